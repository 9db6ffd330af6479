#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace inclines_cases {

const double kTheta = std::atan(0.5);

/// A unit cube of 1 kg on an inclined slab, its edges at an angle to the fall line, which has that heading too;
/// somewhere in the world.
struct Ramp {
    double share = 1;    ///< friction over the tangent of the slope
    double heading = 0;  ///< degrees
    DVec3 at{};

    Slope slope() const { return {kTheta, heading * std::numbers::pi / 180, at}; }
    std::string name() const {
        return fmt::format("mu={} tan, {} deg{}", share, heading, at == DVec3{} ? "" : ", 1 km away");
    }
};

Run start(Trial& trial, const Ramp& ramp) {
    Scene scene;
    const Material material = surface(static_cast<float>(ramp.share * std::tan(kTheta)));
    addSlope(scene, ramp.slope(), material);
    add(scene, onSlope(ramp.slope(), solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, material)));
    return trial.start(scene);
}

/// Distance down the fall line from where the cube began.
double descent(const Run& run, const Ramp& ramp) {
    const DVec3 d = run.position(1) - ramp.at, down = ramp.slope().down();
    return d.x * down.x + d.y * down.y + d.z * down.z;
}

/// Speed of a cube that must stay, after it has had two seconds to come to rest.
void holds(Trial& trial, const Ramp& ramp) {
    constexpr double kSeconds = 10;
    Run run = start(trial, ramp);
    run.advance(2);
    const DVec3 from = run.position(1);
    run.advance(kSeconds);
    const DVec3 d = run.position(1) - from;
    trial.expectAtMost("creep", std::hypot(d.x, d.y, d.z) / kSeconds, 1e-6, "m/s");
}

/// Acceleration by Coulomb's law, g (sin θ − μ cos θ), from three places four seconds apart.
void slides(Trial& trial, const Ramp& ramp) {
    Run run = start(trial, ramp);
    const auto placeAfter = [&](double seconds) {
        run.advance(seconds);
        return descent(run, ramp);
    };
    const double x0 = placeAfter(2), x1 = placeAfter(4), x2 = placeAfter(4);
    const double a = (x2 - 2 * x1 + x0) / 16;
    const double exact = kGravity * (1 - ramp.share) * std::sin(kTheta);
    trial.expectNear("acceleration", a, exact, 0.01 * exact, "m/s2");
}

}  // namespace inclines_cases
}  // namespace

Family inclines() {
    using namespace inclines_cases;
    Family family{"incline", {}};
    const DVec3 away{1000, 0, 1000};
    for (const double heading : {0.0, 22.5, 45.0}) {
        for (const double share : {1.01, 1.05}) {
            const Ramp ramp{share, heading};
            family.cases.push_back({ramp.name(), [ramp](Trial& trial) { holds(trial, ramp); }});
        }
        for (const double share : {0.99, 0.95}) {
            const Ramp ramp{share, heading};
            family.cases.push_back({ramp.name(), [ramp](Trial& trial) { slides(trial, ramp); }});
        }
    }
    const Ramp far{1.01, 22.5, away}, farSliding{0.99, 22.5, away};
    family.cases.push_back({far.name(), [far](Trial& trial) { holds(trial, far); }});
    family.cases.push_back({farSliding.name(), [farSliding](Trial& trial) { slides(trial, farSliding); }});
    return family;
}

}  // namespace ragtop::stability
