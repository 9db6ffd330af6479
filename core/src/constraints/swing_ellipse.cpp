#include "constraints/swing_ellipse.h"

#include <cmath>

#include "constraints/joint_geometry.h"
#include "constraints/joint_constants.h"

namespace ragtop {
namespace {

/// Where on the edge, as a unit vector.
struct Phase {
    float cos, sin;
};
Phase unit(float c, float s) {
    const float inverse = 1 / std::sqrt(c * c + s * s);
    return {inverse * c, inverse * s};
}

/// cos r and sin r/r by u = r² up to π²: series of r/4, doubled twice.
struct Turn {
    float cos, q;
};
Turn turnOf(float u) {
    const float x = 0.0625f * u;
    const float q4 = 1 - x * (1.0f / 6 - x * (1.0f / 120 - x * (1.0f / 5040)));
    const float c4 = 1 - x * (0.5f - x * (1.0f / 24 - x * (1.0f / 720 - x * (1.0f / 40320))));
    const float c2 = 1 - 2 * x * (q4 * q4);
    return {2 * c2 * c2 - 1, c4 * c2 * q4};
}

/// A place P of the edge and its derivatives by φ. With u = (y cos φ)² + (z sin φ)² and q = sin √u/√u,
///   P = (cos √u, q z sin φ, −q y cos φ),   d cos √u/du = −q/2,   q₁ = dq/du = (cos √u − q)/2u,
///   q₂ = dq₁/du = −(q/2 + 3 q₁)/2u.
struct EdgePlace {
    Vec3 place, first, second;
};
EdgePlace edgePlace(float y, float z, const Phase& phi) {
    const float sy = y * phi.cos, sz = z * phi.sin, dy = -y * phi.sin, dz = z * phi.cos;
    const float u = sy * sy + sz * sz, du = 2 * (sy * dy + sz * dz), ddu = 2 * (dy * dy + dz * dz - u);
    const float inverse = 0.5f / u;
    const Turn turn = turnOf(u);
    const float q = turn.q, q1 = inverse * (turn.cos - q), q2 = -inverse * (0.5f * q + 3 * q1);
    const float dq = q1 * du, ddq = q2 * du * du + q1 * ddu - q;
    return {{turn.cos, q * sz, -q * sy},
            {-0.5f * q * du, dq * sz + q * dz, -(dq * sy + q * dy)},
            {-0.5f * (dq * du + q * ddu), ddq * sz + 2 * dq * dz, -(ddq * sy + 2 * dq * dy)}};
}

/// The circle that touches the edge at a place and bends as it does there, round the axis n = P′ × P″, which is on the
/// inner side. From the place to where it is nearest to d it turns by α about n,
///   tan α = |n| (P × d) · n / (n² P · d − (n · P)(n · d)),
/// and the phase by α |P′|²/|n|. Until there the edge leaves it by half of (Δφ)³ |P′ · P″| |n|/|P′|³, where P′ · P″
/// grows by up to |y² − z²| Δφ on the way.
struct Osculating {
    Vec3 axis;
    float square, alongPlace, alongDirection, across, speed2, way;

    Osculating(const EdgePlace& edge, const Vec3& d)
        : axis(cross(edge.first, edge.second)),
          square(lengthSquared(axis)),
          alongPlace(dot(axis, edge.place)),
          alongDirection(dot(axis, d)),
          across(square * dot(edge.place, d) - alongPlace * alongDirection),
          speed2(lengthSquared(edge.first)),
          way(across > 0 ? speed2 * dot(axis, cross(edge.place, d)) / across : 0.0f) {}

    /// `uneven`: |y² − z²|
    bool isNear(const EdgePlace& edge, float uneven) const {
        constexpr float kEnough = 4e-5f;  // rad
        const float stretch = dot(edge.first, edge.second), most = way > 0 ? way * uneven : -way * uneven;
        const float cubed = ((stretch < 0 ? -stretch : stretch) + most) * (way * way * way);
        return across > 0 && cubed * cubed * square < (kEnough * kEnough) * (speed2 * speed2 * speed2);
    }
    /// β − γ, with β the angle from n to the edge and γ that to d; |n × P| = |P′|³.
    SwingMargin margin(const Vec3& d) const {
        const Vec3 turn = cross(axis, d);
        const float far = length(turn), near = speed2 * std::sqrt(speed2);
        return {jointAngle(near * alongDirection - alongPlace * far, alongPlace * alongDirection + near * far),
                -(1 / far) * turn};
    }
};

/// Without a circle: the margin of d at this place of the edge.
SwingMargin marginAt(const EdgePlace& edge, const Vec3& d) {
    const Vec3 tangent = normalized(edge.first, {}), inwards = cross(edge.place, tangent);
    return {jointAngle(dot(inwards, d), dot(edge.place, d)), -tangent};
}

/// Where the plane ellipse y, z is nearest to (v, w): (y v/(y² + t), z w/(z² + t)) with the t that makes it a unit
/// vector; two steps of Newton's method on its inverse length [Moré, Sorensen, Computing a Trust Region Step, 1983],
/// from below.
Phase nearestOnPlane(float y, float z, float v, float w) {
    constexpr int kSteps = 2;  // as said above
    const float y2 = y * y, z2 = z * z, yv = y * v, zw = z * w;
    float t = yv - y2 > zw - z2 ? yv - y2 : zw - z2;
    for (int i = 0;; ++i) {
        const float inverseY = 1 / (y2 + t), inverseZ = 1 / (z2 + t), c = inverseY * yv, s = inverseZ * zw;
        if (i == kSteps) return unit(c, s);
        const float cc = c * c, ss = s * s, square = cc + ss;
        t += square * (std::sqrt(square) - 1) / (inverseY * cc + inverseZ * ss);
    }
}

/// d in the quadrant of positive swings. The phase stays between those where d is ahead and where it is behind.
SwingMargin quadrantMargin(float y, float z, const Vec3& d, Phase phase) {
    constexpr int kEvaluations = 8;  // a bound, by trial
    const float uneven = y > z ? y * y - z * z : z * z - y * y;
    Phase low{1, 0}, high{0, 1};
    for (int i = 1;; ++i) {
        const EdgePlace edge = edgePlace(y, z, phase);
        const Osculating circle(edge, d);
        if (circle.isNear(edge, uneven)) return circle.margin(d);
        if (i == kEvaluations) return marginAt(edge, d);
        (dot(edge.first, d) > 0 ? low : high) = phase;
        phase = unit(phase.cos - circle.way * phase.sin, phase.sin + circle.way * phase.cos);
        const bool between = low.cos * phase.sin > low.sin * phase.cos && phase.cos * high.sin > phase.sin * high.cos;
        if (circle.way == 0 || !between) phase = unit(low.cos + high.cos, low.sin + high.sin);
    }
}

}  // namespace

SwingMargin ellipseMargin(float y, float z, const Vec3& direction) {
    // A swing exactly on a half axis, where the plane ellipse may be undecided, is taken a little beside it.
    constexpr float kBeside = 1e-4f;
    const float across = std::sqrt(direction.y * direction.y + direction.z * direction.z);
    const float angle = jointAngle(across, direction.x);
    const float flipY = direction.z > 0 ? -1.0f : 1.0f, flipZ = direction.y < 0 ? -1.0f : 1.0f;
    // Turning a component of the swing vector round mirrors z or y of the direction, and axes of turning once more.
    const Vec3 d{direction.x, flipZ * direction.y, flipY * direction.z};
    const bool defined = across > kNoDirection;
    const float v = defined ? angle * -d.z / across : angle, w = defined ? angle * d.y / across : angle;
    const float leastV = kBeside * y, leastW = kBeside * z;
    const Phase guess = nearestOnPlane(y, z, v > leastV ? v : leastV, w > leastW ? w : leastW);
    const SwingMargin side = quadrantMargin(y, z, d, guess);
    const float handed = flipY * flipZ;
    return {side.margin, handed * Vec3{side.axis.x, flipZ * side.axis.y, flipY * side.axis.z}};
}

}  // namespace ragtop
