#include "contacts/find_manifolds.h"

#include <algorithm>

#include "contacts/tuning.h"
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

/// B's way beside A in the step and in the substep after it, which the last relaxing pass foresees, where it is longer
/// than that within which manifolds count as found here.
static Approach approachOf(const FindManifolds& view, const ContactRecord& record, float margin) {
    const float near = tuning::kReuse * record.size;
    if (!(margin > 2 * near)) return {};
    const Quat axes = view.bodies[record.bodyA].rotation * view.shapes[record.shapeA].frame.rotation;
    const Vec3 speed = view.bodies.states[record.bodyB].v - view.bodies.states[record.bodyA].v;
    return {inverseRotate(axes, (view.dt + view.h) * speed), near};
}

/// Share of B's way by which the points of a contact go back with it: both bodies get the arm of one point.
static float shareOfB(const Bodies& bodies, const ContactRecord& record) {
    if (bodies[record.bodyA].type != BodyType::dynamic) return 1;
    return bodies[record.bodyB].type == BodyType::dynamic ? 0.5f : 0.0f;
}

static int findConvexManifold(const FindManifolds& view, ContactRecord& record, const Frame& bInA, float margin,
                              Manifold& found) {
    const GeometryEntry& a = view.shapes.geometryOf(view.shapes[record.shapeA]);
    const GeometryEntry& b = view.shapes.geometryOf(view.shapes[record.shapeB]);
    collide(a.convex, b.convex, bInA, margin, record.cache, found);
    const Approach approach = approachOf(view, record, margin);
    if (found.pointCount == 0 || !approach.looksAhead()) return found.pointCount > 0 ? 1 : 0;
    const float apart = std::max(0.0f, leastSeparation(found.all()));
    const float gone = goToMeet(approach, found, [&](float share, Manifold& there) {
        collide(a.convex, b.convex, {bInA.position + share * approach.way, bInA.rotation}, margin, record.cache, there);
    });
    const Vec3 back = shareOfB(view.bodies, record) * gone * approach.way;
    for (ManifoldPoint& point : found.all()) point.position -= back;
    bringBack(approach, gone, found);
    if (found.pointCount == 0) found.gap = apart;
    return found.pointCount > 0 ? 1 : 0;
}

int findManifolds(const FindManifolds& view, ContactRecord& record, const Frame& bInA, float margin,
                  std::span<Manifold> found) {
    const Shapes& shapes = view.shapes;
    const GeometryEntry& a = shapes.geometries[shapes[record.shapeA].geometry];
    const GeometryEntry& b = shapes.geometries[shapes[record.shapeB].geometry];
    if (record.isMesh && meetAsSurfaces(view.bodies, shapes, record))
        return findSurfaceManifolds(view, record, bInA, margin, found);
    if (!a.mesh && !a.field) return findConvexManifold(view, record, bInA, margin, found[0]);
    const Approach approach = approachOf(view, record, margin);
    found[0].gap = approach.looksAhead() ? 0 : margin;
    if (a.mesh && record.nearTriangles != kNone)
        return collide(*a.mesh, b.convex, bInA, margin, view.meshMemory[record.nearTriangles], found, approach);
    if (a.mesh) return collide(*a.mesh, b.convex, bInA, margin, found, approach);
    return collide(*a.field, b.convex, bInA, margin, found, approach);
}

}  // namespace ragtop
