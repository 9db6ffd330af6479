#include <algorithm>
#include <cmath>

#include "base/check_tunables.h"
#include "shapes/mesh_build.h"
#include "shapes/solid_mass.h"

namespace ragtop {
namespace {

/// Calls visit(first, last) for the half-edges of each edge.
template <class Visit>
void forEachEdge(const std::vector<HalfEdge>& halves, Visit&& visit) {
    for (std::size_t first = 0, last = 0; first < halves.size(); first = last) {
        while (last < halves.size() && halves[last].low == halves[first].low &&
               halves[last].high == halves[first].high) {
            ++last;
        }
        visit(first, last);
    }
}

/// Of several neighbours the one met first in front of the face, as findActiveEdges has it.
void findNeighbours(MeshTables& mesh, const std::vector<HalfEdge>& halves) {
    mesh.neighbours.assign(mesh.triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
    mesh.owned.assign(mesh.triangles.size(), 0);
    forEachEdge(halves, [&](std::size_t first, std::size_t last) {
        const EdgeFan fan(mesh, std::span(halves).subspan(first, last - first));
        for (std::size_t i = first; i < last; ++i) {
            const HalfEdge& own = halves[i];
            const std::uint32_t neighbour = mesh.neighbours[own.triangle][own.edge] = fan.next(own).triangle;
            const bool owns = neighbour == kNoTriangle || own.triangle < neighbour;
            if (owns) mesh.owned[own.triangle] = static_cast<std::uint8_t>(mesh.owned[own.triangle] | 1u << own.edge);
        }
    });
}

/// The sum of normals by the angles of the faces tells inside from outside at a vertex, whatever the triangles
/// [Bærentzen, Aanæs, Signed Distance Computation Using the Angle Weighted Pseudonormal, 2005].
void findVertexNormals(MeshTables& mesh, const std::vector<std::uint32_t>& name) {
    std::vector<DVec3> sums(mesh.vertices.size());
    std::vector<std::uint8_t> taken(mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& triangle = mesh.triangles[t];
        const std::uint32_t corner[3] = {triangle.a, triangle.b, triangle.c};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& at = mesh.vertices[corner[k]];
            const Vec3 u = mesh.vertices[corner[(k + 1) % 3]] - at, v = mesh.vertices[corner[(k + 2) % 3]] - at;
            const float angle = arcTan2(length(cross(u, v)), dot(u, v));
            const std::uint32_t vertex = name[corner[k]];
            sums[vertex] = sums[vertex] + static_cast<double>(angle) * DVec3(mesh.normals[t]);
            if (taken[vertex] == 0) mesh.owned[t] = static_cast<std::uint8_t>(mesh.owned[t] | 8u << k);
            taken[vertex] = 1;
        }
    }
    mesh.vertexNormals.resize(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const DVec3& sum = sums[name[i]];
        const double size = std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
        constexpr double kNothing = 1e-3;  // rad: the faces are back to back
        mesh.vertexNormals[i] = size > kNothing ? toVec3((1 / size) * sum) : Vec3{};
    }
}

/// As the caller gave the triangles, those without area included: they may be what closes the surface.
std::string whyOpen(const MeshTables& mesh, const std::vector<std::uint32_t>& name) {
    std::string why;
    const std::vector<HalfEdge> halves = sortedHalfEdges(mesh.sourceTriangles, name);
    forEachEdge(halves, [&](std::size_t first, std::size_t last) {
        if (!why.empty() || halves[first].low == halves[first].high) return;
        std::size_t reversed = 0;
        for (std::size_t i = first; i < last; ++i) reversed += halves[i].reversed ? 1 : 0;
        if (2 * reversed == last - first) return;
        const bool turned = (last - first) % 2 == 0;
        why = (turned ? "has triangles of opposite orientation" : "is open") +
              std::string(" at the edge of vertices ") + std::to_string(halves[first].low) + " and " +
              std::to_string(halves[first].high);
    });
    return why;
}

double areaOf(const MeshTables& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const DVec3 u = DVec3(mesh.vertices[t.b]) - DVec3(mesh.vertices[t.a]);
        const DVec3 v = DVec3(mesh.vertices[t.c]) - DVec3(mesh.vertices[t.a]);
        const DVec3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
        sum += 0.5 * std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    }
    return sum;
}

}  // namespace

void findSolid(MeshTables& mesh) {
    const std::vector<std::uint32_t> name = weld(mesh.vertices);
    findNeighbours(mesh, sortedHalfEdges(mesh.triangles, name));
    findVertexNormals(mesh, name);
    mesh.whyNotSolid = whyOpen(mesh, name);
    const double area = areaOf(mesh);
    const double volume = mesh.whyNotSolid.empty() ? massOfMesh(viewOf(mesh), 1).mass : 0;
    constexpr double kNoVolume = 1e-6;  // of the surface to the power of 3/2
    if (mesh.whyNotSolid.empty() && !(volume > kNoVolume * area * std::sqrt(area)))
        mesh.whyNotSolid = "has a volume of " + numberText(static_cast<float>(volume)) +
                           " m³, which triangles that are clockwise seen from outside make";
    constexpr double kSheet = 0.02;  // of the size: what is open has no thickness of its own
    const Vec3 extent = mesh.bounds.upper - mesh.bounds.lower;
    mesh.thickness = static_cast<float>(mesh.whyNotSolid.empty()
                                            ? 2 * volume / area
                                            : kSheet * static_cast<double>(std::max({extent.x, extent.y, extent.z})));
}

}  // namespace ragtop
