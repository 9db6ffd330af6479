#include "narrowphase/sweep_ball.h"

#include <cmath>

#include "narrowphase/triangle_feature.h"

namespace ragtop {
namespace {

/// A ball of radius r about the origin goes along t d; obstacles are given from there.
struct BallPath {
    Vec3 d;
    float radius, travel2;  ///< of d, squared
};

constexpr float kNever = 2;  ///< as a share of the way, whose end is 1

/// When the ball is first as near as its radius to what is `from` it in the plane across a line, or in space, going
/// there by `way`; kNever where it does not come nearer. With b what is between them at the nearest, r² − b² is the
/// square of half a chord.
float timeAcross(const Vec3& from, const Vec3& way, float way2, float radius) {
    const float foot = dot(from, way) / way2;
    const float chord2 = radius * radius - lengthSquared(from - foot * way);
    if (!(foot > 0) || !(chord2 >= 0)) return kNever;
    const float t = foot - std::sqrt(chord2 / way2);
    return t > 0 ? t : 0;
}

/// When the ball meets an edge, and where on it; a corner only where its line is met beyond there, or near from the
/// beginning.
float timeAtEdge(const BallPath& path, const Vec3& a, const Vec3& b, Vec3& at) {
    constexpr float kAlong = 1e-12f;  // of a way, squared, across a line that it goes along
    const Vec3 edge = b - a;
    const float square = lengthSquared(edge);
    if (!(square > 0)) return kNever;
    const Vec3 way = path.d - (dot(path.d, edge) / square) * edge;
    const float way2 = lengthSquared(way);
    float along = dot(path.d, edge) < 0 ? 2.0f : -1.0f;
    if (way2 > kAlong * path.travel2) {
        const Vec3 from = a - (dot(a, edge) / square) * edge;
        const float t = timeAcross(from, way, way2, path.radius);
        if (t != kNever) {
            along = dot(t * path.d - a, edge) / square;
            at = a + along * edge;
            if (along >= 0 && along <= 1) return t;
        } else if (lengthSquared(from) > path.radius * path.radius) {
            return kNever;
        }
    }
    at = along < 0 ? a : b;
    return path.travel2 > 0 ? timeAcross(at, path.d, path.travel2, path.radius) : kNever;
}

}  // namespace

SweepHit sweepBall(const TriangleView& triangle, const Vec3& center, float radius, const Vec3& translation,
                   float closer) {
    SweepHit out;
    out.fraction = closer;
    const Vec3 v[3] = {triangle.a - center, triangle.b - center, triangle.c - center};
    const BallPath path{translation, radius, lengthSquared(translation)};
    const float height = -dot(triangle.normal, v[0]), sign = height < 0 ? -1.0f : 1.0f;
    const Vec3 facing = sign * triangle.normal;
    const float away = std::abs(height) - radius, falling = -dot(facing, translation);
    const auto take = [&](float t, const Vec3& at) {
        out.hit = true;
        out.fraction = t;
        out.point = center + at;
        out.normal = normalized(t * translation - at, facing);
    };
    Feature feature;
    if (away > 0) {
        // Nothing of a triangle is met before its plane.
        if (!(falling > 0) || away > closer * falling) return out;
        const float t = away / falling;
        const Vec3 met = t * translation - radius * facing,
                   nearest = nearestOnTriangle(v, triangle.normal, met, feature);
        if (feature.kind == Feature::face) {
            take(t, nearest);
            out.normal = facing;
            out.onFace = sign > 0;
            return out;
        }
    }
    for (int i = 0; i < 3; ++i) {
        Vec3 at;
        const float t = timeAtEdge(path, v[i], v[i == 2 ? 0 : i + 1], at);
        if (t <= out.fraction) take(t, at);
    }
    return out;
}

}  // namespace ragtop
