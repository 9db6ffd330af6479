#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "joint_rig.h"

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

}  // namespace
}  // namespace ragtop::test
