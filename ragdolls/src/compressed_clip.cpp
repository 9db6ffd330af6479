#include "ragtop/compressed_clip.h"

#include <algorithm>
#include <bit>
#include <span>

#include "clip_curve.h"

namespace ragtop {
namespace {

/// Times of a clip.
struct Times {
    std::span<const float> all;  ///< s; empty where they are at even distances
    float first, step;           ///< s, of those
    std::size_t count;

    float of(std::size_t index) const { return all.empty() ? first + step * static_cast<float>(index) : all[index]; }
    /// The last one that is not behind `time`, or the first.
    std::size_t before(float time) const {
        if (all.empty()) {
            const float steps = step > 0 ? (time - first) / step : 0.0f;
            return static_cast<std::size_t>(std::clamp(steps, 0.0f, static_cast<float>(count - 1)));
        }
        const auto later = std::upper_bound(all.begin(), all.end(), time);
        return static_cast<std::size_t>(std::max<std::ptrdiff_t>(later - all.begin() - 1, 0));
    }
};

/// Reads the tracks of a clip one after another, at one time.
class ClipReader {
public:
    ClipReader(const std::uint8_t* stream, const Times& times, float unit, float time)
        : stream_(stream), times_(times), unit_(unit), before_(times.before(time)) {
        const std::size_t last = times.count - 1;
        time_ = std::clamp(time, times.of(0), times.of(last));
        all_ = between(before_, std::min(before_ + 1, last));
    }

    /// Goes on to the next track, and puts where its bone is in its parent into the pose, or of the first bone into
    /// `root`.
    void next(const LocalPose& rest, LocalPose& pose, Frame& root) {
        const std::uint64_t head = bitsAt(stream_, at_);
        const unsigned kinds = kindBits(times_.count);
        at_ += 1 + 2 * kinds;
        ++bone_;
        if ((head & 1u) == 0) {
            bone_ = lowest(bitsAt(stream_, at_), 16);
            at_ += 16;
        }
        const auto turn = static_cast<CurveKind>(lowest(head >> 1, kinds)),
                   place = static_cast<CurveKind>(lowest(head >> (1 + kinds), kinds));
        if (bone_ == 0) root = {toVec3(rest.root.position), normalized(rest.root.rotation)};
        const Frame& still = bone_ == 0 ? root : rest.bones[bone_];
        Frame& frame = bone_ == 0 ? root : pose.bones[bone_];
        if (turn == CurveKind::none) {
            frame.rotation = still.rotation;
        } else {
            const Keys keys = keysOf(turn, 1);
            const Quat own = turn == CurveKind::chords ? turnBetween(at(keys, 0), at(keys, 1), keys.share, true)
                                                       : turnOf(at(keys, keys.share));
            frame.rotation = still.rotation * own;
        }
        frame.position = still.position;
        if (place == CurveKind::none) return;
        const Keys keys = keysOf(place, unit_);
        frame.position += at(keys, keys.share);
    }

    std::size_t bone() const { return bone_; }

private:
    struct Between {
        std::size_t from = 0, to = 0;  ///< numbers of keys
        float share = 0;
    };
    /// The two keys of a curve about the time.
    struct Keys {
        std::int32_t low[3];
        unsigned width[3];
        std::size_t from, to;  ///< where they are in the stream
        float size, share;
    };

    std::int32_t numberAt(std::size_t at, unsigned width) const {
        return static_cast<std::int32_t>(lowest(bitsAt(stream_, at), width));
    }

    Vec3 at(const Keys& keys, float share) const {
        const auto number = [&](int i, std::size_t before) {
            const std::int32_t from = numberAt(keys.from + before, keys.width[i]),
                               to = numberAt(keys.to + before, keys.width[i]);
            return keys.size * (static_cast<float>(keys.low[i] + from) + share * static_cast<float>(to - from));
        };
        return {number(0, 0), number(1, keys.width[0]), number(2, keys.width[0] + keys.width[1])};
    }

    /// Passes the curve.
    Keys keysOf(CurveKind kind, float unit) {
        const std::uint64_t head = bitsAt(stream_, at_);
        const bool stays = kind == CurveKind::constant;
        const unsigned widthBits = stays ? kStillWidthBits : kWidthBits;
        auto width = static_cast<unsigned>(lowest(head >> kStepBits, widthBits));
        if (stays) width = kStillWidths[width];
        at_ += kStepBits + widthBits;
        const std::int32_t least = lowestOf(width);
        Keys keys{{least + numberAt(at_, width), least + numberAt(at_ + width, width),
                   least + numberAt(at_ + 2 * width, width)},
                  {0, 0, 0},
                  at_,
                  at_,
                  unit * kCurveSteps[lowest(head, kStepBits)],
                  0};
        at_ += 3 * width;
        if (!stays) passKeys(keys);
        return keys;
    }

    void passKeys(Keys& keys) {
        const std::uint64_t head = bitsAt(stream_, at_);
        const auto field = [&](unsigned from, unsigned bits) {
            return static_cast<unsigned>(lowest(head >> from, bits));
        };
        for (unsigned i = 0; i < 3; ++i) keys.width[i] = field(i * kWidthBits, kWidthBits);
        const std::size_t count = 1 + field(3 * kWidthBits, kCountBits);
        at_ += 3 * kWidthBits + kCountBits + kMarksBits;
        const Between about = passMarks(static_cast<CurveMarks>(field(3 * kWidthBits + kCountBits, kMarksBits)), count);
        const std::size_t stride = keys.width[0] + keys.width[1] + keys.width[2];
        keys.from = at_ + about.from * stride;
        keys.to = at_ + about.to * stride;
        keys.share = about.share;
        at_ += count * stride;
    }

    Between passMarks(CurveMarks marks, std::size_t count) {
        const std::size_t at = at_;
        if (marks == CurveMarks::all) return all_;
        if (marks == CurveMarks::list) {
            at_ += count * listWidth(times_.count);
            return inList(at, count);
        }
        at_ += times_.count + kRankBits * rankCount(times_.count);
        return inBits(at, count);
    }

    Between inList(std::size_t at, std::size_t count) const {
        const unsigned width = listWidth(times_.count);
        const auto entry = [&](std::size_t key) { return lowest(bitsAt(stream_, at + key * width), width); };
        std::size_t low = 0, high = count;  // keys below `low` are at times up to `before_`, those from `high` on later
        while (low < high) {
            const std::size_t middle = (low + high) / 2;
            if (entry(middle) <= before_)
                low = middle + 1;
            else
                high = middle;
        }
        if (low == 0) return {};
        if (low == count) return {count - 1, count - 1, 0};
        return {low - 1, low, between(entry(low - 1), entry(low)).share};
    }

    Between inBits(std::size_t at, std::size_t count) const {
        const auto block = [&](std::size_t index) {
            const std::size_t left = times_.count - kMarked * index;
            return lowest(bitsAt(stream_, at + kMarked * index),
                          static_cast<unsigned>(std::min<std::size_t>(kMarked, left)));
        };
        std::size_t word = before_ / kMarked, next = word;
        const std::uint64_t marks = block(word), until = (std::uint64_t{2} << before_ % kMarked) - 1;
        std::uint64_t bits = marks & until, rest = marks & ~until;
        auto rank = static_cast<std::size_t>(std::popcount(bits));
        if (word > 0) rank += lowest(bitsAt(stream_, at + times_.count + kRankBits * (word - 1)), kRankBits);
        if (rank == 0) return {};
        if (rank == count) return {count - 1, count - 1, 0};
        while (bits == 0) bits = block(--word);
        while (rest == 0) rest = block(++next);
        const std::size_t from = kMarked * word + 63u - static_cast<std::size_t>(std::countl_zero(bits)),
                          to = kMarked * next + static_cast<std::size_t>(std::countr_zero(rest));
        return {rank - 1, rank, between(from, to).share};
    }

    /// Of two times that have keys.
    Between between(std::size_t from, std::size_t to) const {
        const float start = times_.of(from);
        return {from, to, from == to ? 0.0f : std::clamp((time_ - start) / (times_.of(to) - start), 0.0f, 1.0f)};
    }

    const std::uint8_t* stream_;
    Times times_;
    float unit_;
    std::size_t at_ = 0, before_ = 0, bone_ = std::size_t{0} - 1;
    float time_ = 0;
    Between all_;  ///< of curves with a key at each time
};

}  // namespace

std::size_t CompressedClip::bytes() const { return times_.size() * sizeof(float) + stream_.size(); }

void sample(const CompressedClip& clip, const LocalPose& rest, float time, LocalPose& pose, const Pose& placement) {
    if (clip.tracks_ == 0) return;
    ClipReader reader(clip.stream_.data(), {clip.times_, clip.first_, clip.step_, clip.count_}, clip.unit_, time);
    Frame root;
    for (std::uint32_t i = 0; i < clip.tracks_; ++i) {
        reader.next(rest, pose, root);
        if (i == 0 && reader.bone() == 0) pose.root = placement * root;
    }
}

}  // namespace ragtop
