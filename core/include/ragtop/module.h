#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ragtop {

class World;

/// What a part outside the core (a vehicle, a ragdoll, a game's own controller) registers with a world: it acts at
/// fixed places of the step, in the order of registration, on the calling thread, and its state is saved, restored
/// and hashed with the world's. Plain functions and a pointer; null functions are skipped; none may throw.
struct StepModule {
    void* user = nullptr;
    const char* name = "";
    /// Before collisions are found; dt of the step, s. May cast rays and apply impulses and forces.
    void (*beforeStep)(void* user, World& world, double dt) = nullptr;
    /// Before the velocities of each substep are integrated; h of the substep, s. May read velocities and poses and
    /// apply impulses; may not create or destroy.
    void (*beforeSubstep)(void* user, World& world, double h) = nullptr;
    /// After the step.
    void (*afterStep)(void* user, World& world, double dt) = nullptr;
    std::size_t (*saveSize)(const void* user) = nullptr;
    void (*save)(const void* user, std::span<std::byte> into) = nullptr;
    /// Whether bytes of its size were saved by a module like it is now; asked before anything is restored. Null: always.
    bool (*fits)(const void* user, std::span<const std::byte> from) = nullptr;
    void (*restore)(void* user, std::span<const std::byte> from) = nullptr;
    std::uint64_t (*hash)(const void* user) = nullptr;
};

}  // namespace ragtop
