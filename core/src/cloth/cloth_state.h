#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "cloth/cloth_sim.h"

/// Saving, restoring and hashing what of a cloth decides the future.
namespace ragtop::cloth {

std::size_t saveSize(const ClothSim& sim);
void save(const ClothSim& sim, std::span<std::byte> into);
bool fits(const ClothSim& sim, std::span<const std::byte> from);
void restore(ClothSim& sim, std::span<const std::byte> from);
std::uint64_t hashOf(const ClothSim& sim);

}  // namespace ragtop::cloth
