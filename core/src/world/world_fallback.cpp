// Direct islands that could not be solved: iteration over their constraints, one after the other.

#include "world/single_bundle.h"
#include "world/world_impl.h"

namespace ragtop {

/// Where Newton's method gives up, its velocities mean nothing, and the bodies still have those from before it.
void WorldImpl::iterateIsland(const DirectIsland& island, DirectPass pass) {
    constexpr int kIterations = 4;  // per substep, by trial
    const bool moves = pass == DirectPass::positions;
    const BodyArrays arrays = bodies.arrays();
    SolverContext all = context;
    all.normals = all.friction = true;
    const auto substeps = static_cast<float>(bodies[directSet.bodies[island.firstBody]].stepFactor);
    JointContext own = jointContext;
    own.h *= substeps, own.inverseH /= substeps, own.softness.biasRate /= substeps;
    SingleBundle bundle(graph.lanes());
    const auto contactsBy = [&](auto kernel) {
        for (std::uint32_t i = 0; i < island.contactCount; ++i)
            bundle.visit(directSet.lanes[island.firstContact + i],
                         [&](float* fields, int begin, int end) { kernel(fields, begin, end, arrays, all); });
    };
    const std::uint32_t* members = directSet.joints.data() + island.firstJoint;
    if (moves) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            warmStartJoint(joints.sims[members[j]], arrays.states, arrays.inertia, own);
        contactsBy(kernels->warmStartContacts);
    }
    for (int iteration = 0; iteration < (moves ? kIterations : 1); ++iteration) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            solveJoint(joints.sims[members[j]], arrays.states, arrays.inertia, own, moves);
        contactsBy(moves ? kernels->solveContacts : kernels->relaxContacts);
    }
}

}  // namespace ragtop
