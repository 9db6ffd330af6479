#include "quick_angles.h"

#include <cmath>

#include "four_angles.h"
#include "ragtop/math.h"

namespace ragtop {
namespace {

constexpr float kHalfPi = 0.5f * kPi;
constexpr float kFarthest = 1e4f;  ///< beyond which a turn is not told from another one in single precision

/// For |x| ≤ 1 [Abramowitz, Stegun 1964, 4.4.49], of one number or of four.
template <class Real>
Real arcTanOfFraction(Real x) {
    const Real s = x * x;
    return x +
           x * s *
               (-0.3333314528f +
                s * (0.1999355085f +
                     s * (-0.1420889944f +
                          s * (0.1065626393f + s * (-0.0752896400f +
                                                    s * (0.0429096138f + s * (-0.0161657367f + s * 0.0028662257f)))))));
}

/// For |x| ≤ π/2 [4.3.97].
template <class Real>
Real sinOfQuarter(Real x) {
    const Real s = x * x;
    return x +
           x * s *
               (-0.1666666664f + s * (0.0083333315f + s * (-0.0001984090f + s * (0.0000027526f + s * -0.0000000239f))));
}

/// For |x| ≤ π/2 [4.3.99].
template <class Real>
Real cosOfQuarter(Real x) {
    const Real s = x * x;
    return 1 +
           s * (-0.4999999963f + s * (0.0416666418f + s * (-0.0013888397f + s * (0.0000247609f + s * -0.0000002605f))));
}

struct HalfTurns {
    float rest;  ///< of an angle, in [−π/2, π/2]
    float sign;  ///< of what sine and cosine are after so many half turns
};

constexpr float kPiHigh = 3.140625f, kPiLow = 9.67653589793e-4f;  ///< their sum is π; the first has 8 bits

HalfTurns halfTurnsOf(float x) {
    const int count = static_cast<int>(x * (1 / kPi) + (x < 0 ? -0.5f : 0.5f));
    const auto turns = static_cast<float>(count);
    return {(x - turns * kPiHigh) - turns * kPiLow, (count & 1) != 0 ? -1.0f : 1.0f};
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

FourFloats quickArcTan(FourFloats x) {
    const FourFloats size = x < 0.0f ? -x : x, half = x < 0.0f ? FourFloats{} - kHalfPi : FourFloats{} + kHalfPi;
    const FourInts within = size <= 1.0f;
    const FourFloats angle = arcTanOfFraction(within ? x : 1.0f / x);
    return within ? angle : half - angle;
}

FourFloats quickSinOrCos(FourFloats x, FourInts cosines) {
    const FourInts near = (x < 0.0f ? -x : x) <= kFarthest;
    if ((near[0] & near[1] & near[2] & near[3]) == 0) {
        FourFloats each{};
        for (int i = 0; i < 4; ++i) each[i] = cosines[i] != 0 ? quickCos(x[i]) : quickSin(x[i]);
        return each;
    }
    const FourFloats nearest = x * (1 / kPi) + (x < 0.0f ? FourFloats{} - 0.5f : FourFloats{} + 0.5f);
    const FourInts count = __builtin_convertvector(nearest, FourInts);
    const FourFloats turns = __builtin_convertvector(count, FourFloats);
    const FourFloats rest = (x - turns * kPiHigh) - turns * kPiLow;
    const FourFloats value = cosines != 0 ? cosOfQuarter(rest) : sinOfQuarter(rest);
    return (count & 1) != 0 ? -value : value;
}

}  // namespace ragtop
