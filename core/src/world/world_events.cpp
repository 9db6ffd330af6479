#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/nonzero_bytes.h"
#include "constraints/lane_view.h"
#include "world/world_impl.h"

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
void markDirty(WorldImpl& world, std::uint32_t contact) {
    const std::uint32_t place = world.contacts[contact].awakeIndex;
    if (place != kNone) std::atomic_ref(world.contactFinds.change[place]).store(1, std::memory_order_relaxed);
}

/// What the lanes of some bundles say of their manifolds. Contacts of which they say the same as in the step before
/// touch as they did.
void takeTouches(WorldImpl& world, const ConstraintGraph::Color& color, std::size_t perBundle, int begin, int end) {
    const auto lanes = static_cast<std::size_t>(world.graph.lanes());
    world.kernels->readTouches(color.bundles.data(), begin, end, world.contactFinds.laneTouches.data());
    for (auto bundle = static_cast<std::size_t>(begin); bundle < static_cast<std::size_t>(end); ++bundle)
        for (std::size_t lane = 0; lane < perBundle && bundle * perBundle + lane < color.manifolds.size(); ++lane) {
            const std::uint32_t manifold = color.manifolds[bundle * perBundle + lane];
            const std::uint8_t touch = world.contactFinds.laneTouches[bundle * lanes + lane];
            std::uint8_t& known = world.manifolds.touches[manifold];
            if (known == touch && touch != kUnknownTouch) continue;
            known = touch;
            markDirty(world, world.manifolds[manifold].contact);
        }
}

}  // namespace

void WorldImpl::forgetTouches() {
    contactFinds.allDirty = true;
    manifolds.touches.resizeForOverwrite(manifolds.size());
    for (std::size_t i = 0; i < manifolds.size(); ++i)
        manifolds.touches[i] = manifolds[i].place.color == ConstraintGraph::kFrozen ? kFrozenTouch
                               : manifolds[i].pointCount > 0                        ? kUnknownTouch
                                                                                    : 0;
}

/// What the lanes say of all manifolds in the graph.
void WorldImpl::findTouches() {
    const auto lanes = static_cast<std::size_t>(graph.lanes());
    for (int c = 0; c < graph.listCount(); ++c) {
        if (c == ConstraintGraph::kFrozen || graph.color(c).manifolds.empty()) continue;
        const std::size_t perBundle = ConstraintGraph::isSerial(c) ? 1 : lanes;
        contactFinds.laneTouches.resizeForOverwrite(static_cast<std::size_t>(graph.bundleCount(c)) * lanes);
        runner.parallelFor(graph.bundleCount(c), 32,
                           [&](int begin, int end, int) { takeTouches(*this, graph.color(c), perBundle, begin, end); });
    }
}

/// Contacts that may touch otherwise than before: where lanes say otherwise, what came, changed, or was struck in this
/// step or the last. Sensors have no lanes; what tells of motion does so in every step.
static void findDirty(WorldImpl& world) {
    const bool all = world.contactFinds.allDirty || world.contactFinds.motionReported ||
                     world.contactFinds.anySensor.load(std::memory_order_relaxed);
    world.contactFinds.change.resizeForOverwrite(world.contacts.awake.size());
    std::fill(world.contactFinds.change.begin(), world.contactFinds.change.end(), all ? 1 : 0);
    world.contactFinds.allDirty = false;
    world.findTouches();
    for (const ChangedContact changed : world.contactFinds.changed)
        if ((changed.change & kApart) == 0) markDirty(world, changed.contact);
    for (const std::uint32_t contact : world.contactFinds.dirty) markDirty(world, contact);
    for (const SweptImpact& impact : world.sweptBodies.impacts) markDirty(world, impact.contact);
    world.contactFinds.dirty.clear();
}

/// Does a contact touch after the step? Notes whether it bears a load.
bool WorldImpl::isTouching(ContactRecord& record) {
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

/// Contacts touch when a point carries load or overlaps; begin and end are reported in the order of the list.
void WorldImpl::publishEvents() {
    findDirty(*this);
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

/// Impacts that continuous collision has played are over; the next step may find nothing of them.
void WorldImpl::publishSweptImpacts() {
    for (const SweptImpact& impact : sweptBodies.impacts) {
        ContactRecord& record = contacts[impact.contact];
        record.struck = false;
        contactFinds.dirty.push(impact.contact);
        if (!record.reportsMotion || impact.speed <= context.restitutionSpeed) continue;
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

void WorldImpl::publishContact(std::uint32_t index) {
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

void WorldImpl::publishSurface(const ContactRecord& record, const ManifoldRecord& manifold, bool wasLoaded) {
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
    const float slowest = tuning::kSlideSpeed * std::sqrt(length(settings.gravity) * size);
    event.shapeA = shapes.id(record.shapeA), event.shapeB = shapes.id(record.shapeB);
    event.bodyA = bodies.id(record.bodyA), event.bodyB = bodies.id(record.bodyB);
    event.surfaceA = shapes.materialAt(shapes[record.shapeA], manifold.triangle).surface;
    event.surfaceB = shapes[record.shapeB].material.surface;
    event.point = (a.state == 0 ? b.center : a.center) + rA;
    event.normal = normal;
    // An impact is over in the step that it begins in; what it leaves for the next is no other one.
    if (approach < -context.restitutionSpeed && !wasLoaded) {
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

Contact WorldImpl::describe(const ContactRecord& record, const ManifoldRecord& manifold) const {
    Contact result;
    result.shapeA = shapes.id(record.shapeA), result.shapeB = shapes.id(record.shapeB);
    result.bodyA = bodies.id(record.bodyA), result.bodyB = bodies.id(record.bodyB);
    const PlacedManifold now = placed(record, manifold);
    result.normal = now.normal;
    result.pointCount = manifold.pointCount;
    const ManifoldImpulses impulses = impulsesOf(manifold);
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
