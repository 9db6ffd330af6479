#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "joint_rig.h"
#include "ragtop/world.h"

namespace ragtop::test {
namespace {

/// A body that turns into a soft stop: k = 200 N m/rad, 0.02 kg m², ω = 100 rad/s, which is 0.4 rad per substep. It is
/// let go where k x + c v = 0, after Ω t = atan2(2 ζ √(1 − ζ²), 2 ζ² − 1), wherever in a substep it is met and left.
TEST(SoftStop, GivesBackTheSpeedOfItsSpringAndNeverMore) {
    constexpr double kSpeed = 6, kOmega = 100, kTurn = kOmega / 240;
    for (const double ratio : {0.0, 0.1, 0.4}) {
        const double lean = std::sqrt(1 - ratio * ratio);
        const double turn = ratio > 0 ? std::atan2(2 * ratio * lean, 2 * ratio * ratio - 1) : std::numbers::pi;
        const double exact =
            -kSpeed * std::exp(-ratio * turn / lean) * (std::cos(turn) - ratio / lean * std::sin(turn));
        for (int phase = 0; phase < 16; ++phase) {
            Rig rig;
            rig.gravity = {};
            RigBody body = box(1, {0.1f, 0.1f, 0.1f}, {});
            body.inertia = {0.02f, 0.02f, 0.02f};
            body.w = {-static_cast<float>(kSpeed), 0, 0};
            HingeDef hinge;
            // A substep is 25 mrad long.
            hinge.limit = Range{-0.2f - 0.0016f * static_cast<float>(phase), 2};
            hinge.stop.stiffness = 200;
            hinge.stop.damping = static_cast<float>(2 * ratio * kOmega * 0.02);
            rig.join(0, rig.add(body), hinge);
            rig.run(0.15);
            // Where it is met about half way through a substep, the speed to go on from is more than a stop that only
            // pushes can leave: it loses up to (ωh)²/24 of it.
            const auto speed = static_cast<double>(rig.bodies[1].w.x);
            EXPECT_LT(speed, exact + 1e-4 * kSpeed) << ratio << ", phase " << phase;
            EXPECT_GT(speed, exact * (1 - kTurn * kTurn / 24) - 1e-4 * kSpeed) << ratio << ", phase " << phase;
        }
    }
}

/// Two bodies that rattle between soft stops on their hinge, k = 200 N m/rad and 8,000 substeps of what turning adds:
/// springs without damping give back what they took, a hundred times over. Compared while no stop is pressed.
TEST(SoftStop, TwoBodiesThatRattleKeepTheirEnergy) {
    constexpr float kMoments[] = {0.02f, 0.06f, 0.05f};
    World world;
    WorldSettings settings;
    settings.gravity = {};
    world.setSettings(settings);
    BodyId bodies[2];
    for (int i = 0; i < 2; ++i) {
        const float side = i == 0 ? -1.0f : 1.0f;
        BodyDef def;
        def.pose.position = {0.3 * static_cast<double>(side), 0, 0};
        def.shapes.push_back({.geometry = Sphere{0.1f}});
        def.shapes[0].filter.mask = 0;
        def.mass = MassProperties{1, {}, {{kMoments[0], 0, 0}, {0, kMoments[1], 0}, {0, 0, kMoments[2]}}};
        def.angularVelocity = {side * 8, 2, 1};
        def.linearVelocity = cross(Vec3{0, 2, 1}, Vec3{side * 0.3f, 0, 0});
        bodies[i] = world.create(def);
    }
    HingeDef hinge;
    hinge.bodies = {bodies[0], bodies[1], {{0.3f, 0, 0}, {}}, {{-0.3f, 0, 0}, {}}};
    hinge.limit = Range{-0.3f, 0.5f};
    hinge.stop.stiffness = 200;
    const JointId joint = world.create(JointDef(hinge));
    const auto energy = [&] {
        double sum = 0;
        for (const BodyId id : bodies) {
            const Vec3 v = world.linearVelocity(id);
            const Vec3 w = inverseRotate(world.pose(id).rotation, world.angularVelocity(id));
            sum += 0.5 * static_cast<double>(dot(v, v) + kMoments[0] * w.x * w.x + kMoments[1] * w.y * w.y +
                                             kMoments[2] * w.z * w.z);
        }
        return sum;
    };
    world.step(1.0f / 60);
    const double start = energy();
    int seen = 0;
    for (int step = 0; step < 600; ++step) {
        world.step(1.0f / 60);
        if (world.state(joint).limitMargin < 0) continue;
        ++seen;
        EXPECT_NEAR(energy() / start, 1, 1e-3) << step;
    }
    EXPECT_GT(seen, 100);
}

}  // namespace
}  // namespace ragtop::test
