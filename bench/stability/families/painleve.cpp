#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace painleve_cases {

constexpr double kHalf = 0.5;      ///< m, half the rod's length
constexpr double kRadius = 0.002;  ///< m, of its round end
constexpr double kSpeed = 5;       ///< m/s

/// A thin rod of 1 kg leans with tan θ = 2 and slides with its foot ahead: friction presses the foot into the floor.
/// For 1 + 3 cos²θ − 3 μ sin θ cos θ < 0, here μ > 4/3, no finite force keeps it out [Painlevé 1895].
Scene rod(double friction) {
    Scene scene;
    const Material material = surface(static_cast<float>(friction));
    addFloor(scene, material);
    const double theta = std::atan(2.0);
    const float inertia = static_cast<float>(kHalf * kHalf / 3);
    const DVec3 at{kHalf * std::cos(theta), kHalf * std::sin(theta) + kRadius, 0};
    BodyDef def = bodyWithMass(Capsule{static_cast<float>(kRadius), static_cast<float>(kHalf)}, at, 1,
                               {inertia, 1e-4f, inertia}, material);
    def.pose.rotation = rotationAbout({0, 0, 1}, static_cast<float>(theta - std::numbers::pi / 2));
    def.linearVelocity = {static_cast<float>(-kSpeed), 0, 0};
    add(scene, def);
    return scene;
}

/// The rod's spin at a time while its foot is on the floor, by Newton's law in small steps. The foot slides while it
/// can; where no force would do, a jam: an impulse stops the foot at once, and the rod turns on about it.
double spinAfter(double friction, double seconds) {
    constexpr double kStep = 1e-6, kInertia = kHalf * kHalf / 3;
    double theta = std::atan(2.0), spin = 0, speed = -kSpeed;
    const auto jam = [&] {
        // Angular momentum about the foot is kept.
        spin = (kInertia * spin - kHalf * std::sin(theta) * speed) / (kInertia + kHalf * kHalf);
    };
    for (double t = 0; t < seconds; t += kStep) {
        const double c = std::cos(theta), s = std::sin(theta);
        const double foot = speed + kHalf * s * spin, mass = 1 + 3 * c * c - 3 * friction * s * c;
        if (foot < 0 && mass > 0) {
            const double load = larger(0.0, kGravity - kHalf * spin * spin * s) / mass;
            speed += kStep * friction * load;
            spin += kStep * load * kHalf * (friction * s - c) / kInertia;
        } else {
            if (foot < 0) jam();
            if (kHalf * spin * spin * s < kGravity) spin -= kStep * kGravity * kHalf * c / (kInertia + kHalf * kHalf);
            speed = -kHalf * s * spin;
        }
        theta += kStep * spin;
    }
    return spin;
}

void slides(Trial& trial, double friction) {
    Run run = trial.start(rod(friction));
    const double energy = run.energy();
    double gained = 0, fastest = 0;
    const auto count = std::max(1L, std::lround(1.0 / 30 / trial.dt()));
    double spin = 0, spinTime = 0;
    long step = 0;
    run.advance(2, [&] {
        const BodyMotion m = run.motion(1);
        gained = larger(gained, run.energy() / energy - 1);
        fastest = larger(fastest, static_cast<double>(length(m.v)));
        if (++step == count) {
            spin = static_cast<double>(m.w.z);
            spinTime = run.time();
        }
        return std::isfinite(fastest);
    });
    trial.expectAtMost("energy gained", gained, 0.001, "1");
    trial.expectAtMost("fastest", fastest, 2 * kSpeed, "m/s");
    // Just below 4/3 the load is 25 weights and stops the foot within a third of a step: jammed or not is the same
    // then.
    if (friction > 1.2 && friction < 4.0 / 3) return;
    const double exact = spinAfter(friction, spinTime);
    trial.expectNear("spin after 1/30 s", spin, exact, 0.1 * std::abs(exact), "rad/s");
}

}  // namespace painleve_cases
}  // namespace

Family painleve() {
    using namespace painleve_cases;
    Family family{"painleve", {}};
    for (const double friction : {1.0, 1.3, 1.4, 2.0})
        family.cases.push_back({fmt::format("mu={}", friction), [friction](Trial& trial) { slides(trial, friction); }});
    return family;
}

}  // namespace ragtop::stability
