#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace isotropy_cases {

struct Slide {
    double forward = 0, sideways = 0;  ///< m, along and across the heading
};

Slide slideAlong(Trial& trial, double heading, double speed, float friction) {
    Scene scene;
    const Material material = surface(friction);
    addFloor(scene, material);
    BodyDef cube = solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, material);
    const double c = std::cos(heading), s = std::sin(heading);
    cube.linearVelocity = toVec3(DVec3{speed * c, 0, speed * s});
    const int box = add(scene, cube);
    Run run = trial.start(scene, fmt::format("{:.2f} rad", heading));
    run.advance(1.5 * speed / (static_cast<double>(friction) * kGravity));
    const DVec3 end = run.position(box);
    return {end.x * c + end.z * s, std::abs(end.z * c - end.x * s)};
}

/// The stopping distance may not depend on the heading, and nothing is pushed aside.
void headings(Trial& trial) {
    constexpr int kHeadings = 16;
    constexpr double kSpeed = 5;
    constexpr float kFriction = 0.5f;
    const double exact = kSpeed * kSpeed / (2 * static_cast<double>(kFriction) * kGravity);
    double shortest = INFINITY, longest = -INFINITY, sideways = 0;
    for (int i = 0; i < kHeadings; ++i) {
        const Slide slide = slideAlong(trial, 2 * std::numbers::pi * i / kHeadings, kSpeed, kFriction);
        shortest = smaller(shortest, slide.forward);
        longest = larger(longest, slide.forward);
        sideways = larger(sideways, slide.sideways);
    }
    trial.expectNear("shortest distance", shortest, exact, 0.002 * exact, "m");
    trial.expectNear("longest distance", longest, exact, 0.002 * exact, "m");
    trial.expectAtMost("spread", longest - shortest, 0.001 * exact, "m");
    trial.expectAtMost("sideways", sideways, 0.001 * exact, "m");
}

/// A board of 10 kg on 5 × 5 balls of 1 kg, pushed with 150 N. All roll, so that with the board's acceleration a each
/// ball has a/2 and takes m a (1/4 + I/(4 m r²)) = 0.35 m a from the board. The push acts where the balls touch it, so
/// that it does not tilt the board; and the run is over before the balls lag so far behind that those at the rear slip:
/// they need 89 % of their share of the load.
void board(Trial& trial, double heading) {
    constexpr float kRadius = 0.1f, kBoard = 10, kBall = 1;
    constexpr double kPush = 150, kSeconds = 0.25;
    Scene scene;
    // The pairs meet with 0.8 above, √(0.8 · 0.2) = 0.4 below.
    const Material smooth = surface(0.2f), rough = surface(0.8f);
    addFloor(scene, smooth);
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j) add(scene, solidBody(Sphere{kRadius}, {2.0 * i, 0.1, 2.0 * j}, kBall, rough));
    const int top = add(scene, solidBody(Box{{5, 0.1f, 5}}, {0, 0.3, 0}, kBoard, rough));
    Run run = trial.start(scene);
    const double c = std::cos(heading), s = std::sin(heading);
    const auto count = std::lround(kSeconds / trial.dt());
    for (long i = 0; i < count; ++i) {
        const DVec3 middle = run.position(top);
        run.engine().push(top, toVec3(kPush * DVec3{c, 0, s}), middle + DVec3{0, -0.1, 0});
        run.step();
    }
    const DVec3 v{run.motion(top).v};
    const double exact = kPush / (kBoard + 25 * 0.35 * static_cast<double>(kBall)) * run.time();
    trial.expectNear("speed", v.x * c + v.z * s, exact, 0.005 * exact, "m/s");
    trial.expectAtMost("sideways", v.z * c - v.x * s, 0.001 * exact, "m/s");
}

/// The rolling test of SimBenchmark as published [Hwangbo et al., SimBenchmark, 2018]: 25 balls of 1 kg on a box of
/// 10 kg on the ground, pushed with 150 N. Friction between box and ground (0.4) takes 137.3 N of that, so that what
/// friction errs by shows tenfold, and a pyramid around the cone, 1.41 times as strong aslant, does not let go. The
/// balls roll (0.8) with 2/7 of the box's acceleration.
void pushedBox(Trial& trial, double heading) {
    constexpr double kPush = 150, kSeconds = 4, kBox = 10, kBall = 1, kFriction = 0.4;
    constexpr int kSide = 5;
    Scene scene;
    // Friction of a pair is the geometric mean: 0.8 above, √(0.8 · 0.2) = 0.4 below.
    const Material rough = surface(0.8f);
    addFloor(scene, surface(0.2f));
    const int box = add(scene, solidBody(Box{{10, 0.5f, 10}}, {0, 0.5, 0}, static_cast<float>(kBox), rough));
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j)
            add(scene, solidBody(Sphere{0.5f}, {2.0 * i - 4, 1.5, 2.0 * j - 4}, static_cast<float>(kBall), rough));
    Run run = trial.start(scene);
    const double c = std::cos(heading), s = std::sin(heading);
    const auto count = std::lround(kSeconds / trial.dt());
    for (long i = 0; i < count; ++i) {
        run.engine().push(box, toVec3(kPush * DVec3{c, 0, s}), run.position(box));
        run.step();
    }
    constexpr int kBalls = kSide * kSide;
    const double friction = kFriction * (kBox + kBalls * kBall) * kGravity;
    const double exact = (kPush - friction) / (kBox + kBalls * kBall * 2 / 7) * run.time();
    const DVec3 v{run.motion(box).v};
    double slowest = INFINITY, fastest = -INFINITY;
    for (int ball = box + 1; ball <= box + kBalls; ++ball) {
        const DVec3 u{run.motion(ball).v};
        slowest = smaller(slowest, u.x * c + u.z * s);
        fastest = larger(fastest, u.x * c + u.z * s);
    }
    trial.expectNear("speed of the box", v.x * c + v.z * s, exact, 0.005 * exact, "m/s");
    trial.expectAtMost("sideways", v.z * c - v.x * s, 0.001 * exact, "m/s");
    trial.expectNear("slowest ball", slowest, exact * 2 / 7, 0.005 * exact * 2 / 7, "m/s");
    trial.expectNear("fastest ball", fastest, exact * 2 / 7, 0.005 * exact * 2 / 7, "m/s");
}

}  // namespace isotropy_cases
}  // namespace

Family isotropy() {
    using namespace isotropy_cases;
    Family family{"isotropy", {{"5 m/s, 16 headings", headings}}};
    for (const double degrees : {0.0, 45.0})
        family.cases.push_back({fmt::format("board on balls, {} deg", degrees),
                                [=](Trial& trial) { board(trial, degrees * std::numbers::pi / 180); }});
    for (const double degrees : {0.0, 30.0, 45.0})
        family.cases.push_back({fmt::format("balls on a box, {} deg", degrees),
                                [=](Trial& trial) { pushedBox(trial, degrees * std::numbers::pi / 180); }});
    return family;
}

}  // namespace ragtop::stability
