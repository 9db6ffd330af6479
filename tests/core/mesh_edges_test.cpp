#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "ragtop/shape.h"
#include "shapes/mesh_build.h"

namespace ragtop {
namespace {

/// Triangles at the edge from the origin along z, at any angles about it, that run one way or the other.
MeshTables pages(std::size_t count, unsigned seed) {
    MeshTables mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const float angle = 2 * kPi * static_cast<float>(random()) / 4294967296.0f;
        const auto far = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0.5f});
        mesh.triangles.push_back(random() % 2 ? Triangle{0, 1, far} : Triangle{1, 0, far});
        const Triangle& t = mesh.triangles.back();
        mesh.normals.push_back(triangleNormal(mesh.vertices[t.a], mesh.vertices[t.b], mesh.vertices[t.c]));
    }
    return mesh;
}

std::vector<HalfEdge> halvesAtSpine(const MeshTables& mesh) {
    std::vector<HalfEdge> halves;
    for (const HalfEdge& half : sortedHalfEdges(mesh.triangles, weld(mesh.vertices)))
        if (half.low == 0 && half.high == 1) halves.push_back(half);
    return halves;
}

TEST(EdgeFan, GoesOnIntoTheFaceThatIsMetFirstHoweverManyThereAre) {
    for (const std::size_t count : {3u, 16u, 17u, 40u, 400u})
        for (unsigned seed = 0; seed < 20; ++seed) {
            const MeshTables mesh = pages(count, seed);
            const std::vector<HalfEdge> halves = halvesAtSpine(mesh);
            ASSERT_EQ(halves.size(), count);
            const EdgeFan fan(mesh, halves);
            for (const HalfEdge& own : halves) {
                float least = kPi;
                for (const HalfEdge& other : halves)
                    if (other.reversed != own.reversed)
                        least = std::min(least, bendAt(mesh.normals[own.triangle], mesh.normals[other.triangle],
                                                       {0, 0, own.reversed ? -1.0f : 1.0f}));
                const EdgeFan::Next next = fan.next(own);
                EXPECT_NEAR(next.bend, least, 2e-6f) << count << " " << seed;  // three roundings of an angle
                if (next.triangle == kNoTriangle) continue;
                EXPECT_NEAR(bendAt(mesh.normals[own.triangle], mesh.normals[next.triangle],
                                   {0, 0, own.reversed ? -1.0f : 1.0f}),
                            least, 2e-6f);
            }
        }
}

/// Comparing each of them with each would take minutes.
TEST(EdgeFan, OfAHundredThousandTrianglesAtOneEdgeIsAMeshAllTheSame) {
    const MeshTables mesh = pages(100'000, 1);
    const TriangleMesh built(mesh.vertices, mesh.triangles);
    EXPECT_EQ(built.triangles().size(), 100'000u);
}

}  // namespace
}  // namespace ragtop
