#include "world/world_springs.h"

#include "constraints/spring_lead.h"
#include "world/world_impl.h"

namespace ragtop {

void collectSprings(WorldImpl& world) {
    Springs& springs = world.springs;
    springs.joints.clear();
    springs.starts.clear();
    for (int c = 0; c < world.graph.listCount(); ++c) {
        springs.starts.push(static_cast<std::uint32_t>(springs.joints.size()));
        for (const std::uint32_t joint : world.graph.color(c).joints)
            if (hasSprings(world.joints.sims[joint])) springs.joints.push(joint);
    }
    springs.starts.push(static_cast<std::uint32_t>(springs.joints.size()));
}

static BodyKicks kicksOf(const WorldImpl& world, const JointSim& joint) {
    const float h = world.context.h;
    const auto linear = [&](std::uint32_t state) { return h * world.bodies.dynamics[state].acceleration; };
    const auto angular = [&](std::uint32_t state) {
        return h * (world.bodies.inertias[state] * world.bodies.dynamics[state].torque);
    };
    return {linear(joint.stateA), angular(joint.stateA), linear(joint.stateB), angular(joint.stateB)};
}

void leadSprings(WorldImpl& world, Lead when) {
    constexpr int kAtOnce = 16;  // springs of a task
    const Springs& springs = world.springs;
    if (springs.joints.empty()) return;
    const auto visit = [&](std::uint32_t joint) {
        JointSim& sim = world.joints.sims[joint];
        const auto lead = when == Lead::begin ? beginLead : endLead;
        lead(sim, world.bodies.states.data(), world.bodies.inertias.data(), kicksOf(world, sim), world.context.h);
    };
    for (int c = 0; c + 1 < static_cast<int>(springs.starts.size()); ++c) {
        const std::uint32_t first = springs.starts[static_cast<std::size_t>(c)];
        const auto count = static_cast<int>(springs.starts[static_cast<std::size_t>(c) + 1] - first);
        // Bodies may occur as often as they like in these.
        const bool serial = ConstraintGraph::isSerial(c) || !ConstraintGraph::isIterated(c);
        world.runner.parallelFor(count, serial ? count + 1 : kAtOnce, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) visit(springs.joints[first + static_cast<std::uint32_t>(i)]);
        });
    }
}

}  // namespace ragtop
