#include "world/swept_groups.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/joint_counts.h"
#include "constraints/stored_energy.h"
#include "continuous/meetings.h"
#include "world/group_motion.h"
#include "world/joint_opening.h"

namespace ragtop {

namespace {

constexpr double kUnswept = std::numeric_limits<double>::quiet_NaN();
constexpr float kShortest = 0.125f;  ///< of a step, below which none of it is left: as where joints are closed
constexpr double kPayable = 0.1;     ///< of its kinetic energy, which a group may lose rather than go less far
constexpr double kNothing = 1e-6;    ///< of the same, that is nothing

bool holdsSprings(const ClosingView& world, std::span<const std::uint32_t> group) {
    bool holds = false;
    forEachJoint(world, group, [&](std::uint32_t joint) { holds |= storesEnergy(world.joints.sims[joint]); });
    return holds;
}

bool isAny(const ClosingView& world, std::span<const std::uint32_t> group, BodyFlag flag) {
    return std::any_of(group.begin(), group.end(),
                       [&](std::uint32_t b) { return world.sweptBodies.flags[world.bodies[b].awakeIndex] == flag; });
}

double motionOf(const ClosingView& world, std::span<const std::uint32_t> group) {
    double kinetic = 0;
    for (const std::uint32_t b : group) kinetic += kineticEnergy(world.bodies, b, world.bodies[b].rotation);
    return kinetic;
}

/// J, of motion, of springs, and of what forces would give on the way back to where the step began.
double energyOf(const ClosingView& world, std::span<const std::uint32_t> group) {
    double energy = motionOf(world, group);
    forEachJoint(world, group, [&](std::uint32_t joint) {
        const JointSim& sim = world.joints.sims[joint];
        if (storesEnergy(sim)) energy += storedEnergy(sim, jointBodies(world.bodies, world.joints[joint]));
    });
    for (const std::uint32_t b : group) {
        const SweptPath path = pathOfStep(world.bodies, world.sweptBodies.startPoses(), world.dt, b);
        energy -= static_cast<double>(world.bodies[b].mass * dot(world.bodies.dynamics[b].acceleration, path.way));
    }
    return energy;
}

/// Every body at a share of the way that it goes now.
void goBack(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const SweptPath> paths,
            float share) {
    for (std::size_t i = 0; i < group.size(); ++i) {
        BodyRecord& body = world.bodies[group[i]];
        const Pose at = paths[i].at(share);
        world.bodies.turnVelocity(group[i], body.rotation, at.rotation);
        body.center = at.position;
        body.rotation = at.rotation;
        world.bodies.refreshInertia(group[i]);
    }
    forEachJoint(world, group, [&](std::uint32_t joint) {
        JointSim& sim = world.joints.sims[joint];
        restoreCounts(sim);
        placeJoint(sim, jointBodies(world.bodies, world.joints[joint]), world.bodies.states.data(),
                   world.bodies.inertias.data());
    });
}

void payForSweep(const ClosingView& world, std::span<const std::uint32_t> group, double before) {
    AlignedArray<SweptPath>& paths = world.jointClosing.sweptPaths;
    double excess = energyOf(world, group) - before;
    const double kinetic = motionOf(world, group);
    if (!(excess > kNothing * kinetic)) return;
    paths.clear();
    for (const std::uint32_t b : group)
        paths.push(pathOfStep(world.bodies, world.sweptBodies.startPoses(), world.dt, b));
    for (float share = 0.5f; excess > kPayable * kinetic && share > 0; share *= 0.5f) {
        goBack(world, group, {paths.data(), paths.size()}, share < kShortest ? share = 0 : share);
        excess = energyOf(world, group) - before;
    }
    // What it met has got its momentum; only what motion against each other cannot pay comes from that of all.
    excess -= takeEnergy(world.bodies, world.joints, group, excess, Keeps::momenta);
    if (excess > kNothing * kinetic) takeEnergy(world.bodies, world.joints, group, excess, Keeps::nothing);
    for (const std::uint32_t b : group) world.bodies.storeMomentum(b);
}

}  // namespace

void noteEnergyToSweep(const ClosingView& world) {
    const EnergyGuard& guard = world.energyGuard;
    AlignedArray<double>& noted = world.jointClosing.energyToSweep;
    noted.clear();
    if (guard.groupCount() == 0 || !guard.stores) return;
    for (std::size_t g = 0; g < guard.groupCount(); ++g) {
        const std::span<const std::uint32_t> group = guard.membersOf(g);
        const bool isNoted =
            guard.watched[g] == Watching::all && isAny(world, group, kToSweep) && holdsSprings(world, group);
        noted.push(isNoted ? energyOf(world, group) : kUnswept);
    }
}

void payForSweeps(const ClosingView& world) {
    const AlignedArray<double>& noted = world.jointClosing.energyToSweep;
    for (std::size_t g = 0; g < noted.size(); ++g) {
        const std::span<const std::uint32_t> group = world.energyGuard.membersOf(g);
        if (std::isfinite(noted[g]) && isAny(world, group, kSwept)) payForSweep(world, group, noted[g]);
    }
}

}  // namespace ragtop
