#pragma once

#include "world/world_impl.h"

/// Islands that have nothing to do with each other, side by side (docs/adr/0006).
namespace ragtop {

/// Deals islands out to regions where that pays, or mends what has changed about them.
void divideIntoRegions(WorldImpl& world);
/// What belongs to each region in this step, and whether they go through its substeps alone.
void collectRegions(WorldImpl& world);

/// Calls contact(manifold), then joint(joint), for all that is in the graph, in an order that depends on the scene
/// alone.
template <class Contact, class Joint>
void forEachInGraph(const WorldImpl& world, Contact&& contact, Joint&& joint) {
    for (const std::uint32_t index : world.awakeContacts) {
        const ContactRecord& record = world.contacts[index];
        if (record.firstManifold == kNone) continue;
        for (std::uint32_t k = record.firstManifold; k < record.firstManifold + record.manifoldCapacity; ++k)
            if (world.manifolds[k].place.color != kNone) contact(k);
    }
    for (std::uint32_t j = 0; j < world.jointSlots.count(); ++j)
        if (world.jointSlots.isUsed(j) && world.joints[j].place.color != kNone) joint(j);
}

}  // namespace ragtop
