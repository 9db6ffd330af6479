#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "packed_key.h"
#include "ragtop/compressed_clip.h"

namespace ragtop {

namespace {

constexpr float kLeastArm = 0.05f;  // m, that a bone without others below it reaches

/// How far what hangs on each bone reaches from it, at rest.
std::vector<float> reaches(const Skeleton& skeleton) {
    std::vector<float> reach(skeleton.bones.size(), kLeastArm);
    for (std::size_t i = skeleton.bones.size(); i-- > 1;) {
        const Bone& bone = skeleton.bones[i];
        if (bone.parent < 0) continue;
        const auto parent = static_cast<std::size_t>(bone.parent);
        const float away = length(bone.bind.position - skeleton.bones[parent].bind.position);
        reach[parent] = std::max(reach[parent], away + reach[i]);
    }
    return reach;
}

float angleBetween(const Quat& a, const Quat& b) {
    const Quat d = conjugate(a) * b;
    return 2 * std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

/// The share of the error that each bone gets of that of the longest way through it.
std::vector<float> sharesOf(const Skeleton& skeleton, const Clip& clip) {
    std::vector<float> own(skeleton.bones.size(), 0);
    for (const ClipTrack& track : clip.tracks) own[static_cast<std::size_t>(track.bone)] = 1;
    std::vector<float> above = own, below = own;
    const auto parent = [&](std::size_t i) { return skeleton.bones[i].parent; };
    for (std::size_t i = 0; i < own.size(); ++i)
        if (parent(i) >= 0) above[i] += above[static_cast<std::size_t>(parent(i))];
    for (std::size_t i = own.size(); i-- > 0;)
        if (parent(i) >= 0) {
            const auto p = static_cast<std::size_t>(parent(i));
            below[p] = std::max(below[p], own[p] + below[i]);
        }
    for (std::size_t i = 0; i < own.size(); ++i)
        if (own[i] > 0) own[i] /= above[i] + below[i] - own[i];
    return own;
}

}  // namespace

/// Packs with shares of the error that shrink until what is measured keeps to it, and then gives each bone as much more
/// as that allows: the farthest points are on one limb, and others may be looser.
class ClipPacker {
public:
    ClipPacker(const Clip& clip, const Skeleton& skeleton, float maxError)
        : clip_(clip),
          skeleton_(skeleton),
          reach_(reaches(skeleton)),
          shares_(sharesOf(skeleton, clip)),
          coarse_(skeleton.bones.size(), false) {
        for (const ClipTrack& track : clip.tracks) times_.insert(times_.end(), track.times.begin(), track.times.end());
        std::sort(times_.begin(), times_.end());
        times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
        constexpr std::size_t kMost = 65535;
        if (times_.size() > kMost || skeleton.bones.size() > kMost)
            throw std::invalid_argument("clip '" + clip.name + "' has " + std::to_string(times_.size()) +
                                        " times, must have at most 65535");
        maxError_ = maxError;
    }

    CompressedClip pack() {
        constexpr int kTrials = 20, kFiner = 4;
        constexpr float kFirst = 16, kLess = 0.7f;  // errors of a chain seldom add up
        float share = kFirst;
        for (int i = 0; i < kTrials; ++i, share *= kLess) {
            CompressedClip best = packed(share);
            if (best.error_ > maxError_) continue;
            float low = share, high = share / kLess;
            for (int k = 0; k < kFiner; ++k) {
                const float middle = 0.5f * (low + high);
                CompressedClip made = packed(middle);
                const bool holds = made.error_ <= maxError_;
                (holds ? low : high) = middle;
                if (holds && made.bytes() <= best.bytes()) best = std::move(made);
            }
            loosen(low, best);
            return best;
        }
        throw std::invalid_argument("clip '" + clip_.name + "': maxError is " + std::to_string(maxError_) +
                                    " m, must be more for a body that moves as far");
    }

private:
    void loosen(float share, CompressedClip& best) {
        const auto helps = [&] {
            CompressedClip made = packed(share);
            const bool better = made.error_ <= maxError_ && made.bytes() <= best.bytes();
            if (better) best = std::move(made);
            return better;
        };
        for (std::size_t i = clip_.tracks.size(); i-- > 0;) {
            const auto bone = static_cast<std::size_t>(clip_.tracks[i].bone);
            coarse_[bone] = true;
            coarse_[bone] = helps();
        }
        for (const float more : {3.0f, 1.7f, 1.3f, 1.15f})
            for (const ClipTrack& track : clip_.tracks) {
                float& own = shares_[static_cast<std::size_t>(track.bone)];
                const float before = own;
                own *= more;
                if (!helps()) own = before;
            }
    }

    CompressedClip packed(float share) const {
        CompressedClip made;
        made.name_ = clip_.name;
        made.seconds_ = clip_.seconds;
        made.times_ = times_;
        for (const ClipTrack& track : clip_.tracks) add(made, track, share);
        made.error_ = errorOf(made);
        return made;
    }

    void add(CompressedClip& made, const ClipTrack& track, float share) const {
        const auto bone = static_cast<std::size_t>(track.bone);
        const float allowed = share * maxError_ * shares_[bone] / 2, angle = allowed / reach_[bone];
        CompressedClip::Track to;
        to.bone = static_cast<std::uint16_t>(bone);
        to.firstWord = static_cast<std::uint32_t>(made.words_.size());
        to.coarse = coarse_[bone];
        to.firstMarks = static_cast<std::uint32_t>(made.marks_.size());
        to.firstPlace = static_cast<std::uint32_t>(made.places_.size());
        Vec3 low = track.keys[0].position, high = low;
        for (const Frame& key : track.keys) low = min(low, key.position), high = max(high, key.position);
        constexpr float kSteps = 65535;
        const Vec3 step = (1 / kSteps) * (high - low);
        const auto turnError = [&](const Frame& key, const Frame& from, const Frame& next, float at) {
            return angleBetween(key.rotation, alongChord(from.rotation, next.rotation, at));
        };
        const auto placeError = [&](const Frame& key, const Frame& from, const Frame& next, float at) {
            return length(key.position - (from.position + at * (next.position - from.position)));
        };
        to.turns = addKeys(made, track, angle, turnError, [&](const Frame& f) {
            packTurn(f.rotation, to.coarse ? kCoarseTurn : kFineTurn, made.words_);
        });
        if (length(high - low) > allowed) {
            made.places_.insert(made.places_.end(), {low, step});
            to.places = addKeys(made, track, allowed, placeError, [&](const Frame& f) {
                const PackedPlace packed = packPlace(f.position, low, step);
                made.words_.insert(made.words_.end(), packed.begin(), packed.end());
            });
        } else {
            made.places_.push_back(0.5f * (low + high));
        }
        made.tracks_.push_back(to);
    }

    /// From each key on to the farthest one that all between are near the way to.
    template <class Error, class Pack>
    std::uint16_t addKeys(CompressedClip& made, const ClipTrack& track, float allowed, Error&& error,
                          Pack&& pack) const {
        const std::size_t marks = made.marks_.size();
        std::size_t count = 0;
        made.marks_.resize(marks + made.marksOfEach());
        const std::size_t given = track.keys.size();
        const auto put = [&](std::size_t i) {
            const auto at = std::lower_bound(times_.begin(), times_.end(), track.times[i]) - times_.begin();
            pack(track.keys[i]);
            ++count;
            constexpr auto kMarked = static_cast<std::ptrdiff_t>(CompressedClip::kMarked);
            made.marks_[marks + static_cast<std::size_t>(at / kMarked)] |= std::uint64_t{1} << (at % kMarked);
        };
        const auto spans = [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from + 1; i <= to; ++i) {
                const float whole = track.times[to] - track.times[from];
                if (error(track.keys[i], track.keys[from], track.keys[to],
                          (track.times[i] - track.times[from]) / whole) > allowed)
                    return false;
                const float middle = 0.5f * (track.times[i - 1] + track.times[i]);
                const Frame between{0.5f * (track.keys[i - 1].position + track.keys[i].position),
                                    alongChord(track.keys[i - 1].rotation, track.keys[i].rotation, 0.5f)};
                if (error(between, track.keys[from], track.keys[to], (middle - track.times[from]) / whole) > allowed)
                    return false;
            }
            return true;
        };
        const auto still = [&](std::size_t i) {
            return error(track.keys[i], track.keys[0], track.keys[0], 0) > allowed;
        };
        put(0);
        bool moves = false;
        for (std::size_t i = 1; i < given && !moves; ++i) moves = still(i);
        for (std::size_t from = 0; moves && from + 1 < given;) {
            std::size_t to = from + 1;
            constexpr std::size_t kLongest = 256;  // keys; a bound on time
            while (to + 1 < given && to - from < kLongest && spans(from, to + 1)) ++to;
            put(from = to);
        }
        if (count == 1) made.marks_.resize(marks);
        std::uint64_t earlier = 0;
        for (std::size_t w = marks; w < made.marks_.size(); ++w) {
            const auto own = static_cast<std::uint64_t>(std::popcount(made.marks_[w]));
            made.marks_[w] |= earlier << CompressedClip::kMarked;
            earlier += own;
        }
        return static_cast<std::uint16_t>(count);
    }

    /// Farthest that ends of bones, and points beside them, get from where the clip has them.
    float errorOf(const CompressedClip& made) const {
        LocalPose exact = restPose(skeleton_), other = exact;
        std::vector<Pose> a(skeleton_.bones.size()), b = a;
        double worst = 0;
        const auto compare = [&](float time) {
            sample(clip_, time, exact);
            sample(made, time, other);
            writePose(skeleton_, exact, a);
            writePose(skeleton_, other, b);
            for (std::size_t i = 0; i < a.size(); ++i)
                for (const Vec3& side : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
                    const Vec3 p = kLeastArm * side;
                    const DVec3 d =
                        (a[i].position - b[i].position) + DVec3(rotate(a[i].rotation, p) - rotate(b[i].rotation, p));
                    worst = std::max(worst, d.x * d.x + d.y * d.y + d.z * d.z);
                }
        };
        for (std::size_t i = 0; i < times_.size(); ++i) {
            compare(times_[i]);
            if (i > 0) compare(0.5f * (times_[i - 1] + times_[i]));
        }
        return static_cast<float>(std::sqrt(worst));
    }

    const Clip& clip_;
    const Skeleton& skeleton_;
    std::vector<float> reach_, shares_, times_;
    std::vector<bool> coarse_;  ///< keeps its turns coarsely
    float maxError_ = 0;
};

CompressedClip::CompressedClip(const Clip& clip, const Skeleton& skeleton, float maxError) {
    if (std::string why = whyInvalid(skeleton); !why.empty()) throw std::invalid_argument("compress: " + why);
    if (std::string why = whyInvalid(clip, skeleton); !why.empty()) throw std::invalid_argument("compress: " + why);
    if (!(maxError > 0 && maxError <= 10))
        throw std::invalid_argument("compress: maxError is " + std::to_string(maxError) + ", must be in (0, 10] m");
    *this = ClipPacker(clip, skeleton, maxError).pack();
}

}  // namespace ragtop
