#include "contacts/yielding_shapes.h"

#include <algorithm>

#include "narrowphase/collide.h"

namespace ragtop {

namespace {

/// Does a manifold push a shape along the way that it gives? `wayOfB` is B's in A's frame.
bool isAlongWay(const Manifold& manifold, bool aGives, bool bGives, const Vec3& wayOfB) {
    constexpr float kAlong = 0.2f;  // cosine to its way, of what counts as along it
    return (aGives && -manifold.normal.y > kAlong) || (bGives && dot(manifold.normal, wayOfB) > kAlong);
}

float leastSeparation(const Manifold& manifold) {
    float least = manifold.points[0].separation;
    for (int j = 1; j < manifold.pointCount; ++j) least = std::min(least, manifold.points[j].separation);
    return least;
}

/// What a pair would touch with, without what is remembered of it.
int touchesAt(const GeometryEntry& a, const GeometryEntry& b, const Frame& bInA, float margin,
              std::span<Manifold> found) {
    if (a.mesh) return collide(*a.mesh, b.convex, bInA, margin, found);
    if (a.field) return collide(*a.field, b.convex, bInA, margin, found);
    SeparationCache cache;
    collide(a.convex, b.convex, bInA, margin, cache, found[0]);
    return found[0].pointCount > 0 ? 1 : 0;
}

}  // namespace

int keepUnyielding(const Bodies& bodies, const Shapes& shapes, const ContactRecord& record, const Frame& bInA,
                   float near, float dt, std::span<Manifold> found) {
    const ShapeRecord &a = shapes[record.shapeA], &b = shapes[record.shapeB];
    const int count = static_cast<int>(found.size());
    if (!a.givesWay && !b.givesWay) return count;
    const Vec3 wayOfB = rotate(bInA.rotation, {0, 1, 0});
    const Quat ofA = bodies[record.bodyA].rotation * a.frame.rotation;
    const Vec3 speed = inverseRotate(ofA, bodies.states[record.bodyB].v - bodies.states[record.bodyA].v);
    int kept = 0;
    for (const Manifold& manifold : found) {
        bool along = isAlongWay(manifold, a.givesWay, b.givesWay, wayOfB);
        const float closing = -dot(speed, manifold.normal), gap = leastSeparation(manifold);
        if (!along && gap > near && closing * dt > gap) {
            Manifold touching[kMaxManifolds];
            const Frame met{bInA.position + (gap / closing) * speed, bInA.rotation};
            const int touches = touchesAt(shapes.geometryOf(a), shapes.geometryOf(b), met, near, touching);
            along = touches == 0;
            for (int i = 0; i < touches; ++i) along |= isAlongWay(touching[i], a.givesWay, b.givesWay, wayOfB);
        }
        if (!along) found[static_cast<std::size_t>(kept++)] = manifold;
    }
    if (kept == 0 && count > 0) found[0].gap = 0;
    return kept;
}

}  // namespace ragtop
