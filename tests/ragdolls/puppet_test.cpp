#include "ragtop/puppet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/heap_counter.h"
#include "human.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

struct Show {
    World world{WorldSettings{.sleeping = false}};
    BodyId floor;
    Ragdoll body;
    Puppet puppet;
    InverseDynamics dynamics;
    std::vector<PuppetState> states{PuppetState::stands};

    explicit Show(const PuppetOptions& options = {})
        : floor(world.create(
              StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}, .material = {.friction = 0.8f}})),
          body(world, human(), standing(BodyAxes(human()))),
          puppet(world, body, options),
          dynamics(world, body) {}
    void run(double seconds) {
        for (int i = 0; i < std::lround(seconds / kDt); ++i) {
            puppet.step(kDt);
            if (puppet.state() != states.back()) states.push_back(puppet.state());
            world.step(kDt);
        }
        dynamics.look();
    }
    void strike(BodyRole role, const Vec3& impulse) {
        const int part = BodyAxes(human()).find(role, role == BodyRole::chest ? BodySide::middle : BodySide::left);
        puppet.strike(part, impulse, world.centerOfMass(body.bodies()[static_cast<std::size_t>(part)]));
    }
    bool has(PuppetState state) const { return std::find(states.begin(), states.end(), state) != states.end(); }
};

TEST(Puppet, StandsAndTakesALightBlow) {
    Show show;
    show.run(2);
    // N s: a third of m d √(g/z), d of 0.1 m.
    show.strike(BodyRole::chest, {0, 0, 8});
    show.run(3);
    EXPECT_EQ(show.puppet.state(), PuppetState::stands);
    EXPECT_FALSE(show.has(PuppetState::falls));
    EXPECT_GT(show.dynamics.centerOfMass().y, 0.85);
}

/// Twice m d √(g/z), with d from the centre of mass to the toes, of half a sole's length or so.
TEST(Puppet, TakesAStepAndStands) {
    for (const float way : {1.0f, -1.0f}) {
        Show show;
        show.run(2);
        show.strike(BodyRole::chest, {0, 0, 60 * way});
        show.run(5);
        EXPECT_FALSE(show.has(PuppetState::falls));
        EXPECT_TRUE(show.has(PuppetState::staggers));
        EXPECT_EQ(show.puppet.state(), PuppetState::stands);
        EXPECT_GT(show.dynamics.centerOfMass().y, 0.85);
    }
}

/// The whole way: stands, falls, lies, gets up and stands, as often as it takes; no force but gravity, the ground and
/// what is told while it gets up.
TEST(Puppet, FallsAndGetsUpAgain) {
    Show show;
    show.run(2);
    show.strike(BodyRole::chest, {0, 0, -150});
    show.run(3);
    EXPECT_TRUE(show.has(PuppetState::falls));
    EXPECT_TRUE(show.has(PuppetState::lies));
    show.run(17);
    EXPECT_TRUE(show.has(PuppetState::getsUp));
    EXPECT_EQ(nameOf(show.puppet.state()), "stands");
    EXPECT_GT(show.dynamics.centerOfMass().y, 0.85);
    EXPECT_EQ(length(show.puppet.assistance().linear), 0);
    const auto order = [&](PuppetState a, PuppetState b) {
        return std::find(show.states.begin(), show.states.end(), a) <
               std::find(show.states.begin(), show.states.end(), b);
    };
    EXPECT_TRUE(order(PuppetState::falls, PuppetState::lies));
    EXPECT_TRUE(order(PuppetState::lies, PuppetState::getsUp));
}

/// A struck joint is weak, the next less so by half, and both come back.
TEST(Puppet, IsLimpWhereItIsStruckForAWhile) {
    Show show;
    show.run(1);
    int elbow = -1, shoulder = -1, knee = -1;
    for (std::size_t i = 0; i < human().joints.size(); ++i) {
        const RagdollPart& part = human().parts[static_cast<std::size_t>(human().joints[i].child)];
        if (part.side != BodySide::left) continue;
        if (part.role == BodyRole::forearm) elbow = static_cast<int>(i);
        if (part.role == BodyRole::upperArm) shoulder = static_cast<int>(i);
        if (part.role == BodyRole::shank) knee = static_cast<int>(i);
    }
    show.strike(BodyRole::hand, {0, 0, 10});
    EXPECT_NEAR(show.puppet.muscles().strength(elbow), 1 - 0.5f * 0.25f, 1e-5f);
    EXPECT_NEAR(show.puppet.muscles().strength(shoulder), 1 - 0.25f * 0.25f, 1e-5f);
    EXPECT_EQ(show.puppet.muscles().strength(knee), 1);
    show.run(0.4);
    EXPECT_NEAR(show.puppet.muscles().strength(elbow), 1 - 0.5f * 0.5f * 0.25f, 0.01f);
    show.run(0.6);
    EXPECT_EQ(show.puppet.muscles().strength(elbow), 1);
    EXPECT_EQ(show.puppet.state(), PuppetState::stands);
}

TEST(Puppet, StepsWithoutMemoryAndTellsWhatIsWrong) {
    Show show;
    show.run(0.5);
    const long before = heapCalls();
    show.puppet.step(kDt);
    EXPECT_EQ(heapCalls(), before);
    EXPECT_EQ(whyInvalid(PuppetOptions{.hurt = 0}), "hurt is 0 N s, must be in [0.1, 1e+06]");
    EXPECT_THROW(Puppet(show.world, show.body, {.rest = -1}), std::invalid_argument);
    EXPECT_THROW(show.puppet.strike(99, {}, {}), std::out_of_range);
    EXPECT_THROW(show.puppet.strike(0, {std::numeric_limits<float>::infinity(), 0, 0}, {}), std::invalid_argument);
}

/// What is saved while it staggers, falls, lies or gets up goes on from there with the same bits.
TEST(Puppet, GoesOnFromASavedStateWithTheSameBits) {
    Show show;
    show.run(1);
    show.strike(BodyRole::chest, {0, 0, 120});
    for (int part = 0; part < 8; ++part) {
        std::vector<std::byte> saved(show.world.saveSize());
        show.world.save(saved);
        const std::uint64_t then = show.world.hash();
        show.run(0.7);
        const std::uint64_t after = show.world.hash();
        show.world.restore(saved);
        EXPECT_EQ(show.world.hash(), then) << part;
        show.run(0.7);
        EXPECT_EQ(show.world.hash(), after) << part << " " << nameOf(show.puppet.state());
    }
    EXPECT_TRUE(show.has(PuppetState::lies));
    EXPECT_TRUE(show.has(PuppetState::getsUp));
}

}  // namespace
}  // namespace ragtop
