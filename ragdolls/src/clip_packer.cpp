#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "curve_packer.h"
#include "ragtop/compressed_clip.h"

namespace ragtop {

namespace {

constexpr float kLeastArm = 0.05f;  // m, that a bone without others below it reaches

/// How far what hangs on each bone reaches from it, at rest; or the next bones alone.
std::vector<float> reaches(const Skeleton& skeleton, bool next) {
    std::vector<float> reach(skeleton.bones.size(), kLeastArm);
    for (std::size_t i = skeleton.bones.size(); i-- > 1;) {
        const Bone& bone = skeleton.bones[i];
        const auto parent = static_cast<std::size_t>(bone.parent);
        const float away = length(bone.bind.position - skeleton.bones[parent].bind.position);
        reach[parent] = std::max(reach[parent], next ? away : away + reach[i]);
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

/// Of modified Rodrigues parameters that are off by one, rad; less beyond small turns.
constexpr float kTurnReach = 4;

/// Parameters of turns that go on beyond half a turn, and leap back before a whole one.
std::vector<Vec3> unrolled(const std::vector<Quat>& turns) {
    constexpr float kLeast = -0.5f;  // of w: two thirds of a turn
    std::vector<Vec3> parameters;
    Quat before{0, 0, 0, 1};
    const auto back = [](const Quat& q) { return Quat{-q.x, -q.y, -q.z, -q.w}; };
    for (std::size_t i = 0; i < turns.size(); i += kParts) {
        Quat q = turns[i];
        if (q.x * before.x + q.y * before.y + q.z * before.z + q.w * before.w < 0) q = back(q);
        if (q.w < kLeast) q = back(q);
        parameters.push_back(parametersOf(q));
        before = q;
    }
    return parameters;
}

}  // namespace

/// Packs with shares of the error that shrink until what is measured keeps to it, and then gives each bone as much more
/// as that allows: the farthest points are on one limb, and others may be looser.
class ClipPacker {
public:
    ClipPacker(const Clip& clip, const Skeleton& skeleton, float maxError)
        : clip_(clip), skeleton_(skeleton), maxError_(maxError), shares_(sharesOf(skeleton, clip)) {
        for (const ClipTrack& track : clip.tracks) times_.insert(times_.end(), track.times.begin(), track.times.end());
        std::sort(times_.begin(), times_.end());
        times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
        constexpr std::size_t kMost = 65535;
        if (times_.size() > kMost)
            throw std::invalid_argument("clip '" + clip.name + "' has " + std::to_string(times_.size()) +
                                        " times, must have at most 65535");
        reach_ = reaches(skeleton, isPose());
        rest_ = restPose(skeleton);
        for (const ClipTrack& track : clip.tracks) tracks_.push_back(sourceOf(track));
        std::sort(tracks_.begin(), tracks_.end(),
                  [](const TrackSource& a, const TrackSource& b) { return a.track->bone < b.track->bone; });
        layExact();
    }

    CompressedClip pack() {
        if (tracks_.empty()) return assembled();
        constexpr int kTrials = 24, kFiner = 4;
        constexpr float kFirst = 16, kLess = 0.7f;  // errors of a chain seldom add up
        float share = kFirst;
        for (int i = 0; i < kTrials; ++i, share *= kLess) {
            packAll(share);
            if (!holds()) continue;
            float low = share, high = share / kLess;
            for (int k = 0; k < kFiner; ++k) {
                const float middle = 0.5f * (low + high);
                packAll(middle);
                (holds() ? low : high) = middle;
            }
            packAll(low);
            share_ = low;
            loosen();
            return assembled();
        }
        throw std::invalid_argument("clip '" + clip_.name + "': maxError is " + std::to_string(maxError_) +
                                    " m, must be more for a body that moves as far");
    }

private:
    struct PackedTrack {
        ClipCurve turn{}, place{};
        std::vector<Frame> reached{};  ///< at all parts

        std::size_t bits(std::size_t timeCount) const { return bitsOf(turn, timeCount) + bitsOf(place, timeCount); }
    };

    /// What a track has at its keys and in the middle between them, beside the body at rest.
    struct TrackSource {
        const ClipTrack* track;
        Frame rest;
        std::vector<std::uint16_t> at;            ///< numbers of the times
        std::vector<Quat> turns;                  ///< at its parts
        std::vector<Vec3> parameters, ways;       ///< of turns and places, at keys
        float turnAllowed = 1, placeAllowed = 1;  ///< times their share of the error
        PackedTrack packed{};
    };

    float partTime(std::size_t part) const { return atPart(std::span<const float>(times_), part); }
    std::size_t parts() const { return partCount(times_.size()); }

    TrackSource sourceOf(const ClipTrack& track) const {
        const auto bone = static_cast<std::size_t>(track.bone);
        TrackSource source{
            &track, bone == 0 ? Frame{toVec3(rest_.root.position), rest_.root.rotation} : rest_.bones[bone], {}, {}, {},
            {}};
        source.rest.rotation = normalized(source.rest.rotation);
        for (std::size_t i = 0; i < track.keys.size(); ++i) {
            const Quat turn = normalized(conjugate(source.rest.rotation) * track.keys[i].rotation);
            for (std::size_t part = 1; i > 0 && part < kParts; ++part) {
                const Pose from{{}, source.turns[kParts * (i - 1)]};
                source.turns.push_back(blend(from, Pose{{}, turn}, static_cast<double>(shareOf(part))).rotation);
            }
            source.turns.push_back(turn);
            source.ways.push_back(track.keys[i].position - source.rest.position);
            const auto at = std::lower_bound(times_.begin(), times_.end(), track.times[i]) - times_.begin();
            source.at.push_back(static_cast<std::uint16_t>(at));
        }
        source.parameters = unrolled(source.turns);
        return source;
    }

    /// Where the clip has the bones at all parts of the times, if that is not too much to keep.
    void layExact() {
        constexpr std::size_t kMost = 1'000'000;  // poses of a bone, 56 MB
        const std::size_t count = skeleton_.bones.size();
        posed_.resize(count);
        exactPosed_.resize(count);
        exactLocal_ = rest_;
        if (parts() > kMost / count && !isPose()) return;
        std::vector<Pose> all;
        for (std::size_t part = 0; part < parts(); ++part) {
            const std::span<const Pose> exact = exactAt(part);
            all.insert(all.end(), exact.begin(), exact.end());
        }
        exact_ = std::move(all);
    }
    /// Valid until the next call.
    std::span<const Pose> exactAt(std::size_t part) {
        const std::size_t count = skeleton_.bones.size();
        if (!exact_.empty()) return std::span<const Pose>(exact_).subspan(part * count, count);
        sample(clip_, partTime(part), exactLocal_);
        writePose(skeleton_, exactLocal_, exactPosed_);
        return exactPosed_;
    }

    void packAll(float share) {
        share_ = share;
        if (isPose()) return packPose();
        for (TrackSource& track : tracks_) pack(track);
    }

    bool isPose() const { return times_.size() == 1; }

    /// What a bone is off, those that hang on it make good: in its turn alone where its own place is that at rest.
    void packPose() {
        auto track = tracks_.begin();
        for (std::size_t i = 0; i < posed_.size(); ++i) {
            const Pose above = i == 0 ? Pose{} : posed_[static_cast<std::size_t>(skeleton_.bones[i].parent)];
            Frame own = i == 0 ? Frame{toVec3(rest_.root.position), rest_.root.rotation} : rest_.bones[i];
            if (track != tracks_.end() && static_cast<std::size_t>(track->track->bone) == i) {
                const Quat& still = track->rest.rotation;
                track->turns = {normalized(conjugate(still) * (conjugate(above.rotation) * exact_[i].rotation))};
                track->parameters = unrolled(track->turns);
                const Vec3 way = track->track->keys[0].position - track->rest.position;
                const bool stays = length(way) <= track->placeAllowed * allowedOf(*track);
                track->ways = {stays ? way : inverseTransformPoint(above, exact_[i].position) - track->rest.position};
                pack(*track);
                own = track->packed.reached[0];
                ++track;
            }
            posed_[i] = above * own;
            posed_[i].rotation = normalized(posed_[i].rotation);
        }
    }
    void pack(TrackSource& track) {
        packTurn(track);
        packPlace(track);
        lay(track);
    }
    float allowedOf(const TrackSource& track) const {
        return 0.5f * share_ * maxError_ * shares_[static_cast<std::size_t>(track.track->bone)];
    }
    void packTurn(TrackSource& track) {
        const float angle = track.turnAllowed * allowedOf(track) / reach_[static_cast<std::size_t>(track.track->bone)];
        const CurveSource source{track.track->times, track.at, track.parameters, 1};
        const auto packed = [&](bool chords) {
            return packCurve(source, times_.size(), kTurnReach, angle,
                             [&](std::size_t part, const Vec3& from, const Vec3& to, float at) {
                                 return angleBetween(track.turns[part], turnBetween(from, to, at, chords));
                             });
        };
        Packed straight = packed(false);
        track.packed.turn = straight.holds ? std::move(straight.curve) : packed(true).curve;
        if (!straight.holds && track.packed.turn.kind == CurveKind::moving) track.packed.turn.kind = CurveKind::chords;
    }
    void packPlace(TrackSource& track) {
        const CurveSource source{track.track->times, track.at, track.ways, maxError_};
        const auto wayAt = [&](std::size_t part) { return atPart(std::span<const Vec3>(track.ways), part); };
        track.packed.place = packCurve(source, times_.size(), 1, track.placeAllowed * allowedOf(track),
                                       [&](std::size_t part, const Vec3& from, const Vec3& to, float at) {
                                           return length(wayAt(part) - (from + at * (to - from)));
                                       })
                                 .curve;
    }

    /// What is read of the curves at all parts of the times.
    void lay(TrackSource& track) const {
        track.packed.reached.assign(parts(), track.rest);
        eachPart(track.packed.turn, 1, [&](std::size_t part, const Vec3& from, const Vec3& to, float share) {
            track.packed.reached[part].rotation =
                track.rest.rotation * turnBetween(from, to, share, track.packed.turn.kind == CurveKind::chords);
        });
        eachPart(track.packed.place, maxError_, [&](std::size_t part, const Vec3& from, const Vec3& to, float share) {
            track.packed.reached[part].position = track.rest.position + from + share * (to - from);
        });
    }

    template <class Set>
    void eachPart(const ClipCurve& curve, float unit, const Set& set) const {
        if (curve.kind == CurveKind::none) return;
        std::size_t next = 0;  // key
        for (std::size_t part = 0; part < parts(); ++part) {
            const float time = partTime(part);
            while (curve.kind != CurveKind::constant && next < curve.keys.size() && kParts * curve.at[next] <= part)
                ++next;
            const Vec3 from = curve.key(next == 0 ? 0 : next - 1, unit);
            if (curve.kind == CurveKind::constant || next == 0 || next == curve.keys.size()) {
                set(part, from, from, 0.0f);
                continue;
            }
            const float start = times_[curve.at[next - 1]], end = times_[curve.at[next]];
            set(part, from, curve.key(next, unit), (time - start) / (end - start));
        }
    }

    /// Are ends of bones, and points beside them, where the clip has them? What failed last is asked first.
    bool holds() {
        const double most = 0.9995 * maxError_;  // room for the rounding of times
        if (farthestAt(failed_) > most * most) return false;
        for (std::size_t part = 0; part < parts(); ++part)
            if (farthestAt(part) > most * most) {
                failed_ = part;
                return false;
            }
        return true;
    }

    /// m², at a part.
    double farthestAt(std::size_t part) {
        local_ = rest_;
        for (const TrackSource& track : tracks_) {
            const Frame& frame = track.packed.reached[part];
            if (track.track->bone == 0)
                local_.root = Pose{} * frame;
            else
                local_.bones[static_cast<std::size_t>(track.track->bone)] = frame;
        }
        writePose(skeleton_, local_, posed_);
        return farthestApart(posed_, exactAt(part));
    }

    static double farthestApart(std::span<const Pose> a, std::span<const Pose> b) {
        double worst = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            for (const Vec3& side : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
                const Vec3 p = kLeastArm * side;
                const DVec3 d =
                    (a[i].position - b[i].position) + DVec3(rotate(a[i].rotation, p) - rotate(b[i].rotation, p));
                worst = std::max(worst, d.x * d.x + d.y * d.y + d.z * d.z);
            }
        return worst;
    }

    void loosen() {
        constexpr std::size_t kMostWork = 500'000'000;  // bones posed, beyond which it would take minutes
        if (skeleton_.bones.size() * parts() > kMostWork / tracks_.size()) return;
        if (isPose()) return loosenPose();
        for (const float more : {2.8f, 1.4f, 1.2f})
            for (TrackSource& track : tracks_) {
                const auto loosened = [&](float& own, auto&& packAgain) {
                    const PackedTrack before = track.packed;
                    const float tight = std::exchange(own, own * more);
                    packAgain();
                    lay(track);
                    if (track.packed.bits(times_.size()) < before.bits(times_.size()) && holds()) return;
                    track.packed = before;
                    own = tight;
                };
                loosened(track.turnAllowed, [&] { packTurn(track); });
                loosened(track.placeAllowed, [&] { packPlace(track); });
            }
    }

    /// From a quarter of the error on: in each round first what saves most bits for what it adds to the errors.
    void loosenPose() {
        constexpr float kFine = 0.25f;
        const float share = share_;
        packAll(kFine * share);
        if (!holds()) return packAll(share);  // where roundings happened to fit
        for (bool looser = true; looser;) {
            looser = false;
            std::vector<Loosening> ways;
            for (std::size_t i = 0; i < tracks_.size(); ++i)
                for (float TrackSource::*const allowed : {&TrackSource::turnAllowed, &TrackSource::placeAllowed})
                    if (Loosening way = looseningOf(i, allowed); way.gain > 0) {
                        way.number = ways.size();
                        ways.push_back(way);
                    }
            std::sort(ways.begin(), ways.end(), [](const Loosening& a, const Loosening& b) {
                return a.gain != b.gain ? a.gain > b.gain : a.number < b.number;
            });
            for (std::size_t k = 0; k < std::max<std::size_t>(1, ways.size() / 8) && k < ways.size(); ++k)
                looser = loosenedBy(ways[k]) || looser;
        }
        packPose();
    }
    /// What a bone's turn or place may be off for one bit less, and bits over errors.
    struct Loosening {
        std::size_t track;
        float TrackSource::*allowed;
        float more = 1;
        double gain = 0;
        std::size_t number = 0;
    };
    Loosening looseningOf(std::size_t track, float TrackSource::*allowed) {
        constexpr float kMore = 1.42f;  // a step
        constexpr int kSteps = 4;
        Loosening way{track, allowed};
        float& own = tracks_[track].*allowed;
        const float before = own;
        const std::size_t bits = bitsOfAll();
        const double errors = errorsOfPose();
        for (int k = 0; k < kSteps && bitsOfAll() >= bits; ++k) {
            own *= kMore;
            packPose();
        }
        if (bitsOfAll() < bits && holds())
            way.gain = static_cast<double>(bits - bitsOfAll()) / std::max(1e-12, errorsOfPose() - errors);
        way.more = own / before;
        own = before;
        packPose();
        return way;
    }
    bool loosenedBy(const Loosening& way) {
        float& own = tracks_[way.track].*way.allowed;
        const float before = own;
        const std::size_t bits = bitsOfAll();
        own *= way.more;
        packPose();
        if (bitsOfAll() < bits && holds()) return true;
        own = before;
        packPose();
        return false;
    }
    std::size_t bitsOfAll() const {
        std::size_t sum = 0;
        for (const TrackSource& track : tracks_) sum += track.packed.bits(times_.size());
        return sum;
    }
    double errorsOfPose() {
        farthestAt(0);
        double sum = 0;
        for (std::size_t i = 0; i < posed_.size(); ++i) {
            const double square = farthestApart(std::span(posed_).subspan(i, 1), std::span(exact_).subspan(i, 1)) /
                                  (maxError_ * maxError_);
            sum += square * square * square;
        }
        return sum;
    }

    CompressedClip assembled() {
        CompressedClip made;
        made.name_ = clip_.name;
        made.seconds_ = clip_.seconds;
        made.unit_ = maxError_;
        if (tracks_.empty()) return made;
        made.count_ = static_cast<std::uint32_t>(times_.size());
        made.tracks_ = static_cast<std::uint32_t>(tracks_.size());
        putTimes(made);
        BitWriter into;
        int before = -1;
        for (const TrackSource& track : tracks_) {
            const bool next = track.track->bone == before + 1;
            before = track.track->bone;
            into.put(next ? 1 : 0, 1);
            into.put(static_cast<std::uint64_t>(track.packed.turn.kind), kindBits(times_.size()));
            into.put(static_cast<std::uint64_t>(track.packed.place.kind), kindBits(times_.size()));
            if (!next) into.put(static_cast<std::uint64_t>(before), 16);
            write(track.packed.turn, times_.size(), into);
            write(track.packed.place, times_.size(), into);
        }
        made.stream_ = std::move(into).finished();
        made.error_ = errorOf(made);
        return made;
    }

    void putTimes(CompressedClip& made) const {
        made.first_ = times_[0];
        if (times_.size() == 1) return;
        made.step_ = (times_.back() - times_[0]) / static_cast<float>(times_.size() - 1);
        constexpr float kEven = 1e-4f;  // of a step
        for (std::size_t i = 0; i < times_.size(); ++i)
            if (!(std::abs(made.first_ + made.step_ * static_cast<float>(i) - times_[i]) <= kEven * made.step_)) {
                made.times_ = times_;
                return;
            }
    }

    /// As read.
    float errorOf(const CompressedClip& made) {
        LocalPose pose = rest_;
        std::vector<Pose> posed(skeleton_.bones.size());
        double worst = 0;
        for (std::size_t part = 0; part < parts(); ++part) {
            sample(made, rest_, partTime(part), pose);
            writePose(skeleton_, pose, posed);
            worst = std::max(worst, farthestApart(posed, exactAt(part)));
        }
        return static_cast<float>(std::sqrt(worst));
    }

    const Clip& clip_;
    const Skeleton& skeleton_;
    float maxError_, share_ = 1;
    std::vector<float> reach_, shares_, times_;
    LocalPose rest_, local_, exactLocal_;
    std::vector<TrackSource> tracks_;
    std::vector<Pose> exact_, posed_, exactPosed_;
    std::size_t failed_ = 0;
};

CompressedClip::CompressedClip(const Clip& clip, const Skeleton& skeleton, float maxError) {
    if (std::string why = whyInvalid(skeleton); !why.empty()) throw std::invalid_argument("compress: " + why);
    if (std::string why = whyInvalid(clip, skeleton); !why.empty()) throw std::invalid_argument("compress: " + why);
    if (!(maxError > 0 && maxError <= 10))
        throw std::invalid_argument("compress: maxError is " + std::to_string(maxError) + ", must be in (0, 10] m");
    *this = ClipPacker(clip, skeleton, maxError).pack();
}

}  // namespace ragtop
