#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

#include "human.h"
#include "ragtop/ragdoll.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

struct Fall {
    World world;
    Ragdoll person;
    Fall()
        : person((world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}}), world), human(),
                 Pose{{0, 0.3, 0}, {}}) {}
    void run(int steps) {
        for (int i = 0; i < steps; ++i) world.step(1.0 / 60);
    }
};

/// The first ball of the person with a swing limit.
std::size_t limitedBall(const RagdollDef& def) {
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        const auto* ball = std::get_if<BallDef>(&def.joints[i].joint);
        if (ball && ball->swingLimit) return i;
    }
    return 0;
}

TEST(RagdollChange, MassesSurfacesAndLimitsReachTheWorld) {
    Fall fall;
    fall.run(30);
    const Vec3 speed = fall.world.linearVelocity(fall.person.bodies()[0]);
    RagdollDef def = human();
    def.parts[0].mass *= 2;
    def.parts[0].material.friction = 0.1f;
    const std::size_t joint = limitedBall(def);
    std::get<BallDef>(def.joints[joint].joint).swingLimit = 0.2f;
    fall.person.setDef(def);
    // Its points go on as they did; the centre is one of them but for rounding.
    EXPECT_LT(length(fall.world.linearVelocity(fall.person.bodies()[0]) - speed), 1e-6f * length(speed));
    EXPECT_EQ(fall.world.mass(fall.person.bodies()[0]).mass, def.parts[0].mass);
    EXPECT_EQ(fall.world.material(fall.world.shapes(fall.person.bodies()[0])[0]).friction, 0.1f);
    EXPECT_EQ(std::get<BallDef>(fall.world.def(fall.person.joints()[joint])).swingLimit, 0.2f);
    // It comes within the new limit and stays there.
    fall.run(240);
    EXPECT_LT(fall.world.state(fall.person.joints()[joint]).swing, 0.25f);
}

/// Twice the mass in every part is twice the weight on the ground.
TEST(RagdollChange, TheGroundCarriesTheNewWeight) {
    Fall fall;
    RagdollDef def = human();
    float mass = 0;
    for (RagdollPart& part : def.parts) mass += part.mass *= 2;
    fall.person.setDef(def);
    WorldSettings settings;
    settings.sleeping = false;
    fall.world.setSettings(settings);
    fall.run(600);
    double force = 0;
    int steps = 0;
    for (; steps < 60; ++steps) {
        fall.world.step(1.0 / 60);
        fall.world.forEachContact(fall.world.bodies()[0],
                                  [&](const Contact& c) { force += static_cast<double>(c.normalForce); });
    }
    EXPECT_NEAR(force / steps, static_cast<double>(mass) * 9.81, 0.02 * static_cast<double>(mass) * 9.81);
}

/// A state brings its masses and surfaces with it, and what is set after it counts although it was set before it too.
TEST(RagdollChange, WhatIsSetAfterAStateOfBeforeCounts) {
    Fall fall;
    fall.run(10);
    std::vector<std::byte> state(fall.world.saveSize());
    fall.world.save(state);
    fall.run(30);
    const std::uint64_t later = fall.world.hash();
    RagdollDef def = human();
    def.parts[0].mass *= 2;
    def.parts[1].material.friction = 0.1f;
    fall.person.setDef(def);
    fall.world.restore(state);
    fall.run(30);
    EXPECT_EQ(fall.world.hash(), later);
    fall.person.setDef(def);
    EXPECT_EQ(fall.world.mass(fall.person.bodies()[0]).mass, def.parts[0].mass);
    EXPECT_EQ(fall.world.material(fall.world.shapes(fall.person.bodies()[1])[0]).friction, 0.1f);
}

TEST(RagdollChange, WhatCannotBeIsRefused) {
    Fall fall;
    fall.run(10);
    const std::uint64_t before = fall.world.hash();
    RagdollDef def = human();
    def.parts[0].mass = -1;
    EXPECT_THROW(fall.person.setDef(def), std::invalid_argument);
    def = human();
    def.joints.pop_back();
    EXPECT_THROW(fall.person.setDef(def), std::invalid_argument);
    def = human();
    def.parts[1].mass *= 2;
    def.joints.back().joint = FixedDef{};
    EXPECT_THROW(fall.person.setDef(def), std::invalid_argument);
    EXPECT_EQ(fall.world.hash(), before);
}

}  // namespace
}  // namespace ragtop
