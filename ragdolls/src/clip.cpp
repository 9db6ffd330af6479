#include "ragtop/clip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "range_check.h"

namespace ragtop {
namespace {

/// The short way at a constant rate [Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985].
Quat between(const Quat& from, const Quat& to, float share) {
    const float cosine = from.x * to.x + from.y * to.y + from.z * to.z + from.w * to.w;
    const float sign = cosine < 0 ? -1.0f : 1.0f, along = std::min(std::abs(cosine), 1.0f);
    float a = 1 - share, b = share;
    // Below two degrees the chord and the arc differ by less than rounding.
    if (along < 0.9994f) {
        const float angle = arcTan2(std::sqrt(1 - along * along), along);
        const float whole = sinCos(angle).sin;
        a = sinCos((1 - share) * angle).sin / whole;
        b = sinCos(share * angle).sin / whole;
    }
    b *= sign;
    return normalized(Quat{a * from.x + b * to.x, a * from.y + b * to.y, a * from.z + b * to.z, a * from.w + b * to.w});
}

Frame between(const Frame& from, const Frame& to, float share) {
    return {from.position + share * (to.position - from.position), between(from.rotation, to.rotation, share)};
}

Frame at(const ClipTrack& track, float time) {
    const auto later = std::upper_bound(track.times.begin(), track.times.end(), time);
    if (later == track.times.begin()) return track.keys.front();
    if (later == track.times.end()) return track.keys.back();
    const auto i = static_cast<std::size_t>(later - track.times.begin());
    const float before = track.times[i - 1];
    return between(track.keys[i - 1], track.keys[i], (time - before) / (track.times[i] - before));
}

std::string whyInvalidTrack(const ClipTrack& track, float seconds, std::size_t boneCount) {
    if (track.bone < 0 || static_cast<std::size_t>(track.bone) >= boneCount)
        return "bone is " + std::to_string(track.bone) + ", must be an index of the skeleton's " +
               std::to_string(boneCount) + " bones";
    if (track.times.empty() || track.keys.size() != track.times.size())
        return "has " + std::to_string(track.times.size()) + " times and " + std::to_string(track.keys.size()) +
               " keys, must have one or more, as many of each";
    for (std::size_t i = 0; i < track.times.size(); ++i) {
        if (!(track.times[i] >= 0 && track.times[i] <= seconds) || (i > 0 && !(track.times[i] > track.times[i - 1])))
            return "times[" + std::to_string(i) + "] is " + std::to_string(track.times[i]) +
                   " s, must rise from 0 to the clip's " + std::to_string(seconds);
        if (!isFinite(track.keys[i].position) || !isRotation(track.keys[i].rotation))
            return "keys[" + std::to_string(i) + "] is not finite or its rotation has not length 1";
    }
    return {};
}

}  // namespace

std::string whyInvalid(const Clip& clip, const Skeleton& skeleton) {
    if (!(clip.seconds >= 0 && std::isfinite(clip.seconds)))
        return "seconds is " + std::to_string(clip.seconds) + ", must be finite and not below 0";
    std::vector<bool> moved(skeleton.bones.size(), false);
    for (std::size_t i = 0; i < clip.tracks.size(); ++i) {
        const std::string name = "tracks[" + std::to_string(i) + "].";
        if (const std::string problem = whyInvalidTrack(clip.tracks[i], clip.seconds, moved.size()); !problem.empty())
            return name + problem;
        const auto bone = static_cast<std::size_t>(clip.tracks[i].bone);
        if (moved[bone]) return name + "bone is " + std::to_string(bone) + ", which another track moves already";
        moved[bone] = true;
    }
    return {};
}

float wrapped(const Clip& clip, float time) {
    if (!(clip.seconds > 0)) return 0;
    const float rest = std::fmod(time, clip.seconds);
    return rest < 0 ? rest + clip.seconds : rest;
}

void sample(const Clip& clip, float time, LocalPose& pose, const Pose& placement) {
    for (const ClipTrack& track : clip.tracks) {
        const Frame frame = at(track, time);
        if (track.bone == 0)
            pose.root = placement * frame;
        else
            pose.bones[static_cast<std::size_t>(track.bone)] = frame;
    }
}

void blendInto(LocalPose& pose, const LocalPose& other, float share) {
    if (pose.bones.size() != other.bones.size())
        throw std::invalid_argument("pose: has " + std::to_string(other.bones.size()) + " bones, must have " +
                                    std::to_string(pose.bones.size()));
    const float part = std::clamp(share, 0.0f, 1.0f);
    for (std::size_t i = 1; i < pose.bones.size(); ++i) pose.bones[i] = between(pose.bones[i], other.bones[i], part);
    pose.root = blend(pose.root, other.root, static_cast<double>(part));
}

}  // namespace ragtop
