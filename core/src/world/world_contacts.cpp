#include <algorithm>
#include <cmath>

#include "constraints/lane_view.h"
#include "world/world_impl.h"

namespace ragtop {

void WorldImpl::recordGraphChange(GraphPlace place) { islands.graphChangedAt(place.color == ConstraintGraph::kDirect); }

void WorldImpl::addToGraph(std::uint32_t index) {
    ManifoldRecord& manifold = manifolds[index];
    const ContactRecord& record = contacts[manifold.contact];
    if (manifold.place.color != kNone || manifold.pointCount == 0 || record.sensor) return;
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    const ManifoldImpulses impulses = manifolds.impulsesOf(manifold, graph, lastSubstep);
    const bool direct = bodies.isDirect(record.bodyA) || bodies.isDirect(record.bodyB);
    manifold.place = graph.insertContact(index, bodies[record.bodyA].state, bodies.moves(record.bodyA),
                                         bodies[record.bodyB].state, bodies.moves(record.bodyB),
                                         direct ? ConstraintGraph::By::direct : ConstraintGraph::By::iteration);
    recordGraphChange(manifold.place);
    contactWriter().writeLane(record, manifold, impulses);
    if (record.manifoldCapacity == 1) manifolds.forgetStored(manifold);
}

void WorldImpl::removeFromGraph(std::uint32_t index) {
    ManifoldRecord& manifold = manifolds[index];
    if (manifold.place.color == kNone) return;
    const ContactRecord& record = contacts[manifold.contact];
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    if (manifold.pointCount > 0) manifolds.store(manifold, manifolds.impulsesOf(manifold, graph, lastSubstep));
    const std::uint32_t moved =
        graph.removeContact(manifold.place, bodies[record.bodyA].state, bodies.moves(record.bodyA),
                            bodies[record.bodyB].state, bodies.moves(record.bodyB));
    if (moved != kNone) manifolds[moved].place.slot = manifold.place.slot;
    recordGraphChange(manifold.place);
    manifold.place = {};
    manifolds.touches[index] = manifold.pointCount > 0 ? kUnknownTouch : 0;
    contacts[manifold.contact].until = 0;
}

}  // namespace ragtop
