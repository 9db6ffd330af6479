#include <algorithm>
#include <cmath>

#include "segments.h"

namespace ragtop {
namespace {

constexpr float kVisibleBend = 0.17f;  ///< sine of ten degrees: less says nothing about which way a knee bends
constexpr float kVisibleFoot = 0.05f;  ///< of the shank, that toes are ahead of the ankle

/// −1 where the first limb of a pair is on the right by what a map or names say, 1 where it is on the left, else 0.
int sideSaid(const BoneTree& tree, const KnownRoles& known, const LimbPair& pair, bool byMap) {
    int sum = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        if (!pair.limb[i]) continue;
        const int sign = i == 0 ? 1 : -1;
        for (const int bone : pair.limb[i]->joint) {
            if (bone < 0) continue;
            const auto at = static_cast<std::size_t>(bone);
            if (!byMap) sum -= sign * tree.names[at].side;
            if (byMap && known.of[at] && known.of[at]->side != BodySide::middle)
                sum += known.of[at]->side == BodySide::left ? sign : -sign;
        }
    }
    return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

/// Above zero where the first leg is the left one: feet point ahead of the shank, and knees bend the other way.
float facing(const LimbPair& legs, const Vec3& across) {
    float sum = 0;
    for (const auto& limb : legs.limb) {
        if (!limb || limb->lower == 0) continue;
        const Vec3 shank = limb->point[2] - limb->point[1], foot = limb->point[3] - limb->point[2];
        if (limb->isComplete() && length(foot) > kVisibleFoot * length(shank))
            sum -= dot(cross(normalized(shank), normalized(foot)), across);
        if (!limb->isComplete()) continue;  // the way to the toes bends forward, that of the knee back
        const float knee = dot(cross(normalized(limb->point[1] - limb->point[0]), normalized(shank)), across);
        if (std::abs(knee) > kVisibleBend) sum += knee;
    }
    return sum;
}

/// How far the skin of the lowest parts lies ahead of their joints.
float skinAhead(const Skeleton& skeleton, const LimbPair& legs, const Vec3& sagittal) {
    float sum = 0;
    if (skeleton.skin.empty()) return sum;
    for (const auto& limb : legs.limb) {
        if (!limb) continue;
        const int bone = limb->isComplete() ? limb->joint[2] : limb->joint[1];
        const Vec3 joint = limb->isComplete() ? limb->point[2] : limb->point[1];
        for (const Vec3& vertex : skeleton.skin[static_cast<std::size_t>(bone)]) sum += dot(vertex - joint, sagittal);
    }
    return sum;
}

/// Up is along the spine, and the legs where they continue it; forward where the toes point.
void orientHuman(const Skeleton& skeleton, const BoneTree& tree, const KnownRoles& known, const PlanChoice& choice,
                 Anatomy& anatomy) {
    const LimbPair& wide = choice.legs.limb[1] ? choice.legs : choice.arms;
    const Vec3 across = normalized(wide.limb[0]->point[0] - wide.limb[1]->point[0]);
    const Vec3 trunk = normalized(choice.arms.start() - choice.legs.start()), down = choice.legs.direction();
    const Vec3 along = trunk - std::max(0.0f, -dot(trunk, down)) * down;
    anatomy.up = normalized(along - dot(along, across) * across);
    const Vec3 sagittal = normalized(cross(across, anatomy.up));
    float ahead = static_cast<float>(sideSaid(tree, known, wide, true));
    if (ahead == 0) ahead = facing(choice.legs, across);
    if (std::abs(ahead) < 0.1f) ahead = static_cast<float>(sideSaid(tree, known, wide, false));
    if (ahead == 0) ahead = skinAhead(skeleton, choice.legs, sagittal);
    if (ahead == 0) {
        ahead = sagittal.z >= 0 ? 1.0f : -1.0f;
        anatomy.note = "which way it faces was guessed: it has neither toes nor named sides";
    }
    anatomy.forward = ahead < 0 ? -sagittal : sagittal;
    anatomy.left = cross(anatomy.up, anatomy.forward);
}

}  // namespace

void orient(const Skeleton& skeleton, const BoneTree& tree, const KnownRoles& known, const PlanChoice& choice,
            Anatomy& anatomy) {
    if (choice.plan == BodyPlan::human) return orientHuman(skeleton, tree, known, choice, anatomy);
    // Of animals forward is along the trunk, and up away from the feet.
    const Vec3 across = normalized(choice.legs.limb[0]->point[0] - choice.legs.limb[1]->point[0]);
    const Vec3 trunk = choice.arms.start() - choice.legs.start();
    Vec3 down = choice.legs.direction();
    if (choice.plan == BodyPlan::quadruped) down += choice.arms.direction();
    if (choice.plan == BodyPlan::hexapod) {
        down += choice.arms.direction();
        for (const LimbPair& pair : choice.more) down += pair.direction();
    }
    anatomy.forward = normalized(trunk - dot(trunk, across) * across);
    const Vec3 up = -down + dot(down, across) * across;
    anatomy.up = normalized(up - dot(up, anatomy.forward) * anatomy.forward, perpendicular(anatomy.forward));
    anatomy.left = cross(anatomy.up, anatomy.forward);
}

}  // namespace ragtop
