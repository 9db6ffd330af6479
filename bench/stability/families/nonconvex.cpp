#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../../tests/core/mesh_bodies.h"
#include "../extremes.h"
#include "../families.h"
#include "../mesh_overlap.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace nonconvex_cases {

constexpr double kLong = 60;  ///< s
const Material kMaterial = surface(0.5f);
constexpr float kSteel = 7800;                                    ///< kg/m³
constexpr float kRing = 0.25f, kTube = 0.05f;                     ///< m, of tori
constexpr double kTaut = 2 * static_cast<double>(kRing - kTube);  ///< m, between rings of a chain

BodyDef dense(Shape shape, const DVec3& position, float density) {
    BodyDef def;
    def.shapes.push_back({.geometry = std::move(shape), .density = density, .material = kMaterial});
    def.pose.position = position;
    return def;
}

/// Bodies hang in each other, each in the one before: how long none leaves it, and how much farther apart two get than
/// when taut, which the surfaces of thin parts pay.
struct Hanging {
    double held = 0, apart = 0;  ///< s, m
};
Hanging hang(Run& run, const std::vector<double>& taut, double lost) {
    Hanging result;
    run.advance(kLong, [&] {
        for (int i = 1; i <= static_cast<int>(taut.size()); ++i) {
            const DVec3 d = run.position(i) - run.position(i - 1);
            result.apart = larger(result.apart, std::hypot(d.x, d.y, d.z) - taut[static_cast<std::size_t>(i - 1)]);
        }
        if (result.apart < lost) result.held = run.time();
        return result.apart < lost;
    });
    return result;
}

/// Every other ring of a chain is turned by a right angle; the first one is held. They begin a little slack, are let
/// fall into each other, and the last one is pushed aside at 1 m/s.
Scene chainOfTori(int links, float load, int seed) {
    constexpr double kSlack = 0.01;
    Scene scene;
    Dice dice(static_cast<std::uint64_t>(seed));
    const Shape ring = scenes::torus(kRing, kTube);
    add(scene, fixedBody(ring, {}, kMaterial));
    for (int i = 1; i <= links; ++i) {
        BodyDef link =
            dense(ring, DVec3{0, -(kTaut - kSlack) * i, 0} + jitter(dice, 0.002f), i == links ? load * kSteel : kSteel);
        if (i % 2 != 0) link.pose.rotation = rotationAbout({0, 1, 0}, kPi / 2);
        if (i == links) link.linearVelocity = {1, 0, 0.5f};
        add(scene, link);
    }
    return scene;
}

void tori(Trial& trial, int links, float load) {
    const std::vector<double> taut(static_cast<std::size_t>(links), kTaut);
    double apart = 0;
    int holding = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Run run = trial.start(chainOfTori(links, load, seed), fmt::format("{}", seed));
        const Hanging result = hang(run, taut, static_cast<double>(kTube));
        if (result.held >= kLong) ++holding;
        apart = larger(apart, result.apart);
    }
    trial.expectAtLeast(fmt::format("hold, of {}", trial.starts()), holding, trial.starts(), "chains");
    trial.expectAtMost("links apart beyond taut", apart, 0.01, "m");
}

/// S-hooks of steel rod hang in each other, with a torus of 96 kg on the last.
void hooks(Trial& trial, bool mesh) {
    constexpr float kBend = 0.1f, kRod = 0.02f;
    const std::vector<Vec3> curve = scenes::hookCurve(kBend);
    const Shape hook = mesh ? Shape{scenes::bentRod(curve, kRod)} : Shape{scenes::capsulesAlong(curve, kRod)};
    const double taut = 4 * static_cast<double>(kBend) - 2 * static_cast<double>(kRod), slack = 0.005;
    Scene scene;
    BodyDef top = fixedBody(hook, {}, kMaterial);
    add(scene, top);
    constexpr int kHooks = 4;
    for (int i = 1; i <= kHooks; ++i) {
        BodyDef def = dense(hook, {0, -(taut - slack) * i, 0}, kSteel);
        if (i % 2 != 0) def.pose.rotation = rotationAbout({0, 1, 0}, kPi / 2);
        add(scene, def);
    }
    // The ring hangs from the bottom of the last hook by the inside of its top.
    const double below =
        2 * static_cast<double>(kBend) - static_cast<double>(kRod) + static_cast<double>(kRing - kTube);
    BodyDef load = dense(scenes::torus(kRing, kTube), {0, -(taut - slack) * kHooks - below + slack, 0}, kSteel);
    load.pose.rotation = rotationAbout({0, 1, 0}, kPi / 2);
    add(scene, load);
    std::vector<double> tauts(kHooks, taut);
    tauts.push_back(below);
    Run run = trial.start(scene);
    const Hanging result = hang(run, tauts, static_cast<double>(kRod));
    trial.expectAtLeast("holds", result.held, kLong, "s");
    trial.expectAtMost("links apart beyond taut", result.apart, 0.01, "m");
}

/// A floor of bumps a quarter of a metre apart and rocks on it, between walls.
Scene rubble() {
    Scene scene;
    Dice dice(7);
    constexpr int kCells = 16;
    constexpr float kCell = 0.25f, kBump = 0.1f;
    std::vector<float> heights;
    for (int i = 0; i < (kCells + 1) * (kCells + 1); ++i) heights.push_back(dice.between(-kBump, kBump));
    const double half = 0.5 * kCells * static_cast<double>(kCell);
    add(scene, fixedBody(HeightField(kCells + 1, kCells + 1, kCell, heights), {-half, 0, -half}, kMaterial));
    for (const double side : {-1.0, 1.0}) {
        add(scene, fixedBody(Box{{0.5f, 5, 2.5f}}, {side * (half + 0.4), 4, 0}, kMaterial));
        add(scene, fixedBody(Box{{2.5f, 5, 0.5f}}, {0, 4, side * (half + 0.4)}, kMaterial));
    }
    for (int i = 0; i < 30; ++i) {
        BodyDef rock = fixedBody(
            Box{{dice.between(0.05f, 0.2f), dice.between(0.05f, 0.2f), dice.between(0.05f, 0.2f)}},
            {static_cast<double>(dice.between(-1.8f, 1.8f)), 0.05, static_cast<double>(dice.between(-1.8f, 1.8f))},
            kMaterial);
        rock.pose.rotation = dice.rotation();
        add(scene, rock);
    }
    return scene;
}

Shape anyShape(int i) {
    switch (i % 4) {
        case 0:
            return scenes::torus(0.2f, 0.05f, 20, 10);
        case 1:
            return scenes::angleIron(0.4f, 0.1f, 0.05f);
        case 2:
            return scenes::bentRod(scenes::hookCurve(0.12f), 0.03f);
        default:
            return Compound{{{Box{{0.2f, 0.05f, 0.05f}}, {{0.2f, 0.05f, 0}, {}}},
                             {Box{{0.05f, 0.15f, 0.05f}}, {{0.05f, 0.25f, 0}, {}}}}};
    }
}

/// What lies on rubble: overlaps, m, and what moves of it.
struct Heap {
    double p99 = 0, deepest = 0, energy = 0;  ///< the last one J/kg, mean
    double lost = 0;                          ///< bodies

    void keepWorse(const Heap& other) {
        p99 = larger(p99, other.p99), deepest = larger(deepest, other.deepest), energy = larger(energy, other.energy);
        lost = larger(lost, other.lost);
    }
};

/// Rings, angle irons and hooks, and angles of two boxes.
Heap drop(Trial& trial, int bodies, double seconds, int seed) {
    Scene scene = rubble();
    Dice dice(static_cast<std::uint64_t>(seed));
    const int first = static_cast<int>(scene.bodies.size());
    for (int i = 0; i < bodies; ++i) {
        const DVec3 at{0.7 * (i % 5 - 2), 0.6 + 0.6 * (i / 25), 0.7 * (i / 5 % 5 - 2)};
        BodyDef body = dense(anyShape(i), at + jitter(dice, 0.05f), 1000);
        body.pose.rotation = dice.rotation();
        add(scene, body);
    }
    Run run = trial.start(scene, fmt::format("{}", seed));
    run.advance(seconds);
    std::vector<double> depths = overlapsOf(run, first);
    std::ranges::sort(depths);
    Heap heap;
    if (!depths.empty()) heap.p99 = depths[(depths.size() - 1) * 99 / 100], heap.deepest = depths.back();
    for (int i = first; i < first + bodies; ++i) {
        const Vec3 v = run.motion(i).v;
        heap.energy += 0.5 * static_cast<double>(dot(v, v)) / bodies;
        if (!(run.height(i) >= -0.2)) ++heap.lost;
    }
    return heap;
}

void dropped(Trial& trial, int bodies, double seconds) {
    Heap worst;
    for (int seed = 1; seed <= trial.starts(); ++seed) worst.keepWorse(drop(trial, bodies, seconds, seed));
    trial.expectAtMost("overlap, 99th percentile", worst.p99, 0.01, "m");
    trial.expectAtMost("deepest overlap", worst.deepest, 0.02, "m");
    trial.expectAtMost("mean kinetic energy per mass", worst.energy, 0.001, "J/kg");
    trial.expectAtMost("fell through", worst.lost, 0, "bodies");
}

/// Rings, angle irons and hooks, or angles of two boxes, fly against sheets of a mesh, 4 cm thick, in lanes of their
/// own; half of the speed is the sheet's, where sheets move. What comes past the rim of its sheet is no longer looked
/// at.
void shots(Trial& trial, float speed, bool sheetsMove, bool compounds) {
    constexpr int kShots = 64;
    constexpr double kLane = 8;
    constexpr float kHalf = 1.5f;
    Scene scene;
    scene.settings.gravity = {};
    Dice dice(301);
    const Shape sheet = scenes::boxMesh({0.02f, kHalf, kHalf});
    const float share = sheetsMove ? 0.5f : 0.0f;
    for (int i = 0; i < kShots; ++i) {
        if (!sheetsMove) {
            add(scene, fixedBody(sheet, {0, 0, kLane * i}, kMaterial));
            continue;
        }
        BodyDef def = dense(sheet, {0, 0, kLane * i}, kSteel);
        def.bullet = true;
        def.linearVelocity = {-share * speed, 0, 0};
        add(scene, def);
    }
    for (int i = 0; i < kShots; ++i) {
        const double gap = static_cast<double>(speed) * trial.dt() * (1.2 + static_cast<double>(i) / kShots);
        BodyDef body = dense(anyShape(compounds ? 3 : i % 3), {-gap, 0, kLane * i}, 1000);
        body.pose.rotation = dice.rotation();
        body.bullet = true;
        body.linearVelocity = {(1 - share) * speed, 0, 0};
        body.angularVelocity = {dice.between(-20, 20), dice.between(-20, 20), dice.between(-20, 20)};
        add(scene, body);
    }
    Run run = trial.start(scene);
    std::vector<bool> gone(kShots), behind(kShots);
    run.advance(0.1, [&] {
        for (int i = 0; i < kShots; ++i) {
            const auto lane = static_cast<std::size_t>(i);
            const Vec3 at = inverseTransformPoint(run.motion(i).pose, run.centerOfMass(kShots + i));
            if (!gone[lane] && at.x > 0) behind[lane] = true;
            if (larger(std::abs(at.y), std::abs(at.z)) > kHalf - 0.3f) gone[lane] = true;
        }
        return true;
    });
    const auto passed = std::ranges::count(behind, true);
    trial.expectAtMost(fmt::format("passes of {}", kShots), static_cast<double>(passed), 0, "shots");
}

}  // namespace nonconvex_cases
}  // namespace

Family nonconvex() {
    using namespace nonconvex_cases;
    return {"nonconvex",
            {
                {"chain of 12 tori", [](Trial& trial) { tori(trial, 12, 1); }, Kind::ragtopOnly, false},
                {"chain of 12 tori, the last 10 times as heavy", [](Trial& trial) { tori(trial, 12, 10); },
                 Kind::ragtopOnly, false},
                {"hooks of mesh", [](Trial& trial) { hooks(trial, true); }, Kind::ragtopOnly},
                {"hooks of capsules", [](Trial& trial) { hooks(trial, false); }, Kind::ragtopOnly},
                {"100 bodies on rubble", [](Trial& trial) { dropped(trial, 100, 10); }, Kind::ragtopOnly, false},
                {"mesh at 300 m/s at a fixed mesh", [](Trial& trial) { shots(trial, 300, false, false); },
                 Kind::ragtopOnly},
                {"mesh at 300 m/s at a moving mesh", [](Trial& trial) { shots(trial, 300, true, false); },
                 Kind::ragtopOnly},
                {"compound at 300 m/s at a moving mesh", [](Trial& trial) { shots(trial, 300, true, true); },
                 Kind::ragtopOnly},
            }};
}

}  // namespace ragtop::stability
