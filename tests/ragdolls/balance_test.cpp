#include "ragtop/balance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "core/heap_counter.h"
#include "human.h"
#include "ragtop/world.h"
#include "support.h"

namespace ragtop {
namespace {

struct Stander {
    World world;
    BodyId floor;
    Ragdoll body;
    Muscles muscles;
    Balance balance;
    InverseDynamics dynamics;

    explicit Stander(const BodyType ground = BodyType::fixed, SolverChoice solver = SolverChoice::automatic)
        : world(WorldSettings{.sleeping = false, .solver = solver}),
          floor(world.create(BodyDef{.type = ground,
                                     .shapes = {{.geometry = Box{{100, 1, 100}}, .material = {.friction = 0.8f}}},
                                     .pose = {{0, -1, 0}, {}}})),
          body(world, human(), standing(BodyAxes(human()))),
          muscles(world, body),
          balance(world, body, muscles),
          dynamics(world, body) {}
    void run(double seconds) {
        for (int i = 0; i < std::lround(seconds / kDt); ++i) step();
    }
    void step() {
        balance.step(kDt);
        muscles.step(kDt);
        world.step(kDt);
        dynamics.look();
    }
    float height() const { return static_cast<float>(dynamics.centerOfMass().y); }
    /// All parts get the same velocity, m/s.
    void push(const Vec3& velocity) {
        for (const BodyId part : body.bodies())
            world.setVelocity(part, world.linearVelocity(part) + velocity, world.angularVelocity(part));
    }
};

/// m, thigh and shank.
float rigLegs() {
    const HumanRig rig;
    return length(rig.at(rig.thigh[0]) - rig.at(rig.shank[0])) + length(rig.at(rig.shank[0]) - rig.at(rig.foot[0]));
}

TEST(Balance, StandsStill) {
    Stander stander;
    stander.run(4);
    const float height = stander.height();
    const DVec3 place = stander.dynamics.centerOfMass();
    EXPECT_GT(height, 0.9f);
    stander.run(16);
    EXPECT_NEAR(stander.height(), height, 0.005f);
    EXPECT_LT(length(relative(stander.dynamics.centerOfMass(), place)), 0.03f);
    EXPECT_LT(length(stander.dynamics.velocity()), 0.005f);
    EXPECT_GT(stander.balance.margin(), 0.03f);
}

/// The weight is fed forward, so that no spring has to be stiffer than sweeps of the solver hold.
TEST(Balance, StandsAlsoWhereNothingIsSolvedDirectly) {
    Stander stander(BodyType::fixed, SolverChoice::iterative);
    stander.run(10);
    EXPECT_GT(stander.height(), 0.9f);
    EXPECT_LT(length(stander.dynamics.velocity()), 0.01f);
}

/// Rising from a squat, feet stay on the ground, and hips rise no faster than asked for.
TEST(Balance, RisesFromASquat) {
    Stander stander;
    BalanceOptions options;
    stander.run(2);
    const float upright = stander.height();
    for (const float crouch : {0.3f, BalanceOptions{}.crouch}) {
        const float before = options.crouch;
        for (int i = 1; i <= 90; ++i) {
            options.crouch = before + (crouch - before) * (static_cast<float>(i) / 90);
            stander.balance.setOptions(options);
            stander.step();
            EXPECT_TRUE(stander.balance.onFeet());
        }
        stander.run(2);
        // m: hips sink by that share of the legs, and the legs' own third of the mass by less.
        const float sunk = (crouch - BalanceOptions{}.crouch) * rigLegs();
        EXPECT_LT(stander.height(), upright - 0.66f * sunk + 0.005f) << crouch;
        EXPECT_GT(stander.height(), upright - sunk - 0.005f) << crouch;
    }
}

/// Told to rise from a squat at once, it begins no faster than feet are pressed on the ground by gravity: its centre of
/// mass, whose speed is at most that of the hips, never gains more in a step than they may and what springs overshoot.
TEST(Balance, RisesAtOnceWithoutLeavingTheGround) {
    Stander stander;
    BalanceOptions options{.crouch = 0.3f};
    stander.balance.setOptions(options);
    stander.run(3);
    const float squat = stander.height();
    stander.balance.setOptions({});
    float before = stander.height(), speed = 0;
    for (int i = 0; i < 90; ++i) {
        stander.step();
        const float next = 60 * (stander.height() - before);
        EXPECT_TRUE(stander.balance.onFeet()) << i;
        EXPECT_LT(60 * std::abs(next - speed), 9.81f) << i;
        before = stander.height();
        speed = next;
    }
    EXPECT_GT(stander.height(), squat + 0.15f * rigLegs());
}

/// J = m d √(g/z) is what a body without a step can take, d from the centre of mass to the edge of its feet.
TEST(Balance, TakesFourFifthsOfWhatFeetCanFromAnySide) {
    for (int way = 0; way < 8; ++way) {
        Stander stander;
        stander.run(3);
        const float rate = std::sqrt(9.81f / stander.height());
        const SinCos angle = sinCos(0.25f * kPi * static_cast<float>(way));
        const Vec3 along{angle.sin, 0, angle.cos};
        const float edge = stander.balance.reach(along);
        EXPECT_GT(edge, 0.05f);
        stander.push(0.8f * edge * rate * along);
        stander.run(6);
        EXPECT_GT(stander.height(), 0.9f) << way;
        // As still as who was not pushed: the capture point comes back at 1.8 √(g/z), the lean is learnt at 0.5/s.
        EXPECT_LT(length(stander.dynamics.velocity()), 0.005f) << way;
    }
}

/// A half more than J, which feet in place cannot take, is taken by a step; and what is asked for not to step falls.
TEST(Balance, AStepTakesAHalfMoreThanThatFromAnySide) {
    for (int way = 0; way < 9; ++way) {
        Stander stander;
        stander.run(3);
        const bool inPlace = way == 8;
        if (inPlace) stander.balance.setOptions({.step = 0});
        const float rate = std::sqrt(9.81f / stander.height());
        const SinCos angle = sinCos(0.25f * kPi * static_cast<float>(way));
        const Vec3 along{angle.sin, 0, angle.cos};
        stander.push(1.5f * stander.balance.reach(along) * rate * along);
        bool stepped = false;
        for (int i = 0; i < std::lround(6 / kDt); ++i) {
            stander.step();
            stepped |= stander.balance.steps();
        }
        EXPECT_EQ(stepped, !inPlace) << way;
        EXPECT_EQ(stander.height() > 0.8f, !inPlace) << way;
        EXPECT_TRUE(inPlace || length(stander.dynamics.velocity()) < 0.05f) << way;
    }
}

/// Whose trunk is wider than its shoulders holds its arms farther off, so that no two of its parts press on each other.
TEST(Balance, StandsWithATrunkThatIsWiderThanTheShoulders) {
    RagdollDef def = human();
    for (RagdollPart& part : def.parts)
        if (part.role == BodyRole::abdomen || part.role == BodyRole::chest)
            std::get<Box>(part.shape).halfExtents.x = 0.3f;
    World world(WorldSettings{.sleeping = false});
    world.create(
        BodyDef{.type = BodyType::fixed, .shapes = {{.geometry = Box{{100, 1, 100}}}}, .pose = {{0, -1, 0}, {}}});
    const PartAngles arms[] = {{BodyRole::upperArm, BodySide::left, 0, 1}, {BodyRole::upperArm, BodySide::right, 0, 1}};
    Ragdoll body(world, def, standing(BodyAxes(def), {}, arms));
    Muscles muscles(world, body);
    Balance balance(world, body, muscles);
    InverseDynamics dynamics(world, body);
    for (int i = 0; i < 600; ++i) {
        balance.step(kDt);
        muscles.step(kDt);
        world.step(kDt);
    }
    dynamics.look();
    EXPECT_GT(dynamics.centerOfMass().y, 0.85);
    EXPECT_LT(length(dynamics.velocity()), 0.005f);
    for (const BodyId part : body.bodies())
        world.forEachContact(part, [&](const Contact& contact) {
            const auto own = [&](BodyId id) {
                return std::find(body.bodies().begin(), body.bodies().end(), id) != body.bodies().end();
            };
            EXPECT_FALSE(contact.normalForce > 0 && own(contact.bodyA) && own(contact.bodyB));
        });
}

/// On what accelerates it leans by z a/g.
TEST(Balance, LeansIntoAnAcceleration) {
    Stander stander(BodyType::kinematic);
    stander.run(3);
    const auto ahead = [&] {
        double feet = 0;
        for (std::size_t i = 0; i < human().parts.size(); ++i)
            if (human().parts[i].role == BodyRole::foot)
                feet += 0.5 * stander.world.centerOfMass(stander.body.bodies()[i]).z;
        return stander.dynamics.centerOfMass().z - feet;
    };
    const double upright = ahead();
    for (double time = 0; time < 10; time += kDt) {
        const double way = 0.5 * (time + kDt) * (time + kDt);
        stander.world.moveTo(stander.floor, {{0, -1, way}, {}}, kDt);
        stander.step();
    }
    EXPECT_GT(stander.height(), 0.85f);
    EXPECT_NEAR(ahead() - upright, static_cast<double>(stander.height()) / 9.81, 0.015);
}

/// No force acts on what balances but gravity: in the air its centre of mass falls, and it keeps its angular momentum.
TEST(Balance, HoldsTheBodyByItsJointsAlone) {
    Stander stander;
    stander.run(2);
    for (const BodyId part : stander.body.bodies()) {
        Pose pose = stander.world.pose(part);
        pose.position.y += 50;
        stander.world.setPose(part, pose);
    }
    stander.dynamics.look();
    const DVec3 start = stander.dynamics.centerOfMass();
    const Vec3 first = stander.dynamics.velocity();
    const Vec3 spin = stander.dynamics.angularMomentum();
    stander.run(1);
    const Vec3 velocity = stander.dynamics.velocity();
    EXPECT_NEAR(velocity.y - first.y, -9.81f, 1e-3f);
    EXPECT_LT(std::hypot(velocity.x - first.x, velocity.z - first.z), 1e-4f);
    EXPECT_LT(std::abs(stander.dynamics.centerOfMass().x - start.x - first.x), 1e-3);
    // N m s: what a thousandth of the weight gives about a hand's breadth in that second.
    EXPECT_LT(length(stander.dynamics.angularMomentum() - spin), 1e-3f * 75 * 9.81f * 0.1f);
    EXPECT_FALSE(stander.balance.onFeet());
}

TEST(Balance, StepsWithoutMemory) {
    Stander stander;
    stander.run(0.5);
    const long before = heapCalls();
    stander.balance.step(kDt);
    stander.muscles.step(kDt);
    EXPECT_EQ(heapCalls(), before);
}

TEST(Balance, WhatIsWrongIsTold) {
    EXPECT_EQ(whyInvalid(BalanceOptions{.gain = 0.5f}), "gain is 0.5, must be in [1, 20]");
    World world;
    RagdollDef def = human();
    Ragdoll body(world, def);
    Muscles muscles(world, body);
    EXPECT_THROW(Balance(world, body, muscles, {.crouch = 2}), std::invalid_argument);
    Balance standing(world, body, muscles);
    EXPECT_THROW(standing.setOptions({.gain = 0}), std::invalid_argument);
    EXPECT_THROW(standing.setOptions({.step = -1}), std::invalid_argument);
    EXPECT_EQ(standing.options().gain, BalanceOptions{}.gain);
    for (RagdollPart& part : def.parts)
        if (part.role == BodyRole::foot && part.side == BodySide::right) part.role = BodyRole::other;
    Ragdoll lame(world, def);
    Muscles others(world, lame);
    try {
        Balance balance(world, lame, others);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(),
                     "balance: the right leg is not a thigh on the pelvis, a shank on a hinge and a foot");
    }
}

TEST(Support, ASoleIsFlatOnItsCornersAndKeepsWaysWithin) {
    const BodyAxes axes(human());
    const Sole sole = soleOf(axes, axes.find(BodyRole::foot, BodySide::left));
    ASSERT_EQ(sole.corners.size(), 4u);
    for (const Vec3& corner : sole.corners) {
        EXPECT_NEAR(dot(corner - sole.middle, sole.up), 0, 1e-5f);
        EXPECT_LT(length(sole.within(corner - sole.middle, 1) - (corner - sole.middle)), 1e-5f);
        EXPECT_LT(length(sole.within(3 * (corner - sole.middle), 0.5f) - 0.5f * (corner - sole.middle)), 1e-5f);
    }
    EXPECT_LT(length(sole.within(0.1f * sole.up, 1)), 1e-6f);
}

/// A hull that narrows upwards stands on what is lowest of it, however its frame lies; a box is the hull of its
/// corners.
TEST(Support, TheSoleOfAHullIsThatOfTheBoxThatItStandsOn) {
    RagdollDef def = human();
    const BodyAxes axes(def);
    const int foot = axes.find(BodyRole::foot, BodySide::left);
    RagdollPart& part = def.parts[static_cast<std::size_t>(foot)];
    const Vec3 half = std::get<Box>(part.shape).halfExtents;
    const Vec3 down = inverseRotate(part.frame.rotation, inverseRotate(axes.zero(foot), {0, -1, 0}));
    for (const float narrowing : {1.0f, 0.4f}) {
        std::vector<Vec3> corners;
        for (int i = 0; i < 8; ++i) {
            const Vec3 corner = scale(half, {i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
            const bool isLow = dot(corner, down) > 0;
            corners.push_back(isLow ? corner : scale(corner, {narrowing, narrowing, 1}));
        }
        part.shape = ConvexHull(corners);
        const Sole of = soleOf(BodyAxes(def), foot), expected = soleOf(axes, foot);
        ASSERT_EQ(of.corners.size(), 4u);
        EXPECT_LT(length(of.middle - expected.middle), 1e-6f);
        EXPECT_LT(length(of.up - expected.up), 1e-6f);
        for (std::size_t i = 0; i < 2; ++i)
            EXPECT_NEAR(length(of.halves[i]), length(expected.halves[i]), 1e-6f) << narrowing;
    }
}

/// Feet that are hulls hold a person up as boxes do.
TEST(Balance, StandsOnHulls) {
    RagdollDef def = human();
    for (RagdollPart& part : def.parts) {
        if (part.role != BodyRole::foot) continue;
        const Vec3 half = std::get<Box>(part.shape).halfExtents;
        const std::vector<Vec3> corners{{-half.x, -half.y, -half.z},
                                        {half.x, -half.y, -half.z},
                                        {-half.x, half.y, -half.z},
                                        {half.x, half.y, -half.z},
                                        {0, 0, half.z},
                                        {0, -half.y, half.z}};
        part.shape = ConvexHull(corners);
    }
    World world(WorldSettings{.sleeping = false});
    world.create(
        BodyDef{.type = BodyType::fixed, .shapes = {{.geometry = Box{{100, 1, 100}}}}, .pose = {{0, -1, 0}, {}}});
    Ragdoll body(world, def, standing(BodyAxes(def)));
    Muscles muscles(world, body);
    Balance balance(world, body, muscles);
    InverseDynamics dynamics(world, body);
    DVec3 before;
    for (int i = 0; i < 1200; ++i) {
        balance.step(kDt);
        muscles.step(kDt);
        world.step(kDt);
        dynamics.look();
        if (i == 300) before = dynamics.centerOfMass();
    }
    EXPECT_GT(dynamics.centerOfMass().y, 0.9);
    EXPECT_LT(length(relative(dynamics.centerOfMass(), before)), 0.01f);
    EXPECT_LT(length(dynamics.velocity()), 0.005f);
    EXPECT_GT(balance.margin(), 0.03f);
}

TEST(Support, MarginIsTheWayToTheNearestEdge) {
    std::vector<Spot> square{{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}};
    EXPECT_NEAR(marginWithin(square, {0.5f, 1}), 0.5f, 1e-6f);
    EXPECT_NEAR(marginWithin(square, {3, 1}), -1, 1e-6f);
    EXPECT_NEAR(marginWithin(square, {3, 3}), -std::sqrt(2.0f), 1e-6f);
    std::vector<Spot> line{{0, 0}, {2, 0}};
    EXPECT_NEAR(marginWithin(line, {0, 1}), -1, 1e-6f);
}

}  // namespace
}  // namespace ragtop
