#include "ragtop/pose.h"

#include <stdexcept>
#include <string>

namespace ragtop {
namespace {

void expect(std::size_t count, std::size_t wanted) {
    if (count != wanted)
        throw std::invalid_argument("pose: has " + std::to_string(count) + " bones, must have " +
                                    std::to_string(wanted));
}

Frame blendFrames(const Frame& from, const Frame& to, float share) {
    const Pose a{DVec3(from.position), from.rotation}, b{DVec3(to.position), to.rotation};
    const Pose blended = blend(a, b, static_cast<double>(share));
    return {toVec3(blended.position), blended.rotation};
}

}  // namespace

Skeleton skeletonOf(const RagdollDef& def) {
    Skeleton skeleton;
    for (const RagdollBone& bone : def.bones)
        skeleton.bones.push_back(
            {bone.name, bone.parent, def.parts[static_cast<std::size_t>(bone.part)].bind * bone.inPart});
    return skeleton;
}

LocalPose restPose(const Skeleton& skeleton, const Pose& placement) {
    std::vector<Pose> world;
    for (const Bone& bone : skeleton.bones) world.push_back(placement * bone.bind);
    return readPose(skeleton, world);
}

LocalPose readPose(const Skeleton& skeleton, std::span<const Pose> world) {
    expect(world.size(), skeleton.bones.size());
    LocalPose pose;
    if (world.empty()) return pose;
    pose.root = world[0];
    pose.bones.resize(world.size());
    for (std::size_t i = 1; i < world.size(); ++i) {
        pose.bones[i] = relative(world[static_cast<std::size_t>(skeleton.bones[i].parent)], world[i]);
        pose.bones[i].rotation = normalized(pose.bones[i].rotation);
    }
    return pose;
}

void writePose(const Skeleton& skeleton, const LocalPose& pose, std::span<Pose> world) {
    expect(pose.bones.size(), skeleton.bones.size());
    expect(world.size(), skeleton.bones.size());
    if (world.empty()) return;
    world[0] = pose.root;
    for (std::size_t i = 1; i < world.size(); ++i) {
        world[i] = world[static_cast<std::size_t>(skeleton.bones[i].parent)] * pose.bones[i];
        world[i].rotation = normalized(world[i].rotation);
    }
}

std::vector<Pose> writePose(const Skeleton& skeleton, const LocalPose& pose) {
    std::vector<Pose> world(skeleton.bones.size());
    writePose(skeleton, pose, world);
    return world;
}

LocalPose blend(const LocalPose& from, const LocalPose& to, std::span<const float> shares) {
    expect(to.bones.size(), from.bones.size());
    expect(shares.size(), from.bones.size());
    LocalPose result = from;
    for (std::size_t i = 1; i < shares.size(); ++i)
        result.bones[i] = blendFrames(from.bones[i], to.bones[i], shares[i]);
    if (!shares.empty()) result.root = blend(from.root, to.root, static_cast<double>(shares[0]));
    return result;
}

LocalPose blend(const LocalPose& from, const LocalPose& to, float share) {
    const std::vector<float> shares(from.bones.size(), share);
    return blend(from, to, shares);
}

PoseDifference subtract(const LocalPose& pose, const LocalPose& base) {
    expect(pose.bones.size(), base.bones.size());
    PoseDifference result;
    for (std::size_t i = 0; i < pose.bones.size(); ++i) {
        if (i == 0) {
            result.bones.push_back(relative(base.root, pose.root));
            continue;
        }
        const Frame &to = pose.bones[i], &from = base.bones[i];
        result.bones.push_back({to.position - from.position, conjugate(from.rotation) * to.rotation});
    }
    for (Frame& each : result.bones) each.rotation = normalized(each.rotation);
    return result;
}

LocalPose add(const LocalPose& base, const PoseDifference& difference, float share) {
    expect(difference.bones.size(), base.bones.size());
    LocalPose result = base;
    for (std::size_t i = 0; i < base.bones.size(); ++i) {
        const Frame part = blendFrames({}, difference.bones[i], share);
        if (i == 0) {
            result.root = base.root * part;
            result.root.rotation = normalized(result.root.rotation);
            continue;
        }
        const Frame& from = base.bones[i];
        result.bones[i] = {from.position + part.position, normalized(from.rotation * part.rotation)};
    }
    return result;
}

}  // namespace ragtop
