#include <algorithm>
#include <cmath>
#include <variant>

#include "gltf/physics_joints.h"

namespace ragtop {
namespace {

/// Says a joint as limits and drives, coordinate by coordinate.
class Teller {
public:
    GltfJoint said{};

    void lockTravel(std::vector<int> axes) {
        said.limits.push_back({.min = 0.0f, .max = 0.0f, .linearAxes = std::move(axes)});
    }
    void lockTurn(std::vector<int> axes) {
        said.limits.push_back({.min = 0.0f, .max = 0.0f, .angularAxes = std::move(axes)});
    }
    void travel(int axis, const auto& def) { tell(GltfDriveType::linear, axis, def); }
    void turn(int axis, const auto& def) { tell(GltfDriveType::angular, axis, def); }
    void range(GltfDriveType type, std::vector<int> axes, const Range& range, const Stop& stop) {
        GltfLimit limit{.min = range.lower, .max = range.upper};
        if (stop.stiffness > 0) {
            limit.stiffness = stop.stiffness;
            limit.damping = stop.damping;
        }
        (type == GltfDriveType::linear ? limit.linearAxes : limit.angularAxes) = std::move(axes);
        said.limits.push_back(std::move(limit));
    }
    void drive(GltfDriveType type, int axis, const Spring& spring, float target, float speed, float most) {
        GltfDrive drive{.type = type, .axis = axis, .positionTarget = target, .velocityTarget = speed};
        if (most < kNoForceLimit) drive.maxForce = most;
        if (spring.frequency > 0) {
            const float omega = 2 * kPi * spring.frequency;
            drive.mode = GltfDriveMode::acceleration;
            drive.stiffness = omega * omega;
            drive.damping = 2 * spring.dampingRatio * omega;
        } else {
            drive.stiffness = spring.stiffness;
            drive.damping = spring.damping;
        }
        said.drives.push_back(drive);
    }

private:
    void tell(GltfDriveType type, int axis, const auto& def) {
        if (def.limit) range(type, {axis}, *def.limit, def.stop);
        if (def.spring) drive(type, axis, *def.spring, def.target, def.spring->speed, def.spring->maxForce);
    }
};

constexpr auto kTurning = GltfDriveType::angular;

/// rad, of the corner that is farthest from the axis.
float widestOf(const ReachPolygon& reach) {
    float widest = 0;
    for (int i = 0; i < reach.count; ++i) {
        const Vec3 direction = normalized(reach.corners[static_cast<std::size_t>(i)].direction);
        widest = std::max(widest, std::atan2(std::hypot(direction.y, direction.z), direction.x));
    }
    return widest;
}

void tellBall(Teller& to, const BallDef& ball) {
    to.lockTravel({0, 1, 2});
    const auto cone = [&](float angle) { to.range(kTurning, {1, 2}, {0, angle}, ball.stop); };
    if (ball.swingLimit) cone(*ball.swingLimit);
    if (ball.swingEllipse) cone(std::max(ball.swingEllipse->y, ball.swingEllipse->z));
    if (ball.reach) cone(widestOf(*ball.reach));
    if (ball.swingPyramid) {
        to.range(kTurning, {1}, ball.swingPyramid->y, ball.stop);
        to.range(kTurning, {2}, ball.swingPyramid->z, ball.stop);
    }
    if (ball.twistLimit) to.range(kTurning, {0}, *ball.twistLimit, ball.stop);
    const Vec3 target = rotationVector(ball.target);
    const auto drive = [&](int axis, const Spring& spring) {
        to.drive(kTurning, axis, spring, target[axis], ball.targetSpeed[axis], ball.maxSpringTorque);
    };
    if (ball.spring) drive(1, *ball.spring), drive(2, *ball.spring);
    if (ball.twistSpring)
        drive(0, *ball.twistSpring);
    else if (ball.spring)
        drive(0, *ball.spring);
}

void tellJoint(Teller& to, const BallDef& def) { tellBall(to, def); }
void tellJoint(Teller& to, const FixedDef&) { to.lockTravel({0, 1, 2}), to.lockTurn({0, 1, 2}); }
void tellJoint(Teller& to, const HingeDef& def) {
    to.lockTravel({0, 1, 2}), to.lockTurn({1, 2});
    to.turn(0, def);
}
void tellJoint(Teller& to, const SliderDef& def) {
    to.lockTravel({1, 2}), to.lockTurn({0, 1, 2});
    to.travel(0, def);
}
void tellJoint(Teller& to, const DistanceDef& def) {
    if (def.limit) to.range(GltfDriveType::linear, {0, 1, 2}, *def.limit, def.stop);
}
void tellJoint(Teller& to, const CylindricalDef& def) {
    to.lockTravel({1, 2}), to.lockTurn({1, 2});
    to.turn(0, def.turn), to.travel(0, def.travel);
}
void tellJoint(Teller& to, const UniversalDef& def) {
    to.lockTravel({0, 1, 2}), to.lockTurn({2});
    to.turn(0, def.first), to.turn(1, def.second);
}
void tellJoint(Teller& to, const PlaneDef& def) {
    to.lockTravel({0}), to.lockTurn({1, 2});
    to.travel(1, def.y), to.travel(2, def.z), to.turn(0, def.turn);
}
void tellJoint(Teller& to, const ScrewDef& def) {
    to.lockTravel({1, 2}), to.lockTurn({1, 2});
    to.turn(0, def.turn);
}
void tellJoint(Teller&, const PathDef&) {}
void tellJoint(Teller& to, const SixDofDef& def) {
    to.travel(0, def.x), to.travel(1, def.y), to.travel(2, def.z);
    to.turn(0, def.twist), to.turn(1, def.swingY), to.turn(2, def.swingZ);
}

}  // namespace

GltfJoint gltfFromJoint(const JointDef& joint) {
    Teller teller;
    std::visit([&](const auto& def) { tellJoint(teller, def); }, joint);
    return std::move(teller.said);
}

}  // namespace ragtop
