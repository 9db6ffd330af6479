#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "ragtop/math.h"

/// Turns and places in words of 16 bits.
namespace ragtop {

/// How finely turns are kept: three numbers of so many bits, and two that tell which one is left out.
struct TurnFormat {
    unsigned bits, words;

    constexpr int steps() const { return (1 << (bits - 1)) - 1; }  ///< of a number on either side of 0
};
inline constexpr TurnFormat kFineTurn{15, 3}, kCoarseTurn{10, 2};
inline constexpr float kLargest = 0.707106781f;  ///< that the second largest number of a quaternion can be

using PackedPlace = std::array<std::uint16_t, 3>;

/// Appends the three smallest of the numbers, in steps.
inline void packTurn(const Quat& q, const TurnFormat& format, std::vector<std::uint16_t>& words) {
    const std::array<float, 4> all{q.x, q.y, q.z, q.w};
    std::size_t left = 0;
    for (std::size_t i = 1; i < 4; ++i)
        if (std::abs(all[i]) > std::abs(all[left])) left = i;
    const float sign = all[left] < 0 ? -1.0f : 1.0f;
    std::uint64_t packed = left;
    unsigned shift = 2;
    for (std::size_t i = 0; i < 4; ++i) {
        if (i == left) continue;
        const float steps = std::round(sign * all[i] / kLargest * static_cast<float>(format.steps()));
        packed |= static_cast<std::uint64_t>(static_cast<int>(steps) + format.steps()) << shift;
        shift += format.bits;
    }
    for (unsigned k = 0; k < format.words; ++k) words.push_back(static_cast<std::uint16_t>(packed >> (16 * k)));
}

inline Quat unpackTurn(const std::uint16_t* words, const TurnFormat& format) {
    std::uint64_t packed = words[0] | std::uint64_t{words[1]} << 16;
    if (format.words > 2) packed |= std::uint64_t{words[2]} << 32;
    const auto number = [&](unsigned k) {
        const auto steps = static_cast<int>(packed >> (2 + k * format.bits) & ((1u << format.bits) - 1));
        return static_cast<float>(steps - format.steps()) * (kLargest / static_cast<float>(format.steps()));
    };
    const float a = number(0), b = number(1), c = number(2);
    const float rest = std::sqrt(std::max(0.0f, 1 - a * a - b * b - c * c));
    switch (packed & 3u) {
        case 0:
            return {rest, a, b, c};
        case 1:
            return {a, rest, b, c};
        case 2:
            return {a, b, rest, c};
        default:
            return {a, b, c, rest};
    }
}

inline Vec3 unpackPlace(const std::uint16_t* packed, const Vec3& low, const Vec3& step) {
    return {low.x + step.x * static_cast<float>(packed[0]), low.y + step.y * static_cast<float>(packed[1]),
            low.z + step.z * static_cast<float>(packed[2])};
}
inline PackedPlace packPlace(const Vec3& place, const Vec3& low, const Vec3& step) {
    const auto steps = [](float value, float from, float size) {
        return static_cast<std::uint16_t>(size > 0 ? std::min(65535.0f, std::round((value - from) / size)) : 0.0f);
    };
    return {steps(place.x, low.x, step.x), steps(place.y, low.y, step.y), steps(place.z, low.z, step.z)};
}

inline Quat alongChord(const Quat& from, const Quat& to, float share) {
    const float cosine = from.x * to.x + from.y * to.y + from.z * to.z + from.w * to.w;
    const float a = 1 - share, b = cosine < 0 ? -share : share;
    return normalized(Quat{a * from.x + b * to.x, a * from.y + b * to.y, a * from.z + b * to.z, a * from.w + b * to.w});
}

}  // namespace ragtop
