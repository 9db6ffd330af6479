#include <gtest/gtest.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "world_support.h"

// A joint that the core does not know, made in this file alone out of what docs/architecture.md names for that: a
// module that names its bodies and gives impulses before each substep.
namespace ragtop {
namespace {

using namespace test;

/// A rope over two pulleys, which can pull only: its ends hang straight below them.
///
///   C = yA + yB − c ≥ 0,   Ċ = vA + vB,   λ = max(0, −(Ċ + 2 h g + β C)/(1/mA + 1/mB))   up, on both ends,
///
/// with what gravity gives in the substep, as it is integrated after the impulse.
class ToyRope {
public:
    ToyRope(World& world, BodyId a, BodyId b) : ends_{a, b}, sum_(sumIn(world)) {
        module_.user = this;
        module_.name = "rope";
        module_.look = [](void* user, const World&, double) { return std::span<const BodyId>(self(user).ends_); };
        module_.beforeSubstep = [](void* user, World& inWorld, double h) { self(user).pull(inWorld, h); };
        world.add(&module_);
    }
    ToyRope(const ToyRope&) = delete;
    ToyRope& operator=(const ToyRope&) = delete;

    /// m, by which it is too long.
    double gap(const World& world) const { return sum_ - sumIn(world); }

private:
    static ToyRope& self(void* user) { return *static_cast<ToyRope*>(user); }
    double sumIn(const World& world) const { return world.centerOfMass(ends_[0]).y + world.centerOfMass(ends_[1]).y; }
    void pull(World& world, double h) const {
        constexpr double kClosing = 0.2;  // of the gap, in a substep
        double speed = 0, perImpulse = 0;
        for (const BodyId end : ends_) {
            speed += asDouble(world.linearVelocity(end).y) + h * asDouble(world.settings().gravity.y);
            perImpulse += 1 / asDouble(world.mass(end).mass);
        }
        const double impulse = (kClosing / h * gap(world) - speed) / perImpulse;
        if (impulse <= 0) return;
        for (const BodyId end : ends_)
            world.applyImpulse(end, {0, static_cast<float>(impulse), 0}, world.centerOfMass(end));
    }

    std::vector<BodyId> ends_;
    double sum_;  ///< m
    StepModule module_;
};

BodyId weight(World& world, float mass, double x) {
    BodyDef def = bodyDef(Box{{0.1f, 0.1f, 0.1f}}, {x, 10, 0});
    def.mass = MassProperties{mass, {}, Mat3{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    return world.create(def);
}

/// a = g (mB − mA)/(mA + mB). A substep moves an end by at most ½ h² g less or more than a parabola does, of which the
/// gap keeps five times as much, as a fifth of it is closed in each. An impulse acts from the beginning of its substep
/// on, so that places are of first order: off by at most ½ h t (g + a), of the lighter end.
TEST(ToyJoint, ARopeFromOutsideFallsAsAtwoodsMachineDoes) {
    World world;
    const BodyId a = weight(world, 1, 0), b = weight(world, 3, 2);
    const ToyRope rope(world, a, b);
    run(world, 1);
    const double h = kDt / world.settings().substeps, g = asDouble(kGravity), acceleration = g * (3 - 1) / (3 + 1);
    EXPECT_NEAR(rope.gap(world), 0, 5 * h * h * g);
    EXPECT_NEAR(world.linearVelocity(a).y, acceleration, h * g);
    EXPECT_NEAR(world.centerOfMass(a).y - 10, 0.5 * acceleration, 0.5 * h * (g + acceleration));
    EXPECT_NEAR(10 - world.centerOfMass(b).y, 0.5 * acceleration, 0.5 * h * (g + acceleration));
}

/// What is thrown up slackens the rope, and falls freely.
TEST(ToyJoint, ARopeFromOutsideDoesNotPush) {
    World world;
    const BodyId a = weight(world, 1, 0), b = weight(world, 1, 2);
    const ToyRope rope(world, a, b);
    world.setVelocity(a, {0, 2, 0}, {});
    world.step(kDt);
    EXPECT_NEAR(asDouble(world.linearVelocity(a).y), 2 - asDouble(kGravity) * kDt, 1e-5);
    EXPECT_NEAR(asDouble(world.linearVelocity(b).y), -asDouble(kGravity) * kDt, 1e-5);
}

/// It is solved, saved and restored with its world.
TEST(ToyJoint, AWorldWithARopeGoesOnAsItWasSaved) {
    World world;
    const BodyId a = weight(world, 1, 0), b = weight(world, 3, 2);
    const ToyRope rope(world, a, b);
    run(world, 0.25);
    std::vector<std::byte> state(world.saveSize());
    world.save(state);
    run(world, 0.25);
    const auto once = world.hash();
    world.restore(state);
    run(world, 0.25);
    EXPECT_EQ(world.hash(), once);
}

}  // namespace
}  // namespace ragtop
