#include "narrowphase/pairs.h"
#include "narrowphase/round_constants.h"

/// Spheres and capsules with each other and spheres with polyhedra, in closed form wherever there is one.
namespace ragtop::pairs {
namespace {

/// Cores at pointA and pointB with radii: one point half way between the skins.
void pointPair(const Vec3& pointA, float radiusA, const Vec3& pointB, float radiusB, const Vec3& fallback, float margin,
               std::uint32_t feature, Manifold& out) {
    const Vec3 way = pointB - pointA;
    const float distance = length(way);
    const float separation = distance - radiusA - radiusB;
    if (separation > margin) {
        out.gap = separation;
        return;
    }
    out.normal = distance > 0 ? (1.0f / distance) * way : fallback;
    out.pointCount = 1;
    out.points[0] = {pointA + (radiusA + 0.5f * separation) * out.normal, separation, feature};
}

Vec3 closestOnSegment(const Vec3& p, const Vec3& d, const Vec3& point, float& t) {
    const float dd = lengthSquared(d);
    t = dd > 0 ? dot(point - p, d) / dd : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return p + t * d;
}

}  // namespace

void closestPoint(const gjk::Closest& cores, float radiusA, float radiusB, float margin, std::uint32_t feature,
                  Manifold& out) {
    out.pointCount = 0;
    const float separation = cores.distance - radiusA - radiusB;
    if (cores.overlap) return;
    if (separation > margin) {
        out.gap = separation;
        return;
    }
    out.normal = cores.normal;
    out.pointCount = 1;
    out.points[0] = {0.5f * (cores.pointA + radiusA * cores.normal + cores.pointB - radiusB * cores.normal), separation,
                     feature};
}

void commonPoint(const Vec3& normal, float separation, const Vec3& position, Manifold& out) {
    out.normal = normal;
    out.pointCount = 1;
    out.points[0] = {position, separation, kPointFeature};
}

void flip(Manifold& manifold, const Frame& otherInThis) {
    const Frame toOther = inverse(otherInThis);
    manifold.normal = rotate(toOther.rotation, -manifold.normal);
    for (int i = 0; i < manifold.pointCount; ++i) {
        manifold.points[i].position = transformPoint(toOther, manifold.points[i].position);
    }
}

void spheres(float radiusA, float radiusB, const Vec3& centerB, float margin, Manifold& out) {
    pointPair({}, radiusA, centerB, radiusB, {0, 1, 0}, margin, kPointFeature, out);
}

void capsuleSphere(const ConvexView& a, float radiusB, const Vec3& centerB, float margin, Manifold& out) {
    float t = 0;
    const Vec3 low{0, -a.halfExtents.y, 0};
    const Vec3 near = closestOnSegment(low, -2.0f * low, centerB, t);
    pointPair(near, a.radius, centerB, radiusB, {1, 0, 0}, margin, kPointFeature, out);
}

/// Nearly parallel capsules touch along a line, given by two points, unless they cross within it.
void capsules(const ConvexView& a, const ConvexView& b, const Frame& bInA, float margin, Manifold& out) {
    const Vec3 p{0, -a.halfExtents.y, 0}, d = -2.0f * p;
    const Vec3 halfB = rotate(bInA.rotation, {0, b.halfExtents.y, 0});
    const Vec3 q = bInA.position - halfB, e = 2.0f * halfB;
    const ClosestOnSegments near = closestOnSegments(p, d, q, e);
    const Vec3 perpendicularToBoth = cross(d, e);
    const float dd = lengthSquared(d), ee = lengthSquared(e);
    Vec3 fallback = normalized(perpendicularToBoth, {1, 0, 0});
    if (!(lengthSquared(perpendicularToBoth) > kParallelSegments * dd * ee)) fallback = {1, 0, 0};
    pointPair(near.pointA, a.radius, near.pointB, b.radius, fallback, margin, kPointFeature, out);
    if (out.pointCount == 0 || !(lengthSquared(perpendicularToBoth) <= kNearlyParallel * dd * ee) || !(dd * ee > 0)) {
        return;
    }
    // The part of B beside A, between parameters of B.
    const float de = dot(d, e);
    float s = -dot(q - p, d) / de, t = (dd - dot(q - p, d)) / de;
    if (s > t) {
        const float swapped = s;
        s = t;
        t = swapped;
    }
    s = s < 0 ? 0 : s;
    t = t > 1 ? 1 : t;
    if (!(s < t)) return;
    ManifoldPoint points[2];
    float least = 0;
    for (int i = 0; i < 2; ++i) {
        const float parameter = i == 0 ? s : t;
        const Vec3 pointB = q + parameter * e;
        float ignored = 0;
        const Vec3 pointA = closestOnSegment(p, d, pointB, ignored);
        const float distance = length(pointB - pointA), separation = distance - a.radius - b.radius;
        least = i == 0 || separation < least ? separation : least;
        const Vec3 onA = pointA + a.radius * out.normal, onB = pointB - b.radius * out.normal;
        const bool ofB = parameter == 0 || parameter == 1;
        points[i] = {0.5f * (onA + onB), separation, edgeFeature(ofB ? 0 : 1, (i == 0) == (de > 0) ? 2 : 3)};
    }
    const float radius = a.radius < b.radius ? a.radius : b.radius;
    if (least - out.points[0].separation > kChoiceTolerance * radius) return;  // they cross between the two
    out.pointCount = 0;
    for (const ManifoldPoint& point : points) {
        if (point.separation <= margin) out.points[out.pointCount++] = point;
    }
}

void boxSphere(const Vec3& halfExtents, float radius, const Vec3& center, float margin, Manifold& out) {
    const Vec3 near = max(-halfExtents, min(halfExtents, center));
    if (!(near == center)) {
        pointPair(near, 0, center, radius, {0, 1, 0}, margin, kPointFeature, out);
        return;
    }
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
        if (halfExtents[i] - abs(center)[i] < halfExtents[axis] - abs(center)[axis]) axis = i;
    }
    const float sign = center[axis] < 0 ? -1.0f : 1.0f;
    out.normal = {};
    out.normal[axis] = sign;
    const float separation = abs(center)[axis] - halfExtents[axis] - radius;
    out.pointCount = 1;
    out.points[0] = {center - (radius + 0.5f * separation) * out.normal, separation, kPointFeature};
}

void hullSphere(const HullView& a, float radius, const Vec3& center, float margin, Manifold& out) {
    float most = 0;
    std::size_t face = 0;
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        const float height = dot(a.planes[i].normal, center) - a.planes[i].offset;
        if (height - radius > margin) {
            out.gap = height - radius;
            return;
        }
        if (i == 0 || height > most) {
            most = height;
            face = i;
        }
    }
    if (most > 0) {
        const gjk::PointsSupport supportA{a.vertices.data(), static_cast<int>(a.vertices.size())};
        const gjk::Closest cores = gjk::closest(supportA, gjk::PointsSupport{&center, 1}, a.center - center);
        if (!cores.overlap) {
            closestPoint(cores, 0, radius, margin, kPointFeature, out);
            return;
        }
    }
    out.normal = a.planes[face].normal;
    out.pointCount = 1;
    const float separation = most - radius;
    out.points[0] = {center - (radius + 0.5f * separation) * out.normal, separation, kPointFeature};
}

}  // namespace ragtop::pairs
