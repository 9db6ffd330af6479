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

/// How far each body may go in the coming step.
void WorldImpl::lookAhead() {
    runner.parallelFor(static_cast<int>(bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            const std::uint32_t body = bodies.awake[static_cast<std::size_t>(i)];
            const BodyState& state = bodies.states[body];
            bodies[body].ahead = (length(state.v) + length(state.w) * bodies[body].coreRadius) * dt;
        }
    });
}

namespace {

/// Contacts that are asked whether they stay as they are before those that do not are collided.
constexpr int kAskedAtOnce = 32;

struct AskedContacts {
    std::uint32_t moving[kAskedAtOnce];  ///< that may have come nearer, or moved against each other
    std::uint32_t open[kAskedAtOnce];    ///< that stay, and may be ghosts or have other surfaces
    int movingCount = 0, openCount = 0;
};

/// A gap that what both bodies have travelled since it was found, and may travel now, cannot have closed needs no other
/// look while bounds stay as they are; nor do manifolds that have not moved far. Without branches, since nobody
/// foresees them.
bool keepsGeometry(const ContactRecord& record, const BodyRecord& a, const BodyRecord& b, bool sameSubstep) {
    const double travel = a.travel + b.travel, ahead = static_cast<double>(a.ahead) + static_cast<double>(b.ahead);
    const double way = record.hasPoints ? travel : travel + ahead;
    const bool inTime = ahead < static_cast<double>(record.aheadMost), near = way < record.until;
    const bool mayKeep = !record.hasPoints || (inTime & sameSubstep);
    return near & mayKeep & economy.manifoldReuse;
}

bool stays(const ContactRecord& record, const BodyRecord& a, const BodyRecord& b, bool sameSubstep) {
    const bool refitted = a.refitted | b.refitted, keeps = keepsGeometry(record, a, b, sameSubstep);
    return keeps & !refitted;
}

/// Asks some contacts whether they stay as they are, and for the memory of what is asked some places later. Which stay
/// nobody foresees: all are written, and kept or not.
void askSome(WorldImpl& world, int begin, int end, int last, AskedContacts& asked) {
    constexpr int kRecord = 32, kRest = 16;  // places ahead, by trial
    const auto records = world.contacts.records().view();
    const std::uint32_t* awake = world.contacts.awake.data();
    const BodyRecord* of = &world.bodies[0];
    const bool allOpen = world.contactFinds.surfacesForgotten || world.callbacks.modify;
    const bool sameSubstep = world.lastSubstep == world.context.h;
    int moving = 0, open = 0;
    for (int i = begin; i < end; ++i) {
        if (i + kRecord < last) prefetch(&records[awake[i + kRecord]]);
        if (i + kRest < last) {
            const ContactRecord& next = records[awake[i + kRest]];
            prefetch(&of[next.bodyA]);
            prefetch(&of[next.bodyB]);
        }
        const ContactRecord& record = records[awake[i]];
        const bool stay = stays(record, of[record.bodyA], of[record.bodyB], sameSubstep);
        asked.moving[moving] = asked.open[open] = awake[i];
        moving += stay ? 0 : 1;
        // What bears a load is no ghost.
        const bool loaded = record.bearsLoad, looked = loaded ? record.surfaceOpen | allOpen : true;
        open += (stay & record.hasPoints & looked) ? 1 : 0;
    }
    asked.movingCount = moving, asked.openCount = open;
}

}  // namespace

/// Contacts come and go in any order, and records are found faster in that of memory. Seldom: a few in disorder do
/// little.
void WorldImpl::sortAwakeContacts() {
    constexpr std::uint64_t kSteps = 64;  // between two sorts, a second at 60 Hz
    if (stepCount % kSteps != 0) return;
    std::sort(contacts.awake.begin(), contacts.awake.end());
    for (std::size_t i = 0; i < contacts.awake.size(); ++i)
        contacts[contacts.awake[i]].awakeIndex = static_cast<std::uint32_t>(i);
}

/// Asks for what colliding a pair will read.
void WorldImpl::prefetchCollision(const ContactRecord& record) const {
    constexpr std::size_t kLine = 64;  // bytes, of a cache
    prefetch(&shapes[record.shapeA]);
    prefetch(&shapes[record.shapeB]);
    if (!record.hasPoints) return;
    const auto* manifold = reinterpret_cast<const char*>(&manifolds[record.firstManifold]);
    for (std::size_t line = 0; line < sizeof(ManifoldRecord); line += kLine) prefetch(manifold + line);
}

/// Asks for what the shapes of a pair lead to, once these are there.
void WorldImpl::prefetchShapes(const ContactRecord& record) const {
    for (const std::uint32_t index : {record.shapeA, record.shapeB}) {
        const ShapeRecord& shape = shapes[index];
        prefetch(&broadphase.tree(shape.isStaticTree).bounds(shape.proxy));
        prefetch(&shapes.geometries[shape.geometry].convex);
    }
    prefetch(&bodies.states[record.bodyA]);
    prefetch(&bodies.states[record.bodyB]);
    if (record.isMesh && record.nearTriangles != kNone) prefetch(&manifolds.meshMemory[record.nearTriangles]);
}

/// What does not stay is collided after the others were asked: until then its memory is on the way.
static void updateSome(WorldImpl& world, int begin, int end, int last, int worker) {
    AskedContacts asked;
    askSome(world, begin, end, last, asked);
    std::memset(&world.contactFinds.change[static_cast<std::size_t>(begin)], kUnchanged,
                static_cast<std::size_t>(end - begin));
    const int count = asked.movingCount;
    for (int k = 0; k < asked.openCount; ++k) {
        const ManifoldRecord& manifold = world.manifolds[world.contacts[asked.open[k]].firstManifold];
        prefetch(&manifold.pointCount);
        prefetch(&manifold.separation);
    }
    for (int k = 0; k < count; ++k) world.prefetchCollision(world.contacts[asked.moving[k]]);
    for (int k = 0; k < asked.openCount; ++k) {
        ContactRecord& record = world.contacts[asked.open[k]];
        world.contactFinds.change[record.awakeIndex] = world.keepManifolds(record);
    }
    constexpr int kFour = 4, kNext = 2 * kFour;  // lanes of FourFloats; two groups ahead
    for (int k = 0; k < count && k < kNext; ++k) world.prefetchShapes(world.contacts[asked.moving[k]]);
    for (int first = 0; first < count; first += kFour) {
        const int past = std::min(first + kFour, count);
        for (int k = first + kNext; k < past + kNext && k < count; ++k)
            world.prefetchShapes(world.contacts[asked.moving[k]]);
        union Unfilled {
            Unfilled() {}
            PairPlace at[kFour];
        } places;
        world.placePairs(asked.moving + first, past - first, places.at);
        for (int k = first; k < past; ++k) world.updateContact(asked.moving[k], places.at[k - first], worker);
    }
}

void WorldImpl::updateContacts() {
    if (orderContacts({bodies, contacts, manifolds, broadphase.pairs, graph}, stageMemory)) {
        forgetTouches();
        directSet.grouped = false;
    }
    sortAwakeContacts();
    const int count = static_cast<int>(contacts.awake.size());
    contactFinds.change.resizeForOverwrite(contacts.awake.size());
    contactFinds.anySensor.store(false, std::memory_order_relaxed);
    lookAhead();
    manifolds.makeRoomToHold();
    runner.parallelFor(count, kAskedAtOnce, [&](int begin, int end, int worker) {
        for (int i = begin; i < end; i += kAskedAtOnce)
            updateSome(*this, i, i + kAskedAtOnce < end ? i + kAskedAtOnce : end, end, worker);
    });
    contactFinds.surfacesForgotten = false;
}

/// What sensors overlap where the bodies are at the end of the step. Their manifolds carry no impulses and need no
/// place.
void WorldImpl::updateSensors() {
    if (!contactFinds.anySensor.load(std::memory_order_relaxed)) return;
    runner.parallelFor(static_cast<int>(contacts.awake.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            ContactRecord& record = contacts[contacts.awake[static_cast<std::size_t>(i)]];
            if (!record.sensor) continue;
            Manifold found[kMaxManifolds];
            const int count = findManifolds(record, shapeBInA(record), 0, found);
            record.hasPoints = count > 0;
            ManifoldRecord& manifold = manifolds[record.firstManifold];
            manifold.pointCount = count > 0 ? 1 : 0;
            manifold.separation[0] = count > 0 ? found[0].points[0].separation : 0;
        }
    });
}

/// Contacts are found early enough that the motion of the step cannot pass them.
void WorldImpl::updateContact(std::uint32_t index, const PairPlace& place, int worker) {
    ContactRecord& record = contacts[index];
    std::uint8_t& change = contactFinds.change[record.awakeIndex];
    change = kUnchanged;
    const double travel = bodies[record.bodyA].travel + bodies[record.bodyB].travel;
    const ShapeRecord &shapeA = shapes[record.shapeA], &shapeB = shapes[record.shapeB];
    if (!overlaps(broadphase.tree(shapeA.isStaticTree).bounds(shapeA.proxy),
                  broadphase.tree(shapeB.isStaticTree).bounds(shapeB.proxy))) {
        change = record.hasPoints && !record.sensor && holds(record) ? kApart | kPoints : kApart;
        return;
    }
    if (record.sensor) {
        contactFinds.anySensor.store(true, std::memory_order_relaxed);
        return;
    }
    if (keepsGeometry(record, bodies[record.bodyA], bodies[record.bodyB], lastSubstep == context.h)) {
        change = keepManifolds(record);
        return;
    }
    change = economy.manifoldReuse && reuseManifolds(record, place, travel)
                 ? keepManifolds(record)
                 : collideAnew(record, place, travel, worker);
}

/// Manifolds that are kept are brought to where the bodies are when constraints are prepared.
std::uint8_t WorldImpl::keepManifolds(ContactRecord& record) {
    if (!record.hasPoints) return kUnchanged;
    refreshSurfaces(record);
    return !record.bearsLoad && mayBeGhost(ghostView(), record, manifolds[record.firstManifold]) ? kCloses : kUnchanged;
}

std::uint8_t WorldImpl::collideAnew(ContactRecord& record, const PairPlace& place, double travel, int worker) {
    record.collidedMargin = place.margin;
    union Unfilled {  // with zeros: most pairs touch in one direction, if any
        Unfilled() {}
        Manifold manifolds[kMaxManifolds];
    } room;
    std::construct_at(room.manifolds);
    const int all = place.touch.single
                        ? takeTouch(place.touch, place.margin, room.manifolds[0])
                        : findManifolds(record, place.bInA, place.margin, {room.manifolds, record.manifoldCapacity});
    const int count = keepUnyielding(bodies, shapes, record, place.bInA, tuning::kSpeculative * record.size, dt,
                                     {room.manifolds, static_cast<std::size_t>(all)});
    const std::span<const Manifold> found(room.manifolds, static_cast<std::size_t>(count));
    const bool first = record.firstManifold == kNone;
    unsigned change = kUnchanged;
    if (!first)
        change = record.isMesh && meetAsSurfaces(record) ? takeSurfaceManifolds(record, found)
                                                         : takeManifolds(record, found);
    if (!first && (bodies[record.bodyA].frozen || bodies[record.bodyB].frozen)) change |= kGraph;
    if (count == 0) {
        record.until = travel + static_cast<double>(room.manifolds[0].gap - tuning::kSpeculative * record.size);
        return static_cast<std::uint8_t>(change);
    }
    if (first) change = holds(record) ? kGraph | kFound | kPoints : kGraph | kFound;
    ManifoldRecord& manifold = first ? takeFirstManifolds(record, found, worker) : manifolds[record.firstManifold];
    manifold.collidedAt = place.bInA;
    record.until = 0;
    if (!turnsUnderContact(record))
        record.until = travel + static_cast<double>(tuning::kReuse * record.size / place.perTravel);
    record.aheadMost = place.margin + (tuning::kReuse - tuning::kSpeculative) * record.size;
    if (mayBeGhost(ghostView(), record, manifold)) change |= kCloses;
    return static_cast<std::uint8_t>(change);
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
            if (!record.hasPoints || !holds(record)) continue;
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
