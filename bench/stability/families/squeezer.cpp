#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "../extremes.h"
#include "../scenery.h"
#include "loops.h"

namespace ragtop::stability {
namespace {
namespace squeezer_cases {

/// The squeezer mechanism of Andrews and Manning as published: seven bodies, ten hinges, three loops, one degree of
/// freedom, a spring and a constant torque at the crank, in the plane and without gravity [Hairer, Wanner, Solving ODEs
/// II, VII.7; Mazzia, Magherini, Test Set for Initial Value Problem Solvers, Andrews' squeezing mechanism].
constexpr double kEnd = 0.03;                                          ///< s
constexpr double kTorque = 0.033, kStiffness = 4530, kRest = 0.07785;  ///< N m, N/m, m

/// Angles of the bodies: of crank, rod, lever, upper rod and arm, lower rod and arm.
using Angles = std::array<double, 7>;
/// The published coordinates: of rods the angle beside the part that they hang on.
constexpr Angles absolute(double beta, double theta, double gamma, double phi, double delta, double omega,
                          double epsilon) {
    return {beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon};
}
constexpr Angles kStart = absolute(-0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885,
                                   0.487364979543842550, -0.222668390165885885, 1.23054744454982119);
constexpr Angles kAtEnd = absolute(15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
                                   0.5244099658805304, 0.5347301163226948, 1.048080741042263);
constexpr double kCrankSpeedAtEnd = 1139.920302151208;  ///< rad/s

/// kg, and kg m² about the centre of mass.
struct Inertia {
    double mass, moment;
};
constexpr std::array<Inertia, 7> kInertias{{{0.04325, 2.194e-6},
                                            {0.00365, 4.410e-7},
                                            {0.02373, 5.255e-6},
                                            {0.00706, 5.667e-7},
                                            {0.07050, 1.169e-5},
                                            {0.00706, 5.667e-7},
                                            {0.05498, 1.912e-5}}};

/// (along, across), turned by an angle.
DVec3 turned(double angle, double along, double across) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * along - s * across, s * along + c * across, 0};
}

/// What a unit of the scene is of the published ones.
struct Units {
    double length = 1, time = 1, mass = 1;
};

Scene sceneOf(const Units& units) {
    const auto& [crank, rod, lever, upperRod, upper, lowerRod, lower] = kStart;
    const DVec3 o{}, a{-0.06934, -0.00227, 0}, b{-0.03635, 0.03273, 0}, c{0.014, 0.072, 0};
    const DVec3 f = turned(crank, 0.007, 0), e = f - turned(rod, 0.028, 0);
    const DVec3 g = a + turned(upper, 0.04, 0), h = a + turned(lower, 0, -0.04);
    const DVec3 d = b + turned(lever, 0.02, -0.018);
    const std::array<DVec3, 7> centers{turned(crank, 0.00092, 0),
                                       f - turned(rod, 0.0115, 0),
                                       b + turned(lever, 0.01874, -0.01043),
                                       g + turned(upperRod, 0, 0.01421 - 0.02),
                                       a + turned(upper, 0.02308, 0.00916),
                                       h + turned(lowerRod, 0.02 - 0.01421, 0),
                                       a + turned(lower, 0.01228, -0.00449)};
    Scene scene;
    scene.settings.gravity = {};
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const float moment = static_cast<float>(kInertias[i].moment * units.mass * units.length * units.length);
        BodyDef def = bodyWithMass(Sphere{static_cast<float>(0.002 * units.length)}, units.length * centers[i],
                                   static_cast<float>(kInertias[i].mass * units.mass), {moment, moment, moment}, {});
        def.shapes[0].filter.mask = 0;
        add(scene, def);
    }
    const auto pin = [&](int first, int second, const DVec3& at) -> HingeDef& {
        return addHinge(scene, first, second, units.length * at, {0, 0, 1});
    };
    constexpr float kAlways = 1e5f;  // faster than it gets
    const double force = units.mass * units.length / (units.time * units.time);
    pin(kWorld, 0, o).motor = Motor{kAlways, static_cast<float>(kTorque * force * units.length)};
    pin(kWorld, 2, b), pin(kWorld, 4, a), pin(kWorld, 6, a);
    pin(0, 1, f), pin(4, 3, g), pin(6, 5, h);
    for (const int arm : {1, 3, 5}) pin(arm, 2, e);
    DistanceDef& spring = addDistance(scene, kWorld, 2, units.length * c, units.length * d);
    spring.spring = Spring{static_cast<float>(kStiffness * force / units.length), 0};
    spring.rest = static_cast<float>(kRest * units.length);
    return scene;
}

/// Against the published state at the end, in as many steps as 60 a second make of it in the scene's units.
void published(Trial& trial, const Units& units) {
    Run run = trial.start(sceneOf(units));
    Angles angles = kStart;
    std::array<double, 7> before{};
    double gap = 0;
    run.advance(kEnd * units.time, [&] {
        for (std::size_t i = 0; i < angles.size(); ++i) {
            const Quat q = run.motion(static_cast<int>(i)).pose.rotation;
            const double now = 2 * std::atan2(static_cast<double>(q.z), static_cast<double>(q.w));
            angles[i] += std::remainder(now - before[i], 2 * std::numbers::pi);
            before[i] = now;
        }
        gap = larger(gap, run.jointGap());
        return true;
    });
    double worst = 0;
    for (std::size_t i = 1; i < angles.size(); ++i) worst = larger(worst, std::abs(angles[i] - kAtEnd[i]));
    const double speed = static_cast<double>(run.motion(0).w.z) * units.time;
    trial.expectNear("angle of the crank", angles[0], kAtEnd[0], 0.01 * (kAtEnd[0] - kStart[0]), "rad");
    trial.expectNear("its speed", speed, kCrankSpeedAtEnd, 0.01 * kCrankSpeedAtEnd, "rad/s");
    trial.expectAtMost("angles of the others", worst, 0.01, "rad");
    trial.expectAtMost("gap", gap, 1e-4, "m");
}

}  // namespace squeezer_cases
}  // namespace

void addSqueezerCases(Family& family) {
    using namespace squeezer_cases;
    // Three seconds instead of 0.03, in decimetres and tonnes: 60 steps a second see the crank turn.
    family.cases.push_back({"Andrews as published, slowed", [](Trial& trial) { published(trial, {10, 100, 1000}); }});
    family.cases.push_back({"Andrews as published", [](Trial& trial) {
                                trial.setStep(trial.dt() / 100);
                                published(trial, {});
                            }});
}

}  // namespace ragtop::stability
