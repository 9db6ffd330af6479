#pragma once

#include "activity/activity.h"

/// What is outside the core and takes part in steps (docs/adr/0048).
namespace ragtop {

class World;

/// Asks modules what they look at in this step, wakes that, and groups them.
void askModules(ModuleWork& work, const Activity& activity, StageRunner& runner, const World& face, double dt);
/// Between two substeps of h seconds: all modules, those of different groups side by side.
void actBetweenSubsteps(ModuleWork& work, StageRunner& runner, World& face, float h);
/// Those of one group.
void actAsGroup(const ModuleWork& work, World& face, std::size_t group, float h);
/// An impulse on a body is one that may be: not between substeps, or on what was named. Counts those that are not.
bool mayPush(ModuleWork& work, std::uint32_t body);
/// The region that the moving bodies of a group lie in; kNone where that is not one, 0 where none of its bodies moves.
std::uint32_t regionOfGroup(const ModuleWork& work, const Bodies& bodies, const ConstraintGraph& graph,
                            std::size_t group);
/// Makes the moving bodies of each group one island, for what is dealt out to regions.
void uniteNamed(const ModuleWork& work, const Bodies& bodies, Islands& islands);

}  // namespace ragtop
