#include "contacts/find_manifolds.h"

#include "narrowphase/collide.h"
#include "narrowphase/collide_surfaces.h"

namespace ragtop {

bool meetAsSurfaces(const Bodies& bodies, const Shapes& shapes, const ContactRecord& record) {
    const GeometryEntry& a = shapes.geometries[shapes[record.shapeA].geometry];
    const GeometryEntry& b = shapes.geometries[shapes[record.shapeB].geometry];
    return b.isMesh() || (a.mesh && bodies[record.bodyA].type == BodyType::dynamic);
}

/// The way of the step beside the margin of a pair is that in which B moves; only what turns goes everywhere, and what
/// both share and one of them may lose in the step to something else, up to half the size.
static int findSurfaceManifolds(const FindManifolds& view, const ContactRecord& record, const Frame& bInA, float margin,
                                std::span<Manifold> found) {
    const Bodies& bodies = view.bodies;
    const Shapes& shapes = view.shapes;
    const float dt = view.dt;
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

int findManifolds(const FindManifolds& view, ContactRecord& record, const Frame& bInA, float margin,
                  std::span<Manifold> found) {
    const Shapes& shapes = view.shapes;
    const GeometryEntry& a = shapes.geometries[shapes[record.shapeA].geometry];
    const GeometryEntry& b = shapes.geometries[shapes[record.shapeB].geometry];
    if (record.isMesh && meetAsSurfaces(view.bodies, shapes, record))
        return findSurfaceManifolds(view, record, bInA, margin, found);
    found[0].gap = margin;
    if (a.mesh && record.nearTriangles != kNone)
        return collide(*a.mesh, b.convex, bInA, margin, view.meshMemory[record.nearTriangles], found);
    if (a.mesh) return collide(*a.mesh, b.convex, bInA, margin, found);
    if (a.field) return collide(*a.field, b.convex, bInA, margin, found);
    collide(a.convex, b.convex, bInA, margin, record.cache, found[0]);
    return found[0].pointCount > 0 ? 1 : 0;
}

}  // namespace ragtop
