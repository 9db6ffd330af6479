#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace shots_cases {

/// Shots at walls that stand side by side without meeting, flying along x at x = 0.
constexpr double kLane = 8;  ///< m between the middles of two walls
constexpr float kHalfWall = 2;
constexpr double kRim = 0.25;  ///< m from the edge of a wall: half a shot reaches over it

struct Wall {
    double thickness = 0.1;
    bool mesh = false;
};

void addWall(Scene& scene, int lane, const Wall& wall) {
    const DVec3 at{0, 0, kLane * lane};
    const float half = static_cast<float>(wall.thickness / 2);
    if (!wall.mesh) {
        add(scene, fixedBody(Box{{half, kHalfWall, kHalfWall}}, at, {}));
        return;
    }
    // A single sheet that faces the shots.
    const std::vector<Vec3> vertices{{-half, -kHalfWall, -kHalfWall},
                                     {-half, kHalfWall, -kHalfWall},
                                     {-half, kHalfWall, kHalfWall},
                                     {-half, -kHalfWall, kHalfWall}};
    const std::vector<Triangle> triangles{{0, 2, 1}, {0, 3, 2}};
    add(scene, fixedBody(TriangleMesh{vertices, triangles}, at, {}));
}

/// Shots at walls, one per lane; counts those that come out behind.
class Range {
public:
    Range() { scene_.settings.gravity = {}; }
    void shoot(const Wall& wall, BodyDef shot, double distance, const Vec3& velocity) {
        addWall(scene_, lanes_, wall);
        shot.pose.position = DVec3{-distance, 0, kLane * lanes_} + shot.pose.position;
        shot.linearVelocity = velocity;
        shots_.push_back(add(scene_, std::move(shot)));
        longest_ = larger(longest_, distance / static_cast<double>(velocity.x));
        ++lanes_;
    }
    /// Waits until the slowest would have been there one and a half times. What slides along its wall to the rim has
    /// not passed it, wherever it goes from there.
    int passed(Trial& trial) {
        Run run = trial.start(std::move(scene_));
        std::vector<bool> gone(shots_.size()), behind(shots_.size());
        run.advance(1.5 * longest_ + 4 * trial.dt(), [&] {
            for (std::size_t i = 0; i < shots_.size(); ++i) {
                const DVec3 at = run.position(shots_[i]);
                const double aside = larger(std::abs(at.y), std::abs(at.z - kLane * static_cast<double>(i)));
                if (!gone[i] && !(at.x < 0.05)) behind[i] = true;
                if (aside > static_cast<double>(kHalfWall) - kRim) gone[i] = true;
            }
            return true;
        });
        return static_cast<int>(std::ranges::count(behind, true));
    }

private:
    Scene scene_;
    std::vector<int> shots_;
    int lanes_ = 0;
    double longest_ = 0;
};

/// A ball of 5 cm at 100 m/s against a wall, at eight phases of the step.
void phases(Trial& trial, double thickness) {
    constexpr double kSpeed = 100;
    Range range;
    for (int phase = 0; phase < 8; ++phase)
        range.shoot({thickness}, solidBody(Sphere{0.05f}, {}, 1, {}), 5 + kSpeed * trial.dt() * phase / 8, {100, 0, 0});
    trial.expectAtMost("passes of 8", range.passed(trial), 0, "shots");
}

/// A rod of 0.4 m that spins at 100 rad/s while it flies at 20 m/s, at eight phases of both.
void spinningRods(Trial& trial) {
    Range range;
    for (int phase = 0; phase < 8; ++phase) {
        BodyDef rod = solidBody(Box{{0.01f, 0.2f, 0.01f}}, {}, 1, {});
        rod.angularVelocity = {0, 0, 100};
        rod.pose.rotation = rotationAbout({0, 0, 1}, kPi * static_cast<float>(phase) / 8);
        range.shoot({.thickness = 0.05}, rod, 3 + 20 * trial.dt() * phase / 8, {20, 0, 0});
    }
    trial.expectAtMost("passes of 8", range.passed(trial), 0, "shots");
}

/// Two bullets that meet head on at eight phases must not change places.
void bullets(Trial& trial) {
    constexpr float kSpeed = 100;
    Scene scene;
    scene.settings.gravity = {};
    for (int phase = 0; phase < 8; ++phase)
        for (const float side : {-1.0f, 1.0f}) {
            const double gap = 2 + static_cast<double>(kSpeed) * trial.dt() * phase / 8;
            BodyDef ball = solidBody(Sphere{0.05f}, {static_cast<double>(side) * gap, 0, 2.0 * phase}, 1, {});
            ball.bullet = true;
            ball.linearVelocity = {-side * kSpeed, 0, 0};
            add(scene, ball);
        }
    Run run = trial.start(scene);
    run.advance(0.2);
    int passed = 0;
    for (int i = 0; i < 16; i += 2)
        if (!(run.position(i).x < run.position(i + 1).x)) ++passed;
    trial.expectAtMost("passes of 8", passed, 0, "pairs");
}

/// A ball, capsule, box or spinning rod of 5 to 20 cm.
BodyDef randomShot(Dice& dice) {
    const float size = dice.between(0.0625f, 0.21f);
    Shape shape;
    switch (dice.below(4)) {
        case 0:
            shape = Sphere{size / 2};
            break;
        case 1:
            shape = Capsule{size / 4, size / 2};
            break;
        case 2:
            shape = Box{{size / 2, size / 3, size / 4}};
            break;
        default:
            shape = Box{{size / 10, size, size / 10}};
    }
    BodyDef def = solidBody(shape, {}, 1, {});
    def.pose.rotation = dice.rotation();
    def.angularVelocity = {dice.between(-100, 100), dice.between(-100, 100), dice.between(-100, 100)};
    return def;
}

/// Ten thousand shots of all kinds, speeds (10 to 200 m/s), directions and walls (5 to 20 cm; boxes and sheets).
void random(Trial& trial, int shots) {
    constexpr int kBatch = 100;
    Dice dice(1);
    int passed = 0;
    for (int done = 0; done < shots; done += kBatch) {
        Range range;
        for (int i = 0; i < kBatch; ++i) {
            const Wall wall{static_cast<double>(dice.between(0.05f, 0.2f)), dice.below(2) == 0};
            const float speed = dice.between(10, 200);
            const double distance = 1 + static_cast<double>(dice.between(0, 2));
            // Aslant by up to a third, so that all hit the wall.
            const float up = dice.between(-0.33f, 0.33f), aside = dice.between(-0.33f, 0.33f);
            const BodyDef shot = randomShot(dice);
            range.shoot(wall, shot, distance, {speed, up * speed, aside * speed});
        }
        passed += range.passed(trial);
    }
    trial.expectAtMost(fmt::format("passes of {}", shots), passed, 0, "shots");
}

}  // namespace shots_cases
}  // namespace

Family shots() {
    using namespace shots_cases;
    return {"ccd",
            {
                {"ball at 100 m/s, wall of 0.1 m", [](Trial& trial) { phases(trial, 0.1); }},
                {"ball at 100 m/s, wall of 0.05 m", [](Trial& trial) { phases(trial, 0.05); }},
                {"rod spinning at 100 rad/s", spinningRods},
                {"two bullets head on", bullets},
                {"random shots, short", [](Trial& trial) { random(trial, 1000); }, Kind::oneStep},
                {"random shots", [](Trial& trial) { random(trial, 10000); }, Kind::oneStep},
            }};
}

}  // namespace ragtop::stability
