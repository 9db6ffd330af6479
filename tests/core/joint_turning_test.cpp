#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "constraints/rows.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

constexpr double kTwoPi = 6.283185307179586;
const Quat kAlongZ = rotationBetween({1, 0, 0}, {0, 0, 1});

WorldSettings swept() {
    WorldSettings settings = withoutGravity();
    settings.solver = 1;
    return settings;
}

/// A thin rod of 1 m.
BodyDef rodAt(const DVec3& position) { return bodyDef(Box{{0.5f, 0.02f, 0.02f}}, position); }

double lengthOf(const DVec3& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

/// (r' − r)/h − ω × r of a turn about z; what is left out is of the order θ⁵ of ω r, 9/2 θ⁵ where arms fade.
TEST(Curving, IsWhatATurnAddsToItsFirstSpeed) {
    const float h = 1.0f / 240, radius = 0.7f;
    for (const double angle : {0.001, 0.01, 0.1, 0.2}) {
        const double w = angle / static_cast<double>(h), r = static_cast<double>(radius);
        const Vec3 found = curving({0, 0, static_cast<float>(w)}, {radius, 0, 0}, h);
        const double x = r * (std::cos(angle) - 1) / static_cast<double>(h);
        const double y = r * std::sin(angle) / static_cast<double>(h) - w * r;
        const double rounding = 1e-6 * w * r, bound = 4.5 * std::pow(angle, 5) * w * r + rounding;
        EXPECT_NEAR(static_cast<double>(found.x), x, bound) << angle;
        EXPECT_NEAR(static_cast<double>(found.y), y, bound) << angle;
    }
}

TEST(Curving, StaysFiniteAtAnySpeed) {
    for (const float w : {1e3f, 1e6f, 1e9f}) {
        const Vec3 found = curving({w, w, 0}, {1, 0, 1}, 1.0f / 240);
        EXPECT_LE(length(found), 2 * w);
    }
}

/// A rod whirls about its end. Nothing is left of ½ h ω² r, which would open the joint by 1.2 mm: only the joint's
/// spring of frequency f gives way, by the acceleration over (2 π f)², half of which acts before positions move.
TEST(SweptJoints, GiveWayToAWhirlingRodAsTheirSpringDoes) {
    constexpr float kSpin = 6;
    for (const bool hinged : {false, true}) {
        World world(swept());
        BodyDef def = rodAt({0.5, 0, 0});
        def.linearVelocity = {0, 0.5f * kSpin, 0};
        def.angularVelocity = {0, 0, kSpin};
        const BodyId rod = world.create(def);
        JointBodies bodies;
        bodies.b = rod;
        bodies.frameA = {{}, kAlongZ};
        bodies.frameB = {{-0.5f, 0, 0}, kAlongZ};
        const JointDef made = hinged ? JointDef(HingeDef{.bodies = bodies}) : JointDef(BallDef{.bodies = bodies});
        const JointId joint = world.create(made);
        run(world, 10);
        const double rate = 240 * static_cast<double>(world.settings().jointFrequency) * kTwoPi;
        const double gives = 0.5 * (0.5 * kSpin * kSpin) / (rate * rate);
        EXPECT_NEAR(static_cast<double>(world.state(joint).gap), gives, 0.1 * gives) << hinged;
        EXPECT_NEAR(static_cast<double>(world.angularVelocity(rod).z), kSpin, 1e-3 * kSpin) << hinged;
    }
}

/// Tension does not resist turns about its own line, however easy they are: nothing is taken from the momentum of two
/// thin rods that whirl on one joint.
TEST(SweptJoints, LeaveThinRodsTheirMomentum) {
    World world(swept());
    BodyDef first = rodAt({-0.5, 0, 0}), second = rodAt({0.5, 0, 0});
    first.angularVelocity = second.angularVelocity = {0, 0, 20};
    first.linearVelocity = {0, -10, 0}, second.linearVelocity = {0, 10, 0};
    const BodyId a = world.create(first), b = world.create(second);
    BallDef def;
    def.bodies.a = a, def.bodies.b = b;
    def.bodies.frameA = {{0.5f, 0, 0}, {}}, def.bodies.frameB = {{-0.5f, 0, 0}, {}};
    world.create(def);
    const auto momentum = [&] {
        DVec3 sum;
        for (const BodyId body : {a, b}) {
            const DVec3 x = world.pose(body).position;
            sum = sum + DVec3(cross(toVec3(x), world.linearVelocity(body)));
            sum = sum + (0.2504 / 3) * DVec3{0, 0, static_cast<double>(world.angularVelocity(body).z)};
        }
        return sum;
    };
    const DVec3 before = momentum();
    run(world, 10);
    EXPECT_LT(lengthOf(momentum() - before), 1e-4 * lengthOf(before));
}

}  // namespace
}  // namespace ragtop::test
