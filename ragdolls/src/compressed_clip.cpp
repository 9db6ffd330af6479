#include "ragtop/compressed_clip.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "packed_key.h"

namespace ragtop {
CompressedClip::Between CompressedClip::keysAbout(std::uint32_t count, std::size_t firstMarks, std::uint16_t before,
                                                  float time) const {
    if (count == 1) return {};
    constexpr std::uint64_t kAll = (std::uint64_t{1} << kMarked) - 1;
    const std::uint64_t* marks = marks_.data() + firstMarks;
    std::size_t word = before / kMarked, next = word;
    const std::uint64_t until = (std::uint64_t{2} << before % kMarked) - 1;
    std::uint64_t bits = marks[word] & until & kAll, rest = marks[word] & ~until & kAll;
    const std::size_t rank = (marks[word] >> kMarked) + static_cast<std::size_t>(std::popcount(bits));
    if (rank == 0) return {};
    if (rank == count) return {count - 1u, count - 1u};
    while (bits == 0) bits = marks[--word] & kAll;
    while (rest == 0) rest = marks[++next] & kAll;
    const float from = times_[kMarked * word + 63u - static_cast<std::size_t>(std::countl_zero(bits))];
    const float to = times_[kMarked * next + static_cast<std::size_t>(std::countr_zero(rest))];
    return {rank - 1, rank, (time - from) / (to - from)};
}

Frame CompressedClip::at(const Track& track, std::uint16_t before, float time) const {
    const TurnFormat format = track.coarse ? kCoarseTurn : kFineTurn;
    const std::uint16_t* words = words_.data() + track.firstWord;
    const Between turns = keysAbout(track.turns, track.firstMarks, before, time);
    const auto turn = [&](std::size_t key) { return unpackTurn(words + key * format.words, format); };
    const Vec3* range = places_.data() + track.firstPlace;
    Frame frame{range[0], alongChord(turn(turns.from), turn(turns.to), turns.share)};
    if (track.places == 0) return frame;
    words += track.turns * format.words;
    const Between places =
        keysAbout(track.places, track.firstMarks + (track.turns > 1 ? marksOfEach() : 0), before, time);
    const auto place = [&](std::size_t key) { return unpackPlace(words + 3 * key, range[0], range[1]); };
    const Vec3 from = place(places.from);
    frame.position = from + places.share * (place(places.to) - from);
    return frame;
}

std::size_t CompressedClip::bytes() const {
    const auto size = [](const auto& all) { return all.size() * sizeof(all[0]); };
    return size(times_) + size(tracks_) + size(words_) + size(marks_) + size(places_);
}

void sample(const CompressedClip& clip, float time, LocalPose& pose, const Pose& placement) {
    if (clip.times_.empty()) return;
    const auto later = std::upper_bound(clip.times_.begin(), clip.times_.end(), time);
    const auto before = static_cast<std::uint16_t>(std::max<std::ptrdiff_t>(later - clip.times_.begin() - 1, 0));
    const float within = std::clamp(time, clip.times_.front(), clip.times_.back());
    for (const CompressedClip::Track& track : clip.tracks_) {
        const Frame frame = clip.at(track, before, within);
        if (track.bone == 0)
            pose.root = placement * frame;
        else
            pose.bones[track.bone] = frame;
    }
}

}  // namespace ragtop
