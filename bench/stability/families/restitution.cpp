#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace restitution_cases {

constexpr double kHeight = 5;  ///< m, of the drop
constexpr float kRadius = 0.5f;

Scene dropOf(float restitution) {
    Scene scene;
    const Material material = surface(0.5f, restitution);
    addFloor(scene, material);
    add(scene, solidBody(Sphere{kRadius}, {0, kHeight + static_cast<double>(kRadius), 0}, 1, material));
    return scene;
}

/// Heights of the tops between bounces, each from the parabola through its highest three steps.
std::vector<double> apexes(Run& run, int body, std::size_t count, double seconds) {
    std::vector<double> heights;
    std::array<double, 3> y{};
    y.fill(run.height(body));
    run.advance(seconds, [&] {
        y = {y[1], y[2], run.height(body)};
        if (y[1] > y[0] && y[1] >= y[2]) {
            const double curve = y[0] - 2 * y[1] + y[2], slope = (y[2] - y[0]) / 2;
            heights.push_back(y[1] - slope * slope / (2 * curve) - static_cast<double>(kRadius));
        }
        return heights.size() < count;
    });
    return heights;
}

/// Bounce k rises to e^(2k) of the drop; the worst one counts.
void bounces(Trial& trial, float restitution, std::size_t count) {
    Run run = trial.start(dropOf(restitution));
    const std::vector<double> heights = apexes(run, 1, count, 60);
    const double e2 = static_cast<double>(restitution) * static_cast<double>(restitution);
    double worst = heights.size() == count ? 0 : INFINITY;
    for (std::size_t k = 0; k < heights.size(); ++k)
        worst = larger(worst, std::abs(heights[k] / (kHeight * std::pow(e2, static_cast<double>(k + 1))) - 1));
    trial.expectAtMost(fmt::format("worst of {} tops", count), worst, 0.002, "1");
}

/// With e = 1/2 it comes to rest after √(2 h/g) (1 + e)/(1 − e). Bounces below the speed that gravity gives in two
/// steps need not happen: they would have taken 4 e/(1 − e) steps; one more for the sampling.
void restTime(Trial& trial) {
    constexpr double kRestitution = 0.5;
    Run run = trial.start(dropOf(static_cast<float>(kRestitution)));
    double rest = 0;
    run.advance(6, [&] {
        if (std::abs(run.motion(1).v.y) > 0.1f) rest = run.time();
        return true;
    });
    const double exact = std::sqrt(2 * kHeight / kGravity) * (1 + kRestitution) / (1 - kRestitution);
    trial.expectNear("time to rest", rest, exact, (4 * kRestitution / (1 - kRestitution) + 1) * trial.dt(), "s");
}

/// e = 0: it stays where it fell.
void staysDown(Trial& trial) {
    Run run = trial.start(dropOf(0));
    double speed = 0;
    run.advance(3, [&] {
        speed = larger(speed, static_cast<double>(run.motion(1).v.y));
        return true;
    });
    trial.expectAtMost("speed upwards", speed, 0.05, "m/s");
}

/// 49 balls that bounce without loss for 20 s [Hwangbo et al., SimBenchmark, 2018].
void manyBalls(Trial& trial) {
    Scene scene;
    const Material material = surface(0.5f, 1);
    addFloor(scene, material);
    Dice dice(49);
    for (int i = 0; i < 7; ++i)
        for (int j = 0; j < 7; ++j)
            add(scene,
                solidBody(Sphere{kRadius}, {2.0 * i, static_cast<double>(dice.between(2, 5)), 2.0 * j}, 1, material));
    Run run = trial.start(scene);
    const double floorEnergy = 49 * kGravity * static_cast<double>(kRadius);
    const double energy = run.energy() - floorEnergy;
    double worst = 0;
    run.advance(20, [&] {
        worst = larger(worst, std::abs((run.energy() - floorEnergy) / energy - 1));
        return true;
    });
    trial.expectAtMost("energy", worst, 0.01, "1");
}

/// Five pendulums in a row, `lifted` of them let go together: as many leave on the other side, the rest stays.
void cradle(Trial& trial, int lifted, double gap) {
    constexpr double kLength = 2, kAngle = 0.5;
    Scene scene;
    const Material material = surface(0, 1);
    for (int i = 0; i < 5; ++i) {
        const DVec3 pivot{i * (1 + gap), kLength, 0};
        const double angle = i < lifted ? kAngle : 0;
        const DVec3 at = pivot + kLength * DVec3{-std::sin(angle), -std::cos(angle), 0};
        BodyDef def = solidBody(Sphere{kRadius}, at, 1, material);
        def.pose.rotation = rotationAbout({0, 0, 1}, static_cast<float>(-angle));
        addBall(scene, kWorld, add(scene, def), pivot);
    }
    Run run = trial.start(scene);
    // A quarter of a period down and a quarter up, of a pendulum that turns with its ball [Landau, Mechanics, § 11].
    const double whole = kLength * std::sin(kAngle), turning = 0.4 * kRadius * kRadius / kLength;
    const double amplitude = 1 + kAngle * kAngle / 16 + 11 * kAngle * kAngle * kAngle * kAngle / 3072;
    const double quarter = 0.5 * std::numbers::pi * std::sqrt((kLength + turning) / kGravity) * amplitude;
    double reached = 0;
    std::array<double, 5> farthest{};
    run.advance(2.1 * quarter, [&] {
        for (int i = 0; i < 5; ++i) {
            const double aside = run.position(i).x - i * (1 + gap);
            if (run.time() > 1.1 * quarter)
                farthest[static_cast<std::size_t>(i)] = larger(farthest[static_cast<std::size_t>(i)], std::abs(aside));
        }
        reached = larger(reached, run.position(4).x - 4 * (1 + gap));
        return true;
    });
    const auto ejected = std::ranges::count_if(farthest, [&](double d) { return d > 0.5 * whole; });
    trial.expectNear("ejected", static_cast<double>(ejected), lifted, 0, "balls");
    double still = 0;
    for (int i = 0; i < 5 - lifted; ++i) still = larger(still, farthest[static_cast<std::size_t>(i)]);
    trial.expectAtMost("the others move", still / whole, 0.02, "1");
    trial.expectNear("the last one's reach", reached / whole, 1, 0.02, "1");
}

}  // namespace restitution_cases
}  // namespace

Family restitution() {
    using namespace restitution_cases;
    Family family{"restitution", {{"e=0", staysDown}}};
    const auto addBounces = [&family](float e, std::size_t count) {
        family.cases.push_back({fmt::format("e={}", e), [=](Trial& trial) { bounces(trial, e, count); }});
    };
    addBounces(0.5f, 3);
    addBounces(0.9f, 10);
    addBounces(1, 20);
    family.cases.push_back({"e=0.5, rest", restTime});
    family.cases.push_back({"49 balls, e=1", manyBalls});
    for (const double gap : {0.001, 0.0})
        for (int lifted = 1; lifted <= 4; ++lifted)
            family.cases.push_back({fmt::format("cradle, {}, k={}", gap > 0 ? "1 mm gap" : "touching", lifted),
                                    [=](Trial& trial) { cradle(trial, lifted, gap); }});
    return family;
}

}  // namespace ragtop::stability
