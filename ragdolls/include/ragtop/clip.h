#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/pose.h"
#include "ragtop/skeleton.h"

/// Animations of a skeleton, kept as keys.
namespace ragtop {

/// What one bone does. Between two keys places go along straight lines and turns the short way, at a constant rate;
/// before the first and behind the last key they stay.
struct ClipTrack {
    int bone = -1;               ///< of the skeleton
    std::vector<float> times{};  ///< s, rising
    std::vector<Frame> keys{};   ///< one per time: of the bone in its parent, m; of the first bone in model space
};

struct Clip {
    std::string name{};
    float seconds = 0;                ///< from 0 to the last key of any bone
    std::vector<ClipTrack> tracks{};  ///< of the bones that it moves; the others are left as they are
};

/// Empty when the clip is usable with that skeleton; otherwise names the track, its value and what is allowed.
std::string whyInvalid(const Clip& clip, const Skeleton& skeleton);

/// The time within a clip that repeats, s; `time` may be below zero.
float wrapped(const Clip& clip, float time);

/// Puts what the clip has its bones do at `time`, s, into `pose`, with model space at `placement`; bones that it has no
/// keys of are left alone. No memory is allocated. The clip has to be usable with the skeleton of the pose.
void sample(const Clip& clip, float time, LocalPose& pose, const Pose& placement = {});

/// Blends `pose` towards `other` (share 1) in place. No memory is allocated. Throws std::invalid_argument where they
/// have not as many bones.
void blendInto(LocalPose& pose, const LocalPose& other, float share);

}  // namespace ragtop
