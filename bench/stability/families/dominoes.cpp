#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace dominoes_cases {

constexpr int kCount = 100;

/// Dominoes of 48 × 24 × 7.5 mm, 20 mm apart, the first one toppling; lengths are short binary fractions, times
/// `scale`, which is a power of four. Lengths × 4 at equal gravity and density are times × 2, speeds × 2, spins ÷ 2,
/// masses × 64.
Scene row(double friction, float scale) {
    Scene scene;
    const Material material = surface(static_cast<float>(friction));
    // Their feet have 0.6, or nothing where they have none among each other: the pairs' friction is the geometric mean.
    const Material ground = surface(friction > 0 ? static_cast<float>(0.36 / friction) : 0);
    add(scene, fixedBody(Box{scale * Vec3{4, 0.125f, 0.25f}}, double{scale} * DVec3{1, -0.125, 0}, ground));
    const Vec3 half{0.00390625f, 0.0234375f, 0.01171875f};
    for (int i = 0; i < kCount; ++i) {
        const DVec3 at{0.01953125 * i, static_cast<double>(half.y), 0};
        BodyDef def;
        def.shapes.push_back({.geometry = Box{scale * half}, .density = 1024, .material = material});
        def.pose.position = double{scale} * at;
        if (i == 0) {
            // About its front lower edge.
            const float spin = 6 / std::sqrt(scale);
            def.angularVelocity = {0, 0, -spin};
            def.linearVelocity = scale * spin * Vec3{half.y, half.x, 0};
        }
        add(scene, def);
    }
    return scene;
}

bool hasFallen(const Run& run, int body) {
    return static_cast<double>(rotate(run.motion(body).pose.rotation, {0, 1, 0}).y) < 0.9;
}

/// Speed of the wave between the 20th and the 80th domino, 0.77 m high so that it takes several steps for each.
double waveSpeed(Trial& trial, double friction) {
    constexpr float kScale = 16;
    Run run = trial.start(row(friction, kScale));
    double first = NAN, last = NAN;
    run.advance(20, [&] {
        if (std::isnan(first) && hasFallen(run, 20)) first = run.time();
        if (std::isnan(last) && hasFallen(run, 80)) last = run.time();
        return std::isnan(last);
    });
    return 60 * 0.01953125 * static_cast<double>(kScale) / (last - first);
}

/// Against the same engine at a sixteenth of the step.
void speed(Trial& trial, double friction) {
    Trial fine({"", "", &trial.engine(), trial.dt() / 16, {}});
    const double exact = waveSpeed(fine, friction);
    trial.expectNear("speed of the wave", waveSpeed(trial, friction), exact, 0.05 * exact, "m/s");
}

/// The same row four times as large, with steps twice as long, runs the same but for exponents.
void scaling(Trial& trial, double friction) {
    Trial large({"", "", &trial.engine(), 2 * trial.dt(), {}});
    Run one = trial.start(row(friction, 1)), four = large.start(row(friction, 4));
    double worst = 0;
    for (int i = 0; i < 180; ++i) {
        one.step();
        four.step();
        for (int body = 1; body <= kCount; ++body) {
            const DVec3 d = 0.25 * four.position(body) - one.position(body);
            worst = larger(worst, std::hypot(d.x, d.y, d.z));
        }
    }
    trial.expectAtMost("scaling defect", worst, 0, "m");
}

}  // namespace dominoes_cases
}  // namespace

Family dominoes() {
    using namespace dominoes_cases;
    Family family{"dominoes", {}};
    for (const double friction : {0.0, 0.2, 0.6}) {
        family.cases.push_back(
            {fmt::format("scaled, mu={}", friction), [friction](Trial& trial) { scaling(trial, friction); }});
        if (friction > 0)
            family.cases.push_back({fmt::format("speed, mu={}", friction),
                                    [friction](Trial& trial) { speed(trial, friction); }, Kind::oneStep});
    }
    return family;
}

}  // namespace ragtop::stability
