#include "narrowphase/pairs.h"

/// A capsule and a polyhedron: the closest points of segment and polyhedron while the segment is outside, at once where
/// an end is over a face, separating axes when it cuts through.
namespace ragtop::pairs {
int segmentOnFace(const HullView& a, int face, const Rod& rod, ManifoldPoint* out) {
    const Plane& plane = a.planes[static_cast<std::size_t>(face)];
    const Vec3 d = rod.q - rod.p;
    const float overhang = kOverhang * rod.size;
    float enter = 0, leave = 1;
    int enterCode = 0, leaveCode = 1;
    const auto sides = a.loop(static_cast<std::size_t>(face));
    Vec3 from = a.vertices[sides.back()];
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const Vec3 to = a.vertices[sides[i]];
        const Vec3 outward = normalized(cross(to - from, plane.normal));
        const float heightP = dot(outward, rod.p - from), heightQ = dot(outward, rod.q - from);
        from = to;
        if (heightP > overhang && heightQ > overhang) return 0;
        if (heightP <= overhang && heightQ <= overhang) continue;
        const float t = heightP / (heightP - heightQ);
        const int code = 128 + static_cast<int>(i);
        if (heightP > heightQ && t > enter) {
            enter = t;
            enterCode = code;
        } else if (heightP <= heightQ && t < leave) {
            leave = t;
            leaveCode = code;
        }
    }
    if (enter > leave) return 0;
    int count = 0;
    for (int i = 0; i < 2; ++i) {
        const Vec3 point = rod.p + (i == 0 ? enter : leave) * d;
        const float separation = dot(plane.normal, point) - plane.offset - rod.radius;
        if (separation > rod.margin) continue;
        const ClipPoint clip{point, separation, static_cast<std::uint8_t>(i == 0 ? enterCode : leaveCode),
                             static_cast<std::uint8_t>(i)};
        out[count++] = {point - (rod.radius + 0.5f * separation) * plane.normal, separation,
                        faceFeature(clip, face, 0, false)};
    }
    return count;
}

namespace {

/// Two points along an edge of the polyhedron that lies nearly parallel under the segment; 0 when there is none. Where
/// an edge is a little beside the core, x, the skin over it is lower by x²/2r; where that counts it is not under the
/// segment.
int segmentOnEdge(const HullView& a, const Vec3& normal, const Rod& rod, ManifoldPoint* out) {
    constexpr float kNearlyParallel = 0.01f;  // sin²
    const Vec3 d = rod.q - rod.p;
    const float dd = lengthSquared(d), tolerance = kChoiceTolerance * rod.size, beside = 2 * rod.radius * tolerance;
    float highest = dot(a.vertices[0], normal);
    for (const Vec3& vertex : a.vertices) {
        const float height = dot(vertex, normal);
        highest = height > highest ? height : highest;
    }
    for (std::size_t i = 0; i < a.edges.size(); ++i) {
        const Vec3 from = a.vertices[a.edges[i].from], e = a.vertices[a.edges[i].to] - from;
        if (dot(from, normal) < highest - tolerance || dot(from + e, normal) < highest - tolerance) continue;
        const float de = dot(d, e), ee = lengthSquared(e);
        if (!(de * de > (1 - kNearlyParallel) * dd * ee)) continue;
        float s = dot(from - rod.p, e) / de, t = s + ee / de;
        const float low = s < t ? s : t, high = s < t ? t : s;
        s = low < 0 ? 0 : low;
        t = high > 1 ? 1 : high;
        if (!(s < t)) continue;
        int count = 0;
        bool under = true;
        for (int end = 0; end < 2 && under; ++end) {
            const Vec3 point = rod.p + (end == 0 ? s : t) * d;
            const Vec3 onEdge = from + (dot(point - from, e) / ee) * e;
            const float height = dot(normal, point - onEdge), separation = height - rod.radius;
            under = lengthSquared(point - onEdge - height * normal) <= beside;
            if (separation > rod.margin) continue;
            out[count++] = {onEdge + 0.5f * separation * normal, separation, edgeFeature(static_cast<int>(i), end)};
        }
        if (!under) continue;
        return count;
    }
    return 0;
}

void shallow(const HullView& a, const gjk::Closest& cores, const Rod& rod, Manifold& out) {
    constexpr float kAlongFace = 0.9995f;  // cosine
    constexpr float kFlat = 0.01f;         // sin² between segment and face
    closestPoint(cores, 0, rod.radius, rod.margin, kPointFeature, out);
    if (out.pointCount == 0) return;
    int face = 0;
    float most = -2;
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        const float facing = dot(a.planes[i].normal, cores.normal);
        if (facing > most) {
            most = facing;
            face = static_cast<int>(i);
        }
    }
    ManifoldPoint points[2];
    const Vec3 d = rod.q - rod.p, faceNormal = a.planes[static_cast<std::size_t>(face)].normal;
    const float rise = dot(d, faceNormal);
    if (most > kAlongFace && rise * rise < kFlat * lengthSquared(d)) {
        const int count = segmentOnFace(a, face, rod, points);
        if (count == 0) return;
        out.normal = faceNormal;
        out.pointCount = count;
        for (int i = 0; i < count; ++i) out.points[i] = points[i];
        return;
    }
    const int count = segmentOnEdge(a, cores.normal, rod, points);
    for (int i = 0; i < count; ++i) out.points[i] = points[i];
    out.pointCount = count > 0 ? count : out.pointCount;
}

/// Faces, and edges whose arc of normals crosses the circle of directions perpendicular to the segment. `common` is a
/// point of both.
void deep(const HullView& a, const Rod& rod, const Vec3& common, Manifold& out) {
    constexpr float kParallelSides = 1e-5f;  // sine of the angle, some 80 units in the last place
    const Vec3 d = rod.q - rod.p;
    int face = -1, edge = -1;
    float best = 0;
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        const float p = dot(a.planes[i].normal, rod.p), q = dot(a.planes[i].normal, rod.q);
        const float separation = (p < q ? p : q) - a.planes[i].offset;
        if (face < 0 || separation > best) {
            face = static_cast<int>(i);
            best = separation;
        }
    }
    out.normal = a.planes[static_cast<std::size_t>(face)].normal;
    best += kChoiceTolerance * rod.size;
    for (std::size_t i = 0; i < a.edges.size(); ++i) {
        const HullData::Edge& candidate = a.edges[i];
        const float l = dot(a.planes[candidate.leftFace].normal, d), r = dot(a.planes[candidate.rightFace].normal, d);
        if (l * r >= 0) continue;
        const Vec3 from = a.vertices[candidate.from], e = a.vertices[candidate.to] - from;
        const Vec3 axis = cross(e, d);
        const float length2 = lengthSquared(axis);
        if (length2 <= kParallelSides * lengthSquared(e) * lengthSquared(d)) continue;
        const Vec3 normal = (r > 0 ? -1.0f : 1.0f) / std::sqrt(length2) * axis;
        const float separation = dot(normal, rod.p - from);
        if (separation > best) {
            best = separation;
            edge = static_cast<int>(i);
            out.normal = normal;
        }
    }
    if (edge < 0) {
        out.pointCount = segmentOnFace(a, face, rod, out.points);
        if (out.pointCount > 0) return;
        const Vec3 lower = dot(out.normal, d) < 0 ? rod.q : rod.p;
        const float separation = dot(out.normal, lower) - a.planes[static_cast<std::size_t>(face)].offset - rod.radius;
        commonPoint(out.normal, separation, common, out);
        return;
    }
    const HullData::Edge& chosen = a.edges[static_cast<std::size_t>(edge)];
    const Vec3 from = a.vertices[chosen.from];
    const ClosestOnSegments near = closestOnSegments(from, a.vertices[chosen.to] - from, rod.p, d);
    out.pointCount = 1;
    out.points[0] = {0.5f * (near.pointA + near.pointB - rod.radius * out.normal), best - rod.radius,
                     edgeFeature(edge, 2)};
}

/// The face that the core lies highest above, by its lower end, unless it lies too high above some face; −1 then.
int highestFace(const HullView& a, const Rod& rod, float& height, Manifold& out) {
    int best = 0;
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        const Plane& plane = a.planes[i];
        const float heightP = dot(plane.normal, rod.p), heightQ = dot(plane.normal, rod.q);
        const float lower = (heightP < heightQ ? heightP : heightQ) - plane.offset, separation = lower - rod.radius;
        if (separation > rod.margin) {
            out.gap = separation;
            return -1;
        }
        if (i == 0 || lower > height) {
            height = lower;
            best = static_cast<int>(i);
        }
    }
    return best;
}

bool isOver(const HullView& a, int face, const Vec3& point) {
    const Vec3& normal = a.planes[static_cast<std::size_t>(face)].normal;
    const auto sides = a.loop(static_cast<std::size_t>(face));
    Vec3 from = a.vertices[sides.back()];
    for (const std::uint8_t side : sides) {
        const Vec3 to = a.vertices[side];
        if (dot(cross(to - from, normal), point - from) > 0) return false;
        from = to;
    }
    return true;
}

/// Where the lower end of the core is over the face that the core lies highest above, those two are nearest: nothing of
/// the polyhedron is beyond the plane of the face.
bool endOverFace(const HullView& a, int face, float height, const Rod& rod, gjk::Closest& cores) {
    if (!(height > 0)) return false;
    const Vec3& normal = a.planes[static_cast<std::size_t>(face)].normal;
    const Vec3& end = dot(normal, rod.p) < dot(normal, rod.q) ? rod.p : rod.q;
    if (!isOver(a, face, end)) return false;
    cores.normal = normal;
    cores.distance = height;
    cores.pointA = end - height * normal;
    cores.pointB = end;
    return true;
}

}  // namespace

void hullCapsule(const HullView& a, const Vec3& p, const Vec3& q, float radius, float margin, Manifold& out) {
    const float size = a.innerRadius > 0 && a.innerRadius < radius ? a.innerRadius : radius;
    const Rod rod{p, q, radius, margin, size};
    float height = 0;
    const int face = highestFace(a, rod, height, out);
    if (face < 0) return;
    gjk::Closest cores;
    // A triangle has one face and more than one side: what is beside it is told by the corners.
    if (a.faces.size() > 1 && endOverFace(a, face, height, rod, cores)) return shallow(a, cores, rod, out);
    const Vec3 ends[2] = {p, q};
    const gjk::PointsSupport supportA{a.vertices.data(), static_cast<int>(a.vertices.size())};
    cores = gjk::closest(supportA, gjk::PointsSupport{ends, 2}, a.center - 0.5f * (p + q));
    if (cores.overlap) {
        deep(a, rod, cores.pointB, out);
    } else {
        shallow(a, cores, rod, out);
    }
}

}  // namespace ragtop::pairs
