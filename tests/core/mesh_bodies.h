#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "ragtop/shape.h"

/// Meshes of bodies that are not convex, for tests and the stability suite.
namespace ragtop::scenes {

/// Triangles of a grid of `rows` × `columns` that closes in both directions, vertex (i, j) at i · columns + j.
inline TriangleMesh closedGrid(const std::vector<Vec3>& vertices, std::uint32_t rows, std::uint32_t columns) {
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            const std::uint32_t a = i * columns + j, b = i * columns + (j + 1) % columns;
            const std::uint32_t c = (i + 1) % rows * columns + j, d = (i + 1) % rows * columns + (j + 1) % columns;
            triangles.push_back({a, d, b});
            triangles.push_back({a, c, d});
        }
    return TriangleMesh(vertices, triangles);
}

/// A ring about z: `ring` radius of the circle of the tube's centres, `tube` of the tube.
inline TriangleMesh torus(float ring, float tube, std::uint32_t around = 24, std::uint32_t across = 12) {
    std::vector<Vec3> vertices;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const SinCos u = sinCos(2 * kPi * static_cast<float>(i) / static_cast<float>(around));
            const SinCos v = sinCos(2 * kPi * static_cast<float>(j) / static_cast<float>(across));
            const float radius = ring + tube * v.cos;
            vertices.push_back({radius * u.cos, radius * u.sin, tube * v.sin});
        }
    return closedGrid(vertices, around, across);
}

/// A rod of this radius along a curve in the x–y plane, its ends flat.
inline TriangleMesh bentRod(const std::vector<Vec3>& curve, float radius, std::uint32_t across = 10) {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    const auto n = static_cast<std::uint32_t>(curve.size());
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vec3 along = normalized(curve[i + 1 < n ? i + 1 : i] - curve[i > 0 ? i - 1 : i]);
        const Vec3 side = cross({0, 0, 1}, along);
        for (std::uint32_t j = 0; j < across; ++j) {
            const SinCos v = sinCos(2 * kPi * static_cast<float>(j) / static_cast<float>(across));
            vertices.push_back(curve[i] + radius * (v.cos * side + v.sin * Vec3{0, 0, 1}));
        }
    }
    for (std::uint32_t i = 0; i + 1 < n; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const std::uint32_t a = i * across + j, b = i * across + (j + 1) % across;
            triangles.push_back({a, b, b + across});
            triangles.push_back({a, b + across, a + across});
        }
    const std::uint32_t last = (n - 1) * across;
    for (std::uint32_t j = 1; j + 1 < across; ++j) {
        triangles.push_back({0, j + 1, j});
        triangles.push_back({last, last + j, last + j + 1});
    }
    return TriangleMesh(vertices, triangles);
}

/// The middle line of an S about the origin: above and below it three quarters of a circle.
inline std::vector<Vec3> hookCurve(float radius, int pieces = 9) {
    std::vector<Vec3> curve;
    const auto at = [&](float middle, float angle) {
        const SinCos a = sinCos(angle);
        curve.push_back({radius * a.cos, middle + radius * a.sin, 0});
    };
    for (int i = pieces; i > 0; --i)
        at(radius, -kPi / 2 + 1.5f * kPi * static_cast<float>(i) / static_cast<float>(pieces));
    for (int i = 0; i <= pieces; ++i)
        at(-radius, kPi / 2 + 1.5f * kPi * static_cast<float>(i) / static_cast<float>(pieces));
    return curve;
}

/// The same rod of capsules.
inline Compound capsulesAlong(const std::vector<Vec3>& curve, float radius) {
    Compound rod;
    for (std::size_t i = 1; i < curve.size(); ++i) {
        const Vec3 way = curve[i] - curve[i - 1];
        rod.parts.push_back({Capsule{radius, 0.5f * length(way)},
                             {0.5f * (curve[i] + curve[i - 1]), rotationBetween({0, 1, 0}, normalized(way))}});
    }
    return rod;
}

/// A polygon in the x–y plane, counter-clockwise, drawn out along z from −half to +half. `ears` are its triangles.
inline TriangleMesh prism(const std::vector<Vec3>& outline, const std::vector<Triangle>& ears, float half) {
    const auto n = static_cast<std::uint32_t>(outline.size());
    std::vector<Vec3> vertices;
    for (const Vec3& p : outline) vertices.push_back({p.x, p.y, -half});
    for (const Vec3& p : outline) vertices.push_back({p.x, p.y, half});
    std::vector<Triangle> triangles;
    for (const Triangle& t : ears) {
        triangles.push_back({t.a, t.c, t.b});
        triangles.push_back({t.a + n, t.b + n, t.c + n});
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        triangles.push_back({i, j, j + n});
        triangles.push_back({i, j + n, i + n});
    }
    return TriangleMesh(vertices, triangles);
}

/// A box as a mesh.
inline TriangleMesh boxMesh(const Vec3& half) {
    return prism({{-half.x, -half.y, 0}, {half.x, -half.y, 0}, {half.x, half.y, 0}, {-half.x, half.y, 0}},
                 {{0, 1, 2}, {0, 2, 3}}, half.z);
}

/// An L of two legs, each of this length and thickness, their corner at the origin.
inline TriangleMesh angleIron(float leg, float thickness, float half) {
    return prism(
        {{0, 0, 0}, {leg, 0, 0}, {leg, thickness, 0}, {thickness, thickness, 0}, {thickness, leg, 0}, {0, leg, 0}},
        {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, half);
}

}  // namespace ragtop::scenes
