#pragma once

#include "activity/activity.h"
#include "iteration/regions.h"
#include "ragtop/settings.h"

/// Islands that have nothing to do with each other, side by side (docs/adr/0006).
namespace ragtop {

/// What dealing islands out to regions reads and writes.
struct RegionView {
    ConstTables tables;
    const Bodies& bodies;
    const Contacts& contacts;
    Manifolds& manifolds;  ///< places of constraints
    Joints& joints;
    const Couplings& couplings;
    ConstraintGraph& graph;
    Islands& islands;
    const Articulations& articulations;
    const DirectSet& directSet;
    const ModuleWork& moduleWork;
    const Freezing& freezing;
    const ContactFinds& contactFinds;
    Regions& regions;
    const WorldSettings& settings;
    bool bouncy;  ///< does any contact of this step have restitution?
    int workers;
};

/// Deals islands out to regions where that pays, or mends what has changed about them.
void divideIntoRegions(const RegionView& view);
/// What belongs to each region in this step, and whether they go through its substeps alone.
void collectRegions(const RegionView& view);

}  // namespace ragtop
