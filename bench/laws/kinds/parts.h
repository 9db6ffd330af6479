#pragma once

#include <cmath>

#include "../kinds.h"

/// Words that several kinds share.
namespace ragtop::laws {

using stability::add;
using stability::addBall;
using stability::addFloor;
using stability::addHinge;
using stability::fixedBody;
using stability::jointFrames;
using stability::kWorld;
using stability::solidBody;
using stability::surface;

inline bool coin(Dice& dice) { return dice.below(2) == 0; }

template <class T>
const T& oneOf(Dice& dice, std::initializer_list<T> list) {
    return list.begin()[dice.below(static_cast<std::uint32_t>(list.size()))];
}

/// Evenly among orders of magnitude.
inline float magnitude(Dice& dice, float from, float to) {
    // A product of roots, which are exact to rounding on every platform.
    float value = from, ratio = to / from;
    for (int bit = 0; bit < 6; ++bit) {
        ratio = std::sqrt(ratio);
        if (coin(dice)) value *= ratio;
    }
    return value;
}

inline Vec3 anyDirection(Dice& dice) {
    for (;;) {
        const Vec3 v{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
        const float square = dot(v, v);
        if (square > 0.05f && square <= 1) return (1 / std::sqrt(square)) * v;
    }
}

inline BodyDef solidOfDensity(Shape shape, const DVec3& position, float density, const Material& material) {
    BodyDef def;
    def.shapes.push_back({.geometry = std::move(shape), .density = density, .material = material});
    def.pose.position = position;
    return def;
}

}  // namespace ragtop::laws
