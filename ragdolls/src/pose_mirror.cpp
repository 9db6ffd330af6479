#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "ragtop/pose.h"

namespace ragtop {
namespace {

Vec3 reflected(const Vec3& v, const Vec3& normal) { return v - 2 * dot(v, normal) * normal; }

/// A turn about an axis becomes one about the reflected axis the other way round.
Quat reflected(const Quat& q, const Vec3& normal) {
    const Vec3 v = -reflected(Vec3{q.x, q.y, q.z}, normal);
    return {v.x, v.y, v.z, q.w};
}

}  // namespace

PoseMirror::PoseMirror(const Skeleton& skeleton, const Vec3& left) : skeleton_(skeleton), left_(normalized(left)) {
    if (const std::string problem = whyInvalid(skeleton_); !problem.empty())
        throw std::invalid_argument("pose mirror: " + problem);
    skeleton_.skin.clear();
    pair();
}

PoseMirror::PoseMirror(const Skeleton& skeleton)
    : PoseMirror(skeleton, whyInvalid(skeleton).empty() ? recognise(skeleton).left : Vec3{1, 0, 0}) {}

/// Children of twins are twins where their places are nearest to each other's reflection; those of one bone among
/// themselves, where one may be its own.
void PoseMirror::pair() {
    const auto& bones = skeleton_.bones;
    const Vec3 middle = bones[0].bind.position;
    twins_.assign(bones.size(), -1);
    twins_[0] = 0;
    std::vector<std::vector<int>> children(bones.size());
    for (std::size_t i = 1; i < bones.size(); ++i)
        children[static_cast<std::size_t>(bones[i].parent)].push_back(static_cast<int>(i));
    for (std::size_t i = 0; i < bones.size(); ++i) {
        std::vector<std::tuple<float, int, int>> ways;
        for (const int a : children[i])
            for (const int b : children[static_cast<std::size_t>(twins_[i])]) {
                const Vec3 other = middle + reflected(bones[static_cast<std::size_t>(a)].bind.position - middle, left_);
                ways.emplace_back(length(other - bones[static_cast<std::size_t>(b)].bind.position), a, b);
            }
        std::sort(ways.begin(), ways.end());
        for (const auto& [off, a, b] : ways) {
            int &twinOfA = twins_[static_cast<std::size_t>(a)], &twinOfB = twins_[static_cast<std::size_t>(b)];
            if (twinOfA >= 0 || twinOfB >= 0) continue;
            twinOfA = b;
            twinOfB = a;
        }
        for (const int a : children[i])
            if (twins_[static_cast<std::size_t>(a)] < 0) twins_[static_cast<std::size_t>(a)] = a;
    }
}

/// In the axes of model space a bone has turned from rest by D = R R̄⁻¹; its twin turns by the reflected D, and is as
/// far from its own place in its parent as the reflection of what the bone is.
LocalPose PoseMirror::operator()(const LocalPose& pose, const Pose& placement) const {
    const auto& bones = skeleton_.bones;
    if (pose.bones.size() != bones.size())
        throw std::invalid_argument("pose mirror: got " + std::to_string(pose.bones.size()) + " bones, must be " +
                                    std::to_string(bones.size()));
    const auto bindOf = [&](int bone) -> const Frame& { return bones[static_cast<std::size_t>(bone)].bind; };
    std::vector<Quat> turned(bones.size()), mirrored(bones.size());
    const Frame root = relative(placement, pose.root);
    turned[0] = root.rotation;
    for (std::size_t i = 1; i < bones.size(); ++i)
        turned[i] = turned[static_cast<std::size_t>(bones[i].parent)] * pose.bones[i].rotation;
    for (std::size_t i = 0; i < bones.size(); ++i) {
        const auto other = static_cast<std::size_t>(twins_[i]);
        mirrored[other] =
            normalized(reflected(turned[i] * conjugate(bones[i].bind.rotation), left_) * bones[other].bind.rotation);
    }
    LocalPose result = pose;
    const Vec3 moved = reflected(root.position - bones[0].bind.position, left_);
    result.root = placement * Frame{bones[0].bind.position + moved, mirrored[0]};
    for (std::size_t i = 1; i < bones.size(); ++i) {
        const int bone = static_cast<int>(i), other = twins_[i];
        const auto parent = static_cast<std::size_t>(bones[static_cast<std::size_t>(other)].parent);
        const Frame rest = inverse(bindOf(bones[i].parent)) * bindOf(bone);
        const Frame otherRest = inverse(bones[parent].bind) * bindOf(other);
        const Vec3 off = rotate(bindOf(bones[i].parent).rotation, pose.bones[i].position - rest.position);
        result.bones[static_cast<std::size_t>(other)] = {
            otherRest.position + inverseRotate(bones[parent].bind.rotation, reflected(off, left_)),
            normalized(conjugate(mirrored[parent]) * mirrored[static_cast<std::size_t>(other)])};
    }
    return result;
}

}  // namespace ragtop
