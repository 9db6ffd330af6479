#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ragtop/id.h"

namespace ragtop {

class World;

/// What code outside the core (a vehicle, a ragdoll, a game's own controller) registers with a world (World::add) to
/// act at fixed points of the step and to be saved, restored and hashed with the world. Plain functions and a pointer;
/// null functions are skipped; none may throw. Unless a function says otherwise, it is called on the thread that steps,
/// in the order of registration.
struct StepModule {
    void* user = nullptr;
    const char* name = "";
    /// Before collisions are found; dt of the step, s. May cast rays and apply impulses and forces.
    void (*beforeStep)(void* user, World& world, double dt) = nullptr;
    /// After `beforeStep` of all modules: reads the world, casts included, and returns the bodies that `beforeSubstep`
    /// will read or push in this step; fixed ones need not be named. Named bodies wake. Called on any thread, at once
    /// with that of other modules, so it may write only what is the module's own. The span must stay valid until the
    /// step ends; ids in it of bodies that no longer exist do no harm.
    std::span<const BodyId> (*look)(void* user, const World& world, double dt) = nullptr;
    /// Before the velocities of each substep are integrated; h of the substep, s. May read velocities and poses and
    /// apply impulses; may not create or destroy.
    ///
    /// With `look` it may act on named and fixed bodies only, is not called in steps in which none was named, and runs
    /// on any thread, at once with modules that share no moving body with it; modules that share one run in the order
    /// of registration. An impulse on another body is left out and counted (StepStats::strayImpulses). Without `look`
    /// it may act on any body: it runs alone, and the world solves as if every body were named, which costs what it
    /// would otherwise save.
    void (*beforeSubstep)(void* user, World& world, double h) = nullptr;
    /// After the step.
    void (*afterStep)(void* user, World& world, double dt) = nullptr;
    std::size_t (*saveSize)(const void* user) = nullptr;  ///< bytes
    void (*save)(const void* user, std::span<std::byte> into) = nullptr;
    /// Whether these bytes, of the right size, were saved by a module with the same definition; asked before anything
    /// is restored. Null: always.
    bool (*fits)(const void* user, std::span<const std::byte> from) = nullptr;
    void (*restore)(void* user, std::span<const std::byte> from) = nullptr;
    std::uint64_t (*hash)(const void* user) = nullptr;
};

}  // namespace ragtop
