// What touches: the narrow phase of each awake contact once per step, and what it changes.

#include <algorithm>
#include <cstring>
#include <memory>

#include "base/economy.h"
#include "base/nonzero_bytes.h"
#include "base/prefetch.h"
#include "constraints/lane_view.h"
#include "contacts/contact_order.h"
#include "contacts/yielding_shapes.h"
#include "world/world_impl.h"

namespace ragtop {

/// Contacts come and go in any order, and records are found faster in that of memory. Seldom: a few in disorder do
/// little.
void WorldImpl::sortAwakeContacts() {
    constexpr std::uint64_t kSteps = 64;  // between two sorts, a second at 60 Hz
    if (stepCount % kSteps != 0) return;
    std::sort(contacts.awake.begin(), contacts.awake.end());
    for (std::size_t i = 0; i < contacts.awake.size(); ++i)
        contacts[contacts.awake[i]].awakeIndex = static_cast<std::uint32_t>(i);
}

void WorldImpl::updateContacts() {
    if (orderContacts({bodies, contacts, manifolds, broadphase.pairs, graph}, stageMemory)) {
        forgetTouches(manifolds, contactFinds);
        directSet.grouped = false;
    }
    sortAwakeContacts();
    narrowPhase().collide(runner);
}

/// Contacts that came or went, in the order of the list, so that colours depend on the scene alone.
void WorldImpl::applyContactChanges() {
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
    for (const ChangedContact changed : contactFinds.changed) {
        if ((changed.change & kApart) != 0)
            destroyContact(changed.contact);
        else
            applyContactChange(changed.contact);
    }
    recordShiftedLoads();
    // All may fall asleep at once, when nothing may grow.
    if (settings.sleeping) manifolds.makeRoomToStore();
}

/// Where points that hold a body came or went, all that hold it find their loads anew.
void WorldImpl::recordShiftedLoads() {
    for (const std::uint32_t body : contactFinds.shiftedBodies)
        for (std::uint32_t key = bodies[body].firstContact; key != kNone; key = contacts.next(key)) {
            const ContactRecord& record = contacts[key >> 1];
            if (!record.hasPoints || !holds(bodies, record)) continue;
            for (const ManifoldRecord& manifold : manifolds.of(record))
                if (manifold.place.color != kNone && ConstraintGraph::isIterated(manifold.place))
                    LaneView(graph.lane(manifold.place), graph.lanes()).at(contact::kShifted) = 1;
        }
}

/// Puts the manifolds of a contact that have points into the graph and takes those without out of it. A body that
/// sleeps wakes when it is met; until then it takes no part. The contacts of a body that wakes keep the geometry they
/// fell asleep with, which has not changed.
void WorldImpl::applyContactChange(std::uint32_t index) {
    ContactRecord& record = contacts[index];
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    bool meets = false;
    Manifolds::forEach(record, [&](std::uint32_t k) {
        const ManifoldRecord& manifold = manifolds[k];
        if (manifold.pointCount == 0) removeFromGraph(k);
        for (int j = 0; j < manifold.pointCount; ++j) meets |= willMeet(ghostView(), record, manifold, j);
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
