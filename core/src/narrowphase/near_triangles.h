#pragma once

#include <cstdint>
#include <limits>

#include "shapes/geometry.h"

/// The triangles around a shape that moves on a mesh, kept from step to step: while it stays among them the tree of the
/// mesh need not be walked. They are those that a walk would find, in its order, so that remembering changes no result.
namespace ragtop {

struct alignas(64) NearTriangles {
    static constexpr int kMost = 24;  ///< remembered, six groups of four
    static constexpr int kTooMany = kMost + 1;

    /// In the mesh. What lies within it meets no triangles but these; at first nothing does.
    Bounds around{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
    std::int32_t count = 0;  ///< kTooMany: they are not kept
    std::uint32_t triangles[kMost] = {};

private:
    static constexpr float kFar = std::numeric_limits<float>::max();
};
static_assert(sizeof(NearTriangles) == 128);

/// Takes all triangles in `around`, if there is room.
inline void lookAround(const MeshData& mesh, const Bounds& around, NearTriangles& near) {
    near.around = around;
    near.count = 0;
    walkTriangles(mesh, around, [&near](std::uint32_t triangle, const TriangleView&) {
        if (near.count < NearTriangles::kMost) near.triangles[near.count] = triangle;
        return ++near.count < NearTriangles::kTooMany;
    });
}

/// As forEachTriangle without memory. Looks around by `room` (m) farther than asked where it must.
template <class Visit>
void forEachTriangle(const MeshData& mesh, const Bounds& bounds, float room, NearTriangles& near, Visit&& visit) {
    if (!contains(near.around, bounds)) {
        const Vec3 farther{room, room, room};
        lookAround(mesh, {bounds.lower - farther, bounds.upper + farther}, near);
    }
    if (near.count == NearTriangles::kTooMany) return forEachTriangle(mesh, bounds, visit);
    for (int i = 0; i < near.count; ++i) {
        const TriangleView view = triangleOf(mesh, near.triangles[i]);
        if (overlaps(boundsOfTriangle(view.a, view.b, view.c), bounds) && !visit(view)) return;
    }
}

}  // namespace ragtop
