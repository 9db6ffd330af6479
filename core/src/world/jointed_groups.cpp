#include "world/jointed_groups.h"

#include <algorithm>

#include "base/union_find.h"
#include "constraints/stiffness.h"
#include "constraints/stored_energy.h"
#include "world/energy_drivers.h"
#include "world/energy_guard.h"

namespace ragtop {

namespace {

/// How much is known of what a joint gives and takes. What couplings bring is not counted, what forces
/// that a caller adds do not closely; soft stops that turn by less than a radian per substep keep their own ledger
/// (StopLedger); on curves a substep trades more than there is room for.
Watching watchingOf(const AxisRows& axis) {
    if (axis.features & AxisRows::kCoupled) return Watching::none;
    return (axis.features & AxisRows::kSpring) != 0 && axis.spring.feedForward != 0 ? Watching::garbage : Watching::all;
}
Watching watchingOf(const GuardView& view, const JointSim& sim) {
    if (hasAxes(sim.kind)) {
        Watching least = sim.kind == JointKind::path ? Watching::garbage : Watching::all;
        for (std::uint32_t i = 0; i < withAxes(sim).axes.freeRows; ++i) {
            const AxisRows& axis = withAxes(sim).axes.axis[i];
            // What these hold is not counted.
            if ((axis.features & AxisRows::kSpring) != 0 || axis.stop.stiffness > 0) return Watching::none;
            least = std::min(least, watchingOf(axis));
        }
        return least;
    }
    const bool isPushed = (sim.ball.features & BallRows::kDrives) != 0 && sim.drives.feedForward != Vec3{};
    const bool hasLedger =
        (sim.axis.stop.stiffness > 0 || sim.ball.stop.stiffness > 0) &&
        !(hardnessOf(sim, view.bodies.states.data(), view.bodies.inertias.data(), view.context.h).stiffness > 1);
    return isPushed || hasLedger ? Watching::garbage : watchingOf(sim.axis);
}

/// Union-find over bodies that move and joints between them; false where there are no joints.
bool uniteJoined(const GuardView& view) {
    EnergyGuard& guard = view.guard;
    bool joined = false;
    guard.parent.resizeForOverwrite(view.bodies.size());
    for (const std::uint32_t body : view.bodies.awake) guard.parent[body] = body;
    for (int c = 0; c < view.graph.listCount(); ++c)
        for (const std::uint32_t index : view.graph.color(c).joints) {
            const JointRecord& joint = view.joints[index];
            joined = true;
            if (view.bodies.moves(joint.bodyA) && view.bodies.moves(joint.bodyB))
                unite(guard.parent, joint.bodyA, joint.bodyB);
        }
    return joined;
}

/// Lists the members of each group in the order of awake bodies.
void listMembers(const GuardView& view, AlignedArray<std::uint32_t>& groupOf) {
    EnergyGuard& guard = view.guard;
    const auto isMember = [&](std::uint32_t body) {
        return view.bodies.moves(body) && view.bodies[body].firstJoint != kNone;
    };
    const auto group = [&](std::uint32_t body) { return groupOf[rootOf(guard.parent, body)]; };
    std::uint32_t count = 0;
    for (const std::uint32_t body : view.bodies.awake)
        if (isMember(body) && rootOf(guard.parent, body) == body) groupOf[body] = count++;
    guard.watched.resize(count, Watching::all);
    // Counted two places on, so that filling moves each begin to where the group before ends.
    guard.starts.resize(count + 2, 0);
    for (const std::uint32_t body : view.bodies.awake)
        if (isMember(body)) ++guard.starts[group(body) + 2];
    for (std::size_t g = 2; g < guard.starts.size(); ++g) guard.starts[g] += guard.starts[g - 1];
    guard.bodies.resizeForOverwrite(guard.starts[count + 1]);
    for (const std::uint32_t body : view.bodies.awake)
        if (isMember(body)) {
            guard.bodies[guard.starts[group(body) + 1]++] = body;
            guard.parent[body] = rootOf(guard.parent, body);
        }
    guard.starts.pop();
}

/// Lists the joints of each group in the order of its bodies, and what is known of them.
void listJoints(const GuardView& view) {
    EnergyGuard& guard = view.guard;
    const auto note = [&](std::size_t g, std::uint32_t joint) {
        const JointSim& sim = view.joints.sims[joint];
        guard.joints.push(joint);
        guard.watched[g] = std::min(guard.watched[g], watchingOf(view, sim));
        EnergyGuard::GroupTraits& traits = guard.traits[g];
        traits.drives |= mayDrive(view, joint);
        traits.isMotored |= hasBoundedMotor(sim);
        traits.stores |= storesEnergy(sim);
        traits.hangs |= !view.bodies.moves(view.joints[joint].bodyA) || !view.bodies.moves(view.joints[joint].bodyB);
        guard.stores |= traits.stores;
    };
    guard.traits.resize(guard.groupCount(), EnergyGuard::GroupTraits{});
    for (std::size_t g = 0; g < guard.groupCount(); ++g) {
        guard.jointStarts.push(static_cast<std::uint32_t>(guard.joints.size()));
        for (const std::uint32_t body : guard.membersOf(g))
            for (std::uint32_t key = view.bodies[body].firstJoint; key != kNone; key = view.joints.next(key)) {
                const bool isFirst = (key & 1) == 0 || !view.bodies.moves(view.joints[key >> 1].bodyA);
                if (isFirst && view.joints.isHolding(key >> 1)) note(g, key >> 1);
            }
    }
    guard.jointStarts.push(static_cast<std::uint32_t>(guard.joints.size()));
}

}  // namespace

void findGroups(const GuardView& view) {
    if (!view.articulations.areFresh()) return;
    EnergyGuard& guard = view.guard;
    guard.starts.clear();
    guard.bodies.clear();
    guard.watched.clear();
    guard.jointStarts.clear();
    guard.joints.clear();
    guard.traits.clear();
    guard.stores = false;
    view.joints.opened = false;
    if (!uniteJoined(view)) return;
    guard.visited.reserve(view.bodies.size());
    AlignedArray<std::uint32_t>& groupOf = guard.groupOf;
    groupOf.resizeForOverwrite(view.bodies.size());
    listMembers(view, groupOf);
    listJoints(view);
}

bool areGrouped(const Bodies& bodies, const EnergyGuard& guard, std::uint32_t a, std::uint32_t b) {
    const auto isMember = [&](std::uint32_t body) {
        return bodies.moves(body) && bodies.isAwake(body) && bodies[body].firstJoint != kNone;
    };
    return isMember(a) && isMember(b) && guard.parent[a] == guard.parent[b];
}

}  // namespace ragtop
