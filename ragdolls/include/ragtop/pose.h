#pragma once

#include <span>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/ragdoll.h"
#include "ragtop/skeleton.h"

/// Poses of a skeleton as animations keep them: each bone in its parent. What takes two poses, or a skeleton and a
/// pose, throws std::invalid_argument where they have not as many bones.
namespace ragtop {

struct LocalPose {
    Pose root{};                 ///< of the first bone in the world
    std::vector<Frame> bones{};  ///< of each other one in its parent; the first is not used
};

/// What to do to one pose to get another.
struct PoseDifference {
    std::vector<Frame>
        bones{};  ///< turn of each bone in itself, its shift in m along its parent's axes; of the first its own
};

/// The bones of a definition, at rest, as a skeleton without skin.
Skeleton skeletonOf(const RagdollDef& def);

/// At rest, with model space at `placement`.
LocalPose restPose(const Skeleton& skeleton, const Pose& placement = {});
/// From one world pose per bone, as an animation or Ragdoll::pose() gives them.
LocalPose readPose(const Skeleton& skeleton, std::span<const Pose> world);
/// One world pose per bone.
void writePose(const Skeleton& skeleton, const LocalPose& pose, std::span<Pose> world);
std::vector<Pose> writePose(const Skeleton& skeleton, const LocalPose& pose);

/// From one pose (0) to another (1): places along straight lines, turns the short way. Beyond [0, 1] it stays at the
/// ends.
LocalPose blend(const LocalPose& from, const LocalPose& to, float share);
/// The same with a share for each bone.
LocalPose blend(const LocalPose& from, const LocalPose& to, std::span<const float> shares);

/// add(base, subtract(pose, base)) is `pose`; on another base it is a gesture on top of that, from none of it (0) to
/// all of it (1).
PoseDifference subtract(const LocalPose& pose, const LocalPose& base);
LocalPose add(const LocalPose& base, const PoseDifference& difference, float share = 1);

/// Swaps left and right. Bones are paired by where they are at rest and by what they hang on; one without a twin is its
/// own. Each keeps its length, so that a body that is not quite symmetric stays whole.
class PoseMirror {
public:
    /// `left`: unit vector in model space, to the body's left. Throws std::invalid_argument on a bad skeleton.
    PoseMirror(const Skeleton& skeleton, const Vec3& left);
    /// Of a human, which knows its left (anatomy.h); of others what `recognise` takes for it.
    explicit PoseMirror(const Skeleton& skeleton);

    /// Bone on the other side.
    int twin(int bone) const { return twins_[static_cast<std::size_t>(bone)]; }
    /// About the plane through the root at rest, with model space at `placement`. Twice is once none.
    LocalPose operator()(const LocalPose& pose, const Pose& placement = {}) const;

private:
    void pair();

    Skeleton skeleton_;
    Vec3 left_;
    std::vector<int> twins_;
};

}  // namespace ragtop
