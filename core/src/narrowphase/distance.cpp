#include "narrowphase/distance.h"

#include "narrowphase/gjk.h"

namespace ragtop {
namespace gjk {
namespace {

/// A face of the simplex: corners, weights and its point nearest to the origin.
struct Part {
    int corner[3] = {};
    float weight[3] = {};
    int count = 0;
    Vec3 point;
    float squared = 0;
};

Part cornerPart(const Simplex& s, int i) {
    Part part;
    part.corner[0] = i;
    part.weight[0] = 1;
    part.count = 1;
    part.point = s.w[i];
    part.squared = lengthSquared(part.point);
    return part;
}

Part edgePart(const Simplex& s, int i, int j) {
    const Vec3 edge = s.w[j] - s.w[i];
    const float along = -dot(s.w[i], edge);
    const float ee = lengthSquared(edge);
    if (along <= 0) return cornerPart(s, i);
    if (along >= ee) return cornerPart(s, j);
    Part part;
    const float t = along / ee;
    part.corner[0] = i;
    part.corner[1] = j;
    part.weight[0] = 1 - t;
    part.weight[1] = t;
    part.count = 2;
    part.point = s.w[i] + t * edge;
    part.squared = lengthSquared(part.point);
    return part;
}

const Part& nearer(const Part& a, const Part& b) { return b.squared < a.squared ? b : a; }

/// The origin lies over the triangle when all three barycentric coordinates n · (wᵢ × wⱼ) / n² are positive; otherwise
/// the nearest point is on one of its edges [Ericson 2005, ch. 5.1.5].
Part trianglePart(const Simplex& s, int i, int j, int k) {
    const Vec3 a = s.w[i], b = s.w[j], c = s.w[k];
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 n = cross(ab, ac);
    const float nn = lengthSquared(n);
    constexpr float kFlat = 1e-12f;  // sine² below which rounding decides the direction of n
    constexpr float kThin = 1e-3f;   // sine² above which the three signs can be trusted
    const float flatness = nn / (lengthSquared(ab) * lengthSquared(ac));
    Part part;
    if (flatness > kFlat) {
        const float u = dot(n, cross(b, c)), v = dot(n, cross(c, a)), w = dot(n, cross(a, b));
        if (u > 0 && v > 0 && w > 0) {
            const float sum = u + v + w;
            part.corner[0] = i;
            part.corner[1] = j;
            part.corner[2] = k;
            part.weight[0] = u / sum;
            part.weight[1] = v / sum;
            part.weight[2] = w / sum;
            part.count = 3;
            // Near contact the direction of the point is that of n, which the weighted sum would lose.
            const bool thick = flatness > kThin;
            part.point = thick ? (dot(n, a) / nn) * n : a + part.weight[1] * ab + part.weight[2] * ac;
            part.squared = lengthSquared(part.point);
            if (thick) return part;
        }
    }
    const Part edge = nearer(nearer(edgePart(s, i, j), edgePart(s, j, k)), edgePart(s, k, i));
    return part.count == 0 ? edge : nearer(edge, part);
}

/// The part of a tetrahedron nearest to the origin; count 0 when the origin is inside, with these `weights` then: its
/// height above each face by that of the fourth corner.
Part tetrahedronPart(const Simplex& s, float weights[4]) {
    static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    Part best;
    for (const auto& face : kFaces) {
        const Vec3 a = s.w[face[0]];
        const Vec3 ab = s.w[face[1]] - a, ac = s.w[face[2]] - a, ad = s.w[face[3]] - a;
        const Vec3 n = cross(ab, ac);
        const float fourth = dot(n, ad), origin = -dot(n, a);
        constexpr float kFlat = 1e-12f;  // (volume / product of edges)²: no side is the inner one
        const bool flat = fourth * fourth <= kFlat * lengthSquared(n) * lengthSquared(ad);
        weights[face[3]] = origin / fourth;
        if (!flat && fourth * origin > 0) continue;
        const Part part = trianglePart(s, face[0], face[1], face[2]);
        if (best.count == 0 || part.squared < best.squared) best = part;
    }
    return best;
}

}  // namespace

Vec3 reduce(Simplex& simplex) {
    Part part;
    switch (simplex.count) {
        case 1:
            part = cornerPart(simplex, 0);
            break;
        case 2:
            part = edgePart(simplex, 0, 1);
            break;
        case 3:
            part = trianglePart(simplex, 0, 1, 2);
            break;
        default:
            part = tetrahedronPart(simplex, simplex.weight);
            break;
    }
    if (part.count == 0) return {};
    const Simplex all = simplex;
    simplex.count = part.count;
    for (int i = 0; i < part.count; ++i) {
        simplex.a[i] = all.a[part.corner[i]];
        simplex.b[i] = all.b[part.corner[i]];
        simplex.w[i] = all.w[part.corner[i]];
        simplex.weight[i] = part.weight[i];
    }
    return part.point;
}

Closest finish(const Simplex& simplex, const Vec3& v, float scale2, bool inside) {
    Closest out;
    for (int i = 0; i < simplex.count; ++i) {
        out.pointA += simplex.weight[i] * simplex.a[i];
        out.pointB += simplex.weight[i] * simplex.b[i];
    }
    constexpr float kOverlap = 1.6e-13f;  // (two roundings)²
    const float vv = lengthSquared(v);
    if (inside || vv <= kOverlap * scale2) {
        out.overlap = true;
        return out;
    }
    out.distance = std::sqrt(vv);
    out.normal = (-1.0f / out.distance) * v;
    if (simplex.count == 3) {
        // Near contact the triangle's own normal is known better than the short vector v.
        const Vec3 ab = simplex.w[1] - simplex.w[0], ac = simplex.w[2] - simplex.w[0], bc = ac - ab;
        const Vec3 n = cross(ab, ac);
        const float nn = lengthSquared(n);
        float longest = lengthSquared(ab);
        longest = lengthSquared(ac) > longest ? lengthSquared(ac) : longest;
        longest = lengthSquared(bc) > longest ? lengthSquared(bc) : longest;
        if (nn > longest * vv) out.normal = (dot(n, v) > 0 ? -1.0f : 1.0f) / std::sqrt(nn) * n;
    }
    return out;
}

}  // namespace gjk

namespace {

Distance withRadii(const gjk::Closest& cores, float radiusA, float radiusB) {
    Distance out;
    out.coresOverlap = cores.overlap;
    out.normal = cores.normal;
    out.distance = cores.distance - radiusA - radiusB;
    out.pointA = cores.pointA + radiusA * cores.normal;
    out.pointB = cores.pointB - radiusB * cores.normal;
    return out;
}

}  // namespace

Distance distance(const ConvexView& a, const ConvexView& b, const Frame& bInA) {
    const gjk::Closest cores = gjk::closest(gjk::CoreSupport{&a}, gjk::PlacedCoreSupport(b, bInA), -bInA.position);
    return withRadii(cores, a.radius, b.radius);
}

/// The triangle may lie far from the origin of its mesh, so the work is done about B's position.
Distance distance(const TriangleView& a, const ConvexView& b, const Frame& bInA) {
    const Vec3 corners[3] = {a.a - bInA.position, a.b - bInA.position, a.c - bInA.position};
    const gjk::Closest cores =
        gjk::closest(gjk::PointsSupport{corners, 3}, gjk::PlacedCoreSupport(b, {{}, bInA.rotation}), corners[0]);
    Distance out = withRadii(cores, 0, b.radius);
    out.pointA += bInA.position;
    out.pointB += bInA.position;
    return out;
}

}  // namespace ragtop
