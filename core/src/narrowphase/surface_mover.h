#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "narrowphase/box_on_triangles.h"
#include "narrowphase/pairs.h"

namespace ragtop {

/// The convex shape in the axes of the mesh, about its own origin: exact however far from the origin of the mesh it is.
struct Mover {
    const ConvexView* shape;
    Vec3 position;  ///< of its origin in the mesh
    float margin;
    float size;
    Vec3 center;  ///< of its mass
    Vec3 p, q;    ///< capsule: the segment
    std::optional<TurnedBox> box;
    std::optional<PlacedHull> hull;

    Mover(const ConvexView& view, const Frame& frame, float contactMargin)
        : shape(&view), position(frame.position), margin(contactMargin), size(pairs::sizeOf(view)) {
        const Frame turned{{}, frame.rotation};
        q = rotate(frame.rotation, {0, view.halfExtents.y, 0});
        p = -q;
        if (view.kind == ConvexKind::box) {
            box.emplace(view.halfExtents, frame.rotation);
        } else if (view.kind == ConvexKind::hull) {
            hull.emplace(viewOf(*view.hull), turned);
            center = hull->view().center;
        }
    }

    /// How far the shape is in front of a plane, m.
    float above(const Plane& plane) const {
        const Vec3& n = plane.normal;
        if (box) {
            const Vec3 &h = box->half, &x = box->axes[0], &y = box->axes[1], &z = box->axes[2];
            return -plane.offset - std::fabs(dot(n, x)) * h.x - std::fabs(dot(n, y)) * h.y - std::fabs(dot(n, z)) * h.z;
        }
        if (!hull) return -plane.offset - std::fabs(dot(n, q)) - shape->radius;
        float least = dot(n, hull->view().vertices[0]);
        for (const Vec3& vertex : hull->view().vertices) least = std::min(least, dot(n, vertex));
        return least - plane.offset;
    }

    /// In the mesh, grown by the margin and by the rounding of the sums.
    Bounds bounds() const {
        Bounds b{p, p};
        if (box) {
            b = {-box->reach(), box->reach()};
        } else if (hull) {
            b = {hull->view().vertices[0], hull->view().vertices[0]};
            for (const Vec3& vertex : hull->view().vertices) b = {min(b.lower, vertex), max(b.upper, vertex)};
        } else if (shape->kind == ConvexKind::capsule) {
            b = {min(p, q), max(p, q)};
        } else {
            b = {};
        }
        constexpr float kRounding = 1e-6f;  // eight units in the last place
        const Vec3 far = abs(position) + max(abs(b.lower), abs(b.upper));
        const float grow = shape->radius + margin;
        const Vec3 slack = Vec3{grow, grow, grow} + kRounding * far;
        return {b.lower + position - slack, b.upper + position + slack};
    }
};

}  // namespace ragtop
