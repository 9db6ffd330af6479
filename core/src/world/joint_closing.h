#pragma once

#include <cstdint>
#include <memory>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "constraints/joint_sim.h"
#include "continuous/swept_bodies.h"
#include "continuous/swept_motion.h"
#include "direct/island_system.h"
#include "world/closing_touches.h"
#include "world/energy_guard.h"

/// Closes joints by places where a step has left them open (docs/adr/0039). Whatever way its island
/// is solved, a group of bodies that joints hold together ends no step with its anchors further apart than a small part
/// of their bodies' size: all of the group go the least way, weighted with their masses, that closes its joints, and
/// what speed opens them is taken. Both are orthogonal projections in the metric of the masses: they keep the momentum
/// of a group that nothing holds, and add no kinetic energy.
namespace ragtop {

/// Memory of the closing, from step to step.
struct JointClosing {
    explicit JointClosing(std::pmr::memory_resource* memory)
        : open(memory), groups(memory), localOf(memory), energyToSweep(memory), sweptPaths(memory) {}

    AlignedArray<std::uint8_t> open;      ///< per group of the energy guard
    AlignedArray<std::uint32_t> groups;   ///< those that are open
    AlignedArray<std::uint32_t> localOf;  ///< per body, its number in its group's system
    AlignedArray<double> energyToSweep;   ///< J, per group, before its bodies were swept; no number: none is to be
    AlignedArray<SweptPath> sweptPaths;   ///< of the bodies of one
    /// Of each worker.
    struct Bench {
        explicit Bench(std::pmr::memory_resource* memory)
            : joints(memory),
              sims(memory),
              paths(memory),
              speeds(memory),
              best(memory),
              turns(memory),
              touches(memory),
              points(memory),
              system(memory) {}
        AlignedArray<std::uint32_t> joints;
        AlignedArray<JointSim*> sims;
        AlignedArray<SweptPath> paths;    ///< of the group's bodies in this step
        AlignedArray<PairVector> speeds;  ///< of these when it was done: m/s and rad/s
        AlignedArray<Pose> best;          ///< where they were closed best
        AlignedArray<float> turns;        ///< rad², of the ways of a round
        AlignedArray<ClosingTouch> touches;
        AlignedArray<direct::ClosingPoint> points;  ///< these where they are now
        direct::IslandSystem system;
        int pivots = 0;         ///< that closing a group beside contacts has taken
        std::uint64_t cut = 0;  ///< steps of groups that were cut short, in this step
    };
    std::vector<std::unique_ptr<Bench>> benches;
    std::size_t mostBodies = 0, mostJoints = 0, mostTouches = 0;  ///< of a group that was closed
    std::uint64_t closed = 0, cut = 0;  ///< groups, and those whose step was cut short, since the world was made
};

/// What closing joints reads and writes of a world.
struct ClosingView {
    Bodies& bodies;
    const Shapes& shapes;
    const Contacts& contacts;
    const Manifolds& manifolds;
    Joints& joints;
    const ConstraintGraph& graph;  ///< how many lanes
    const EnergyGuard& energyGuard;
    const SweptBodies& sweptBodies;
    JointClosing& jointClosing;
    const SolverContext& context;
    const JointContext& jointContext;
    float dt;
    StageRunner& runner;
    std::pmr::memory_resource* memory;
};

/// When bodies are where the step has taken them.
void closeOpenJoints(const ClosingView& world);

}  // namespace ragtop
