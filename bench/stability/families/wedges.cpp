#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../limit_analysis.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace wedges_cases {

constexpr double kDepth = 0.4;  ///< m, of everything along z

/// Half the width of a wedge at height y above its middle, on the left and on the right; it is 1 m high.
struct Taper {
    double left = 0, right = 0;  ///< rad, of the faces from the vertical

    double leftAt(double y) const { return 0.5 + y * std::tan(left); }
    double rightAt(double y) const { return 0.5 + y * std::tan(right); }
};

ConvexHull prism(const std::vector<DVec3>& corners) {
    std::vector<Vec3> points;
    for (const DVec3& corner : corners)
        for (const double z : {-kDepth / 2, kDepth / 2}) points.push_back(toVec3(DVec3{corner.x, corner.y, z}));
    return ConvexHull{points};
}

ConvexHull wedge(const Taper& t) {
    return prism(
        {{-t.leftAt(-0.5), -0.5, 0}, {t.rightAt(-0.5), -0.5, 0}, {t.rightAt(0.5), 0.5, 0}, {-t.leftAt(0.5), 0.5, 0}});
}

/// A jaw beside a face that leans by `angle`, 1.6 m high, reaching 1 m out; `side` is −1 on the left.
ConvexHull jaw(double angle, double side) {
    const double slope = std::tan(angle);
    const auto face = [&](double y) { return side * (0.5 + y * slope); };
    return prism({{face(-0.8), -0.8, 0}, {face(0.8), 0.8, 0}, {side * 2, 0.8, 0}, {side * 2, -0.8, 0}});
}

struct Press {
    Scene scene;
    int left = 0, right = 0, middle = 0;
};

/// Something of 1 kg between two jaws of 1 kg that slide along x.
Press pressOf(const Taper& taper, const ConvexHull& middle, float friction) {
    Press press;
    const Material material = surface(friction);
    const auto addJaw = [&](double angle, double side) {
        const int body = add(press.scene, solidBody(jaw(angle, side), {}, 1, material));
        addSlider(press.scene, kWorld, body, {}, {1, 0, 0});
        return body;
    };
    press.left = addJaw(taper.left, -1);
    press.right = addJaw(taper.right, 1);
    press.middle = add(press.scene, solidBody(middle, {}, 1, material));
    return press;
}

/// Squeezed with `force` on both sides for so long, how far the middle has gone up or down.
double squeeze(Run& run, const Press& press, double force, double seconds) {
    const auto count = std::lround(seconds / run.dt());
    const Vec3 push = toVec3(DVec3{force, 0, 0});
    for (long i = 0; i < count && run.moved(press.middle) < 0.1; ++i) {
        run.engine().push(press.left, push, run.position(press.left));
        run.engine().push(press.right, -push, run.position(press.right));
        run.step();
    }
    return run.moved(press.middle);
}

/// A plank between two pistons holds when F ≥ m g/(2 μ).
void plank(Trial& trial) {
    constexpr double kMu = 0.5, kExact = kGravity / (2 * kMu);
    const auto holds = [&](double force) {
        const Press press = pressOf({}, wedge({}), static_cast<float>(kMu));
        Run run = trial.start(press.scene, fmt::format("{:.3f} N", force));
        return squeeze(run, press, force, 3) < 0.05;
    };
    trial.expectNear("critical force", bisect(1.5 * kExact, 0.7 * kExact, 5e-3, holds), kExact, 0.02 * kExact, "N");
}

/// The least friction that keeps a wedge squeezed by two equal forces from popping out, by the linear program.
double limitFriction(const Taper& taper, double force) {
    LimitAnalysis limit;
    const int block = limit.addBlock(0, {});
    const auto addFace = [&](double angle, double side) {
        const DVec3 normal{-side * std::cos(angle), std::sin(angle), 0};
        const double slope = std::tan(angle);
        std::vector<DVec3> points;
        for (const double y : {-0.5, 0.5})
            for (const double z : {-kDepth / 2, kDepth / 2}) points.push_back({side * (0.5 + y * slope), y, z});
        // The jaw slides freely along x: of what acts on it only the force along x counts, and the guide takes the
        // rest.
        const int piston = limit.addBlock(0, {side, 0, 0});
        limit.addForce(piston, {-side * force, 0, 0}, {side, 0, 0});
        limit.addJoint({piston, block, points, normal, {side * std::sin(angle), std::cos(angle), 0}});
        limit.addGuide(piston, {1, 0, 0});
    };
    addFace(taper.left, -1);
    addFace(taper.right, 1);
    return bisect(1, 0.01, 1e-3, [&](double friction) { return limit.stands(friction); });
}

/// Without gravity a wedge between equal jaws stays where it is when friction exceeds the slope.
void selfLock(Trial& trial, const Taper& taper) {
    constexpr double kForce = 100;
    const auto holds = [&](double friction) {
        Press press = pressOf(taper, wedge(taper), static_cast<float>(friction));
        press.scene.settings.gravity = {};
        Run run = trial.start(press.scene, fmt::format("mu {:.4f}", friction));
        return squeeze(run, press, kForce, 2) < 0.02;
    };
    const double exact = limitFriction(taper, kForce);
    trial.expectNear("critical mu", bisect(1.5 * exact, 0.6 * exact, 5e-3, holds), exact, 0.02 * exact, "1");
}

/// Driven into a fixed slot with 100 times its weight for a second, then let go: it stays.
void driven(Trial& trial, const Taper& taper, float friction) {
    Scene scene;
    const Material material = surface(friction);
    add(scene, fixedBody(jaw(taper.left, -1), {}, material));
    add(scene, fixedBody(jaw(taper.right, 1), {}, material));
    const int body = add(scene, solidBody(wedge(taper), {}, 1, material));
    Run run = trial.start(scene);
    const auto count = std::lround(1 / trial.dt());
    for (long i = 0; i < count; ++i) {
        run.engine().push(body, {0, static_cast<float>(-100 * kGravity), 0}, run.position(body));
        run.step();
    }
    const double deepest = run.height(body);
    double highest = -INFINITY;
    run.advance(5, [&] {
        highest = larger(highest, run.height(body));
        return true;
    });
    trial.expectAtMost("driven in", deepest, 0.002, "m");
    trial.expectAtMost("comes out", larger(0.0, highest - deepest), 0.002, "m");
}

}  // namespace wedges_cases
}  // namespace

Family wedges() {
    using namespace wedges_cases;
    const Taper symmetric{0.25, 0.25}, threeFourFive{0, std::atan(0.75)};
    return {"wedge",
            {
                {"plank between pistons", plank},
                {"symmetric taper", [=](Trial& trial) { selfLock(trial, symmetric); }},
                {"3-4-5 wedge", [=](Trial& trial) { selfLock(trial, threeFourFive); }},
                {"3-4-5 wedge driven in, mu=0.5", [=](Trial& trial) { driven(trial, threeFourFive, 0.5f); }},
                {"3-4-5 wedge driven in, mu=0.2", [=](Trial& trial) { driven(trial, threeFourFive, 0.2f); }},
            }};
}

}  // namespace ragtop::stability
