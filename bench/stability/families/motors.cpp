#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace motors_cases {

constexpr int kLinks = 30;
constexpr double kLength = 0.1;                     ///< m; with 1 kg about 1e-3 kg m²
constexpr double kStiffness = 1e4, kDamping = 500;  ///< N m/rad, N m s/rad

/// A level arm of links that springs hold straight against gravity.
Scene arm() {
    Scene scene;
    int last = kWorld;
    for (int i = 0; i < kLinks; ++i) {
        BodyDef def =
            solidBody(Box{{static_cast<float>(kLength / 2), 0.02f, 0.02f}}, {kLength * (i + 0.5), 0, 0}, 1, {});
        def.shapes[0].filter.mask = 0;
        const int link = add(scene, def);
        addHinge(scene, last, link, {kLength * i, 0, 0}, {0, 0, 1}).spring =
            Spring{static_cast<float>(kStiffness), static_cast<float>(kDamping)};
        last = link;
    }
    return scene;
}

/// Where the tip is at rest: each hinge bends by the moment of all that is beyond it, over the stiffness.
double tipAtRest() {
    std::vector<double> bend(kLinks, 0.0), x(kLinks + 1), y(kLinks + 1);
    for (int iteration = 0; iteration < 200; ++iteration) {
        double heading = 0;
        for (std::size_t i = 0; i < kLinks; ++i) {
            heading += bend[i];
            x[i + 1] = x[i] + kLength * std::cos(heading);
            y[i + 1] = y[i] + kLength * std::sin(heading);
        }
        for (std::size_t i = 0; i < kLinks; ++i) {
            double moment = 0;
            for (std::size_t j = i; j < kLinks; ++j) moment += kGravity * ((x[j] + x[j + 1]) / 2 - x[i]);
            bend[i] = -moment / kStiffness;
        }
    }
    return y[kLinks];
}

/// Its slowest swing, ω² = 12.4 k/(m n⁴ l²) of a beam, dies as e^(−γ t) with γ = ½ ω² c/k = 0.38/s: from 4 m/s to 1
/// mm/s in 22 s.
void holds(Trial& trial) {
    Run run = trial.start(arm());
    run.advance(30);
    const Pose pose = run.motion(kLinks - 1).pose;
    const double tip = transformPoint(pose, {static_cast<float>(kLength / 2), 0, 0}).y;
    trial.expectNear("height of the tip", tip, tipAtRest(), 0.01 * std::abs(tipAtRest()), "m");
    trial.expectAtMost("gap", run.jointGap(), 0.001, "m");
    trial.expectAtMost("speed", static_cast<double>(length(run.motion(kLinks - 1).v)), 0.001, "m/s");
}

constexpr float kInertia = 0.1f;

/// A wheel of 0.1 kg m² on a hinge along z, without gravity.
int addWheel(Scene& scene, float speed) {
    BodyDef def = bodyWithMass(Sphere{0.2f}, {}, 2, {kInertia, kInertia, kInertia}, {});
    def.angularVelocity = {0, 0, speed};
    scene.settings.gravity = {};
    return add(scene, def);
}

/// About z, in (−2π, 2π].
double angleOf(Run& run, int body) {
    const Quat q = run.motion(body).pose.rotation;
    return 2 * std::atan2(static_cast<double>(q.z), static_cast<double>(q.w));
}

double turnedBy(Run& run, int body, double seconds) {
    double angle = 0, before = 0;
    run.advance(seconds, [&] {
        const double now = angleOf(run, body);
        angle += std::remainder(now - before, 2 * std::numbers::pi);
        before = now;
        return true;
    });
    return angle;
}

/// 0.5 N m stop 10 rad/s within 10 rad.
void friction(Trial& trial, int rate) {
    trial.setStep(1.0 / rate);
    Scene scene;
    const int wheel = addWheel(scene, 10);
    addHinge(scene, kWorld, wheel, {}, {0, 0, 1}).friction = 0.5f;
    Run run = trial.start(scene);
    const double angle = turnedBy(run, wheel, 2.5);
    trial.expectNear("angle", angle, 10, 0.01, "rad");
    trial.expectAtMost("speed", static_cast<double>(run.motion(wheel).w.z), 1e-4, "rad/s");
}

/// A pendulum on a thick pin: friction μ r R with R about its weight takes 4 μ r/l off each half swing.
void pin(Trial& trial, int rate) {
    trial.setStep(1.0 / rate);
    constexpr double kMu = 0.1, kRadius = 0.01, kStart = 0.1;
    Scene scene;
    BodyDef def = solidBody(Box{{0.02f, 0.5f, 0.02f}}, {0.5 * std::sin(kStart), -0.5 * std::cos(kStart), 0}, 1, {});
    def.pose.rotation = rotationAbout({0, 0, 1}, static_cast<float>(kStart));
    const int rod = add(scene, def);
    addHinge(scene, kWorld, rod, {}, {0, 0, 1}).bearing =
        Bearing{0, 0, static_cast<float>(kMu), static_cast<float>(kRadius)};
    Run run = trial.start(scene);
    double a = kStart, b = kStart, last = kStart;
    int peaks = 0;
    run.advance(20, [&] {
        const DVec3 at = run.position(rod);
        const double c = std::atan2(at.x, -at.y);
        if ((b - a) * (c - b) < 0) {
            last = std::abs(b - (c - a) * (c - a) / (8 * (a - 2 * b + c)));
            ++peaks;
        }
        a = b, b = c;
        return peaks < 8;
    });
    const double exact = 8 * 2 * kMu * kRadius / 0.5;
    trial.expectNear("loss in 8 half swings", kStart - last, exact, 0.01 * exact, "rad");
}

/// A level rod sags from a spring until k θ = m g l/2 cos θ, at any step.
void sag(Trial& trial, int rate, double stiffness) {
    trial.setStep(1.0 / rate);
    Scene scene;
    const int rod = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {}));
    addHinge(scene, kWorld, rod, {}, {0, 0, 1}).spring =
        Spring{static_cast<float>(stiffness), static_cast<float>(0.2 * stiffness)};
    Run run = trial.start(scene);
    run.advance(10);
    double exact = 0;
    for (int i = 0; i < 100; ++i) exact = 0.5 * (exact + 0.5 * kGravity * std::cos(exact) / stiffness);
    trial.expectNear("sag", -angleOf(run, rod), exact, 0.01 * exact, "rad");
}

/// A wheel on a spring against x'' + 2 ζ ω x' + ω² x = 0, at the time of each step. A course that lags by δ is
/// x(t − δ) ≈ x − δ x', which has the least squares δ = Σ (x − x_lagging) x' / Σ x'².
void response(Trial& trial, int rate, double zeta) {
    trial.setStep(1.0 / rate);
    const double omega = 2 * std::numbers::pi * 2, w = omega * std::sqrt(1 - zeta * zeta), decay = zeta * omega;
    constexpr double kTarget = 0.4;
    Scene scene;
    const int wheel = addWheel(scene, 0);
    HingeDef& hinge = addHinge(scene, kWorld, wheel, {}, {0, 0, 1});
    const double inertia = static_cast<double>(kInertia);
    hinge.spring = Spring{static_cast<float>(inertia * omega * omega), static_cast<float>(2 * inertia * decay)};
    hinge.target = static_cast<float>(kTarget);
    Run run = trial.start(scene);
    double place = 0, speed = 0, late = 0, squares = 0;
    run.advance(2, [&] {
        const double t = run.time(), left = kTarget * std::exp(-decay * t);
        const double angle = kTarget - left * (std::cos(w * t) + decay / w * std::sin(w * t));
        const double turning = left * omega * omega / w * std::sin(w * t);
        place = larger(place, std::abs(angleOf(run, wheel) - angle) / kTarget);
        late += (angle - angleOf(run, wheel)) * turning;
        squares += turning * turning;
        speed = larger(speed, std::abs(static_cast<double>(run.motion(wheel).w.z) - turning) / (kTarget * omega));
        return true;
    });
    trial.expectAtMost("off its closed form", place, 0.01, "1");
    trial.expectAtMost("speed off its closed form", speed, 0.01, "1");
    const double substep = 1.0 / (rate * WorldSettings{}.substeps);
    trial.expectNear("lag", late / squares / substep, 0, 0.01, "substeps");
}

/// An undamped spring lets a wheel of 0.1 kg m² swing to twice its target at most; where the speed stands half a
/// substep beside the angle, the amplitude is 1/cos(ωh/2) larger, and beyond one substep per radian it is damped.
void stiff(Trial& trial, double stiffness) {
    Scene scene;
    const int wheel = addWheel(scene, 0);
    HingeDef& hinge = addHinge(scene, kWorld, wheel, {}, {0, 0, 1});
    hinge.spring = Spring{static_cast<float>(stiffness), 0};
    hinge.target = 0.4f;
    Run run = trial.start(scene);
    double most = 0;
    run.advance(5, [&] {
        most = larger(most, angleOf(run, wheel));
        return true;
    });
    trial.expectAtMost("farthest", most, 0.4 * (1 + 1 / std::cos(0.5)), "rad");
}

/// A motor of 3 N m against a load of a little less and a little more.
void stall(Trial& trial, double load) {
    Scene scene;
    scene.settings.gravity = {};
    const float arm = 1;
    BodyDef def = solidBody(Box{{0.1f, 0.1f, 0.1f}}, {static_cast<double>(arm), 0, 0}, 1, {});
    scene.settings.gravity = {0, static_cast<float>(-3 * load), 0};
    const int body = add(scene, def);
    addHinge(scene, kWorld, body, {}, {0, 0, 1}).motor = Motor{0, 3};
    Run run = trial.start(scene);
    run.advance(2);
    const double speed = -static_cast<double>(run.motion(body).w.z);
    if (load < 1)
        trial.expectAtMost("speed", speed, 1e-4, "rad/s");
    else
        trial.expectAtLeast("speed", speed, 1e-3, "rad/s");
}

}  // namespace motors_cases
}  // namespace

Family motors() {
    using namespace motors_cases;
    Family family{"motors", {{"30 links on springs", holds}}};
    for (const int rate : {30, 60, 120, 240}) {
        const auto name = [rate](const char* what) { return fmt::format("{}, {} Hz", what, rate); };
        family.cases.push_back({name("friction"), [rate](Trial& t) { friction(t, rate); }});
        family.cases.push_back({name("friction of a loaded pin"), [rate](Trial& t) { pin(t, rate); }});
        family.cases.push_back({name("sag of a spring"), [rate](Trial& t) { sag(t, rate, 50); }});
        for (const double zeta : {0.0, 0.3})
            family.cases.push_back({name(zeta > 0 ? "damped response" : "undamped response"),
                                    [rate, zeta](Trial& t) { response(t, rate, zeta); }});
    }
    for (const double stiffness : {1e3, 1e4, 1e5, 1e6})
        family.cases.push_back(
            {fmt::format("spring of {:.0e} N m/rad", stiffness), [stiffness](Trial& t) { stiff(t, stiffness); }});
    for (const double load : {0.999, 1.001})
        family.cases.push_back(
            {fmt::format("motor under {} of its torque", load), [load](Trial& t) { stall(t, load); }});
    return family;
}

}  // namespace ragtop::stability
