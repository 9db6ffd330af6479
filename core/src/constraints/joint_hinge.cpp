// A hinge: B turns about the x axis of both joint frames. With p the anchors, x the axes in the world and E two
// directions across xB,
//   C₁ = pB − pA                          Ċ₁ = vB + ωB × rB − vA − ωA × rA        three linear rows
//   C₂ = Eᵀ 2 sin(θ/2) xA × xB/|xA × xB|   Ċ₂ ≈ Eᵀ (ωB − ωA)                       two angular rows
// θ being the angle between the axes. All five are one block (rows.h). Free is ωrel · xB, the rate of the angle about
// x, along which limits, spring, friction and motor act (axis_rows.h).

#include "constraints/joint_angle.h"
#include "constraints/joint_constants.h"
#include "constraints/joint_types.h"

namespace ragtop {

float angleAboutX(const Quat& q) {
    const float angle = q.w < 0 ? 2 * jointAngle(-q.x, -q.w) : 2 * jointAngle(q.x, q.w);
    return angle > -kPi ? angle : kPi;
}

Vec3 axisError(const Vec3& xA, const Vec3& xB) {
    // |xA × xB| = 2 sin(θ/2) cos(θ/2), and 1 + xA · xB = 2 cos²(θ/2).
    const Vec3 axis = cross(xA, xB);
    const float onePlusCos = 1 + dot(xA, xB);
    if (onePlusCos > kOpposite) return std::sqrt(2 / onePlusCos) * axis;
    return 2.0f * normalized(axis, perpendicular(xB));
}

/// The errors, masses and margins of now; at the beginning of a substep also the aims of the scalar rows.
void refreshHinge(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    const Vec3 xA = axisX(place.a), yA = axisY(place.a), xB = axisX(place.b);
    RigidBlock& block = joint.block;
    const Vec3 y = normalized(yA - dot(yA, xB) * xB, perpendicular(xB));
    block.basis = {y, cross(xB, y), xB};
    block.errorFirst = place.gap;
    block.errorSecond = transposeTimes(block.basis, axisError(xA, xB));
    block.impulseSecond -= dot(block.impulseSecond, xB) * xB;
    refreshMass(block, pair.mass(joint.arms), true);
    const float mass = block.second.inverse[2];
    joint.axis.inverseMass = mass > 0 ? 1 / mass : 0.0f;
    const float raw = hingeAngle(place.a, place.b);
    track(joint.axis, raw);
    const double angle = unwrapped(joint.axis, raw);
    setMargins(joint.axis, angle);
    if (!refresh.begins) return;
    const Vec3 load = block.impulseFirst - dot(block.impulseFirst, xB) * xB;
    const bool hadImpact =
        beginAxis(joint.axis, angle, dot(xB, pair.velocity(joint.arms).angular), length(load), refresh.context);
    beginBlock(block, hadImpact);
}

}  // namespace ragtop
