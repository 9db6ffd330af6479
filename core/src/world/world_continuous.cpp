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
        const Bounds swept = merge(boundsOf(geometry.shape, shapeStart), boundsOf(geometry.shape, shapeEnd));
        // Stop a little before; the next step finds a contact. What is nearer already is left to the contact it has.
        const float target = 0.25f * tuning::kSpeculative * shape.size;
        const auto meet = [&](std::uint32_t other) {
            const ShapeRecord& obstacle = shapes[other];
            if (obstacle.sensor || !shouldCollide(shape, obstacle)) return true;
            if (callbacks.filter && !callbacks.filter({shapeId(s), shapeId(other), id(shape.body), id(obstacle.body),
                                                       shape.userData, obstacle.userData}))
                return true;
            const Pose pose = shapePose(obstacle);
            const Frame from = seenFrom(pose, shapeStart), to = seenFrom(pose, shapeEnd);
            const GeometryEntry& solid = geometries[obstacle.geometry];
            const auto take = [&](const SweepHit& hit) {
                if (hit.hit && hit.fraction > 0 && hit.fraction < earliest) earliest = hit.fraction;
            };
            if (!solid.isMesh()) {
                take(timeOfImpact(solid.convex, geometry.convex, from, to, target));
                return true;
            }
            const Bounds path = merge(boundsOf(geometry.shape, from), boundsOf(geometry.shape, to));
            const auto triangle = [&](const TriangleView& view) {
                // Surfaces are met from the front only.
                if (dot(view.normal, from.position - view.a) > 0)
                    take(timeOfImpact(view, geometry.convex, from, to, target));
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
