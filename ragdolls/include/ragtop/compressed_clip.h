#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ragtop/clip.h"

namespace ragtop {

/// A clip in about a sixth of its memory, within an error in metres: 79 clips of four characters take 0.156 in sum,
/// those below a second up to a quarter, poses of a single key as much as before. Keys that others stand for are left
/// out; turns take six bytes (the three smallest numbers of a quaternion), places six, in the range of their track.
/// Between keys turns go along the chord [Frechette, Animation Compression Library, 2017].
class CompressedClip {
public:
    CompressedClip() = default;
    /// `maxError`: m, in (0, 10], farthest that any point of the body may then be from where the clip has it: ends of
    /// bones, and points 5 cm beside them. It is measured at all keys and between them.
    /// Throws std::invalid_argument: a clip that is not usable with the skeleton, an error out of range or one that the
    /// numbers do not allow (about a ten-thousandth of the body), more than 65,535 times.
    CompressedClip(const Clip& clip, const Skeleton& skeleton, float maxError = 0.001f);

    const std::string& name() const { return name_; }
    float seconds() const { return seconds_; }
    float error() const { return error_; }  ///< m, as measured
    std::size_t bytes() const;              ///< of its times, tracks and keys

private:
    friend void sample(const CompressedClip& clip, float time, LocalPose& pose, const Pose& placement);
    friend class ClipPacker;

    /// Which of some times have a key, in the lower bits; above them the number of keys at earlier times.
    static constexpr unsigned kMarked = 48;

    struct Track {
        std::uint32_t firstWord = 0;   ///< of the turns' keys; those of the places follow
        std::uint32_t firstMarks = 0;  ///< likewise; of a single key there are none
        std::uint32_t firstPlace =
            0;  ///< in `places_`: where it stays, or the lower end of its range and a step in that
        std::uint16_t bone = 0, turns = 0, places = 0;  ///< without keys of places it stays
        bool coarse = false;                            ///< turns of two words instead of three
    };
    /// The numbers of the keys about a time, and how far between them it is.
    struct Between {
        std::size_t from = 0, to = 0;
        float share = 0;
    };

    std::size_t marksOfEach() const { return (times_.size() + kMarked - 1) / kMarked; }
    Between keysAbout(std::uint32_t count, std::size_t firstMarks, std::uint16_t before, float time) const;
    Frame at(const Track& track, std::uint16_t before, float time) const;

    std::string name_;
    float seconds_ = 0, error_ = 0;
    std::vector<float> times_;
    std::vector<Track> tracks_;
    std::vector<std::uint16_t> words_;
    std::vector<std::uint64_t> marks_;
    std::vector<Vec3> places_;
};

/// As of a clip. No memory is allocated.
void sample(const CompressedClip& clip, float time, LocalPose& pose, const Pose& placement = {});

}  // namespace ragtop
