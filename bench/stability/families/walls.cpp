#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

constexpr int kCourses = 10, kBricks = 20;
constexpr double kLength = 0.4, kHeight = 0.2, kThickness = 0.2;  ///< m

/// A wall of bricks in running bond in the x–y plane, mirrored about x = 0; every other course ends in half bricks.
struct Wall {
    Scene scene;
    std::vector<int> bricks;
};

Wall wall(Dice* dice) {
    Wall wall;
    const Material material = surface(0.6f);
    addFloor(wall.scene, material);
    const auto lay = [&](double x, int course, double length) {
        const Vec3 half = toVec3(0.5 * DVec3{length, kHeight, kThickness});
        BodyDef def = fixedBody(Box{half}, {x, kHeight * (course + 0.5), 0}, material);
        def.type = BodyType::dynamic;
        def.shapes[0].density = 1800;
        if (dice) def.pose.position = def.pose.position + jitter(*dice, 1e-4f);
        wall.bricks.push_back(add(wall.scene, def));
    };
    for (int course = 0; course < kCourses; ++course) {
        const bool shifted = course % 2 == 1;
        const double left = -kLength * kBricks / 2;
        if (shifted) lay(left + kLength / 4, course, kLength / 2);
        for (int i = 0; i < kBricks - (shifted ? 1 : 0); ++i)
            lay(left + kLength * (i + (shifted ? 1 : 0.5)), course, kLength);
        if (shifted) lay(-left - kLength / 4, course, kLength / 2);
    }
    return wall;
}

void unhit(Trial& trial) {
    constexpr double kSeconds = 60;
    const Wall scene = wall(nullptr);
    Run run = trial.start(scene.scene);
    double worst = 0;
    int steps = 0;
    run.advance(kSeconds, [&] {
        if (++steps % 10 != 0) return true;
        for (const int brick : scene.bricks) worst = larger(worst, run.moved(brick));
        return worst < kHeight;
    });
    trial.expectAtLeast("stands", run.time(), kSeconds, "s");
    trial.expectAtMost("largest move", worst, 0.01, "m");
}

struct Debris {
    double aside = 0;   ///< m, mean place of the bricks along the wall
    double gained = 0;  ///< largest rise of energy within a step, of what the ball brought
};

/// A ball of 50 kg hits the middle of the wall with 20 m/s.
Debris smash(Trial& trial, std::uint64_t seed) {
    constexpr float kRadius = 0.25f, kMass = 50, kSpeed = 20;
    Dice dice(seed);
    Wall scene = wall(&dice);
    BodyDef ball = solidBody(Sphere{kRadius}, {0, 1, 2}, kMass, surface(0.6f));
    ball.linearVelocity = {0, 0, -kSpeed};
    add(scene.scene, ball);
    Run run = trial.start(scene.scene, fmt::format("{}", seed));
    const double brought = 0.5 * static_cast<double>(kMass * kSpeed * kSpeed);
    double before = run.energy();
    Debris result;
    run.advance(3, [&] {
        const double now = run.energy();
        result.gained = larger(result.gained, (now - before) / brought);
        before = now;
        return true;
    });
    for (const int brick : scene.bricks)
        result.aside += run.position(brick).x / static_cast<double>(scene.bricks.size());
    return result;
}

/// Runs that differ by a tenth of a millimetre: the debris may lie anywhere, but not to one side on the average. With n
/// runs the mean is within 3.5 standard errors of zero, but for one chance in hundreds.
void ensemble(Trial& trial, int runs) {
    double sum = 0, squares = 0, gained = 0;
    for (int i = 0; i < runs; ++i) {
        const Debris debris = smash(trial, static_cast<std::uint64_t>(i + 1));
        sum += debris.aside;
        squares += debris.aside * debris.aside;
        gained = larger(gained, debris.gained);
    }
    const double mean = sum / runs, variance = (squares - runs * mean * mean) / (runs - 1);
    trial.expectAtMost("debris to one side", mean / std::sqrt(variance / runs), 3.5, "errors");
    trial.expectAtMost("energy gained in a step", gained, 0.001, "1");
}

}  // namespace

Family walls() {
    return {"wall",
            {
                {"10 x 20 bricks, unhit", unhit},
                {"hit, 8 runs", [](Trial& trial) { ensemble(trial, 8); }, Kind::oneStep},
                {"hit, 64 runs", [](Trial& trial) { ensemble(trial, 64); }, Kind::longer},
            }};
}

}  // namespace ragtop::stability
