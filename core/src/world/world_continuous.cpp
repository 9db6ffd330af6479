#include <cmath>

#include "narrowphase/distance.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// A frame of `pose` seen from `from`.
Frame seenFrom(const Pose& from, const Pose& pose) {
    Frame frame = relative(from, pose);
    frame.rotation = normalized(frame.rotation);
    return frame;
}

}  // namespace

/// Bodies that moved far for their size are swept along their path, so that they do not pass what their contacts did not
/// foresee. Serial and in order of the list; each is stopped where it first meets something.
void WorldImpl::sweepFastBodies() {
    if (!settings.continuous) return;
    for (std::size_t i = 0; i < awakeBodies.size(); ++i)
        if (bodyFlags[i] != 0) sweepBody(awakeBodies[i], startPoses[i].center, startPoses[i].rotation);
}

void WorldImpl::sweepBody(std::uint32_t index, const DVec3& fromCenter, const Quat& fromRotation) {
    BodyRecord& body = bodies[index];
    const Pose start{fromCenter, fromRotation}, end{body.center, body.rotation};
    float earliest = 1;
    for (std::uint32_t s = body.firstShape; s != kNone; s = shapes[s].next) {
        const ShapeRecord& shape = shapes[s];
        const GeometryEntry& geometry = geometries[shape.geometry];
        if (shape.sensor || geometry.isMesh()) continue;
        const Pose shapeStart = start * shape.frame, shapeEnd = end * shape.frame;
        // A point at r that turns by θ leaves its chord by r (1 − cos θ/2) at most.
        const float bulge = body.radius * (1 - std::abs((end.rotation * conjugate(start.rotation)).w));
        const Bounds swept =
            enlarged(merge(boundsOf(geometry.shape, shapeStart), boundsOf(geometry.shape, shapeEnd)), bulge);
        // Stop a little before; the next step finds a contact. What is nearer already is left to the contact it has.
        const float target = 0.25f * tuning::kSpeculative * shape.size;
        const Bounds own = boundsOf(geometry.shape, Frame{});
        const Vec3 middle = 0.5f * (own.lower + own.upper);
        const ConvexView core = convexView(Sphere{0.25f * shape.size});
        const auto meet = [&](std::uint32_t other) {
            const ShapeRecord& obstacle = shapes[other];
            if (obstacle.sensor || !shouldCollide(shape, obstacle)) return true;
            if (callbacks.filter && !callbacks.filter({shapeId(s), shapeId(other), id(shape.body), id(obstacle.body),
                                                       shape.userData, obstacle.userData}))
                return true;
            const Pose pose = shapePose(obstacle);
            const Frame from = seenFrom(pose, shapeStart), to = seenFrom(pose, shapeEnd);
            const GeometryEntry& solid = geometries[obstacle.geometry];
            // What touches already is left to its contact, but the middle of the shape must not go through it either.
            const auto sweepAt = [&](const auto& obstacleView) {
                SweepHit hit = timeOfImpact(obstacleView, geometry.convex, from, to, target);
                if (hit.hit && hit.fraction == 0)
                    hit = timeOfImpact(obstacleView, core, {transformPoint(from, middle), from.rotation},
                                       {transformPoint(to, middle), to.rotation}, 0);
                if (hit.hit && hit.fraction > 0 && hit.fraction < earliest) earliest = hit.fraction;
            };
            if (!solid.isMesh()) {
                sweepAt(solid.convex);
                return true;
            }
            const Bounds path = enlarged(merge(boundsOf(geometry.shape, from), boundsOf(geometry.shape, to)), bulge);
            const auto triangle = [&](const TriangleView& view) {
                // Surfaces are met from the front only.
                if (dot(view.normal, from.position - view.a) > 0) sweepAt(view);
                return true;
            };
            if (solid.mesh)
                forEachTriangle(*solid.mesh, path, triangle);
            else
                forEachTriangle(*solid.field, path, triangle);
            return true;
        };
        staticTree.query(swept, meet);
        if (body.bullet) movingTree.query(swept, meet);
    }
    if (earliest >= 1) return;
    const Pose stopped = blend(start, end, earliest);
    body.center = stopped.position;
    body.rotation = stopped.rotation;
}

}  // namespace ragtop
