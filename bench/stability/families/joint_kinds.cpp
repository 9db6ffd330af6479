#include "joint_kinds.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace ragtop::stability {
namespace {
namespace joint_kinds_cases {

constexpr float kSpring = 200;  ///< N m/rad or N/m of soft stops

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
    ball.reach = anyReach(dice, [&] { return around(dice, 0, 3); });
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
/// Its twist is free.
Drawn softCone(Dice& dice) {
    BallDef def;
    def.swingLimit = dice.between(0.1f, 2);
    def.stop.stiffness = kSpring;
    return {def, swung(dice, dice.between(0, *def.swingLimit), dice.between(-3, 3))};
}
/// Its swing is kept from half a turn, where there is no twist.
Drawn softTwist(Dice& dice) {
    BallDef def;
    def.swingLimit = 1.5f;
    def.twistLimit = around(dice, 0, 2);
    def.stop.stiffness = kSpring;
    return {def, swung(dice, dice.between(0, 1.5f), 0)};
}

Place turned(Dice& dice) { return {anyRotation(dice)}; }
Place aboutX(Dice& dice) { return {rotationAbout(kX, dice.between(-3, 3))}; }
Place alongX(Dice& dice) { return {{}, dice.between(-1, 1) * kX}; }
/// As far as soft stops give way to what these bodies bring.
Place littleAboutX(Dice& dice) { return {rotationAbout(kX, dice.between(-1, 1))}; }
Place littleTurned(Dice& dice) { return {swung(dice, dice.between(0, 1), dice.between(-1, 1))}; }
Place littleAlongX(Dice& dice) { return {{}, dice.between(-0.4f, 0.4f) * kX}; }
Place thrown(Dice& dice) { return {anyRotation(dice), anyVector(dice, 1)}; }
Place alongAndAboutX(Dice& dice) { return {rotationAbout(kX, dice.between(-3, 3)), dice.between(-1, 1) * kX}; }
Place aboutXThenY(Dice& dice) {
    return {rotationAbout(kX, dice.between(-3, 3)) * rotationAbout(kY, dice.between(-3, 3))};
}
Place onPlane(Dice& dice) {
    return {rotationAbout(kX, dice.between(-3, 3)), {0, dice.between(-1, 1), dice.between(-1, 1)}};
}
Place aboutZAndX(Dice& dice) {
    return {rotationAbout(kZ, dice.between(-1.5f, 1.5f)) * rotationAbout(kX, dice.between(-3, 3))};
}

const JointType kTypes[] = {
    {"cone", cone, turned},
    {"ellipse", ellipse, turned},
    {"pyramid", pyramid, turned},
    {"polygon", polygon, turned},
    {"ball", freeBall},
    {"hinge", hinge, aboutX},
    {"slider", slider, alongX},
    {"fixed", fixed},
    {"rope", rope, thrown},
    {"rod", rod},
    {"cylindrical", cylindrical, alongAndAboutX},
    {"universal", universal, aboutXThenY},
    {"plane", plane, onPlane},
    {"screw", screw},
    {"path", path},
    {"ring", [](Dice& dice) { return ring(dice, false); }},
    {"aligned ring", [](Dice& dice) { return ring(dice, true); }},
    {"six degrees", sixDof, thrown},
    {"six degrees, four locked", lockedSixDof, aboutZAndX},
    {"hinge with soft stops", softHinge, littleAboutX},
    {"slider with soft stops", softSlider, littleAlongX},
    {"cone with soft stops", softCone, littleTurned},
    {"twist with soft stops", softTwist, littleTurned},
};

/// A body of moments 0.02, 0.06 and 0.05 kg m² whose joint is 0.3 m beside its centre.
int addBody(Scene& scene, Dice& dice, const Pose& joint, float side, bool moves) {
    const Vec3 arm{0.3f * side, 0, 0};
    BodyDef def = bodyWithMass(Sphere{0.2f}, joint.position - DVec3(rotate(joint.rotation, arm)), kJointedMass,
                               kJointedMoments, {});
    def.pose.rotation = joint.rotation;
    def.shapes[0].filter.mask = 0;
    if (moves) {
        def.angularVelocity = anyVector(dice, 6);
        def.linearVelocity = cross(def.angularVelocity, -rotate(joint.rotation, arm)) + anyVector(dice, 1);
    }
    return add(scene, def);
}

}  // namespace joint_kinds_cases
}  // namespace

std::span<const JointType> jointTypes() { return joint_kinds_cases::kTypes; }

void addJoint(Scene& scene, Dice& dice, const Drawn& drawn, const DVec3& place, bool twoBodies) {
    using namespace joint_kinds_cases;
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

}  // namespace ragtop::stability
