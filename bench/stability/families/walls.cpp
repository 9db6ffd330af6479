#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace walls_cases {

constexpr int kCourses = 10, kBricks = 20;
constexpr double kLength = 0.4, kHeight = 0.2, kThickness = 0.2;  ///< m

/// A wall of bricks in running bond in the x–y plane, mirrored about x = 0; every other course ends in half bricks.
struct Wall {
    Scene scene;
    std::vector<int> bricks;
};

Wall wall(Dice& dice) {
    Wall wall;
    const Material material = surface(0.6f);
    addFloor(wall.scene, material);
    const auto lay = [&](double x, int course, double length) {
        const Vec3 half = toVec3(0.5 * DVec3{length, kHeight, kThickness});
        BodyDef def = fixedBody(Box{half}, {x, kHeight * (course + 0.5), 0}, material);
        def.type = BodyType::dynamic;
        def.shapes[0].density = 1800;
        def.pose.position = def.pose.position + jitter(dice, 1e-4f);
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
    double worst = 0;
    int standing = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Dice dice(static_cast<std::uint64_t>(seed));
        const Wall scene = wall(dice);
        Run run = trial.start(scene.scene, fmt::format("{}", seed));
        double moved = 0;
        int steps = 0;
        const bool stands = run.advance(kSeconds, [&] {
            if (++steps % 10 != 0) return true;
            for (const int brick : scene.bricks) moved = larger(moved, run.moved(brick));
            return moved < kHeight;
        });
        if (stands) ++standing;
        worst = larger(worst, moved);
    }
    trial.expectAtLeast(fmt::format("stand, of {}", trial.starts()), standing, trial.starts(), "walls");
    trial.expectAtMost("largest move", worst, 0.01, "m");
}

struct Debris {
    double aside = 0;   ///< m, mean place of the bricks along the wall
    double gained = 0;  ///< largest rise of energy above the least before, of what the ball brought
};

/// A ball of 50 kg hits the middle of the wall with 20 m/s.
Debris smash(Trial& trial, std::uint64_t seed) {
    constexpr float kRadius = 0.25f, kMass = 50, kSpeed = 20;
    Dice dice(seed);
    Wall scene = wall(dice);
    BodyDef ball = solidBody(Sphere{kRadius}, {0, 1, 2}, kMass, surface(0.6f));
    ball.linearVelocity = {0, 0, -kSpeed};
    add(scene.scene, ball);
    Run run = trial.start(scene.scene, fmt::format("{}", seed));
    const double brought = 0.5 * static_cast<double>(kMass * kSpeed * kSpeed);
    double least = run.energy();
    Debris result;
    run.advance(3, [&] {
        const double now = run.energy();
        result.gained = larger(result.gained, (now - least) / brought);
        least = smaller(least, now);
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
    trial.expectAtMost("energy gained at any time", gained, 0.001, "1");
}

}  // namespace walls_cases
}  // namespace

Family walls() {
    using namespace walls_cases;
    return {"wall",
            {
                {"10 x 20 bricks, unhit", unhit, Kind::swept, false},
                {"hit, 8 runs", [](Trial& trial) { ensemble(trial, 8); }, Kind::oneStep},
                {"hit, 64 runs", [](Trial& trial) { ensemble(trial, 64); }, Kind::longer},
            }};
}

}  // namespace ragtop::stability
