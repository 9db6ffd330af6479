#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

/// A rod of 1 m on a hinge runs into its stop at 1 rad: it may neither pass it nor come back faster.
void stop(Trial& trial, float speed) {
    constexpr float kStop = 1;
    Scene scene;
    scene.settings.gravity = {};
    BodyDef def = solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {});
    def.angularVelocity = {0, 0, speed};
    def.linearVelocity = {0, 0.5f * speed, 0};
    const int body = add(scene, def);
    addHinge(scene, kWorld, body, {}, {0, 0, 1}).limit = Range{-kStop, kStop};
    Run run = trial.start(scene);
    const double energy = run.energy();
    double angle = 0, beyond = 0, gained = -1, before = 0;
    run.advance(1, [&] {
        const DVec3 at = run.position(body);
        const double next = std::atan2(at.y, at.x);
        angle += std::remainder(next - before, 2 * std::numbers::pi);
        before = next;
        beyond = std::max(beyond, std::abs(angle) - static_cast<double>(kStop));
        gained = std::max(gained, run.energy() / energy - 1);
        return true;
    });
    trial.expectAtMost("overshoot", beyond, 0.01, "rad");
    trial.expectAtMost("energy gained", std::max(gained, 0.0), 0.001, "1");
}

}  // namespace

Family limits() {
    Family family{"limits", {}};
    for (const int speed : {20, 200})
        family.cases.push_back(
            {fmt::format("rod at {} rad/s", speed), [speed](Trial& trial) { stop(trial, static_cast<float>(speed)); }});
    return family;
}

}  // namespace ragtop::stability
