#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "chain_support.h"

namespace ragtop {
namespace {

using namespace test;

TEST(TreesOfJoints, HeavyChainsSwingWithoutGapsOrLossOfEnergy) {
    for (const bool hinges : {false, true}) {
        World world(withoutSleep());
        const Chain chain(world, 12, 1000, 0, hinges);
        const double before = energyOf(world, chain), drop = 1000.0 * 9.81 * 6;
        run(world, 3, kDt, [&] { ASSERT_LT(chain.largestGap(world), 1e-3f) << hinges; });
        EXPECT_NEAR(energyOf(world, chain), before, 0.01 * drop) << hinges;
        const auto islands = world.stats().islands;
        ASSERT_EQ(islands.size(), 1u);
        EXPECT_STREQ(islands[0].reason, "tree");
        EXPECT_TRUE(islands[0].solved);
        // Four substeps of one elimination, or two where it is very taut, and a pass after each.
        EXPECT_LE(islands[0].iterations, 12);
    }
}

TEST(TreesOfJoints, TensionOfAHangingChainIsItsWeight) {
    World world(withoutSleep());
    const Chain chain(world, 8, 100);
    for (std::size_t i = 0; i < chain.bodies.size(); ++i)
        world.setPose(chain.bodies[i],
                      {{0, -0.5 * static_cast<double>(i) - 0.25, 0},
                       i == 8 ? rotationBetween({1, 0, 0}, {0, -1, 0}) : rotationBetween({0, 1, 0}, {0, -1, 0})});
    run(world, 2);
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
        const float weight = (100 + static_cast<float>(8 - i)) * kGravity;
        EXPECT_NEAR(length(world.state(chain.joints[i]).force), weight, 1e-3f * weight) << i;
    }
}

/// Chains of two lengths, one of them of hinges: groups of several trees, and one that is alone.
std::vector<DVec3> placesAfter(const WorldConfig& config, int company, double seconds) {
    World world(withoutSleep(), config);
    const Chain first(world, 9, 300);
    std::vector<Chain> others;
    for (int i = 0; i < company; ++i)
        others.emplace_back(world, i % 3 == 2 ? 11 : 9, 300.0f + i, 2.0 * i + 2, i % 4 == 3);
    run(world, seconds);
    std::vector<DVec3> places;
    for (const BodyId body : first.bodies) places.push_back(world.centerOfMass(body));
    return places;
}

TEST(TreesOfJoints, CompanyAndLanesChangeNoBit) {
    const std::vector<DVec3> independent = placesAfter({.lanes = 4}, 0, 1.5);
    for (const int lanes : {4, 8, 16})
        for (const int company : {0, 13}) EXPECT_EQ(placesAfter({.lanes = lanes}, company, 1.5), independent) << lanes;
}

/// Narrow groups before wide ones: vectors of every width must lie where they may be read.
TEST(TreesOfJoints, AnyCompanyOfWidthsChangesNoBit) {
    for (int light = 1; light <= 4; ++light) {
        std::vector<std::uint64_t> hashes;
        for (const int lanes : {4, 8, 16}) {
            World world(withoutSleep(), {.lanes = lanes});
            for (int i = 0; i < light; ++i) Chain(world, 7 + i, 2, 2.0 * i);
            for (int i = 0; i < 11; ++i) Chain(world, 9, 300, -2.0 * i - 2);
            run(world, 0.2);
            hashes.push_back(world.hash());
        }
        EXPECT_EQ(hashes[1], hashes[0]) << light;
        EXPECT_EQ(hashes[2], hashes[0]) << light;
    }
}

TEST(TreesOfJoints, RestoredWorldGoesOnBitForBit) {
    World world(withoutSleep());
    const Chain chain(world, 10, 500), other(world, 6, 500, 3, true);
    run(world, 1);
    expectRestoredGoesOn(world);
}

/// Two rods of 1 m on hinges, one below the other, let go from the side.
struct DoublePendulum {
    World world;
    BodyId rods[2];

    explicit DoublePendulum(int substeps) : world(settingsOf(substeps)) {
        const Quat aboutZ = rotationBetween({1, 0, 0}, {0, 0, 1});
        for (int i = 0; i < 2; ++i) {
            BodyDef def = bodyDef(Box{{0.5f, 0.02f, 0.02f}}, {i + 0.5, 0, 0});
            def.shapes[0].filter.mask = 0;
            rods[i] = world.create(def);
            HingeDef hinge;
            if (i > 0) hinge.bodies.a = rods[0];
            hinge.bodies.b = rods[i];
            hinge.bodies.frameA = {i > 0 ? Vec3{0.5f, 0, 0} : Vec3{}, aboutZ};
            hinge.bodies.frameB = {{-0.5f, 0, 0}, aboutZ};
            world.create(hinge);
        }
    }
    static WorldSettings settingsOf(int substeps) {
        WorldSettings settings = withoutSleep();
        settings.substeps = substeps;
        return settings;
    }
    double energy() const {
        double sum = 0;
        for (const BodyId rod : rods) {
            const Vec3 v = world.linearVelocity(rod), l = angularMomentum(world, rod);
            const float m = world.mass(rod).mass;
            sum += 0.5 * static_cast<double>(m * dot(v, v) + dot(l, world.angularVelocity(rod))) +
                   static_cast<double>(m * kGravity) * world.centerOfMass(rod).y;
        }
        return sum;
    }
    /// Largest error of the energy in four seconds, over what there is between level and hanging.
    double worstError() {
        const double start = energy(), swing = 4 * static_cast<double>(world.mass(rods[0]).mass * kGravity);
        double worst = 0;
        run(world, 4, kDt, [&] { worst = std::max(worst, std::fabs(energy() - start) / swing); });
        return worst;
    }
};

TEST(TreesOfJoints, EnergyErrsWithTheSquareOfTheSubstep) {
    const double coarse = DoublePendulum(2).worstError(), fine = DoublePendulum(8).worstError();
    EXPECT_LT(fine, 2e-4);
    // A sixteenth: the orders above the second are still felt at two substeps.
    EXPECT_NEAR(fine / coarse, 1.0 / 16, 0.03);
}

/// What is thrown at 46 m/s, where velocities are known to 2e-6 m/s, keeps what it has of angular momentum about its
/// centre of mass to far less than the sum of such roundings.
TEST(TreesOfJoints, ThrownFigureKeepsItsMomentaAtAnySpeed) {
    World world(withoutGravity());
    scenes::Dice dice(7);
    std::vector<BodyId> bodies;
    const auto joinTo = [&](std::size_t above, bool hinged, const DVec3& at) {
        BodyDef def = bodyDef(Box{{0.06f, 0.15f, 0.05f}}, at);
        def.shapes[0].filter.mask = 0;
        def.shapes[0].density = dice.between(500, 2000);
        def.linearVelocity = {30, -30, 20};
        def.angularVelocity = {dice.between(-3, 3), dice.between(-3, 3), dice.between(-3, 3)};
        const BodyId body = world.create(def);
        const bool root = bodies.empty();
        bodies.push_back(body);
        if (root) return;
        const Vec3 apart = toVec3(at - world.pose(bodies[above]).position);
        const JointBodies joined{bodies[above], body, {0.5f * apart, {}}, {-0.5f * apart, {}}};
        if (hinged)
            world.create(HingeDef{.bodies = joined});
        else
            world.create(BallDef{.bodies = joined});
    };
    for (int i = 0; i < 9; ++i)
        joinTo(i < 5 ? static_cast<std::size_t>(i > 0 ? i - 1 : 0) : static_cast<std::size_t>(i - 4), i % 3 == 2,
               i < 5 ? DVec3{0, 0.35 * i, 0} : DVec3{0.3, 0.35 * (i - 4), 0});
    struct Whole {
        double mass = 0, arms = 0;  // kg, kg m
        DVec3 center, speed, turning;
    };
    const auto whole = [&] {
        Whole sum;
        for (const BodyId body : bodies) {
            const auto m = static_cast<double>(world.mass(body).mass);
            sum.mass += m;
            sum.center = sum.center + m * world.centerOfMass(body);
            sum.speed = sum.speed + m * DVec3(world.linearVelocity(body));
        }
        sum.center = (1 / sum.mass) * sum.center, sum.speed = (1 / sum.mass) * sum.speed;
        for (const BodyId body : bodies) {
            const auto m = static_cast<double>(world.mass(body).mass);
            const DVec3 x = world.centerOfMass(body) - sum.center, v = DVec3(world.linearVelocity(body)) - sum.speed;
            const DVec3 own(angularMomentum(world, body));
            sum.turning =
                sum.turning + own + m * DVec3{x.y * v.z - x.z * v.y, x.z * v.x - x.x * v.z, x.x * v.y - x.y * v.x};
            sum.arms += m * static_cast<double>(length(toVec3(x)));
        }
        return sum;
    };
    // In the first step what does not fit the joints is lost, and what fits is rounded to an ulp of 47 m/s.
    world.step(kDt);
    const Whole before = whole();
    run(world, 5);
    ASSERT_STREQ(world.stats().islands[0].reason, "tree");
    const Whole after = whole();
    const DVec3 way = after.center - before.center - (world.time() - kDt) * before.speed;
    // Velocities are told in floats: to half an ulp of 47 m/s, 2e-6 m/s.
    EXPECT_LT(length(toVec3(after.turning - before.turning)), 2e-6 * before.arms);
    EXPECT_LT(length(toVec3(way)), 1e-4f);
    EXPECT_LT(length(toVec3(after.speed - before.speed)), 2e-6f);
}

/// A velocity that is set counts as it is, whatever rounding has left over.
TEST(TreesOfJoints, VelocityThatIsSetHolds) {
    World world(withoutSleep());
    const Chain chain(world, 3, 1);
    run(world, 0.5);
    for (const BodyId body : chain.bodies) world.setVelocity(body, {}, {});
    const double before = energyOf(world, chain);
    const DVec3 place = world.centerOfMass(chain.bodies[3]);
    world.step(kDt);
    // At most free fall for a step.
    EXPECT_LE(length(toVec3(world.centerOfMass(chain.bodies[3]) - place)), 0.5f * 9.81f / 3600 * 1.5f);
    EXPECT_NEAR(energyOf(world, chain), before, 1e-3 * 9.81);
}

/// Two posts and a beam of 1 m on four hinges, pushed aside: in each swing all lie on one line, where the mechanism
/// could go on in two ways.
TEST(LoopsOfJoints, FourBarStaysClosedThroughItsSingularPose) {
    World world(withoutSleep());
    const Quat aboutZ = rotationBetween({1, 0, 0}, {0, 0, 1});
    const auto bar = [&](const DVec3& center, const Vec3& half, const Vec3& v, float spin) {
        BodyDef def = bodyDef(Box{half}, center);
        def.shapes[0].filter.mask = 0;
        def.linearVelocity = v;
        def.angularVelocity = {0, 0, spin};
        return world.create(def);
    };
    const Vec3 upright{0.02f, 0.5f, 0.02f}, level{0.5f, 0.02f, 0.02f};
    const BodyId left = bar({0, 0.5, 0}, upright, {0.5f, 0, 0}, -1);
    const BodyId right = bar({1, 0.5, 0}, upright, {0.5f, 0, 0}, -1);
    const BodyId beam = bar({0.5, 1, 0}, level, {1, 0, 0}, 0);
    std::vector<JointId> hinges;
    const auto hinge = [&](BodyId a, const Vec3& inA, BodyId b, const Vec3& inB) {
        hinges.push_back(world.create(HingeDef{.bodies = {a, b, {inA, aboutZ}, {inB, aboutZ}}}));
    };
    hinge({}, {}, left, {0, -0.5f, 0});
    hinge({}, {1, 0, 0}, right, {0, -0.5f, 0});
    hinge(left, {0, 0.5f, 0}, beam, {-0.5f, 0, 0});
    hinge(beam, {0.5f, 0, 0}, right, {0, 0.5f, 0});
    float gap = 0;
    double lowest = 0;
    run(world, 5, kDt, [&] {
        for (const JointId joint : hinges) gap = std::max(gap, world.state(joint).gap);
        lowest = std::min(lowest, world.centerOfMass(beam).y);
    });
    EXPECT_LT(gap, 1e-4f);
    EXPECT_LT(lowest, -0.95);  // it hangs down in between
    ASSERT_EQ(world.stats().islands.size(), 1u);
    EXPECT_STREQ(world.stats().islands[0].reason, "loop");
}

TEST(TreesOfJoints, HingesCountTheirTurns) {
    World world(withoutSleep());
    const Chain chain(world, 8, 20, 0, true);
    // Its neighbours are too light to keep the ball from going round, by 0.67 rad per step at first.
    world.setVelocity(chain.bodies.back(), {0, 0, 0}, {0, 0, 40});
    float last = 0, farthest = 0;
    run(world, 1, kDt, [&] {
        const float now = world.state(chain.joints.back()).coordinate;
        EXPECT_LT(std::fabs(now - last), 0.5f * kPi);
        last = now;
        farthest = std::max(farthest, std::fabs(now));
    });
    EXPECT_GT(farthest, kPi);
}

TEST(TreesOfJoints, ChainBreaksWhereItsLoadIsTooLarge) {
    World world(withoutSleep());
    const Chain chain(world, 8, 100, 0, false, 500);
    run(world, 1);
    EXPECT_FALSE(world.isValid(chain.joints.front()));
}

}  // namespace
}  // namespace ragtop
