#include <stdexcept>
#include <string>

#include "base/check_tunables.h"
#include "ragtop/body.h"
#include "shapes/mesh_build.h"

namespace ragtop {
namespace {

[[noreturn]] void rejectMesh(const std::string& why) { throw std::invalid_argument("TriangleMesh: " + why); }

std::string item(const char* list, std::size_t i) { return std::string(list) + "[" + std::to_string(i) + "]"; }

void checkVertices(std::span<const Vec3> vertices) {
    if (vertices.empty()) rejectMesh("vertices is empty, must have at least 3");
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (const std::string why = whyNotFinite(item("vertices", i), vertices[i]); !why.empty()) rejectMesh(why);
    }
}

void checkTriangles(std::span<const Triangle> triangles, std::size_t vertexCount) {
    if (triangles.empty()) rejectMesh("triangles is empty, must have at least 1");
    if (triangles.size() > 0x7fffffffu) {
        rejectMesh("triangles has " + std::to_string(triangles.size()) + " entries, must have at most 2147483647");
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto check = [&](const char* corner, std::uint32_t index) {
            if (index < vertexCount) return;
            rejectMesh(item("triangles", i) + corner + " is " + std::to_string(index) + ", must be in [0, " +
                       std::to_string(vertexCount - 1) + "]");
        };
        check(".a", triangles[i].a);
        check(".b", triangles[i].b);
        check(".c", triangles[i].c);
    }
}

void checkMaterials(std::span<const std::uint8_t> materialOfTriangle, std::span<const Material> materials,
                    std::size_t triangleCount) {
    if (!materialOfTriangle.empty() && materialOfTriangle.size() != triangleCount) {
        rejectMesh("materialOfTriangle has " + std::to_string(materialOfTriangle.size()) +
                   " entries, must have none or one per triangle, " + std::to_string(triangleCount));
    }
    for (std::size_t i = 0; i < materialOfTriangle.size(); ++i) {
        if (materialOfTriangle[i] < materials.size()) continue;
        rejectMesh(item("materialOfTriangle", i) + " is " + std::to_string(materialOfTriangle[i]) +
                   ", must be less than the number of materials, " + std::to_string(materials.size()));
    }
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const std::string why = whyInvalid(materials[i]);
        if (!why.empty()) rejectMesh(item("materials", i) + "." + why);
    }
}

/// Those with area.
void takeTriangles(MeshTables& mesh) {
    for (std::uint32_t i = 0; i < mesh.sourceTriangles.size(); ++i) {
        const Triangle& t = mesh.sourceTriangles[i];
        const Vec3 normal = triangleNormal(mesh.vertices[t.a], mesh.vertices[t.b], mesh.vertices[t.c]);
        if (normal == Vec3{}) {
            ++mesh.degenerateCount;
            continue;
        }
        mesh.triangles.push_back(t);
        mesh.normals.push_back(normal);
        mesh.sourceIndex.push_back(i);
    }
}

void finish(MeshTables& mesh) {
    findActiveEdges(mesh);
    buildTree(mesh);
    findSolid(mesh);
}

}  // namespace

MeshData viewOf(const MeshTables& tables) {
    MeshData mesh;
    static_cast<MeshParts<TableInPlace>&>(mesh) = {
        tables.vertices,        tables.triangles,   tables.sourceIndex,
        tables.normals,         tables.activeEdges, tables.materialOfTriangle,
        tables.materials,       tables.branches,    tables.sourceTriangles,
        tables.degenerateCount, tables.bounds,      tables.neighbours,
        tables.vertexNormals,   tables.owned,       tables.whyNotSolid,
        tables.thickness};
    return mesh;
}

MeshData meshOn(MeshTables&& tables) {
    const auto kept = std::make_shared<const MeshTables>(std::move(tables));
    MeshData mesh = viewOf(*kept);
    mesh.owner = kept;
    return mesh;
}

MeshData meshOf(const HullData& hull) {
    MeshTables mesh;
    mesh.vertices.assign(hull.vertices.begin(), hull.vertices.end());
    for (const HullData::Face& face : hull.faces) {
        const auto corner = [&](int i) {
            return static_cast<std::uint32_t>(hull.faceIndices[static_cast<std::size_t>(face.firstIndex + i)]);
        };
        for (int i = 2; i < face.count; ++i) mesh.sourceTriangles.push_back({corner(0), corner(i - 1), corner(i)});
    }
    takeTriangles(mesh);
    finish(mesh);
    return meshOn(std::move(mesh));
}

TriangleMesh::TriangleMesh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                           std::span<const std::uint8_t> materialOfTriangle, std::span<const Material> materials) {
    checkVertices(vertices);
    checkTriangles(triangles, vertices.size());
    checkMaterials(materialOfTriangle, materials, triangles.size());

    MeshTables mesh;
    mesh.vertices.assign(vertices.begin(), vertices.end());
    mesh.sourceTriangles.assign(triangles.begin(), triangles.end());
    mesh.materialOfTriangle.assign(materialOfTriangle.begin(), materialOfTriangle.end());
    mesh.materials.assign(materials.begin(), materials.end());
    takeTriangles(mesh);
    if (mesh.triangles.empty()) {
        rejectMesh("triangles has " + std::to_string(triangles.size()) +
                   " without area, must have at least 1 with area");
    }
    finish(mesh);
    data_ = std::make_shared<const MeshData>(meshOn(std::move(mesh)));
}

std::span<const Vec3> TriangleMesh::vertices() const { return data_->vertices; }
std::span<const Triangle> TriangleMesh::triangles() const { return data_->sourceTriangles; }
int TriangleMesh::degenerateCount() const { return data_->degenerateCount; }

}  // namespace ragtop
