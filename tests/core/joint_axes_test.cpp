#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "joint_rig.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

const Quat kUp = rotationBetween({1, 0, 0}, {0, 1, 0});

/// Without friction a body turns and falls along a post as if it were alone, whatever else pushes it.
TEST(Cylindrical, TurnsAndSlidesFreely) {
    Rig rig;
    RigBody body = box(2, {0.2f, 0.1f, 0.3f}, {});
    body.w = {0, 7, 0};
    rig.add(body);
    CylindricalDef def;
    def.bodies = frames({}, {}, kUp, kUp);
    rig.join(0, 1, def);
    rig.gravity = {4, -9.81f, -3};
    rig.run(1);
    const double h = asDouble(rig.h());
    EXPECT_NEAR(rig.state().second, -9.81 / 2 * (1 + h), 1e-3);
    EXPECT_NEAR(rig.state().coordinate, 7, 1e-3);
    EXPECT_NEAR(rig.state().speed, 7, 1e-4);
    EXPECT_LT(rig.state().gap, 1e-3);
}

TEST(Cylindrical, DrivesAndStopsBothOfItsCoordinates) {
    Rig rig;
    rig.add(box(2, {0.2f, 0.1f, 0.3f}, {}));
    CylindricalDef def;
    def.bodies = frames({}, {}, kUp, kUp);
    def.turn.motor = Motor{3, 100};
    def.travel.limit = Range{-0.5f, 0.5f};
    rig.join(0, 1, def);
    rig.run(3);
    EXPECT_NEAR(rig.state().second, -0.5, 1e-3);
    EXPECT_NEAR(rig.state().coordinate, 9, 0.05);
}

TEST(Plane, SlidesAsAFreeBodyInItsPlane) {
    Rig rig;
    RigBody body = box(2, {0.2f, 0.1f, 0.3f}, {});
    body.v = {3, 0, -2};
    body.w = {0, 4, 0};
    rig.add(body);
    PlaneDef def;
    def.bodies = frames({}, {0.3f, 0, 0.1f}, kUp, kUp);
    rig.join(0, 1, def);
    rig.begin();
    const double energy = rig.energy();
    rig.run(2);
    // Its centre of mass goes straight on.
    EXPECT_NEAR(rig.bodies[1].position.x, 6, 6e-3);
    EXPECT_NEAR(rig.bodies[1].position.z, -4, 4e-3);
    EXPECT_NEAR(rig.bodies[1].position.y, 0, 1e-3);
    EXPECT_NEAR(rig.state().coordinate, 8, 1e-2);
    EXPECT_NEAR(rig.energy(), energy, 1e-3 * energy);
}

/// The nut's weight turns it: with r = pitch/2π, (m r² + I) α = m g r.
TEST(Screw, FallsAlongItsThread) {
    const double pitch = 0.2, r = pitch / (2 * std::numbers::pi);
    Rig rig;
    const RigBody body = box(2, {0.1f, 0.1f, 0.1f}, {});
    rig.add(body);
    ScrewDef def;
    def.bodies = frames({}, {}, kUp, kUp);
    def.pitch = static_cast<float>(pitch);
    rig.join(0, 1, def);
    rig.run(2);
    const double acceleration = 2 * 9.81 * r / (2 * r * r + asDouble(body.inertia.y));
    EXPECT_NEAR(rig.state().speed, -2 * acceleration, 2e-3 * 2 * acceleration);
    EXPECT_NEAR(rig.bodies[1].position.y, r * asDouble(rig.state().coordinate), 1e-4);
    EXPECT_GT(std::abs(rig.state().coordinate), 2 * std::numbers::pi);
}

/// A thread locks itself where the friction of its nut exceeds what its load turns it with.
TEST(Screw, HoldsByFriction) {
    for (const float friction : {0.55f, 0.7f}) {  // m g r = 0.6245 N m
        Rig rig;
        rig.add(box(2, {0.1f, 0.1f, 0.1f}, {}));
        ScrewDef def;
        def.bodies = frames({}, {}, kUp, kUp);
        def.pitch = 0.2f;
        def.turn.friction = friction;
        rig.join(0, 1, def);
        rig.run(2);
        if (friction > 0.6245f)
            EXPECT_NEAR(rig.state().coordinate, 0, 1e-3);
        else
            EXPECT_LT(rig.state().coordinate, -1);
    }
}

/// Two shafts at an angle β: tan(out) = tan(in) cos β, and after whole turns they agree.
TEST(Universal, TurnsAShaftAsTheCardanFormulaSays) {
    const double beta = 0.5;
    Rig rig;
    rig.gravity = {};
    const Quat out = rotationAbout({0, 0, 1}, static_cast<float>(beta));
    const Vec3 along = rotate(out, {1, 0, 0});
    RigBody first = box(1, {0.5f, 0.1f, 0.1f}, {-0.5, 0, 0});
    RigBody second = box(1, {0.5f, 0.1f, 0.1f}, DVec3(0.5f * along));
    second.rotation = out;
    rig.add(first);
    rig.add(second);
    HingeDef bearing;
    bearing.bodies = frames({-0.5f, 0, 0}, {});
    bearing.motor = Motor{5, 1000};
    rig.join(0, 1, bearing);
    bearing.motor.reset();
    bearing.bodies = frames(0.5f * along, {}, out, {});
    rig.join(0, 2, bearing);
    UniversalDef def;
    // The cross turns about B's y axis, and A's x axis is across its shaft: the shafts are the other axes.
    const Quat cross = rotationBetween({1, 0, 0}, {0, 0, 1});
    def.bodies = frames({0.5f, 0, 0}, {-0.5f, 0, 0}, cross, cross);
    rig.join(1, 2, def);
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
        rig.step();
        if (i < 60) continue;
        const double in = asDouble(rig.state(0).coordinate), turned = asDouble(rig.state(1).coordinate);
        // With the cross' first arm across the plane of the shafts: tan(out) = tan(in)/cos β or its inverse.
        const double exact =
            std::min(std::abs(std::remainder(std::atan2(std::sin(in) * std::cos(beta), std::cos(in)) - turned,
                                             2 * std::numbers::pi)),
                     std::abs(std::remainder(std::atan2(std::sin(in), std::cos(in) * std::cos(beta)) - turned,
                                             2 * std::numbers::pi)));
        worst = std::max(worst, exact);
    }
    EXPECT_GT(rig.state(1).coordinate, 40);
    EXPECT_LT(worst, 2e-3);
}

TEST(Universal, LimitsEachOfItsAngles) {
    Rig rig;
    RigBody body = box(1, {0.3f, 0.05f, 0.05f}, {0.3, 0, 0});
    body.w = {3, 8, 5};
    rig.add(body);
    UniversalDef def;
    def.bodies = frames({}, {-0.3f, 0, 0});
    def.first.limit = Range{-0.4f, 0.5f};
    def.second.limit = Range{-0.3f, 0.2f};
    rig.join(0, 1, def);
    double worst = 0;
    for (int i = 0; i < 300; ++i) {
        rig.step();
        worst = std::max(worst, -asDouble(rig.state().limitMargin));
    }
    EXPECT_LT(worst, 0.1 * std::numbers::pi / 180 * 5);
    EXPECT_LT(rig.state().gap, 1e-3);
}

TEST(Axes, FreePairsKeepTheirMomentum) {
    for (int kind = 0; kind < 4; ++kind) {
        Rig rig;
        rig.gravity = {};
        RigBody a = box(1, {0.2f, 0.1f, 0.3f}, {}), b = box(3, {0.1f, 0.4f, 0.1f}, {0.5, 0.2, 0});
        a.w = {3, -2, 1}, b.w = {-1, 4, 2}, a.v = {1, 0, 2};
        rig.add(a);
        rig.add(b);
        const JointBodies bodies = frames({0.25f, 0.1f, 0}, {-0.25f, -0.1f, 0});
        const JointDef defs[] = {CylindricalDef{bodies, {}, {}}, PlaneDef{bodies, {}, {}, {}},
                                 ScrewDef{bodies, 0.1f, {}}, UniversalDef{bodies, {}, {}}};
        rig.join(1, 2, defs[kind]);
        rig.begin();
        const DVec3 before = rig.angularMomentum();
        rig.run(0.1);  // what does not fit the joint is lost at once
        const double energy = rig.energy();
        rig.run(2);
        const DVec3 change = rig.angularMomentum() - before;
        EXPECT_LT(std::sqrt(change.x * change.x + change.y * change.y + change.z * change.z), 2e-4) << kind;
        EXPECT_NEAR(rig.energy(), energy, 0.02 * energy) << kind;
    }
}

}  // namespace
}  // namespace ragtop::test
