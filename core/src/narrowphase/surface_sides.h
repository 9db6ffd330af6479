#pragma once

#include <cassert>

#include "narrowphase/triangle_feature.h"
#include "shapes/geometry.h"

/// Surfaces as collideSurfaces reads them, all in one frame: the axes of A about the origin of B, so that they are
/// exact however far from the origin of a mesh they meet.
namespace ragtop::surface {

/// A triangle in that frame.
struct Facet {
    Vec3 v[3];
    Vec3 normal;
    std::uint32_t index = 0;   ///< in the surface
    std::uint32_t source = 0;  ///< as TriangleView has it
    std::uint8_t activeEdges = 0, owned = 0;

    Bounds bounds() const { return {min(min(v[0], v[1]), v[2]), max(max(v[0], v[1]), v[2])}; }
    Vec3 edge(int i) const { return v[i == 2 ? 0 : i + 1] - v[i]; }
    bool owns(int edge) const { return (owned >> edge & 1) != 0 && (activeEdges >> edge & 1) != 0; }
    bool ownsVertex(int corner) const { return (owned >> (3 + corner) & 1) != 0; }
};

constexpr Bounds grownBy(const Bounds& b, float by) { return {b.lower - Vec3{by, by, by}, b.upper + Vec3{by, by, by}}; }

/// Goes down the tree where enter(bounds of a child) says so, and calls visit(index of a triangle) until it returns
/// false.
template <class Enter, class Visit>
void walk(const MeshData& mesh, Enter&& enter, Visit&& visit) {
    struct Waiting {
        std::uint32_t branch;
        int child;
    };
    Waiting stack[kMostWaiting];
    int waiting = 0;
    const auto push = [&](std::uint32_t branch) {
        for (int child = mesh.branches[branch].children(); child-- > 0;) {
            assert(waiting < kMostWaiting);
            stack[waiting++] = {branch, child};
        }
    };
    if (enter(mesh.bounds)) push(0);
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        const MeshBranch& branch = mesh.branches[next.branch];
        if (!enter(branch.bounds(next.child))) continue;
        const std::uint32_t first = branch.first[next.child], count = branch.count[next.child];
        if (count == 0) push(first);
        for (std::uint32_t i = first; i < first + count; ++i)
            if (!visit(i)) return;
    }
}

class MeshSide {
public:
    /// A mesh whose axes are those of the frame, with `offset` at its origin.
    MeshSide(const MeshData& mesh, const Vec3& offset) : mesh_(mesh), offset_(offset) { findBounds(); }
    /// A mesh about the origin of the frame, turned.
    MeshSide(const MeshData& mesh, const Quat& rotation) : mesh_(mesh), turned_(true), turn_(toMat3(rotation)) {
        findBounds();
    }

    bool encloses() const { return mesh_.whyNotSolid.empty(); }
    const Bounds& bounds() const { return bounds_; }
    Facet facet(std::uint32_t i) const {
        const Triangle& t = mesh_.triangles[i];
        return {{placed(mesh_.vertices[t.a]), placed(mesh_.vertices[t.b]), placed(mesh_.vertices[t.c])},
                turned(mesh_.normals[i]),
                i,
                mesh_.sourceIndex[i],
                mesh_.activeEdges[i],
                mesh_.owned[i]};
    }
    std::uint32_t vertexName(const Facet& facet, int corner) const {
        const Triangle& t = mesh_.triangles[facet.index];
        return corner == 0 ? t.a : corner == 1 ? t.b : t.c;
    }
    Vec3 vertexNormal(const Facet& facet, int corner) const {
        return turned(mesh_.vertexNormals[vertexName(facet, corner)]);
    }
    /// Normal of the face beyond an edge; false at a border.
    bool beyond(const Facet& facet, int edge, Vec3& normal) const {
        const std::uint32_t other = mesh_.neighbours[facet.index][static_cast<std::size_t>(edge)];
        if (other == kNoTriangle) return false;
        normal = turned(mesh_.normals[other]);
        return true;
    }

    bool anyNear(const Bounds& bounds) const {
        bool any = false;
        forEachFacetIndex(bounds, [&](std::uint32_t) { return !(any = true); });
        return any;
    }
    template <class Visit>
    void forEachFacet(const Bounds& bounds, Visit&& visit) const {
        forEachFacetIndex(bounds, [&](std::uint32_t i) { return visit(facet(i)); });
    }
    /// The facets of branches whose bounds pass a test in the frame.
    template <class Enter, class Visit>
    void descend(Enter&& enter, Visit&& visit) const {
        walk(
            mesh_, [&](const Bounds& node) { return enter(placed(node)); },
            [&](std::uint32_t i) {
                visit(facet(i));
                return true;
            });
    }
    /// The facet nearest to a point.
    Facet nearestFacet(const Vec3& point) const;

private:
    void findBounds() { bounds_ = placed(mesh_.bounds); }
    Vec3 turned(const Vec3& v) const { return turned_ ? turn_ * v : v; }
    Vec3 placed(const Vec3& v) const { return turned_ ? turn_ * v : v - offset_; }
    /// Rounded outwards.
    static Bounds around(const Vec3& center, const Vec3& half) {
        constexpr float kRounding = 1e-6f;  // eight units in the last place
        const Vec3 h = half + kRounding * (abs(center) + half);
        return {center - h, center + h};
    }
    Bounds placed(const Bounds& b) const {
        if (!turned_) return {b.lower - offset_, b.upper - offset_};
        const Vec3 center = 0.5f * (b.lower + b.upper), half = 0.5f * (b.upper - b.lower);
        return around(turn_ * center, half.x * abs(turn_.cx) + half.y * abs(turn_.cy) + half.z * abs(turn_.cz));
    }
    Bounds local(const Bounds& b) const {
        if (!turned_) return around(0.5f * (b.lower + b.upper) + offset_, 0.5f * (b.upper - b.lower));
        const Vec3 center = 0.5f * (b.lower + b.upper), half = 0.5f * (b.upper - b.lower);
        return around(transposeTimes(turn_, center),
                      {dot(abs(turn_.cx), half), dot(abs(turn_.cy), half), dot(abs(turn_.cz), half)});
    }
    template <class Visit>
    void forEachFacetIndex(const Bounds& bounds, Visit&& visit) const {
        const Bounds near = local(bounds);
        walk(
            mesh_, [&](const Bounds& node) { return overlaps(node, near); },
            [&](std::uint32_t i) {
                const Triangle& t = mesh_.triangles[i];
                const Bounds own = boundsOfTriangle(mesh_.vertices[t.a], mesh_.vertices[t.b], mesh_.vertices[t.c]);
                return !overlaps(own, near) || visit(i);
            });
    }

    const MeshData& mesh_;
    Vec3 offset_;
    bool turned_ = false;
    Mat3 turn_;
    Bounds bounds_;
};

inline Facet MeshSide::nearestFacet(const Vec3& point) const {
    const Vec3 p = turned_ ? transposeTimes(turn_, point) : point + offset_;
    const auto outside = [&](const Bounds& b) {
        const Vec3 away = max(max(b.lower - p, p - b.upper), Vec3{});
        return lengthSquared(away);
    };
    float least = 0;
    std::uint32_t best = kNoTriangle;
    walk(
        mesh_, [&](const Bounds& node) { return best == kNoTriangle || outside(node) < least; },
        [&](std::uint32_t i) {
            const Triangle& t = mesh_.triangles[i];
            const Vec3 v[3] = {mesh_.vertices[t.a], mesh_.vertices[t.b], mesh_.vertices[t.c]};
            Feature feature;
            const float square = lengthSquared(nearestOnTriangle(v, mesh_.normals[i], p, feature) - p);
            if (best == kNoTriangle || square < least) least = square, best = i;
            return true;
        });
    return facet(best);
}

class FieldSide {
public:
    FieldSide(const HeightFieldData& field, const Vec3& offset) : field_(field), offset_(offset) {
        const float spacing = field.spacing;
        bounds_ = {Vec3{0, field.lowest, 0} - offset,
                   Vec3{static_cast<float>(field.columns - 1) * spacing, field.highest,
                        static_cast<float>(field.rows - 1) * spacing} -
                       offset};
    }

    bool encloses() const { return false; }
    const Bounds& bounds() const { return bounds_; }
    std::uint32_t vertexName(const Facet& facet, int corner) const {
        const Vertex at = vertexOf(facet.index, corner);
        return static_cast<std::uint32_t>(at.row * field_.columns + at.column);
    }
    Vec3 vertexNormal(const Facet& facet, int corner) const {
        Vec3 sum;
        forEachAround(vertexOf(facet.index, corner), [&](std::uint32_t i) { sum += field_.normals[i]; });
        return normalized(sum);
    }
    bool beyond(const Facet& facet, int edge, Vec3& normal) const {
        const std::uint32_t other = neighbour(facet.index, edge);
        if (other == kNoTriangle) return false;
        normal = field_.normals[other];
        return true;
    }
    bool anyNear(const Bounds& bounds) const {
        bool any = false;
        forEachTriangle(field_, local(bounds), [&](const TriangleView&) { return !(any = true); });
        return any;
    }
    template <class Visit>
    void forEachFacet(const Bounds& bounds, Visit&& visit) const {
        forEachTriangle(field_, local(bounds), [&](const TriangleView& view) { return visit(facetOf(view)); });
    }

private:
    struct Vertex {
        int column, row;
    };
    int cells() const { return field_.columns - 1; }
    Vertex vertexOf(std::uint32_t index, int corner) const {
        const int cell = static_cast<int>(index / 2), column = cell % cells(), row = cell / cells();
        if (corner == 0) return {column, row};
        const bool far = (index & 1) == 0 ? corner == 2 : corner == 1;
        if (far) return {column + 1, row + 1};
        return (index & 1) == 0 ? Vertex{column, row + 1} : Vertex{column + 1, row};
    }
    /// kNoTriangle beyond the border and in a hole.
    std::uint32_t at(int column, int row, std::uint32_t half) const {
        if (column < 0 || row < 0 || column >= cells() || row >= field_.rows - 1) return kNoTriangle;
        const std::uint32_t index = 2 * static_cast<std::uint32_t>(row * cells() + column) + half;
        return isHole(field_.normals[index]) ? kNoTriangle : index;
    }
    std::uint32_t neighbour(std::uint32_t index, int edge) const {
        const int cell = static_cast<int>(index / 2), column = cell % cells(), row = cell / cells();
        if ((index & 1) == 0) return edge == 0 ? at(column - 1, row, 1) : at(column, edge == 1 ? row + 1 : row, 1);
        return edge == 0 ? at(column, row, 0) : edge == 1 ? at(column + 1, row, 0) : at(column, row - 1, 0);
    }
    template <class Visit>
    void forEachAround(const Vertex& v, Visit&& visit) const {
        for (const std::uint32_t i :
             {at(v.column - 1, v.row - 1, 0), at(v.column - 1, v.row - 1, 1), at(v.column, v.row - 1, 0),
              at(v.column - 1, v.row, 1), at(v.column, v.row, 0), at(v.column, v.row, 1)})
            if (i != kNoTriangle) visit(i);
    }
    Facet facetOf(const TriangleView& view) const {
        Facet facet{{view.a - offset_, view.b - offset_, view.c - offset_},
                    view.normal,
                    view.index,
                    view.index,
                    view.activeEdges,
                    0};
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t other = neighbour(view.index, k);
            if (other == kNoTriangle || view.index < other)
                facet.owned = static_cast<std::uint8_t>(facet.owned | 1u << k);
            std::uint32_t first = kNoTriangle;
            forEachAround(vertexOf(view.index, k), [&](std::uint32_t i) { first = i < first ? i : first; });
            if (first == view.index) facet.owned = static_cast<std::uint8_t>(facet.owned | 8u << k);
        }
        return facet;
    }
    Bounds local(const Bounds& b) const { return {b.lower + offset_, b.upper + offset_}; }

    const HeightFieldData& field_;
    Vec3 offset_;
    Bounds bounds_;
};

/// A ball, or a capsule: its core and the thickness around it.
struct RoundSide {
    Vec3 p, q;
    float radius = 0;
    Bounds box;

    RoundSide(const ConvexView& shape, const Quat& rotation)
        : p(rotate(rotation, -shape.halfExtents)),
          q(-p),
          radius(shape.radius),
          box(grownBy({min(p, q), max(p, q)}, radius)) {}
    const Bounds& bounds() const { return box; }
};

}  // namespace ragtop::surface
