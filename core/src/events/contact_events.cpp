#include "events/contact_events.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/nonzero_bytes.h"
#include "constraints/lane_view.h"
#include "contacts/tuning.h"

namespace ragtop {

namespace {

LaneReader reader(const ConstraintGraph& graph, const ManifoldRecord& manifold) {
    return {graph.lane(manifold.place), graph.lanes()};
}

/// Does a point overlap, or did it carry load in this step?
bool isLoaded(const ConstraintGraph& graph, const ManifoldRecord& manifold) {
    if (manifold.place.color == kNone) {
        for (int j = 0; j < manifold.pointCount; ++j)
            if (manifold.separation[j] <= 0) return true;
        return false;
    }
    const LaneReader lane = reader(graph, manifold);
    for (int j = 0; j < manifold.pointCount; ++j)
        if (lane.at(j, contact::kSeparation) <= 0 || lane.at(j, contact::kPeak) > 0) return true;
    return false;
}

/// Threads may say so of one contact at once.
void markDirty(const ContactEvents& v, std::uint32_t contact) {
    const std::uint32_t place = v.contacts[contact].awakeIndex;
    if (place != kNone) std::atomic_ref(v.contactFinds.change[place]).store(1, std::memory_order_relaxed);
}

/// What the lanes of some bundles say of their manifolds. Contacts of which they say the same as in the step before
/// touch as they did.
void takeTouches(const ContactEvents& v, const ConstraintGraph::Color& color, std::size_t perBundle, int begin,
                 int end) {
    const auto lanes = static_cast<std::size_t>(v.graph.lanes());
    v.kernels.readTouches(color.bundles.data(), begin, end, v.contactFinds.laneTouches.data());
    for (auto bundle = static_cast<std::size_t>(begin); bundle < static_cast<std::size_t>(end); ++bundle)
        for (std::size_t lane = 0; lane < perBundle && bundle * perBundle + lane < color.manifolds.size(); ++lane) {
            const std::uint32_t manifold = color.manifolds[bundle * perBundle + lane];
            const std::uint8_t touch = v.contactFinds.laneTouches[bundle * lanes + lane];
            std::uint8_t& known = v.manifolds.touches[manifold];
            if (known == touch && touch != kUnknownTouch) continue;
            known = touch;
            markDirty(v, v.manifolds[manifold].contact);
        }
}

/// What the lanes say of all manifolds in the v.graph.
void findTouches(const ContactEvents& v, StageRunner& runner) {
    const auto lanes = static_cast<std::size_t>(v.graph.lanes());
    v.graph.forUsedLists([&](int c) {
        if (c == ConstraintGraph::kFrozen || v.graph.color(c).manifolds.empty()) return;
        const std::size_t perBundle = ConstraintGraph::isSerial(c) ? 1 : lanes;
        v.contactFinds.laneTouches.resizeForOverwrite(static_cast<std::size_t>(v.graph.bundleCount(c)) * lanes);
        runner.parallelFor(v.graph.bundleCount(c), 32,
                           [&](int begin, int end, int) { takeTouches(v, v.graph.color(c), perBundle, begin, end); });
    });
}

/// Contacts that may touch otherwise than before: where lanes say otherwise, what came, changed, or was struck in this
/// step or the last. Sensors have no lanes; what tells of motion does so in every step.
void findDirty(const ContactEvents& v, StageRunner& runner) {
    const bool all = v.contactFinds.allDirty || v.contactFinds.motionReported ||
                     v.contactFinds.anySensor.load(std::memory_order_relaxed);
    v.contactFinds.change.resizeForOverwrite(v.contacts.awake.size());
    std::fill(v.contactFinds.change.begin(), v.contactFinds.change.end(), all ? 1 : 0);
    v.contactFinds.allDirty = false;
    findTouches(v, runner);
    for (const ChangedContact changed : v.contactFinds.changed)
        if ((changed.change & kApart) == 0) markDirty(v, changed.contact);
    for (const std::uint32_t contact : v.contactFinds.dirty) markDirty(v, contact);
    for (const SweptImpact& impact : v.sweptBodies.impacts) markDirty(v, impact.contact);
    v.contactFinds.dirty.clear();
}

/// A manifold found some steps ago, where its anchors are now.
PlacedManifold placed(const Bodies& bodies, const ContactRecord& record, const ManifoldRecord& manifold) {
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Vec3 offset = relative(b.center, a.center);
    // A A has no reference point of its own: anchors are then from the centre of B.
    const Vec3 reference = a.state == 0 ? offset : Vec3{};
    PlacedManifold now;
    now.normal = rotate(a.rotation, manifold.normal);
    now.offset = a.state == 0 ? Vec3{} : offset;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const Vec3 onA = rotate(a.rotation, manifold.anchorA[j]) - reference;
        const Vec3 onB = rotate(b.rotation, manifold.anchorB[j]) + now.offset;
        now.anchor[j] = 0.5f * (onA + onB);
        now.separation[j] = manifold.separation[j] + dot(now.normal, onB - onA);
    }
    return now;
}

}  // namespace

void forgetTouches(Manifolds& manifolds, ContactFinds& finds) {
    finds.allDirty = true;
    manifolds.touches.resizeForOverwrite(manifolds.size());
    for (std::size_t i = 0; i < manifolds.size(); ++i)
        manifolds.touches[i] = manifolds[i].place.color == ConstraintGraph::kFrozen ? kFrozenTouch
                               : manifolds[i].pointCount > 0                        ? kUnknownTouch
                                                                                    : 0;
}

void ContactEvents::publish(StageRunner& runner) const {
    findDirty(*this, runner);
    runner.parallelFor(static_cast<int>(contacts.awake.size()), 256, [&](int begin, int end, int) {
        std::uint8_t* doubtful = contactFinds.change.data() + begin;
        const std::uint32_t* awake = contacts.awake.data() + begin;
        forEachNonzero(doubtful, static_cast<std::size_t>(end - begin), [&](std::size_t i) {
            ContactRecord& record = contacts[awake[i]];
            const bool touching = (record.hasPoints || record.struck) && isTouching(record);
            doubtful[i] = touching != record.touching || (touching && record.reportsMotion) ? 1 : 0;
        });
    });
    forEachNonzero(contactFinds.change.data(), contacts.awake.size(),
                   [&](std::size_t i) { publishContact(contacts.awake[i]); });
    publishSweptImpacts();
}

/// Does a contact touch after the step? Notes whether it bears a load.
bool ContactEvents::isTouching(ContactRecord& record) const {
    bool touching = record.struck;
    for (std::uint32_t k = 0; record.hasPoints && k < record.manifoldCapacity; ++k) {
        const std::uint8_t touch = manifolds.touches[record.firstManifold + k];
        if (touch == kFrozenTouch) return record.touching;
        const bool unknown = touch == kUnknownTouch || record.sensor;
        touching |= unknown ? isLoaded(graph, manifolds[record.firstManifold + k]) : (touch & kTouches) != 0;
        const bool bears = !unknown && (touch & kBearsLoad) != 0;
        if (k == 0 && record.bearsLoad != bears) record.bearsLoad = bears;
    }
    return touching;
}

/// Impacts that continuous collision has played are over; the next step may find nothing of them.
void ContactEvents::publishSweptImpacts() const {
    for (const SweptImpact& impact : sweptBodies.impacts) {
        ContactRecord& record = contacts[impact.contact];
        record.struck = false;
        contactFinds.dirty.push(impact.contact);
        if (!record.reportsMotion || impact.speed <= restitutionSpeed) continue;
        SurfaceEvent event;
        event.kind = SurfaceEvent::Kind::impact;
        event.shapeA = shapes.id(record.shapeA), event.shapeB = shapes.id(record.shapeB);
        event.bodyA = bodies.id(record.bodyA), event.bodyB = bodies.id(record.bodyB);
        event.surfaceA = shapes.materialAt(shapes[record.shapeA], impact.triangle).surface;
        event.surfaceB = shapes[record.shapeB].material.surface;
        event.point = impact.point;
        event.normal = impact.normal;
        event.speed = impact.speed;
        event.impulse = impact.impulse;
        events.surface(event);
    }
}

void ContactEvents::publishContact(std::uint32_t index) const {
    ContactRecord& record = contacts[index];
    for (const ManifoldRecord& manifold : manifolds.of(record))
        if (manifold.place.color == ConstraintGraph::kFrozen) return;
    bool touching = record.struck;
    unsigned loadedNow = 0, bit = 1;
    for (const ManifoldRecord& manifold : manifolds.of(record)) {
        const bool loaded = isLoaded(graph, manifold);
        touching |= loaded;
        if (loaded && record.reportsMotion && manifold.place.color != kNone)
            publishSurface(record, manifold, (record.loaded & bit) != 0);
        if (loaded && record.reportsMotion) loadedNow |= bit;
        bit <<= 1;
    }
    record.loaded = static_cast<std::uint8_t>(loadedNow);
    if (touching == record.touching) return;
    const ContactEvent event{shapes.id(record.shapeA), shapes.id(record.shapeB), bodies.id(record.bodyA),
                             bodies.id(record.bodyB)};
    if (touching)
        events.begin(event, record.sensor);
    else
        events.end(event, record.sensor);
    record.touching = touching;
}

void ContactEvents::publishSurface(const ContactRecord& record, const ManifoldRecord& manifold, bool wasLoaded) const {
    const LaneReader lane = reader(graph, manifold);
    SurfaceEvent event;
    float approach = 0;
    for (int j = 0; j < manifold.pointCount; ++j) {
        event.impulse += lane.at(j, contact::kPeak);
        if (lane.at(j, contact::kPeak) > 0 && lane.at(contact::kApproach + j) < approach)
            approach = lane.at(contact::kApproach + j);
    }
    if (event.impulse <= 0) return;
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Vec3 rA = lane.vector(contact::kCenter), rB = rA - lane.vector(contact::kOffset);
    const BodyState &stateA = bodies.states[a.state], &stateB = bodies.states[b.state];
    const Vec3 velocityA = stateA.v + cross(stateA.w, rA), velocityB = stateB.v + cross(stateB.w, rB);
    const Vec3 slip = velocityB - velocityA + lane.vector(contact::kSurface);
    const Vec3 normal = lane.vector(contact::kNormal);
    const Vec3 tangential = slip - dot(slip, normal) * normal;
    const float size = lane.at(contact::kSize);
    const float slowest = tuning::kSlideSpeed * std::sqrt(gravity * size);
    event.shapeA = shapes.id(record.shapeA), event.shapeB = shapes.id(record.shapeB);
    event.bodyA = bodies.id(record.bodyA), event.bodyB = bodies.id(record.bodyB);
    event.surfaceA = shapes.materialAt(shapes[record.shapeA], manifold.triangle).surface;
    event.surfaceB = shapes[record.shapeB].material.surface;
    event.point = (a.state == 0 ? b.center : a.center) + rA;
    event.normal = normal;
    // An impact is over in the step that it begins in; what it leaves for the next is no other one.
    if (approach < -restitutionSpeed && !wasLoaded) {
        event.kind = SurfaceEvent::Kind::impact;
        event.speed = -approach;
        events.surface(event);
    }
    event.speed = length(tangential);
    event.kind = SurfaceEvent::Kind::slide;
    if (event.speed <= slowest) {
        // Rolling: the surfaces stick, but the contact point travels over them.
        const Vec3 travel = 0.5f * (stateA.v + stateB.v) - 0.5f * (velocityA + velocityB);
        event.speed = length(travel - dot(travel, normal) * normal) * 2;
        event.kind = SurfaceEvent::Kind::roll;
    }
    if (event.speed > slowest) events.surface(event);
}

Contact describe(const ConstTables& tables, float lastSubstep, const ContactRecord& record,
                 const ManifoldRecord& manifold) {
    const Bodies& bodies = tables.bodies;
    const Shapes& shapes = tables.shapes;
    Contact result;
    result.shapeA = shapes.id(record.shapeA), result.shapeB = shapes.id(record.shapeB);
    result.bodyA = bodies.id(record.bodyA), result.bodyB = bodies.id(record.bodyB);
    const PlacedManifold now = placed(bodies, record, manifold);
    result.normal = now.normal;
    result.pointCount = manifold.pointCount;
    const ManifoldImpulses impulses = tables.manifolds.impulsesOf(manifold, tables.graph, lastSubstep);
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const float rate = lastSubstep > 0 ? 1 / lastSubstep : 0;
    for (int j = 0; j < manifold.pointCount; ++j) {
        ContactPoint& point = result.points[j];
        point.point = (a.state == 0 ? b.center : a.center) + now.anchor[j];
        point.separation = now.separation[j];
        point.impulse = impulses.impulse[j];
        result.normalForce += rate * point.impulse;
    }
    result.frictionForce = rate * impulses.frictionImpulse;
    return result;
}

}  // namespace ragtop
