#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "bit_stream.h"
#include "ragtop/math.h"

/// Three numbers over time as few bits: the places of a bone, or its turns, beside those at rest. In the stream:
///
///     none       at rest all the time: nothing
///     constant   step 5, one of 16 widths 4, then three numbers of that width with a sign
///     moving     step 5, width 5, the lowest of each number likewise; three widths of 5, keys less one 16, kind of
///     marks 2; marks;
///                for each key what its numbers are above the lowest
///
///     chords     likewise, of turns that go along the chord between keys, where numbers are too far apart to go
///     straight
///
/// Between keys the numbers go straight. Marks say which times have a key: all do; or a bit for each time, with the
/// number of keys before for each 56 but the first; or their numbers, of as many bits as the number of times has.
namespace ragtop {

enum class CurveKind : std::uint8_t { none, constant, moving, chords };
enum class CurveMarks : std::uint8_t { all, bits, list };

inline constexpr unsigned kStepBits = 5, kWidthBits = 5, kStillWidthBits = 4, kCountBits = 16, kMarksBits = 2;
inline constexpr unsigned kMarked = 56;    ///< times whose marks are read at once
inline constexpr unsigned kRankBits = 16;  ///< of a number of keys

/// Of a unit, from 1 down to 2.2e-5 by the root of two.
inline constexpr auto kCurveSteps = [] {
    std::array<float, 1u << kStepBits> steps{};
    double step = 1;
    for (float& of : steps) {
        of = static_cast<float>(step);
        step *= 0.70710678118654752;
    }
    return steps;
}();

/// Modified Rodrigues parameters: the axis times the tangent of a quarter of the angle. Finite below a whole turn, so
/// that turns beyond half a one go on as they began.
inline Quat turnOf(const Vec3& p) {
    const float square = dot(p, p), share = 1 / (1 + square);
    return {2 * share * p.x, 2 * share * p.y, 2 * share * p.z, (1 - square) * share};
}
/// Of a unit quaternion with w above −1.
inline Vec3 parametersOf(const Quat& q) { return 1 / (1 + q.w) * Vec3{q.x, q.y, q.z}; }

/// Along the chord, with the share by which that is where the arc would be, within 2e-5 of the angle; not normalised
/// [Kapoulkine, Approximating slerp, 2015].
inline Quat alongChord(const Quat& from, const Quat& to, float share) {
    const float cosine = from.x * to.x + from.y * to.y + from.z * to.z + from.w * to.w, d = std::abs(cosine);
    const float outer = 1.0904f + d * (-3.2452f + d * (3.55645f - d * 1.43519f)),
                inner = 0.848013f + d * (-1.06021f + d * 0.215638f), off = share - 0.5f;
    const float along = share + share * off * (share - 1) * (outer * off * off + inner);
    const float a = 1 - along, b = cosine < 0 ? -along : along;
    return {a * from.x + b * to.x, a * from.y + b * to.y, a * from.z + b * to.z, a * from.w + b * to.w};
}

/// Between the keys of a curve: the numbers go straight, or the turns themselves along the chord.
inline Quat turnBetween(const Vec3& from, const Vec3& to, float share, bool chords) {
    if (!chords) return turnOf(from + share * (to - from));
    return normalized(alongChord(turnOf(from), turnOf(to), share));
}

/// Widths of numbers that stay: up to twelve bits as they are, more by a few.
inline constexpr std::array<unsigned, 1u << kStillWidthBits> kStillWidths{0, 1, 2,  3,  4,  5,  6,  7,
                                                                          8, 9, 10, 11, 12, 15, 20, 26};
inline constexpr float kMostSteps = (1 << 25) - 2;  ///< of any number, either way: 26 bits with a sign

using CurveKey = std::array<std::int32_t, 3>;  ///< in steps

struct ClipCurve {
    CurveKind kind = CurveKind::none;
    unsigned step = 0;                ///< of kCurveSteps
    std::vector<std::uint16_t> at{};  ///< number of the time of each key
    std::vector<CurveKey> keys{};

    Vec3 key(std::size_t index, float unit) const {
        const float size = unit * kCurveSteps[step];
        const CurveKey& k = keys[index];
        return {size * static_cast<float>(k[0]), size * static_cast<float>(k[1]), size * static_cast<float>(k[2])};
    }
};

/// A pose of one time has nothing that moves.
constexpr unsigned kindBits(std::size_t timeCount) { return timeCount == 1 ? 1 : 2; }
constexpr std::size_t rankCount(std::size_t timeCount) { return (timeCount - 1) / kMarked; }
constexpr unsigned listWidth(std::size_t timeCount) { return static_cast<unsigned>(std::bit_width(timeCount - 1)); }

/// Bits that a curve takes in the stream, and the curve there, of a clip with so many times.
std::size_t bitsOf(const ClipCurve& curve, std::size_t timeCount);
void write(const ClipCurve& curve, std::size_t timeCount, BitWriter& into);

}  // namespace ragtop
