#include "model/spring_leads.h"

#include "constraints/constraint_graph.h"
#include "constraints/spring_lead.h"

namespace ragtop {

void collectSprings(Joints& joints, const ConstraintGraph& graph) {
    Springs& springs = joints.springs;
    springs.joints.clear();
    springs.starts.clear();
    for (int c = 0; c < graph.listCount(); ++c) {
        springs.starts.push(static_cast<std::uint32_t>(springs.joints.size()));
        for (const std::uint32_t joint : graph.color(c).joints)
            if (leads(joints.sims[joint])) springs.joints.push(joint);
    }
    springs.starts.push(static_cast<std::uint32_t>(springs.joints.size()));
}

static BodyKicks kicksOf(const Bodies& bodies, const JointSim& joint, float h) {
    const auto linear = [&](std::uint32_t state) { return h * bodies.dynamics[state].acceleration; };
    const auto angular = [&](std::uint32_t state) {
        return h * (bodies.inertias[state] * bodies.dynamics[state].torque);
    };
    return {linear(joint.stateA), angular(joint.stateA), linear(joint.stateB), angular(joint.stateB)};
}

void leadSprings(Joints& joints, Bodies& bodies, float h, Lead when, StageRunner& runner) {
    constexpr int kAtOnce = 16;  // springs of a task
    const Springs& springs = joints.springs;
    if (springs.joints.empty()) return;
    const auto visit = [&](std::uint32_t joint) {
        JointSim& sim = joints.sims[joint];
        const auto lead = when == Lead::begin ? beginLead : endLead;
        const std::uint32_t a = joints[joint].bodyA, moving = bodies.moves(a) ? a : joints[joint].bodyB;
        const float own = static_cast<float>(bodies[moving].direct.pace.stepFactor) * h;
        lead(sim, bodies.states.data(), bodies.inertias.data(), kicksOf(bodies, sim, own), own);
    };
    for (int c = 0; c + 1 < static_cast<int>(springs.starts.size()); ++c) {
        const std::uint32_t first = springs.starts[static_cast<std::size_t>(c)];
        const auto count = static_cast<int>(springs.starts[static_cast<std::size_t>(c) + 1] - first);
        // Bodies may occur as often as they like in these.
        const bool serial = ConstraintGraph::isSerial(c) || !ConstraintGraph::isIterated(c);
        runner.parallelFor(count, serial ? count + 1 : kAtOnce, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) visit(springs.joints[first + static_cast<std::uint32_t>(i)]);
        });
    }
}

}  // namespace ragtop
