#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shapes/geometry.h"

/// Polyhedra as the narrow phase reads them, whether they come from a ConvexHull or from a Box.
namespace ragtop {

/// Borrowed parts of a HullData or BoxHull; valid while that lives.
struct HullView {
    std::span<const Vec3> vertices;
    std::span<const Plane> planes;
    std::span<const HullData::Face> faces;
    std::span<const std::uint8_t> faceIndices;
    std::span<const HullData::Edge> edges;
    Vec3 center;
    float innerRadius = 0;

    std::span<const std::uint8_t> loop(std::size_t face) const {
        return faceIndices.subspan(faces[face].firstIndex, faces[face].count);
    }
};

inline HullView viewOf(const HullData& hull) {
    return {hull.vertices, hull.planes, hull.faces, hull.faceIndices, hull.edges, hull.center, hull.innerRadius};
}

/// The topology of every box. Vertex 4x + 2y + z has the positive sides of the axes whose bits are set; faces and
/// edges are in the order in which ConvexHull would put them.
namespace box_topology {

inline constexpr std::array<std::uint8_t, 24> kFaceIndices{0, 1, 3, 2, 0, 2, 6, 4, 0, 4, 5, 1,
                                                           1, 5, 7, 3, 2, 3, 7, 6, 4, 6, 7, 5};
inline constexpr std::array<HullData::Face, 6> kFaces{{{0, 4}, {4, 4}, {8, 4}, {12, 4}, {16, 4}, {20, 4}}};
inline constexpr std::array<Vec3, 6> kNormals{{{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}}};
inline constexpr std::array<HullData::Edge, 12> kEdges{{{0, 1, 0, 2},
                                                        {0, 2, 1, 0},
                                                        {0, 4, 2, 1},
                                                        {1, 3, 0, 3},
                                                        {1, 5, 3, 2},
                                                        {2, 3, 4, 0},
                                                        {2, 6, 1, 4},
                                                        {3, 7, 4, 3},
                                                        {4, 5, 2, 5},
                                                        {4, 6, 5, 1},
                                                        {5, 7, 3, 5},
                                                        {6, 7, 5, 4}}};

}  // namespace box_topology

/// A box as a polyhedron, without allocation.
struct BoxHull {
    std::array<Vec3, 8> vertices;
    std::array<Plane, 6> planes;
    float innerRadius = 0;

    constexpr explicit BoxHull(const Vec3& halfExtents) {
        for (std::size_t i = 0; i < 8; ++i) {
            vertices[i] = {i & 4 ? halfExtents.x : -halfExtents.x, i & 2 ? halfExtents.y : -halfExtents.y,
                           i & 1 ? halfExtents.z : -halfExtents.z};
        }
        for (std::size_t i = 0; i < 6; ++i) {
            const Vec3& n = box_topology::kNormals[i];
            planes[i] = {n, dot(abs(n), halfExtents)};
        }
        const float xy = halfExtents.x < halfExtents.y ? halfExtents.x : halfExtents.y;
        innerRadius = xy < halfExtents.z ? xy : halfExtents.z;
    }
    HullView view() const {
        return {vertices, planes,     box_topology::kFaces, box_topology::kFaceIndices, box_topology::kEdges,
                Vec3{},   innerRadius};
    }
};

/// The same as data of its own.
HullData boxHull(const Vec3& halfExtents);

}  // namespace ragtop
