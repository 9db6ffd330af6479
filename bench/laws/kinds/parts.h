#pragma once

#include <algorithm>
#include <cmath>

#include "../kinds.h"

/// Words that several kinds share.
namespace ragtop::laws {

using stability::add;
using stability::addBall;
using stability::addDistance;
using stability::addFloor;
using stability::addHinge;
using stability::addSlider;
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

constexpr double kBridgeHeight = 12;  ///< m, of the banks

struct Bridge {
    double span = 0, sag = 0;  ///< m
    float plank = 0;           ///< kg

    double height(double x) const { return kBridgeHeight - 4 * sag * std::max(0.0, 0.25 - x * x / (span * span)); }
};

/// Planks on balls or hinges, one or two a side, between two banks that one can drive on.
Bridge addBridge(Scene& scene, Dice& dice, const Material& wood);
/// Of twelve sides, about z: its corners are roots, which are the same on every platform.
Shape prism(float radius, float half);
/// On four wheels, driven or not. Returns its box.
int addCar(Scene& scene, Dice& dice, const DVec3& at, float mass, float speed, const Material& rubber);

}  // namespace ragtop::laws
