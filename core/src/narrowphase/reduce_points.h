#pragma once

#include <cstddef>
#include <span>

#include "narrowphase/manifold.h"
#include "ragtop/math.h"

/// Choosing the points that make a manifold: four that can exert nearly every wrench that all could. Over all
/// directions the mean width of those wrenches follows the length of the way round the points.
namespace ragtop {

/// Does p lie outside the triangle a b c in their plane?
inline bool isOutside(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
    const float u = dot(normal, cross(b - a, p - a)), v = dot(normal, cross(c - b, p - b));
    const float w = dot(normal, cross(a - c, p - c));
    return !((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0));
}

/// Of four points in a plane, does each lie outside the triangle of the others?
inline bool areConvex(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& normal) {
    return isOutside(a, b, c, d, normal) && isOutside(b, c, d, a, normal) && isOutside(c, d, a, b, normal) &&
           isOutside(d, a, b, c, normal);
}

/// Of the first points the four with the longest way round them, of which one is at most `deep`, go to the front, that
/// one first; the four that are there already stay where others gain little.
template <class Point>
void widen(Point* points, int count, const Vec3& normal, float deep) {
    constexpr int kMost = 12;               // two polygons of four corners cross in eight points at most
    constexpr float kWorth = 0.01f;         // gain for which the four in front go
    constexpr float kDifference = 0.0001f;  // between the ways of two choices that rounding does not make
    const int n = count < kMost ? count : kMost;
    float apart[kMost][kMost] = {};
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) apart[i][j] = apart[j][i] = length(points[i].position - points[j].position);
    // Of the ways that visit all four, the shortest goes round.
    const auto wayRound = [&](int a, int b, int c, int d) {
        const float ab = apart[a][b] + apart[c][d], ac = apart[a][c] + apart[b][d], ad = apart[a][d] + apart[b][c];
        const float diagonals = ab > ac ? (ab > ad ? ab : ad) : (ac > ad ? ac : ad);
        return ab + ac + ad - diagonals;
    };
    int chosen[4] = {0, 1, 2, 3};
    float most = (1 + kWorth) * wayRound(0, 1, 2, 3);
    for (int a = 0; a < n; ++a)
        for (int b = a + 1; b < n; ++b)
            for (int c = b + 1; c < n; ++c)
                for (int d = c + 1; d < n; ++d) {
                    const float way = wayRound(a, b, c, d);
                    if (!(way > most)) continue;
                    const int four[4] = {a, b, c, d};
                    int first = 0;
                    while (first < 4 && points[four[first]].separation > deep) ++first;
                    if (first == 4 || !areConvex(points[a].position, points[b].position, points[c].position,
                                                 points[d].position, normal))
                        continue;
                    most = (1 + kDifference) * way;
                    for (int k = 0; k < 4; ++k) chosen[k] = four[k];
                    chosen[0] = four[first];
                    chosen[first] = a;
                }
    Point kept[4] = {points[chosen[0]], points[chosen[1]], points[chosen[2]], points[chosen[3]]};
    for (int k = 0; k < 4; ++k) points[k] = kept[k];
}

/// Copies at most four points to the front, over others, and returns how many: of the nearly deepest the one farthest
/// along a fixed direction, the one farthest from it, and the corners of the largest triangles on either side of the
/// two, or of the first such triangle, unless they all but lie within; then widened. Ties go to the earlier point.
/// `tolerance` is the difference in depth (m) that does not matter. At least one point.
template <class Point>
int reducePoints(Point* points, int count, const Vec3& normal, float tolerance) {
    if (count == 1) return 1;
    float deepest = points[0].separation;
    for (int i = 1; i < count; ++i) deepest = points[i].separation < deepest ? points[i].separation : deepest;

    const Vec3 direction = perpendicular(normal);
    int best = -1;
    float most = 0;
    for (int i = 0; i < count; ++i) {
        if (points[i].separation > deepest + tolerance) continue;
        const float score = dot(points[i].position, direction);
        if (best < 0 || score > most) {
            best = i;
            most = score;
        }
    }
    const auto take = [&](int slot, int chosen) {
        const Point point = points[slot];
        points[slot] = points[chosen];
        points[chosen] = point;
    };
    take(0, best);

    const auto pick = [&](int slot, float least, auto&& scoreOf) {
        int chosen = -1;
        float high = least;
        for (int i = slot; i < count; ++i) {
            const float score = scoreOf(points[i].position);
            if (score > high) {
                chosen = i;
                high = score;
            }
        }
        if (chosen < 0) return false;
        take(slot, chosen);
        return true;
    };
    const Vec3 first = points[0].position;
    if (!pick(1, 0, [&](const Vec3& p) { return lengthSquared(p - first); })) return 1;
    const Vec3 second = points[1].position, side = cross(normal, second - first);
    constexpr float kInLine = 0.01f;  // of the span
    const float least = kInLine * lengthSquared(second - first);
    int kept = 2;
    if (pick(kept, least, [&](const Vec3& p) { return dot(side, p - first); })) ++kept;
    const bool left = kept == 3;
    if (pick(kept, least, [&](const Vec3& p) { return -dot(side, p - first); })) ++kept;
    if (kept == 3) {
        const Vec3 third = points[2].position, outward = left ? -normal : normal;
        const Vec3 beyondSecond = cross(outward, third - second), beyondThird = cross(outward, first - third);
        const auto beyond = [&](const Vec3& p) {
            const float s = dot(beyondSecond, p - second), t = dot(beyondThird, p - third);
            return s > t ? s : t;
        };
        if (pick(kept, least, beyond)) ++kept;
    }
    if (kept == 4 && count > 4) widen(points, count, normal, deepest + tolerance);
    return kept;
}

/// Clusters of contacts of one direction each as manifolds of the points that reach most, moved by `offset`; as many as
/// there is room for. Returns how many.
template <class Cluster>
int writeClusters(Cluster* clusters, int count, float tolerance, const Vec3& offset, std::span<Manifold> out) {
    int written = 0;
    for (int i = 0; i < count && written < static_cast<int>(out.size()); ++i) {
        Cluster& cluster = clusters[i];
        Manifold& manifold = out[static_cast<std::size_t>(written++)];
        manifold.normal = cluster.normal;
        manifold.triangle = cluster.triangle;
        manifold.pointCount = reducePoints(cluster.points, cluster.count, cluster.normal, tolerance);
        for (int k = 0; k < manifold.pointCount; ++k) {
            manifold.points[k] = cluster.points[k];
            manifold.points[k].position += offset;
        }
    }
    return written;
}

}  // namespace ragtop
