#pragma once

#include <cstdint>
#include <span>

#include "activity/activity.h"
#include "islands/direct_view.h"
#include "iteration/iteration.h"
#include "world/body_stage.h"
#include "world/energy_guard.h"

/// Multirate: trees of joints whose gaps stay small take several substeps of the world at once (docs/adr/0021), as does
/// what stiff springs hold upright and hardly moves (docs/adr/0080); trees that nothing else has part in do so by
/// themselves (docs/adr/0006).
namespace ragtop {

/// What the choice of step factors reads and writes.
struct MultirateView {
    Bodies& bodies;  ///< step factors, and speeds that belong to the middle of a substep
    const Joints& joints;
    const Contacts& contacts;
    const Manifolds& manifolds;
    const ContactFinds& contactFinds;
    DirectSet& directSet;  ///< trees and their paces
    const Freezing& freezing;
    const ModuleWork& moduleWork;
    const SolverContext& context;
    const WorldSettings& settings;
    int lanes;
    StageRunner& runner;
};

/// How each body of this step goes through it; groups trees anew that changed.
void chooseStepFactors(const MultirateView& view);
/// Trees that nothing else has part in go through the whole step, each group of them in one task.
void stepIndependentTrees(const DirectView& d, const Iteration& iteration, const BodyStage& stage,
                          const GuardView& guard);
/// A body of a tree that takes as many substeps of h seconds at once from now on.
void setStepFactor(Bodies& bodies, std::uint32_t body, int stepFactor, const Vec3& gravity, float h);

/// Calls visit(k, bodies) for those of `solved` that take 2ᵏ substeps of the world at once and are not independent.
template <class Visit>
void forSharedBodies(const Multirate& multirate, std::span<const std::uint32_t> solved, Visit&& visit) {
    for (std::size_t k = 0; k < multirate.lists.size(); ++k) {
        const bool whole = k == 0 && !multirate.any;
        const AlignedArray<std::uint32_t>& some = multirate.lists[k];
        const std::span<const std::uint32_t> list = whole ? solved : std::span(some.data(), some.size());
        if (!list.empty()) visit(static_cast<int>(k), list);
    }
}

}  // namespace ragtop
