#include <cmath>
#include <vector>

#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

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

void holds(Trial& trial) {
    Run run = trial.start(arm());
    run.advance(20);
    const Pose pose = run.motion(kLinks - 1).pose;
    const double tip = transformPoint(pose, {static_cast<float>(kLength / 2), 0, 0}).y;
    trial.expectNear("height of the tip", tip, tipAtRest(), 0.01 * std::abs(tipAtRest()), "m");
    trial.expectAtMost("gap", run.jointGap(), 0.001, "m");
    trial.expectAtMost("speed", static_cast<double>(length(run.motion(kLinks - 1).v)), 0.001, "m/s");
}

}  // namespace

Family motors() { return {"motors", {{"30 links on springs", holds}}}; }

}  // namespace ragtop::stability
