#include <fmt/format.h>

#include <cmath>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace overlaps_cases {

const Material kMaterial = surface(0.5f);

int addCube(Scene& scene, const DVec3& middle, float mass = 1) {
    return add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, middle, mass, kMaterial));
}

/// Follows a body that begins too deep: how far it flies above its rest, and what is left after half a second.
void expectRecovery(Trial& trial, const Scene& scene, int body, double rest) {
    Run run = trial.start(scene);
    double highest = -INFINITY, left = INFINITY;
    const auto half = std::lround(0.5 / trial.dt());
    long steps = 0;
    run.advance(3, [&] {
        highest = larger(highest, run.height(body));
        if (++steps == half) left = std::abs(run.height(body) - rest);
        return true;
    });
    trial.expectAtMost("overshoot", larger(0.0, highest - rest), 0.01, "m");
    trial.expectAtMost("off its rest after 0.5 s", left, 0.01, "m");
}

void intoFloor(Trial& trial, double depth) {
    Scene scene;
    addFloor(scene, kMaterial);
    const int box = addCube(scene, {0, 0.5 - depth, 0});
    expectRecovery(trial, scene, box, 0.5);
}

void intoBox(Trial& trial, double depth) {
    Scene scene;
    addFloor(scene, kMaterial);
    addCube(scene, {0, 0.5, 0});
    const int box = addCube(scene, {0, 1.5 - depth, 0});
    expectRecovery(trial, scene, box, 1.5);
}

/// Four rows, each a quarter of a box too deep in the one below: no jump, and it must stand afterwards.
void pyramid(Trial& trial) {
    constexpr int kRows = 4;
    Scene scene;
    addFloor(scene, kMaterial);
    int top = 0;
    for (int row = 0; row < kRows; ++row)
        for (int i = 0; i < kRows - row; ++i) top = addCube(scene, {1.1 * (i + 0.5 * row), 0.5 - 0.25 + 0.75 * row, 0});
    const double rest = kRows - 0.5;
    Run run = trial.start(scene);
    double highest = 0;
    run.advance(5, [&] {
        highest = larger(highest, run.height(top));
        return true;
    });
    trial.expectAtMost("overshoot", larger(0.0, highest - rest), 0.01, "m");
    trial.expectNear("height of the top after 5 s", run.height(top), rest, 0.01, "m");
}

/// A weight of 100 boxes is taken from a pile that has borne it for two seconds.
void capGone(Trial& trial) {
    Scene scene;
    addFloor(scene, kMaterial);
    for (int i = 0; i < 3; ++i) addCube(scene, {0, i + 0.5, 0});
    const int cap = addCube(scene, {0, 3.5, 0}, 100);
    Run run = trial.start(scene);
    run.advance(2);
    run.remove(cap);
    double highest = 0, fastest = 0;
    run.advance(3, [&] {
        highest = larger(highest, run.height(cap - 1));
        fastest = larger(fastest, static_cast<double>(run.motion(cap - 1).v.y));
        return true;
    });
    trial.expectAtMost("overshoot", larger(0.0, highest - 2.5), 0.01, "m");
    // Half a metre of overlap in half a second needs 1 m/s; a pile that was not overlapping needs none of it.
    trial.expectAtMost("speed upwards", fastest, 1, "m/s");
}

}  // namespace overlaps_cases
}  // namespace

Family overlaps() {
    using namespace overlaps_cases;
    Family family{"overlap", {}};
    for (const double depth : {0.1, 0.5, 0.9}) {
        family.cases.push_back(
            {fmt::format("{} m in the floor", depth), [depth](Trial& trial) { intoFloor(trial, depth); }});
        family.cases.push_back({fmt::format("{} m in a box", depth), [depth](Trial& trial) { intoBox(trial, depth); }});
    }
    family.cases.push_back({"0.4 m in a box", [](Trial& trial) { intoBox(trial, 0.4); }});
    family.cases.push_back({"pyramid at a quarter", pyramid});
    family.cases.push_back({"cap taken off", capGone});
    return family;
}

}  // namespace ragtop::stability
