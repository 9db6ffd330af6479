#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace balls_cases {

constexpr float kRadius = 0.1f;

/// Overlaps of all pairs of balls from `first` on and of balls with the floor, m.
std::vector<double> overlaps(const Run& run, int first) {
    std::vector<DVec3> at;
    for (int i = first; i < static_cast<int>(run.scene().bodies.size()); ++i) at.push_back(run.position(i));
    std::vector<double> depths;
    const double r = static_cast<double>(kRadius);
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (!(at[i].y >= r)) depths.push_back(r - at[i].y);
        for (std::size_t j = 0; j < i; ++j) {
            const DVec3 d = at[i] - at[j];
            const double apart = d.x * d.x + d.y * d.y + d.z * d.z;
            if (!(apart >= 4 * r * r)) depths.push_back(2 * r - std::sqrt(apart));
        }
    }
    return depths;
}

/// Balls that fall onto a plane between four walls.
struct Pit {
    static constexpr int kBalls = 666;
    static constexpr double kWide = 2;  ///< m
    Scene scene;
    int first = 0;

    explicit Pit(int seed) {
        const Material material = surface(0.5f);
        addFloor(scene, material);
        for (const double side : {-1.0, 1.0}) {
            add(scene, fixedBody(Box{{0.5f, 5, 2}}, {1.5 * side, 5, 0}, material));
            add(scene, fixedBody(Box{{2, 5, 0.5f}}, {0, 5, 1.5 * side}, material));
        }
        first = static_cast<int>(scene.bodies.size());
        Dice dice(static_cast<std::uint64_t>(seed));
        for (int i = 0; i < kBalls; ++i) {
            const DVec3 at{0.25 * (i % 8 - 3.5), 0.15 + 0.25 * (i / 64), 0.25 * (i / 8 % 8 - 3.5)};
            add(scene, solidBody(Sphere{kRadius}, at + jitter(dice, 0.01f), 1, material));
        }
    }
};

/// A pile of eleven layers: a hundredth of a diameter is what eyes forgive.
void pile(Trial& trial) {
    constexpr double kDiameter = 2 * static_cast<double>(kRadius);
    double mean = 0, deepest = 0, restless = 0, height = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        const Pit pit(seed);
        Run run = trial.start(pit.scene, fmt::format("{}", seed));
        run.advance(5);
        const std::vector<double> depths = overlaps(run, pit.first);
        double sum = 0, energy = 0, heights = 0;
        for (const double depth : depths) {
            sum += depth;
            deepest = larger(deepest, depth);
        }
        for (int i = pit.first; i < pit.first + Pit::kBalls; ++i) {
            const Vec3 v = run.motion(i).v;
            energy += 0.5 * static_cast<double>(dot(v, v));
            heights += run.height(i);
        }
        if (!depths.empty()) mean = larger(mean, sum / static_cast<double>(depths.size()));
        restless = larger(restless, energy / Pit::kBalls);
        height = larger(height, heights / Pit::kBalls);
    }
    // Balls that lie fill more than half of the room.
    const double volume = Pit::kBalls * std::numbers::pi / 6 * kDiameter * kDiameter * kDiameter;
    trial.expectAtMost("mean height", height, volume / 0.5 / (Pit::kWide * Pit::kWide) / 2, "m");
    trial.expectAtMost("mean overlap", mean, 0.01 * kDiameter, "m");
    trial.expectAtMost("deepest overlap", deepest, 0.05 * kDiameter, "m");
    trial.expectAtMost("mean kinetic energy", restless, 0.01, "J");
}

/// SimBenchmark's "666": a cube of 6 × 6 × 6 balls of 10 kg without friction, a centimetre apart, which falls apart
/// [Hwangbo et al., SimBenchmark, 2018]. Its measure is the sum of the squares of all overlaps, mean over the run; the
/// best of the engines published there has 2.8e-4 at steps of 1 ms. Nothing pushes sideways, and energy only falls.
void cube(Trial& trial) {
    constexpr int kSide = 6, kBalls = kSide * kSide * kSide;
    constexpr double kGap = 0.21, kStart = 0.101, kMass = 10;
    double error = 0, gained = 0, aside = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Scene scene;
        Dice dice(static_cast<std::uint64_t>(seed));
        const Material slippery = surface(0);
        addFloor(scene, slippery);
        const auto off = [&] { return 0.001 * static_cast<double>(dice.between(0, 1)); };
        for (int i = 0; i < kBalls; ++i) {
            const double x = i % kSide, y = i / (kSide * kSide), z = i / kSide % kSide;
            const DVec3 at{kGap * x + off(), kStart + kGap * y + off(), kGap * z + off()};
            add(scene, solidBody(Sphere{kRadius}, at, static_cast<float>(kMass), slippery));
        }
        Run run = trial.start(scene, fmt::format("{}", seed));
        const double start = run.energy();
        double sum = 0;
        int steps = 0;
        run.advance(10, [&] {
            for (const double depth : overlaps(run, 1)) sum += depth * depth;
            ++steps;
            gained = larger(gained, run.energy() / start - 1);
            return true;
        });
        DVec3 momentum;
        double speeds = 0;
        for (int i = 1; i <= kBalls; ++i) {
            const DVec3 v{run.motion(i).v};
            momentum = momentum + v;
            speeds += std::hypot(v.x, v.z);
        }
        error = larger(error, sum / steps);
        aside = larger(aside, std::hypot(momentum.x, momentum.z) / speeds);
    }
    trial.expectAtMost("squares of overlaps", error, 2.8e-4, "m2");
    trial.expectAtMost("momentum sideways", aside, 1e-5, "1");
    trial.expectAtMost("energy gained", gained, 0.001, "1");
}

}  // namespace balls_cases
}  // namespace

Family balls() {
    using namespace balls_cases;
    return {"balls", {{"666 in a pit", pile, Kind::swept, false}, {"6 x 6 x 6 without friction", cube, Kind::swept}}};
}

}  // namespace ragtop::stability
