#include "ragtop/get_up.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "core/heap_counter.h"
#include "human.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

struct Riser {
    World world;
    BodyId floor;
    Ragdoll body;
    Muscles muscles;
    Balance balance;
    GetUp getUp;
    InverseDynamics dynamics;
    Vec3 push{}, twist{};  ///< N s, N m s, of the assistance so far; twist about the centre of mass
    float wrung = 0;       ///< N m s, of its sizes

    explicit Riser(const Quat& turn, const GetUpOptions& options = {})
        : floor(world.create(
              StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}, .material = {.friction = 0.8f}})),
          body(world, human(), standing(BodyAxes(human()), {{0, 1.2, 0}, turn})),
          muscles(world, body, muscleProfile("limp")),
          balance(world, body, muscles),
          getUp(world, body, muscles, balance, options),
          dynamics(world, body) {}
    void lie(double seconds) {
        for (int i = 0; i < std::lround(seconds / kDt); ++i) {
            muscles.step(kDt);
            world.step(kDt);
        }
    }
    void rise(double seconds) {
        muscles.setProfile(muscleProfile("tense"));
        getUp.begin();
        for (int i = 0; i < std::lround(seconds / kDt); ++i) step();
    }
    void step() {
        getUp.step(kDt);
        muscles.step(kDt);
        world.step(kDt);
        dynamics.look();
        push += static_cast<float>(kDt) * getUp.assistance().linear;
        twist += static_cast<float>(kDt) * getUp.assistance().angular;
        wrung += static_cast<float>(kDt) * length(getUp.assistance().angular);
    }
    float height() const { return static_cast<float>(dynamics.centerOfMass().y); }
    float weight() const { return dynamics.mass() * length(world.settings().gravity); }
};

/// On its back, its belly, either side and between. Where the feet come to stand is as the ground has it, so that one
/// in six may fall again; none is held up afterwards.
TEST(GetUp, StandsWithinFourSecondsOfLying) {
    const Vec3 axes[] = {{-1, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {1, 0, 0.5f}, {-1, 0, 0.5f}};
    int stood = 0;
    for (const Vec3& axis : axes) {
        Riser riser(rotationAbout(axis, 0.5f * kPi));
        riser.lie(2);
        riser.dynamics.look();
        ASSERT_LT(riser.height(), 0.35f);
        riser.rise(4);
        EXPECT_TRUE(riser.getUp.stands());
        for (int i = 0; i < 60; ++i) {
            riser.step();
            EXPECT_EQ(length(riser.getUp.assistance().linear) + length(riser.getUp.assistance().angular), 0);
        }
        stood += riser.height() > 0.85f ? 1 : 0;
    }
    EXPECT_GE(stood, 5);
}

/// Who is limp is taken over where it lies: in that step no part goes on by more than 1 cm or 2° beside its velocity.
TEST(GetUp, BeginsWithoutAJump) {
    for (const Vec3& axis : {Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0.5f}}) {
        Riser riser(rotationAbout(axis, 0.5f * kPi));
        riser.lie(2);
        riser.muscles.setProfile(muscleProfile("tense"));
        riser.getUp.begin();
        {
            std::vector<Pose> before;
            std::vector<PartMotion> speeds;
            for (const BodyId part : riser.body.bodies()) {
                before.push_back({riser.world.centerOfMass(part), riser.world.pose(part).rotation});
                speeds.push_back({riser.world.linearVelocity(part), riser.world.angularVelocity(part)});
            }
            riser.step();
            const auto seconds = static_cast<float>(kDt);
            for (std::size_t i = 0; i < before.size(); ++i) {
                const BodyId part = riser.body.bodies()[i];
                const Vec3 way = relative(riser.world.centerOfMass(part), before[i].position);
                const Vec3 turn = rotationVector(riser.world.pose(part).rotation * conjugate(before[i].rotation));
                EXPECT_LT(length(way - seconds * speeds[i].linear), 0.01f) << i;
                EXPECT_LT(length(turn - seconds * speeds[i].angular), 2 * kPi / 180) << i;
            }
        }
    }
}

/// Nothing acts on the body but gravity, the ground and what is told: in the air its momentum changes by these alone.
TEST(GetUp, TheAssistanceIsAllThatActs) {
    for (const float help : {0.0f, 0.6f}) {
        Riser riser(rotationAbout({1, 0, 0}, 0.5f * kPi), {.force = help, .torque = 0.5f * help});
        riser.world.destroy(riser.floor);
        riser.lie(0.2);
        riser.dynamics.look();
        const Vec3 velocity = riser.dynamics.velocity(), spin = riser.dynamics.angularMomentum();
        riser.rise(1);
        const Vec3 gained = riser.dynamics.mass() * (riser.dynamics.velocity() - velocity);
        const Vec3 expected = riser.push - Vec3{0, riser.weight(), 0};
        EXPECT_LT(length(gained - expected), 0.01f * riser.weight()) << help;
        EXPECT_EQ(length(riser.push) > 0, help > 0);
        // N m s: a thousandth of what the weight would give at the length of a leg; a limb is turned from where the
        // step begins, while it moves on in it.
        EXPECT_LT(length(riser.dynamics.angularMomentum() - spin - riser.twist), 0.02f * riser.wrung + 0.3f) << help;
    }
}

TEST(GetUp, AssistanceKeepsWithinItsBounds) {
    const GetUpOptions options{.force = 0.2f, .torque = 0.1f};
    Riser riser(rotationAbout({1, 0, 0}, -0.5f * kPi), options);
    riser.lie(2);
    riser.dynamics.look();
    riser.rise(0);
    const HumanRig rig;
    const float legs =
        length(rig.at(rig.thigh[0]) - rig.at(rig.shank[0])) + length(rig.at(rig.shank[0]) - rig.at(rig.foot[0]));
    float force = 0, torque = 0;
    for (int i = 0; i < 180; ++i) {
        riser.step();
        force = std::max(force, length(riser.getUp.assistance().linear));
        torque = std::max(torque, length(riser.getUp.assistance().angular));
    }
    EXPECT_NEAR(force, 0.2f * riser.weight(), 1e-3f * riser.weight());
    EXPECT_LT(torque, 0.1f * riser.weight() * legs * 1.001f);
}

TEST(GetUp, StepsWithoutMemoryAndTellsWhatIsWrong) {
    Riser riser(rotationAbout({1, 0, 0}, -0.5f * kPi));
    riser.rise(0.4);  // while the profile changes, so does the friction of joints
    const long before = heapCalls();
    riser.getUp.step(kDt);
    riser.muscles.step(kDt);
    EXPECT_EQ(heapCalls(), before);
    EXPECT_EQ(whyInvalid(GetUpOptions{.force = -1}), "force is -1, must be in [0, 2]");
    EXPECT_THROW(GetUp(riser.world, riser.body, riser.muscles, riser.balance, {.rising = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
