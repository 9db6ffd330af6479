#include "leg.h"

#include <algorithm>
#include <cmath>

#include "joint_bodies.h"

namespace ragtop {
namespace {

int jointTo(const RagdollDef& def, int part) {
    for (std::size_t i = 0; i < def.joints.size(); ++i)
        if (def.joints[i].child == part) return static_cast<int>(i);
    return -1;
}

const JointBodies& at(const RagdollDef& def, int joint) {
    return bodiesOf(def.joints[static_cast<std::size_t>(joint)].joint);
}

}  // namespace

Quat turnOf(const RagdollJoint& joint, const Quat& parent, const Quat& child) {
    const JointBodies& joined = bodiesOf(joint.joint);
    return normalized(conjugate(parent * joined.frameA.rotation) * (child * joined.frameB.rotation));
}

std::optional<Leg> legOf(const BodyAxes& axes, BodySide side) {
    const RagdollDef& def = axes.def();
    Leg leg;
    leg.thigh = axes.find(BodyRole::thigh, side);
    leg.shank = axes.find(BodyRole::shank, side);
    leg.foot = axes.find(BodyRole::foot, side);
    if (leg.thigh < 0 || leg.shank < 0 || leg.foot < 0) return {};
    leg.hip = jointTo(def, leg.thigh);
    leg.knee = jointTo(def, leg.shank);
    leg.ankle = jointTo(def, leg.foot);
    const auto isBetween = [&](int joint, int parent) {
        return joint >= 0 && def.joints[static_cast<std::size_t>(joint)].parent == parent;
    };
    if (!isBetween(leg.hip, axes.find(BodyRole::pelvis, BodySide::middle)) || !isBetween(leg.knee, leg.thigh) ||
        !isBetween(leg.ankle, leg.shank))
        return {};
    const auto* knee = std::get_if<HingeDef>(&def.joints[static_cast<std::size_t>(leg.knee)].joint);
    if (!knee) return {};
    leg.hipInPelvis = at(def, leg.hip).frameA.position;
    leg.hipInThigh = at(def, leg.hip).frameB.position;
    leg.kneeInThigh = knee->bodies.frameA.position;
    leg.kneeInShank = knee->bodies.frameB.position;
    leg.ankleInShank = at(def, leg.ankle).frameA.position;
    leg.ankleInFoot = at(def, leg.ankle).frameB.position;
    leg.kneeAxis = rotate(knee->bodies.frameA.rotation, {1, 0, 0});
    leg.kneeRange = knee->limit.value_or(Range{-kPi, kPi});
    leg.length = ragtop::length(leg.kneeInThigh - leg.hipInThigh) + ragtop::length(leg.ankleInShank - leg.kneeInShank);
    return leg;
}

/// |u + R(a, q) v|² = |u|² + |v|² + 2 (u·a)(v·a) + 2 |u⊥| |v⊥| cos(q + φ), with u from hip to knee and v from knee to
/// ankle at q = 0, both in the thigh, and φ the angle from u⊥ to v⊥ about the knee's axis a.
Leg::Bent Leg::reachFrom(const RagdollDef& def, const Quat& from, const Vec3& hipPoint, const Quat& footTurn,
                         const Vec3& anklePoint) const {
    const JointBodies& bound = at(def, knee);
    const Quat straight = bound.frameA.rotation * conjugate(bound.frameB.rotation);
    const Vec3 u = kneeInThigh - hipInThigh, v = rotate(straight, ankleInShank - kneeInShank);
    const Vec3 to = anklePoint - hipPoint;
    const float ua = dot(u, kneeAxis), va = dot(v, kneeAxis);
    const Vec3 uAcross = u - ua * kneeAxis, vAcross = v - va * kneeAxis;
    const float size = ragtop::length(uAcross) * ragtop::length(vAcross);
    const float wanted = (lengthSquared(to) - lengthSquared(u) - lengthSquared(v) - 2 * ua * va) / (2 * size);
    const float cosine = std::clamp(wanted, -1.0f, 1.0f);
    const float bend = arcTan2(std::sqrt(1 - cosine * cosine), cosine);
    const float phase = arcTan2(dot(kneeAxis, cross(uAcross, vAcross)), dot(uAcross, vAcross));
    const auto beyond = [&](float q) { return std::max({kneeRange.lower - q, q - kneeRange.upper, 0.0f}); };
    const float one = bend - phase, other = -bend - phase;
    const float angle = std::clamp(beyond(one) < beyond(other) ? one : other, kneeRange.lower, kneeRange.upper);
    const Quat shankInThigh = rotationAbout(kneeAxis, angle) * straight;
    const Vec3 reached = u + rotate(rotationAbout(kneeAxis, angle), v);
    Bent bent;
    bent.thigh = normalized(rotationBetween(normalized(rotate(from, reached)), normalized(to)) * from);
    bent.shank = normalized(bent.thigh * shankInThigh);
    bent.foot = footTurn;
    return bent;
}

/// The thigh hangs as in who stands with this pelvis, and from there turns the shortest way.
Leg::Bent Leg::reach(const BodyAxes& axes, const Quat& pelvis, const Vec3& hipPoint, const Quat& footTurn,
                     const Vec3& anklePoint) const {
    const Quat hanging =
        pelvis * conjugate(axes.zero(axes.find(BodyRole::pelvis, BodySide::middle))) * axes.zero(thigh);
    return reachFrom(axes.def(), hanging, hipPoint, footTurn, anklePoint);
}

}  // namespace ragtop
