#include "constraints/stiffness.h"

#include <algorithm>
#include <cmath>

namespace ragtop {

namespace {

// Measured on trees of 3 to 16 bodies; see the header.
constexpr float kDamped = 14, kLeast = 0.03f, kMost = 1;

/// Inverse, of what nothing else holds.
struct RelativeMass {
    float travel = 0;  ///< 1/kg
    float turn = 0;    ///< 1/(kg m²)
};

float stiffness(const TunedSpring& spring, float inverseMass, float h) {
    if (!(spring.stiffness > 0 && inverseMass > 0)) return 0;
    const float z = h * h * spring.stiffness * inverseMass;
    const float ratio = 0.5f * spring.damping * std::sqrt(inverseMass / spring.stiffness);
    return z / std::clamp(kDamped * ratio, kLeast, kMost);
}

/// The iteration knows the trajectory of a softer one (StopTrajectory).
float stiffness(const Stop& stop, float inverseMass, float h) { return h * h * stop.stiffness * inverseMass / kMost; }

float stiffness(const AxisRows& axis, bool turns, const RelativeMass& inverse, float h) {
    const float w = turns ? inverse.turn : inverse.travel;
    const bool sprung = (axis.features & AxisRows::kSpring) != 0, stops = (axis.features & AxisRows::kLimit) != 0;
    const TunedSpring spring = axis.spring.tuning.at(w);
    return std::max(sprung ? stiffness(spring, w, h) : 0.0f, stops ? stiffness(axis.stop, w, h) : 0.0f);
}

float stiffness(const BallRows& ball, const BallDrives& drives, float w, float h) {
    float most = 0;
    const auto note = [&](const SpringTuning& spring) { most = std::max(most, stiffness(spring.at(w), w, h)); };
    if (ball.features & BallRows::kSpring) note(ball.spring.tuning);
    if (ball.features & BallRows::kDrives) note(drives.swing), note(drives.twist);
    if (ball.features & (BallRows::kSwing | BallRows::kTwist)) most = std::max(most, stiffness(ball.stop, w, h));
    return most;
}

/// Is a coordinate of a joint of more axes an angle? In the order in which joint_axes.cpp and joint_six_dof.cpp write
/// them.
bool turns(JointKind kind, int coordinate) {
    switch (kind) {
        case JointKind::cylindrical:
        case JointKind::plane:
            return coordinate == 0;
        case JointKind::sixDof:
            return coordinate < 3;
        case JointKind::path:
            return false;
        default:
            return true;
    }
}

/// Next to the largest principal one, and the same however the body is turned, so that what is chosen by it is chosen
/// again from a restored state.
float easiest(const BodyInertia& inverse) {
    const Vec3 along{inverse.xx, inverse.yy, inverse.zz}, across{inverse.xy, inverse.xz, inverse.yz};
    return std::sqrt(lengthSquared(along) + 2 * lengthSquared(across));
}

}  // namespace

float stiffnessOf(const JointSim& joint, const BodyState* states, const BodyInertia* inertia, float h) {
    RelativeMass inverse;
    for (const std::uint32_t body : {joint.stateA, joint.stateB}) {
        inverse.travel += states[body].invMass;
        inverse.turn += easiest(inertia[body]);
    }
    if (joint.kind == JointKind::ball) return stiffness(joint.ball, joint.drives, inverse.turn, h);
    if (!hasAxes(joint.kind)) return stiffness(joint.axis, joint.kind == JointKind::hinge, inverse, h);
    float most = 0;
    for (int f = 0; f < AxesBlock::kMostFree; ++f)
        most = std::max(most, stiffness(withAxes(joint).axes.axis[f], turns(joint.kind, f), inverse, h));
    return most;
}

}  // namespace ragtop
