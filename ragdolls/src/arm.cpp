#include "arm.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fit.h"

namespace ragtop {
namespace {

constexpr float kLeastAbduction = -0.2f, kMostAbduction = 1.4f;  ///< rad

}  // namespace

/// (± sin a, −cos a cos f, cos a sin f) for abduction a and flexion f.
PartAngles pointing(BodySide side, const Vec3& along) {
    const float out = side == BodySide::left ? along.x : -along.x;
    const float across = std::sqrt(along.y * along.y + along.z * along.z);
    PartAngles arm{.role = BodyRole::upperArm, .side = side};
    arm.abduction = std::clamp(arcTan2(out, across), kLeastAbduction, kMostAbduction);
    arm.flexion = arcTan2(along.z, -along.y);
    return arm;
}

namespace {

constexpr float kMostApart = 1.5f, kStep = 0.05f;  ///< rad

bool isArm(BodyRole role) { return role == BodyRole::upperArm || role == BodyRole::forearm || role == BodyRole::hand; }

/// Does any shape of an arm touch another?
bool rubs(const BodyAxes& axes, std::span<const PartAngles> pose, float gap) {
    const RagdollDef& def = axes.def();
    const std::vector<Pose> bones = standing(axes, {}, pose);
    std::vector<FittedShape> shapes;
    for (const RagdollPart& part : def.parts) {
        const Pose& bone = bones[static_cast<std::size_t>(part.bone)];
        shapes.push_back({part.shape, Frame{relative(bone.position, {}), bone.rotation} * part.frame});
    }
    for (std::size_t i = 0; i < shapes.size(); ++i)
        for (std::size_t j = 0; j < shapes.size(); ++j)
            if (isArm(def.parts[i].role) && i != j && !ignoreEachOther(def, static_cast<int>(i), static_cast<int>(j)) &&
                mayOverlap(shapes[i], shapes[j], gap))
                return true;
    return false;
}

}  // namespace

float armsApart(const BodyAxes& axes, std::span<const PartAngles> arms, float least, float gap) {
    std::vector<PartAngles> pose(arms.begin(), arms.end());
    for (float apart = least; apart < kMostApart; apart += kStep) {
        for (PartAngles& each : pose)
            if (each.role == BodyRole::upperArm) each.abduction = apart;
        if (!rubs(axes, pose, gap)) return apart;
    }
    return least;
}

}  // namespace ragtop
