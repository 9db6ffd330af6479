#include <cmath>
#include <numbers>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace drift_cases {

/// A rod on a hinge, let go at half a radian, for an hour: period by the complete elliptic integral, energy by its
/// drop.
void pendulum(Trial& trial) {
    constexpr double kAngle = 0.5, kLength = 1;
    Scene scene;
    const DVec3 along{std::sin(kAngle), -std::cos(kAngle), 0};
    BodyDef def = solidBody(Box{{0.02f, static_cast<float>(kLength / 2), 0.02f}}, 0.5 * kLength * along, 1, {});
    def.pose.rotation = rotationAbout({0, 0, 1}, static_cast<float>(kAngle));
    const int body = add(scene, def);
    addHinge(scene, kWorld, body, {}, {0, 0, 1});
    Run run = trial.start(scene);
    const double energy = run.energy(), drop = kGravity * kLength / 2 * (1 - std::cos(kAngle));
    double before = 1, first = 0, last = 0, gap = 0;
    int crossings = -1;
    run.advance(3600, [&] {
        const double now = run.position(body).x;
        if (now * before < 0) {
            last = run.time() - trial.dt() * now / (now - before);
            if (++crossings == 0) first = last;
        }
        before = now;
        gap = larger(gap, run.jointGap());
        return gap < 1;
    });
    const double inertia = (kLength * kLength + 0.04 * 0.04) / 12 + kLength * kLength / 4;
    const double exact = 4 * std::sqrt(inertia / (kGravity * kLength / 2)) * std::comp_ellint_1(std::sin(kAngle / 2));
    trial.expectNear("period", 2 * (last - first) / crossings, exact, 0.001 * exact, "s");
    trial.expectAtMost("energy over the drop", (run.energy() - energy) / drop, 0.01, "1");
    trial.expectAtMost("gap", gap, 1e-4, "m");
}

/// A weight on an undamped spring: amplitude after a million steps.
void spring(Trial& trial, long steps) {
    constexpr double kMass = 1, kStiffness = 100, kAmplitude = 0.5, kRest = 2;
    Scene scene;
    scene.settings.gravity = {};
    BodyDef def = solidBody(Sphere{0.1f}, {kRest + kAmplitude, 0, 0}, static_cast<float>(kMass), {});
    const int body = add(scene, def);
    DistanceDef& joint = addDistance(scene, kWorld, body, {}, def.pose.position);
    joint.spring = Spring{static_cast<float>(kStiffness), 0};
    joint.rest = static_cast<float>(kRest);
    Run run = trial.start(scene);
    for (long i = 0; i < steps; ++i) run.step();
    const BodyMotion m = run.motion(body);
    const double stretch = m.pose.position.x - kRest, v = static_cast<double>(m.v.x);
    const double energy = 0.5 * (kMass * v * v + kStiffness * stretch * stretch);
    trial.expectNear("energy left", energy / (0.5 * kStiffness * kAmplitude * kAmplitude), 1, 0.01, "1");
}

/// Chains that fly and collide without gravity: what they have of momentum and of angular momentum about the origin.
void momenta(Trial& trial) {
    Scene scene;
    scene.settings.gravity = {};
    Dice dice(24);
    for (int chain = 0; chain < 4; ++chain) {
        int last = kWorld;
        for (int i = 0; i < 5; ++i) {
            BodyDef def = solidBody(Capsule{0.1f, 0.3f}, {0.6 * chain, 0.8 * i, 0.1 * chain}, 1, surface(0.5f));
            def.linearVelocity = {dice.between(-2, 2), dice.between(-2, 2), dice.between(-2, 2)};
            def.angularVelocity = {dice.between(-4, 4), dice.between(-4, 4), dice.between(-4, 4)};
            const int link = add(scene, def);
            if (last != kWorld) addBall(scene, last, link, {0.6 * chain, 0.8 * i - 0.4, 0.1 * chain});
            last = link;
        }
    }
    Run run = trial.start(scene);
    struct Sum {
        DVec3 p, l;
        double speeds = 0, arms = 0;
    };
    const auto sum = [&] {
        Sum s;
        for (int i = 0; i < 20; ++i) {
            const DVec3 x = run.centerOfMass(i), v{run.motion(i).v};
            const DVec3 moment{x.y * v.z - x.z * v.y, x.z * v.x - x.x * v.z, x.x * v.y - x.y * v.x};
            s.p = s.p + v;
            s.l = s.l + moment + run.angularMomentum(i);
            s.speeds += std::hypot(v.x, v.y, v.z);
            s.arms += std::hypot(moment.x, moment.y, moment.z);
        }
        return s;
    };
    const Sum before = sum();
    run.advance(10);
    const Sum after = sum();
    const DVec3 dp = after.p - before.p, dl = after.l - before.l;
    trial.expectAtMost("momentum", std::hypot(dp.x, dp.y, dp.z) / before.speeds, 1e-5, "1");
    trial.expectAtMost("angular momentum", std::hypot(dl.x, dl.y, dl.z) / before.arms, 1e-4, "1");
}

}  // namespace drift_cases
}  // namespace

Family drift() {
    using namespace drift_cases;
    return {"drift",
            {
                {"pendulum, one hour", pendulum, Kind::oneStep, false},
                {"spring, 10,000 steps", [](Trial& trial) { spring(trial, 10000); }},
                {"spring, 1,000,000 steps", [](Trial& trial) { spring(trial, 1000000); }, Kind::longer},
                {"momenta without gravity", momenta},
            }};
}

}  // namespace ragtop::stability
