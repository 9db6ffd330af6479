#pragma once

#include "world/world_impl.h"

/// Islands that have nothing to do with each other, side by side (docs/adr/0006).
namespace ragtop {

/// Deals islands out to regions where that pays, or mends what has changed about them.
void divideIntoRegions(WorldImpl& world);
/// What belongs to each region in this step, and whether they go through its substeps alone.
void collectRegions(WorldImpl& world);

}  // namespace ragtop
