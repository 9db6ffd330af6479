#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

constexpr int kBalls = 666;
constexpr float kRadius = 0.1f;

/// 666 balls fall onto a plane between four walls [Hwangbo et al., SimBenchmark, 2018: the number, not the
/// arrangement].
Scene pit() {
    Scene scene;
    const Material material = surface(0.5f);
    addFloor(scene, material);
    for (const double side : {-1.0, 1.0}) {
        add(scene, fixedBody(Box{{0.5f, 5, 2}}, {1.5 * side, 5, 0}, material));
        add(scene, fixedBody(Box{{2, 5, 0.5f}}, {0, 5, 1.5 * side}, material));
    }
    Dice dice(666);
    for (int i = 0; i < kBalls; ++i) {
        const DVec3 at{0.25 * (i % 8 - 3.5), 0.15 + 0.25 * (i / 64), 0.25 * (i / 8 % 8 - 3.5)};
        add(scene, solidBody(Sphere{kRadius}, at + jitter(dice, 0.01f), 1, material));
    }
    return scene;
}

/// Overlaps of all pairs of balls and of balls with the floor, m.
std::vector<double> overlaps(const Run& run, int first) {
    std::vector<DVec3> at;
    for (int i = 0; i < kBalls; ++i) at.push_back(run.position(first + i));
    std::vector<double> depths;
    const double r = static_cast<double>(kRadius);
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i].y < r) depths.push_back(r - at[i].y);
        for (std::size_t j = 0; j < i; ++j) {
            const DVec3 d = at[i] - at[j];
            const double apart = std::hypot(d.x, d.y, d.z);
            if (apart < 2 * r) depths.push_back(2 * r - apart);
        }
    }
    return depths;
}

/// A pile of eleven layers: a hundredth of a diameter is what eyes forgive.
void pile(Trial& trial) {
    const Scene scene = pit();
    const int first = static_cast<int>(scene.bodies.size()) - kBalls;
    Run run = trial.start(scene);
    run.advance(5);
    const std::vector<double> depths = overlaps(run, first);
    double sum = 0, worst = 0, energy = 0;
    for (const double depth : depths) {
        sum += depth;
        worst = larger(worst, depth);
    }
    for (int i = 0; i < kBalls; ++i) {
        const Vec3 v = run.motion(first + i).v;
        energy += 0.5 * static_cast<double>(dot(v, v));
    }
    const double mean = depths.empty() ? 0 : sum / static_cast<double>(depths.size());
    trial.expectAtMost("mean overlap", mean, 0.01 * 2 * static_cast<double>(kRadius), "m");
    trial.expectAtMost("deepest overlap", worst, 0.05 * 2 * static_cast<double>(kRadius), "m");
    trial.expectAtMost("mean kinetic energy", energy / kBalls, 0.01, "J");
}

}  // namespace

Family balls() { return {"balls", {{"666 in a pit", pile}}}; }

}  // namespace ragtop::stability
