#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace stacks_cases {

constexpr double kLong = 60;  ///< s

/// Cubes of 1 kg per cubic metre on a floor, each up to a thousandth of its size off the middle.
struct Column {
    int boxes = 10;
    float size = 1;  ///< m
    float friction = 0.5f;
};

Scene sceneOf(const Column& column, int seed) {
    Scene scene;
    Dice dice(static_cast<std::uint64_t>(seed));
    const Material material = surface(column.friction);
    addFloor(scene, material);
    const float half = column.size / 2, mass = column.size * column.size * column.size;
    for (int i = 0; i < column.boxes; ++i) {
        const DVec3 middle{0, static_cast<double>(column.size) * (i + 0.5), 0};
        add(scene, solidBody(Box{{half, half, half}}, middle + jitter(dice, 0.001f * column.size), mass, material));
    }
    return scene;
}

struct Standing {
    double time = 0;      ///< s, until the top box had lost half its size
    double loss = 0;      ///< m, largest of the top box
    double sideways = 0;  ///< m, largest of any box
};

Standing watch(Run& run, const Column& column, double seconds) {
    Standing result;
    const DVec3 top = run.position(column.boxes);
    const auto stands = [&] {
        result.loss = larger(result.loss, top.y - run.height(column.boxes));
        if (!(result.loss < static_cast<double>(column.size) / 2)) return false;
        for (int box = 1; box <= column.boxes; ++box) {
            const DVec3 from = run.scene().bodies[static_cast<std::size_t>(box)].def.pose.position;
            const DVec3 d = run.position(box) - from;
            result.sideways = larger(result.sideways, std::hypot(d.x, d.z));
        }
        result.time = run.time();
        return true;
    };
    run.advance(seconds, stands);
    return result;
}

/// The force between each two boxes against the weight above, as a share of the whole weight; mean of a second.
double errorOfLoads(Run& run, const Column& column) {
    std::vector<double> force(static_cast<std::size_t>(column.boxes), 0.0);
    int steps = 0;
    run.advance(1, [&] {
        ++steps;
        for (int i = 0; i < column.boxes; ++i) force[static_cast<std::size_t>(i)] += run.engine().normalForce(i, i + 1);
        return true;
    });
    const double weight = kGravity * std::pow(static_cast<double>(column.size), 3);
    double worst = 0;
    for (int i = 0; i < column.boxes; ++i) {
        const double error = force[static_cast<std::size_t>(i)] / steps - (column.boxes - i) * weight;
        worst = larger(worst, std::abs(error) / (column.boxes * weight));
    }
    return worst;
}

/// The worst of columns that begin apart by other millimetres, and how many stand. Bounds of height and sideways move
/// are thousandths of the box: 5 mm and 1 cm for 1 m.
void stands(Trial& trial, const Column& column) {
    Standing worst;
    double loads = 0;
    int standing = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Run run = trial.start(sceneOf(column, seed), fmt::format("{}", seed));
        const Standing result = watch(run, column, kLong);
        worst.loss = larger(worst.loss, result.loss);
        worst.sideways = larger(worst.sideways, result.sideways);
        if (!(result.time >= kLong)) continue;
        ++standing;
        loads = larger(loads, errorOfLoads(run, column));
    }
    const double size = static_cast<double>(column.size);
    trial.expectAtLeast(fmt::format("stand, of {}", trial.starts()), standing, trial.starts(), "columns");
    trial.expectAtMost("height lost", worst.loss, 0.005 * size, "m");
    trial.expectAtMost("sideways", worst.sideways, 0.01 * size, "m");
    trial.expectAtMost("loads against the weight above", loads, 0.01, "1");
}

/// Hundred boxes need only stand.
void standsAtAll(Trial& trial, const Column& column) {
    int standing = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Run run = trial.start(sceneOf(column, seed), fmt::format("{}", seed));
        if (watch(run, column, kLong).time >= kLong) ++standing;
    }
    trial.expectAtLeast(fmt::format("stand, of {}", trial.starts()), standing, trial.starts(), "columns");
}

/// The tallest column that stands, to a twentieth of its height.
void tallest(Trial& trial) {
    const auto stands = [&](int boxes) {
        const Column column{boxes};
        Run run = trial.start(sceneOf(column, boxes), fmt::format("{}", boxes));
        return watch(run, column, kLong).time >= kLong;
    };
    constexpr int kMost = 512;
    int standing = 1, falling = 2;
    while (falling <= kMost && stands(falling)) {
        standing = falling;
        falling *= 2;
    }
    while (falling <= kMost && falling - standing > 1 + standing / 20) {
        const int middle = (standing + falling) / 2;
        (stands(middle) ? standing : falling) = middle;
    }
    trial.expectAtLeast("n_max", standing, 100, "boxes");
}

/// The house of the crash scene, which nothing hits.
void house(Trial& trial) {
    Run run = trial.start(loadScene(findScene("crash_unhit")));
    double worst = 0;
    int steps = 0;
    const auto stands = [&] {
        if (++steps % 30 != 0) return true;
        for (std::size_t i = 0; i < run.scene().bodies.size(); ++i)
            if (run.scene().bodies[i].masonry) worst = larger(worst, run.moved(static_cast<int>(i)));
        return worst < 0.5;
    };
    run.advance(kLong, stands);
    trial.expectAtLeast("stands", run.time(), kLong, "s");
    trial.expectAtMost("largest move of a brick", worst, 0.01, "m");
}

/// What a step of the house costs, in steps of Bullet on the same machine: Box3D takes 5.5 ms where Bullet takes 10.1.
/// Seconds alternate, so that whatever else the machine does meets both.
void houseCost(Trial& trial) {
    const auto bullet = std::ranges::find(engineKinds(), "bullet", &EngineKind::name);
    if (!bullet->make) throw Missing("this program was built without Bullet, whose cost it is compared with");
    Trial peer({"", "", &*bullet, trial.dt(), {}});
    const Scene scene = loadScene(findScene("crash_unhit"));
    Run ours = trial.start(scene), theirs = peer.start(scene);
    for (int second = 0; second < 3; ++second) {
        ours.advance(1);
        theirs.advance(1);
    }
    trial.expectAtMost("cost over Bullet's", trial.cpuMs() / peer.cpuMs(), 5.5 / 10.1, "1");
}

}  // namespace stacks_cases
}  // namespace

Family stacks() {
    using namespace stacks_cases;
    Family family{"stack", {}};
    for (const int n : {10, 20, 40})
        family.cases.push_back({fmt::format("n={}", n), [n](Trial& trial) { stands(trial, {n}); }});
    family.cases.push_back({"n=100", [](Trial& trial) { standsAtAll(trial, {100}); }});
    for (const int n : {10, 40})
        family.cases.push_back({fmt::format("n={} of 0.05 m", n), [n](Trial& trial) { stands(trial, {n, 0.05f}); }});
    for (const float friction : {0.2f, 0.8f})
        family.cases.push_back({fmt::format("n=20, mu={}", friction), [friction](Trial& trial) {
                                    stands(trial, {20, 1, friction});
                                }});
    family.cases.push_back({"tallest", tallest, Kind::oneStep});
    family.cases.push_back({"house of crash", house, Kind::oneStep, false});
    family.cases.push_back({"house of crash, cost", houseCost, Kind::ragtopOnly, false});
    return family;
}

}  // namespace ragtop::stability
