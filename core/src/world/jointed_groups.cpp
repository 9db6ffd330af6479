#include "world/jointed_groups.h"

#include <algorithm>

#include "constraints/stiffness.h"
#include "constraints/stored_energy.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// How much is known of what a joint gives and takes. What couplings bring is not counted, what forces
/// that a caller adds do not closely; soft stops that turn by less than a radian per substep keep their own ledger
/// (StopLedger); on curves a substep trades more than there is room for.
Watching watchingOf(const AxisRows& axis) {
    if (axis.features & AxisRows::kCoupled) return Watching::none;
    return (axis.features & AxisRows::kSpring) != 0 && axis.feedForward != 0 ? Watching::garbage : Watching::all;
}
Watching watchingOf(const WorldImpl& world, const JointSim& sim) {
    if (hasAxes(sim.kind)) {
        Watching least = sim.kind == JointKind::path ? Watching::garbage : Watching::all;
        for (std::uint32_t i = 0; i < sim.axes.freeRows; ++i) {
            const AxisRows& axis = sim.axes.axis[i];
            // What these hold is not counted.
            if ((axis.features & AxisRows::kSpring) != 0 || axis.stop.stiffness > 0) return Watching::none;
            least = std::min(least, watchingOf(axis));
        }
        return least;
    }
    const bool isPushed = (sim.ball.features & BallRows::kDrives) != 0 && sim.drives.feedForward != Vec3{};
    const bool hasLedger =
        (sim.axis.stop.stiffness > 0 || sim.ball.stop.stiffness > 0) &&
        !(stiffnessOf(sim, world.bodies.states.data(), world.bodies.inertias.data(), world.context.h) > 1);
    return isPushed || hasLedger ? Watching::garbage : watchingOf(sim.axis);
}

std::uint32_t rootOf(AlignedArray<std::uint32_t>& parent, std::uint32_t body) {
    while (parent[body] != body) {
        parent[body] = parent[parent[body]];
        body = parent[body];
    }
    return body;
}

template <class Visit>
void forEachJoint(const WorldImpl& world, Visit&& visit) {
    for (int c = 0; c < world.graph.listCount(); ++c)
        for (const std::uint32_t joint : world.graph.color(c).joints)
            visit(world.joints[joint], world.joints.sims[joint]);
}

/// Union-find over bodies that move and joints between them; false where there are no joints.
bool uniteJoined(WorldImpl& world) {
    EnergyGuard& guard = world.energyGuard;
    bool joined = false;
    guard.parent.resizeForOverwrite(world.bodies.size());
    for (const std::uint32_t body : world.bodies.awake) guard.parent[body] = body;
    forEachJoint(world, [&](const JointRecord& joint, const JointSim&) {
        joined = true;
        if (!world.bodies.moves(joint.bodyA) || !world.bodies.moves(joint.bodyB)) return;
        const std::uint32_t a = rootOf(guard.parent, joint.bodyA), b = rootOf(guard.parent, joint.bodyB);
        guard.parent[a < b ? b : a] = a < b ? a : b;
    });
    return joined;
}

/// Lists the members of each group in the order of awake bodies.
void listMembers(WorldImpl& world, AlignedArray<std::uint32_t>& groupOf) {
    EnergyGuard& guard = world.energyGuard;
    const auto isMember = [&](std::uint32_t body) {
        return world.bodies.moves(body) && world.bodies[body].firstJoint != kNone;
    };
    const auto group = [&](std::uint32_t body) { return groupOf[rootOf(guard.parent, body)]; };
    std::uint32_t count = 0;
    for (const std::uint32_t body : world.bodies.awake)
        if (isMember(body) && rootOf(guard.parent, body) == body) groupOf[body] = count++;
    guard.watched.resize(count, Watching::all);
    // Counted two places on, so that filling moves each begin to where the group before ends.
    guard.starts.resize(count + 2, 0);
    for (const std::uint32_t body : world.bodies.awake)
        if (isMember(body)) ++guard.starts[group(body) + 2];
    for (std::size_t g = 2; g < guard.starts.size(); ++g) guard.starts[g] += guard.starts[g - 1];
    guard.bodies.resizeForOverwrite(guard.starts[count + 1]);
    for (const std::uint32_t body : world.bodies.awake)
        if (isMember(body)) guard.bodies[guard.starts[group(body) + 1]++] = body;
    guard.starts.pop();
}

}  // namespace

void findGroups(WorldImpl& world) {
    if (!world.articulations.areFresh()) return;
    EnergyGuard& guard = world.energyGuard;
    guard.starts.clear();
    guard.bodies.clear();
    guard.watched.clear();
    guard.stores = false;
    if (!uniteJoined(world)) return;
    guard.room.resize(world.bodies.size(), 1.0f);
    AlignedArray<std::uint32_t>& groupOf = guard.visited;  // of roots; it has room for all bodies from then on
    groupOf.resizeForOverwrite(world.bodies.size());
    listMembers(world, groupOf);
    forEachJoint(world, [&](const JointRecord& joint, const JointSim& sim) {
        const std::uint32_t body = world.bodies.moves(joint.bodyA) ? joint.bodyA : joint.bodyB;
        const std::uint32_t group = groupOf[rootOf(guard.parent, body)];
        guard.stores |= storesEnergy(sim);
        guard.watched[group] = std::min(guard.watched[group], watchingOf(world, sim));
    });
}

}  // namespace ragtop
