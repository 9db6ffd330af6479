#pragma once

#include <cmath>
#include <type_traits>

#include "base/numbers.h"
#include "constraints/joint_constants.h"

/// Angles, axes and errors of two joint frames, over a number T (base/numbers.h).
namespace ragtop {

/// The number of a vector or rotation.
template <class V>
using NumberIn = std::remove_cvref_t<decltype(V::x)>;

/// Four-quadrant arc tangent in (−π, π] in single precision, for angles that are known no better; 0 where both are. The
/// polynomial is for |t| ≤ tan(π/8) [Moshier, Cephes mathematical library, 1992], the whole within 3e-7 rad and, near
/// zero, 3e-7 of the angle.
template <class T>
RAGTOP_INLINE T jointAngle(const T& y, const T& x) {
    constexpr float kTanOfEighth = 0.41421356f;  // tan π/8
    const T zero(0.0f), ax = select(x < zero, -x, x), ay = select(y < zero, -y, y);
    const auto isFlat = ax > ay;
    const T large = select(isFlat, ax, ay), small = select(isFlat, ay, ax);
    const auto beyond = small > kTanOfEighth * large;
    const T t = divideOrZero(select(beyond, small - large, small), select(beyond, small + large, large)), s = t * t;
    const T c9(8.05374449538e-2f), c7(-1.38776856032e-1f), c5(1.99777106478e-1f), c3(-3.33329491539e-1f);
    const T series = (((c9 * s + c7) * s + c5) * s + c3) * s * t + t;
    T angle = select(beyond, 0.25f * kPi + series, series);
    angle = select(ay > ax, 0.5f * kPi - angle, angle);
    angle = select(x < zero, kPi - angle, angle);
    return select(y < zero, -angle, angle);
}

/// The angle about x of a rotation, (−π, π].
template <class Q>
RAGTOP_INLINE NumberIn<Q> angleAboutX(const Q& q) {
    using T = NumberIn<Q>;
    const auto far = q.w < 0.0f;
    const T angle = 2 * jointAngle(select(far, -q.x, q.x), select(far, -q.w, q.w));
    return select(angle > -kPi, angle, T(kPi));
}
/// The angle plus or minus a turn so that it lies within half a turn of `center`; |angle − center| < 3π.
template <class T>
RAGTOP_INLINE T wrapAbout(const T& angle, const T& center) {
    const T off = angle - center, turn(2 * kPi);
    return select(off > kPi, angle - turn, select(off <= T(-kPi), angle + turn, angle));
}

/// The axes of a frame.
template <class Q>
constexpr RAGTOP_INLINE VectorOf<NumberIn<Q>> axisX(const Q& q) {
    const auto y = 2 * q.y, z = 2 * q.z;
    return {1 - (q.y * y + q.z * z), q.x * y + q.w * z, q.x * z - q.w * y};
}
template <class Q>
constexpr RAGTOP_INLINE VectorOf<NumberIn<Q>> axisY(const Q& q) {
    const auto x = 2 * q.x, z = 2 * q.z;
    return {q.y * x - q.w * z, 1 - (q.x * x + q.z * z), q.y * z + q.w * x};
}

/// The rotation vector of q, at most half a turn long.
template <class Q>
RAGTOP_INLINE VectorOf<NumberIn<Q>> turnVector(const Q& q) {
    using std::sqrt;
    using T = NumberIn<Q>;
    const T sine = sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
    const auto far = q.w < 0.0f;
    const T angle = jointAngle(sine, select(far, -q.w, q.w)), half = select(far, -angle, angle);
    return select(sine > 0.0f, (2 * half / sine) * VectorOf<T>{q.x, q.y, q.z}, VectorOf<T>{});
}
/// Twice the vector part of the rotation from a to b, which is its rotation vector while small and grows with the
/// angle up to a half turn.
template <class Q>
RAGTOP_INLINE VectorOf<NumberIn<Q>> rotationError(const Q& a, const Q& b) {
    using T = NumberIn<Q>;
    const Q q = b * conjugate(a);
    const T s = select(q.w < 0.0f, T(-2.0f), T(2.0f));
    return {s * q.x, s * q.y, s * q.z};
}
/// The same for the two x axes alone, and perpendicular to both:  2 sin(θ/2) along xA × xB, where
/// |xA × xB| = 2 sin(θ/2) cos(θ/2) and 1 + xA · xB = 2 cos²(θ/2).
template <class V>
RAGTOP_INLINE V axisError(const V& xA, const V& xB) {
    using std::sqrt;
    using T = NumberIn<V>;
    const V axis = cross(xA, xB);
    const T onePlusCos = 1 + dot(xA, xB);
    const auto regular = onePlusCos > kOpposite;
    const V error = sqrt(2 / onePlusCos) * axis;
    if (!any(!regular)) return error;
    return select(regular, error, T(2.0f) * normalized(axis, perpendicular(xB)));
}

/// A twist about the axis half way between both x axes, and the cosine of half the swing:
///   q = swing · twist ∝ (…, x, w) gives tan(twist/2) = x/w,  cos(swing/2) = √(x² + w²),
/// regular everywhere but at a half turn of swing, where x = w = 0 and no twist is defined. Its rate is
/// ω · (xA + xB)/(1 + xA · xB) = (ω · u)/cos(swing/2) with the unit vector u below. Rows are scaled by that cosine,
/// margin and rate alike, so that u stays a unit vector and the row fades where the twist loses its meaning.
template <class T>
struct TwistOf {
    T angle{}, cosHalfSwing{};
    VectorOf<T> axis;
};
template <class V>
RAGTOP_INLINE V twistAxis(const V& xA, const V& xB) {
    return normalized(xA + xB, V{});
}
template <class Q>
RAGTOP_INLINE TwistOf<NumberIn<Q>> twistBetween(const Q& a, const Q& b) {
    using std::sqrt;
    using T = NumberIn<Q>;
    const Q q = conjugate(a) * b;
    const T c = sqrt(q.x * q.x + q.w * q.w);
    return {angleAboutX(q), c, select(c > kNoTwist, twistAxis(axisX(a), axisX(b)), VectorOf<T>{})};
}

/// Signed angle to the nearest place of the edge, and the unit axis about which d turns inwards.
template <class T>
struct SwingMarginOf {
    T margin{};        ///< rad, negative outside
    VectorOf<T> axis;  ///< in the frame of d; zero where none is defined
};
/// Of a circle with the half angle `limit` about x. Half a turn away, any axis leads back.
template <class V>
RAGTOP_INLINE SwingMarginOf<NumberIn<V>> circleMargin(const NumberIn<V>& limit, const V& d) {
    using std::sqrt;
    using T = NumberIn<V>;
    const T zero(0.0f), across = sqrt(d.y * d.y + d.z * d.z);
    const V half{zero, zero, select(d.x < zero, T(-1.0f), zero)};
    return {limit - jointAngle(across, d.x), select(across > kNoDirection, V{zero, d.z / across, -d.y / across}, half)};
}

}  // namespace ragtop
