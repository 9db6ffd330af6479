#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "clip_curve.h"

namespace ragtop {

/// What a curve is to stand for: numbers at times, and between each two of those in the middle.
struct CurveSource {
    std::span<const float> times;       ///< s, of the keys
    std::span<const std::uint16_t> at;  ///< their numbers among those of the clip
    std::span<const Vec3> keys;         ///< the three numbers at each
    float unit = 1;
};

/// The curve, and whether it is within what is allowed where all its keys are kept.
struct Packed {
    ClipCurve curve{};
    bool holds = false;
};

/// What is to be is asked at keys, and at three places between each two: that is parts of the way from key to key.
inline constexpr std::size_t kParts = 4;
constexpr std::size_t partCount(std::size_t keyCount) { return keyCount == 0 ? 0 : kParts * (keyCount - 1) + 1; }
constexpr float shareOf(std::size_t part) { return static_cast<float>(part % kParts) / static_cast<float>(kParts); }

/// Straight between the keys.
template <class T>
T atPart(std::span<const T> keys, std::size_t part) {
    const T& from = keys[part / kParts];
    return part % kParts == 0 ? from : from + shareOf(part) * (keys[part / kParts + 1] - from);
}

/// The curve of fewest keys that is within `allowed`, whose keys are multiples of a step. `apart(part, from, to,
/// share)` is how far the way between two keys is from what is to be.
template <class Apart>
class CurvePacker {
public:
    CurvePacker(const CurveSource& source, std::size_t timeCount, unsigned step, float allowed, const Apart& apart)
        : source_(source), apart_(apart), timeCount_(timeCount), allowed_(allowed) {
        curve_.step = step;
    }

    Packed pack() {
        const float size = source_.unit * kCurveSteps[curve_.step];
        Vec3 lower = source_.keys[0], upper = lower;
        for (const Vec3& key : source_.keys) lower = min(lower, key), upper = max(upper, key);
        if (stays({0, 0, 0})) return {curve_, true};
        const CurveKey middle = rounded(0.5f * (lower + upper), size);
        if (stays(inUnits(middle, size))) {
            curve_.kind = CurveKind::constant;
            curve_.keys = {middle};
            return {curve_, true};
        }
        for (const Vec3& key : source_.keys) {
            steps_.push_back(rounded(key, size));
            reached_.push_back(inUnits(steps_.back(), size));
        }
        curve_.kind = CurveKind::moving;
        put(0);
        const std::size_t last = source_.keys.size() - 1;
        for (std::size_t from = 0; from < last;) put(from = farthestFrom(from, last));
        if (ClipCurve whole = withAllKeys(); isPreferred(whole)) curve_ = std::move(whole);
        return {std::move(curve_), holds_};
    }

private:
    static CurveKey rounded(const Vec3& numbers, float size) {
        CurveKey key{};
        for (int i = 0; i < 3; ++i) {
            const float steps = std::clamp(numbers[i] / size, -kMostSteps, kMostSteps);
            key[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(std::lround(steps));
        }
        return key;
    }
    static Vec3 inUnits(const CurveKey& key, float size) {
        return {size * static_cast<float>(key[0]), size * static_cast<float>(key[1]),
                size * static_cast<float>(key[2])};
    }
    void put(std::size_t key) {
        curve_.at.push_back(source_.at[key]);
        curve_.keys.push_back(steps_[key]);
    }

    ClipCurve withAllKeys() const { return {curve_.kind, curve_.step, {source_.at.begin(), source_.at.end()}, steps_}; }
    /// Keys at all times are found without a search, which is worth some memory.
    bool isPreferred(const ClipCurve& whole) const {
        constexpr float kWorth = 2;
        return whole.keys.size() == timeCount_ &&
               static_cast<float>(bitsOf(whole, timeCount_)) <= kWorth * static_cast<float>(bitsOf(curve_, timeCount_));
    }

    bool stays(const Vec3& at) const {
        for (std::size_t part = 0; part < partCount(source_.keys.size()); ++part)
            if (apart_(part, at, at, 0.0f) > allowed_) return false;
        return true;
    }

    bool spans(std::size_t from, std::size_t to) const {
        const float start = source_.times[from], whole = source_.times[to] - start;
        for (std::size_t part = kParts * from + 1; part < kParts * to; ++part) {
            const float time = atPart(source_.times, part);
            if (apart_(part, reached_[from], reached_[to], (time - start) / whole) > allowed_) return false;
        }
        return true;
    }

    /// In leaps that double, then by halving: what is between on the way is as good.
    std::size_t farthestFrom(std::size_t from, std::size_t last) {
        constexpr std::size_t kLongest = 256;  // keys; a bound on time
        if (!spans(from, from + 1)) {
            holds_ = false;
            return from + 1;
        }
        const std::size_t most = std::min(last, from + kLongest);
        std::size_t good = from + 1, bad = most + 1;
        for (std::size_t leap = 1; good < most; leap *= 2) {
            const std::size_t to = std::min(good + leap, most);
            if (!spans(from, to)) {
                bad = to;
                break;
            }
            good = to;
        }
        while (good + 1 < bad) {
            const std::size_t middle = (good + bad) / 2;
            (spans(from, middle) ? good : bad) = middle;
        }
        return good;
    }

    const CurveSource& source_;
    const Apart& apart_;
    std::size_t timeCount_;
    float allowed_;
    ClipCurve curve_;
    bool holds_ = true;
    std::vector<CurveKey> steps_;
    std::vector<Vec3> reached_;
};

/// With the step that takes least of those that are fine enough. `reach`: how far, at most, a number that is off by one
/// puts what is measured.
template <class Apart>
Packed packCurve(const CurveSource& source, std::size_t timeCount, float reach, float allowed, const Apart& apart) {
    // Half a step off in each number, and room for what lies between keys.
    constexpr float kHalfDiagonal = 0.866f, kRoom = 0.8f;
    constexpr unsigned kTries = 3;
    float largest = 0;
    for (const Vec3& key : source.keys)
        largest = std::max({largest, std::abs(key.x), std::abs(key.y), std::abs(key.z)});
    const auto tooFine = std::find_if(kCurveSteps.begin() + 1, kCurveSteps.end(),
                                      [&](float step) { return kMostSteps * source.unit * step < largest; });
    const auto fine = std::find_if(kCurveSteps.begin(), tooFine - 1, [&](float step) {
        return kHalfDiagonal * reach * source.unit * step <= kRoom * allowed;
    });
    const auto first = static_cast<unsigned>(fine - kCurveSteps.begin()),
               end = std::min(first + kTries, static_cast<unsigned>(tooFine - kCurveSteps.begin()));
    Packed best;
    std::size_t least = 0;
    for (unsigned step = first; step < end; ++step) {
        Packed made = CurvePacker<Apart>(source, timeCount, step, allowed, apart).pack();
        const std::size_t bits = bitsOf(made.curve, timeCount);
        if (step == first || (made.holds && (!best.holds || bits < least))) best = std::move(made), least = bits;
    }
    return best;
}

}  // namespace ragtop
