// Direct islands that could not be solved: iteration over their constraints, one after the other.

#include "constraints/single_bundle.h"
#include "islands/direct_view.h"

namespace ragtop {

void rescaleJoints(Joints& joints, const DirectSet& directSet, const DirectIsland& island, float ratio) {
    for (std::uint32_t j = 0; j < island.jointCount; ++j)
        rescaleJoint(joints.sims[directSet.joints[island.firstJoint + j]], ratio);
}

SolverContext ofSubsteps(const SolverContext& one, int count) {
    SolverContext all = one;
    const auto times = static_cast<float>(count);
    all.h *= times, all.inverseH /= times, all.gravityStep *= times;
    all.soft.biasRate /= times, all.softStatic.biasRate /= times;
    return all;
}
JointContext ofSubsteps(const JointContext& one, int count) {
    JointContext all = one;
    const auto times = static_cast<float>(count);
    all.h *= times, all.inverseH /= times, all.softness.biasRate /= times;
    return all;
}

static void rescaleContacts(const DirectView& d, const DirectIsland& island, float ratio) {
    const auto lanes = static_cast<std::size_t>(d.graph.lanes());
    for (std::uint32_t i = 0; i < island.contactCount; ++i) {
        float* lane = d.directSet.lanes[island.firstContact + i];
        const auto change = [&](int field) { rescale(lane[static_cast<std::size_t>(field) * lanes], ratio); };
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const int point = contact::kPoints + j * contact::kPointFields;
            change(point + contact::kImpulse);
            change(point + contact::kLoad);
        }
        for (int k = 0; k < 3; ++k) change(contact::kFrictionImpulse + k);
        change(contact::kTwistImpulse);
    }
}

void rescaleLoads(const DirectView& d, const DirectIsland& island, float ratio) {
    rescaleContacts(d, island, ratio);
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        JointSim& joint = d.joints.sims[d.directSet.joints[island.firstJoint + j]];
        const PairVector lead = joint.lead;  // is taken back as it was given
        rescaleJoint(joint, ratio);
        joint.lead = lead;
    }
}

/// Iteration from no loads takes energy with every row. What a solve has left, or heavy bodies brought a step ago, a
/// few iterations cannot spread: they would throw what is light. What joints hold the energy guard watches.
void fallBack(const DirectView& d, DirectIsland& island, DirectPass pass) {
    island.fellBack = true;
    island.report.converged = false;
    rescaleJoints(d.joints, d.directSet, island, 0);
    if (island.jointCount == 0) rescaleContacts(d, island, 0);
    iterateIsland(d, island, pass);
}

void iterateIsland(const DirectView& d, const DirectIsland& island, DirectPass pass) {
    constexpr int kIterations = 4;  // per substep, by trial
    const bool moves = pass == DirectPass::positions;
    const DirectSet& direct = d.directSet;
    const BodyArrays arrays = d.bodies.arrays();
    const int substeps = d.bodies[direct.bodies[island.firstBody]].direct.pace.stepFactor;
    SolverContext all = ofSubsteps(d.context, substeps);
    all.normals = all.friction = true;
    const JointContext own = ofSubsteps(d.jointContext, substeps);
    SingleBundle bundle(d.graph.lanes());
    const auto contactsBy = [&](auto kernel) {
        for (std::uint32_t i = 0; i < island.contactCount; ++i)
            bundle.visit(direct.lanes[island.firstContact + i],
                         [&](float* fields, int begin, int end) { kernel(fields, begin, end, arrays, all); });
    };
    const std::uint32_t* members = direct.joints.data() + island.firstJoint;
    if (moves) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            warmStartJoint(d.joints.sims[members[j]], arrays.states, arrays.inertia, own);
        contactsBy(d.kernels.warmStartContacts);
    }
    for (int iteration = 0; iteration < (moves ? kIterations : 1); ++iteration) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            solveJoint(d.joints.sims[members[j]], arrays.states, arrays.inertia, own, moves);
        contactsBy(moves ? d.kernels.solveContacts : d.kernels.relaxContacts);
    }
}

}  // namespace ragtop
