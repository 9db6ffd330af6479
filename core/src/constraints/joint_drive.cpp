#include "constraints/joint_drive.h"

namespace ragtop {
namespace {

bool same(const Spring& a, const Spring& b) {
    return a.stiffness == b.stiffness && a.damping == b.damping && a.frequency == b.frequency && a.speed == b.speed &&
           a.feedForward == b.feedForward && a.maxForce == b.maxForce;
}

bool set(BallDef& ball, const JointDrive& drive) {
    const Spring spring{.stiffness = drive.stiffness, .damping = drive.damping};
    if (ball.spring && same(*ball.spring, spring) && !ball.twistSpring && ball.target == drive.target &&
        ball.targetSpeed == drive.speed && ball.feedForward == drive.feedForward &&
        ball.maxSpringTorque == drive.maxTorque)
        return false;
    ball.spring = spring;
    ball.twistSpring.reset();
    ball.target = drive.target;
    ball.targetSpeed = drive.speed;
    ball.feedForward = drive.feedForward;
    ball.maxSpringTorque = drive.maxTorque;
    return true;
}

bool set(HingeDef& hinge, const JointDrive& drive) {
    Spring spring{.stiffness = drive.stiffness, .damping = drive.damping};
    spring.speed = drive.speed.x;
    spring.feedForward = drive.feedForward.x;
    spring.maxForce = drive.maxTorque;
    if (hinge.spring && same(*hinge.spring, spring) && hinge.target == drive.angle) return false;
    hinge.spring = spring;
    hinge.target = drive.angle;
    return true;
}

bool set(JointSim& joint, const BallDef& ball) {
    const std::uint32_t wanted = needsDrives(ball) ? BallRows::kDrives : BallRows::kSpring;
    BallRows& rows = joint.ball;
    if ((rows.features & (BallRows::kDrives | BallRows::kSpring)) != wanted) return false;
    rows.spring = {{ball.spring->stiffness, ball.spring->damping, 0, ball.spring->dampingRatio}, ball.maxSpringTorque};
    rows.target = normalized(ball.target);
    joint.drives.swing = rows.spring.tuning;
    joint.drives.twist = {};
    joint.drives.apart = 0;
    joint.drives.targetSpeed = ball.targetSpeed;
    joint.drives.feedForward = ball.feedForward;
    return true;
}

bool set(JointSim& joint, const HingeDef& hinge) {
    AxisRows& rows = joint.axis;
    if (!(rows.features & AxisRows::kSpring)) return false;
    const Spring& spring = *hinge.spring;
    rows.spring = {{spring.stiffness, spring.damping, 0, spring.dampingRatio},
                   hinge.target,
                   spring.speed,
                   spring.feedForward,
                   spring.maxForce};
    return true;
}

}  // namespace

bool setDrive(JointDef& def, const JointDrive& drive) {
    if (auto* ball = std::get_if<BallDef>(&def)) return set(*ball, drive);
    return set(std::get<HingeDef>(def), drive);
}

bool setDrive(JointSim& joint, const JointDef& def) {
    const auto* ball = std::get_if<BallDef>(&def);
    if (!(ball ? set(joint, *ball) : set(joint, std::get<HingeDef>(def)))) return false;
    joint.ledger = {};
    joint.leads = 0;
    joint.ball.springStart = joint.ball.springLoad = {};
    joint.axis.springStart = joint.axis.springLoad = 0;
    return true;
}

}  // namespace ragtop
