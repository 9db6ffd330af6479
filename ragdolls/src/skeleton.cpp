#include "ragtop/skeleton.h"

#include <cmath>

namespace ragtop {
namespace {

constexpr float kFarthest = 1e6f;  ///< m: farther out squares and volumes leave the range of numbers

bool isNear(const Vec3& point) {
    const Vec3 size = abs(point);
    return size.x <= kFarthest && size.y <= kFarthest && size.z <= kFarthest;
}

}  // namespace

int Skeleton::find(std::string_view name) const {
    for (std::size_t i = 0; i < bones.size(); ++i)
        if (bones[i].name == name) return static_cast<int>(i);
    return -1;
}

Bounds boundsOf(const Skeleton& skeleton) {
    if (skeleton.bones.empty()) return {};
    Bounds bounds{skeleton.bones[0].bind.position, skeleton.bones[0].bind.position};
    const auto include = [&](const Vec3& point) {
        bounds.lower = min(bounds.lower, point);
        bounds.upper = max(bounds.upper, point);
    };
    for (const Bone& bone : skeleton.bones) include(bone.bind.position);
    for (const auto& vertices : skeleton.skin)
        for (const Vec3& vertex : vertices) include(vertex);
    return bounds;
}

std::string whyInvalid(const Skeleton& skeleton) {
    if (skeleton.bones.empty()) return "bones is empty, must have at least one";
    if (skeleton.bones.size() > 65535)
        return "bones has " + std::to_string(skeleton.bones.size()) + " entries, at most 65535 are allowed";
    for (std::size_t i = 0; i < skeleton.bones.size(); ++i) {
        const Bone& bone = skeleton.bones[i];
        const std::string name = "bones[" + std::to_string(i) + "] (" + bone.name + ")";
        const int first = i == 0 ? -1 : 0;
        if (bone.parent < first || bone.parent >= static_cast<int>(i))
            return name + ".parent is " + std::to_string(bone.parent) + ", must be " +
                   (i == 0 ? "-1: the first bone is the only root" : "the index of an earlier bone");
        const Quat& q = bone.bind.rotation;
        if (!isFinite(bone.bind.position) || !isFinite(q)) return name + ".bind has a number that is not finite";
        if (!isNear(bone.bind.position)) return name + ".bind.position is more than 1e6 m from the origin";
        const float norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
        if (!(norm > 0.99f && norm < 1.01f))
            return name + ".bind.rotation has length " + std::to_string(std::sqrt(norm)) + ", must be 1";
    }
    if (!skeleton.skin.empty() && skeleton.skin.size() != skeleton.bones.size())
        return "skin has " + std::to_string(skeleton.skin.size()) + " entries, must be empty or one per bone";
    for (std::size_t i = 0; i < skeleton.skin.size(); ++i)
        for (const Vec3& vertex : skeleton.skin[i])
            if (!isNear(vertex))
                return "skin[" + std::to_string(i) + "] has a vertex that is " +
                       (isFinite(vertex) ? "more than 1e6 m from the origin" : "not finite");
    return {};
}

}  // namespace ragtop
