// Direct islands that could not be solved: iteration over their constraints, one after the other.

#include "constraints/single_bundle.h"
#include "islands/direct_view.h"

namespace ragtop {

void rescaleJoints(Joints& joints, const DirectSet& directSet, const DirectIsland& island, float ratio) {
    for (std::uint32_t j = 0; j < island.jointCount; ++j)
        rescaleJoint(joints.sims[directSet.joints[island.firstJoint + j]], ratio);
}

/// Contacts' of the last step.
static void forgetLoads(const DirectView& d, const DirectIsland& island) {
    const auto lanes = static_cast<std::size_t>(d.graph.lanes());
    for (std::uint32_t i = 0; i < island.contactCount; ++i) {
        float* lane = d.directSet.lanes[island.firstContact + i];
        const auto clear = [&](int field) { lane[static_cast<std::size_t>(field) * lanes] = 0; };
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const int point = contact::kPoints + j * contact::kPointFields;
            clear(point + contact::kImpulse);
            clear(point + contact::kLoad);
        }
        for (int k = 0; k < 3; ++k) clear(contact::kFrictionImpulse + k);
        clear(contact::kTwistImpulse);
    }
}

/// Iteration from no loads takes energy with every row. What a solve has left, or heavy bodies brought a step ago, a
/// few iterations cannot spread: they would throw what is light. What joints hold the energy guard watches.
void fallBack(const DirectView& d, DirectIsland& island, DirectPass pass) {
    island.fellBack = true;
    island.report.converged = false;
    rescaleJoints(d.joints, d.directSet, island, 0);
    if (island.jointCount == 0) forgetLoads(d, island);
    iterateIsland(d, island, pass);
}

void iterateIsland(const DirectView& d, const DirectIsland& island, DirectPass pass) {
    constexpr int kIterations = 4;  // per substep, by trial
    const bool moves = pass == DirectPass::positions;
    const DirectSet& direct = d.directSet;
    const BodyArrays arrays = d.bodies.arrays();
    SolverContext all = d.context;
    all.normals = all.friction = true;
    const auto substeps = static_cast<float>(d.bodies[direct.bodies[island.firstBody]].direct.pace.stepFactor);
    JointContext own = d.jointContext;
    own.h *= substeps, own.inverseH /= substeps, own.softness.biasRate /= substeps;
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
