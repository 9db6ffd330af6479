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

constexpr double kLong = 60;  ///< s
const Material kMaterial = surface(0.5f);
constexpr float kSteel = 7800;  ///< kg/m³

BodyDef dense(Shape shape, const DVec3& position, float density) {
    BodyDef def;
    def.shapes.push_back({.geometry = std::move(shape), .density = density, .material = kMaterial});
    def.pose.position = position;
    return def;
}

/// Bodies hang in each other, each in the one before: how long none leaves it, and how much farther apart two get than
/// when taut, which the surfaces of thin parts pay.
void expectHangs(Trial& trial, const Scene& scene, const std::vector<double>& taut, double lost) {
    Run run = trial.start(scene);
    double worst = 0, held = 0;
    run.advance(kLong, [&] {
        for (int i = 1; i <= static_cast<int>(taut.size()); ++i) {
            const DVec3 d = run.position(i) - run.position(i - 1);
            worst = larger(worst, std::hypot(d.x, d.y, d.z) - taut[static_cast<std::size_t>(i - 1)]);
        }
        if (worst < lost) held = run.time();
        return worst < lost;
    });
    trial.expectAtLeast("holds", held, kLong, "s");
    trial.expectAtMost("links apart beyond taut", worst, 0.01, "m");
}

/// Every other ring of a chain is turned by a right angle; the first one is held. They begin a little slack, are let
/// fall into each other, and the last one is pushed aside at 1 m/s.
void chainOfTori(Trial& trial, int links, float load) {
    constexpr float kRing = 0.25f, kTube = 0.05f;
    Scene scene;
    Dice dice(static_cast<std::uint64_t>(links));
    const Shape ring = scenes::torus(kRing, kTube);
    const double taut = 2 * static_cast<double>(kRing - kTube), slack = 0.01;
    add(scene, fixedBody(ring, {}, kMaterial));
    for (int i = 1; i <= links; ++i) {
        BodyDef link =
            dense(ring, DVec3{0, -(taut - slack) * i, 0} + jitter(dice, 0.002f), i == links ? load * kSteel : kSteel);
        if (i % 2 != 0) link.pose.rotation = rotationAbout({0, 1, 0}, kPi / 2);
        if (i == links) link.linearVelocity = {1, 0, 0.5f};
        add(scene, link);
    }
    expectHangs(trial, scene, std::vector<double>(static_cast<std::size_t>(links), taut), static_cast<double>(kTube));
}

/// S-hooks of steel rod hang in each other, with a torus of 96 kg on the last.
void hooks(Trial& trial, bool mesh) {
    constexpr float kBend = 0.1f, kRod = 0.02f, kRing = 0.25f, kTube = 0.05f;
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
    expectHangs(trial, scene, tauts, static_cast<double>(kRod));
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

/// Rings, angle irons and hooks, and angles of two boxes.
void dropped(Trial& trial, int bodies, double seconds) {
    Scene scene = rubble();
    Dice dice(100);
    const int first = static_cast<int>(scene.bodies.size());
    for (int i = 0; i < bodies; ++i) {
        const DVec3 at{0.7 * (i % 5 - 2), 0.6 + 0.6 * (i / 25), 0.7 * (i / 5 % 5 - 2)};
        BodyDef body = dense(anyShape(i), at + jitter(dice, 0.05f), 1000);
        body.pose.rotation = dice.rotation();
        add(scene, body);
    }
    Run run = trial.start(scene);
    run.advance(seconds);
    std::vector<double> depths = overlapsOf(run, first);
    std::ranges::sort(depths);
    const double p99 = depths.empty() ? 0 : depths[(depths.size() - 1) * 99 / 100];
    trial.expectAtMost("overlap, 99th percentile", p99, 0.01, "m");
    trial.expectAtMost("deepest overlap", depths.empty() ? 0 : depths.back(), 0.02, "m");
    double energy = 0;
    int lost = 0;
    for (int i = first; i < first + bodies; ++i) {
        const Vec3 v = run.motion(i).v;
        energy += 0.5 * static_cast<double>(dot(v, v));
        if (run.height(i) < -0.2) ++lost;
    }
    trial.expectAtMost("mean kinetic energy per mass", energy / bodies, 0.001, "J/kg");
    trial.expectAtMost("fell through", lost, 0, "bodies");
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

}  // namespace

Family nonconvex() {
    return {"nonconvex",
            {
                {"chain of 12 tori", [](Trial& trial) { chainOfTori(trial, 12, 1); }, Kind::ragtopOnly, false},
                {"chain of 12 tori, the last 10 times as heavy", [](Trial& trial) { chainOfTori(trial, 12, 10); },
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
