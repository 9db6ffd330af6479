// The sweeps of meshes that move.

#include <cmath>

#include "contacts/tuning.h"
#include "continuous/meetings.h"
#include "narrowphase/collide_surfaces.h"
#include "narrowphase/mesh_sweep.h"

namespace ragtop {

namespace {

MeshSweepHit hitOf(const GeometryEntry& solid, const MeshPath& path) {
    if (const MeshData* triangles = solid.triangles()) return timeOfImpact(*triangles, path);
    return solid.field ? timeOfImpact(*solid.field, path) : timeOfImpact(solid.convex, path);
}

/// All points that touch there along the direction in which it is met, at least the one that was found.
Manifold touchAt(const GeometryEntry& solid, const MeshPath& path, const MeshSweepHit& hit, float size) {
    Manifold touch;
    touch.normal = hit.normal;
    touch.triangle = hit.triangle;
    touch.pointCount = 1;
    touch.points[0].position = hit.point;
    if (hit.overlap || !(solid.triangles() || solid.field)) return touch;
    const Frame met = path.at(hit.fraction);
    const ContactReach reach{3 * path.target, {}, size};
    Manifold found[kMaxManifolds];
    const int count = solid.field ? collideSurfaces(*solid.field, *path.mesh, met, reach, found)
                                  : collideSurfaces(*solid.triangles(), *path.mesh, met, reach, found);
    constexpr float kAlike = 0.98f;  // cosine, 11°: the same side
    for (int i = 0; i < count; ++i)
        if (dot(found[i].normal, hit.normal) > kAlike) return found[i];
    return touch;
}

}  // namespace

void sweepMesh(const SweepView& view, std::uint32_t index, std::uint32_t s, const Pose& start, const Pose& end,
               float done, float until, Meeting& first) {
    const ConstTables& t = view.tables;
    const BodyRecord& body = t.bodies[index];
    const ShapeRecord& shape = t.shapes[s];
    const GeometryEntry& geometry = t.shapes.geometries[shape.geometry];
    const Pose shapeStart = start * shape.frame, shapeEnd = end * shape.frame;
    const float bulge = body.radius * (1 - std::abs((end.rotation * conjugate(start.rotation)).w));
    const Bounds swept =
        enlarged(merge(boundsOf(geometry.shape, shapeStart), boundsOf(geometry.shape, shapeEnd)), bulge);
    const float target = 0.25f * tuning::kSpeculative * shape.size;
    const auto meet = [&](std::uint32_t other) {
        const ShapeRecord& obstacle = t.shapes[other];
        if (obstacle.body == index || obstacle.sensor || !view.mayCollide(s, other)) return true;
        const bool still = t.bodies[obstacle.body].type == BodyType::fixed;
        const SweptPath others =
            still ? SweptPath{{t.bodies[obstacle.body].center, t.bodies[obstacle.body].rotation}, {}, {}}
                  : pathOfStep(view, obstacle.body);
        const GeometryEntry& solid = t.shapes.geometries[obstacle.geometry];
        const Pose otherStart = others.at(done), place = otherStart * obstacle.frame;
        const float share = until - done;
        const auto inPlace = [&](const Vec3& v) { return inverseRotate(place.rotation, v); };
        const MeshPath path{geometry.mesh,
                            seenFrom(place, shapeStart),
                            inverseTransformPoint(shape.frame, {}),
                            inPlace(relative(end.position, start.position) - share * others.way),
                            inPlace(rotationVector(end.rotation * conjugate(start.rotation))),
                            inverseTransformPoint(obstacle.frame, {}),
                            inPlace(share * others.turn),
                            target,
                            2 * target};
        const MeshSweepHit hit = hitOf(solid, path);
        if (!hit.hit || (first.hit && hit.fraction >= first.fraction)) return true;
        first = {true, hit.fraction, s, other, touchAt(solid, path, hit, shape.size)};
        return true;
    };
    view.broadphase.fixedTree.query(swept, meet);
    if (body.options.bullet) view.broadphase.movingTree.query(swept, meet);
}

}  // namespace ragtop
