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

/// The hardest of what acts on a motion of the inverse mass w.
struct Measure {
    float w, h;
    Hardness hardest;

    void spring(const SpringTuning& tuning) {
        const TunedSpring spring = tuning.at(w);
        damper(spring.damping);
        if (!(spring.stiffness > 0 && w > 0)) return;
        const float ratio = 0.5f * spring.damping * std::sqrt(w / spring.stiffness);
        stiffness(h * h * spring.stiffness * w / std::clamp(kDamped * ratio, kLeast, kMost));
    }
    /// The iteration knows the trajectory of a softer one (StopTrajectory).
    void stop(const Stop& stop) { stiffness(h * h * stop.stiffness * w / kMost); }
    void damper(float damping) { hardest.braking = std::max(hardest.braking, h * damping * w); }
    void stiffness(float z) { hardest.stiffness = std::max(hardest.stiffness, z); }
};

Hardness hardness(const AxisRows& axis, float w, float h) {
    Measure most{w, h, {}};
    if (axis.features & AxisRows::kSpring) most.spring(axis.spring.tuning);
    if (axis.features & AxisRows::kViscous) most.damper(axis.resistance.viscous);
    if (axis.features & AxisRows::kLimit) most.stop(axis.stop);
    return most.hardest;
}

Hardness hardness(const BallRows& ball, const BallDrives& drives, float w, float h) {
    Measure most{w, h, {}};
    if (ball.features & BallRows::kSpring) most.spring(ball.spring.tuning);
    if (ball.features & BallRows::kDrives) most.spring(drives.swing), most.spring(drives.twist);
    if (ball.features & BallRows::kViscous) most.damper(ball.resistance.viscous);
    if (ball.features & (BallRows::kSwing | BallRows::kTwist)) most.stop(ball.stop);
    return most.hardest;
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

Hardness hardnessOf(const JointSim& joint, const BodyState* states, const BodyInertia* inertia, float h) {
    RelativeMass inverse;
    for (const std::uint32_t body : {joint.stateA, joint.stateB}) {
        inverse.travel += states[body].invMass;
        inverse.turn += easiest(inertia[body]);
    }
    if (joint.kind == JointKind::ball) return hardness(joint.ball, joint.drives, inverse.turn, h);
    if (joint.kind == JointKind::hinge) return hardness(joint.axis, inverse.turn, h);
    if (!hasAxes(joint.kind)) {
        Hardness along = hardness(joint.axis, inverse.travel, h);
        if (joint.axis.features & AxisRows::kSpring)
            along.travel = joint.axis.spring.tuning.at(inverse.travel).stiffness;
        return along;
    }
    Hardness most;
    for (int f = 0; f < AxesBlock::kMostFree; ++f) {
        const Hardness of =
            hardness(withAxes(joint).axes.axis[f], turns(joint.kind, f) ? inverse.turn : inverse.travel, h);
        most = {std::max(most.stiffness, of.stiffness), std::max(most.braking, of.braking), 0};
    }
    return most;
}

}  // namespace ragtop
