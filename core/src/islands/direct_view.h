#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/stage_runner.h"
#include "contacts/tables.h"
#include "islands/direct_set.h"
#include "islands/islands.h"
#include "model/module_work.h"
#include "solve/kernel_table.h"

/// Islands that are solved directly, in the course of a step: by Newton's method, in lanes as trees of joints, or in
/// their own time as mechanisms.
namespace ragtop {

/// What solving islands directly reads and writes.
struct DirectView {
    Bodies& bodies;
    Joints& joints;
    const Contacts& contacts;
    const Manifolds& manifolds;
    ConstraintGraph& graph;  ///< the lanes of its list of theirs
    Islands& islands;        ///< sets of bodies, and that the choice is to be made anew
    DirectSet& directSet;
    const ModuleWork& moduleWork;
    const SolverContext& context;
    const JointContext& jointContext;
    const KernelTable& kernels;
    StageRunner& runner;
    std::pmr::memory_resource* memory;
    int substeps;
};

enum class DirectPass { positions, velocities };

/// Islands of the direct list, their bodies numbered in the order in which its constraints name them, so that the
/// grouping depends on that list alone.
void groupDirect(const DirectView& d);
/// Once in a step, after constraints were prepared.
void beginDirect(const DirectView& d);
/// In each substep, before and after positions move.
void solveDirect(const DirectView& d, DirectPass pass);
/// Before velocities change: a mechanism adds what acts from outside by itself.
void readMechanisms(const DirectView& d);
/// Once in a step: what could not be solved, or rests, is noted.
void endDirect(const DirectView& d);

// Trees of joints (direct_trees.cpp).
/// Rigid rows alone, of a kind that trees know.
bool isTreeJoint(const JointSim& joint);
bool turnsFreely(const Bodies& bodies, std::uint32_t body);
/// Direct islands that are trees of rigid rows and touch nothing; chooseStepFactors groups them. Leapfrog trees have
/// half of their forces in a step's first substep: a module that holds them against all of them would move them.
void planChains(const DirectView& d);
/// Rows and loads of this step, of all groups that take part in the substeps of the world, or of one.
void beginChains(const DirectView& d);
void beginGroup(const DirectView& d, direct::TreePlan::Group& group);
/// What is to be done in a substep of the world.
void solveChains(const DirectView& d, DirectPass pass);
void solveGroup(const DirectView& d, direct::TreePlan::Group& group, DirectPass pass, int substep);
/// Of a tree: it takes more substeps at once when its joints have been closed for a while, fewer as soon as they open.
void recordGaps(const DirectView& d, const DirectIsland& island);

// Mechanisms of joints alone (direct_mechanisms.cpp).
/// Which islands are mechanisms.
void planMechanisms(const DirectView& d);
/// Bodies as they are, in double, and joints with their loads.
void beginMechanism(const DirectView& d, const DirectIsland& island, direct::Mechanism& mechanism);
/// Moves a mechanism through the substep before anything else has; it is seen where it is only after all have moved.
void solveMechanism(const DirectView& d, DirectIsland& island, direct::Mechanism& mechanism, DirectPass pass);
/// Fewer inner steps when a second has asked for half of them only.
void keepPace(const DirectView& d, const DirectIsland& island, const direct::Mechanism& mechanism);

// Islands that could not be solved (direct_fallback.cpp).
/// Iterates over the constraints of an island, one after the other, with the velocities that its bodies have: where a
/// solve failed, those from before it.
void iterateIsland(const DirectView& d, const DirectIsland& island, DirectPass pass);
/// What all share in a substep as long as so many.
SolverContext ofSubsteps(const SolverContext& one, int count);
JointContext ofSubsteps(const JointContext& one, int count);
/// Of an island that takes several substeps at once: loads of contacts and joints, but not what was given already.
void rescaleLoads(const DirectView& d, const DirectIsland& island, float ratio);
/// Loads of as many substeps as its joints are solved for at once.
void rescaleJoints(Joints& joints, const DirectSet& directSet, const DirectIsland& island, float ratio);
/// Does that from now to the end of the step. Its joints begin without loads: those of taut joints are more than
/// iteration can carry, and throw bodies about that a solve does not hold.
void fallBack(const DirectView& d, DirectIsland& island, DirectPass pass);

}  // namespace ragtop
