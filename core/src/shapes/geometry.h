#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/shape.h"

/// The immutable data behind shapes, and the small views that the narrow phase works on.
namespace ragtop {

/// normal · x = offset on the plane, less inside.
struct Plane {
    Vec3 normal;
    float offset = 0;
};

/// A convex polyhedron. Faces are counter-clockwise vertex loops seen from outside; every edge is stored once with
/// the faces on its two sides.
struct HullData {
    struct Face {
        std::uint16_t firstIndex = 0;  ///< into faceIndices
        std::uint16_t count = 0;
    };
    struct Edge {
        std::uint8_t from = 0, to = 0;  ///< vertices; left face runs from → to
        std::uint8_t leftFace = 0, rightFace = 0;
    };
    std::vector<Vec3> vertices;
    std::vector<Plane> planes;  ///< per face
    std::vector<Face> faces;
    std::vector<std::uint8_t> faceIndices;
    std::vector<Edge> edges;
    Vec3 center;            ///< centre of mass of the solid
    float innerRadius = 0;  ///< of the largest ball about `center` inside
    Bounds bounds;
};

/// A branch of a bounding volume tree stored depth first, the children in its order. Absent children, behind the
/// others, meet nothing.
struct alignas(64) MeshBranch {
    static constexpr int kWidth = 4;           ///< lanes of FourFloats
    float lower[3][kWidth], upper[3][kWidth];  ///< m, by axis and child
    std::uint32_t first[kWidth] = {};          ///< leaf: first triangle; inner: index of the branch
    std::uint32_t count[kWidth] = {};          ///< leaf: number of triangles; inner: 0

    Bounds bounds(int child) const {
        return {{lower[0][child], lower[1][child], lower[2][child]},
                {upper[0][child], upper[1][child], upper[2][child]}};
    }
    /// The root is no child, and every leaf has triangles.
    int children() const {
        int n = 0;
        while (n < kWidth && (first[n] | count[n]) != 0) ++n;
        return n;
    }
};
static_assert(sizeof(MeshBranch) == 128);

/// The tables of a mesh, each a Table of its elements.
template <template <class> class Table>
struct MeshParts {
    Table<Vec3> vertices;
    Table<Triangle> triangles;         ///< in tree order
    Table<std::uint32_t> sourceIndex;  ///< of each triangle in the caller's list
    Table<Vec3> normals;               ///< per triangle
    /// Bit e (0..2): edge e (a→b, b→c, c→a) is convex, so a shape may touch it; flat and concave edges are inactive and
    /// yield to the faces beside them.
    Table<std::uint8_t> activeEdges;
    Table<std::uint8_t> materialOfTriangle;  ///< in the caller's order, empty or one per triangle
    Table<Material> materials;
    Table<MeshBranch> branches;
    Table<Triangle> sourceTriangles;  ///< as the caller gave them
    int degenerateCount = 0;
    Bounds bounds;

    // What a mesh that moves is collided by.
    /// The triangle beyond each edge, kNoTriangle at a border.
    Table<std::array<std::uint32_t, 3>> neighbours;
    /// Per vertex the mean of the normals around it by their angles, unit; vertices at one place have the same.
    Table<Vec3> vertexNormals;
    /// Bits 0–2 edges, 3–5 vertices: each of the surface is owned by one of its triangles.
    Table<std::uint8_t> owned;
    /// Empty when the surface is closed and its triangles are counter-clockwise seen from outside.
    std::string whyNotSolid;
    /// m, that stands for the size of the solid: twice volume over surface, which is the radius of a rod. Of a surface
    /// that is not solid a small part of its extent.
    float thickness = 0;
};

template <class T>
using TableBeingBuilt = std::vector<T>;
template <class T>
using TableInPlace = std::span<const T>;

struct MeshTables : MeshParts<TableBeingBuilt> {};
/// A mesh to collide with: tables wherever they lie, a file that is mapped into memory included.
struct MeshData : MeshParts<TableInPlace> {
    std::shared_ptr<const void> owner;  ///< keeps the tables
};

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;  ///< no index

struct HeightFieldData {
    int columns = 0, rows = 0;
    float spacing = 1;
    std::vector<float> heights;
    std::vector<Vec3> normals;              ///< two per cell, in cell order
    std::vector<std::uint8_t> activeEdges;  ///< two per cell, as in MeshData
    float lowest = 0, highest = 0;
};

/// A triangle as the narrow phase sees it.
struct TriangleView {
    Vec3 a, b, c;
    Vec3 normal;
    std::uint8_t activeEdges = 7;
    std::uint32_t index = 0;  ///< in the caller's list (mesh) or 2 · cell + half (height field)
};

enum class ConvexKind : std::uint8_t { sphere, capsule, box, hull };

/// A convex shape in its own frame: a core (point, segment, box or hull) thickened by a radius.
struct ConvexView {
    ConvexKind kind = ConvexKind::sphere;
    float radius = 0;                ///< sphere, capsule; 0 for box and hull
    Vec3 halfExtents;                ///< box; capsule: {0, halfHeight, 0}
    const HullData* hull = nullptr;  ///< hull only
};

/// Throws std::invalid_argument for a mesh, height field or compound.
ConvexView convexView(const Shape& shape);
/// A length that stands for the size of a shape: its smallest half extent, or its radius; for meshes and height
/// fields infinity (the other shape decides).
float sizeOf(const Shape& shape);
/// Radius of the smallest ball about `center` that holds the shape.
float radiusAbout(const Shape& shape, const Vec3& center);
/// The bounds of a shape (no Compound) at a pose, rounded outwards.
Bounds boundsOf(const Shape& shape, const Pose& pose);
/// The bounds of a ball that goes from one place to another, rounded outwards.
Bounds boundsOfPath(const DVec3& from, const DVec3& to, float radius);
/// The bounds of a shape in a nearby frame.
Bounds boundsOf(const Shape& shape, const Frame& frame);

/// The farthest point of the core (radius left out) along a direction that need not be a unit vector.
Vec3 supportOfCore(const ConvexView& shape, const Vec3& direction);

/// Calls visit(const TriangleView&) for each triangle whose bounds meet `bounds`, in the order of the tree or grid.
/// visit returns false to end.
template <class Visit>
void forEachTriangle(const MeshData& mesh, const Bounds& bounds, Visit&& visit);
template <class Visit>
void forEachTriangle(const HeightFieldData& field, const Bounds& bounds, Visit&& visit);

}  // namespace ragtop

#include "shapes/triangle_walk.inl"
