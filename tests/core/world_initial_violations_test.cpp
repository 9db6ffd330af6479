#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ragtop/world.h"
#include "world_support.h"

// Joints that are made beyond their hard limits.
namespace ragtop::test {
namespace {

constexpr float kMoment = 0.05f;

struct Pair {
    World world;
    BodyId a, b;
    JointId joint;

    /// Two bodies that turn about z as one, B by `beyond` past the end of the hinge between them.
    Pair(float spin, float beyond) {
        WorldSettings settings;
        settings.gravity = {};
        world.setSettings(settings);
        a = body({-0.3, 0, 0}, {}, spin);
        const Quat turned = rotationAbout({0, 0, 1}, 1 + beyond);
        b = body(DVec3(rotate(turned, {0.3f, 0, 0})), turned, spin);
        HingeDef hinge;
        const Quat alongZ = rotationBetween({1, 0, 0}, {0, 0, 1});
        hinge.bodies = {a, b, {{0.3f, 0, 0}, alongZ}, {{-0.3f, 0, 0}, alongZ}};
        hinge.limit = Range{-1, 1};
        joint = world.create(JointDef(hinge));
    }
    BodyId body(const DVec3& place, const Quat& rotation, float spin) {
        BodyDef def;
        def.pose = {place, rotation};
        def.shapes.push_back({.geometry = Sphere{0.1f}});
        def.shapes[0].filter.mask = 0;
        def.mass = MassProperties{1, {}, {{kMoment, 0, 0}, {0, kMoment, 0}, {0, 0, kMoment}}};
        def.angularVelocity = {0, 0, spin};
        def.linearVelocity = cross(def.angularVelocity, relative(place, DVec3{}));
        return world.create(def);
    }
    double energy() const {
        double sum = 0;
        for (const BodyId id : {a, b}) {
            const Vec3 v = world.linearVelocity(id), w = world.angularVelocity(id);
            sum += 0.5 * static_cast<double>(dot(v, v) + kMoment * dot(w, w));
        }
        return sum;
    }
    Vec3 momentum() const { return world.linearVelocity(a) + world.linearVelocity(b); }
    double beyond() const { return -static_cast<double>(world.state(joint).limitMargin); }
};

/// At rest nothing else moves it: 0.01 rad in each step, up to what rows bring back.
TEST(WorldInitialViolations, ComesBackAtABoundedRate) {
    Pair pair(0, 0.5f);
    double before = pair.beyond();
    EXPECT_NEAR(before, 0.5, 1e-5);
    for (int i = 0; i < 70; ++i) {
        pair.world.step(kDt);
        EXPECT_NEAR(before - pair.beyond(), std::min(0.01, before), 2e-4) << i;
        before = pair.beyond();
    }
    EXPECT_LT(before, 1e-3);
    EXPECT_LT(pair.energy(), 1e-9);
}

/// Drawing two bodies in that turn about each other would spin them up: I falls by 40 % here. Moving them does not.
TEST(WorldInitialViolations, GainsNoEnergy) {
    for (const float spin : {0.5f, 8.0f}) {
        Pair pair(spin, 0.8f);
        const double start = pair.energy();
        const Vec3 momentum = pair.momentum();
        for (int i = 0; i < 180; ++i) {
            pair.world.step(kDt);
            EXPECT_LT(pair.energy(), 1.001 * start) << spin << ", step " << i;
            EXPECT_LT(length(pair.momentum() - momentum), 1e-5f * spin) << i;
            EXPECT_LT(pair.world.state(pair.joint).gap, 1e-3f) << i;
        }
        EXPECT_LT(pair.beyond(), 0.01);
    }
}

TEST(WorldInitialViolations, GoesOnFromASavedState) {
    Pair pair(3, 0.8f);
    for (int i = 0; i < 20; ++i) pair.world.step(kDt);
    std::vector<std::byte> saved(pair.world.saveSize());
    pair.world.save(saved);
    const auto later = [&] {
        for (int i = 0; i < 80; ++i) pair.world.step(kDt);
        return pair.world.hash();
    };
    const std::uint64_t once = later();
    pair.world.restore(saved);
    EXPECT_EQ(later(), once);
}

TEST(WorldInitialViolations, LetsGoOfWhatIsGone) {
    Pair pair(0, 0.5f);
    pair.world.step(kDt);
    pair.world.destroy(pair.joint);
    const Pose before = pair.world.pose(pair.b);
    for (int i = 0; i < 10; ++i) pair.world.step(kDt);
    EXPECT_LT(length(relative(pair.world.pose(pair.b).position, before.position)), 1e-6f);
}

}  // namespace
}  // namespace ragtop::test
