#include <fmt/format.h>

#include <cmath>

#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace stopping_cases {

constexpr float kSpeed = 5;  ///< m/s

/// A unit cube thrown along a rough floor: it stops after v²/(2 μ g), at the time v/(μ g).
void stops(Trial& trial, float friction) {
    Scene scene;
    const Material material = surface(friction);
    addFloor(scene, material);
    BodyDef cube = solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, material);
    cube.linearVelocity = {kSpeed, 0, 0};
    const int box = add(scene, cube);
    Run run = trial.start(scene);

    const double v = static_cast<double>(kSpeed), mu = static_cast<double>(friction);
    const double time = v / (mu * kGravity), distance = v * v / (2 * mu * kGravity);
    // The speed falls linearly: the last two steps that end well above rest tell when it reaches zero.
    double before = v, last = v, lastTime = 0, stopped = NAN;
    run.advance(1.5 * time, [&] {
        const double now = static_cast<double>(run.motion(box).v.x);
        if (now > 0.02 * v) {
            before = last;
            last = now;
            lastTime = run.time();
        }
        return true;
    });
    if (before > last) stopped = lastTime + last * trial.dt() / (before - last);
    trial.expectNear("distance", run.position(box).x, distance, 0.002 * distance, "m");
    trial.expectNear("time", stopped, time, 0.005 * time, "s");
}

}  // namespace stopping_cases
}  // namespace

Family stopping() {
    using namespace stopping_cases;
    Family family{"stopping", {}};
    for (const float friction : {0.2f, 0.5f, 0.8f})
        family.cases.push_back(
            {fmt::format("5 m/s, mu={}", friction), [friction](Trial& trial) { stops(trial, friction); }});
    return family;
}

}  // namespace ragtop::stability
