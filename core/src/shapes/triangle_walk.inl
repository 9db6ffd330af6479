#pragma once

#include <bit>
#include <cassert>
#include <cstdint>

#include "base/four_floats.h"

namespace ragtop {

/// Deeper trees than this are never built (mesh_tree.cpp).
inline constexpr int kMeshTreeDepth = 80;
/// Of a walk: every level leaves all children but one waiting.
inline constexpr int kMostWaiting = (MeshBranch::kWidth - 1) * kMeshTreeDepth + 1;

inline Bounds boundsOfTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {min(min(a, b), c), max(max(a, b), c)};
}

/// Bit i for each child whose bounds meet `bounds`, as `overlaps` says.
inline unsigned childrenMeeting(const MeshBranch& branch, const Bounds& bounds) {
    static_assert(MeshBranch::kWidth == 4);
    FourInts meets = {-1, -1, -1, -1};
    for (int axis = 0; axis < 3; ++axis) {
        meets &= loadFour(branch.lower[axis]) <= bounds.upper[axis];
        meets &= loadFour(branch.upper[axis]) >= bounds.lower[axis];
    }
    return lanesWhere(meets);
}

inline TriangleView triangleOf(const MeshData& mesh, std::uint32_t i) {
    const Triangle& t = mesh.triangles[i];
    return {mesh.vertices[t.a], mesh.vertices[t.b],  mesh.vertices[t.c],
            mesh.normals[i],    mesh.activeEdges[i], mesh.sourceIndex[i]};
}

/// As forEachTriangle, with visit(place in the order of the tree, const TriangleView&).
template <class Visit>
void walkTriangles(const MeshData& mesh, const Bounds& bounds, Visit&& visit) {
    struct Waiting {
        std::uint32_t first, count;  ///< as in MeshBranch
    };
    Waiting stack[kMostWaiting];
    stack[0] = {0, 0};
    for (int waiting = 1; waiting > 0;) {
        const Waiting next = stack[--waiting];
        if (next.count == 0) {
            const MeshBranch& branch = mesh.branches[next.first];
            // The first child is looked at next, so it goes on top.
            for (unsigned near = childrenMeeting(branch, bounds); near != 0;) {
                const int child = static_cast<int>(std::bit_width(near)) - 1;
                near ^= 1u << child;
                assert(waiting < kMostWaiting);
                stack[waiting++] = {branch.first[child], branch.count[child]};
            }
            continue;
        }
        for (std::uint32_t i = next.first; i < next.first + next.count; ++i) {
            const TriangleView view = triangleOf(mesh, i);
            if (overlaps(boundsOfTriangle(view.a, view.b, view.c), bounds) && !visit(i, view)) return;
        }
    }
}

template <class Visit>
void forEachTriangle(const MeshData& mesh, const Bounds& bounds, Visit&& visit) {
    walkTriangles(mesh, bounds, [&visit](std::uint32_t, const TriangleView& view) { return visit(view); });
}

/// The first and last cell, inclusive, that meet [lower, upper] along an axis; first > last when none does.
struct CellRange {
    int first, last;
};
inline CellRange cellsMeeting(float lower, float upper, float spacing, int cells) {
    const float most = static_cast<float>(cells);
    const float from = lower / spacing, to = upper / spacing;
    if (!(from <= most + 1) || !(to >= -1)) return {0, -1};
    // One more on either side than the quotients say: they are rounded, and touching counts.
    int first = from > 1 ? static_cast<int>(from) - 1 : 0;
    int last = to < most - 1 ? (to > 0 ? static_cast<int>(to) + 1 : 0) : cells - 1;
    while (first <= last && static_cast<float>(first + 1) * spacing < lower) ++first;
    while (first <= last && static_cast<float>(last) * spacing > upper) --last;
    return {first, last};
}

inline bool isHole(const Vec3& normal) { return normal.y == 0; }

/// The triangle `half` (0 or 1) of a cell, whose corners are (i, j), (i, j+1), (i+1, j+1) and (i, j), (i+1, j+1),
/// (i+1, j); its normal is zero in a hole.
inline TriangleView triangleOf(const HeightFieldData& field, int column, int row, int half) {
    const auto corner = [&](int i, int j) {
        return Vec3{static_cast<float>(i) * field.spacing,
                    field.heights[static_cast<std::size_t>(j) * static_cast<std::size_t>(field.columns) +
                                  static_cast<std::size_t>(i)],
                    static_cast<float>(j) * field.spacing};
    };
    const std::size_t index = 2 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns - 1) +
                                   static_cast<std::size_t>(column)) +
                              static_cast<std::size_t>(half);
    const Vec3 near = corner(column, row), far = corner(column + 1, row + 1);
    return {near,
            half == 0 ? corner(column, row + 1) : far,
            half == 0 ? far : corner(column + 1, row),
            field.normals[index],
            field.activeEdges[index],
            static_cast<std::uint32_t>(index)};
}

/// Are all heights of a cell above bounds or below them? A hole never is.
inline bool isBeside(const HeightFieldData& field, int column, int row, const Bounds& bounds) {
    const float* near = &field.heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns) +
                                       static_cast<std::size_t>(column)];
    const float* far = near + field.columns;
    const float lower = bounds.lower.y, upper = bounds.upper.y;
    return (near[0] < lower && near[1] < lower && far[0] < lower && far[1] < lower) ||
           (near[0] > upper && near[1] > upper && far[0] > upper && far[1] > upper);
}

template <class Visit>
void forEachTriangle(const HeightFieldData& field, const Bounds& bounds, Visit&& visit) {
    if (!(bounds.lower.y <= field.highest && bounds.upper.y >= field.lowest)) return;
    const CellRange columns = cellsMeeting(bounds.lower.x, bounds.upper.x, field.spacing, field.columns - 1);
    const CellRange rows = cellsMeeting(bounds.lower.z, bounds.upper.z, field.spacing, field.rows - 1);
    for (int row = rows.first; row <= rows.last; ++row) {
        for (int column = columns.first; column <= columns.last; ++column) {
            if (isBeside(field, column, row, bounds)) continue;
            for (int half = 0; half < 2; ++half) {
                const TriangleView view = triangleOf(field, column, row, half);
                if (isHole(view.normal) || !overlaps(boundsOfTriangle(view.a, view.b, view.c), bounds)) continue;
                if (!visit(view)) return;
            }
        }
    }
}

}  // namespace ragtop
