#include "constraints/stored_energy.h"

#include <cmath>

#include "constraints/joint_types.h"

namespace ragtop {

namespace {

/// ∫ min(k x, F) dx
double ofSpring(double stiffness, double way, double longest) {
    const double x = std::fabs(way), bound = longest / stiffness;
    return x < bound ? 0.5 * stiffness * x * x : longest * (x - 0.5 * bound);
}

double ofStop(const Stop& stop, double margin) {
    const auto k = static_cast<double>(stop.stiffness);
    return margin < 0 ? 0.5 * k * margin * margin : 0;
}

JointPlace placeOf(const JointSim& joint, const JointBodiesAtStep& at) {
    const Vec3 gap =
        at.centerOffset + rotate(at.rotationB, joint.localB.position) - rotate(at.rotationA, joint.localA.position);
    return {at.rotationA * joint.localA.rotation, at.rotationB * joint.localB.rotation, gap};
}

double ofSwingAndTwist(const BallRows& rows, const JointPlace& at) {
    const Vec3 d = inverseRotate(at.a, axisX(at.b));
    SwingMargin sides[SwingLimit::kSides];
    swingMargins(rows.swingLimit, d, sides);
    double sum = 0;
    for (const SwingMargin& side : sides) sum += ofStop(rows.stop, static_cast<double>(side.margin));
    if (rows.features & BallRows::kTwist) {
        const Range range = twistRange(rows, d);
        const SwingTwist angles = swingTwist(at.a, at.b);
        const float twist = wrapAbout(angles.twist, 0.5f * (range.lower + range.upper)), c = angles.cosHalfSwing;
        sum += ofStop(rows.stop, static_cast<double>(c * (twist - range.lower))) +
               ofStop(rows.stop, static_cast<double>(c * (range.upper - twist)));
    }
    return sum;
}

double ofBall(const JointSim& joint, const JointPlace& at) {
    const BallRows& rows = joint.ball;
    double sum = rows.stop.stiffness > 0 ? ofSwingAndTwist(rows, at) : 0;
    const float w = easiest(joint.block);
    const auto add = [&](const SpringTuning& spring, float way) {
        const double stiffness = static_cast<double>(spring.at(w).stiffness);
        if (stiffness > 0) sum += ofSpring(stiffness, static_cast<double>(way), static_cast<double>(rows.spring.most));
    };
    const Quat target = at.a * rows.target;
    if (rows.features & BallRows::kSpring) add(rows.spring.tuning, length(turnVector(at.b * conjugate(target))));
    if ((rows.features & BallRows::kDrives) == 0) return sum;
    const BallDrives& drives = joint.drives;
    if (drives.apart != 0) {
        const SwingTwist off = swingTwist(target, at.b);
        add(drives.swing, off.swing);
        add(drives.twist, off.twist);
    } else {
        add(drives.swing, length(turnVector(at.b * conjugate(target))));
    }
    return sum;
}

double ofAxis(AxisRows rows, double coordinate) {
    double sum = 0;
    if (rows.features & AxisRows::kSpring) {
        const auto k = static_cast<double>(rows.spring.tuning.at(rows.inverseMass).stiffness);
        const double way = coordinate - static_cast<double>(rows.spring.target);
        if (k > 0) sum += ofSpring(k, way, static_cast<double>(rows.spring.most));
    }
    if ((rows.features & AxisRows::kLimit) != 0 && rows.stop.stiffness > 0) {
        setMargins(rows, coordinate);
        sum += ofStop(rows.stop, static_cast<double>(rows.atLower.margin)) +
               ofStop(rows.stop, static_cast<double>(rows.atUpper.margin));
    }
    return sum;
}

}  // namespace

bool storesEnergy(const JointSim& joint) {
    constexpr std::uint32_t kBall = BallRows::kSpring | BallRows::kDrives;
    if (hasAxes(joint.kind)) return false;
    return (joint.axis.features & AxisRows::kSpring) != 0 || (joint.ball.features & kBall) != 0 ||
           joint.axis.stop.stiffness > 0 || joint.ball.stop.stiffness > 0;
}

double storedEnergy(const JointSim& joint, const JointBodiesAtStep& bodies) {
    const JointPlace at = placeOf(joint, bodies);
    switch (joint.kind) {
        case JointKind::ball:
            return ofBall(joint, at);
        case JointKind::hinge:
            return ofAxis(joint.axis, unwrapped(joint.axis, hingeAngle(at.a, at.b)));
        case JointKind::slider:
            return ofAxis(joint.axis, static_cast<double>(dot(axisX(at.a), at.gap)));
        case JointKind::distance:
            return ofAxis(joint.axis, static_cast<double>(length(at.gap)));
        default:
            return 0;
    }
}

}  // namespace ragtop
