#include <cmath>
#include <numbers>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace mechanisms_cases {

/// Fifteen parts on balls and hinges, thrown: nothing from outside but gravity.
void thrown(Trial& trial) {
    Scene scene;
    Dice dice(15);
    const auto limb = [&](int parent, const DVec3& at, const DVec3& joint, bool hinged) {
        BodyDef def = solidBody(Box{{0.06f, 0.15f, 0.05f}}, at, dice.between(1, 4), {});
        def.shapes[0].filter.mask = 0;
        def.linearVelocity = {2, 3, 1};
        def.angularVelocity = {dice.between(-3, 3), dice.between(-3, 3), dice.between(-3, 3)};
        const int body = add(scene, def);
        if (parent >= 0 && hinged) addHinge(scene, parent, body, joint, {0, 0, 1});
        if (parent >= 0 && !hinged) addBall(scene, parent, body, joint);
        return body;
    };
    const int chest = limb(-1, {0, 0, 0}, {}, false), belly = limb(chest, {0, -0.4, 0}, {0, -0.2, 0}, false);
    const int hips = limb(belly, {0, -0.8, 0}, {0, -0.6, 0}, false);
    limb(chest, {0, 0.4, 0}, {0, 0.2, 0}, false);
    for (const double side : {-1.0, 1.0}) {
        const int arm = limb(chest, {0.3 * side, 0, 0}, {0.3 * side, 0.15, 0}, false);
        const int fore = limb(arm, {0.3 * side, -0.35, 0}, {0.3 * side, -0.17, 0}, true);
        limb(fore, {0.3 * side, -0.7, 0}, {0.3 * side, -0.52, 0}, false);
        const int thigh = limb(hips, {0.15 * side, -1.2, 0}, {0.15 * side, -1, 0}, false);
        const int shank = limb(thigh, {0.15 * side, -1.55, 0}, {0.15 * side, -1.37, 0}, true);
        if (side > 0) limb(shank, {0.15 * side, -1.9, 0}, {0.15 * side, -1.72, 0}, false);
    }
    Run run = trial.start(scene);
    const auto parts = static_cast<int>(scene.bodies.size());
    struct Whole {
        double mass = 0, arms = 0;
        DVec3 center, speed, spin;
    };
    const auto whole = [&] {
        Whole sum;
        for (int i = 0; i < parts; ++i) {
            const double m = static_cast<double>(massOf(scene.bodies[static_cast<std::size_t>(i)].def).mass);
            sum.mass += m;
            sum.center = sum.center + m * run.centerOfMass(i);
            sum.speed = sum.speed + m * DVec3(run.motion(i).v);
        }
        sum.center = (1 / sum.mass) * sum.center;
        sum.speed = (1 / sum.mass) * sum.speed;
        for (int i = 0; i < parts; ++i) {
            const double m = static_cast<double>(massOf(scene.bodies[static_cast<std::size_t>(i)].def).mass);
            const DVec3 x = run.centerOfMass(i) - sum.center, v = DVec3(run.motion(i).v) - sum.speed;
            const DVec3 l = m * DVec3{x.y * v.z - x.z * v.y, x.z * v.x - x.x * v.z, x.x * v.y - x.y * v.x};
            const DVec3 own = run.angularMomentum(i);
            sum.spin = sum.spin + l + own;
            sum.arms += std::hypot(l.x + own.x, l.y + own.y, l.z + own.z);
        }
        return sum;
    };
    const Whole before = whole();
    run.advance(5);
    const Whole after = whole();
    const double t = run.time();
    const DVec3 exact = before.center + t * before.speed + DVec3{0, -0.5 * kGravity * t * t, 0};
    const DVec3 off = after.center - exact, dl = after.spin - before.spin;
    trial.expectAtMost("angular momentum", std::hypot(dl.x, dl.y, dl.z) / before.arms, 1e-5, "1");
    trial.expectAtMost("parabola", std::hypot(off.x, off.y, off.z), 1e-3, "m");
}

/// Two rods one below the other, let go from the side.
void doublePendulum(Trial& trial) {
    Scene scene;
    const int first = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {}));
    const int second = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {1.5, 0, 0}, 1, {}));
    addHinge(scene, kWorld, first, {}, {0, 0, 1});
    addHinge(scene, first, second, {1, 0, 0}, {0, 0, 1});
    Run run = trial.start(scene);
    const double energy = run.energy(), swing = 4 * kGravity;  // J, between level and hanging
    double worst = 0, gap = 0;
    run.advance(60, [&] {
        worst = larger(worst, std::abs(run.energy() - energy));
        gap = larger(gap, run.jointGap());
        return true;
    });
    trial.expectAtMost("energy", worst / swing, 1e-3, "1");
    trial.expectAtMost("gap", gap, 1e-3, "m");
}

/// A bob on a massless arm goes round a circle: cos θ = g/(ω² l).
void conicalPendulum(Trial& trial) {
    constexpr double kLength = 1, kTilt = 0.6;
    Scene scene;
    const DVec3 at{kLength * std::sin(kTilt), -kLength * std::cos(kTilt), 0};
    const double omega = std::sqrt(kGravity / (kLength * std::cos(kTilt)));
    BodyDef def = bodyWithMass(Sphere{0.05f}, at, 1, {1e-4f, 1e-4f, 1e-4f}, {});
    def.linearVelocity = {0, 0, static_cast<float>(-omega * at.x)};
    def.angularVelocity = {0, static_cast<float>(omega), 0};
    const int body = add(scene, def);
    addBall(scene, kWorld, body, {});
    Run run = trial.start(scene);
    const double energy = run.energy(), drop = kGravity * kLength * (1 - std::cos(kTilt));
    double worst = 0, turned = 0, before = 0;
    run.advance(60, [&] {
        worst = larger(worst, std::abs(run.energy() - energy));
        const DVec3 p = run.position(body);
        const double angle = std::atan2(-p.z, p.x);
        turned += std::remainder(angle - before, 2 * std::numbers::pi);
        before = angle;
        return true;
    });
    trial.expectAtMost("energy", worst / drop, 1e-3, "1");
    const double period = 2 * std::numbers::pi / omega;
    trial.expectNear("period", 2 * std::numbers::pi * run.time() / turned, period, 1e-3 * period, "s");
}

/// A bob that swings and circles at once: the cosine c of its angle from the vertical swings between two roots of
/// ċ² = (1 − c²)(2 E + 2 m g l c)/J − (L/J)² = k (c − c₁)(c₂ − c)(c − c₃), while it turns at L/(J (1 − c²)). Both
/// integrals are of smooth periodic functions of ψ, c = (c₁ + c₂)/2 + (c₂ − c₁)/2 cos ψ, so that a plain sum is exact.
struct SphericalPendulum {
    static constexpr double kLength = 1, kMass = 1, kMoment = 1e-4;  ///< m, kg, kg m² of the bob about itself
    static constexpr double kAngle = 1, kTurn = 1.5;  ///< rad and rad/s, at the start, where it is highest
    double period = 0, advance = 0;                   ///< s, rad from one highest place to the next

    static constexpr double inertia() { return kMoment + kMass * kLength * kLength; }
    static double momentum() { return inertia() * std::sin(kAngle) * std::sin(kAngle) * kTurn; }

    SphericalPendulum() {
        const double first = std::cos(kAngle), k = 2 * kMass * kGravity * kLength / inertia();
        const double spin = momentum() / inertia();
        const double e = spin * kTurn - k * first;
        const double sum = -e / k - first, product = -1 - first * sum;
        const double root = std::sqrt(sum * sum / 4 - product);
        const double second = sum / 2 + root, third = sum / 2 - root;
        constexpr int kPoints = 64;
        for (int i = 0; i < kPoints; ++i) {
            const double psi = std::numbers::pi * (i + 0.5) / kPoints;
            const double c = (first + second) / 2 + (second - first) / 2 * std::cos(psi);
            const double time = 2 * std::numbers::pi / kPoints / std::sqrt(k * (c - third));
            period += time;
            advance += spin / (1 - c * c) * time;
        }
    }
};

void sphericalPendulum(Trial& trial) {
    using P = SphericalPendulum;
    const P exact;
    Scene scene;
    const DVec3 at{P::kLength * std::sin(P::kAngle), -P::kLength * std::cos(P::kAngle), 0};
    const float moment = static_cast<float>(P::kMoment);
    BodyDef def = bodyWithMass(Sphere{0.05f}, at, static_cast<float>(P::kMass), {moment, moment, moment}, {});
    // Across its arm, so that the bob does not spin about it.
    const DVec3 v{0, 0, -P::kTurn * at.x};
    def.linearVelocity = toVec3(v);
    def.angularVelocity = (1 / static_cast<float>(P::kLength * P::kLength)) * cross(toVec3(at), toVec3(v));
    const int body = add(scene, def);
    addBall(scene, kWorld, body, {});
    Run run = trial.start(scene);
    const double energy = run.energy(), drop = kGravity * P::kLength * P::kMass * (1 - std::cos(P::kAngle));
    const auto momentum = [&] {
        const DVec3 x = run.position(body), w{run.motion(body).v};
        return P::kMass * (x.z * w.x - x.x * w.z) + run.angularMomentum(body).y;
    };
    double energyError = 0, momentumError = 0, turned = 0, heading = 0, rising = 0;
    double firstTime = 0, firstTurn = 0, lastTime = 0, lastTurn = 0;
    int tops = -1;
    run.advance(60, [&] {
        const BodyMotion m = run.motion(body);
        const double next = std::atan2(-m.pose.position.z, m.pose.position.x);
        const double turn = std::remainder(next - heading, 2 * std::numbers::pi);
        const double now = static_cast<double>(m.v.y);
        energyError = larger(energyError, std::abs(run.energy() - energy));
        momentumError = larger(momentumError, std::abs(momentum() - P::momentum()));
        turned += turn;
        if (rising > 0 && !(now > 0)) {
            const double back = now / (now - rising);
            lastTime = run.time() - back * trial.dt(), lastTurn = turned - back * turn;
            if (++tops == 0) firstTime = lastTime, firstTurn = lastTurn;
        }
        rising = now, heading = next;
        return true;
    });
    trial.expectAtMost("energy", energyError / drop, 1e-3, "1");
    trial.expectAtMost("angular momentum", momentumError / P::momentum(), 1e-3, "1");
    trial.expectNear("period", (lastTime - firstTime) / tops, exact.period, 1e-3 * exact.period, "s");
    trial.expectNear("turn in a period", (lastTurn - firstTurn) / tops, exact.advance, 1e-3 * exact.advance, "rad");
}

/// Two wheels that mesh, for ten thousand turns of the first: it keeps its speed, and the other one keeps to it as well
/// at the end as it did once both had come to speed.
void gears(Trial& trial) {
    constexpr float kRatio = -17.0f / 41, kSpeed = 100;
    constexpr double kTurns = 1e4, kSome = 100;
    Scene scene;
    scene.settings.gravity = {};
    for (const double x : {0.0, 1.0}) {
        const int wheel = add(scene, bodyWithMass(Sphere{0.2f}, {x, 0, 0}, 1, {0.1f, 0.1f, 0.1f}, {}));
        HingeDef& hinge = addHinge(scene, kWorld, wheel, {x, 0, 0}, {0, 0, 1});
        if (wheel == 0) hinge.motor = Motor{kSpeed, 100};
    }
    SceneCoupling mesh{"", {1, 0}, gear({}, {}, kRatio)};
    scene.couplings.push_back(mesh);
    Run run = trial.start(scene);
    double turned[2] = {}, before[2] = {}, off = 0;
    const auto meanOver = [&](double turns) {
        double sum = 0;
        int steps = 0;
        run.advance(2 * std::numbers::pi * turns / static_cast<double>(kSpeed), [&] {
            for (int i = 0; i < 2; ++i) {
                const Quat q = run.motion(i).pose.rotation;
                const double angle = 2 * std::atan2(static_cast<double>(q.z), static_cast<double>(q.w));
                turned[i] += std::remainder(angle - before[i], 2 * std::numbers::pi);
                before[i] = angle;
            }
            off = turned[1] - static_cast<double>(kRatio) * turned[0];
            sum += off;
            ++steps;
            return true;
        });
        return sum / steps;
    };
    meanOver(kSome);
    const double first = meanOver(kSome);
    meanOver(kTurns - 3 * kSome);
    const double last = meanOver(kSome);
    trial.expectNear("turns", turned[0] / (2 * std::numbers::pi), kTurns, 0.001 * kTurns, "1");
    trial.expectAtMost("off its ratio", off, 1e-4, "rad");
    trial.expectAtMost("drift over 10,000 turns", last - first, 1e-6, "rad");
}

/// A nut on a thread of lead angle atan 0.2.
void worm(Trial& trial, float friction) {
    constexpr float kRadius = 0.05f, kLead = 0.2f;
    Scene scene;
    const int nut = add(scene, bodyWithMass(Sphere{0.1f}, {}, 2, {0.01f, 0.01f, 0.01f}, {}));
    ScrewDef screw;
    screw.bodies = jointFrames(scene, kWorld, nut, {}, {0, 1, 0});
    screw.pitch = kLead * 2 * std::numbers::pi_v<float> * kRadius;
    screw.turn.bearing = Bearing{0, 0, friction, kRadius};
    scene.joints.push_back({"", kWorld, nut, screw});
    Run run = trial.start(scene);
    run.advance(0.5);
    const double from = run.height(nut);
    run.advance(4);
    const double sunk = from - run.height(nut);
    if (friction > kLead)
        trial.expectAtMost("sinks", sunk, 1e-5, "m");
    else
        trial.expectAtLeast("sinks", sunk, 1e-2, "m");
}

}  // namespace mechanisms_cases
}  // namespace

Family mechanisms() {
    using namespace mechanisms_cases;
    return {"mechanisms",
            {
                {"fifteen parts thrown", thrown},
                {"double pendulum", doublePendulum},
                {"conical pendulum", conicalPendulum},
                {"spherical pendulum", sphericalPendulum},
                {"gears", gears},
                {"worm below the friction angle", [](Trial& trial) { worm(trial, 0.21f); }},
                {"worm above the friction angle", [](Trial& trial) { worm(trial, 0.19f); }},
            }};
}

}  // namespace ragtop::stability
