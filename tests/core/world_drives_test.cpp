#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "heap_counter.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

/// A chain that hangs by balls and hinges in turn.
struct DrivenChain {
    World world;
    std::vector<JointId> joints;

    DrivenChain() {
        BodyId carrier{};
        for (int i = 0; i < 6; ++i) {
            const BodyId body = world.create(bodyDef(Box{{0.2f, 0.05f, 0.05f}}, {0.5 * i, 3, 0}));
            JointBodies joined{.a = carrier, .b = body, .frameB = {{-0.25f, 0, 0}, {}}};
            joined.frameA.position = i == 0 ? Vec3{-0.25f, 3, 0} : Vec3{0.25f, 0, 0};
            const JointDef def =
                i % 2 == 0 ? JointDef(BallDef{.bodies = joined}) : JointDef(HingeDef{.bodies = joined});
            joints.push_back(world.create(def));
            carrier = body;
        }
    }
    bool isBall(std::size_t joint) const { return std::holds_alternative<BallDef>(world.def(joints[joint])); }
};

std::vector<JointDrive> drivesAt(const DrivenChain& chain, int step) {
    std::mt19937 random(static_cast<unsigned>(step));
    const auto any = [&](float most) { return std::uniform_real_distribution<float>(-most, most)(random); };
    std::vector<JointDrive> drives;
    for (const JointId joint : chain.joints) {
        JointDrive drive{.joint = joint, .angle = any(1), .stiffness = 50 + any(40), .damping = 2 + any(1)};
        drive.target = rotationAbout({any(1), any(1), 1}, any(1));
        // Now and then a plain spring, which has other rows.
        if (step % 7 != 0) drive.speed = {any(1), any(1), any(1)};
        if (step % 7 != 0) drive.feedForward = {any(3), any(3), any(3)};
        if (step % 5 == 0) drive.maxTorque = 20;
        drives.push_back(drive);
    }
    return drives;
}

JointDef withSpring(const JointDef& def, const JointDrive& drive) {
    JointDef result = def;
    Spring spring{.stiffness = drive.stiffness, .damping = drive.damping};
    if (auto* ball = std::get_if<BallDef>(&result)) {
        ball->spring = spring;
        ball->target = drive.target;
        ball->targetSpeed = drive.speed;
        ball->feedForward = drive.feedForward;
        ball->maxSpringTorque = drive.maxTorque;
    } else {
        auto& hinge = std::get<HingeDef>(result);
        spring.speed = drive.speed.x;
        spring.feedForward = drive.feedForward.x;
        spring.maxForce = drive.maxTorque;
        hinge.spring = spring;
        hinge.target = drive.angle;
    }
    return result;
}

TEST(Drives, DoWhatDefinitionsWithTheirSpringsDo) {
    DrivenChain chain, other;
    for (int step = 1; step <= 120; ++step) {
        const std::vector<JointDrive> drives = drivesAt(chain, step);
        chain.world.setDrives(drives);
        for (std::size_t i = 0; i < drives.size(); ++i)
            other.world.setDef(other.joints[i], withSpring(other.world.def(other.joints[i]), drives[i]));
        chain.world.step(kDt);
        other.world.step(kDt);
        ASSERT_EQ(chain.world.hash(), other.world.hash()) << step;
    }
}

TEST(Drives, AreSetWithoutMemory) {
    DrivenChain chain;
    for (int step = 0; step < 3; ++step) {
        const std::vector<JointDrive> drives = drivesAt(chain, 8 + step);
        const long before = heapCalls();
        chain.world.setDrives(drives);
        const long calls = heapCalls() - before;
        EXPECT_TRUE(step == 0 || calls == 0) << calls;
    }
}

TEST(Drives, ThatStayLetSleepersSleep) {
    DrivenChain chain;
    const std::vector<JointDrive> drives = drivesAt(chain, 7);
    chain.world.setDrives(drives);
    const BodyId body = chain.world.bodies().back();
    chain.world.sleep(body);
    chain.world.setDrives(drives);
    EXPECT_FALSE(chain.world.isAwake(body));
    chain.world.setDrives(drivesAt(chain, 14));
    EXPECT_TRUE(chain.world.isAwake(body));
}

/// The rows of what is broken are listed one by one; the good drive before it is not set either.
TEST(Drives, WhatIsWrongIsToldAndChangesNothing) {
    DrivenChain chain;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto tells = [&](const char* what, auto&& spoil) {
        std::vector<JointDrive> drives = drivesAt(chain, 8);
        spoil(drives[1]);
        const auto hash = chain.world.hash();
        try {
            chain.world.setDrives(drives);
            ADD_FAILURE() << what;
        } catch (const std::invalid_argument& error) {
            EXPECT_EQ(std::string(error.what()), std::string("drives[1]: ") + what);
        }
        EXPECT_EQ(chain.world.hash(), hash);
        EXPECT_FALSE(std::get<BallDef>(chain.world.def(chain.joints[0])).spring);
    };
    tells("stiffness must be in [0, 1e12] N m/rad", [&](JointDrive& drive) { drive.stiffness = -1; });
    tells("damping must be in [0, 1e12] N m s/rad", [&](JointDrive& drive) { drive.damping = nan; });
    tells("angle must be in [-1e5, 1e5] rad", [&](JointDrive& drive) { drive.angle = nan; });
    tells("speed must be in [-1e5, 1e5] rad/s", [&](JointDrive& drive) { drive.speed.y = 1e6f; });
    tells("feedForward must be in [-1e12, 1e12] N m", [&](JointDrive& drive) { drive.feedForward.x = nan; });
    tells("maxTorque must be at least 0 N m", [&](JointDrive& drive) { drive.maxTorque = nan; });
    tells("target must be finite and have length 1 to within 0.001", [&](JointDrive& drive) {
        drive.target = {};
        drive.target.w = 2;
    });
    const JointId weld = chain.world.create(FixedDef{.bodies = {.b = chain.world.bodies().back()}});
    tells("joint must be a ball or a hinge", [&](JointDrive& drive) { drive.joint = weld; });
    EXPECT_THROW(chain.world.setDrives(std::vector<JointDrive>(1)), std::out_of_range);
}

}  // namespace
}  // namespace ragtop::test
