#pragma once

#include <cstdint>

#include "base/stage_runner.h"
#include "contacts/tables.h"
#include "islands/articulations.h"
#include "islands/direct_set.h"
#include "iteration/regions.h"
#include "model/coupling_passes.h"
#include "solve/joint_kernels.h"
#include "solve/kernel_table.h"

namespace ragtop {

/// What a pass over constraints does.
enum class SolvePass { warmStart, solve, relax };

/// Gauss–Seidel over the colours of the constraint graph: rows are prepared once per step, and passes go over all of
/// them in each substep, bundles of a colour side by side.
struct Iteration {
    ConstTables tables;
    Bodies& bodies;
    Manifolds& manifolds;  ///< places
    Joints& joints;
    Couplings& couplings;
    ConstraintGraph& graph;  ///< lanes
    Regions& regions;
    const Articulations& articulations;
    const DirectSet& directSet;  ///< joints that others prepare
    const KernelTable& kernels;
    const JointKernels& jointKernels;
    SolverContext& context;  ///< which rows a pass solves
    const JointContext& jointContext;
    StageRunner& runner;

    // prepare.cpp
    /// Rows in lanes, from constraints where bodies are; loads are those of substeps of so many seconds, 0 where none
    /// was. True if some contact may bounce.
    bool prepare(float lastSubstep) const;
    void prepareJointOf(std::uint32_t joint) const;
    /// What the substeps have changed of joints.
    void storeJoints() const;

    // passes.cpp
    void warmStart() const;
    /// After the warm start: loads of contacts that were struck lately and would throw their bodies are shrunk to what
    /// takes most of their energy.
    void shrinkStruckLoads() const;
    void shrinkStruckLoads(int region, const SolverContext& own) const;
    /// Friction beside the normal rows of each contact, or, `sequential`, after those of all. `useBias`: the soft pass,
    /// else the relaxing one.
    void solve(bool useBias, bool sequential) const;
    void passOverRegion(int region, SolvePass which, const SolverContext& own) const;
    /// Iterates until nothing more will meet, or enough: what is left then is stopped by the rows that do not bounce.
    void bounce() const;
    /// Iterations that move nothing yet make the estimate of the loads of some manifolds an equilibrium of weights,
    /// which is what these contacts bear from then on.
    void settleNewContacts(AlignedArray<std::uint32_t>& fresh, const Vec3& gravity, bool sequential) const;
    /// After velocities are integrated, of a body that modules may have pushed before: its contacts bear that from the
    /// beginning. Before the warm start they find the loads λ' that hold the body as it is pushed now, against others
    /// that go on as they did but for these, and are soft about them,
    ///
    ///     s = min(2 g h m_eff/λ', 1),   λ̂ ← s λ̂ + (1 − s) λ',   λ ← λ',
    ///
    /// so that a brick of 1 kg under a wheel gives way by what its own motion asks for.
    void bearPush(std::uint32_t body, const SolverContext& own) const;

private:
    void groupContacts() const;
    std::int32_t placeAndPrepare(int color, int begin, int end) const;
    void collectStruck(bool any) const;
    void markThrown(int region, const SolverContext& own) const;
    void prepareJoints() const;
    void passOverAll(SolvePass which, const SolverContext& own) const;
};

}  // namespace ragtop
