#pragma once

#include <cstddef>
#include <cstdint>

#include "base/prefetch.h"
#include "world/world_impl.h"

namespace ragtop {

/// Calls visit(manifold's index, manifold, contact) for the contacts of a list of the graph. Records and bodies of those
/// that follow each other there lie anywhere: they are asked for some places ahead, each when what leads to it has come.
template <class Visit>
void forContactsOf(const WorldImpl& world, const AlignedArray<std::uint32_t>& list, Visit&& visit) {
    constexpr std::size_t kManifold = 24, kContact = 16, kBodies = 8;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (i + kManifold < list.size()) {
            const ManifoldRecord& manifold = world.manifolds[list[i + kManifold]];
            prefetch(&manifold.pointCount);
            prefetch(&manifold.separation);
            prefetch(&manifold.contact);
        }
        if (i + kContact < list.size()) prefetch(&world.contacts[world.manifolds[list[i + kContact]].contact]);
        if (i + kBodies < list.size()) {
            const ContactRecord& contact = world.contacts[world.manifolds[list[i + kBodies]].contact];
            for (const std::uint32_t body : {contact.bodyA, contact.bodyB}) {
                prefetch(&world.bodies[body].type);
                prefetch(&world.bodies[body].mass);
            }
        }
        const ManifoldRecord& manifold = world.manifolds[list[i]];
        visit(list[i], manifold, world.contacts[manifold.contact]);
    }
}

}  // namespace ragtop
