#pragma once

#include <array>
#include <span>
#include <vector>

#include "shapes/geometry.h"

/// The steps of building a TriangleMesh.
namespace ragtop {

/// By how much the surface turns at the edge along `direction` of a triangle with normal `own` into the neighbour with
/// normal `other`: in (−π, π], positive where convex.
float bendAt(const Vec3& own, const Vec3& other, const Vec3& direction);
/// Does an edge that bends so take part in collisions?
bool isActiveBend(float bend);

/// Unit normal by the right-hand rule in double; zero when the area is zero next to the longest edge squared.
Vec3 triangleNormal(const Vec3& a, const Vec3& b, const Vec3& c);

/// One number for all vertices at the same place.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& vertices);

/// An edge of a triangle as its boundary runs, keyed by the names of its ends regardless of direction.
struct HalfEdge {
    std::uint32_t low, high;
    bool reversed;  ///< runs from high to low
    std::uint32_t triangle;
    std::uint8_t edge;
};
/// Those of the same edge one after the other. `name` as weld gives it.
std::vector<HalfEdge> sortedHalfEdges(std::span<const Triangle> triangles, std::span<const std::uint32_t> name);

/// The triangles at one edge. Of several behind it the surface goes on into the one that is met first in front.
class EdgeFan {
public:
    /// `halves`, which it keeps, are all those of one edge.
    EdgeFan(const MeshTables& mesh, std::span<const HalfEdge> halves);

    struct Next {
        float bend = kPi;  ///< as bendAt has it; π where there is none
        std::uint32_t triangle = kNoTriangle;
    };
    Next next(const HalfEdge& own) const;

private:
    struct Side {
        float angle;  ///< rad, of the normal about the edge, as those see it that run the other way
        std::uint32_t triangle;
    };
    float angleOf(std::uint32_t triangle) const;
    Next nextOfMany(const HalfEdge& own) const;

    const MeshTables& mesh_;
    std::span<const HalfEdge> halves_;
    Vec3 along_;
    std::array<std::vector<Side>, 2>
        sides_;  ///< where there are many: by the way that they run, in the order of angles
};

/// Fills activeEdges out of vertices, triangles and normals; vertices at the same place count as one.
void findActiveEdges(MeshTables& mesh);

/// Puts triangles, normals and sourceIndex in tree order and fills branches.
void buildTree(MeshTables& mesh);

/// The mesh of finished tables, which it keeps.
MeshData meshOn(MeshTables&& tables);
/// The same without keeping them.
MeshData viewOf(const MeshTables& tables);

/// The surface of a convex polyhedron.
MeshData meshOf(const HullData& hull);

/// Fills what a mesh that moves is collided by, after all else.
void findSolid(MeshTables& mesh);

}  // namespace ragtop
