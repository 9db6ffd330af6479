#include "ragtop/brace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/heap_counter.h"
#include "human.h"
#include "ragtop/balance.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

struct Faller {
    World world;
    BodyId floor;
    Ragdoll body;
    Muscles muscles;
    Brace brace;
    BodyRole first = BodyRole::other;  ///< what met the ground first, of all but legs
    float headSpeed = 0;               ///< m/s, of the hardest impact of the head

    /// Tips over as a whole from standing, at so many m/s of each metre of height, in a direction.
    Faller(const Vec3& direction, float rate)
        : floor(world.create(
              StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}, .material = {.friction = 0.8f}})),
          body(world, human(), standing(BodyAxes(human()))),
          muscles(world, body),
          brace(world, body, muscles) {
        const Vec3 spin = rate * cross(Vec3{0, 1, 0}, direction);
        for (const BodyId part : body.bodies())
            world.setVelocity(part, cross(spin, toVec3(world.centerOfMass(part))), spin);
    }
    void fall(bool bracing) {
        if (!bracing) muscles.setProfile(muscleProfile("limp"), 0);
        for (int i = 0; i < 240; ++i) {
            if (bracing) brace.step();
            muscles.step(kDt);
            std::vector<float> down;
            for (const BodyId part : body.bodies()) down.push_back(-world.linearVelocity(part).y);
            world.step(kDt);
            for (std::size_t part = 0; part < down.size(); ++part) note(part, down[part]);
        }
    }
    void note(std::size_t part, float speed) {
        const BodyRole role = human().parts[part].role;
        if (role == BodyRole::foot || role == BodyRole::shank || role == BodyRole::thigh) return;
        bool touches = false;
        world.forEachContact(body.bodies()[part], [&](const Contact& contact) {
            touches |= (contact.bodyA == floor || contact.bodyB == floor) && contact.normalForce > 0;
        });
        if (!touches) return;
        if (first == BodyRole::other) first = role;
        if (role == BodyRole::head) headSpeed = std::max(headSpeed, speed);
    }
};

TEST(Brace, MeetsTheGroundWithTheHandsAndSparesTheHead) {
    float braced = 0, limp = 0;
    for (int way = 0; way < 8; ++way) {
        const SinCos angle = sinCos(0.25f * kPi * static_cast<float>(way));
        Faller one({angle.sin, 0, angle.cos}, 1), other({angle.sin, 0, angle.cos}, 1);
        one.fall(true);
        other.fall(false);
        EXPECT_TRUE(one.first == BodyRole::hand || one.first == BodyRole::forearm || one.first == BodyRole::upperArm)
            << way << " " << nameOf(one.first);
        braced += one.headSpeed;
        limp += other.headSpeed;
    }
    EXPECT_GT(limp, 8 * 1.0f);
    EXPECT_LT(braced, 0.6f * limp);
}

/// No force acts on who falls but gravity.
TEST(Brace, ActsByTheJointsAlone) {
    Faller faller({0, 0, 1}, 1);
    faller.world.destroy(faller.floor);
    InverseDynamics dynamics(faller.world, faller.body);
    const Vec3 velocity = dynamics.velocity(), spin = dynamics.angularMomentum();
    for (int i = 0; i < 60; ++i) {
        faller.brace.step();
        faller.muscles.step(kDt);
        faller.world.step(kDt);
    }
    dynamics.look();
    EXPECT_LT(length(dynamics.velocity() - velocity - Vec3{0, -9.81f, 0}), 2e-3f);
    EXPECT_LT(length(dynamics.angularMomentum() - spin), 0.01f * length(spin));
}

TEST(Brace, StepsWithoutMemoryAndTellsWhatItLacks) {
    Faller faller({0, 0, 1}, 1);
    faller.brace.step();
    const long before = heapCalls();
    faller.brace.step();
    EXPECT_EQ(heapCalls(), before);
    RagdollDef def = human();
    for (RagdollPart& part : def.parts)
        if (part.role == BodyRole::upperArm && part.side == BodySide::left) part.role = BodyRole::other;
    World world;
    Ragdoll body(world, def);
    Muscles muscles(world, body);
    EXPECT_THROW(Brace(world, body, muscles), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
