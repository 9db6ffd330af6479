#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

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
/// they need 89 % of their share of the load. [Hwangbo et al., SimBenchmark, 2018: the scene]
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

}  // namespace

Family isotropy() {
    return {"isotropy",
            {
                {"5 m/s, 16 headings", headings},
                {"board on balls, 0 deg", [](Trial& trial) { board(trial, 0); }},
                {"board on balls, 45 deg", [](Trial& trial) { board(trial, std::numbers::pi / 4); }},
            }};
}

}  // namespace ragtop::stability
