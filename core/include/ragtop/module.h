#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ragtop/id.h"

namespace ragtop {

class World;

/// What a part outside the core (a vehicle, a ragdoll, a game's own controller) registers with a world: it acts at
/// fixed places of the step, and its state is saved, restored and hashed with the world's. Plain functions and a
/// pointer; null functions are skipped; none may throw. Where nothing else is said, they are called on the thread that
/// steps, in the order of registration.
struct StepModule {
    void* user = nullptr;
    const char* name = "";
    /// Before collisions are found; dt of the step, s. May cast rays and apply impulses and forces.
    void (*beforeStep)(void* user, World& world, double dt) = nullptr;
    /// After `beforeStep` of all modules: looks at the world as the step finds it, and names the bodies that
    /// `beforeSubstep` will read or push in this step, those that are fixed left out. What is named is woken. Called on
    /// any thread, at once with that of other modules: it reads the world and writes what is the module's own. The span
    /// is valid until the step ends; bodies in it that are no more do no harm.
    std::span<const BodyId> (*look)(void* user, const World& world, double dt) = nullptr;
    /// Before the velocities of each substep are integrated; h of the substep, s. May read velocities and poses and
    /// apply impulses; may not create or destroy.
    ///
    /// With `look` it keeps to the bodies that were named, and to what is fixed; is not called where none was; and is
    /// called on any thread, at once with modules that share no moving body with it, those that share one in the order
    /// of registration. An impulse on another body is left out and counted (StepStats::strayImpulses). Without `look`
    /// it may act on any body: no other module is called meanwhile, and the world solves everything as if it were acted
    /// on.
    void (*beforeSubstep)(void* user, World& world, double h) = nullptr;
    /// After the step.
    void (*afterStep)(void* user, World& world, double dt) = nullptr;
    std::size_t (*saveSize)(const void* user) = nullptr;
    void (*save)(const void* user, std::span<std::byte> into) = nullptr;
    /// Whether bytes of its size were saved by a module like it is now; asked before anything is restored. Null:
    /// always.
    bool (*fits)(const void* user, std::span<const std::byte> from) = nullptr;
    void (*restore)(void* user, std::span<const std::byte> from) = nullptr;
    std::uint64_t (*hash)(const void* user) = nullptr;
};

}  // namespace ragtop
