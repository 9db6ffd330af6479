// Contacts that come, go, or change.

#include <utility>

#include "activity/activity.h"
#include "base/nonzero_bytes.h"
#include "constraints/lane_view.h"
#include "contacts/find_manifolds.h"
#include "model/edge_list.h"

namespace ragtop {

void Activity::createContact(std::uint32_t a, std::uint32_t b) const {
    // A mesh comes first, and of meshes one that does not move, as height fields; else a body that moves, because the
    // narrow phase works in A's frame near its centre.
    const bool meshA = shapes.geometries[shapes[a].geometry].isMesh(),
               meshB = shapes.geometries[shapes[b].geometry].isMesh();
    const bool movesA = bodies.moves(shapes[a].body), movesB = bodies.moves(shapes[b].body);
    const bool swap = meshA != meshB ? meshB : meshA && movesA != movesB ? movesA : movesA != movesB ? movesB : b < a;
    if (swap) std::swap(a, b);
    const ShapeRecord &shapeA = shapes[a], &shapeB = shapes[b];
    const std::uint32_t index = contacts.acquire();
    ContactRecord& contact = contacts[index];
    contact.shapeA = a;
    contact.shapeB = b;
    contact.bodyA = shapeA.body;
    contact.bodyB = shapeB.body;
    contact.size = shapeA.size < shapeB.size ? shapeA.size : shapeB.size;
    contact.isMesh = meshA || meshB;
    contact.sensor = shapeA.sensor || shapeB.sensor;
    contact.reportsMotion = shapeA.reportsMotion || shapeB.reportsMotion;
    contact.manifoldCapacity = contact.isMesh ? kMaxManifolds : 1;
    if (contact.isMesh) {
        const bool walks = shapes.geometries[shapeA.geometry].mesh && !meetAsSurfaces(bodies, shapes, contact);
        contact.nearTriangles = walks ? manifolds.meshMemory.acquire() : kNone;
    }
    if (contact.sensor) {  // what it overlaps is told at the end of a step, when nothing may grow
        contact.firstManifold = manifolds.acquire(contact.manifoldCapacity);
        for (ManifoldRecord& manifold : manifolds.of(contact)) manifold = {}, manifold.contact = index;
    }
    link(contacts.links, bodies[contact.bodyA].firstContact, 2 * index);
    link(contacts.links, bodies[contact.bodyB].firstContact, 2 * index + 1);
    broadphase.pairs.insert(pairKey(a, b), index);
    if (bodies.isAwake(contact.bodyA) || bodies.isAwake(contact.bodyB)) addAwakeContact(index);
}

void Activity::destroyContact(std::uint32_t index) const {
    ContactRecord& contact = contacts[index];
    Manifolds::forEach(contact, [&](std::uint32_t manifold) {
        manifolds[manifold].pointCount = 0;
        removeFromGraph(manifold);
    });
    manifolds.release(contact);
    if (contact.isMesh && contact.nearTriangles != kNone) manifolds.meshMemory.release(contact.nearTriangles);
    if (contact.awakeIndex != kNone) contacts.removeAwake(index);
    if (contact.touching) {
        events.end(
            {shapes.id(contact.shapeA), shapes.id(contact.shapeB), bodies.id(contact.bodyA), bodies.id(contact.bodyB)},
            contact.sensor);
    }
    unlink(contacts.links, bodies[contact.bodyA].firstContact, 2 * index);
    unlink(contacts.links, bodies[contact.bodyB].firstContact, 2 * index + 1);
    broadphase.pairs.erase(pairKey(contact.shapeA, contact.shapeB));
    contacts.release(index);
}

void Activity::addAwakeContact(std::uint32_t index) const {
    contacts.addAwake(index);
    if (contacts[index].sensor) contactFinds.anySensor.store(true, std::memory_order_relaxed);
    contactFinds.closing.push(index);
    contactFinds.dirty.push(index);
}

void Activity::applyContactChanges(const GhostView& ghosts, bool mayStore) const {
    contactFinds.changed.clear();
    contactFinds.closing.clear();
    contactFinds.shiftedBodies.clear();
    static_assert(kUnchanged == 0);
    forEachNonzero(contactFinds.change.data(), contacts.awake.size(), [&](std::size_t i) {
        const std::uint8_t change = contactFinds.change[i];
        if ((change & kFound) != 0) manifolds.settle(contacts[contacts.awake[i]], contacts.awake[i]);
        if ((change & kCloses) != 0) contactFinds.closing.push(contacts.awake[i]);
        if ((change & kPoints) != 0) {
            const ContactRecord& record = contacts[contacts.awake[i]];
            contactFinds.shiftedBodies.push(bodies.moves(record.bodyA) ? record.bodyA : record.bodyB);
        }
        if ((change & (kApart | kGraph)) != 0) contactFinds.changed.push({contacts.awake[i], change});
    });
    graph.expectContacts(contactFinds.changed.size());
    for (const ChangedContact changed : contactFinds.changed) {
        if ((changed.change & kApart) != 0)
            destroyContact(changed.contact);
        else
            applyContactChange(changed.contact, ghosts);
    }
    graph.expectContacts(0);
    recordShiftedLoads();
    // All may fall asleep at once, when nothing may grow.
    if (mayStore) manifolds.makeRoomToStore();
}

/// Where points that hold a body came or went, all that hold it find their loads anew.
void Activity::recordShiftedLoads() const {
    for (const std::uint32_t body : contactFinds.shiftedBodies)
        for (std::uint32_t key = bodies[body].firstContact; key != kNone; key = contacts.next(key)) {
            const ContactRecord& record = contacts[key >> 1];
            if (!record.hasPoints || !holds(bodies, record)) continue;
            for (const ManifoldRecord& manifold : manifolds.of(record))
                if (manifold.place.color != kNone &&
                    ConstraintGraph::isIterated(static_cast<int>(manifold.place.color)))
                    LaneView(graph.lane(manifold.place), graph.lanes()).at(contact::kShifted) = 1;
        }
}

/// Puts the manifolds of a contact that have points into the graph and takes those without out of it. A body that
/// sleeps wakes when it is met; until then it takes no part. The contacts of a body that wakes keep the geometry they
/// fell asleep with, which has not changed.
void Activity::applyContactChange(std::uint32_t index, const GhostView& ghosts) const {
    ContactRecord& record = contacts[index];
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    bool meets = false;
    Manifolds::forEach(record, [&](std::uint32_t k) {
        const ManifoldRecord& manifold = manifolds[k];
        if (manifold.pointCount == 0) removeFromGraph(k);
        for (int j = 0; j < manifold.pointCount; ++j) meets |= willMeet(ghosts, record, manifold, j);
    });
    if (!record.hasPoints) return manifolds.release(record);
    const bool sleepsA = bodies.moves(record.bodyA) && !bodies.isAwake(record.bodyA);
    const bool sleepsB = bodies.moves(record.bodyB) && !bodies.isAwake(record.bodyB);
    if ((sleepsA || sleepsB) && !meets) {
        record.until = 0;
        return;
    }
    if (sleepsA) wakeBody(record.bodyA);
    if (sleepsB) wakeBody(record.bodyB);
    Manifolds::forEach(record, [&](std::uint32_t manifold) { addToGraph(manifold); });
}

}  // namespace ragtop
