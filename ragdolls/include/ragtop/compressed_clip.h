#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ragtop/clip.h"

namespace ragtop {

/// A clip in less than a sixth of its memory, within an error in metres. Bones are kept as what sets them apart from
/// the body at rest, so that those which stay at rest take a few bits; keys that others stand for are left out; the
/// others have as many bits as the range of each of their numbers and the error ask for [Frechette, Animation
/// Compression Library, 2017]. Turns are kept as modified Rodrigues parameters [Schaub and Junkins, Analytical
/// Mechanics of Space Systems, 2003, chapter 3.6].
class CompressedClip {
public:
    CompressedClip() = default;
    /// `maxError`: m, in (0, 10], farthest that any point of the body may then be from where the clip has it: ends of
    /// bones, and points 5 cm beside them. It is measured at all keys and at three places between each two.
    /// Throws std::invalid_argument: a clip that is not usable with the skeleton, an error out of range or one that the
    /// numbers do not allow (about a ten-thousandth of the body), more than 65,535 times.
    CompressedClip(const Clip& clip, const Skeleton& skeleton, float maxError = 0.001f);

    const std::string& name() const { return name_; }
    float seconds() const { return seconds_; }
    float error() const { return error_; }  ///< m, as measured
    std::size_t bytes() const;              ///< of its times and tracks

private:
    friend void sample(const CompressedClip& clip, const LocalPose& rest, float time, LocalPose& pose,
                       const Pose& placement);
    friend class ClipPacker;

    std::string name_;
    float seconds_ = 0, error_ = 0;
    float unit_ = 0;              ///< m, of which steps of places are parts
    float first_ = 0, step_ = 0;  ///< s, of times at even distances
    std::vector<float> times_;    ///< of others
    std::uint32_t count_ = 0;     ///< of times
    std::uint32_t tracks_ = 0;
    std::vector<std::uint8_t> stream_;  ///< the tracks, bit by bit (clip_curve.h)
};

/// As of a clip. `rest` is that of the skeleton that it was made with. No memory is allocated.
void sample(const CompressedClip& clip, const LocalPose& rest, float time, LocalPose& pose, const Pose& placement = {});

}  // namespace ragtop
