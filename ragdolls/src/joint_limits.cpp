#include "joint_limits.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr float kDegree = kPi / 180.0f;

/// Ranges of motion in degrees. Sources: Merck manual's list (hip, knee, elbow, ankle) and AAOS, Joint Motion, 1965
/// (shoulder, spine, neck, wrist, forearm). An asymmetric range a forward, b back becomes a cone of (a + b)/2 whose
/// axis is tilted by (a − b)/2.
struct BallRange {
    float tilt;   ///< of the cone's axis from the neutral direction, forward
    float swing;  ///< half angle of the cone
    float twist;  ///< either way
};

BallRange ballRange(const Anatomy& anatomy, BodyRole role) {
    // Of other bodies no tables exist; how they stand at rest is the middle of what they do.
    constexpr BallRange kOther{0.0f, 45.0f, 30.0f};
    if (!anatomy.isHuman()) return kOther;
    switch (role) {
        case BodyRole::thigh:
            return {55.0f, 70.0f, 45.0f};  // flexion 125, extension 15; rotation 45/45
        case BodyRole::upperArm:
            return {0.0f, 110.0f, 80.0f};  // flexion 180, extension 60; rotation 70/90
        case BodyRole::head:
            return {0.0f, 45.0f, 60.0f};  // flexion, extension, bending 45; rotation 60
        case BodyRole::abdomen:           // each half of flexion 75, extension 30
        case BodyRole::chest:
            return {11.25f, 26.25f, 20.0f};
        case BodyRole::hand:
            return {0.0f, 45.0f, 80.0f};  // 80/70 by 20/30; pronation, supination 80
        case BodyRole::foot:
            return {-15.0f, 35.0f, 30.0f};  // dorsal 20, plantar 50; inversion 35, eversion 25
        default:
            return kOther;
    }
}

/// Where the twist axis of a joint points when its angles are zero in the textbook.
Vec3 neutralAxis(const Anatomy& anatomy, const Segment& segment, const Vec3& atRest) {
    const Vec3 outward = segment.side == BodySide::right ? -anatomy.left : anatomy.left;
    if (!anatomy.isHuman()) return atRest;
    switch (segment.role) {
        case BodyRole::thigh:
            return -anatomy.up;
        // From the hanging arm 180° up in front and beside, 25° back, 25° across: a cone about this direction.
        case BodyRole::upperArm:
            return 0.8f * outward + 0.6f * anatomy.forward;
        case BodyRole::foot:
            return anatomy.forward;
        default:
            return atRest;
    }
}

/// `from` turned towards `to` (both unit) by an angle of at most theirs.
Vec3 turned(const Vec3& from, const Vec3& to, float angle) {
    const Vec3 side = normalized(to - dot(to, from) * from, perpendicular(from));
    const SinCos s = sinCos(angle);
    return s.cos * from + s.sin * side;
}

float angleBetween(const Vec3& a, const Vec3& b) { return arcTan2(length(cross(a, b)), dot(a, b)); }

Frame inBone(const Skeleton& skeleton, int bone, const Vec3& position, const Quat& rotation) {
    return inverse(skeleton.bones[static_cast<std::size_t>(bone)].bind) * Frame{position, rotation};
}

struct JointPlace {
    int boneA, boneB;
    Vec3 position;
};

BallDef ball(const Skeleton& skeleton, const Anatomy& anatomy, const Segment& segment, const JointPlace& place,
             float limitScale) {
    const BallRange range = ballRange(anatomy, segment.role);
    const Vec3 axis = normalized(segment.end - place.position, anatomy.up);
    Vec3 center = neutralAxis(anatomy, segment, axis);
    // Forward of an upright axis is where `forward` is; of the foot's it is where the shin is.
    const Vec3 ahead = segment.role == BodyRole::foot ? anatomy.up : anatomy.forward;
    const float tilt = range.tilt * kDegree;
    center = tilt < 0 ? turned(center, -ahead, -tilt) : tilt > 0 ? turned(center, ahead, tilt) : center;

    const float swing = std::min(range.swing * limitScale * kDegree, 3.0f);
    const float spare = std::min(5.0f * kDegree, 0.5f * swing);
    const float off = angleBetween(axis, center);
    if (off > swing - spare) center = turned(axis, center, swing - spare);

    const Vec3 sideways = perpendicular(axis);
    const Quat rotationB = rotationFromAxes(axis, sideways, cross(axis, sideways));
    const Quat rotationA = normalized(rotationBetween(axis, center) * rotationB);
    BallDef def;
    def.bodies.frameA = inBone(skeleton, place.boneA, place.position, rotationA);
    def.bodies.frameB = inBone(skeleton, place.boneB, place.position, rotationB);
    def.swingLimit = swing;
    const float twist = std::min(range.twist * limitScale * kDegree, 3.0f);
    def.twistLimit = Range{-twist, twist};
    return def;
}

/// Positive angles flex: the shank backwards, the forearm forwards. The angle at rest is measured, so that the range
/// from straight to fully bent is kept with its zero at rest.
HingeDef hinge(const Skeleton& skeleton, const Anatomy& anatomy, const Segment& segment, const JointPlace& place,
               const Vec3& upperStart, float limitScale) {
    const bool knee = segment.role == BodyRole::shank;
    const Vec3 upper = normalized(place.position - upperStart, -anatomy.up);
    const Vec3 lower = normalized(segment.end - place.position, upper);
    // Legs to the sides bend downwards.
    const Vec3 towards = anatomy.plan == BodyPlan::hexapod ? -anatomy.up : knee ? -anatomy.forward : anatomy.forward;
    Vec3 axis = normalized(cross(lower, towards), anatomy.left);
    const Vec3 bend = cross(upper, lower);
    // A limb that is visibly bent shows its own plane.
    if (length(bend) > 0.17f && dot(normalized(bend), axis) > 0.5f) axis = normalized(bend);
    const float atRest = arcTan2(dot(bend, axis), dot(upper, lower));

    const float flexion = (knee ? 130.0f : 150.0f) * limitScale * kDegree;  // Merck; AAOS; extension 0 in both
    HingeDef def;
    const Vec3 sideways = normalized(lower - dot(lower, axis) * axis, perpendicular(axis));
    const Quat rotation = rotationFromAxes(axis, sideways, cross(axis, sideways));
    def.bodies.frameA = inBone(skeleton, place.boneA, place.position, rotation);
    def.bodies.frameB = inBone(skeleton, place.boneB, place.position, rotation);
    def.limit = Range{std::min(-atRest, 0.0f), std::max(flexion - atRest, 0.1f * flexion)};
    return def;
}

}  // namespace

JointDef anatomicalJoint(const Skeleton& skeleton, const Anatomy& anatomy, int child, float limitScale) {
    const Segment& segment = anatomy.segments[static_cast<std::size_t>(child)];
    const Segment& carrier = anatomy.segments[static_cast<std::size_t>(segment.parent)];
    const Vec3 position = skeleton.bones[static_cast<std::size_t>(segment.bone)].bind.position;
    const JointPlace place{carrier.bone, segment.bone, position};
    if (segment.role == BodyRole::shank || segment.role == BodyRole::forearm) {
        const Vec3 upperStart = skeleton.bones[static_cast<std::size_t>(carrier.bone)].bind.position;
        return hinge(skeleton, anatomy, segment, place, upperStart, limitScale);
    }
    return ball(skeleton, anatomy, segment, place, limitScale);
}

}  // namespace ragtop
