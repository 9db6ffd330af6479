#include <cmath>
#include <string>

#include "range_check.h"
#include "spring_plan.h"

namespace ragtop {
namespace {

std::string boneText(const Skeleton& skeleton, int bone) {
    return "bones[" + std::to_string(bone) + "] (" + skeleton.bones[static_cast<std::size_t>(bone)].name + ")";
}

bool isBone(const Skeleton& skeleton, int bone) {
    return bone >= 0 && static_cast<std::size_t>(bone) < skeleton.bones.size();
}

std::string whyInvalidChain(const SpringChain& chain, const Skeleton& skeleton, std::vector<bool>& taken) {
    if (std::string problem = whyOutside(chain); !problem.empty()) return problem;
    if (!isFinite(chain.tip)) return "tip is not finite";
    for (const auto& [name, bone] : {std::pair{"first", chain.first}, std::pair{"last", chain.last}})
        if (!isBone(skeleton, bone) || skeleton.bones[static_cast<std::size_t>(bone)].parent < 0)
            return name + std::string(" is ") + std::to_string(bone) + ", must be the index of a bone below the root";
    const std::vector<int> bones = bonesOf(chain, skeleton);
    if (bones.empty())
        return "first is " + boneText(skeleton, chain.first) + ", must be last or above it, " +
               boneText(skeleton, chain.last);
    for (std::size_t i = 0; i < bones.size(); ++i) {
        if (taken[static_cast<std::size_t>(bones[i])])
            return "moves " + boneText(skeleton, bones[i]) + ", which another chain moves already";
        taken[static_cast<std::size_t>(bones[i])] = true;
        if (!(length(weightOf(chain, bones, i, skeleton)) > 1e-6f))
            return std::string(i + 1 < bones.size() ? "the next bone after " : "tip of ") +
                   boneText(skeleton, bones[i]) + " is where it begins, must be apart";
    }
    return {};
}

std::string whyInvalidCollider(const SpringCollider& collider, const Skeleton& skeleton,
                               const std::vector<bool>& taken) {
    if (!isFinite(collider.frame.position) || !isRotation(collider.frame.rotation))
        return "frame is not finite or its rotation has not length 1";
    if (collider.bone != -1 && !isBone(skeleton, collider.bone))
        return "bone is " + std::to_string(collider.bone) + ", must be the index of a bone or -1";
    for (int bone = collider.bone; bone >= 0; bone = skeleton.bones[static_cast<std::size_t>(bone)].parent)
        if (taken[static_cast<std::size_t>(bone)])
            return "bone is " + boneText(skeleton, collider.bone) + ", must be one that no chain moves";
    std::string problem;
    if (const auto* sphere = std::get_if<Sphere>(&collider.shape)) problem = whyOutside(*sphere);
    if (const auto* capsule = std::get_if<Capsule>(&collider.shape)) problem = whyOutside(*capsule);
    return problem.empty() ? problem : "shape." + problem;
}

}  // namespace

std::vector<int> bonesOf(const SpringChain& chain, const Skeleton& skeleton) {
    std::vector<int> bones;
    int bone = chain.last;
    for (; bone >= 0 && bone != chain.first; bone = skeleton.bones[static_cast<std::size_t>(bone)].parent)
        bones.insert(bones.begin(), bone);
    if (bone < 0) return {};
    bones.insert(bones.begin(), bone);
    return bones;
}

Vec3 weightOf(const SpringChain& chain, const std::vector<int>& bones, std::size_t index, const Skeleton& skeleton) {
    const Bone& bone = skeleton.bones[static_cast<std::size_t>(bones[index])];
    if (index + 1 < bones.size()) {
        const Bone& next = skeleton.bones[static_cast<std::size_t>(bones[index + 1])];
        return inverseTransformPoint(bone.bind, next.bind.position);
    }
    if (chain.tip != Vec3{}) return chain.tip;
    const Bone& parent = skeleton.bones[static_cast<std::size_t>(bone.parent)];
    return inverseRotate(bone.bind.rotation, bone.bind.position - parent.bind.position);
}

std::string whyInvalid(const SpringBonesDef& def, const Skeleton& skeleton) {
    if (std::string problem = whyInvalid(skeleton); !problem.empty()) return "skeleton: " + problem;
    if (std::string problem = whyOutside(def); !problem.empty()) return problem;
    std::vector<bool> taken(skeleton.bones.size(), false);
    for (std::size_t i = 0; i < def.chains.size(); ++i)
        if (const std::string problem = whyInvalidChain(def.chains[i], skeleton, taken); !problem.empty())
            return "chains[" + std::to_string(i) + "]." + problem;
    for (std::size_t i = 0; i < def.colliders.size(); ++i)
        if (const std::string problem = whyInvalidCollider(def.colliders[i], skeleton, taken); !problem.empty())
            return "colliders[" + std::to_string(i) + "]." + problem;
    return {};
}

}  // namespace ragtop
