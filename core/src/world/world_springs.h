#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"

/// What springs lead their bodies by between steps (constraints/spring_lead.h).
namespace ragtop {

struct WorldImpl;

/// Joints with springs, in the order of the lists of the graph, and where those of each list begin.
struct Springs {
    explicit Springs(std::pmr::memory_resource* memory) : joints(memory), starts(memory) {}
    AlignedArray<std::uint32_t> joints, starts;
};

/// After joints came, went or changed.
void collectSprings(WorldImpl& world);
/// Before the first substep, and after the last one.
enum class Lead { begin, end };
void leadSprings(WorldImpl& world, Lead when);

}  // namespace ragtop
