// Bodies whose shapes are meshes that move.

#include "heap_counter.h"
#include "mesh_bodies.h"
#include "narrowphase/mesh_sweep.h"
#include "ragtop/tasks.h"
#include "scenes.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

using scenes::Scale;
using scenes::torus;

/// A soft contact that bears its load without memory sinks by g/ω², ω = 2π · 30 Hz.
constexpr double kSink = 9.81 / (4 * 3.1416 * 3.1416 * 900);

BodyId addAt(World& world, const Shape& shape, const DVec3& at, const Quat& rotation = {}) {
    BodyDef def = bodyDef(shape, at, surface(0.5f));
    def.pose.rotation = rotation;
    return world.create(def);
}

Shape levelField() {
    const std::vector<float> heights(41 * 41, 0.0f);
    return HeightField(41, 41, 0.5f, heights);
}

TEST(MovingMesh, RestsOnBoxMeshAndHeightFieldAtItsOwnHeight) {
    const Quat lying = rotationAbout({1, 0, 0}, kPi / 2);
    for (int floor = 0; floor < 3; ++floor) {
        World world;
        if (floor == 0) addFloor(world, surface(0.5f));
        if (floor == 1) world.create(bodyDef(scenes::boxMesh({10, 1, 10}), {0, -1, 0}, surface(0.5f), BodyType::fixed));
        if (floor == 2) world.create(bodyDef(levelField(), {-10, 0, -10}, surface(0.5f), BodyType::fixed));
        const BodyId box = addAt(world, scenes::boxMesh({0.5f, 0.25f, 0.5f}), {0, 0.5, 0});
        const BodyId rim = addAt(world, torus(0.5f, 0.1f), {3, 0.7, 0});
        const BodyId flat = addAt(world, torus(0.5f, 0.1f), {-3, 0.3, 0}, lying);
        run(world, 3);
        EXPECT_NEAR(height(world, box), 0.25, kSink) << floor;
        EXPECT_NEAR(height(world, rim), 0.6, kSink) << floor;
        EXPECT_NEAR(height(world, flat), 0.1, kSink) << floor;
    }
}

/// A ball of radius ρ lies in a ring of radius R and thickness r at the height √((ρ + r)² − R²) above it. A tube of n
/// sides has its flats inside by r (1 − cos π/n), its corners on the ring.
TEST(MovingMesh, HoldsABallInARing) {
    World world;
    addFloor(world, surface(0.5f));
    constexpr std::uint32_t kSides = 24;
    const double R = 0.4, r = 0.125, ball = 0.5;
    const BodyId ring = addAt(world, torus(0.4f, 0.125f, 48, kSides), {0, 0.126, 0}, rotationAbout({1, 0, 0}, kPi / 2));
    const BodyId on = addAt(world, Sphere{0.5f}, {0, 0.61, 0});
    run(world, 3);
    // It goes on rolling from facet to facet.
    double mean = 0;
    constexpr int kSteps = 60;
    for (int i = 0; i < kSteps; ++i) {
        world.step(kDt);
        mean += (height(world, on) - height(world, ring)) / kSteps;
    }
    const double above = std::sqrt((ball + r) * (ball + r) - R * R), flats = 1 - std::cos(3.1416 / kSides);
    const double around = 1 - std::cos(3.1416 / 48);
    // dh = (ρ + r)/h dr and R/h dR.
    // To first order, and a tenth for the rest.
    const double slack = 1.1 * ((ball + r) * r * flats + R * R * around) / above + 2 * kSink;
    EXPECT_NEAR(mean, above, slack);
    EXPECT_NEAR(world.pose(on).position.x, 0, 0.01);
}

TEST(MovingMesh, ImpactsKeepMomentum) {
    World world(withoutGravity());
    scenes::Dice dice(4);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 8; ++i) {
        const Shape shape =
            i % 2 != 0 ? Shape{torus(0.3f, 0.1f, 16, 8)} : Shape{scenes::angleIron(0.5f, 0.125f, 0.125f)};
        BodyDef def = bodyDef(shape, {i % 2 - 0.5, (i / 2 % 2) - 0.5, (i / 4) - 0.5}, surface(0.5f));
        def.pose.rotation = dice.rotation();
        def.linearVelocity = -3.0f * toVec3(def.pose.position);
        bodies.push_back(world.create(def));
    }
    const auto momentum = [&] {
        Vec3 sum;
        for (const BodyId id : bodies) sum += world.mass(id).mass * world.linearVelocity(id);
        return sum;
    };
    const Vec3 before = momentum();
    float scale = 0;
    for (const BodyId id : bodies) scale += world.mass(id).mass * length(world.linearVelocity(id));
    run(world, 2);
    EXPECT_LT(length(momentum() - before), 1e-4f * scale);
}

/// Every other ring turned by a right angle, the first one held.
std::vector<BodyId> addChain(World& world, int links, double slack, const Scale& scale = {}) {
    const Shape ring = torus(scale.length(0.25f), scale.length(0.0625f), 20, 10);
    world.create(bodyDef(ring, scale.position(0, 0, 0), surface(0.5f), BodyType::fixed));
    std::vector<BodyId> ids;
    for (int i = 1; i <= links; ++i) {
        BodyDef def = bodyDef(ring, scale.position(0, -(0.375 - slack) * i, 0), surface(0.5f));
        if (i % 2 != 0) def.pose.rotation = rotationAbout({0, 1, 0}, kPi / 2);
        if (i == links) def.linearVelocity = scale.velocity({1, 0, 0.5f});
        ids.push_back(world.create(def));
    }
    return ids;
}

TEST(MovingMesh, InterlockedRingsHangAndStayWhole) {
    World world(withoutSleep());
    const std::vector<BodyId> links = addChain(world, 6, 0.0078125);
    run(world, 10, kDt, [&] {
        DVec3 above;
        for (const BodyId id : links) {
            const DVec3 at = world.pose(id).position, way = at - above;
            // A tenth of the thickness.
            ASSERT_LT(std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z), 0.375 + 0.0125);
            above = at;
        }
    });
}

/// The inner corner of an L lies on a round peg, one leg on either side.
TEST(MovingMesh, HangsByAConcaveCorner) {
    World world(withoutSleep());
    const Quat turned = rotationAbout({0, 0, 1}, kPi / 4 + kPi);
    BodyDef peg = bodyDef(Capsule{0.125f, 1}, {2, 0, 0}, surface(0.5f), BodyType::fixed);
    peg.pose.rotation = rotationAbout({1, 0, 0}, kPi / 2);
    world.create(peg);
    // Two planes at right angles touch a round of radius r at r √2 from its middle.
    const double corner = 0.1 * std::sqrt(2.0), apart = 0.125 * std::sqrt(2.0);
    const BodyId iron = addAt(world, scenes::angleIron(0.6f, 0.1f, 0.2f), {2, apart + corner + 0.01, 0}, turned);
    run(world, 10);
    EXPECT_NEAR(height(world, iron), apart + corner, 0.001);
    EXPECT_NEAR(world.pose(iron).position.x, 2, 0.02);
}

/// What begins in something else comes out the short way and is not thrown. A ring on its edge falls over in time: upright,
/// any lean grows by e in about 0.3 s.
TEST(MovingMesh, ComesOutOfOverlapWithoutAJump) {
    for (const bool onMesh : {false, true}) {
        World world;
        if (onMesh)
            world.create(bodyDef(scenes::boxMesh({10, 1, 10}), {0, -1, 0}, surface(0.5f), BodyType::fixed));
        else
            addFloor(world, surface(0.5f));
        const BodyId ring = addAt(world, torus(0.5f, 0.1f), {0, 0.52, 0});
        const BodyId flat = addAt(world, torus(0.5f, 0.1f), {3, 0.05, 0}, rotationAbout({1, 0, 0}, kPi / 2));
        double highest = 0;
        const auto look = [&] {
            highest = std::max(highest, std::max(height(world, ring) - 0.6, height(world, flat) - 0.1));
        };
        run(world, 0.5, kDt, look);
        EXPECT_NEAR(height(world, ring), 0.6, 0.001) << onMesh;
        run(world, 1.5, kDt, look);
        EXPECT_LT(highest, 0.01) << onMesh;
        EXPECT_NEAR(height(world, flat), 0.1, 0.001) << onMesh;
    }
}

/// Pairs at random, some of them through each other's middle, where no way is the short one: nearly all come apart,
/// slowly.
TEST(MovingMesh, WhatBeginsInsideEachOtherComesApart) {
    scenes::Dice dice(11);
    int stuck = 0;
    double fastest = 0;
    for (int i = 0; i < 100; ++i) {
        World world(withoutGravity());
        BodyId ids[2];
        for (int k = 0; k < 2; ++k) {
            const Shape shape = (i >> k) % 2 != 0 ? Shape{torus(0.25f, 0.0625f, 16, 8)}
                                                  : Shape{scenes::angleIron(0.5f, 0.125f, 0.0625f)};
            const DVec3 at{static_cast<double>(dice.between(-0.125f, 0.125f)),
                           static_cast<double>(dice.between(-0.125f, 0.125f)), 0.25 * k};
            ids[k] = addAt(world, shape, at, dice.rotation());
        }
        run(world, 3);
        float deepest = 0;
        world.forEachContact(ids[0], [&](const Contact& contact) {
            for (int j = 0; j < contact.pointCount; ++j) deepest = std::min(deepest, contact.points[j].separation);
        });
        if (deepest < -0.002f) ++stuck;
        for (const BodyId id : ids) fastest = std::max(fastest, static_cast<double>(length(world.linearVelocity(id))));
    }
    EXPECT_LE(stuck, 2);
    EXPECT_LT(fastest, 0.5);
}

/// Along a line the time of an impact is the gap over the speed.
TEST(MovingMesh, MeetsAPlaneWhenTheGapIsUsedUp) {
    const TriangleMesh ring = torus(0.5f, 0.125f), wall = scenes::boxMesh({0.5f, 4, 4});
    MeshPath path;
    path.mesh = &ring.data();
    path.start.position = {-3, 0, 0};
    path.way = {10, 0, 0};
    path.target = 1e-3f;
    // Its corners begin on the x axis at ±(R + r); the wall's face is at −0.5.
    const MeshSweepHit hit = timeOfImpact(wall.data(), path);
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction, (3 - 0.5 - 0.625) / 10, 2e-4);
    EXPECT_LT(length(hit.normal - Vec3{-1, 0, 0}), 1e-3f);
    path.way = {0, 10, 0};
    EXPECT_FALSE(timeOfImpact(wall.data(), path).hit);
    // A wall that turns about a point 3 m below comes to where the ring waits: it leans by asin(d/l).
    path.way = {};
    path.start.position = {-1.5f, 0, 0};
    path.axisCenter = {0, -3, 0};
    path.axisTurn = {0, 0, 1};
    const MeshSweepHit leaning = timeOfImpact(wall.data(), path);
    ASSERT_TRUE(leaning.hit);
    EXPECT_LT(leaning.fraction, 0.5f);
    EXPECT_GT(leaning.fraction, 0.05f);
}

/// Whatever the phase of the step, at 300 m/s, with the wall fixed or coming.
TEST(MovingMesh, DoesNotPassAThinMesh) {
    for (const bool comes : {false, true}) {
        World world(withoutGravity());
        std::vector<BodyId> walls, rings;
        scenes::Dice dice(6);
        for (int i = 0; i < 16; ++i) {
            BodyDef wall = bodyDef(scenes::boxMesh({0.02f, 2, 2}), {0, 0, 8.0 * i}, surface(0.5f),
                                   comes ? BodyType::dynamic : BodyType::fixed);
            wall.shapes[0].density = 8000;
            if (comes) wall.linearVelocity = {-150, 0, 0};
            wall.bullet = true;
            walls.push_back(world.create(wall));
            BodyDef ring = bodyDef(torus(0.25f, 0.05f, 16, 8), {-6 - 5.0 * i / 16, 0, 8.0 * i}, surface(0.5f));
            ring.pose.rotation = dice.rotation();
            ring.linearVelocity = {comes ? 150.0f : 300.0f, 0, 0};
            ring.bullet = true;
            rings.push_back(world.create(ring));
        }
        for (int step = 0; step < 4; ++step) {
            world.step(kDt);
            for (std::size_t i = 0; i < rings.size(); ++i) {
                const Vec3 at = inverseTransformPoint(world.pose(walls[i]), world.centerOfMass(rings[i]));
                const bool gone = std::abs(at.y) > 1.5f || std::abs(at.z) > 1.5f;
                EXPECT_TRUE(gone || at.x < 0) << comes << ' ' << i;
            }
        }
    }
}

void addHeap(World& world, const Scale& scale) {
    std::vector<float> heights;
    scenes::Dice dice(9);
    for (int i = 0; i < 17 * 17; ++i) heights.push_back(scale.length(dice.between(-0.125f, 0.125f)));
    world.create(bodyDef(HeightField(17, 17, scale.length(0.5f), heights), scale.position(-4, 0, -4), surface(0.5f),
                         BodyType::fixed));
    for (int i = 0; i < 16; ++i) {
        const Shape shape =
            i % 3 == 0   ? Shape{torus(scale.length(0.25f), scale.length(0.0625f), 16, 8)}
            : i % 3 == 1 ? Shape{scenes::angleIron(scale.length(0.5f), scale.length(0.125f), scale.length(0.0625f))}
                         : Shape{Box{scale.length(Vec3{0.125f, 0.25f, 0.125f})}};
        BodyDef def =
            bodyDef(shape, scale.position(0.5 * (i % 3) - 0.5, 0.75 + 0.5 * (i / 3), 0.25 * (i % 2)), surface(0.5f));
        def.pose.rotation = dice.rotation();
        world.create(def);
    }
    addChain(world, 4, 0.0078125, scale);
}

TEST(MovingMesh, MovesAlikeAtAnyScaleToTheBit) {
    const Scale scale{2};
    WorldSettings settings = withoutSleep();
    World unit(settings), scaled(settings);
    addHeap(unit, {});
    addHeap(scaled, scale);
    for (int i = 0; i < 120; ++i) {
        unit.step(kDt);
        scaled.step(2 * kDt);
    }
    for (std::size_t i = 0; i < unit.bodies().size(); ++i) {
        EXPECT_EQ(4.0 * unit.pose(unit.bodies()[i]).position, scaled.pose(scaled.bodies()[i]).position) << i;
        EXPECT_EQ(unit.pose(unit.bodies()[i]).rotation, scaled.pose(scaled.bodies()[i]).rotation) << i;
    }
}

TEST(MovingMesh, HasTheSameBitsOnAnyThreadsAndLanes) {
    const auto hashOf = [](const WorldConfig& config) {
        World world({}, config);
        addHeap(world, {});
        run(world, 2);
        return world.hash();
    };
    const std::uint64_t expected = hashOf({.lanes = 4});
    EXPECT_EQ(hashOf({.lanes = 16}), expected);
    EXPECT_EQ(hashOf({.tasks = threadTasks(3), .lanes = 8}), expected);
}

// Meshes that others move have no size of their own, and meet what is near them alone.
TEST(KinematicMesh, ManyPlatesLiftABoxEach) {
    World world(withoutSleep());
    const std::vector<Vec3> corners{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    const std::vector<Triangle> halves{{0, 1, 2}, {0, 2, 3}};
    const TriangleMesh plate(corners, halves);
    constexpr int kPlates = 32;
    std::vector<BodyId> boxes;
    for (int i = 0; i < kPlates; ++i) {
        const DVec3 at{4.0 * i, 0, 0};
        BodyDef lift = bodyDef(plate, at, surface(0.5f), BodyType::kinematic);
        lift.linearVelocity = {0, 1, 0};
        world.create(lift);
        boxes.push_back(addAt(world, Box{{0.25f, 0.25f, 0.25f}}, at + Vec3{0, 0.25f, 0}));
    }
    run(world, 1);
    for (const BodyId box : boxes) EXPECT_NEAR(world.pose(box).position.y, 1.25, 2 * kSink);
    EXPECT_EQ(world.stats().contacts, kPlates);
}

TEST(MovingMesh, GoesOnFromASavedState) {
    World world;
    addHeap(world, {});
    run(world, 1);
    std::vector<std::byte> saved(world.saveSize());
    world.save(saved);
    run(world, 1);
    World other;
    addHeap(other, {});
    other.restore(saved);
    run(other, 1);
    EXPECT_EQ(other.hash(), world.hash());
}

TEST(MovingMesh, AllocatesNothingWhileItMoves) {
    World world(withoutSleep());
    addChain(world, 6, 0);
    run(world, 4);  // until no link meets more others than ever before
    const long before = heapCalls();
    for (int i = 0; i < stepsIn(1); ++i) world.step(kDt);  // without asking the world what holds of it, which takes memory
    EXPECT_EQ(heapCalls() - before, 0);
}

}  // namespace
}  // namespace ragtop::test
