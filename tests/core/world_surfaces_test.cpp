#include "shape_support.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

TriangleMesh flatMesh(int n, float cell, std::vector<std::uint8_t> materialOfTriangle = {},
                      std::vector<Material> materials = {}) {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            vertices.push_back({cell * (static_cast<float>(i) - 0.5f * static_cast<float>(n)), 0,
                                cell * (static_cast<float>(j) - 0.5f * static_cast<float>(n))});
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), c = a + static_cast<std::uint32_t>(n) + 1;
            triangles.push_back({a, c, a + 1});
            triangles.push_back({a + 1, c, c + 1});
        }
    return TriangleMesh(vertices, triangles, materialOfTriangle, materials);
}

ConvexHull wedgeHull() {
    const Vec3 points[] = {{-0.4f, -0.3f, -0.4f}, {0.4f, -0.3f, -0.4f}, {0.4f, -0.3f, 0.4f}, {-0.4f, -0.3f, 0.4f},
                           {-0.2f, 0.3f, -0.2f},  {0.2f, 0.3f, -0.2f},  {0.2f, 0.3f, 0.2f},  {-0.2f, 0.3f, 0.2f}};
    return ConvexHull(points);
}

// Apex k is e^{2k} times the height: the approach speed is that at the surface. The rise begins at the end of the step
// of the impact from the surface, or from the stop of the continuous sweep, a quarter of the speculative margin (0.02
// r) above it, whose height the energy gains. The time of the impact is foreseen without the fall during it, g h² of
// height. Poses are seen once per step: the highest is up to g (dt/2)²/2 below the apex.
TEST(WorldSurfaces, BouncesRiseToTheSquareOfRestitution) {
    for (const float e : {0.5f, 0.9f, 1.0f}) {
        World world(withoutSleep());
        addFloor(world, surface(0.5f, e));
        const double drop = 5;
        const BodyId ball = world.create(bodyDef(Sphere{0.1f}, {0, 0.1 + drop, 0}, surface(0.5f, e)));
        double before = drop, apex = 0;
        float vBefore = -1;
        int bounces = 0;
        for (int i = 0; i < 900 && bounces < 4; ++i) {
            world.step(kDt);
            apex = std::max(apex, height(world, ball) - 0.1);
            const float v = world.linearVelocity(ball).y;
            if (v > 0 && vBefore <= 0) apex = 0;
            if (v <= 0 && vBefore > 0) {
                const double e2 = static_cast<double>(e) * e;
                const double stop = 0.25 * 0.02 * 0.1, unseen = 0.125 * 9.81 * kDt * kDt;
                const double fall = 9.81 * (kDt / 4) * (kDt / 4);
                EXPECT_LE(apex, e2 * (before + unseen) * (1 + 1e-4) + stop + fall) << e << " bounce " << bounces;
                EXPECT_GE(apex, e2 * before * (1 - 1e-4) - unseen - fall) << e << " bounce " << bounces;
                before = apex;
                ++bounces;
            }
            vBefore = v;
        }
        EXPECT_GE(bounces, e > 0.5f ? 4 : 2);
    }
}

TEST(WorldSurfaces, WithoutRestitutionNothingBounces) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId ball = world.create(bodyDef(Sphere{0.1f}, {0, 3, 0}));
    run(world, 1);
    float fastest = 0;
    run(world, 1, kDt, [&] { fastest = std::max(fastest, world.linearVelocity(ball).y); });
    EXPECT_LT(fastest, 1e-3f);
    EXPECT_NEAR(height(world, ball), 0.1, 1e-3);
}

// A soft row at rest needs the overlap g / ω² with ω = 2π · 2 f against static bodies (solver.md, 1), at f = 0.125 of
// the substep rate: 9.81 / (2π 60)² = 0.07 mm, whatever the size of the box.
TEST(WorldSurfaces, ABoxSagsByGravityOverFrequencySquared) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}));
    const double omega = 2 * kPi * 2 * 0.125 * 240;
    double least = 1;
    run(world, 5, kDt, [&] { least = std::min(least, height(world, box)); });
    EXPECT_GT(least, 0.5 - 1.5 * 9.81 / (omega * omega));
    EXPECT_NEAR(height(world, box), 0.5, 1.1 * 9.81 / (omega * omega));
    EXPECT_LT(length(world.linearVelocity(box)), 1e-4f);
}

// n boxes sag by (g/ω²) Σ of the loads above, with half the frequency between moving bodies (mass ½ of two boxes, so
// twice the sag again): below 8 n² g/ω² = 14 mm for n = 5.
TEST(WorldSurfaces, AStackOfFiveStands) {
    World world(withoutSleep());
    addFloor(world);
    std::vector<BodyId> boxes;
    for (int i = 0; i < 5; ++i)
        boxes.push_back(world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {i % 2 ? 0.001 : -0.001, 0.5 + i, 0})));
    run(world, 20);
    for (int i = 0; i < 5; ++i) {
        const DVec3 p = world.pose(boxes[static_cast<std::size_t>(i)]).position;
        EXPECT_NEAR(p.y, 0.5 + i, 0.014) << i;
        EXPECT_LT(std::hypot(p.x, p.z), 0.005) << i;
        EXPECT_LT(length(world.linearVelocity(boxes[static_cast<std::size_t>(i)])), 1e-3f);
    }
}

// An overlap adds the speed pushOut · size / dt at most, 0.03 · 0.5 / (1/60) = 0.9 m/s here, of which the relax pass takes
// back what it finds. A soft row keeps 1 − s_m of a speed, so that none is beyond 0.9 / s_m, s_m = a/(1 + a) with
// a = ωh (2ζ + ωh) = 18 for ω = 120π rad/s, ζ = 5 and h = 1/240 s: no jump above v²/2g.
TEST(WorldSurfaces, DeepOverlapResolvesWithoutAPop) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0, 0}));
    const BodyId upper = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {5, 0.5, 0}));
    const BodyId inside = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {5, 1, 0}));
    float fastest = 0;
    double highest = 0;
    run(world, 3, kDt, [&] {
        for (const BodyId body : {box, upper, inside}) fastest = std::max(fastest, length(world.linearVelocity(body)));
        highest = std::max(highest, height(world, box));
    });
    EXPECT_LT(fastest, 0.9f * 19 / 18);
    EXPECT_LT(highest, 0.55);
    EXPECT_NEAR(height(world, box), 0.5, 0.005);
    EXPECT_NEAR(height(world, upper), 0.5, 0.01);
    EXPECT_NEAR(height(world, inside), 1.5, 0.02);
}

// A floor of triangles is one plane: nothing that slides over it is lifted by the edges between them.
TEST(WorldSurfaces, AFlatMeshIsAsSmoothAsAPlane) {
    const std::vector<float> heights(41 * 41, 0.0f);
    std::vector<Shape> shapes{Box{{0.4f, 0.3f, 0.4f}}, Sphere{0.3f}, Capsule{0.3f, 0.2f}};
    if (hullsCanBeBuilt()) shapes.push_back(wedgeHull());
    for (const bool field : {false, true}) {
        for (const Shape& shape : shapes) {
            World world(withoutSleep());
            if (field) {
                BodyDef floor = bodyDef(HeightField(41, 41, 0.5f, heights), {-10, 0, -10}, surface(0), BodyType::fixed);
                world.create(floor);
            } else {
                world.create(bodyDef(flatMesh(40, 0.5f), {}, surface(0), BodyType::fixed));
            }
            BodyDef def = bodyDef(shape, {-7.03, 0.3, -6.1}, surface(0));
            if (std::holds_alternative<Capsule>(shape)) def.pose.rotation = rotationAbout({0, 0, 1}, kPi / 2);
            const BodyId body = world.create(def);
            run(world, 0.5);
            const double rest = height(world, body);
            world.setVelocity(body, {5, 0, 4}, {});
            float bump = 0;
            double lift = 0;
            run(world, 2, kDt, [&] {
                bump = std::max(bump, std::abs(world.linearVelocity(body).y));
                lift = std::max(lift, std::abs(height(world, body) - rest));
            });
            // A contact that is missed for half a step would add half of g dt, 0.08 m/s.
            EXPECT_LT(bump, 1e-3f) << field << shape.index();
            EXPECT_LT(lift, 1e-3) << field << shape.index();
            EXPECT_NEAR(world.linearVelocity(body).x, 5, 0.01) << field << shape.index();
            EXPECT_NEAR(world.linearVelocity(body).z, 4, 0.01) << field << shape.index();
        }
    }
}

TEST(WorldSurfaces, EveryShapeRestsOnAMesh) {
    World world;
    world.create(bodyDef(flatMesh(40, 0.5f), {}, surface(0.6f), BodyType::fixed));
    Compound dumbbell;
    dumbbell.parts.push_back({Sphere{0.3f}, {{-0.5f, 0, 0}, {}}});
    dumbbell.parts.push_back({Box{{0.3f, 0.3f, 0.3f}}, {{0.5f, 0, 0}, {}}});
    std::vector<BodyId> bodies{world.create(bodyDef(Sphere{0.3f}, {0.1, 1, 0.2}, surface(0.6f, 0, 0.02f))),
                               world.create(bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {3.1, 1, 0.2})),
                               world.create(bodyDef(dumbbell, {-6, 1, 0.2}))};
    if (hullsCanBeBuilt()) bodies.push_back(world.create(bodyDef(wedgeHull(), {-3, 1, 0.2})));
    const BodyId capsule = world.create(bodyDef(Capsule{0.3f, 0.4f}, {6, 1, 0.2}));
    run(world, 6);
    for (const BodyId body : bodies) {
        EXPECT_LT(length(world.linearVelocity(body)), 0.01f);
        EXPECT_NEAR(height(world, body), 0.3, 0.002);
    }
    EXPECT_LT(length(world.linearVelocity(capsule)), 0.01f);
}

TEST(WorldSurfaces, ABallStaysInACompoundBowl) {
    World world;
    Compound bowl;
    bowl.parts.push_back({Box{{1, 0.1f, 1}}, {{0, -0.1f, 0}, {}}});
    for (int i = 0; i < 4; ++i) {
        const Quat turn = rotationAbout({0, 1, 0}, kPi / 2 * static_cast<float>(i));
        bowl.parts.push_back({Box{{0.1f, 0.5f, 1}}, {rotate(turn, {1, 0.4f, 0}), turn}});
    }
    world.create(bodyDef(bowl, {}, surface(0.3f), BodyType::fixed));
    BodyDef def = bodyDef(Sphere{0.2f}, {0, 0.2, 0}, surface(0.3f, 0.5f));
    def.linearVelocity = {4, 0, 2.5f};
    const BodyId ball = world.create(def);
    run(world, 6, kDt, [&] {
        const DVec3 p = world.pose(ball).position;
        ASSERT_LT(std::max(std::abs(p.x), std::abs(p.z)), 0.71);
        ASSERT_GT(p.y, 0.19);
    });
}

TEST(WorldSurfaces, TrianglesHaveMaterialsOfTheirOwn) {
    World world(withoutSleep());
    std::vector<std::uint8_t> which(2 * 40 * 40, 0);
    // Rows of cells with z above 0 are ice.
    for (std::size_t i = which.size() / 2; i < which.size(); ++i) which[i] = 1;
    Material grip = surface(0.8f), ice = surface(0);
    grip.surface = 7, ice.surface = 9;
    world.create(bodyDef(flatMesh(40, 0.5f, which, {grip, ice}), {}, surface(3), BodyType::fixed));
    const BodyId onGrip = world.create(bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {-5, 0.3, -5}, surface(0.8f)));
    const BodyId onIce = world.create(bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {-5, 0.3, 5}, surface(0.8f)));
    run(world, 0.5);
    world.setVelocity(onGrip, {3, 0, 0}, {});
    world.setVelocity(onIce, {3, 0, 0}, {});
    run(world, 1);
    EXPECT_NEAR(world.linearVelocity(onGrip).x, 0, 1e-3);
    EXPECT_NEAR(world.linearVelocity(onIce).x, 3, 1e-3);
    EXPECT_EQ(world.castRay({{-5, 2, -8}, {0, -5, 0}}).surface, 7u);
    EXPECT_EQ(world.castRay({{-5, 2, 8}, {0, -5, 0}}).surface, 9u);
}

TEST(WorldSurfaces, AModifyCallbackMakesIceAndOpensDoors) {
    World world(withoutSleep());
    const BodyId floor = addFloor(world, surface(0.8f));
    BodyDef slippery = bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {0, 0.3, 0}, surface(0.8f));
    slippery.shapes[0].userData = 1;
    slippery.linearVelocity = {2, 0, 0};
    BodyDef ghost = bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {5, 0.3, 0});
    ghost.shapes[0].userData = 2;
    const BodyId slider = world.create(slippery), faller = world.create(ghost);
    WorldCallbacks callbacks;
    callbacks.modify = [](const PairInfo& pair, ContactSurface& contact) {
        if (pair.userDataA == 1 || pair.userDataB == 1) contact.friction = 0;
        if (pair.userDataA == 2 || pair.userDataB == 2) contact.enabled = false;
    };
    world.setCallbacks(callbacks);
    run(world, 1);
    EXPECT_NEAR(world.linearVelocity(slider).x, 2, 1e-4);
    EXPECT_NEAR(height(world, faller), 0.3 - 0.5 * 9.81, 1e-2);
    EXPECT_TRUE(world.isValid(floor));
}

/// What it writes holds for that pair and step alone, whatever the materials say: a belt under one box, a floor that
/// bounces one ball back to where it came from.
TEST(WorldSurfaces, AModifyCallbackMovesSurfacesAndBounces) {
    World world(withoutSleep());
    addFloor(world, surface(0.8f));
    BodyDef carried = bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {0, 0.3, 0}, surface(0.8f));
    carried.shapes[0].userData = 1;
    BodyDef bouncing = bodyDef(Sphere{0.3f}, {3, 1.3, 0});
    bouncing.shapes[0].userData = 2;
    const BodyId box = world.create(carried), ball = world.create(bouncing);
    const BodyId resting = world.create(bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {-3, 0.3, 0}, surface(0.8f)));
    WorldCallbacks callbacks;
    callbacks.modify = [](const PairInfo& pair, ContactSurface& contact) {
        // The box goes against the way that its own surface runs.
        if (pair.userDataA == 1) contact.surfaceVelocity = {-1, 0, 0};
        if (pair.userDataB == 1) contact.surfaceVelocity = {1, 0, 0};
        if (pair.userDataA == 2 || pair.userDataB == 2) contact.restitution = 1;
    };
    world.setCallbacks(callbacks);
    double highest = 0, lowest = 2;
    run(world, 1.5, kDt, [&] {
        lowest = std::min(lowest, height(world, ball));
        if (lowest < 0.4) highest = std::max(highest, height(world, ball));
    });
    EXPECT_NEAR(std::abs(world.linearVelocity(box).x), 1, 1e-3);
    EXPECT_NEAR(highest, 1.3, 1e-2);
    EXPECT_NEAR(length(world.linearVelocity(resting)), 0, 1e-4);
}

// Pushing out is the only thing that could add energy, and the relax pass takes it back.
TEST(WorldSurfaces, EnergyNeverGrowsInASettlingPile) {
    World world;
    addFloor(world);
    for (int i = 0; i < 60; ++i) {
        const DVec3 at{0.3 * (i % 4), 1 + 0.8 * (i / 4.0), 0.35 * (i % 3)};
        world.create(bodyDef(i % 3 == 0   ? Shape(Sphere{0.3f})
                             : i % 3 == 1 ? Shape(Box{{0.3f, 0.2f, 0.25f}})
                                          : Shape(Capsule{0.2f, 0.2f}),
                             at));
    }
    double before = world.energy();
    const double start = before;
    double worst = 0;
    run(world, 8, kDt, [&] {
        worst = std::max(worst, world.energy() - before);
        before = world.energy();
    });
    // A body that is pushed out of rest overlaps of a step, v dt, gains m g v dt; a thousandth of all allows for it.
    EXPECT_LT(worst, 1e-3 * start);
    EXPECT_LT(before, start);
}

}  // namespace
}  // namespace ragtop
