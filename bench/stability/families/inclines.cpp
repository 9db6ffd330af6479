#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

const double kTheta = std::atan(0.5);

/// A unit cube of 1 kg on a slope whose fall line has a heading (degrees) in the plane, somewhere in the world.
struct Slope {
    double share = 1;  ///< friction over the tangent of the slope
    double heading = 0;
    DVec3 at{};

    double radians() const { return heading * std::numbers::pi / 180; }
    std::string name() const {
        return fmt::format("mu={} tan, {} deg{}", share, heading, at == DVec3{} ? "" : ", 1 km away");
    }
};

Run start(Trial& trial, const Slope& slope) {
    Scene scene;
    scene.settings.gravity = slopeGravity(kTheta, slope.radians());
    const Material material = surface(static_cast<float>(slope.share * std::tan(kTheta)));
    addFloor(scene, material, slope.at);
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, slope.at + DVec3{0, 0.5, 0}, 1, material));
    return trial.start(scene);
}

/// Distance down the fall line from where the cube began.
double descent(const Run& run, const Slope& slope) {
    const DVec3 d = run.position(1) - slope.at;
    return d.x * std::cos(slope.radians()) + d.z * std::sin(slope.radians());
}

/// Speed of a cube that must stay, after it has had two seconds to come to rest.
void holds(Trial& trial, const Slope& slope) {
    constexpr double kSeconds = 10;
    Run run = start(trial, slope);
    run.advance(2);
    const DVec3 from = run.position(1);
    run.advance(kSeconds);
    const DVec3 d = run.position(1) - from;
    trial.expectAtMost("creep", std::hypot(d.x, d.y, d.z) / kSeconds, 1e-6, "m/s");
}

/// Acceleration by Coulomb's law, g (sin θ − μ cos θ), from three places four seconds apart.
void slides(Trial& trial, const Slope& slope) {
    Run run = start(trial, slope);
    const auto placeAfter = [&](double seconds) {
        run.advance(seconds);
        return descent(run, slope);
    };
    const double x0 = placeAfter(2), x1 = placeAfter(4), x2 = placeAfter(4);
    const double a = (x2 - 2 * x1 + x0) / 16;
    const double exact = kGravity * (1 - slope.share) * std::sin(kTheta);
    trial.expectNear("acceleration", a, exact, 0.01 * exact, "m/s2");
}

}  // namespace

Family inclines() {
    Family family{"incline", {}};
    const DVec3 away{1000, 0, 1000};
    for (const double heading : {0.0, 22.5, 45.0}) {
        for (const double share : {1.01, 1.05}) {
            const Slope slope{share, heading};
            family.cases.push_back({slope.name(), [slope](Trial& trial) { holds(trial, slope); }});
        }
        for (const double share : {0.99, 0.95}) {
            const Slope slope{share, heading};
            family.cases.push_back({slope.name(), [slope](Trial& trial) { slides(trial, slope); }});
        }
    }
    const Slope far{1.01, 22.5, away}, farSliding{0.99, 22.5, away};
    family.cases.push_back({far.name(), [far](Trial& trial) { holds(trial, far); }});
    family.cases.push_back({farSliding.name(), [farSliding](Trial& trial) { slides(trial, farSliding); }});
    return family;
}

}  // namespace ragtop::stability
