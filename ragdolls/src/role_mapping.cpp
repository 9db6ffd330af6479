#include "role_mapping.h"

#include <algorithm>
#include <cmath>

#include "joint_bodies.h"
#include "leg.h"
#include "within_limits.h"

namespace ragtop {
namespace {

constexpr float kStraight = 0.1f, kBent = 0.35f;  ///< sines between which a bend begins to tell its plane
constexpr float kMostTwist = 1.0f;                ///< rad, that a bend may say more than the axis of the hinge
constexpr float kLimitMargin = 1e-4f;             ///< rad

Quat halfway(const Quat& a, const Quat& b, float share) {
    return blend(Pose{{}, a}, Pose{{}, b}, static_cast<double>(share)).rotation;
}

}  // namespace

RoleMapping::RoleMapping(const RetargetBody& from, const RetargetBody& to, bool keepLimits)
    : from_(from),
      to_(to),
      keepLimits_(keepLimits),
      chains_(matchChains(from, to)),
      chainOf_(to.def.bones.size(), -1),
      partAt_(to.def.bones.size(), -1),
      pelvis_(from.body.find(BodyRole::pelvis, BodySide::middle)),
      chest_(from.body.find(BodyRole::chest, BodySide::middle)) {
    // Parts of roles that come often, as those of tails, go by their order.
    for (std::size_t i = 0; i < to.def.parts.size(); ++i) {
        const RagdollPart& part = to.def.parts[i];
        const auto same = [&](const RagdollPart& other) { return other.role == part.role && other.side == part.side; };
        auto before = std::count_if(to.def.parts.begin(), to.def.parts.begin() + static_cast<std::ptrdiff_t>(i), same);
        int found = -1;
        for (std::size_t k = 0; k < from.def.parts.size() && found < 0; ++k)
            if (part.role != BodyRole::other && same(from.def.parts[k]) && before-- == 0) found = static_cast<int>(k);
        counterpart_.push_back(found);
        partAt_[static_cast<std::size_t>(part.bone)] = static_cast<int>(i);
    }
    for (std::size_t i = 0; i < chains_.size(); ++i)
        chainOf_[static_cast<std::size_t>(chains_[i].bone)] = static_cast<int>(i);
}

std::vector<int> RoleMapping::still() const {
    std::vector<int> parts;
    for (std::size_t i = 0; i < counterpart_.size(); ++i)
        if (counterpart_[i] < 0 && to_.def.parts[i].role != BodyRole::abdomen) parts.push_back(static_cast<int>(i));
    return parts;
}

int RoleMapping::parentOf(int part) const {
    const int joint = to_.carrier[static_cast<std::size_t>(part)];
    return joint < 0 ? -1 : to_.def.joints[static_cast<std::size_t>(joint)].parent;
}

/// Axes of the other body's bone, seen along its heading.
Quat RoleMapping::axesOf(std::span<const Pose> source, int bone) const {
    const auto i = static_cast<std::size_t>(bone);
    return conjugate(from_.heading) * source[i].rotation * from_.axes[i];
}

Quat RoleMapping::asAtRest(int part, std::span<const Quat> parts) const {
    const int parent = parentOf(part);
    const Quat& bind = to_.part(part).bind.rotation;
    return parent < 0 ? bind
                      : parts[static_cast<std::size_t>(parent)] * conjugate(to_.part(parent).bind.rotation) * bind;
}

Quat RoleMapping::wanted(std::span<const Pose> source, std::span<const Quat> parts, int part) const {
    const int other = counterpart_[static_cast<std::size_t>(part)];
    const Quat back = conjugate(to_.axes[static_cast<std::size_t>(to_.part(part).bone)]);
    const auto axes = [&](int theirs) { return axesOf(source, from_.part(theirs).bone); };
    if (other >= 0) return inPlane(part, source, to_.heading * axes(other) * back);
    if (to_.part(part).role == BodyRole::abdomen && pelvis_ >= 0 && chest_ >= 0)
        return to_.heading * halfway(axes(pelvis_), axes(chest_), 0.5f) * back;
    return asAtRest(part, parts);
}

/// Turns an upper limb about its length until its hinge lies across the plane that the other body's limb is bent in.
Quat RoleMapping::inPlane(int part, std::span<const Pose> source, const Quat& turn) const {
    const BodyRole role = to_.part(part).role;
    const int hinge = role == BodyRole::thigh || role == BodyRole::upperArm ? jointBeyond(to_.def, part) : -1;
    if (hinge < 0 || !std::holds_alternative<HingeDef>(to_.def.joints[static_cast<std::size_t>(hinge)].joint))
        return turn;
    const int lower = counterpart_[static_cast<std::size_t>(to_.def.joints[static_cast<std::size_t>(hinge)].child)];
    if (lower < 0) return turn;
    const auto down = [&](int theirs) {
        return rotate(to_.heading * axesOf(source, from_.part(theirs).bone), {0, -1, 0});
    };
    const Vec3 along = down(counterpart_[static_cast<std::size_t>(part)]), bend = cross(along, down(lower));
    const Vec3 axis =
        rotate(turn * bodiesOf(to_.def.joints[static_cast<std::size_t>(hinge)].joint).frameA.rotation, {1, 0, 0});
    const Vec3 level = axis - dot(axis, along) * along;
    if (dot(level, bend) <= 0) return turn;
    const float angle = arcTan2(dot(along, cross(level, bend)), dot(level, bend));
    const float sure = std::clamp((length(bend) - kStraight) / (kBent - kStraight), 0.0f, 1.0f);
    return rotationAbout(along, sure * sure * (3 - 2 * sure) * std::clamp(angle, -kMostTwist, kMostTwist)) * turn;
}

Quat RoleMapping::limited(int child, const Quat& parent, const Quat& turn) const {
    const int carrier = to_.carrier[static_cast<std::size_t>(child)];
    if (carrier < 0 || !keepLimits_) return normalized(turn);
    const RagdollJoint& joint = to_.def.joints[static_cast<std::size_t>(carrier)];
    const JointBodies& joined = bodiesOf(joint.joint);
    const Quat kept = withinLimits(joint.joint, turnOf(joint, parent, turn), kLimitMargin);
    return normalized(parent * joined.frameA.rotation * kept * conjugate(joined.frameB.rotation));
}

void RoleMapping::turn(std::span<const Pose> source, std::span<Quat> parts, bool limitFeet) const {
    for (int part = 0; part < static_cast<int>(parts.size()); ++part) {
        const int parent = parentOf(part);
        const Quat turn = normalized(wanted(source, parts, part));
        const bool free = parent < 0 || (!limitFeet && to_.part(part).role == BodyRole::foot);
        parts[static_cast<std::size_t>(part)] =
            free ? turn : limited(part, parts[static_cast<std::size_t>(parent)], turn);
    }
}

void RoleMapping::place(std::span<const Pose> source, std::span<const Quat> parts, const Vec3& hips,
                        std::span<Frame> bones) const {
    for (std::size_t i = 0; i < bones.size(); ++i) {
        const Bone& bone = to_.skeleton.bones[i];
        Frame at = bone.bind;
        if (bone.parent >= 0) {
            const auto parent = static_cast<std::size_t>(bone.parent);
            at = bones[parent] * (inverse(to_.skeleton.bones[parent].bind) * bone.bind);
        }
        if (partAt_[i] >= 0) {
            at.rotation = parts[static_cast<std::size_t>(partAt_[i])];
        } else if (bone.parent < 0) {
            const RagdollBone& root = to_.def.bones[i];
            at.rotation = parts[static_cast<std::size_t>(root.part)] * root.inPart.rotation;
        } else if (chainOf_[i] >= 0) {
            const ChainBone& chain = chains_[static_cast<std::size_t>(chainOf_[i])];
            const Quat axes = halfway(axesOf(source, chain.before), axesOf(source, chain.after), chain.share);
            at.rotation = to_.heading * axes * conjugate(to_.axes[i]);
        }
        at.rotation = normalized(at.rotation);
        bones[i] = at;
    }
    Vec3 middle;
    for (const int thigh : to_.thighs)
        middle += 0.5f * transformPoint(bones[static_cast<std::size_t>(to_.part(thigh).bone)], to_.jointInBone(thigh));
    for (Frame& bone : bones) bone.position += hips - middle;
}

}  // namespace ragtop
