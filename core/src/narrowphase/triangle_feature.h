#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// A part of a triangle.
struct Feature {
    enum Kind { face, edge, vertex } kind = face;
    int index = 0;  ///< of the edge (from that vertex to the next) or vertex
};

/// The point of the triangle with corners v and normal n that is nearest to a point, and the part on which it lies.
inline Vec3 nearestOnTriangle(const Vec3 (&v)[3], const Vec3& n, const Vec3& point, Feature& feature) {
    float least = 0;
    Vec3 best;
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
        const int j = i == 2 ? 0 : i + 1;
        const Vec3 e = v[j] - v[i], r = point - v[i];
        if (dot(cross(n, e), r) >= 0) continue;
        const float along = dot(r, e), ee = lengthSquared(e);
        const Vec3 near = along <= 0 ? v[i] : along >= ee ? v[j] : v[i] + (along / ee) * e;
        const float square = lengthSquared(point - near);
        if (!inside && square >= least) continue;
        inside = false;
        least = square;
        best = near;
        feature = along <= 0    ? Feature{Feature::vertex, i}
                  : along >= ee ? Feature{Feature::vertex, j}
                                : Feature{Feature::edge, i};
    }
    if (!inside) return best;
    feature = {};
    return point - dot(n, point - v[0]) * n;
}

}  // namespace ragtop
