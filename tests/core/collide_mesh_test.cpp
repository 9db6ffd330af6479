#include <functional>
#include <limits>

#include "broadphase/broadphase.h"
#include "collide_support.h"
#include "contacts/yielding_shapes.h"
#include "shape_support.h"

namespace ragtop {
namespace {

/// A square of 2 × cells² triangles from −half to half at heights y(x, z), front up.
TriangleMesh gridMesh(int cells, float half, const std::function<float(float, float)>& y, const Vec3& origin = {}) {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    const auto n = static_cast<std::uint32_t>(cells);
    const float spacing = 2 * half / static_cast<float>(cells);
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i) {
            const float x = static_cast<float>(i) * spacing - half, z = static_cast<float>(j) * spacing - half;
            vertices.push_back(origin + Vec3{x, y(x, z), z});
        }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            triangles.push_back({a, c, d});
            triangles.push_back({a, d, b});
        }
    }
    return TriangleMesh(vertices, triangles);
}

float flat(float, float) { return 0; }

TriangleMesh boxMesh(const Vec3& half) {
    const HullData hull = boxHull(half);
    std::vector<Triangle> triangles;
    for (std::size_t f = 0; f < 6; ++f) {
        const auto loop = viewOf(hull).loop(f);
        triangles.push_back({loop[0], loop[1], loop[2]});
        triangles.push_back({loop[0], loop[2], loop[3]});
    }
    return TriangleMesh(hull.vertices, triangles);
}

struct Contacts {
    Manifold manifolds[kMaxManifolds];
    int count = 0;
};

template <class Surface>
Contacts contactsOf(const Surface& surface, const ConvexView& shape, const Frame& frame, float margin) {
    Contacts out;
    out.count = collide(surface.data(), shape, frame, margin, out.manifolds);
    return out;
}

float deepestOf(const Contacts& contacts) {
    float least = std::numeric_limits<float>::infinity();
    for (int i = 0; i < contacts.count; ++i) least = std::min(least, deepest(contacts.manifolds[i]));
    return least;
}

/// Slides a shape over the flat floor: one manifold, straight up, with the depth of the lowest point.
template <class Surface>
void slideOver(const Surface& floor, const ConvexView& shape, const Quat& rotation, float height, int points) {
    Random random(31);
    for (int i = 0; i < 500; ++i) {
        SCOPED_TRACE(i);
        const Quat spun = rotationAbout({0, 1, 0}, random.uniform(-kPi, kPi)) * rotation;
        const Frame frame{{random.uniform(-3, 3), height, random.uniform(-3, 3)}, spun};
        const Contacts contacts = contactsOf(floor, shape, frame, 0.02f);
        ASSERT_EQ(contacts.count, 1);
        const Manifold& m = contacts.manifolds[0];
        expectNear(m.normal, {0, 1, 0}, 1e-6f);
        EXPECT_EQ(m.pointCount, points);
        const float lowest =
            transformPoint(frame, supportOfCore(shape, inverseRotate(spun, {0, -1, 0}))).y - shape.radius;
        EXPECT_NEAR(deepest(m), lowest, 2e-6f);
    }
}

TEST(MeshFloor, ABoxSlidesWithVerticalNormalsOnFourCorners) {
    const TriangleMesh floor = gridMesh(20, 5, flat), fine = gridMesh(100, 5, flat), coarse = gridMesh(1, 5, flat);
    for (const TriangleMesh* mesh : {&floor, &fine, &coarse}) {
        for (const float depth : {-0.005f, 0.001f, 0.02f}) {
            slideOver(*mesh, boxView({0.5f, 0.25f, 0.4f}), {}, 0.25f - depth, 4);
        }
    }
}

TEST(MeshFloor, ATiltedBoxStillGetsVerticalNormals) {
    const TriangleMesh floor = gridMesh(20, 5, flat), fine = gridMesh(100, 5, flat);
    const ConvexView box = boxView({0.5f, 0.25f, 0.4f});
    Random random(32);
    for (int i = 0; i < 1000; ++i) {
        SCOPED_TRACE(i);
        const Quat rotation = random.rotation(i % 2 == 0 ? 0.05f : 3);
        Frame frame{{random.uniform(-3, 3), 0, random.uniform(-3, 3)}, rotation};
        const float lowest = rotate(rotation, supportOfCore(box, inverseRotate(rotation, {0, -1, 0}))).y;
        frame.position.y = -lowest - random.uniform(-0.005f, 0.02f);
        for (const TriangleMesh* mesh : {&floor, &fine}) {
            const Contacts contacts = contactsOf(*mesh, box, frame, 0.02f);
            ASSERT_EQ(contacts.count, 1);
            expectNear(contacts.manifolds[0].normal, {0, 1, 0}, 1e-6f);
            // Of depths within 0.001 of the size (0.25 m) any may stand for the deepest.
            EXPECT_NEAR(deepestOf(contacts), frame.position.y + lowest, 2.52e-4f);
        }
    }
}

TEST(MeshFloor, RoundShapesRollWithVerticalNormals) {
    const TriangleMesh floor = gridMesh(20, 5, flat), fine = gridMesh(60, 5, flat);
    for (const TriangleMesh* mesh : {&floor, &fine}) {
        for (const float depth : {-0.005f, 0.001f, 0.03f}) {
            slideOver(*mesh, sphereView(0.3f), {}, 0.3f - depth, 1);
            slideOver(*mesh, capsuleView(0.3f, 0.5f), rotationAbout({0, 0, 1}, kPi / 2), 0.3f - depth, 2);
            slideOver(*mesh, capsuleView(0.3f, 0.5f), {}, 0.8f - depth, 1);
        }
    }
}

TEST(MeshFloor, AHullSlidesWithVerticalNormals) {
    RAGTOP_NEEDS_HULLS();
    const TriangleMesh floor = gridMesh(20, 5, flat);
    std::vector<Vec3> wedge{{-0.5f, -0.2f, -0.3f}, {0.5f, -0.2f, -0.3f}, {-0.5f, -0.2f, 0.3f},
                            {0.5f, -0.2f, 0.3f},   {-0.5f, 0.2f, 0},     {0.5f, 0.2f, 0}};
    const ConvexHull hull(wedge);
    for (const float depth : {-0.005f, 0.001f, 0.02f}) slideOver(floor, hullView(hull.data()), {}, 0.2f - depth, 4);
}

TEST(HeightFieldFloor, IsLikeTheMeshFloor) {
    const std::vector<float> heights(41 * 41, 0.0f);
    const HeightField field(41, 41, 0.25f, heights);
    const Frame toMiddle{{5, 0, 5}, {}};
    const TriangleMesh mesh = gridMesh(40, 5, flat);
    Random random(33);
    for (int i = 0; i < 500; ++i) {
        const Frame frame{{random.uniform(-3, 3), 0.249f, random.uniform(-3, 3)},
                          rotationAbout({0, 1, 0}, random.uniform(-kPi, kPi))};
        const ConvexView box = boxView({0.5f, 0.25f, 0.4f});
        const Contacts onField = contactsOf(field, box, toMiddle * frame, 0.02f);
        const Contacts onMesh = contactsOf(mesh, box, frame, 0.02f);
        ASSERT_EQ(onField.count, 1);
        ASSERT_EQ(onMesh.count, 1);
        EXPECT_EQ(onField.manifolds[0].pointCount, 4);
        expectNear(onField.manifolds[0].normal, {0, 1, 0}, 1e-6f);
        EXPECT_NEAR(deepestOf(onField), deepestOf(onMesh), 2e-6f);
    }
}

TEST(Mesh, FeaturesOfCornersPersistAcrossTriangles) {
    const TriangleMesh floor = gridMesh(40, 5, flat);
    const ConvexView box = boxView({0.5f, 0.25f, 0.4f});
    std::vector<std::uint32_t> first;
    for (int i = 0; i < 200; ++i) {
        const Frame frame{{-2.0f + 0.021f * static_cast<float>(i), 0.249f, 0.3f}, rotationAbout({0, 1, 0}, 0.2f)};
        const Contacts contacts = contactsOf(floor, box, frame, 0.02f);
        ASSERT_EQ(contacts.count, 1);
        std::vector<std::uint32_t> features;
        for (int k = 0; k < contacts.manifolds[0].pointCount; ++k) {
            features.push_back(contacts.manifolds[0].points[k].feature);
        }
        std::sort(features.begin(), features.end());
        if (i == 0) first = features;
        EXPECT_EQ(features, first);
    }
}

TEST(Mesh, ASphereTouchesABoxMeshWhereItTouchesTheBox) {
    const Vec3 half{1, 0.7f, 0.5f};
    const TriangleMesh mesh = boxMesh(half);
    Random random(34);
    for (int i = 0; i < 3000; ++i) {
        SCOPED_TRACE(i);
        const Frame frame{random.inBox(1.6f), random.rotation()};
        const Vec3 p = frame.position;
        if (!(p == max(-half, min(half, p)))) {
            const Manifold solid = collided(boxView(half), sphereView(0.4f), frame, 0.05f);
            const Contacts contacts = contactsOf(mesh, sphereView(0.4f), frame, 0.05f);
            ASSERT_EQ(contacts.count, solid.pointCount);
            if (solid.pointCount == 0) continue;
            EXPECT_EQ(contacts.manifolds[0].pointCount, 1);
            EXPECT_NEAR(deepestOf(contacts), deepest(solid), 2e-6f);
            const float apart = deepest(solid) + 0.4f;
            if (apart > 0.01f) expectNear(contacts.manifolds[0].normal, solid.normal, 2e-6f / apart);
        }
    }
}

TEST(Mesh, ABoxTouchesABoxMeshAsDeepAsItTouchesTheBox) {
    const Vec3 half{1, 0.7f, 0.5f};
    const TriangleMesh mesh = boxMesh(half);
    const ConvexView box = boxView({0.3f, 0.4f, 0.2f});
    Random random(35);
    int compared = 0;
    for (int i = 0; i < 6000; ++i) {
        SCOPED_TRACE(i);
        const Frame frame{random.inBox(1.6f), random.rotation()};
        const Manifold solid = collided(boxView(half), box, frame);
        const Contacts contacts = contactsOf(mesh, box, frame, 0);
        if (solid.pointCount == 0) {
            // Only what a face reports beyond the hysteresis may be there.
            if (contacts.count > 0) {
                EXPECT_GE(deepestOf(contacts), -0.003f);
            }
            continue;
        }
        const float depth = -deepest(solid);
        if (depth < 0.003f || depth > 0.05f) continue;
        ++compared;
        ASSERT_GT(contacts.count, 0) << depth;
        for (int k = 0; k < contacts.count; ++k) {
            const Manifold& m = contacts.manifolds[k];
            for (int j = 0; j < m.pointCount; ++j) {
                // The surface is met within the depth of the points from the box, by pushes out of it.
                const Vec3 onMesh = m.points[j].position - 0.5f * m.points[j].separation * m.normal;
                const Vec3 inside = max(-half, min(half, onMesh));
                EXPECT_LE(length(inside - onMesh), 0.01f);
            }
        }
        EXPECT_LE(deepestOf(contacts), -depth + 0.004f);
    }
    EXPECT_GT(compared, 200);
}

TEST(Mesh, CollidesOnTheFrontOnly) {
    const TriangleMesh floor = gridMesh(10, 5, flat);
    for (const ConvexView& shape : {sphereView(0.3f), capsuleView(0.3f, 0.2f), boxView({0.3f, 0.3f, 0.3f})}) {
        const float reach = shape.kind == ConvexKind::capsule ? 0.5f : 0.3f;
        EXPECT_GT(contactsOf(floor, shape, {{0.2f, reach - 0.01f, 0.1f}, {}}, 0.01f).count, 0);
        EXPECT_EQ(contactsOf(floor, shape, {{0.2f, -reach + 0.01f, 0.1f}, {}}, 0.01f).count, 0);
    }
}

TEST(Mesh, ABoxInACornerTouchesInThreeDirections) {
    // Floor, and two walls that look along +x and +z.
    std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {4, 0, 4}, {0, 0, 4}, {0, 4, 0}, {4, 4, 0}, {0, 4, 4}};
    const std::vector<Triangle> t{{0, 3, 2}, {0, 2, 1}, {0, 1, 5}, {0, 5, 4}, {0, 4, 6}, {0, 6, 3}};
    const TriangleMesh room(v, t);
    const Contacts contacts = contactsOf(room, boxView({0.5f, 0.5f, 0.5f}), {{0.499f, 0.498f, 0.497f}, {}}, 0.01f);
    ASSERT_EQ(contacts.count, 3);
    Vec3 sum;
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(contacts.manifolds[i].pointCount, 4);
        sum += contacts.manifolds[i].normal;
    }
    expectNear(sum, {1, 1, 1}, 1e-6f);
}

TEST(Mesh, ABoxOverARidgeRestsOnIt) {
    const TriangleMesh roof = gridMesh(2, 5, [](float x, float) { return -std::abs(x); });
    const Contacts contacts = contactsOf(roof, boxView({0.5f, 0.25f, 0.5f}), {{0.1f, 0.245f, 0.3f}, {}}, 0.01f);
    ASSERT_EQ(contacts.count, 1);
    expectNear(contacts.manifolds[0].normal, {0, 1, 0}, 1e-5f);
    EXPECT_EQ(contacts.manifolds[0].pointCount, 2);
    EXPECT_NEAR(deepestOf(contacts), -0.005f, 2e-6f);
}

TEST(Mesh, ManyTrianglesMergeWithoutLosingTheDeepest) {
    const auto bumps = [](float x, float z) { return 0.02f * std::sin(40 * x) * std::cos(37 * z); };
    const TriangleMesh rough = gridMesh(150, 3, bumps);
    const ConvexView box = boxView({1, 0.3f, 1});
    Random random(36);
    for (int i = 0; i < 50; ++i) {
        const Frame frame{{random.uniform(-1, 1), 0.31f, random.uniform(-1, 1)},
                          rotationAbout({0, 1, 0}, random.uniform(-kPi, kPi))};
        const Contacts contacts = contactsOf(rough, box, frame, 0.01f);
        ASSERT_GT(contacts.count, 0);
        ASSERT_LE(contacts.count, kMaxManifolds);
        float highest = -1;
        for (const Vec3& v : rough.vertices()) {
            const Vec3 local = inverseTransformPoint(frame, v);
            if (std::abs(local.x) < 1 && std::abs(local.z) < 1) highest = std::max(highest, v.y);
        }
        EXPECT_NEAR(deepestOf(contacts), 0.01f - highest, 0.004f);
        for (int k = 0; k < contacts.count; ++k) EXPECT_GT(contacts.manifolds[k].normal.y, 0.5f);
    }
}

TEST(Mesh, FarFromItsOriginItCollidesAlike) {
    // A power of two moves the vertices without rounding.
    const Vec3 far{2048, -512, 1024};
    const TriangleMesh near = gridMesh(16, 4, flat), moved = gridMesh(16, 4, flat, far);
    Random random(37);
    for (int i = 0; i < 200; ++i) {
        const Vec3 p{std::round(random.uniform(-2, 2) * 1024) / 1024, 0.25f,
                     std::round(random.uniform(-2, 2) * 1024) / 1024};
        const Quat rotation = rotationAbout({0, 1, 0}, random.uniform(-kPi, kPi));
        const ConvexView box = boxView({0.5f, 0.25f, 0.4f});
        const Contacts a = contactsOf(near, box, {p, rotation}, 0.02f);
        const Contacts b = contactsOf(moved, box, {p + far, rotation}, 0.02f);
        ASSERT_EQ(a.count, 1);
        ASSERT_EQ(b.count, 1);
        EXPECT_EQ(deepestOf(a), deepestOf(b));
    }
}

TEST(Mesh, LengthsTimesFourGiveResultsTimesFour) {
    const auto bumps = [](float x, float z) { return 0.1f * std::sin(3 * x) * std::cos(2 * z); };
    const TriangleMesh small = gridMesh(32, 4, bumps);
    const TriangleMesh large = gridMesh(32, 16, [&](float x, float z) { return 4 * bumps(x / 4, z / 4); });
    Random random(38);
    for (int i = 0; i < 500; ++i) {
        const Frame frame{{random.uniform(-2, 2), random.uniform(0, 0.4f), random.uniform(-2, 2)}, random.rotation()};
        const ConvexView shapes[2][3] = {{sphereView(0.3f), capsuleView(0.2f, 0.3f), boxView({0.3f, 0.2f, 0.25f})},
                                         {sphereView(1.2f), capsuleView(0.8f, 1.2f), boxView({1.2f, 0.8f, 1})}};
        const auto k = static_cast<std::size_t>(i % 3);
        const Contacts a = contactsOf(small, shapes[0][k], frame, 0.05f);
        const Contacts b = contactsOf(large, shapes[1][k], {4 * frame.position, frame.rotation}, 0.2f);
        ASSERT_EQ(a.count, b.count);
        for (int m = 0; m < a.count; ++m) {
            ASSERT_EQ(a.manifolds[m].pointCount, b.manifolds[m].pointCount);
            EXPECT_EQ(a.manifolds[m].normal, b.manifolds[m].normal);
            EXPECT_EQ(a.manifolds[m].triangle, b.manifolds[m].triangle);
            for (int p = 0; p < a.manifolds[m].pointCount; ++p) {
                EXPECT_EQ(4 * a.manifolds[m].points[p].position, b.manifolds[m].points[p].position);
                EXPECT_EQ(4 * a.manifolds[m].points[p].separation, b.manifolds[m].points[p].separation);
            }
        }
    }
}

// What is remembered of the triangles around a pair changes no bit of its contacts: near, far on, put elsewhere, or where
// there are too many to remember.
TEST(CollideMesh, RememberedTrianglesGiveTheSameContacts) {
    const auto hills = [](float x, float z) { return 0.4f * std::sin(1.3f * x) * std::cos(1.7f * z); };
    const TriangleMesh coarse = gridMesh(20, 10, hills), fine = gridMesh(60, 4, hills);
    const HullData wedge = boxHull({0.3f, 0.2f, 0.5f});
    const ConvexView shapes[] = {sphereView(0.4f), boxView({0.4f, 0.3f, 0.5f}), capsuleView(0.2f, 0.4f), hullView(wedge)};
    Random random(5);
    int touching = 0, remembered = 0, tooMany = 0;
    for (const TriangleMesh* mesh : {&coarse, &fine})
        for (const ConvexView& shape : shapes) {
            NearTriangles near;
            Frame frame;
            for (int i = 0; i < 400; ++i) {
                const bool elsewhere = i % 50 == 0;
                frame.position += elsewhere ? random.inBox(3) : random.inBox(0.1f);
                frame.position.y = hills(frame.position.x, frame.position.z) + random.uniform(0.1f, 0.5f);
                frame.rotation = random.rotation();
                const float margin = random.uniform(0.01f, 0.2f);
                const Contacts plain = contactsOf(*mesh, shape, frame, margin);
                Contacts known;
                known.count = collide(mesh->data(), shape, frame, margin, near, known.manifolds);
                ASSERT_EQ(known.count, plain.count);
                for (int k = 0; k < plain.count; ++k) {
                    const Manifold &a = plain.manifolds[k], &b = known.manifolds[k];
                    ASSERT_EQ(a.pointCount, b.pointCount);
                    EXPECT_EQ(a.normal, b.normal);
                    EXPECT_EQ(a.triangle, b.triangle);
                    for (int j = 0; j < a.pointCount; ++j) {
                        EXPECT_EQ(a.points[j].position, b.points[j].position);
                        EXPECT_EQ(a.points[j].separation, b.points[j].separation);
                        EXPECT_EQ(a.points[j].feature, b.points[j].feature);
                    }
                }
                touching += plain.count > 0;
                ++(near.count == NearTriangles::kTooMany ? tooMany : remembered);
            }
        }
    EXPECT_GT(touching, 2000);
    EXPECT_GT(remembered, 500);
    EXPECT_GT(tooMany, 500);
}

/// Where faces tell that all pushes of a surface are along a way, none of the contacts that are found is beside it.
TEST(FacesAlong, PushAlongTheWayOnly) {
    RAGTOP_NEEDS_HULLS();
    Random random(11);
    int told = 0, found = 0;
    for (int round = 0; round < 300; ++round) {
        SCOPED_TRACE(round);
        const float rough = random.uniform(0, 0.25f);
        std::vector<float> heights;
        for (int i = 0; i < 12 * 12; ++i) heights.push_back(random.uniform(-rough, rough));
        const HeightField field(12, 12, 0.3f, heights);
        std::vector<Vec3> vertices;
        for (int i = 0; i < 12 * 12; ++i)
            vertices.push_back({0.3f * static_cast<float>(i % 12), heights[static_cast<std::size_t>(i)],
                                0.3f * static_cast<float>(i / 12)});
        std::vector<Triangle> triangles;
        for (std::uint32_t k = 0; k < 11 * 11; ++k) {
            const std::uint32_t a = k / 11 * 12 + k % 11, b = a + 1, c = a + 12, d = c + 1;
            triangles.insert(triangles.end(), {{a, c, d}, {a, d, b}});
        }
        const TriangleMesh mesh(vertices, triangles);
        const ConvexHull hull(randomPoints(random, 16, 0.3f));
        const Frame frame{{random.uniform(0.2f, 3.1f), random.uniform(-0.1f, 0.5f), random.uniform(0.2f, 3.1f)},
                          random.rotation(0.4f)};
        constexpr float kMargin = 0.02f;
        const ConvexView view = convexView(Shape(hull));
        const Bounds near = enlarged(boundsOf(Shape(hull), frame), 2 * kMargin);
        const Vec3 way = rotate(frame.rotation, {0, 1, 0});
        const auto check = [&](const auto& surface) {
            if (!facesAlong(surface.data(), near, way)) return;
            ++told;
            const Contacts contacts = contactsOf(surface, view, frame, kMargin);
            found += contacts.count;
            for (int i = 0; i < contacts.count; ++i) EXPECT_GT(dot(contacts.manifolds[i].normal, way), 0.2f);
        };
        check(field);
        check(mesh);
    }
    EXPECT_GT(told, 60);
    EXPECT_GT(found, 60);
}

/// From the side of a sheet its border pushes across.
TEST(FacesAlong, DoNotWhereASurfaceEnds) {
    const TriangleMesh mesh = gridMesh(4, 1, flat);
    const HeightField field(5, 5, 0.5f, std::vector<float>(25, 0.0f));
    const Bounds inside{{-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}}, outside{{0.9f, -0.2f, -0.2f}, {1.3f, 0.2f, 0.2f}};
    const Vec3 middle{1, 0, 1};
    EXPECT_TRUE(facesAlong(mesh.data(), inside, {0, 1, 0}));
    EXPECT_FALSE(facesAlong(mesh.data(), inside, {1, 0, 0}));
    EXPECT_FALSE(facesAlong(mesh.data(), outside, {0, 1, 0}));
    EXPECT_TRUE(facesAlong(field.data(), {inside.lower + middle, inside.upper + middle}, {0, 1, 0}));
    EXPECT_FALSE(facesAlong(field.data(), {outside.lower + middle, outside.upper + middle}, {0, 1, 0}));
}

}  // namespace
}  // namespace ragtop
