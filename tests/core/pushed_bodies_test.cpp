#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "ragtop/module.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// A module that pushes a body at a place on it, by another force in each substep.
struct Press {
    BodyId body;
    Vec3 place;  ///< on the body, from its centre
    std::vector<Vec3> forces;
    std::size_t next = 0;
    StepModule module;

    Press(World& world, BodyId pressed, Vec3 at) : body(pressed), place(at) {
        module.user = this;
        module.look = [](void* user, const World&, double) {
            return std::span<const BodyId>(&static_cast<Press*>(user)->body, 1);
        };
        module.beforeSubstep = [](void* user, World& in, double h) {
            Press& self = *static_cast<Press*>(user);
            const Vec3 force = self.forces[self.next++ % self.forces.size()];
            in.applyImpulse(self.body, static_cast<float>(h) * force,
                            in.centerOfMass(self.body) + rotate(in.pose(self.body).rotation, self.place));
        };
        world.add(&module);
    }
    Press(const Press&) = delete;
    Press& operator=(const Press&) = delete;
};

/// What lies on the floor hands on what presses it, whatever it weighs itself, and gives way by no more than rows that
/// do not carry its weight yet: m g of a stiffness m ω² with ω h = 2π/4.
TEST(PushedBodies, HandOnALoadThatJumpsFromSubstepToSubstep) {
    std::mt19937 random(1);
    for (const double rate : {30.0, 60.0, 120.0}) {
        for (const float ratio : {1.0f, 30.0f, 1000.0f}) {
            World world(withoutSleep());
            addFloor(world);
            const BodyId brick = world.create(bodyDef(Box{{0.1f, 0.03f, 0.08f}}, {0, 0.03, 0}));
            const float weight = kGravity * world.mass(brick).mass;
            Press press(world, brick, {0.04f, 0.03f, -0.03f});
            for (int i = 0; i < 997; ++i) {
                const float share = 0.5f + 0.5f * static_cast<float>(random() % 1000) / 999;
                press.forces.push_back({0, -share * ratio * weight, 0});
            }
            run(world, 0.5, 1 / rate);
            const auto h = static_cast<float>(1 / rate) / static_cast<float>(world.settings().substeps);
            const float sag = kGravity * h * h / (0.25f * kPi * kPi);
            for (int i = 0; i < 100; ++i) {
                world.step(1 / rate);
                const float pressed = -press.forces[(press.next - 1) % press.forces.size()].y;
                float borne = 0;
                world.forEachContact(brick, [&](const Contact& contact) { borne += contact.normalForce; });
                ASSERT_NEAR(borne, pressed + weight, 0.01f * (pressed + weight)) << rate << " Hz, " << ratio;
                const Pose pose = world.pose(brick);
                ASSERT_NEAR(pose.position.y, 0.03, asDouble(2 * sag)) << rate << " Hz, " << ratio;
                ASSERT_LT(length(Vec3{pose.rotation.x, 0, pose.rotation.z}), 2 * sag / 0.08f) << rate << ", " << ratio;
            }
        }
    }
}

/// Friction under it holds what pushes it along within its cone, which the load on it widens.
TEST(PushedBodies, StickUnderALoadThatTheyDoNotWeigh) {
    for (const float share : {0.9f, 1.1f}) {
        World world(withoutSleep());
        addFloor(world, surface(0.6f));
        const BodyId brick = world.create(bodyDef(Box{{0.1f, 0.03f, 0.08f}}, {0, 0.03, 0}, surface(0.6f)));
        const float load = 500 * kGravity * world.mass(brick).mass;
        Press press(world, brick, {});
        press.forces = {{share * 0.6f * load, -load, 0}};
        run(world, 1);
        if (share < 1)
            EXPECT_LT(std::abs(world.pose(brick).position.x), 1e-3);
        else
            EXPECT_GT(world.pose(brick).position.x, 1);
    }
}

/// In flight, x = ½ a t² but for the first substep, of whose acceleration nothing is known before: ½ a h² more.
TEST(PushedBodies, FlyAlongAParabola) {
    for (const double rate : {30.0, 60.0, 240.0}) {
        World world(withoutGravity());
        const BodyId ball = world.create(bodyDef(Sphere{0.5f}, {}));
        const float mass = world.mass(ball).mass;
        Press press(world, ball, {});
        press.forces = {{3 * mass, 0, 0}};
        run(world, 2, 1 / rate);
        const double h = 1 / rate / world.settings().substeps;
        EXPECT_NEAR(world.pose(ball).position.x, 0.5 * 3 * (4 + h * h), 1e-4) << rate;
    }
}

/// What stands on what it does not push gets no more than it can hold on to: a brick beyond whose edge a wheel presses
/// tips, and leaves no faster than the push throws it.
TEST(PushedBodies, TipWherePressedBeyondTheirEdge) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId plank = world.create(bodyDef(Box{{0.1f, 0.03f, 0.08f}}, {0, 0.03, 0}));
    const float weight = kGravity * world.mass(plank).mass;
    Press press(world, plank, {0.15f, 0.03f, 0});
    press.forces = {{0, -4 * weight, 0}};
    for (int i = 0; i < 12; ++i) {
        world.step(kDt);
        ASSERT_LT(length(world.linearVelocity(plank)), 4 * kGravity * kDt * (i + 1));
    }
    EXPECT_LT(rotate(world.pose(plank).rotation, {0, 1, 0}).y, 0.95f);
}

}  // namespace
}  // namespace ragtop
