#include <cmath>
#include <stdexcept>
#include <string>

#include "constraints/joint_drive.h"
#include "world/world_impl.h"

namespace ragtop {
namespace {

constexpr float kMostGain = 1e12f, kMostSpeed = 1e5f, kMostAngle = 1e5f;  ///< as describe of joint_parts.h has them

bool within(const Vec3& v, float most) {
    return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

/// The field that is not allowed and what is; null where all are.
const char* whyInvalid(const JointDrive& drive) {
    if (!(std::abs(drive.angle) <= kMostAngle)) return "angle must be in [-1e5, 1e5] rad";
    if (!within(drive.speed, kMostSpeed)) return "speed must be in [-1e5, 1e5] rad/s";
    if (!within(drive.feedForward, kMostGain)) return "feedForward must be in [-1e12, 1e12] N m";
    if (!(drive.stiffness >= 0 && drive.stiffness <= kMostGain)) return "stiffness must be in [0, 1e12] N m/rad";
    if (!(drive.damping >= 0 && drive.damping <= kMostGain)) return "damping must be in [0, 1e12] N m s/rad";
    if (!(drive.maxTorque >= 0)) return "maxTorque must be at least 0 N m";
    const Quat& q = drive.target;
    const float square = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (!(std::abs(square - 1) <= 2e-3f)) return "target must be finite and have length 1 to within 0.001";
    return nullptr;
}

}  // namespace

void World::setDrives(std::span<const JointDrive> drives) {
    for (std::size_t k = 0; k < drives.size(); ++k) {
        const JointDef& def = impl_->tables.joints[indexOf(impl_->tables.joints, drives[k].joint)].def;
        const char* problem = std::holds_alternative<BallDef>(def) || std::holds_alternative<HingeDef>(def)
                                  ? whyInvalid(drives[k])
                                  : "joint must be a ball or a hinge";
        if (problem) throw std::invalid_argument("drives[" + std::to_string(k) + "]: " + problem);
    }
    for (const JointDrive& drive : drives) {
        const std::uint32_t i = indexOf(impl_->tables.joints, drive.joint);
        JointRecord& joint = impl_->tables.joints[i];
        if (!setDrive(joint.def, drive)) continue;
        if (!setDrive(impl_->tables.joints.sims[i], joint.def)) impl_->scene().compile(i);
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (impl_->tables.bodies.moves(body) && !impl_->tables.bodies.isAwake(body))
                impl_->activity().wakeBody(body);
    }
}

}  // namespace ragtop
