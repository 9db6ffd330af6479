#pragma once

#include "activity/activity.h"
#include "iteration/iteration.h"

/// What is outside the core and takes part in steps (docs/adr/0048).
namespace ragtop {

class World;

/// Asks modules what they look at in this step, wakes that, and groups them.
void askModules(ModuleWork& work, const Activity& activity, StageRunner& runner, const World& face, double dt);
/// Between two substeps of h seconds: all modules, those of different groups side by side.
void actBetweenSubsteps(ModuleWork& work, const Bodies& bodies, StageRunner& runner, World& face, float h);
/// Those of one group.
void actAsGroup(ModuleWork& work, const Bodies& bodies, World& face, std::size_t group, float h);
/// After velocities are integrated, of all bodies that modules named, or those of one group. What modules give counts
/// in the change of velocity of the substep, as forces do, beside what answers it, and contacts bear it from the
/// beginning (Iteration::bearPush). Of modules that named none only the former: any body may be pushed.
void bearPushes(const ModuleWork& work, const Iteration& iteration, const SolverContext& own);
void bearPushesOf(const ModuleWork& work, const Iteration& iteration, const SolverContext& own, std::size_t group);
/// An impulse on a body is one that may be: not between substeps, or on what was named. Counts those that are not.
bool mayPush(ModuleWork& work, std::uint32_t body);
/// The region that the moving bodies of a group lie in; kNone where that is not one, 0 where none of its bodies moves.
std::uint32_t regionOfGroup(const ModuleWork& work, const Bodies& bodies, const ConstraintGraph& graph,
                            std::size_t group);
/// Makes the moving bodies of each group one island, for what is dealt out to regions.
void uniteNamed(const ModuleWork& work, const Bodies& bodies, Islands& islands);

}  // namespace ragtop
