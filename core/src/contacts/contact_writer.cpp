#include "contacts/contact_writer.h"

#include "constraints/lane_view.h"

namespace ragtop {

namespace {

/// The contact point of two round surfaces divides the way between their centres by their radii, and a flat one has an
/// infinite radius: the share of B's way that the point goes is RA/(RA + RB). Where both are flat it goes half of it,
/// or stays with the one that moves if only one does.
float followShare(float roundA, float roundB, bool movesA, bool movesB) {
    if (roundA > 0 && roundB > 0) return roundA / (roundA + roundB);
    if (roundA > 0 || roundB > 0) return roundA > 0 ? 0.0f : 1.0f;
    return movesA == movesB ? 0.5f : movesA ? 0.0f : 1.0f;
}

/// Does a round surface's core go anywhere when its body turns? That of a ball about the centre of mass does not.
bool coreTurns(const ShapeRecord& shape, const ConvexView& convex) {
    return convex.radius > 0 && !(convex.kind == ConvexKind::sphere && shape.frame.position == Vec3{});
}

}  // namespace

void ContactWriter::writeSurface(const ContactRecord& record, const ManifoldRecord& manifold) const {
    LaneView lane(graph.lane(manifold.place), graph.lanes());
    ContactSurface surface = surfaceOf(bodies, shapes, record.shapeA, record.shapeB, manifold.triangle);
    if (callbacks.modify) callbacks.modify(pairInfo(bodies, shapes, record.shapeA, record.shapeB), surface);
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
    const float follow = followShare(a.radius, b.radius, bodies.moves(record.bodyA), bodies.moves(record.bodyB));
    lane.at(contact::kRoundA) = a.radius;
    lane.at(contact::kRoundB) = b.radius;
    lane.at(contact::kFollow) = follow;
    // What does not move has no say in it.
    lane.at(contact::kCoreShareA) = coreTurns(shapeA, a) ? (bodies.moves(record.bodyB) ? 1 - follow : 1.0f) : 0.0f;
    lane.at(contact::kCoreShareB) = coreTurns(shapeB, b) ? (bodies.moves(record.bodyA) ? follow : 1.0f) : 0.0f;
    lane.set(contact::kSurface, surface.surfaceVelocity);
}

void ContactWriter::refreshSurfaces(ContactRecord& record) const {
    if (!record.surfaceOpen && !callbacks.modify && !surfacesForgotten) return;
    record.surfaceOpen = false;
    for (const ManifoldRecord& manifold : manifolds.of(record))
        if (manifold.place.color != kNone) writeSurface(record, manifold);
}

void ContactWriter::writeLane(const ContactRecord& record, const ManifoldRecord& manifold,
                              const ManifoldImpulses& impulses) const {
    LaneView lane(graph.lane(manifold.place), graph.lanes());
    lane.setBits(contact::kBodyA, bodies[record.bodyA].state);
    lane.setBits(contact::kBodyB, bodies[record.bodyB].state);
    lane.setBits(contact::kRecordA, record.bodyA);
    lane.setBits(contact::kRecordB, record.bodyB);
    lane.at(contact::kSize) = record.size;
    writeSurface(record, manifold);
    const float ratio = impulses.substep > 0 ? h / impulses.substep : 1;
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

void ContactWriter::writeImpulses(const ContactRecord& record, const ManifoldRecord& manifold,
                                  const ManifoldImpulses& impulses) const {
    if (manifold.place.color != kNone)
        writeLane(record, manifold, impulses);
    else if (manifold.stored != kNone)
        manifolds.storedOf(manifold) = impulses;
}

}  // namespace ragtop
