#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../suite.h"
#include "joint_kinds.h"

namespace ragtop::stability {
namespace {
namespace joint_turns_cases {

constexpr int kCount = 100;
constexpr Vec3 kX{1, 0, 0};

/// A joint along x, with its ends beyond one turn, and what B's speed along it is with each rad/s about it.
struct Turning {
    const char* name;
    JointDef (*with)(const Range& range);
};

JointDef turningSixDof(const Range& range) {
    SixDofDef def;
    for (AxisDef* axis : {&def.x, &def.y, &def.z, &def.swingY, &def.swingZ}) axis->limit = Range{};
    def.twist.limit = range;
    return def;
}

const Turning kTurnings[] = {
    {"hinge", [](const Range& range) { return JointDef{HingeDef{.limit = range}}; }},
    {"cylindrical", [](const Range& range) { return JointDef{CylindricalDef{.turn = {.limit = range}}}; }},
    {"universal", [](const Range& range) { return JointDef{UniversalDef{.first = {.limit = range}}}; }},
    {"plane", [](const Range& range) { return JointDef{PlaneDef{.turn = {.limit = range}}}; }},
    {"screw", [](const Range& range) { return JointDef{ScrewDef{.turn = {.limit = range}}}; }},
    {"six degrees", turningSixDof},
};

/// Turns at 5 to 15 rad/s from up to half a turn to a stop one to two turns away, and stays there.
void turns(Trial& trial, const Turning& turning, bool twoBodies) {
    struct Stopping {
        float stop;
        double angle, before, most = 0;
    };
    Scene scene;
    scene.settings.gravity = {};
    Dice dice(720);
    std::vector<Stopping> each;
    const auto addBody = [&](const DVec3& at, float turned, float spin) {
        BodyDef def = bodyWithMass(Sphere{0.2f}, at, kJointedMass, kJointedMoments, {});
        def.shapes[0].filter.mask = 0;
        def.pose.rotation = rotationAbout(kX, turned);
        def.angularVelocity = spin * kX;
        return add(scene, def);
    };
    constexpr float kTurn = 2 * std::numbers::pi_v<float>;
    for (int i = 0; i < kCount; ++i) {
        const DVec3 at{0, 0, 4.0 * i};
        const float start = dice.between(-3, 3), way = i % 2 == 0 ? 1.0f : -1.0f;
        const float stop = i == 0 ? 2 * kTurn : way * dice.between(kTurn, 2 * kTurn);
        const float spin = way * dice.between(5, 15);
        const int a = twoBodies ? addBody(at - DVec3{0.6, 0, 0}, 0, -spin / 2) : kWorld;
        const int b = addBody(at, start, twoBodies ? spin / 2 : spin);
        SceneJoint joint{"", a, b, turning.with(way > 0 ? Range{-kTurn, stop} : Range{stop, kTurn})};
        std::visit(
            [&](auto& def) {
                def.bodies.frameA.position = twoBodies ? Vec3{0.3f, 0, 0} : toVec3(at - DVec3{0.3, 0, 0});
                def.bodies.frameB.position = {-0.3f, 0, 0};
            },
            joint.def);
        scene.joints.push_back(joint);
        each.push_back({stop, static_cast<double>(start), static_cast<double>(start)});
    }
    Run run = trial.start(scene);
    // The slowest needs three seconds for the farthest stop, with half a turn the wrong side of zero.
    run.advance(4, [&] {
        for (std::size_t i = 0; i < each.size(); ++i) {
            const SceneJoint& joint = run.scene().joints[i];
            const Quat a = joint.bodyA == kWorld ? Quat{} : run.motion(joint.bodyA).pose.rotation;
            const Quat q = conjugate(a) * run.motion(joint.bodyB).pose.rotation;
            const double now = 2 * std::atan2(static_cast<double>(q.x), static_cast<double>(q.w));
            Stopping& one = each[i];
            one.angle += std::remainder(now - one.before, 2 * std::numbers::pi);
            one.before = now;
            const double way = one.stop > 0 ? 1 : -1;
            one.most = larger(one.most, way * (one.angle - static_cast<double>(one.stop)));
        }
        return true;
    });
    double over = 0, off = 0;
    for (const Stopping& one : each) {
        over = larger(over, one.most);
        off = larger(off, std::abs(one.angle - static_cast<double>(one.stop)));
    }
    trial.expectAtMost("overshoot", over, 0.01, "rad");
    trial.expectAtMost("ends off its stop", off, 0.01, "rad");
}

/// A joint of a body with the world that gives at most `limit`, in N m or N.
struct Driven {
    const char* name;
    JointDef (*with)(float limit, Dice& dice);
    bool slides = false;
};

Spring stiff(float limit) {
    Spring spring{500, 5};
    spring.maxForce = limit;
    return spring;
}
const Driven kDriven[] = {
    {"motor of a hinge",
     [](float limit, Dice& dice) {
         return JointDef{HingeDef{.motor = Motor{dice.between(-20, 20), limit}}};
     }},
    {"spring of a hinge",
     [](float limit, Dice& dice) { return JointDef{HingeDef{.spring = stiff(limit), .target = dice.between(-3, 3)}}; }},
    {"motor of a slider",
     [](float limit, Dice& dice) {
         return JointDef{SliderDef{.motor = Motor{dice.between(-20, 20), limit}}};
     },
     true},
    {"spring of a slider",
     [](float limit, Dice& dice) { return JointDef{SliderDef{.spring = stiff(limit), .target = dice.between(-1, 1)}}; },
     true},
    {"spring of a ball",
     [](float limit, Dice& dice) {
         return JointDef{BallDef{.spring = Spring{500, 5}, .target = dice.rotation(), .maxSpringTorque = limit}};
     }},
};

/// What a joint changed of its body's momentum along x, or of the angular momentum about its point, in a step: never
/// more than it may, and where it has most to do just that.
void gives(Trial& trial, const Driven& driven) {
    constexpr double kArm = 0.3;
    Scene scene;
    scene.settings.gravity = {};
    Dice dice(37);
    std::vector<double> limits;
    for (int i = 0; i < kCount; ++i) {
        const DVec3 at{0, 0, 4.0 * i};
        const float limit = dice.between(1, 8);
        const bool ball = std::holds_alternative<BallDef>(driven.with(limit, dice));
        // Of equal moments about its joint, so that it does not tumble by itself.
        const float across = 0.05f, along = ball ? across + static_cast<float>(kArm * kArm) : across;
        BodyDef def = bodyWithMass(Sphere{0.2f}, at + DVec3{kArm, 0, 0}, kJointedMass, {along, across, across}, {});
        def.shapes[0].filter.mask = 0;
        const Vec3 spin{dice.between(-6, 6), dice.between(-6, 6), dice.between(-6, 6)};
        if (driven.slides)
            def.linearVelocity = {dice.between(-3, 3), 0, 0};
        else
            def.angularVelocity = ball ? spin : spin.x * kX;
        if (ball) def.linearVelocity = cross(def.angularVelocity, {static_cast<float>(kArm), 0, 0});
        const int body = add(scene, def);
        SceneJoint joint{"", kWorld, body, driven.with(limit, dice)};
        std::visit(
            [&](auto& each) {
                each.bodies.frameA.position = toVec3(at);
                each.bodies.frameB.position = {static_cast<float>(-kArm), 0, 0};
            },
            joint.def);
        scene.joints.push_back(joint);
        limits.push_back(static_cast<double>(limit));
    }
    const auto momentum = [&](const Run& run, int body) {
        const DVec3 v{run.motion(body).v}, spin = run.angularMomentum(body);
        if (driven.slides) return static_cast<double>(kJointedMass) * v;
        const DVec3 r = run.position(body) - DVec3{0, 0, 4.0 * body};
        return spin + static_cast<double>(kJointedMass) *
                          DVec3{r.y * v.z - r.z * v.y, r.z * v.x - r.x * v.z, r.x * v.y - r.y * v.x};
    };
    Run run = trial.start(scene);
    run.step();
    std::vector<DVec3> before;
    for (int i = 0; i < kCount; ++i) before.push_back(momentum(run, i));
    double most = 0;
    run.advance(1, [&] {
        for (int i = 0; i < kCount; ++i) {
            const auto index = static_cast<std::size_t>(i);
            const DVec3 now = momentum(run, i), d = now - before[index];
            most = larger(most, std::hypot(d.x, d.y, d.z) / (limits[index] * trial.dt()));
            before[index] = now;
        }
        return true;
    });
    trial.expectNear("most that it gives, over its limit", most, 1, 0.001, "1");
}

}  // namespace joint_turns_cases
}  // namespace

void addTurnCases(Family& family) {
    using namespace joint_turns_cases;
    for (const Turning& turning : kTurnings)
        for (const bool two : {false, true})
            family.cases.push_back(
                {fmt::format("{} to 720 degrees, {}", turning.name, two ? "two bodies" : "a body and the world"),
                 [&turning, two](Trial& trial) { turns(trial, turning, two); }, Kind::ragtopOnly});
}

void addTorqueCases(Family& family) {
    using namespace joint_turns_cases;
    for (const Driven& driven : kDriven)
        family.cases.push_back({fmt::format("limit of a {}", driven.name),
                                [&driven](Trial& trial) { gives(trial, driven); }, Kind::oneStep});
}

}  // namespace ragtop::stability
