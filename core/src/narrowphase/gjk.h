#pragma once

#include "ragtop/math.h"
#include "shapes/geometry.h"

/// Closest points of two convex sets given by support functions.
namespace ragtop::gjk {

/// Corners of the difference A − B and the weights that give its point nearest to the origin.
struct Simplex {
    Vec3 a[4], b[4], w[4];
    float weight[4] = {};
    int count = 0;
};

struct Closest {
    Vec3 pointA, pointB;   ///< one point of both where they overlap
    Vec3 normal{0, 1, 0};  ///< unit, from A to B; {0,1,0} when the sets overlap
    float distance = 0;
    bool overlap = false;
};

/// Drops the corners that do not carry the point of the simplex nearest to the origin and returns that point; four
/// corners remain only when the origin lies inside.
Vec3 reduce(Simplex& simplex);
/// What the last simplex says; `overlap` when the nearest point `v` is the origin up to rounding at size² `scale2`.
Closest finish(const Simplex& simplex, const Vec3& v, float scale2, bool inside);

struct PointsSupport {
    const Vec3* points;
    int count;
    Vec3 operator()(const Vec3& direction) const {
        int best = 0;
        float most = dot(points[0], direction);
        for (int i = 1; i < count; ++i) {
            const float s = dot(points[i], direction);
            if (s > most) {
                most = s;
                best = i;
            }
        }
        return points[best];
    }
};

struct CoreSupport {
    const ConvexView* shape;
    Vec3 operator()(const Vec3& direction) const { return supportOfCore(*shape, direction); }
};

struct PlacedCoreSupport {
    const ConvexView* shape;
    Mat3 rotation;
    Vec3 position;
    PlacedCoreSupport(const ConvexView& view, const Frame& frame)
        : shape(&view), rotation(toMat3(frame.rotation)), position(frame.position) {}
    Vec3 operator()(const Vec3& direction) const {
        return position + rotation * supportOfCore(*shape, transposeTimes(rotation, direction));
    }
};

/// [Gilbert, Johnson, Keerthi, 1988]; ends when the supporting plane v·x = v·w leaves no more than rounding to gain,
/// when a corner returns, or when rounding stops the descent. `start` is any guess of a vector from B to A.
template <class SupportA, class SupportB>
Closest closest(const SupportA& supportA, const SupportB& supportB, const Vec3& start) {
    constexpr int kMaxIterations = 48;  // a bound, by trial
    constexpr float kRelativeGap = 1e-6f;  // of |v|²: eight roundings of a float
    constexpr float kRounding = 2e-7f;  // 1.7 roundings of a float, of what corners are sums of
    Simplex simplex;
    Vec3 v = lengthSquared(start) > 0 ? start : Vec3{1, 0, 0};
    float vv = 0, scale2 = 0;
    bool apart = false;  // some plane across v has had A and B on its two sides
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        const Vec3 a = supportA(-v), b = supportB(v), w = a - b;
        const float aa = lengthSquared(a), bb = lengthSquared(b);
        scale2 = aa > scale2 ? aa : scale2;
        scale2 = bb > scale2 ? bb : scale2;
        if (simplex.count > 0) {
            apart = apart || dot(v, w) > 0;
            if (vv - dot(v, w) <= kRelativeGap * vv + kRounding * std::sqrt(scale2 * vv)) break;
            bool known = false;
            for (int i = 0; i < simplex.count; ++i) known = known || simplex.w[i] == w;
            if (known) break;
        }
        const Simplex before = simplex;
        simplex.a[simplex.count] = a;
        simplex.b[simplex.count] = b;
        simplex.w[simplex.count] = w;
        ++simplex.count;
        const Vec3 next = reduce(simplex);
        if (simplex.count == 4) return finish(simplex, next, scale2, true);
        const float nextSquared = lengthSquared(next);
        // Near its minimum v² changes by less than its rounding while the direction of v still improves.
        if (before.count > 0 && nextSquared > vv + kRelativeGap * vv) {
            simplex = before;
            break;
        }
        v = next;
        vv = nextSquared;
        if (vv <= 4 * kRounding * kRounding * scale2) break;
    }
    // Stuck so near to the origin, without proof that it is outside: v is noise, and they overlap.
    constexpr float kUnproven = 1e-5f;
    return finish(simplex, v, scale2, !apart && vv <= kUnproven * kUnproven * scale2);
}

}  // namespace ragtop::gjk
