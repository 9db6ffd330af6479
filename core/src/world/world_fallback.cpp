// Direct islands that could not be solved: sweeps over their constraints, one after the other.

#include "constraints/contact_layout.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// A bundle with one contact in its first lane: contacts of the direct list share bodies within their bundles.
struct SingleBundle {
    static constexpr std::size_t kMostLanes = 16;
    alignas(64) float fields[contact::kFields * kMostLanes] = {};

    template <class Visit>
    void visit(float* lane, std::size_t stride, Visit&& kernel) {
        for (std::size_t f = 0; f < contact::kFields; ++f) fields[f * stride] = lane[f * stride];
        kernel(fields);
        for (std::size_t f = 0; f < contact::kFields; ++f) lane[f * stride] = fields[f * stride];
    }
};

}  // namespace

/// Where Newton's method gives up, its velocities mean nothing, and the bodies still have those from before it.
void WorldImpl::sweepIsland(const DirectIsland& island, DirectPass pass) {
    constexpr int kSweeps = 4;
    const bool moves = pass == DirectPass::positions;
    const BodyArrays arrays = bodyArrays();
    const auto stride = static_cast<std::size_t>(graph.lanes());
    SolverContext all = context;
    all.normals = all.friction = true;
    SingleBundle bundle;
    const auto contactsBy = [&](auto kernel) {
        for (std::uint32_t i = 0; i < island.contactCount; ++i)
            bundle.visit(directLanes[island.firstContact + i], stride,
                         [&](float* fields) { kernel(fields, 0, 1, arrays, all); });
    };
    JointSim* const* sims = directSims.data() + island.firstJoint;
    if (moves) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            warmStartJoint(*sims[j], arrays.states, arrays.inertia, jointContext);
        contactsBy(kernels->warmStartContacts);
    }
    for (int sweep = 0; sweep < (moves ? kSweeps : 1); ++sweep) {
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            solveJoint(*sims[j], arrays.states, arrays.inertia, jointContext, moves);
        contactsBy(moves ? kernels->solveContacts : kernels->relaxContacts);
    }
}

}  // namespace ragtop
