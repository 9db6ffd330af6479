#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// What the arc tangent of joints is made of; lanes do the same operations. The polynomial is for |t| ≤ tan(π/8)
/// [Moshier, Cephes mathematical library, 1992], the whole within 3e-7 rad and, near zero, 3e-7 of the angle.
namespace arc_tangent {
inline constexpr float kTanOfEighth = 0.41421356f;  ///< tan π/8
inline constexpr float kC9 = 8.05374449538e-2f, kC7 = -1.38776856032e-1f, kC5 = 1.99777106478e-1f,
                       kC3 = -3.33329491539e-1f;
}  // namespace arc_tangent

/// Four-quadrant arc tangent in (−π, π] in single precision, for angles that are known no better; 0 where both are.
inline float jointAngle(float y, float x) {
    const float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
    const float large = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
    const bool beyond = small > arc_tangent::kTanOfEighth * large;
    const float above = beyond ? small - large : small, below = beyond ? small + large : large;
    const float t = below > 0 ? above / below : 0.0f, s = t * t;
    const float series =
        (((arc_tangent::kC9 * s + arc_tangent::kC7) * s + arc_tangent::kC5) * s + arc_tangent::kC3) * s * t + t;
    float angle = beyond ? 0.25f * kPi + series : series;
    angle = ay > ax ? 0.5f * kPi - angle : angle;
    angle = x < 0 ? kPi - angle : angle;
    return y < 0 ? -angle : angle;
}

}  // namespace ragtop
