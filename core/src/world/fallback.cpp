// Direct islands that could not be solved: iteration over their constraints, one after the other.

#include "world/fallback.h"

#include "world/multirate.h"
#include "world/single_bundle.h"

namespace ragtop {

void fallBack(WorldImpl& world, DirectIsland& island, WorldImpl::DirectPass pass) {
    island.fellBack = true;
    island.report.converged = false;
    rescaleJoints(world, island, 0);
    iterateIsland(world, island, pass);
}

void iterateIsland(WorldImpl& world, const DirectIsland& island, WorldImpl::DirectPass pass) {
    constexpr int kIterations = 4;  // per substep, by trial
    const bool moves = pass == WorldImpl::DirectPass::positions;
    const DirectSet& direct = world.directSet;
    const BodyArrays arrays = world.bodies.arrays();
    SolverContext all = world.context;
    all.normals = all.friction = true;
    const auto substeps = static_cast<float>(world.bodies[direct.bodies[island.firstBody]].stepFactor);
    JointContext own = world.jointContext;
    own.h *= substeps, own.inverseH /= substeps, own.softness.biasRate /= substeps;
    SingleBundle bundle(world.graph.lanes());
    const auto contactsBy = [&](auto kernel) {
        for (std::uint32_t i = 0; i < island.contactCount; ++i)
            bundle.visit(direct.lanes[island.firstContact + i],
                         [&](float* fields, int begin, int end) { kernel(fields, begin, end, arrays, all); });
    };
    const std::uint32_t* members = direct.joints.data() + island.firstJoint;
    if (moves) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            warmStartJoint(world.joints.sims[members[j]], arrays.states, arrays.inertia, own);
        contactsBy(world.kernels->warmStartContacts);
    }
    for (int iteration = 0; iteration < (moves ? kIterations : 1); ++iteration) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            solveJoint(world.joints.sims[members[j]], arrays.states, arrays.inertia, own, moves);
        contactsBy(moves ? world.kernels->solveContacts : world.kernels->relaxContacts);
    }
}

}  // namespace ragtop
