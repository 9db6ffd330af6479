#include "ragtop/math.h"

#include <limits>

#include "base/double_vectors.h"

// Everything here is evaluated in double with + - * / sqrt alone and rounded once, so that the results are the same
// bits on every platform and within little more than half a unit in the last place.
namespace ragtop {
namespace {

constexpr double kPiDouble = 3.14159265358979323846;  ///< π, rounded to double
/// π/2 in two parts: the first has 33 bits, so that its product with an integer below 2²⁰ is exact
/// [Cody, Waite, Software Manual for the Elementary Functions, 1980].
constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
constexpr double kHalfPiLow = 6.07710050650619224932e-11;  ///< the rest of π/2
constexpr double kLargestReduced = 1048576.0;              ///< 2²⁰, beyond which that product is rounded

/// Taylor polynomials on |x| ≤ π/4; the first omitted terms are below 7e-12 of the result.
double sinNearZero(double x) {
    const double s = x * x;
    return x + x * s * (-1.0 / 6 + s * (1.0 / 120 + s * (-1.0 / 5040 + s * (1.0 / 362880 + s * (-1.0 / 39916800)))));
}
double cosNearZero(double x) {
    const double s = x * x;
    return 1.0 + s * (-0.5 + s * (1.0 / 24 +
                                  s * (-1.0 / 720 + s * (1.0 / 40320 + s * (-1.0 / 3628800 + s * (1.0 / 479001600))))));
}

struct SinCosDouble {
    double sin, cos;
};

SinCosDouble sinCosDouble(double angle) {
    double x = angle < 0 ? -angle : angle;
    // Angles this large have lost their fraction of a turn; what matters is the same bits everywhere.
    while (x > kLargestReduced) {
        x = x - std::floor(x * (0.5 / kPiDouble)) * (2 * kPiDouble);
        x = x < 0 ? -x : x;
    }
    const double quarters = std::floor(x * (2 / kPiDouble) + 0.5);
    const double r = (x - quarters * kHalfPiHigh) - quarters * kHalfPiLow;
    double s = sinNearZero(r), c = cosNearZero(r);
    const int quadrant = static_cast<int>(quarters) & 3;
    if (quadrant & 1) {
        const double old = s;
        s = c;
        c = -old;
    }
    if (quadrant & 2) {
        s = -s;
        c = -c;
    }
    return {angle < 0 ? -s : s, c};
}

/// atan(k/8)
constexpr double kArcTanOfEighths[9] = {0.0,
                                        0.12435499454676143503,
                                        0.24497866312686415417,
                                        0.35877067027057222040,
                                        0.46364760900080611621,
                                        0.55859931534356243597,
                                        0.64350110879328438680,
                                        0.71882999962162450542,
                                        0.78539816339744830962};

/// For 0 ≤ y ≤ x, x > 0: atan(y/x) = atan(c) + atan((y − c x) / (x + c y)) with c the nearest eighth; the rest is at
/// most 1/16, and the first omitted term of its series below 2e-12 of the result.
double arcTanOfFraction(double y, double x) {
    const int eighth = static_cast<int>(8 * (y / x) + 0.5);
    const double c = 0.125 * eighth;
    const double u = (y - c * x) / (x + c * y);
    const double s = u * u;
    const double series = u + u * s * (-1.0 / 3 + s * (1.0 / 5 + s * (-1.0 / 7 + s * (1.0 / 9))));
    return kArcTanOfEighths[eighth] + series;
}

double arcTan2Double(double y, double x) {
    const double ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
    if (ax == 0 && ay == 0) return 0;
    double angle = ay <= ax ? arcTanOfFraction(ay, ax) : 0.5 * kPiDouble - arcTanOfFraction(ax, ay);
    if (x < 0) angle = kPiDouble - angle;
    return y < 0 ? -angle : angle;
}

Quat roundedUnit(double x, double y, double z, double w) {
    const double s = 1 / std::sqrt(x * x + y * y + z * z + w * w);
    return {static_cast<float>(s * x), static_cast<float>(s * y), static_cast<float>(s * z), static_cast<float>(s * w)};
}

}  // namespace

SinCos sinCos(float angle) {
    if (!std::isfinite(angle)) {
        constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
        return {kNan, kNan};
    }
    const SinCosDouble v = sinCosDouble(angle);
    return {static_cast<float>(v.sin), static_cast<float>(v.cos)};
}

float arcTan2(float y, float x) {
    if (!std::isfinite(y) || !std::isfinite(x)) return std::numeric_limits<float>::quiet_NaN();
    return static_cast<float>(arcTan2Double(y, x));
}

Quat rotationAbout(const Vec3& axis, float angle) {
    const DVec3 a(axis);
    const double l = std::sqrt(dot(a, a));
    if (!(l > 0) || !std::isfinite(angle)) return {};
    const SinCosDouble half = sinCosDouble(0.5 * angle);
    const double s = half.sin / l;
    return roundedUnit(s * a.x, s * a.y, s * a.z, half.cos);
}

/// With half angle θ/2: from × to = sin θ n and 1 + from · to = 2 cos²(θ/2), so (from × to, 1 + from · to) is
/// 2 cos(θ/2) times the quaternion.
Quat rotationBetween(const Vec3& from, const Vec3& to) {
    const DVec3 a = (1 / std::sqrt(dot(DVec3(from), DVec3(from)))) * DVec3(from);
    const DVec3 b = (1 / std::sqrt(dot(DVec3(to), DVec3(to)))) * DVec3(to);
    const double x = a.y * b.z - a.z * b.y, y = a.z * b.x - a.x * b.z, z = a.x * b.y - a.y * b.x;
    const double w = 1 + dot(a, b);
    constexpr double kHalfTurn = 1e-14;  // squared sine that single-precision unit vectors cannot tell from zero
    if (!(x * x + y * y + z * z + w * w > kHalfTurn)) {
        const Vec3 n = perpendicular(normalized(from));
        return {n.x, n.y, n.z, 0};
    }
    return roundedUnit(x, y, z, w);
}

/// From the largest of the four components [Shepperd, Quaternion from Rotation Matrix, 1978].
Quat rotationFromAxes(const Vec3& x, const Vec3& y, const Vec3& z) {
    const double m00 = x.x, m11 = y.y, m22 = z.z;
    const double d21 = static_cast<double>(y.z) - z.y, s21 = static_cast<double>(y.z) + z.y;
    const double d02 = static_cast<double>(z.x) - x.z, s02 = static_cast<double>(z.x) + x.z;
    const double d10 = static_cast<double>(x.y) - y.x, s10 = static_cast<double>(x.y) + y.x;
    const double trace = m00 + m11 + m22;
    if (trace > 0) return roundedUnit(d21, d02, d10, 1 + trace);
    if (m00 >= m11 && m00 >= m22) return roundedUnit(1 + m00 - m11 - m22, s10, s02, d21);
    if (m11 >= m22) return roundedUnit(s10, 1 + m11 - m00 - m22, s21, d02);
    return roundedUnit(s02, s21, 1 + m22 - m00 - m11, d10);
}

Vec3 rotationVector(const Quat& q) {
    const DVec3 v(q.x, q.y, q.z);
    const double sine = std::sqrt(dot(v, v));
    if (!(sine > 0)) return {};
    // q and −q are the same rotation; the one with w ≥ 0 turns by at most π.
    const double angle = 2 * arcTan2Double(sine, q.w < 0 ? -static_cast<double>(q.w) : static_cast<double>(q.w));
    return toVec3(((q.w < 0 ? -angle : angle) / sine) * v);
}

/// q(t) = (sin((1−t)θ) q₀ + sin(tθ) q₁) / sin θ [Shoemake, Animating Rotation with Quaternion Curves, 1985], θ from
/// tan(θ/2) = |q₁ − q₀| / |q₁ + q₀|.
Pose blend(const Pose& from, const Pose& to, double blend) {
    if (!(blend > 0)) return from;
    if (blend >= 1) return to;
    const Quat& p = from.rotation;
    const Quat& q = to.rotation;
    const double cosine = static_cast<double>(p.x) * q.x + static_cast<double>(p.y) * q.y +
                          static_cast<double>(p.z) * q.z + static_cast<double>(p.w) * q.w;
    const double sign = cosine < 0 ? -1 : 1;
    const double dx = sign * q.x - p.x, dy = sign * q.y - p.y, dz = sign * q.z - p.z, dw = sign * q.w - p.w;
    const double sx = sign * q.x + p.x, sy = sign * q.y + p.y, sz = sign * q.z + p.z, sw = sign * q.w + p.w;
    const double theta = 2 * arcTan2Double(std::sqrt(dx * dx + dy * dy + dz * dz + dw * dw),
                                           std::sqrt(sx * sx + sy * sy + sz * sz + sw * sw));
    double a = 1 - blend, b = blend;
    constexpr double kStraight = 1e-4;  // sin x / x differs from 1 by less than 2e-9 below this
    if (theta > kStraight) {
        a = sinCosDouble(a * theta).sin;
        b = sinCosDouble(b * theta).sin;
    }
    b *= sign;
    return {(1 - blend) * from.position + blend * to.position,
            roundedUnit(a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z, a * p.w + b * q.w)};
}

}  // namespace ragtop
