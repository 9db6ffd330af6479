#include "retarget_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "joint_bodies.h"
#include "shape_corners.h"

namespace ragtop {
namespace {

constexpr float kUpright = 0.7f;    ///< cosine between the legs and y of who stands
constexpr float kNearAxis = 0.26f;  ///< rad: who looks this near to an axis of model space looks along it
constexpr float kRaised = 0.03f;    ///< of the height: ankles this far apart are those of a stride
constexpr float kLeastBall = 0.4f;  ///< of the sole from its heel, where toes begin that bend
constexpr float kGreatestBall = 0.9f;

constexpr BodySide kSides[] = {BodySide::left, BodySide::right};

bool isUpper(BodyRole role) { return role == BodyRole::thigh || role == BodyRole::upperArm; }
bool isLower(BodyRole role) { return role == BodyRole::shank || role == BodyRole::forearm; }

Vec3 across(const Vec3& v, const Vec3& axis) { return v - dot(v, axis) * axis; }

/// The bone of a foot that its toes turn in: the first on the way to the farthest one; −1 where there is none.
int toeOf(const RagdollDef& def, int foot) {
    const RagdollPart& part = def.parts[static_cast<std::size_t>(foot)];
    int toe = -1;
    float farthest = 0;
    for (std::size_t i = 0; i < def.bones.size(); ++i) {
        const float away = length(def.bones[i].inPart.position);
        if (def.bones[i].part != foot || static_cast<int>(i) == part.bone || away <= farthest) continue;
        farthest = away;
        toe = static_cast<int>(i);
    }
    while (toe >= 0 && def.bones[static_cast<std::size_t>(toe)].parent != part.bone)
        toe = def.bones[static_cast<std::size_t>(toe)].parent;
    return toe;
}

}  // namespace

int jointBeyond(const RagdollDef& def, int part) {
    for (std::size_t i = 0; i < def.joints.size(); ++i)
        if (def.joints[i].parent == part) return static_cast<int>(i);
    return -1;
}

RetargetBody::RetargetBody(const RagdollDef& from) : def(from), body(from), skeleton(skeletonOf(from)) {
    carrier.assign(def.parts.size(), -1);
    for (std::size_t i = 0; i < def.joints.size(); ++i)
        carrier[static_cast<std::size_t>(def.joints[i].child)] = static_cast<int>(i);
    for (std::size_t side = 0; side < 2; ++side) thighs[side] = body.find(BodyRole::thigh, kSides[side]);
    hips = 0.5f * (jointAtRest(thighs[0]) + jointAtRest(thighs[1]));
    findHeading();
    std::vector<Quat> rest(def.parts.size());
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = restAxes(static_cast<int>(i));
    placeFeet(rest);
    for (const RagdollBone& bone : def.bones) {
        const RagdollPart& its = part(bone.part);
        axes.push_back(normalized(conjugate(its.bind.rotation * bone.inPart.rotation) *
                                  rest[static_cast<std::size_t>(bone.part)]));
    }
}

Vec3 RetargetBody::jointInBone(int index) const {
    const int joint = carrier[static_cast<std::size_t>(index)];
    return joint < 0 ? Vec3{} : bodiesOf(def.joints[static_cast<std::size_t>(joint)].joint).frameB.position;
}

/// To the left between two joints at rest, unit; zero where there are not both.
Vec3 RetargetBody::lateral(BodyRole role) const {
    const int left = body.find(role, BodySide::left), right = body.find(role, BodySide::right);
    return left < 0 || right < 0 ? Vec3{} : normalized(jointAtRest(left) - jointAtRest(right));
}

void RetargetBody::findHeading() {
    Vec3 up;
    for (const int thigh : thighs) {
        const int knee = jointBeyond(def, thigh);
        const int shank = knee < 0 ? -1 : def.joints[static_cast<std::size_t>(knee)].child;
        const int ankle = shank < 0 ? -1 : jointBeyond(def, shank);
        const int last = ankle >= 0 ? def.joints[static_cast<std::size_t>(ankle)].child : shank;
        if (last >= 0) up += jointAtRest(thigh) - jointAtRest(last);
    }
    up = normalized(up, {0, 1, 0});
    const bool upright = up.y > kUpright;
    if (upright) up = {0, 1, 0};
    const Vec3 left = normalized(across(lateral(BodyRole::thigh) + lateral(BodyRole::upperArm), up));
    const Vec3 forward = cross(left, up);
    heading = rotationFromAxes(left, up, forward);
    if (!upright) return;
    const float yaw = arcTan2(forward.x, forward.z), quarter = 0.5f * kPi * std::round(yaw / (0.5f * kPi));
    if (std::abs(yaw - quarter) < kNearAxis) heading = rotationAbout({0, 1, 0}, quarter);
}

/// Axes of a part in model space at rest.
Quat RetargetBody::restAxes(int index) const {
    const RagdollPart& its = part(index);
    if (isUpper(its.role) || isLower(its.role)) return limbAxes(index);
    if (its.role == BodyRole::hand && carrier[static_cast<std::size_t>(index)] >= 0)
        return restAxes(def.joints[static_cast<std::size_t>(carrier[static_cast<std::size_t>(index)])].parent);
    // Pelvis and chest lie as hips and shoulders do, however a stride has turned them.
    const Vec3 line = its.role == BodyRole::pelvis  ? lateral(BodyRole::thigh)
                      : its.role == BodyRole::chest ? lateral(BodyRole::upperArm)
                                                    : Vec3{};
    const Vec3 up = rotate(heading, {0, 1, 0});
    if (!(lengthSquared(line) > 0)) return heading;
    const Vec3 upAcross = normalized(across(up, line), up);
    return rotationFromAxes(line, upAcross, cross(line, upAcross));
}

/// y from the far joint to the near one, x along the axis of the hinge between the parts of the limb.
Quat RetargetBody::limbAxes(int index) const {
    const int beyond = jointBeyond(def, index),
              hinge = isLower(part(index).role) ? carrier[static_cast<std::size_t>(index)] : beyond;
    const Vec3 near = jointAtRest(index);
    const Vec3 far = beyond >= 0 ? jointAtRest(def.joints[static_cast<std::size_t>(beyond)].child)
                                 : transformPoint(part(index).bind, part(index).frame.position);
    const Vec3 y = normalized(near - far, rotate(heading, {0, 1, 0}));
    Vec3 axis = rotate(heading, {1, 0, 0});
    if (hinge >= 0) {
        const RagdollJoint& joint = def.joints[static_cast<std::size_t>(hinge)];
        if (std::holds_alternative<HingeDef>(joint.joint))
            axis = rotate(part(joint.parent).bind.rotation * bodiesOf(joint.joint).frameA.rotation, {1, 0, 0});
    }
    const Vec3 x = normalized(across(axis, y), perpendicular(y));
    return rotationFromAxes(x, y, cross(x, y));
}

/// Flat at rest, toes ahead. Returns the pitch of the way to the toes, rad.
float RetargetBody::placeFoot(std::size_t side, std::vector<Quat>& rest) {
    FootPoints& foot = feet[side];
    const Vec3 up = rotate(heading, {0, 1, 0});
    foot.joint = jointInBone(foot.part);
    Quat& lies = rest[static_cast<std::size_t>(foot.part)];
    float pitch = 0;
    if (const int toe = toeOf(def, foot.part); toe >= 0) {
        const Vec3 at = skeleton.bones[static_cast<std::size_t>(toe)].bind.position - jointAtRest(foot.part);
        const Vec3 forward = normalized(across(at, up), rotate(heading, {0, 0, 1}));
        lies = rotationFromAxes(cross(up, forward), up, forward);
        pitch = arcTan2(dot(at, up), dot(at, forward));
    }
    putOnSole(foot, lies);
    return pitch;
}

/// In a stride only the lower foot lies flat, and the other would be pitched as that one is.
void RetargetBody::placeFeet(std::vector<Quat>& rest) {
    const int shank = body.find(BodyRole::shank, BodySide::left);
    height = shank < 0 ? 1.0f : 2 * length(jointAtRest(thighs[0]) - jointAtRest(shank));
    for (std::size_t side = 0; side < 2; ++side) feet[side].part = body.find(BodyRole::foot, kSides[side]);
    if (shank < 0 || feet[0].part < 0 || feet[1].part < 0) return;
    const std::array<float, 2> pitch{placeFoot(0, rest), placeFoot(1, rest)};
    const Vec3 up = rotate(heading, {0, 1, 0});
    const auto ankle = [&](std::size_t side) { return dot(jointAtRest(feet[side].part), up); };
    const std::size_t low = ankle(0) <= ankle(1) ? 0 : 1, high = 1 - low;
    const auto axesInBone = [&](std::size_t side) {
        return conjugate(part(feet[side].part).bind.rotation) * rest[static_cast<std::size_t>(feet[side].part)];
    };
    const float leg = 0.5f * height + length(jointAtRest(shank) - jointAtRest(feet[0].part));
    if (ankle(high) - ankle(low) > kRaised * leg) {
        Quat& lies = rest[static_cast<std::size_t>(feet[high].part)];
        lies = normalized(lies * rotationAbout({1, 0, 0}, pitch[low] - pitch[high]));
        for (Vec3 FootPoints::*point : {&FootPoints::heel, &FootPoints::ball, &FootPoints::tip}) {
            Vec3 mirrored = inverseRotate(axesInBone(low), feet[low].*point - feet[low].joint);
            mirrored.x = -mirrored.x;
            feet[high].*point = feet[high].joint + rotate(axesInBone(high), mirrored);
        }
    }
    ground = dot(transformPoint(part(feet[low].part).bind, feet[low].heel), up);
    height = leg + ankle(low) - ground;
}

/// `lies`: axes of the foot at rest, in model space. The sole is level with the lowest corner of the shape.
void RetargetBody::putOnSole(FootPoints& foot, const Quat& lies) const {
    const Quat inBone = conjugate(part(foot.part).bind.rotation) * lies;
    const float infinite = std::numeric_limits<float>::infinity();
    Vec3 lower{infinite, infinite, infinite}, upper = -lower;
    std::vector<Vec3> corners = soleCorners(part(foot.part), rotate(inBone, {0, -1, 0}));
    if (corners.empty()) corners = cornersOf(part(foot.part));
    for (const Vec3& corner : corners) {
        const Vec3 at = inverseRotate(inBone, corner - foot.joint);
        if (at.y > 0) continue;
        lower = min(lower, at);
        upper = max(upper, at);
    }
    if (!isFinite(lower)) lower = upper = {};
    const Vec3 heel{0.5f * (lower.x + upper.x), lower.y, lower.z};
    const Vec3 tip{heel.x, lower.y, upper.z};
    Vec3 ball = tip;
    if (const int toe = toeOf(def, foot.part); toe >= 0) {
        const Vec3 at =
            inverseRotate(lies, skeleton.bones[static_cast<std::size_t>(toe)].bind.position - jointAtRest(foot.part));
        const float share = (at.z - heel.z) / (ball.z - heel.z);
        if (share > kLeastBall && share < kGreatestBall) ball.z = at.z;
    }
    foot.halfWidth = 0.5f * (upper.x - lower.x);
    foot.heel = foot.joint + rotate(inBone, heel);
    foot.ball = foot.joint + rotate(inBone, ball);
    foot.tip = foot.joint + rotate(inBone, tip);
}

}  // namespace ragtop
