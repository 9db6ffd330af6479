#include <algorithm>
#include <cmath>

#include "constraints/lane_view.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// How far the friction of a material with a grain is from that of one without.
float unevenness(const Material& material) {
    return material.crossFriction > 1 ? material.crossFriction : 1 / material.crossFriction;
}

/// The contact point of two round surfaces divides the way between their centres by their radii, and a flat one has an
/// infinite radius: the share of B's way that the point goes is RA/(RA + RB), half of it where both are flat.
float followShare(float roundA, float roundB) {
    if (roundA > 0 && roundB > 0) return roundA / (roundA + roundB);
    return roundA > 0 ? 0.0f : roundB > 0 ? 1.0f : 0.5f;
}

/// Does a round surface's core go anywhere when its body turns? That of a ball about the centre of mass does not.
bool coreTurns(const ShapeRecord& shape, const ConvexView& convex) {
    return convex.radius > 0 && !(convex.kind == ConvexKind::sphere && shape.frame.position == Vec3{});
}

}  // namespace

float combined(CombineRule a, float valueA, CombineRule b, float valueB) {
    switch (a > b ? a : b) {
        case CombineRule::geometricMean:
            return std::sqrt(valueA * valueB);
        case CombineRule::average:
            return 0.5f * (valueA + valueB);
        case CombineRule::minimum:
            return valueA < valueB ? valueA : valueB;
        case CombineRule::product:
            return valueA * valueB;
        case CombineRule::maximum:
            break;
    }
    return valueA > valueB ? valueA : valueB;
}

ContactSurface WorldImpl::surfaceOf(const ContactRecord& contact, std::uint32_t triangle) const {
    ContactSurface surface = surfaceOfPair(contact.shapeA, contact.shapeB, triangle);
    if (callbacks.modify) callbacks.modify(pairInfo(contact), surface);
    return surface;
}

/// What two surfaces make of each other, without the callback.
ContactSurface WorldImpl::surfaceOfPair(std::uint32_t indexA, std::uint32_t indexB, std::uint32_t triangle) const {
    const ShapeRecord &shapeA = shapes[indexA], &shapeB = shapes[indexB];
    const BodyRecord &bodyA = bodies[shapeA.body], &bodyB = bodies[shapeB.body];
    const Material& a = shapes.materialAt(shapeA, triangle);
    const Material& b = shapeB.material;
    ContactSurface surface;
    surface.friction = combined(a.frictionRule, a.friction, b.frictionRule, b.friction);
    if (a.slidingShare < 1 || b.slidingShare < 1) {
        const float sliding =
            combined(a.frictionRule, a.slidingShare * a.friction, b.frictionRule, b.slidingShare * b.friction);
        surface.slidingShare = sliding < surface.friction ? sliding / surface.friction : 1.0f;
    }
    surface.restitution = combined(a.restitutionRule, a.restitution, b.restitutionRule, b.restitution);
    surface.rollingResistance = a.rollingResistance > b.rollingResistance ? a.rollingResistance : b.rollingResistance;
    surface.spinningResistance =
        a.spinningResistance > b.spinningResistance ? a.spinningResistance : b.spinningResistance;
    const float unevenA = a.grain == Vec3{} ? 1 : unevenness(a), unevenB = b.grain == Vec3{} ? 1 : unevenness(b);
    if (unevenA > 1 || unevenB > 1) {
        const bool ofA = unevenA >= unevenB;
        surface.grain = rotate(definitionRotation(ofA ? bodyA : bodyB), ofA ? a.grain : b.grain);
        surface.crossFriction = ofA ? a.crossFriction : b.crossFriction;
    }
    if (a.surfaceVelocity != Vec3{} || b.surfaceVelocity != Vec3{})
        surface.surfaceVelocity =
            rotate(definitionRotation(bodyB), b.surfaceVelocity) - rotate(definitionRotation(bodyA), a.surfaceVelocity);
    return surface;
}

PairInfo WorldImpl::pairInfo(const ContactRecord& contact) const {
    return {shapes.id(contact.shapeA), shapes.id(contact.shapeB),       bodies.id(contact.bodyA),
            bodies.id(contact.bodyB),  shapes[contact.shapeA].userData, shapes[contact.shapeB].userData};
}

/// A manifold found some steps ago, where its anchors are now.
PlacedManifold WorldImpl::placed(const ContactRecord& record, const ManifoldRecord& manifold) const {
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Vec3 offset = relative(b.center, a.center);
    // A static A has no reference point of its own: anchors are then from the centre of B.
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

/// Writes what the surfaces do to each other; a callback may change it in every step.
void WorldImpl::writeSurface(const ContactRecord& record, const ManifoldRecord& manifold) {
    LaneView lane(graph.lane(manifold.place), graph.lanes());
    const ContactSurface surface = surfaceOf(record, manifold.triangle);
    // Grain and surface velocity turn with the bodies.
    const bool turns = surface.grain != Vec3{} || surface.surfaceVelocity != Vec3{};
    contacts[manifold.contact].surfaceOpen |= callbacks.modify || turns;
    lane.setBits(contact::kPointCount, surface.enabled ? static_cast<std::uint32_t>(manifold.pointCount) : 0);
    lane.at(contact::kFriction) = surface.friction;
    lane.at(contact::kSlidingShare) = surface.slidingShare;
    lane.at(contact::kCross) = 0;
    if (surface.grain != Vec3{} && surface.crossFriction != 1) {
        // Across the grain in the plane of contact; a grain that stands on it has no direction there.
        const Vec3 across = cross(rotate(bodies[record.bodyA].rotation, manifold.normal), surface.grain);
        const float size = length(across), k = surface.crossFriction;
        if (size > 0) lane.set(contact::kAcross, (1 / size) * across), lane.at(contact::kCross) = 1 / (k * k) - 1;
    }
    lane.at(contact::kRestitution) = surface.restitution;
    lane.at(contact::kRolling) = surface.rollingResistance;
    lane.at(contact::kSpinning) = surface.spinningResistance;
    const ShapeRecord &shapeA = shapes[record.shapeA], &shapeB = shapes[record.shapeB];
    const ConvexView &a = shapes.geometries[shapeA.geometry].convex, &b = shapes.geometries[shapeB.geometry].convex;
    const float follow = followShare(a.radius, b.radius);
    lane.at(contact::kRoundA) = a.radius;
    lane.at(contact::kRoundB) = b.radius;
    lane.at(contact::kFollow) = follow;
    // What does not move has no say in it.
    lane.at(contact::kCoreShareA) = coreTurns(shapeA, a) ? (bodies.moves(record.bodyB) ? 1 - follow : 1.0f) : 0.0f;
    lane.at(contact::kCoreShareB) = coreTurns(shapeB, b) ? (bodies.moves(record.bodyA) ? follow : 1.0f) : 0.0f;
    lane.set(contact::kSurface, surface.surfaceVelocity);
}

/// Where surfaces may have changed, they are written anew for all manifolds that have a lane.
void WorldImpl::refreshSurfaces(ContactRecord& record) {
    if (!record.surfaceOpen && !callbacks.modify && !contactFinds.surfacesForgotten) return;
    record.surfaceOpen = false;
    for (const ManifoldRecord& manifold : manifolds.of(record))
        if (manifold.place.color != kNone) writeSurface(record, manifold);
}

/// Writes a manifold with its impulses into its lane.
void WorldImpl::writeLane(const ContactRecord& record, const ManifoldRecord& manifold,
                          const ManifoldImpulses& impulses) {
    LaneView lane(graph.lane(manifold.place), graph.lanes());
    lane.setBits(contact::kBodyA, bodies[record.bodyA].state);
    lane.setBits(contact::kBodyB, bodies[record.bodyB].state);
    lane.setBits(contact::kRecordA, record.bodyA);
    lane.setBits(contact::kRecordB, record.bodyB);
    lane.at(contact::kSize) = record.size;
    writeSurface(record, manifold);
    const float ratio = impulses.substep > 0 ? context.h / impulses.substep : 1;
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        lane.at(j, contact::kImpulse) = ratio * impulses.impulse[j];
        lane.at(j, contact::kLoad) = ratio * impulses.load[j];
    }
    lane.set(contact::kFrictionImpulse, ratio * impulses.frictionImpulse);
    lane.set(contact::kRollImpulse, ratio * impulses.rollImpulse);
    lane.at(contact::kTwistImpulse) = ratio * impulses.twistImpulse;
    lane.at(contact::kSliding) = impulses.sliding ? 1.0f : 0.0f;
    lane.set(contact::kStick, impulses.stick);
}

/// Of what has neither a lane nor stored impulses, they are zero and stay so.
void WorldImpl::writeImpulses(const ContactRecord& record, const ManifoldRecord& manifold,
                              const ManifoldImpulses& impulses) {
    if (manifold.place.color != kNone)
        writeLane(record, manifold, impulses);
    else if (manifold.stored != kNone)
        manifolds.storedOf(manifold) = impulses;
}

void WorldImpl::recordGraphChange(GraphPlace place) { islands.graphChangedAt(place.color == ConstraintGraph::kDirect); }

void WorldImpl::addToGraph(std::uint32_t index) {
    ManifoldRecord& manifold = manifolds[index];
    const ContactRecord& record = contacts[manifold.contact];
    if (manifold.place.color != kNone || manifold.pointCount == 0 || record.sensor) return;
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    const ManifoldImpulses impulses = impulsesOf(manifold);
    const bool direct = bodies.isDirect(record.bodyA) || bodies.isDirect(record.bodyB);
    manifold.place = graph.insertContact(index, bodies[record.bodyA].state, bodies.moves(record.bodyA),
                                         bodies[record.bodyB].state, bodies.moves(record.bodyB),
                                         direct ? ConstraintGraph::By::direct : ConstraintGraph::By::iteration);
    recordGraphChange(manifold.place);
    writeLane(record, manifold, impulses);
    if (record.manifoldCapacity == 1) manifolds.forgetStored(manifold);
}

void WorldImpl::removeFromGraph(std::uint32_t index) {
    ManifoldRecord& manifold = manifolds[index];
    if (manifold.place.color == kNone) return;
    const ContactRecord& record = contacts[manifold.contact];
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    if (manifold.pointCount > 0) manifolds.store(manifold, impulsesOf(manifold));
    const std::uint32_t moved =
        graph.removeContact(manifold.place, bodies[record.bodyA].state, bodies.moves(record.bodyA),
                            bodies[record.bodyB].state, bodies.moves(record.bodyB));
    if (moved != kNone) manifolds[moved].place.slot = manifold.place.slot;
    recordGraphChange(manifold.place);
    manifold.place = {};
    manifolds.touches[index] = manifold.pointCount > 0 ? kUnknownTouch : 0;
    contacts[manifold.contact].until = 0;
}

namespace {

/// Impulses of the points of before for those of now that have the same feature.
ManifoldImpulses matchedImpulses(const ManifoldRecord& before, const ManifoldImpulses& known,
                                 const ManifoldRecord& now) {
    ManifoldImpulses carried;
    if (before.pointCount > 0) carried = known;
    for (int j = 0; j < kMaxManifoldPoints; ++j) {
        carried.impulse[j] = carried.load[j] = 0;
        if (j >= now.pointCount) continue;
        for (int k = 0; k < before.pointCount; ++k)
            if (before.feature[k] == now.feature[j]) {
                carried.impulse[j] = known.impulse[k];
                carried.load[j] = known.load[k];
                break;
            }
    }
    return carried;
}

/// Contacts of surfaces go from feature to feature as they roll and slide on each other. What a place that is gone bore is
/// borne by the nearest one of now that faces alike, so that nothing sinks until it finds its load anew.
void handOverImpulses(std::span<const ManifoldRecord> before, const ManifoldImpulses* known,
                      std::span<const ManifoldRecord> now, ManifoldImpulses* carried, float size) {
    constexpr float kNear = 0.5f, kAlike = 0.7f;  // of the size; cosine, 45°
    for (std::size_t i = 0; i < before.size(); ++i)
        for (int j = 0; j < before[i].pointCount; ++j) {
            const ManifoldRecord& old = before[i];
            if (!(known[i].impulse[j] > 0 || known[i].load[j] > 0)) continue;
            const ManifoldRecord* heir = nullptr;
            int place = 0;
            float least = kNear * kNear * size * size;
            bool kept = false;
            for (const ManifoldRecord& manifold : now) {
                const float facing = dot(manifold.normal, old.normal);
                if (facing < kAlike) continue;
                for (int k = 0; k < manifold.pointCount; ++k) {
                    kept |= &manifold == &now[i] && manifold.feature[k] == old.feature[j];
                    const float square = lengthSquared(manifold.anchorA[k] - old.anchorA[j]);
                    if (square < least) least = square, heir = &manifold, place = k;
                }
            }
            if (kept || !heir) continue;
            const float share = dot(heir->normal, old.normal);
            carried[heir - now.data()].impulse[place] += share * known[i].impulse[j];
            carried[heir - now.data()].load[place] += share * known[i].load[j];
        }
}

/// Are its points those that were found, in the same order?
bool hasSamePoints(const ManifoldRecord& before, const Manifold& found) {
    bool same = before.pointCount == found.pointCount;
    for (int j = 0; same && j < found.pointCount; ++j) same = before.feature[j] == found.points[j].feature;
    return same;
}

/// Are its points other ones than before?
bool hasOtherPoints(const ManifoldRecord& before, const ManifoldRecord& now) {
    if (before.pointCount != now.pointCount) return true;
    for (int j = 0; j < now.pointCount; ++j) {
        bool known = false;
        for (int k = 0; k < before.pointCount; ++k) known |= before.feature[k] == now.feature[j];
        if (!known) return true;
    }
    return false;
}

/// For each new manifold the old one that faces the same way, at most once; the rest take free places.
void matchManifolds(const Vec3* normals, int count, const ManifoldRecord* old, int capacity, int place[kMaxManifolds]) {
    bool used[kMaxManifolds] = {};
    for (int i = 0; i < count; ++i) {
        int best = -1;
        float bestDot = 0.9f;
        for (int k = 0; k < capacity; ++k) {
            if (used[k] || old[k].pointCount == 0) continue;
            const float d = dot(normals[i], old[k].normal);
            if (d > bestDot) bestDot = d, best = k;
        }
        place[i] = best;
        if (best >= 0) used[best] = true;
    }
    for (int i = 0; i < count; ++i) {
        if (place[i] >= 0) continue;
        int free = -1;
        for (int k = 0; k < capacity && free < 0; ++k)
            if (!used[k] && old[k].pointCount == 0) free = k;
        for (int k = 0; k < capacity && free < 0; ++k)
            if (!used[k]) free = k;
        place[i] = free;
        used[free] = true;
    }
}

}  // namespace

/// Where a pair has hardly moved since its manifolds were found, they are still right when they move with the bodies:
/// cheaper, and quieter at rest [Catto, Box3D, 2026]. The bound is a share of the size; a turn counts by the arc that
/// it makes at the radius of the smaller body. How much of it is left is noted as what the bodies may travel until this
/// is to be asked again.
bool WorldImpl::reuseManifolds(ContactRecord& record, const PairPlace& place, double travel) const {
    // Impulses of another substep length are rescaled on their way through the record.
    if (lastSubstep != context.h) return false;
    const float most = tuning::kReuse * record.size;
    if (!record.hasPoints || turnsUnderContact(record) || place.margin > record.collidedMargin + most) return false;
    const float left = most - place.moved;
    if (left < 0) return false;
    for (const ManifoldRecord& manifold : manifolds.of(record))
        if (manifold.pointCount > 0 && manifold.place.color == kNone) return false;
    record.until = travel + static_cast<double>(left / place.perTravel);
    return true;
}

/// A round surface turns under its contact point, and is cheap to collide.
bool WorldImpl::turnsUnderContact(const ContactRecord& record) const {
    return shapes.geometries[shapes[record.shapeA].geometry].convex.radius +
               shapes.geometries[shapes[record.shapeB].geometry].convex.radius >
           0;
}

/// The frame of shape B in that of shape A, where the bodies are.
Frame WorldImpl::shapeBInA(const ContactRecord& record) const {
    const ShapeRecord &shapeA = shapes[record.shapeA], &shapeB = shapes[record.shapeB];
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Vec3 apart = relative(b.center, a.center) + rotate(b.rotation, shapeB.frame.position);
    const Vec3 inA = inverseRotate(a.rotation, apart) - shapeA.frame.position;
    const Quat turn = conjugate(a.rotation) * (b.rotation * shapeB.frame.rotation);
    return {inverseRotate(shapeA.frame.rotation, inA), normalized(conjugate(shapeA.frame.rotation) * turn)};
}

/// Does a mesh of a dynamic body take part? Meshes that only others move collide triangle by triangle.
bool WorldImpl::meetAsSurfaces(const ContactRecord& record) const {
    const GeometryEntry& a = shapes.geometries[shapes[record.shapeA].geometry];
    const GeometryEntry& b = shapes.geometries[shapes[record.shapeB].geometry];
    return b.isMesh() || (a.mesh && bodies[record.bodyA].type == BodyType::dynamic);
}

/// The way of the step beside the margin of a pair is that in which B moves; only what turns goes everywhere, and what
/// both share and one of them may lose in the step to something else, up to half the size.
int WorldImpl::findSurfaceManifolds(const ContactRecord& record, const Frame& bInA, float margin,
                                    std::span<Manifold> found) const {
    const ShapeRecord &shapeA = shapes[record.shapeA], &shapeB = shapes[record.shapeB];
    const GeometryEntry &a = shapes.geometries[shapeA.geometry], &b = shapes.geometries[shapeB.geometry];
    ContactReach reach{margin, {}, shapeA.size < shapeB.size ? shapeA.size : shapeB.size};
    if (margin > 0) {
        const Vec3 vA = bodies.states[record.bodyA].v, vB = bodies.states[record.bodyB].v, way = dt * (vB - vA);
        const float slower = lengthSquared(vA) < lengthSquared(vB) ? length(vA) : length(vB);
        const float shared = dt * slower, most = 0.5f * reach.size;
        reach.way = inverseRotate(bodies[record.bodyA].rotation * shapeA.frame.rotation, way);
        reach.margin = margin - length(way) + (shared < most ? shared : most);
    }
    found[0].gap = reach.margin;
    if (a.field) return collideSurfaces(*a.field, *b.mesh, bInA, reach, found);
    if (b.triangles()) return collideSurfaces(*a.mesh, *b.triangles(), bInA, reach, found);
    return collideSurfaces(*a.mesh, b.convex, bInA, reach, found);
}

/// The narrow phase of a pair; returns how many directions it touches in, at most as many as the contact has room for.
int WorldImpl::findManifolds(ContactRecord& record, const Frame& bInA, float margin, std::span<Manifold> found) {
    const GeometryEntry& a = shapes.geometries[shapes[record.shapeA].geometry];
    const GeometryEntry& b = shapes.geometries[shapes[record.shapeB].geometry];
    if (record.isMesh && meetAsSurfaces(record)) return findSurfaceManifolds(record, bInA, margin, found);
    found[0].gap = margin;
    if (a.mesh && record.nearTriangles != kNone)
        return collide(*a.mesh, b.convex, bInA, margin, manifolds.meshMemory[record.nearTriangles], found);
    if (a.mesh) return collide(*a.mesh, b.convex, bInA, margin, found);
    if (a.field) return collide(*a.field, b.convex, bInA, margin, found);
    collide(a.convex, b.convex, bInA, margin, record.cache, found[0]);
    return found[0].pointCount > 0 ? 1 : 0;
}

/// What a contact without manifolds has found; returns the first.
ManifoldRecord& WorldImpl::takeFirstManifolds(ContactRecord& record, std::span<const Manifold> found, int worker) {
    const std::span<ManifoldRecord> held = manifolds.hold(record, worker);
    record.hasPoints = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
        held[i].normal = rotate(shapes[record.shapeA].frame.rotation, found[i].normal);
        placePoints(record, found[i], held[i]);
    }
    return held[0];
}

/// Writes what the narrow phase has found into the records, and the lanes of those in the graph; tells what that
/// changes.
std::uint8_t WorldImpl::takeManifolds(ContactRecord& record, std::span<const Manifold> found) {
    ManifoldRecord* old = &manifolds[record.firstManifold];
    const int count = static_cast<int>(found.size());
    record.hasPoints = count > 0;
    refreshSurfaces(record);
    const ShapeRecord& shapeA = shapes[record.shapeA];
    Vec3 normals[kMaxManifolds];
    int place[kMaxManifolds];
    for (int i = 0; i < count; ++i) normals[i] = rotate(shapeA.frame.rotation, found[static_cast<std::size_t>(i)].normal);
    matchManifolds(normals, count, old, record.manifoldCapacity, place);

    unsigned change = kUnchanged;
    bool written[kMaxManifolds] = {}, others = false;
    for (int i = 0; i < count; ++i) {
        const Manifold& fresh = found[static_cast<std::size_t>(i)];
        ManifoldRecord& manifold = old[place[i]];
        written[place[i]] = true;
        // Its impulses stay in its lane, and so do its surfaces.
        if (manifold.place.color != kNone && lastSubstep == context.h && hasSamePoints(manifold, fresh) &&
            manifold.triangle == fresh.triangle) {
            manifold.normal = normals[i];
            placePoints(record, fresh, manifold);
            continue;
        }
        const ManifoldRecord before = manifold;
        const ManifoldImpulses known = impulsesOf(manifold);
        manifold.normal = normals[i];
        placePoints(record, fresh, manifold);
        others |= hasOtherPoints(before, manifold);
        writeImpulses(record, manifold, matchedImpulses(before, known, manifold));
        if (manifold.place.color == kNone)
            change |= kGraph,
                manifolds.touches[record.firstManifold + static_cast<std::size_t>(place[i])] = kUnknownTouch;
    }
    for (int k = 0; k < record.manifoldCapacity; ++k) {
        if (written[k] || old[k].pointCount == 0) continue;
        old[k].pointCount = 0;
        change |= kGraph;
        others = true;
    }
    if (others && holds(record)) change |= kPoints;
    return static_cast<std::uint8_t>(change);
}

/// The same of meshes that move.
std::uint8_t WorldImpl::takeSurfaceManifolds(ContactRecord& record, std::span<const Manifold> found) {
    const std::span<ManifoldRecord> now = manifolds.of(record);
    ManifoldRecord before[kMaxManifolds];
    ManifoldImpulses known[kMaxManifolds], handed[kMaxManifolds];
    for (std::size_t k = 0; k < now.size(); ++k) before[k] = now[k], known[k] = impulsesOf(now[k]);
    const std::uint8_t change = takeManifolds(record, found);
    for (std::size_t k = 0; k < now.size(); ++k) handed[k] = matchedImpulses(before[k], known[k], now[k]);
    const float sizeA = shapes[record.shapeA].size, sizeB = shapes[record.shapeB].size;
    handOverImpulses({before, now.size()}, known, now, handed, sizeA < sizeB ? sizeA : sizeB);
    for (std::size_t k = 0; k < now.size(); ++k)
        if (now[k].pointCount > 0) writeImpulses(record, now[k], handed[k]);
    return change;
}

/// The points that were found as anchors in both bodies.
void WorldImpl::placePoints(const ContactRecord& record, const Manifold& found, ManifoldRecord& manifold) const {
    const ShapeRecord& shapeA = shapes[record.shapeA];
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Quat rotationA = a.rotation * shapeA.frame.rotation;
    const Vec3 offset = relative(b.center, a.center);
    const Vec3 originA = rotate(a.rotation, shapeA.frame.position);
    manifold.triangle = found.triangle;
    manifold.pointCount = found.pointCount;
    for (int j = 0; j < kMaxManifoldPoints; ++j) {
        const ManifoldPoint& point = found.points[j];
        const bool present = j < manifold.pointCount;
        manifold.feature[j] = present ? point.feature : 0;
        const Vec3 fromA = originA + rotate(rotationA, point.position);
        manifold.anchorA[j] = present ? transformPoint(shapeA.frame, point.position) : Vec3{};
        manifold.anchorB[j] = present ? inverseRotate(b.rotation, fromA - offset) : Vec3{};
        manifold.separation[j] = present ? point.separation : 0;
    }
}

}  // namespace ragtop
