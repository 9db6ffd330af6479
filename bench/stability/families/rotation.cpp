#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../extremes.h"
#include "../families.h"
#include "../free_rotation.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace rotation_cases {

constexpr double kSeconds = 60;

double lengthOf(const DVec3& a) { return std::hypot(a.x, a.y, a.z); }

/// A slab of 1 × 0.6 × 0.2 m without gravity, spinning about one of its axes (x least, y middle, z greatest moment)
/// with a hundredth of that about the others.
void freeSpin(Trial& trial, int axis, float speed) {
    Scene scene;
    scene.settings.gravity = {};
    BodyDef slab = solidBody(Box{{0.5f, 0.3f, 0.1f}}, {}, 1, {});
    slab.angularVelocity = 0.01f * speed * Vec3{1, 1, 1};
    slab.angularVelocity[axis] = speed;
    const int body = add(scene, slab);
    Run run = trial.start(scene);
    const double energy = run.energy();
    const DVec3 momentum = run.angularMomentum(body);
    double energyError = 0, momentumError = 0;
    run.advance(kSeconds, [&] {
        energyError = larger(energyError, std::abs(run.energy() / energy - 1));
        momentumError = larger(momentumError, lengthOf(run.angularMomentum(body) - momentum) / lengthOf(momentum));
        return std::isfinite(energyError);
    });
    trial.expectAtMost("energy", energyError, 0.001, "1");
    trial.expectAtMost("angular momentum", momentumError, 1e-5, "1");
}

/// A T of two bars spun about its middle axis flips over and over.
void handle(Trial& trial, float speed) {
    Scene scene;
    scene.settings.gravity = {};
    BodyDef def;
    def.shapes.push_back({.geometry = Box{{0.1f, 0.02f, 0.02f}}, .density = 8000});
    def.shapes.push_back({.geometry = Box{{0.02f, 0.06f, 0.02f}}, .frame = {{0.12f, 0, 0}, {}}, .density = 8000});
    const Mat3 inertia = massOf(def).inertia;
    // The stem has the least, the cross bar the middle, the normal of their plane the greatest moment.
    const Principal moments{static_cast<double>(inertia.cx.x), static_cast<double>(inertia.cy.y),
                            static_cast<double>(inertia.cz.z)};
    def.angularVelocity = {0.01f * speed, speed, 0};
    const int body = add(scene, def);
    Run run = trial.start(scene);
    const auto middleSpin = [&] {
        const BodyMotion m = run.motion(body);
        return static_cast<double>(inverseRotate(m.pose.rotation, m.w).y);
    };
    double before = middleSpin(), first = 0, last = 0;
    int flips = -1;
    run.advance(kSeconds, [&] {
        const double now = middleSpin();
        if (now * before < 0) {
            last = run.time() - trial.dt() * now / (now - before);
            if (++flips == 0) first = last;
        }
        before = now;
        return true;
    });
    const double exact = flipTime(moments, {0.01 * static_cast<double>(speed), static_cast<double>(speed), 0});
    trial.expectNear("time between flips", (last - first) / flips, exact, 0.005 * exact, "s");
}

/// A disc of 1 kg on a weightless stem, its tip held at the origin, in steady precession.
struct Top {
    double tilt = 0;  ///< rad, of the stem from the vertical
    double spin = 0;  ///< rad/s, component of the angular velocity along the stem

    static constexpr double kStem = 0.5, kRadius = 0.25;
    static constexpr double kAxial = kRadius * kRadius / 2, kCross = kRadius * kRadius / 4;

    /// The slow root of I₁ cosθ Ω² − I₃ ω₃ Ω + m g r = 0, I₁ about the tip.
    double precession() const {
        const double a = (kCross + kStem * kStem) * std::cos(tilt), b = kAxial * spin, c = kGravity * kStem;
        return 2 * c / (b + std::sqrt(b * b - 4 * a * c));
    }
};

void steadyTop(Trial& trial, const Top& top) {
    Scene scene;
    const Vec3 moments = toVec3(DVec3{Top::kCross, Top::kAxial, Top::kCross});
    const DVec3 stem{std::sin(top.tilt), std::cos(top.tilt), 0};
    BodyDef disc = bodyWithMass(Box{{0.2f, 0.02f, 0.2f}}, Top::kStem * stem, 1, moments, {});
    disc.pose.rotation = rotationBetween({0, 1, 0}, toVec3(stem));
    const double rate = top.precession();
    const DVec3 spin = (top.spin - rate * std::cos(top.tilt)) * stem + DVec3{0, rate, 0};
    disc.angularVelocity = toVec3(spin);
    disc.linearVelocity = cross(toVec3(spin), toVec3(Top::kStem * stem));
    const int body = add(scene, disc);
    addBall(scene, kWorld, body, {});
    Run run = trial.start(scene);

    double turned = 0, heading = 0, nutation = 0;
    run.advance(10, [&] {
        const Vec3 now = rotate(run.motion(body).pose.rotation, {0, 1, 0});
        // y axis up: a positive turn takes x towards −z.
        const double next = std::atan2(-static_cast<double>(now.z), static_cast<double>(now.x));
        turned += std::remainder(next - heading, 2 * std::numbers::pi);
        heading = next;
        const double tilt = std::acos(std::clamp(static_cast<double>(now.y), -1.0, 1.0));
        nutation = larger(nutation, std::abs(tilt - top.tilt));
        return true;
    });
    const double exact = rate * run.time();
    trial.expectNear("precession in 10 s", turned, exact, 0.005 * exact, "rad");
    trial.expectAtMost("nutation", nutation, 0.01, "rad");
    trial.expectAtMost("gap", run.jointGap(), 0.001, "m");
}

/// A ball whose centre of mass is off its middle, spun: it turns itself upside down. Friction at the one contact point
/// leaves the Jellett constant, L · (from the centre of mass to the contact), as it was.
void tippeTop(Trial& trial) {
    constexpr float kRadius = 0.1f, kOffset = 0.03f, kMass = 1;
    Scene scene;
    addFloor(scene, surface(0.3f));
    const float moment = 0.4f * kMass * kRadius * kRadius;
    BodyDef def = bodyWithMass(Sphere{kRadius}, {0, 0.1, 0}, kMass, {moment, moment, moment}, surface(0.3f));
    def.mass->center = {0, -kOffset, 0};
    def.pose.rotation = rotationAbout({0, 0, 1}, 0.1f);
    def.angularVelocity = {0, 60, 0};
    const int body = add(scene, def);
    Run run = trial.start(scene);
    const auto jellett = [&] {
        const Vec3 stem = rotate(run.motion(body).pose.rotation, {0, 1, 0});
        const DVec3 arm = DVec3{kOffset * stem - Vec3{0, kRadius, 0}}, momentum = run.angularMomentum(body);
        return arm.x * momentum.x + arm.y * momentum.y + arm.z * momentum.z;
    };
    const double start = jellett();
    double worst = 0;
    run.advance(10, [&] {
        worst = larger(worst, std::abs(jellett() / start - 1));
        return true;
    });
    trial.expectAtMost("Jellett constant", worst, 0.01, "1");
    const double up = static_cast<double>(rotate(run.motion(body).pose.rotation, {0, 1, 0}).y);
    trial.expectNear("cosine of the tilt, turned over", up, -1, 0.1, "1");
}

}  // namespace rotation_cases
}  // namespace

Family rotation() {
    using namespace rotation_cases;
    Family family{"rotation", {}};
    const char* axes[] = {"least", "middle", "greatest"};
    for (int axis = 0; axis < 3; ++axis)
        for (const int speed : {10, 30, 100})
            family.cases.push_back({fmt::format("{} axis, {} rad/s", axes[axis], speed),
                                    [axis, speed](Trial& trial) { freeSpin(trial, axis, static_cast<float>(speed)); }});
    for (const int speed : {10, 30, 100})
        family.cases.push_back({fmt::format("T-handle, {} rad/s", speed),
                                [speed](Trial& trial) { handle(trial, static_cast<float>(speed)); }});
    const Top heavy{0.5, 100}, gyroscope{std::numbers::pi / 2, 200};
    family.cases.push_back({"heavy top", [heavy](Trial& trial) { steadyTop(trial, heavy); }});
    family.cases.push_back({"gyroscope", [gyroscope](Trial& trial) { steadyTop(trial, gyroscope); }});
    family.cases.push_back({"tippe top", tippeTop});
    return family;
}

}  // namespace ragtop::stability
