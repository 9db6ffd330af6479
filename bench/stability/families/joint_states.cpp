#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <optional>
#include <vector>

#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

constexpr float kMass = 1;
const Vec3 kMoments{0.02f, 0.06f, 0.05f};
constexpr float kSpring = 200;  ///< N m/rad or N/m of soft stops

/// A joint and where on it B begins, in A's joint frame.
struct Drawn {
    JointDef def;
    Quat rotation{};
    Vec3 offset{};
};

/// A range of up to twice `size` with x in it.
Range around(Dice& dice, float x, float size) {
    return Range{x - size * dice.between(0, 1), x + size * dice.between(0.02f, 1)};
}
AxisDef limited(Dice& dice, float x, float size) {
    AxisDef axis;
    axis.limit = around(dice, x, size);
    return axis;
}
Quat anyRotation(Dice& dice) {
    return normalized(Quat{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)});
}
Vec3 anyVector(Dice& dice, float size) {
    return size * Vec3{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
}
constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};
/// A swing about any axis across x, after a twist about x.
Quat swung(Dice& dice, float swing, float twist) {
    const float to = dice.between(0, 2 * std::numbers::pi_v<float>);
    return rotationAbout({0, std::cos(to), std::sin(to)}, swing) * rotationAbout(kX, twist);
}

Drawn cone(Dice& dice) {
    BallDef ball;
    ball.swingLimit = dice.between(0.1f, 3);
    ball.twistLimit = around(dice, 0, 3);
    const float swing = dice.between(0, *ball.swingLimit), twist = dice.between(0, ball.twistLimit->upper);
    return {ball, swung(dice, swing, twist)};
}
Drawn ellipse(Dice& dice) {
    BallDef ball;
    ball.swingEllipse = SwingEllipse{dice.between(0.1f, 2), dice.between(0.1f, 2)};
    ball.twistLimit = around(dice, 0, 3);
    const float least = std::min(ball.swingEllipse->y, ball.swingEllipse->z);
    const float swing = dice.between(0, least), twist = dice.between(0, ball.twistLimit->upper);
    return {ball, swung(dice, swing, twist)};
}
Drawn pyramid(Dice& dice) {
    BallDef ball;
    ball.swingPyramid = SwingPyramid{around(dice, 0, 1.5f), around(dice, 0, 1.5f)};
    ball.twistLimit = around(dice, 0, 3);
    return {ball, rotationAbout(kX, dice.between(0, ball.twistLimit->upper))};
}
Drawn polygon(Dice& dice) {
    BallDef ball;
    ReachPolygon reach;
    reach.count = 7;
    for (int i = 0; i < reach.count; ++i) {
        const double about = 2 * std::numbers::pi * i / reach.count;
        const double from = static_cast<double>(dice.between(0.2f, 2.2f));
        reach.corners[static_cast<std::size_t>(i)] = {
            toVec3({std::cos(from), std::sin(from) * std::cos(about), std::sin(from) * std::sin(about)}),
            around(dice, 0, 3)};
    }
    ball.reach = reach;
    const float swing = dice.between(0, 0.15f);
    return {ball, swung(dice, swing, 0)};
}
Drawn freeBall(Dice& dice) { return {BallDef{}, anyRotation(dice)}; }
Drawn hinge(Dice& dice) {
    HingeDef hinge;
    const float angle = dice.between(-3, 3);
    hinge.limit = around(dice, angle, 8);
    return {hinge, rotationAbout(kX, angle)};
}
Drawn slider(Dice& dice) {
    SliderDef slider;
    const float travel = dice.between(-0.5f, 0.5f);
    slider.limit = around(dice, travel, 1);
    return {slider, {}, travel * kX};
}
Drawn fixed(Dice&) { return {FixedDef{}}; }
Drawn rope(Dice& dice) {
    const Vec3 offset = anyVector(dice, 0.5f);
    DistanceDef distance;
    distance.limit = Range{0, length(offset) + dice.between(0.01f, 1)};
    return {distance, anyRotation(dice), offset};
}
Drawn rod(Dice& dice) {
    const Vec3 offset = anyVector(dice, 0.5f) + 0.6f * kX;
    DistanceDef distance;
    distance.limit = Range{length(offset), length(offset)};
    return {distance, anyRotation(dice), offset};
}
Drawn cylindrical(Dice& dice) {
    const float angle = dice.between(-3, 3), travel = dice.between(-0.5f, 0.5f);
    return {CylindricalDef{{}, limited(dice, angle, 8), limited(dice, travel, 1)}, rotationAbout(kX, angle),
            travel * kX};
}
Drawn universal(Dice& dice) {
    const float first = dice.between(-3, 3), second = dice.between(-3, 3);
    return {UniversalDef{{}, limited(dice, first, 8), limited(dice, second, 8)},
            rotationAbout(kX, first) * rotationAbout(kY, second)};
}
Drawn plane(Dice& dice) {
    const Vec3 offset{0, dice.between(-0.5f, 0.5f), dice.between(-0.5f, 0.5f)};
    const float angle = dice.between(-3, 3);
    return {PlaneDef{{}, limited(dice, offset.y, 1), limited(dice, offset.z, 1), limited(dice, angle, 8)},
            rotationAbout(kX, angle), offset};
}
Drawn screw(Dice& dice) {
    const float pitch = dice.between(0.05f, 0.5f), angle = dice.between(-3, 3);
    const float travel = pitch * angle / (2 * std::numbers::pi_v<float>);
    return {ScrewDef{{}, pitch, limited(dice, angle, 8)}, rotationAbout(kX, angle), travel * kX};
}
/// A wavy line through A's origin about along x, B on its third point.
Drawn path(Dice& dice) {
    PathDef def;
    def.curve.count = 8;
    for (int i = 0; i < def.curve.count; ++i)
        def.curve.points[static_cast<std::size_t>(i)] = {0.2f * static_cast<float>(i), dice.between(-0.1f, 0.1f),
                                                         dice.between(-0.1f, 0.1f)};
    def.travel.limit = Range{0.1f, dice.between(0.9f, 1.2f)};
    return {def, anyRotation(dice), def.curve.points[2]};
}
/// A ring about (0, 0.5, 0), as round as eight points make it, B a quarter turn from its beginning.
Drawn ring(Dice& dice, bool align) {
    PathDef def;
    def.align = align;
    def.curve.closed = true;
    def.curve.count = 8;
    for (int i = 0; i < def.curve.count; ++i) {
        const float turn = static_cast<float>(i) * std::numbers::pi_v<float> / 4;
        def.curve.points[static_cast<std::size_t>(i)] = {0.5f * std::sin(turn), 0.5f - 0.5f * std::cos(turn), 0};
    }
    const Quat aligned = rotationAbout(kZ, std::numbers::pi_v<float> / 2) * rotationAbout(kX, dice.between(-3, 3));
    return {def, align ? aligned : anyRotation(dice), def.curve.points[2]};
}
Drawn sixDof(Dice& dice) {
    const Vec3 offset = anyVector(dice, 0.3f);
    const float twist = dice.between(-2, 2), y = dice.between(-1, 1), z = dice.between(-1, 1), swing = std::hypot(y, z);
    SixDofDef def{{}, limited(dice, offset.x, 0.5f), limited(dice, offset.y, 0.5f), limited(dice, offset.z, 0.5f)};
    def.twist = limited(dice, twist, 2), def.swingY = limited(dice, y, 1), def.swingZ = limited(dice, z, 1);
    return {def, rotationAbout({0, y / swing, z / swing}, swing) * rotationAbout(kX, twist), offset};
}
/// Travels are locked and so is one turn.
Drawn lockedSixDof(Dice& dice) {
    const float twist = dice.between(-3, 3), z = dice.between(-1, 1);
    SixDofDef def;
    for (AxisDef* axis : {&def.x, &def.y, &def.z, &def.swingY}) axis->limit = Range{};
    def.twist = limited(dice, twist, 3), def.swingZ = limited(dice, z, 1.5f);
    return {def, rotationAbout(kZ, z) * rotationAbout(kX, twist)};
}
Drawn softHinge(Dice& dice) {
    HingeDef def;
    def.limit = around(dice, 0, 2);
    def.stop.stiffness = kSpring;
    return {def};
}
Drawn softSlider(Dice& dice) {
    SliderDef def;
    def.limit = around(dice, 0, 0.3f);
    def.stop.stiffness = kSpring;
    return {def};
}

struct JointType {
    const char* name;
    Drawn (*draw)(Dice& dice);
};
const JointType kTypes[] = {
    {"cone", cone},
    {"ellipse", ellipse},
    {"pyramid", pyramid},
    {"polygon", polygon},
    {"ball", freeBall},
    {"hinge", hinge},
    {"slider", slider},
    {"fixed", fixed},
    {"rope", rope},
    {"rod", rod},
    {"cylindrical", cylindrical},
    {"universal", universal},
    {"plane", plane},
    {"screw", screw},
    {"path", path},
    {"ring", [](Dice& dice) { return ring(dice, false); }},
    {"aligned ring", [](Dice& dice) { return ring(dice, true); }},
    {"six degrees", sixDof},
    {"six degrees, four locked", lockedSixDof},
    {"hinge with soft stops", softHinge},
    {"slider with soft stops", softSlider},
};

/// A body of moments 0.02, 0.06 and 0.05 kg m² whose joint is 0.3 m beside its centre.
int addBody(Scene& scene, Dice& dice, const Pose& joint, float side, bool moves) {
    const Vec3 arm{0.3f * side, 0, 0};
    BodyDef def = bodyWithMass(Sphere{0.2f}, joint.position - DVec3(rotate(joint.rotation, arm)), kMass, kMoments, {});
    def.pose.rotation = joint.rotation;
    def.shapes[0].filter.mask = 0;
    if (moves) {
        def.angularVelocity = anyVector(dice, 6);
        def.linearVelocity = cross(def.angularVelocity, -rotate(joint.rotation, arm)) + anyVector(dice, 1);
    }
    return add(scene, def);
}

/// One joint between two bodies, or the world and one, at any state; bodies move with up to 10 rad/s.
void addJoint(Scene& scene, Dice& dice, const Drawn& drawn, const DVec3& place, bool twoBodies) {
    const Quat frameA = twoBodies ? anyRotation(dice) : Quat{};
    const Pose jointA{place, frameA};
    const Pose jointB{place + DVec3(rotate(frameA, drawn.offset)), frameA * drawn.rotation};
    const int a = twoBodies ? addBody(scene, dice, jointA, 1, true) : kWorld;
    const int b = addBody(scene, dice, jointB, -1, true);
    SceneJoint joint{"", a, b, drawn.def};
    std::visit(
        [&](auto& each) {
            each.bodies.frameA.position = twoBodies ? Vec3{0.3f, 0, 0} : toVec3(place);
            each.bodies.frameB.position = {-0.3f, 0, 0};
        },
        joint.def);
    scene.joints.push_back(joint);
}

/// Kinetic energy of a body whose moments are along its axes.
double energyOf(const BodyMotion& motion) {
    const DVec3 v(motion.v);
    const Vec3 w = inverseRotate(motion.pose.rotation, motion.w);
    return 0.5 * (static_cast<double>(kMass) * (v.x * v.x + v.y * v.y + v.z * v.z) +
                  static_cast<double>(dot(w, scale(kMoments, w))));
}

/// Does a soft stop store energy? Its springs act at the beginning of a substep, so that what is stored in them and the
/// speed are of times half a substep apart: energies are compared while no stop is pressed, before and after.
bool isPressed(const Run& run, const SceneJoint& joint) {
    const auto beyond = [](const Range& range, double x) {
        return x < static_cast<double>(range.lower) || x > static_cast<double>(range.upper);
    };
    const auto frame = [&](int body, const Frame& local) {
        if (body == kWorld) return Pose{DVec3(local.position), local.rotation};
        const Pose pose = run.motion(body).pose;
        return Pose{pose.position + DVec3(rotate(pose.rotation, local.position)), pose.rotation * local.rotation};
    };
    const auto* turning = std::get_if<HingeDef>(&joint.def);
    const auto* sliding = std::get_if<SliderDef>(&joint.def);
    if (turning && turning->stop.stiffness > 0) {
        const Quat q = conjugate(frame(joint.bodyA, turning->bodies.frameA).rotation) *
                       frame(joint.bodyB, turning->bodies.frameB).rotation;
        const double angle = 2 * std::atan2(static_cast<double>(q.x), static_cast<double>(q.w));
        return beyond(*turning->limit, std::remainder(angle, 2 * std::numbers::pi));
    }
    if (sliding && sliding->stop.stiffness > 0) {
        const Pose a = frame(joint.bodyA, sliding->bodies.frameA), b = frame(joint.bodyB, sliding->bodies.frameB);
        const Vec3 gap = inverseRotate(a.rotation, relative(b.position, a.position));
        return beyond(*sliding->limit, static_cast<double>(gap.x));
    }
    return false;
}

/// Tells how many of so many joints gained more than 0.1 % in the 2 s after their first step, in which what does not
/// fit the joint is lost, and the most that any did.
struct Gains {
    double most = 0;
    int count = 0;

    void measure(Run& run, int bodiesPerJoint) {
        const std::vector<SceneJoint>& joints = run.scene().joints;
        const auto energy = [&](std::size_t joint) {
            double sum = 0;
            for (int i = 0; i < bodiesPerJoint; ++i)
                sum += energyOf(run.motion(bodiesPerJoint * static_cast<int>(joint) + i));
            return sum;
        };
        run.step();
        std::vector<double> start(joints.size(), -1);
        for (std::size_t i = 0; i < joints.size(); ++i)
            if (!isPressed(run, joints[i])) start[i] = energy(i);
        std::vector<bool> did(joints.size(), false);
        run.advance(2, [&] {
            for (std::size_t i = 0; i < joints.size(); ++i) {
                if (isPressed(run, joints[i])) continue;
                if (start[i] < 0) start[i] = energy(i);
                // What is at rest has nothing to compare with.
                const double gain = (energy(i) - start[i]) / std::max(start[i], 0.01);
                most = std::max(most, gain);
                if (gain <= 0.001 || did[i]) continue;
                ++count;
                did[i] = true;
            }
            return true;
        });
    }
};

void states(Trial& trial, const JointType& type, bool twoBodies, int count) {
    constexpr int kAtOnce = 400;
    Dice dice;
    Gains gains;
    for (int done = 0; done < count; done += kAtOnce) {
        Scene scene;
        scene.settings.gravity = {};
        for (int i = 0; i < std::min(kAtOnce, count - done); ++i)
            addJoint(scene, dice, type.draw(dice), {4.0 * i, 0, 0}, twoBodies);
        Run run = trial.start(scene, std::to_string(done));
        gains.measure(run, twoBodies ? 2 : 1);
    }
    trial.expectAtMost("energy gained", gains.most, 0.001, "1");
    trial.expectAtMost("joints that gain", gains.count, 0, "1");
}

}  // namespace

Family jointStates() {
    Family family{"joint_states", {}};
    const auto add = [&](const JointType& type, bool twoBodies, int count, Kind kind) {
        const std::string name =
            fmt::format("{} of {}, {}", count, type.name, twoBodies ? "two bodies" : "a body and the world");
        family.cases.push_back(
            {name, [&type, twoBodies, count](Trial& trial) { states(trial, type, twoBodies, count); }, kind});
    };
    // 42 kinds of joints, 24,000 states each: a million.
    for (const JointType& type : kTypes)
        for (const bool two : {false, true}) {
            add(type, two, 200, Kind::oneStep);
            add(type, two, 24000, Kind::longer);
        }
    return family;
}

}  // namespace ragtop::stability
