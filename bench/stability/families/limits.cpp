#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace limits_cases {

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
        beyond = larger(beyond, std::abs(angle) - static_cast<double>(kStop));
        gained = larger(gained, run.energy() / energy - 1);
        return true;
    });
    trial.expectAtMost("overshoot", beyond, 0.01, "rad");
    trial.expectAtMost("energy gained", larger(gained, 0.0), 0.001, "1");
}

constexpr float kFallStop = -1;  ///< rad
constexpr double kPerDegree = std::numbers::pi / 180;

/// A rod of 1 m and 1 kg falls from level on a stop at −1 rad. (A test of the core looks at each substep.)
void fall(Trial& trial, int rate) {
    trial.setStep(1.0 / rate);
    Scene scene;
    const int body = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {}));
    addHinge(scene, kWorld, body, {}, {0, 0, 1}).limit = Range{kFallStop, 1};
    Run run = trial.start(scene);
    double lowest = 9, highest = 0;
    run.advance(2, [&] {
        const DVec3 at = run.position(body);
        const double angle = std::atan2(at.y, at.x), stop = static_cast<double>(kFallStop);
        lowest = smaller(lowest, angle - stop);
        if (lowest < 1e-3) highest = larger(highest, angle - stop);
        return true;
    });
    trial.expectAtMost("overshoot", -lowest, 0.1 * kPerDegree, "rad");
    trial.expectAtMost("rebound", highest, 0.05 * kPerDegree, "rad");
}

/// The same with a stop that gives back half of the speed: the next apex is a quarter as high above the stop.
void rebound(Trial& trial, int rate) {
    trial.setStep(1.0 / rate);
    Scene scene;
    const int body = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {}));
    HingeDef& hinge = addHinge(scene, kWorld, body, {}, {0, 0, 1});
    hinge.limit = Range{kFallStop, 1};
    hinge.stop.restitution = 0.5f;
    Run run = trial.start(scene);
    const double bottom = 0.5 * std::sin(static_cast<double>(kFallStop));
    double before = 0, apex = bottom;
    int strikes = 0;
    run.advance(2, [&] {
        const double speed = static_cast<double>(run.motion(body).w.z);
        if (before < 0 && speed > 0) ++strikes;
        before = speed;
        if (strikes == 1) apex = larger(apex, run.height(body));
        return strikes < 2;
    });
    trial.expectNear("rebound speed over impact speed", std::sqrt((apex - bottom) / -bottom), 0.5, 0.025, "1");
}

/// A wheel of 0.1 kg m² at 4 rad/s runs into a soft stop of 3 Hz and leaves it as half a damped swing ends.
void soft(Trial& trial, int rate, double zeta) {
    trial.setStep(1.0 / rate);
    constexpr double kInertia = 0.1, kSpin = 4;
    const double omega = 2 * std::numbers::pi * 3, damped = omega * std::sqrt(1 - zeta * zeta);
    Scene scene;
    scene.settings.gravity = {};
    const float i = static_cast<float>(kInertia);
    BodyDef def = bodyWithMass(Sphere{0.2f}, {}, 2, {i, i, i}, {});
    def.angularVelocity = {0, 0, static_cast<float>(kSpin)};
    const int body = add(scene, def);
    HingeDef& hinge = addHinge(scene, kWorld, body, {}, {0, 0, 1});
    hinge.limit = Range{-10, 0.2f};
    hinge.stop.stiffness = static_cast<float>(kInertia * omega * omega);
    hinge.stop.damping = static_cast<float>(2 * zeta * kInertia * omega);
    Run run = trial.start(scene);
    run.advance(0.4);
    // A stop only pushes: it lets go where k x + c v is zero.
    const double lean = std::sqrt(1 - zeta * zeta);
    const double turn = zeta > 0 ? std::atan2(2 * zeta * lean, 2 * zeta * zeta - 1) : std::numbers::pi;
    const double exact =
        kSpin * std::exp(-zeta * omega * turn / damped) * (std::cos(turn) - zeta / lean * std::sin(turn));
    trial.expectNear("speed after", static_cast<double>(run.motion(body).w.z), exact, 0.02 * std::abs(exact), "rad/s");
}

}  // namespace limits_cases
}  // namespace

Family limits() {
    using namespace limits_cases;
    Family family{"limits", {}};
    for (const int speed : {20, 200})
        family.cases.push_back(
            {fmt::format("rod at {} rad/s", speed), [speed](Trial& trial) { stop(trial, static_cast<float>(speed)); }});
    for (const int rate : {30, 60, 120, 240}) {
        family.cases.push_back(
            {fmt::format("rod falls on its stop, {} Hz", rate), [rate](Trial& t) { fall(t, rate); }});
        family.cases.push_back(
            {fmt::format("stop with restitution, {} Hz", rate), [rate](Trial& t) { rebound(t, rate); }});
    }
    for (const double zeta : {0.0, 0.1, 0.3, 0.6})
        family.cases.push_back(
            {fmt::format("soft stop, damping ratio {}", zeta), [zeta](Trial& t) { soft(t, 60, zeta); }});
    return family;
}

}  // namespace ragtop::stability
