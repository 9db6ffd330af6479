#pragma once

#include "world/world_impl.h"

/// What is outside the core and takes part in steps (docs/adr/0048).
namespace ragtop {

/// `beforeStep` of all.
void beginModules(WorldImpl& world, World& face, double dt);
/// Asks modules what they look at in this step, wakes that, and groups them.
void askModules(WorldImpl& world, const World& face, double dt);
/// Between two substeps: all modules, those of different groups side by side.
void actBetweenSubsteps(WorldImpl& world, World& face);
/// Those of one group.
void actAsGroup(WorldImpl& world, World& face, std::size_t group);
/// An impulse on a body is one that may be: not between substeps, or on what was named. Counts those that are not.
bool mayPush(WorldImpl& world, std::uint32_t body);
/// The region that the moving bodies of a group lie in; kNone where that is not one, 0 where none of its bodies moves.
std::uint32_t regionOfGroup(const WorldImpl& world, std::size_t group);
/// Makes the moving bodies of each group one island, for what is dealt out to regions.
void uniteNamed(WorldImpl& world);

}  // namespace ragtop
