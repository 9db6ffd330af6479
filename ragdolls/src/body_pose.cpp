#include "ragtop/body_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "arm.h"
#include "joint_bodies.h"
#include "point_joint.h"
#include "support.h"

namespace ragtop {
namespace {

constexpr Vec3 kLeft{1, 0, 0}, kUp{0, 1, 0}, kForward{0, 0, 1};

const RagdollJoint* carrierOf(const RagdollDef& def, int part) {
    for (const RagdollJoint& joint : def.joints)
        if (joint.child == part) return &joint;
    return nullptr;
}

/// In the bone of the part.
Vec3 jointOf(const RagdollDef& def, int part) {
    const RagdollJoint* joint = carrierOf(def, part);
    return joint ? bodiesOf(joint->joint).frameB.position : Vec3{};
}

bool isLimb(BodyRole role) {
    return role == BodyRole::thigh || role == BodyRole::shank || role == BodyRole::upperArm ||
           role == BodyRole::forearm;
}

/// From the joint that carries a limb to the one that it carries, or else to the middle of its shape, in its bone.
Vec3 alongLimb(const RagdollDef& def, int part) {
    for (const RagdollJoint& joint : def.joints)
        if (joint.parent == part) return bodiesOf(joint.joint).frameA.position - jointOf(def, part);
    return def.parts[static_cast<std::size_t>(part)].frame.position - jointOf(def, part);
}

Quat turned(const PartAngles& angles) {
    const bool back = angles.role == BodyRole::shank, limb = isLimb(angles.role) || angles.role == BodyRole::hand;
    // What hangs swings forwards the other way than what stands leans.
    const float bend = (limb && !back) || angles.role == BodyRole::foot ? -angles.flexion : angles.flexion;
    const float out = angles.side == BodySide::right ? -1.0f : 1.0f;
    const float side = limb ? out : -1.0f;
    return rotationAbout(kLeft, bend) * rotationAbout(kForward, side * angles.abduction) *
           rotationAbout(kUp, out * angles.rotation);
}

}  // namespace

BodyAxes::BodyAxes(const RagdollDef& def) : def_(&def) {
    const int left = find(BodyRole::thigh, BodySide::left), right = find(BodyRole::thigh, BodySide::right);
    if (find(BodyRole::pelvis, BodySide::middle) < 0 || left < 0 || right < 0)
        throw std::invalid_argument("body: needs a pelvis, a left and a right thigh");
    const auto hip = [&](int part) {
        return transformPoint(def.parts[static_cast<std::size_t>(part)].bind, jointOf(def, part));
    };
    const auto end = [&](int part) {
        return transformPoint(def.parts[static_cast<std::size_t>(part)].bind,
                              jointOf(def, part) + alongLimb(def, part));
    };
    const Vec3 x = normalized(hip(left) - hip(right));
    Vec3 up = hip(left) + hip(right) - end(left) - end(right);
    up = normalized(up - dot(up, x) * x);
    const Quat model = conjugate(rotationFromAxes(x, up, cross(x, up)));
    for (std::size_t i = 0; i < def.parts.size(); ++i) {
        const RagdollPart& part = def.parts[i];
        Quat zero = normalized(model * part.bind.rotation);
        if (isLimb(part.role)) {
            const Vec3 along = normalized(rotate(zero, alongLimb(def, static_cast<int>(i))));
            zero = normalized(rotationBetween(along, -kUp) * zero);
        } else if (part.role == BodyRole::hand) {
            // As it is on its forearm at rest.
            if (const RagdollJoint* joint = carrierOf(def, static_cast<int>(i))) {
                const auto arm = static_cast<std::size_t>(joint->parent);
                zero = normalized(zeros_[arm] * conjugate(def.parts[arm].bind.rotation) * part.bind.rotation);
            }
        }
        zeros_.push_back(zero);
    }
}

int BodyAxes::find(BodyRole role, BodySide side) const {
    for (std::size_t i = 0; i < def_->parts.size(); ++i)
        if (def_->parts[i].role == role && def_->parts[i].side == side) return static_cast<int>(i);
    return -1;
}

void turnsOf(const BodyAxes& axes, std::span<const PartAngles> pose, std::span<Quat> turns) {
    const RagdollDef& def = axes.def();
    for (std::size_t j = 0; j < def.joints.size(); ++j) {
        const RagdollJoint& joint = def.joints[j];
        const RagdollPart& part = def.parts[static_cast<std::size_t>(joint.child)];
        Quat bent;
        for (const PartAngles& angles : pose)
            if (angles.role == part.role && angles.side == part.side) bent = turned(angles);
        const JointBodies& joined = bodiesOf(joint.joint);
        const Quat a = axes.zero(joint.parent) * joined.frameA.rotation;
        const Quat b = bent * axes.zero(joint.child) * joined.frameB.rotation;
        turns[j] = normalized(conjugate(a) * b);
    }
}

namespace {

/// Arms of which nothing is told hang, but for what wide trunks keep them off by: who is set up with a hand in its hip
/// is thrown.
std::vector<PartAngles> withArmsApart(const BodyAxes& axes, std::span<const PartAngles> pose) {
    std::vector<PartAngles> whole(pose.begin(), pose.end());
    for (const PartAngles& angles : pose)
        if (angles.role == BodyRole::upperArm) return whole;
    for (const BodySide side : {BodySide::left, BodySide::right})
        if (axes.find(BodyRole::upperArm, side) >= 0) whole.push_back({BodyRole::upperArm, side});
    const float apart = armsApart(axes, whole, 0, 0);
    if (!(apart > 0)) whole.resize(pose.size());
    for (std::size_t i = pose.size(); i < whole.size(); ++i) whole[i].abduction = apart;
    return whole;
}

}  // namespace

std::vector<Pose> standing(const BodyAxes& axes, const Pose& ground, std::span<const PartAngles> pose) {
    const RagdollDef& def = axes.def();
    std::vector<Quat> turns(def.joints.size());
    turnsOf(axes, withArmsApart(axes, pose), turns);
    std::vector<Pose> parts(def.parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i].rotation = axes.zero(static_cast<int>(i));
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        const RagdollJoint& joint = def.joints[i];
        const JointBodies& joined = bodiesOf(joint.joint);
        const Quat carrier = parts[static_cast<std::size_t>(joint.parent)].rotation * joined.frameA.rotation;
        parts[static_cast<std::size_t>(joint.child)].rotation =
            normalized(carrier * turns[i] * conjugate(joined.frameB.rotation));
    }
    closeJoints(def, parts);
    double lowest = std::numeric_limits<double>::infinity();
    DVec3 middle;
    for (const BodySide side : {BodySide::left, BodySide::right}) {
        const int foot = axes.find(BodyRole::foot, side);
        if (foot < 0) continue;
        const Pose& at = parts[static_cast<std::size_t>(foot)];
        for (const Vec3& corner : soleOf(axes, foot).corners) lowest = std::min(lowest, transformPoint(at, corner).y);
        middle = middle + 0.5 * at.position;
    }
    if (!std::isfinite(lowest)) lowest = 0;
    for (Pose& part : parts) {
        const Frame local{relative(part.position, {middle.x, lowest, middle.z}), part.rotation};
        part = ground * local;
    }
    std::vector<Pose> bones(def.bones.size());
    for (std::size_t i = 0; i < bones.size(); ++i)
        bones[i] = parts[static_cast<std::size_t>(def.bones[i].part)] * def.bones[i].inPart;
    return bones;
}

}  // namespace ragtop
