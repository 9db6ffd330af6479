#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

struct Column {
    World world{withoutSleep()};
    std::vector<BodyId> boxes;

    explicit Column(int count) {
        addFloor(world);
        for (int i = 0; i < count; ++i)
            boxes.push_back(world.create(
                bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {1e-3 * std::sin(7.0 * i), i + 0.5, 1e-3 * std::cos(5.0 * i)})));
    }
};

/// Bricks of 0.4 m × 0.2 m × 0.2 m in running bond, with half bricks at the ends of every other course.
struct Wall {
    World world;
    std::vector<BodyId> bricks;
    std::vector<DVec3> places;

    Wall(int courses, int across, const WorldSettings& settings = withoutSleep()) : world(settings) {
        addFloor(world);
        for (int course = 0; course < courses; ++course) {
            const bool odd = course % 2 == 1;
            for (int i = 0; i < across + odd; ++i) {
                const bool half = odd && (i == 0 || i == across);
                const double inwards = !half ? 0 : i == 0 ? 0.1 : -0.1;
                places.push_back({0.402 * i - (odd ? 0.201 : 0) + inwards, 0.2 * course + 0.1, 0});
                bricks.push_back(world.create(bodyDef(Box{{half ? 0.1f : 0.2f, 0.1f, 0.1f}}, places.back())));
            }
        }
    }
    double largestMove() const {
        double largest = 0;
        for (std::size_t i = 0; i < bricks.size(); ++i) {
            const DVec3 d = world.pose(bricks[i]).position - places[i];
            largest = std::max(largest, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
        }
        return largest;
    }
    bool isDirect() const { return !world.stats().islands.empty(); }
};

TEST(DirectIslands, TallColumnStandsAndBearsItsWeight) {
    Column column(30);
    run(column.world, 2);
    const auto islands = column.world.stats().islands;
    ASSERT_EQ(islands.size(), 1u);
    EXPECT_STREQ(islands[0].reason, "tall");
    EXPECT_TRUE(islands[0].solved);
    EXPECT_NEAR(height(column.world, column.boxes.back()), 29.5, 1e-3);
    double load = 0;
    column.world.forEachContact(column.boxes[0], [&](const Contact& contact) {
        double sum = 0;
        for (int i = 0; i < contact.pointCount; ++i) sum += static_cast<double>(contact.points[i].impulse);
        load = std::max(load, sum);
    });
    const double weight = 30.0 * static_cast<double>(column.world.mass(column.boxes[0]).mass * kGravity);
    EXPECT_NEAR(load, weight * kDt / 4, 1e-4 * weight * kDt);
}

/// A column of n boxes of height l on a floor buckles where (n − 1)³ m g l = 7.84 k, with k = ½ m ω² Σ x² of the four
/// soft points between two boxes. Sweeps let those fall that bear half of it.
TEST(DirectIslands, ColumnsAreSolvedDirectlyFromAQuarterOfTheirBucklingLoadOn) {
    constexpr double kHalfWidth = 0.05, kTwoPi = 6.283185307179586;
    const WorldSettings settings = withoutSleep();
    const double omega = kTwoPi * static_cast<double>(settings.contactFrequency) * settings.substeps / kDt;
    for (const int count : {3, 4, 5}) {
        for (const float halfHeight : {0.05f, 0.3f, 0.5f, 1.0f, 2.0f}) {
            World world{settings};
            addFloor(world);
            std::vector<BodyId> boxes;
            const double length = 2 * static_cast<double>(halfHeight);
            for (int i = 0; i < count; ++i)
                boxes.push_back(world.create(bodyDef(Box{{0.05f, halfHeight, 0.05f}}, {0, (i + 0.5) * length, 0})));
            run(world, 5);
            const double stiffness = 0.5 * omega * omega * 4 * kHalfWidth * kHalfWidth;
            const double share = std::pow(count - 1, 3) * static_cast<double>(kGravity) * length / (7.84 * stiffness);
            EXPECT_EQ(world.stats().islands.empty(), share < 0.25) << count << " boxes of " << length << " m";
            if (share < 0.25) continue;
            EXPECT_STREQ(world.stats().islands[0].reason, "tall");
            EXPECT_NEAR(height(world, boxes.back()), (count - 0.5) * length, 1e-4 * length);
        }
    }
}

TEST(DirectIslands, HeavyDoesNotSinkIntoLight) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId light = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}));
    BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 1.5, 0});
    MassProperties mass = world.mass(light);
    mass.mass *= 1e4f;
    for (Vec3* column : {&mass.inertia.cx, &mass.inertia.cy, &mass.inertia.cz}) *column *= 1e4f;
    def.mass = mass;
    const BodyId heavy = world.create(def);
    run(world, 2, kDt, [&] { EXPECT_NEAR(height(world, heavy), 1.5, 2e-3); });
    EXPECT_STREQ(world.stats().islands[0].reason, "heavy");
}

TEST(DirectIslands, ChangingTheSolverAtRestMovesNothing) {
    Column column(8);
    run(column.world, 1);
    WorldSettings settings = column.world.settings();
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct, SolverChoice::iterative}) {
        settings.solver = solver;
        column.world.setSettings(settings);
        column.world.step(kDt);
        for (const BodyId box : column.boxes)
            EXPECT_LT(length(column.world.linearVelocity(box)), 1e-3f) << nameOf(solver);
    }
}

TEST(DirectIslands, RestoredWorldGoesOnBitForBit) {
    Column column(12);
    run(column.world, 0.5);
    std::vector<std::byte> state(column.world.saveSize());
    column.world.save(state);
    run(column.world, 0.5);
    const std::uint64_t expected = column.world.hash();
    column.world.restore(state);
    run(column.world, 0.5);
    EXPECT_EQ(column.world.hash(), expected);
}

TEST(DirectIslands, LoadsThatHoldAreNotSolvedAgain) {
    Wall wall(10, 10);
    run(wall.world, 1);
    ASSERT_TRUE(wall.isDirect());
    const DVec3 before = wall.world.pose(wall.bricks.back()).position;
    run(wall.world, 1, kDt, [&] { EXPECT_EQ(wall.world.stats().islands[0].iterations, 0); });
    EXPECT_EQ(wall.world.pose(wall.bricks.back()).position, before);
    EXPECT_LT(wall.largestMove(), 1e-5);
}

// With the factor at hand its rounds end at loads that hold, and what remains of speeds is rounding of the foot.
TEST(DirectIslands, LargeOnesAreFactorizedOnceAndRest) {
    Wall wall(20, 30);
    int factorizations = 0;
    run(wall.world, 0.25, kDt, [&] { factorizations += wall.world.stats().islands[0].factorizations; });
    ASSERT_TRUE(wall.isDirect());
    EXPECT_EQ(factorizations, 1);
    const DVec3 before = wall.world.pose(wall.bricks.back()).position;
    run(wall.world, 0.25, kDt, [&] { EXPECT_EQ(wall.world.stats().islands[0].iterations, 0); });
    EXPECT_EQ(wall.world.pose(wall.bricks.back()).position, before);
}

// Islands come, go and change their numbers around it, by contacts and by joints that leave contacts as they are.
TEST(DirectIslands, OneAtRestIsTheSameWhateverOthersDo) {
    World world(withoutSleep());
    addFloor(world);
    std::vector<BodyId> boxes;
    for (int column = 0; column < 3; ++column)
        for (int i = 0; i < 12; ++i)
            boxes.push_back(world.create(
                bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {4.0 * column + 1e-3 * std::sin(7.0 * i), i + 0.5, 1e-3 * std::cos(5.0 * i)})));
    run(world, 1);
    ASSERT_EQ(world.stats().islands.size(), 3u);
    const auto expectLastAtRest = [&](double seconds) {
        const Pose before = world.pose(boxes.back());
        run(world, seconds, kDt, [&] { EXPECT_EQ(world.linearVelocity(boxes.back()), Vec3{}); });
        EXPECT_EQ(world.pose(boxes.back()).position, before.position);
        EXPECT_EQ(world.pose(boxes.back()).rotation, before.rotation);
    };
    const JointId joint = world.create(DistanceDef{.bodies = {.a = boxes[0], .b = boxes[12]}, .limit = Range{0, 5}});
    expectLastAtRest(0.1);
    world.destroy(joint);
    expectLastAtRest(0.1);
    world.setVelocity(boxes[11], {1, 0, 0}, {});
    expectLastAtRest(0.2);
    for (int i = 0; i < 12; ++i) world.destroy(boxes[static_cast<std::size_t>(i)]);
    expectLastAtRest(0.2);
}

// What comes and goes elsewhere, in every step, is no reason to choose anew; what meets the direct island is.
TEST(DirectIslands, ChosenAnewAtOnceWhereTheyAreMet) {
    Wall wall(10, 10);
    run(wall.world, 0.25);
    ASSERT_TRUE(wall.isDirect());
    const std::size_t before = wall.world.stats().islands.size();
    ASSERT_EQ(before, 1u);
    const int bodies = wall.world.stats().islands[0].bodies;
    BodyDef def = bodyDef(Box{{0.2f, 0.1f, 0.1f}}, wall.world.pose(wall.bricks.back()).position + DVec3(0, 0.205, 0));
    wall.world.create(def);
    run(wall.world, 0.25);
    EXPECT_TRUE(wall.isDirect());
    EXPECT_EQ(wall.world.stats().islands[0].bodies, bodies + 1);
}

TEST(DirectIslands, LargeOnesAreSweptWhileTheyMove) {
    Wall wall(20, 30);
    run(wall.world, 0.1);
    ASSERT_TRUE(wall.isDirect());
    EXPECT_EQ(wall.world.stats().islands[0].bodies, 610);
    wall.world.create([] {
        BodyDef ball = bodyDef(Sphere{0.3f}, {6, 2, -0.5});
        ball.linearVelocity = {0, 0, 5};
        return ball;
    }());
    run(wall.world, 0.2);
    EXPECT_FALSE(wall.isDirect());
    EXPECT_EQ(wall.world.stats().directFailures, 0u);
}

/// A wall that is blown apart three times, and what its steps report.
template <class Visit>
void forEachStepOfRubble(Visit&& visit) {
    World world;
    addFloor(world);
    std::vector<BodyId> bricks;
    for (int course = 0; course < 10; ++course)
        for (int i = 0; i < 6; ++i) {
            BodyDef def =
                bodyDef(Box{{0.25f, 0.12f, 0.12f}}, {-1.3 + 0.505 * i + 0.25 * (course % 2), 0.12 + 0.24 * course, 0});
            def.shapes[0].density = 1800;
            bricks.push_back(world.create(def));
        }
    for (int step = 0; step < 360; ++step) {
        if (step % 120 == 60)
            for (const BodyId brick : bricks) {
                const Vec3 way = relative(world.pose(brick).position, DVec3{0, 0.2, -0.8});
                const float far = length(way), speed = 6 / (1 + far * far);
                world.applyImpulse(brick, world.mass(brick).mass * speed / far * way,
                                   world.pose(brick).position + Vec3{0.05f, 0.05f, 0});
            }
        world.step(kDt);
        visit(world.stats().islands);
    }
}

/// Rubble is what no structure is left of: its stay of 60 steps ends after six that are dear. One in which something is
/// wedged does not count, and no more than every other is such a step.
TEST(DirectIslands, RubbleIsSweptWhileItTumbles) {
    int row = 0, longest = 0;
    forEachStepOfRubble([&](std::span<const StepStats::Island> islands) {
        const bool dear = std::any_of(islands.begin(), islands.end(), [](const StepStats::Island& island) {
            return std::strcmp(island.reason, "staying") == 0 && island.bodies > 40 && island.factorizations > 100;
        });
        row = dear ? row + 1 : 0;
        longest = std::max(longest, row);
    });
    EXPECT_LE(longest, 12);
}

/// Loads of rubble are never those of the substep before. What was too hard once is approached once in a step: its
/// other solves begin as soft as the answer was, and take half as many factors as if each began anew.
TEST(DirectIslands, RubbleIsApproachedOnceInAStep) {
    constexpr int kSolves = 8, kOfASolve = 25;
    int largest = 0;
    forEachStepOfRubble([&](std::span<const StepStats::Island> islands) {
        for (const StepStats::Island& island : islands) largest = std::max(largest, island.factorizations);
    });
    EXPECT_LE(largest, kSolves * kOfASolve);
    EXPECT_GT(largest, kSolves);
}

/// What Newton's method leaves unfinished means nothing: the bodies keep the velocities of before and are swept.
TEST(DirectIslands, UnfinishedSolveWritesNothing) {
    Wall wall(20, 30);
    run(wall.world, 0.5);
    ASSERT_TRUE(wall.isDirect());
    const BodyId pushed = wall.bricks[wall.bricks.size() / 2 + 5];
    const float push = 200 * kGravity;
    wall.world.applyForce(pushed, {0, 0, push * wall.world.mass(pushed).mass}, wall.world.pose(pushed).position);
    wall.world.step(kDt);
    ASSERT_EQ(wall.world.stats().directFailures, 1u);
    ASSERT_EQ(wall.world.stats().islands.size(), 1u);
    EXPECT_FALSE(wall.world.stats().islands[0].solved);
    const float most = push * static_cast<float>(kDt);
    EXPECT_GT(wall.world.linearVelocity(pushed).z, 0.5f * most);
    for (const BodyId brick : wall.bricks) EXPECT_LE(length(wall.world.linearVelocity(brick)), most);
    wall.world.step(kDt);
    EXPECT_FALSE(wall.isDirect());
    EXPECT_EQ(wall.world.stats().directFailures, 1u);
}

TEST(DirectIslands, WallAtRestRestoredGoesOnBitForBit) {
    Wall wall(10, 6);
    run(wall.world, 0.5);
    std::vector<std::byte> state(wall.world.saveSize());
    wall.world.save(state);
    run(wall.world, 0.25);
    const std::uint64_t expected = wall.world.hash();
    wall.world.restore(state);
    run(wall.world, 0.25);
    EXPECT_EQ(wall.world.hash(), expected);
}

/// Two cards, 25° from upright, that lean edge against edge: with a level normal there, as symmetry asks, they stand
/// from μ = (tan 25° − thickness/length)/2 = 0.231. The normal of a card's face is 25° off, more than friction bears.
TEST(DirectIslands, LeaningCardsStandByTheirEdges) {
    constexpr double kLength = 0.4, kThickness = 0.002, kHalfWidth = 0.125, kLean = 25 * 3.14159265358979 / 180;
    World world(withoutSleep());
    addFloor(world, surface(0.3f));
    const double x = kLength * std::sin(kLean), y = kLength * std::cos(kLean);
    std::vector<BodyId> cards;
    std::vector<DVec3> places;
    for (const double side : {-1.0, 1.0}) {
        const DVec3 foot{side * x, 0, 0}, head{0, y, 0}, middle{0.5 * side * x, 0.5 * y, 0};
        const DVec3 back = (kThickness / kLength) * DVec3{side * y, x, 0};
        std::vector<Vec3> corners;
        for (const DVec3& corner : {foot, head, foot + back, head + back})
            for (const double z : {-kHalfWidth, kHalfWidth})
                corners.push_back(relative(DVec3{corner.x, corner.y, z}, middle));
        places.push_back(middle);
        cards.push_back(world.create(bodyDef(ConvexHull{corners}, middle, surface(0.3f))));
    }
    run(world, 5);
    for (std::size_t i = 0; i < cards.size(); ++i)
        EXPECT_LT(length(relative(world.pose(cards[i]).position, places[i])), 2e-4f);
}

/// Soft contacts without loads would let the top of n courses sink by n²/2 · g/ω², 40 mm at 30 Hz; loads that are wrong
/// by a hundredth, by a hundredth of that.
TEST(Settling, WhatIsBuiltDoesNotSinkFirst) {
    WorldSettings settings = withoutSleep();
    settings.solver = SolverChoice::iterative;
    Wall wall(17, 10, settings);
    run(wall.world, 0.5, kDt, [&] { EXPECT_LT(wall.largestMove(), 4e-4); });
    EXPECT_FALSE(wall.isDirect());
}

/// Nor does what is thrown along the ground, in however long a step: by (1 − s_m) g h² it would, 1.1 mm. Its slip then
/// falls by 7/2 μ g dt in each step, to the rounding of its arm.
TEST(Settling, WhatIsThrownAlongTheGroundDoesNotSinkFirst) {
    constexpr double kStep = 1.0 / 15;
    WorldSettings settings = withoutSleep();
    settings.substeps = 1;
    World world(settings);
    addFloor(world, surface(0.1f));
    BodyDef def = bodyDef(Sphere{0.25f}, {0, 0.25, 0}, surface(0.1f));
    def.linearVelocity = {5, 0, 0};
    const BodyId ball = world.create(def);
    for (int i = 1; i <= 20; ++i) {
        world.step(kStep);
        EXPECT_NEAR(world.pose(ball).position.y, 0.25, 2e-6) << i;
        const double slip = world.linearVelocity(ball).x + 0.25f * world.angularVelocity(ball).z;
        EXPECT_NEAR(slip, 5 - 3.5 * 0.1 * static_cast<double>(kGravity) * kStep * i, 2e-5) << i;
    }
}

/// Only what stands: a brick in the air falls.
TEST(Settling, WhatIsAloneFalls) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId brick = world.create(bodyDef(Box{{0.2f, 0.1f, 0.1f}}, {0, 0.2, 0}));
    world.step(kDt);
    EXPECT_NEAR(static_cast<double>(world.linearVelocity(brick).y), -static_cast<double>(kGravity) * kDt, 1e-5);
}

/// A mesh has a manifold for each triangle that a box stands on, slivers among them. A box does not tilt about one of
/// them, so it is chosen for as on a plane, where one that has come to rest alone is iterated.
TEST(DirectIslands, ABoxRestsOnHillsOfTrianglesAsOnAPlane) {
    constexpr std::uint32_t kCells = 80;  // of 1 m
    const auto height = [](float x, float z) { return 0.5f * std::sin(0.5f * x) * std::cos(0.5f * z); };
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t row = 0; row <= kCells; ++row)
        for (std::uint32_t column = 0; column <= kCells; ++column) {
            const float x = static_cast<float>(row) - 0.5f * kCells, z = static_cast<float>(column) - 0.5f * kCells;
            vertices.push_back({x, height(x, z), z});
            if (row == kCells || column == kCells) continue;
            const std::uint32_t a = row * (kCells + 1) + column, c = a + kCells + 1;
            triangles.push_back({a, a + 1, c});
            triangles.push_back({a + 1, c + 1, c});
        }
    const TriangleMesh hills(vertices, triangles);
    for (int i = 0; i < 40; ++i) {
        World world(withoutSleep());
        world.create(StaticBody{.shape = hills, .material = surface(0.6f)});
        const BodyId box = world.create(bodyDef(Box{{0.4f, 0.4f, 0.4f}}, {0.37 * i - 7, 1.2, 0.21 * i}, surface(0.6f)));
        const float heading = 0.157f * static_cast<float>(i);
        world.setVelocity(box, {8 * std::cos(heading), 0, 8 * std::sin(heading)}, {});
        for (int step = 0; step < 480; ++step) world.step(kDt);
        EXPECT_LT(length(world.linearVelocity(box)), 1e-3f) << i;
        EXPECT_TRUE(world.stats().islands.empty()) << i << ' ' << world.stats().islands[0].reason;
    }
}

/// Columns come down on the floor while the contacts of one that was pushed over change from step to step, so that it
/// is chosen for in each of them; for the others there is a choice in every sixteenth.
TEST(DirectIslands, WhatFallsHurriesNoChoiceButItsOwn) {
    constexpr int kPeriod = 16;
    for (const double gap : {0.05, 0.08, 0.11}) {
        World world(withoutSleep());
        addFloor(world);
        std::vector<BodyId> falling;
        for (int i = 0; i < 10; ++i) world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0, gap + 0.2 + 0.4 * i, 0}));
        for (int i = 0; i < 14; ++i)
            falling.push_back(world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {20, 0.2 + 0.4 * i, 0})));
        int chosen = -1;
        for (int step = 0; step < 240 && chosen < 0; ++step) {
            if (step == 2)
                for (std::size_t i = 7; i < falling.size(); ++i) world.setVelocity(falling[i], {1, 0, 0}, {});
            world.step(kDt);
            for (const auto& island : world.stats().islands)
                if (island.bodies == 10) chosen = step;
        }
        EXPECT_GT(chosen, 0) << gap;
        EXPECT_EQ(chosen % kPeriod, 0) << gap;
    }
}

}  // namespace
}  // namespace ragtop
