#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"
#include "loops.h"

namespace ragtop::stability {
namespace {
namespace loops_cases {

/// A thin bar of 1 kg between two points; it collides with nothing.
int addBar(Scene& scene, const DVec3& from, const DVec3& to) {
    const DVec3 d = to - from;
    const double length = std::hypot(d.x, d.y, d.z);
    const float half = static_cast<float>(length / 2);
    BodyDef def = solidBody(Box{{half, 0.02f, 0.02f}}, 0.5 * (from + to), 1, {});
    def.pose.rotation = rotationBetween({1, 0, 0}, toVec3((1 / length) * d));
    def.shapes[0].filter.mask = 0;
    return add(scene, def);
}

struct Drift {
    double gap = 0, energy = 0;
};

Drift watch(Run& run, double seconds, double scale) {
    const double energy = run.energy();
    Drift drift;
    run.advance(seconds, [&] {
        drift.gap = larger(drift.gap, run.jointGap());
        drift.energy = larger(drift.energy, std::abs(run.energy() - energy) / scale);
        return drift.gap < 1;
    });
    return drift;
}

void expectDrift(Trial& trial, const Drift& drift) {
    trial.expectAtMost("gap", drift.gap, 1e-4, "m");
    trial.expectAtMost("energy", drift.energy, 0.01, "1");
}

/// Windows of bars of 1 m in a row, pushed aside with 1 m/s: in each swing all bars lie on one line, where the
/// mechanism could go on in several ways [IFToMM benchmark library, N-four-bar]. Energy is compared with the kinetic
/// one at first.
void fourBar(Trial& trial, int windows) {
    Scene scene;
    std::vector<int> posts, beams;
    const auto foot = [](int i) { return DVec3{static_cast<double>(i), 0, 0}; };
    const auto head = [](int i) { return DVec3{static_cast<double>(i), 1, 0}; };
    for (int i = 0; i <= windows; ++i) posts.push_back(addBar(scene, foot(i), head(i)));
    for (int i = 0; i < windows; ++i) beams.push_back(addBar(scene, head(i), head(i + 1)));
    for (int i = 0; i <= windows; ++i) {
        const int post = posts[static_cast<std::size_t>(i)];
        addHinge(scene, kWorld, post, foot(i), {0, 0, 1});
        if (i < windows) addHinge(scene, post, beams[static_cast<std::size_t>(i)], head(i), {0, 0, 1});
        if (i > 0) addHinge(scene, beams[static_cast<std::size_t>(i - 1)], post, head(i), {0, 0, 1});
    }
    for (const int post : posts) {
        scene.bodies[static_cast<std::size_t>(post)].def.linearVelocity = {0.5f, 0, 0};
        scene.bodies[static_cast<std::size_t>(post)].def.angularVelocity = {0, 0, -1};
    }
    for (const int beam : beams) scene.bodies[static_cast<std::size_t>(beam)].def.linearVelocity = {1, 0, 0};
    Run run = trial.start(scene);
    // From upright to hanging every post falls by 1 m and every beam by 2 m.
    expectDrift(trial, watch(run, 60, kGravity * (windows + 1 + 2 * windows)));
}

/// Six bars along the edges of a cube, on six hinges, one bar fixed: seven constraints too many, yet it moves
/// [Bricard 1897; IFToMM benchmark library].
void bricard(Trial& trial) {
    const std::array<DVec3, 6> corners{DVec3{1, 0, 0}, DVec3{1, 1, 0}, DVec3{0, 1, 0},
                                       DVec3{0, 1, 1}, DVec3{0, 0, 1}, DVec3{1, 0, 1}};
    Scene scene;
    std::vector<int> bars;
    for (std::size_t i = 0; i < 6; ++i) {
        const int bar = addBar(scene, corners[i], corners[(i + 1) % 6]);
        if (i == 0) scene.bodies[static_cast<std::size_t>(bar)].def.type = BodyType::fixed;
        bars.push_back(bar);
    }
    for (std::size_t i = 0; i < 6; ++i) {
        const std::size_t next = (i + 1) % 6, after = (i + 2) % 6;
        const Vec3 before = toVec3(corners[next] - corners[i]), behind = toVec3(corners[after] - corners[next]);
        addHinge(scene, bars[i], bars[next], corners[next], cross(before, behind));
    }
    Run run = trial.start(scene);
    double farthest = 0;
    const double energy = run.energy();
    Drift drift;
    run.advance(60, [&] {
        drift.gap = larger(drift.gap, run.jointGap());
        drift.energy = larger(drift.energy, std::abs(run.energy() - energy) / (5 * kGravity));
        farthest = larger(farthest, run.moved(bars[3]));
        return drift.gap < 1;
    });
    expectDrift(trial, drift);
    trial.expectAtLeast("moves", farthest, 0.5, "m");
}

/// The squeezer mechanism of Andrews and Manning in ten times its size, of thin bars, under gravity instead of its
/// spring and motor: seven bodies, ten hinges, three loops, one degree of freedom [Hairer, Wanner, Solving ODEs II,
/// VII.7; IFToMM benchmark library].
void andrews(Trial& trial) {
    const auto polar = [](double length, double angle) {
        return DVec3{length * std::cos(angle), length * std::sin(angle), 0};
    };
    // Feet and start as published.
    const DVec3 o{}, a{-0.6934, -0.0227, 0}, b{-0.3635, 0.3273, 0};
    const double beta = -0.0617138900142764, delta = 0.4873649795438426, epsilon = 1.2305474445498212;
    const DVec3 f = polar(0.07, beta), e = f - polar(0.28, beta), g = a + polar(0.4, delta),
                h = a + polar(0.4, epsilon - std::numbers::pi / 2);
    Scene scene;
    const auto pin = [&](int first, int second, const DVec3& at) { addHinge(scene, first, second, at, {0, 0, 1}); };
    const int crank = addBar(scene, o, f), rod = addBar(scene, f, e), lever = addBar(scene, b, e);
    const int upper = addBar(scene, a, g), upperRod = addBar(scene, g, e);
    const int lower = addBar(scene, a, h), lowerRod = addBar(scene, h, e);
    pin(kWorld, crank, o), pin(kWorld, lever, b), pin(kWorld, upper, a), pin(kWorld, lower, a);
    pin(crank, rod, f), pin(upper, upperRod, g), pin(lower, lowerRod, h);
    for (const int bar : {rod, upperRod, lowerRod}) pin(bar, lever, e);
    Run run = trial.start(scene);
    double highest = -9, lowest = 9;
    const double energy = run.energy();
    Drift drift;
    run.advance(60, [&] {
        drift.gap = larger(drift.gap, run.jointGap());
        drift.energy = larger(drift.energy, std::abs(run.energy() - energy));
        double height = 0;
        for (int bar = 0; bar < 7; ++bar) height += run.height(bar);
        highest = larger(highest, height);
        lowest = smaller(lowest, height);
        return drift.gap < 1;
    });
    drift.energy /= kGravity * (highest - lowest);
    expectDrift(trial, drift);
    trial.expectAtLeast("falls by", highest - lowest, 0.1, "m");
}

/// A door of 2 m × 1 m and 20 kg on hinges on one line.
struct Door {
    static constexpr double kMass = 20, kReach = 0.5;  ///< kg; m from the hinges to its centre of mass
    int hinges = 2;

    double height(int hinge) const { return 0.2 + 1.6 * hinge / (hinges - 1); }
    Scene scene(float spin) const {
        Scene scene;
        BodyDef def = solidBody(Box{{0.5f, 1, 0.02f}}, {kReach, 1, 0}, static_cast<float>(kMass), {});
        def.angularVelocity = {0, spin, 0};
        def.linearVelocity = {0, 0, static_cast<float>(-kReach) * spin};
        const int body = add(scene, def);
        for (int i = 0; i < hinges; ++i) addHinge(scene, kWorld, body, {0, height(i), 0}, {0, 1, 0});
        return scene;
    }
};

/// Swinging it neither slows down nor sags.
void swings(Trial& trial, const Door& door) {
    constexpr float kSpin = 2;
    Run run = trial.start(door.scene(kSpin));
    double gap = 0;
    run.advance(60, [&] {
        gap = larger(gap, run.jointGap());
        return gap < 1;
    });
    trial.expectAtMost("gap", gap, 1e-4, "m");
    trial.expectNear("spin after a minute", static_cast<double>(run.motion(0).w.y), kSpin, 0.005 * kSpin, "rad/s");
}

/// At rest its hinges bear together what statics ask, and equal hinges bear equal shares of the weight: of all the
/// ways that a rigid door may load more than one hinge, the one of any equal give.
void hangs(Trial& trial, const Door& door) {
    Run run = trial.start(door.scene(0));
    run.advance(2);
    std::vector<DVec3> forces(static_cast<std::size_t>(door.hinges));
    double moment = 0;
    int steps = 0;
    run.advance(1, [&] {
        for (int i = 0; i < door.hinges; ++i) {
            const Reaction reaction = run.engine().reaction(i);
            const DVec3 force{reaction.force};
            forces[static_cast<std::size_t>(i)] = forces[static_cast<std::size_t>(i)] + force;
            moment += static_cast<double>(reaction.torque.z) - force.x * door.height(i);
        }
        ++steps;
        return true;
    });
    const double weight = kGravity * Door::kMass, share = weight / door.hinges;
    DVec3 sum;
    double unequal = 0;
    for (DVec3& force : forces) {
        force = (1.0 / steps) * force;
        sum = sum + force;
        unequal = larger(unequal, std::abs(force.y - share));
    }
    trial.expectNear("loads together", sum.y, weight, 0.01 * weight, "N");
    trial.expectAtMost("pull together", std::hypot(sum.x, sum.z), 0.01 * weight, "N");
    trial.expectNear("moment", moment / steps, weight * Door::kReach, 0.01 * weight * Door::kReach, "N m");
    trial.expectAtMost("a hinge off its share", unequal, 0.01 * share, "N");
}

}  // namespace loops_cases
}  // namespace

Family loops() {
    using namespace loops_cases;
    Family family{"loops", {}};
    for (const int windows : {1, 4, 10})
        family.cases.push_back(
            {fmt::format("four-bar, {} windows", windows), [windows](Trial& trial) { fourBar(trial, windows); }});
    family.cases.push_back({"Bricard", bricard});
    family.cases.push_back({"Andrews", andrews});
    addSqueezerCases(family);
    for (const int hinges : {2, 3, 4}) {
        const Door door{hinges};
        family.cases.push_back({fmt::format("door on {} hinges", hinges), [door](Trial& t) { swings(t, door); }});
        family.cases.push_back({fmt::format("loads of {} hinges", hinges), [door](Trial& t) { hangs(t, door); }});
    }
    return family;
}

}  // namespace ragtop::stability
