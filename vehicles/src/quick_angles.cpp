#include "quick_angles.h"

#include <cmath>

#include "ragtop/math.h"

namespace ragtop {
namespace {

constexpr float kHalfPi = 0.5f * kPi;
constexpr float kFarthest = 1e4f;  ///< beyond which a turn is not told from another one in single precision

/// For |x| ≤ 1 [Abramowitz, Stegun 1964, 4.4.49].
float arcTanOfFraction(float x) {
    const float s = x * x;
    return x +
           x * s *
               (-0.3333314528f +
                s * (0.1999355085f +
                     s * (-0.1420889944f +
                          s * (0.1065626393f + s * (-0.0752896400f +
                                                    s * (0.0429096138f + s * (-0.0161657367f + s * 0.0028662257f)))))));
}

/// For |x| ≤ π/2 [4.3.97].
float sinOfQuarter(float x) {
    const float s = x * x;
    return x +
           x * s *
               (-0.1666666664f + s * (0.0083333315f + s * (-0.0001984090f + s * (0.0000027526f + s * -0.0000000239f))));
}

/// For |x| ≤ π/2 [4.3.99].
float cosOfQuarter(float x) {
    const float s = x * x;
    return 1 +
           s * (-0.4999999963f + s * (0.0416666418f + s * (-0.0013888397f + s * (0.0000247609f + s * -0.0000002605f))));
}

struct HalfTurns {
    float rest;  ///< of an angle, in [−π/2, π/2]
    float sign;  ///< of what sine and cosine are after so many half turns
};

HalfTurns halfTurnsOf(float x) {
    constexpr float kHigh = 3.140625f, kLow = 9.67653589793e-4f;  // π; the first has 8 bits
    const int count = static_cast<int>(x * (1 / kPi) + (x < 0 ? -0.5f : 0.5f));
    const auto turns = static_cast<float>(count);
    return {(x - turns * kHigh) - turns * kLow, (count & 1) != 0 ? -1.0f : 1.0f};
}

}  // namespace

float quickArcTan(float x) {
    if (std::abs(x) <= 1) return arcTanOfFraction(x);
    return (x < 0 ? -kHalfPi : kHalfPi) - arcTanOfFraction(1 / x);
}

float quickArcSin(float sine, float cosine) {
    if (std::abs(sine) <= cosine) return arcTanOfFraction(sine / cosine);
    return (sine < 0 ? -kHalfPi : kHalfPi) - arcTanOfFraction(cosine / sine);
}

float quickSin(float x) {
    if (!(std::abs(x) <= kFarthest)) return sinCos(x).sin;
    const HalfTurns turn = halfTurnsOf(x);
    return turn.sign * sinOfQuarter(turn.rest);
}

float quickCos(float x) {
    if (!(std::abs(x) <= kFarthest)) return sinCos(x).cos;
    const HalfTurns turn = halfTurnsOf(x);
    return turn.sign * cosOfQuarter(turn.rest);
}

}  // namespace ragtop
