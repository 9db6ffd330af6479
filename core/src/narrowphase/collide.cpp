#include "narrowphase/pairs.h"

namespace ragtop {
namespace pairs {
namespace {

void boxCapsule(const Vec3& halfExtents, const Vec3& p, const Vec3& q, float radius, float margin, Manifold& out) {
    const BoxHull box(halfExtents);
    hullCapsule(box.view(), p, q, radius, margin, out);
}

/// The pair with the round shape second, or of polyhedra in any order.
void ordered(const ConvexView& a, const ConvexView& b, const Frame& bInA, float margin, SeparationCache& cache,
             Manifold& out) {
    if (a.kind == ConvexKind::sphere) return spheres(a.radius, b.radius, bInA.position, margin, out);
    if (b.kind == ConvexKind::sphere) {
        if (a.kind == ConvexKind::capsule) return capsuleSphere(a, b.radius, bInA.position, margin, out);
        if (a.kind == ConvexKind::box) return boxSphere(a.halfExtents, b.radius, bInA.position, margin, out);
        return hullSphere(viewOf(*a.hull), b.radius, bInA.position, margin, out);
    }
    if (a.kind == ConvexKind::capsule) return capsules(a, b, bInA, margin, out);
    if (b.kind == ConvexKind::capsule) {
        const Vec3 half = rotate(bInA.rotation, {0, b.halfExtents.y, 0});
        const Vec3 p = bInA.position - half, q = bInA.position + half;
        if (a.kind == ConvexKind::box) return boxCapsule(a.halfExtents, p, q, b.radius, margin, out);
        return hullCapsule(viewOf(*a.hull), p, q, b.radius, margin, out);
    }
    if (a.kind == ConvexKind::hull && b.kind == ConvexKind::hull) {
        return hulls(viewOf(*a.hull), viewOf(*b.hull), bInA, margin, cache, out);
    }
    const BoxHull box(a.kind == ConvexKind::box ? a.halfExtents : b.halfExtents);
    if (a.kind == ConvexKind::box) return hulls(box.view(), viewOf(*b.hull), bInA, margin, cache, out);
    hulls(viewOf(*a.hull), box.view(), bInA, margin, cache, out);
}

}  // namespace

float sizeOf(const ConvexView& shape) {
    if (shape.kind == ConvexKind::hull) return shape.hull->innerRadius;
    if (shape.kind != ConvexKind::box) return shape.radius;
    const Vec3& h = shape.halfExtents;
    const float xy = h.x < h.y ? h.x : h.y;
    return xy < h.z ? xy : h.z;
}

}  // namespace pairs

void collide(const ConvexView& a, const ConvexView& b, const Frame& bInA, float margin, SeparationCache& cache,
             Manifold& out) {
    out.pointCount = 0;
    out.gap = margin;
    if (a.kind == ConvexKind::box && b.kind == ConvexKind::box) {
        pairs::boxes(a.halfExtents, b.halfExtents, bInA, margin, cache, out);
        out.gap = cache.separation > margin ? cache.separation : margin;
        return;
    }
    const bool round = a.kind == ConvexKind::sphere || a.kind == ConvexKind::capsule;
    const bool swapped = round && b.kind > a.kind;
    if (!swapped) return pairs::ordered(a, b, bInA, margin, cache, out);
    pairs::ordered(b, a, inverse(bInA), margin, cache, out);
    pairs::flip(out, inverse(bInA));
}

}  // namespace ragtop
