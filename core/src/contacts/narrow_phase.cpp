#include "contacts/narrow_phase.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "base/economy.h"
#include "base/prefetch.h"
#include "contacts/find_manifolds.h"
#include "contacts/tuning.h"
#include "contacts/yielding_shapes.h"

namespace ragtop {

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
    const double travel = a.travel.done + b.travel.done,
                 ahead = static_cast<double>(a.travel.ahead) + static_cast<double>(b.travel.ahead);
    const double way = record.hasPoints ? travel : travel + ahead;
    const bool inTime = ahead < static_cast<double>(record.aheadMost), near = way < record.until;
    const bool mayKeep = !record.hasPoints || (inTime & sameSubstep);
    return near & mayKeep & economy.manifoldReuse;
}

bool stays(const ContactRecord& record, const BodyRecord& a, const BodyRecord& b, bool sameSubstep) {
    const bool refitted = a.bounds.left | b.bounds.left, keeps = keepsGeometry(record, a, b, sameSubstep);
    return keeps & !refitted;
}

/// Asks some contacts whether they stay as they are, and for the memory of what is asked some places later. Which stay
/// nobody foresees: all are written, and kept or not.
void askSome(NarrowPhase& n, int begin, int end, int last, AskedContacts& asked) {
    constexpr int kRecord = 32, kRest = 16;  // places ahead, by trial
    const auto records = n.contacts.records().view();
    const std::uint32_t* awake = n.contacts.awake.data();
    const BodyRecord* of = &n.bodies[0];
    const bool allOpen = n.writer.surfacesForgotten || n.writer.callbacks.modify;
    const bool sameSubstep = n.writer.sameSubstep();
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

/// How far each body may go in the coming step.
void NarrowPhase::lookAhead(StageRunner& runner) {
    runner.parallelFor(static_cast<int>(bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            const std::uint32_t body = bodies.awake[static_cast<std::size_t>(i)];
            const BodyState& state = bodies.states[body];
            bodies[body].travel.ahead = (length(state.v) + length(state.w) * bodies[body].travel.coreRadius) * dt;
        }
    });
}

/// Asks for what colliding a pair will read.
void NarrowPhase::prefetchCollision(const ContactRecord& record) const {
    constexpr std::size_t kLine = 64;  // bytes, of a cache
    prefetch(&shapes[record.shapeA]);
    prefetch(&shapes[record.shapeB]);
    if (!record.hasPoints) return;
    const auto* manifold = reinterpret_cast<const char*>(&manifolds[record.firstManifold]);
    for (std::size_t line = 0; line < sizeof(ManifoldRecord); line += kLine) prefetch(manifold + line);
}

/// Asks for what the shapes of a pair lead to, once these are there.
void NarrowPhase::prefetchShapes(const ContactRecord& record) const {
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
void NarrowPhase::updateSome(int begin, int end, int last, int worker) {
    AskedContacts asked;
    askSome(*this, begin, end, last, asked);
    std::memset(&contactFinds.change[static_cast<std::size_t>(begin)], kUnchanged,
                static_cast<std::size_t>(end - begin));
    const int count = asked.movingCount;
    for (int k = 0; k < asked.openCount; ++k) {
        const ManifoldRecord& manifold = manifolds[contacts[asked.open[k]].firstManifold];
        prefetch(&manifold.pointCount);
        prefetch(&manifold.separation);
    }
    for (int k = 0; k < count; ++k) prefetchCollision(contacts[asked.moving[k]]);
    for (int k = 0; k < asked.openCount; ++k) {
        ContactRecord& record = contacts[asked.open[k]];
        contactFinds.change[record.awakeIndex] = keepManifolds(record);
    }
    constexpr int kFour = 4, kNext = 2 * kFour;  // lanes of FourFloats; two groups ahead
    for (int k = 0; k < count && k < kNext; ++k) prefetchShapes(contacts[asked.moving[k]]);
    for (int first = 0; first < count; first += kFour) {
        const int past = std::min(first + kFour, count);
        for (int k = first + kNext; k < past + kNext && k < count; ++k) prefetchShapes(contacts[asked.moving[k]]);
        union Unfilled {
            Unfilled() {}
            PairPlace at[kFour];
        } places;
        placePairs(ghosts.tables, dt, asked.moving + first, past - first, places.at);
        for (int k = first; k < past; ++k) updateContact(asked.moving[k], places.at[k - first], worker);
    }
}

void NarrowPhase::collide(StageRunner& runner) {
    const int count = static_cast<int>(contacts.awake.size());
    contactFinds.change.resizeForOverwrite(contacts.awake.size());
    contactFinds.anySensor.store(false, std::memory_order_relaxed);
    lookAhead(runner);
    manifolds.makeRoomToHold();
    runner.parallelFor(count, kAskedAtOnce, [&](int begin, int end, int worker) {
        for (int i = begin; i < end; i += kAskedAtOnce)
            updateSome(i, i + kAskedAtOnce < end ? i + kAskedAtOnce : end, end, worker);
    });
    contactFinds.surfacesForgotten = false;
}

void NarrowPhase::updateContact(std::uint32_t index, const PairPlace& place, int worker) {
    ContactRecord& record = contacts[index];
    std::uint8_t& change = contactFinds.change[record.awakeIndex];
    change = kUnchanged;
    const double travel = bodies[record.bodyA].travel.done + bodies[record.bodyB].travel.done;
    const ShapeRecord &shapeA = shapes[record.shapeA], &shapeB = shapes[record.shapeB];
    if (!overlaps(broadphase.tree(shapeA.isStaticTree).bounds(shapeA.proxy),
                  broadphase.tree(shapeB.isStaticTree).bounds(shapeB.proxy))) {
        change = record.hasPoints && !record.sensor && holds(bodies, record) ? kApart | kPoints : kApart;
        return;
    }
    if (record.sensor) {
        contactFinds.anySensor.store(true, std::memory_order_relaxed);
        return;
    }
    if (keepsGeometry(record, bodies[record.bodyA], bodies[record.bodyB], writer.sameSubstep())) {
        change = keepManifolds(record);
        return;
    }
    change = economy.manifoldReuse && reuseManifolds(record, place, travel)
                 ? keepManifolds(record)
                 : collideAnew(record, place, travel, worker);
}

/// Manifolds that are kept are brought to where the bodies are when constraints are prepared.
std::uint8_t NarrowPhase::keepManifolds(ContactRecord& record) {
    if (!record.hasPoints) return kUnchanged;
    writer.refreshSurfaces(record);
    return !record.bearsLoad && mayBeGhost(ghosts, record, manifolds[record.firstManifold]) ? kCloses : kUnchanged;
}

/// Where a pair has hardly moved since its manifolds were found, they are still right when they move with the bodies:
/// cheaper, and quieter at rest [Catto, Box3D, 2026]. The bound is a share of the size; a turn counts by the arc that
/// it makes at the radius of the smaller body. How much of it is left is noted as what the bodies may travel until this
/// is to be asked again.
bool NarrowPhase::reuseManifolds(ContactRecord& record, const PairPlace& place, double travel) const {
    // Impulses of another substep length are rescaled on their way through the record.
    if (!writer.sameSubstep()) return false;
    const float most = tuning::kReuse * record.size;
    if (!record.hasPoints || turnsUnderContact(shapes, record) || place.margin > record.collidedMargin + most)
        return false;
    const float left = most - place.moved;
    if (left < 0) return false;
    for (const ManifoldRecord& manifold : manifolds.of(record))
        if (manifold.pointCount > 0 && manifold.place.color == kNone) return false;
    record.until = travel + static_cast<double>(left / place.perTravel);
    return true;
}

/// Manifolds without those along which a shape gives way; the first is filled in any case.
int NarrowPhase::findKept(ContactRecord& record, const PairPlace& place, Manifold* found) {
    if (yieldsToAll(shapes, record, place.bInA, place.margin)) return 0;
    const float near = tuning::kReuse * record.size, apart = place.touch.separation;
    const bool isNear = place.touch.single && (apart <= near || apart > place.margin);
    const int count = isNear ? takeTouch(place.touch, place.margin, found[0])
                             : findManifolds({bodies, shapes, manifolds.meshMemory, dt, writer.h}, record, place.bInA,
                                             place.margin, {found, record.manifoldCapacity});
    return keepUnyielding(shapes, record, place.bInA, {found, static_cast<std::size_t>(count)});
}

std::uint8_t NarrowPhase::collideAnew(ContactRecord& record, const PairPlace& place, double travel, int worker) {
    record.collidedMargin = place.margin;
    union Unfilled {  // with zeros: most pairs touch in one direction, if any
        Unfilled() {}
        Manifold manifolds[kMaxManifolds];
    } room;
    std::construct_at(room.manifolds);
    const int count = findKept(record, place, room.manifolds);
    const std::span<const Manifold> found(room.manifolds, static_cast<std::size_t>(count));
    const bool first = record.firstManifold == kNone;
    unsigned change = kUnchanged;
    if (!first)
        change = record.isMesh && meetAsSurfaces(bodies, shapes, record) ? writer.takeSurfaceManifolds(record, found)
                                                                         : writer.takeManifolds(record, found);
    if (!first && (bodies[record.bodyA].frozen || bodies[record.bodyB].frozen)) change |= kGraph;
    if (count == 0) {
        record.until = travel + static_cast<double>(room.manifolds[0].gap - tuning::kSpeculative * record.size);
        return static_cast<std::uint8_t>(change);
    }
    if (first) change = holds(bodies, record) ? kGraph | kFound | kPoints : kGraph | kFound;
    ManifoldRecord& manifold =
        first ? writer.takeFirstManifolds(record, found, worker) : manifolds[record.firstManifold];
    manifold.collidedAt = place.bInA;
    record.until = 0;
    if (!turnsUnderContact(shapes, record))
        record.until = travel + static_cast<double>(tuning::kReuse * record.size / place.perTravel);
    record.aheadMost = place.margin + (tuning::kReuse - tuning::kSpeculative) * record.size;
    if (mayBeGhost(ghosts, record, manifold)) change |= kCloses;
    return static_cast<std::uint8_t>(change);
}

/// The frame of shape B in that of shape A, where the bodies are.
static Frame shapeBInA(const Bodies& bodies, const Shapes& shapes, const ContactRecord& record) {
    const ShapeRecord &shapeA = shapes[record.shapeA], &shapeB = shapes[record.shapeB];
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Vec3 apart = relative(b.center, a.center) + rotate(b.rotation, shapeB.frame.position);
    const Vec3 inA = inverseRotate(a.rotation, apart) - shapeA.frame.position;
    const Quat turn = conjugate(a.rotation) * (b.rotation * shapeB.frame.rotation);
    return {inverseRotate(shapeA.frame.rotation, inA), normalized(conjugate(shapeA.frame.rotation) * turn)};
}

void NarrowPhase::updateSensors(StageRunner& runner) {
    if (!contactFinds.anySensor.load(std::memory_order_relaxed)) return;
    runner.parallelFor(static_cast<int>(contacts.awake.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            ContactRecord& record = contacts[contacts.awake[static_cast<std::size_t>(i)]];
            if (!record.sensor) continue;
            Manifold found[kMaxManifolds];
            const int count = findManifolds({bodies, shapes, manifolds.meshMemory, dt, writer.h}, record,
                                            shapeBInA(bodies, shapes, record), 0, found);
            record.hasPoints = count > 0;
            ManifoldRecord& manifold = manifolds[record.firstManifold];
            manifold.pointCount = count > 0 ? 1 : 0;
            manifold.separation[0] = count > 0 ? found[0].points[0].separation : 0;
        }
    });
}

}  // namespace ragtop
