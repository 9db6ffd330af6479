#pragma once

#include "world/world_impl.h"

/// Direct islands that could not be solved.
namespace ragtop {

/// Iterates over the constraints of an island, one after the other, with the velocities that its bodies have: where a
/// solve failed, those from before it.
void iterateIsland(WorldImpl& world, const DirectIsland& island, WorldImpl::DirectPass pass);
/// Does that from now to the end of the step. Its joints begin without loads: those of taut joints are more than
/// iteration can carry, and throw bodies about that a solve does not hold.
void fallBack(WorldImpl& world, DirectIsland& island, WorldImpl::DirectPass pass);

}  // namespace ragtop
