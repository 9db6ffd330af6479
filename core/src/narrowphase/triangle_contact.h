#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "narrowphase/box_on_triangles.h"
#include "narrowphase/manifold_set.h"
#include "narrowphase/triangle_feature.h"
#include "shapes/geometry.h"
#include "shapes/hull.h"

/// One triangle of a surface and what a convex shape has with it.
namespace ragtop {

/// A triangle about the mover's origin, as a polyhedron that shows its front face only; its back plane serves the
/// edges.
struct TriangleHull {
    static constexpr HullData::Face kFace[1] = {{0, 3}};
    static constexpr std::uint8_t kLoop[3] = {0, 1, 2};
    static constexpr HullData::Edge kEdges[3] = {{0, 1, 0, 1}, {1, 2, 0, 1}, {2, 0, 0, 1}};

    Vec3 vertices[3];
    Plane planes[2];
    std::uint8_t activeEdges;
    std::uint32_t index;

    TriangleHull(const TriangleView& t, const Vec3& origin)
        : vertices{t.a - origin, t.b - origin, t.c - origin}, activeEdges(t.activeEdges), index(t.index) {
        planes[0] = {t.normal, dot(t.normal, vertices[0])};
        planes[1] = {-t.normal, -planes[0].offset};
    }
    const Vec3& normal() const { return planes[0].normal; }
    HullView view() const {
        return {vertices, planes, kFace, kLoop, kEdges, (1.0f / 3.0f) * (vertices[0] + vertices[1] + vertices[2]), 0};
    }
};

/// What of a triangle lies farthest along a direction.
inline Feature featureAlong(const TriangleHull& t, const Vec3& normal) {
    float height[3], highest = 0, longest = 0;
    for (int i = 0; i < 3; ++i) {
        height[i] = dot(normal, t.vertices[i]);
        highest = i == 0 || height[i] > highest ? height[i] : highest;
        const float square = lengthSquared(t.vertices[i == 2 ? 0 : i + 1] - t.vertices[i]);
        longest = square > longest ? square : longest;
    }
    constexpr float kLevel = 1e-3f;  // of the longest edge
    const float tolerance = kLevel * std::sqrt(longest);
    int count = 0, top = 0, below = 0;
    for (int i = 0; i < 3; ++i) {
        if (height[i] >= highest - tolerance) {
            ++count;
            top = i;
        } else {
            below = i;
        }
    }
    if (count == 3) return {Feature::face, 0};
    if (count == 2) return {Feature::edge, below == 2 ? 0 : below + 1};
    return {Feature::vertex, top};
}

inline bool edgeIsActive(const TriangleHull& t, int edge) { return (t.activeEdges >> edge & 1) != 0; }

/// The contacts of one triangle. Four corners of a box cut by three edges make seven points; all are needed, for
/// neighbours go on where this one ends.
struct TriangleContact {
    Vec3 normal;
    int count = 0;
    union {  // not filled with zeros first
        ManifoldPoint points[kMostBoxPoints];
    };

    TriangleContact() {}
    std::span<ManifoldPoint> all() { return {points, static_cast<std::size_t>(count)}; }
    std::span<const ManifoldPoint> all() const { return {points, static_cast<std::size_t>(count)}; }
    void clear() { count = 0; }
    void take(const Manifold& m) {
        normal = m.normal;
        count = m.pointCount;
        for (int i = 0; i < count; ++i) points[i] = m.points[i];
    }
};

constexpr std::uint32_t mixed(std::uint32_t feature, std::uint32_t triangle) {
    return (feature ^ (triangle + 1) * 2654435761u) | kNamedAfterTriangle;
}

/// Corners of the convex shape keep their name while the triangles under them change; cuts are named after both.
inline void nameFeatures(TriangleContact& contact, bool onFace, std::uint32_t triangle) {
    for (int i = 0; i < contact.count; ++i) {
        std::uint32_t& feature = contact.points[i].feature;
        const bool uncut = (feature & 128u) == 0 && (feature >> 8 & 128u) == 0;
        if (!onFace || !uncut) feature = mixed(feature, triangle);
    }
}

}  // namespace ragtop
