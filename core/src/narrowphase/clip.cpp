#include "narrowphase/clip.h"

#include <memory>

#include "narrowphase/round_constants.h"

namespace ragtop {
namespace {

constexpr int kMaxClipPoints = 260;  // 128 corners, and every one of 128 sides adds at most one

/// Not filled with zeros first: a clip touches only the front of it.
struct ClipBuffer {
    union {
        ClipPoint points[kMaxClipPoints];
    };
    int count = 0;

    ClipBuffer() {}
    void add(const ClipPoint& point) {
        if (count < kMaxClipPoints) std::construct_at(&points[count++], point);
    }
};

/// Sutherland–Hodgman against normal · x ≤ offset [Ericson 2005, ch. 8.3.4]. Corners up to `overhang` outside stay.
void clipBySide(const ClipBuffer& in, ClipBuffer& out, const Vec3& normal, float offset, float overhang,
                std::uint8_t code) {
    out.count = 0;
    if (in.count == 0) return;
    const ClipPoint* from = &in.points[in.count - 1];
    float fromHeight = dot(normal, from->position) - offset;
    for (int i = 0; i < in.count; ++i) {
        const ClipPoint* to = &in.points[i];
        const float toHeight = dot(normal, to->position) - offset;
        const bool fromInside = fromHeight <= overhang, toInside = toHeight <= overhang;
        if (fromInside != toInside) {
            float t = fromHeight / (fromHeight - toHeight);
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            const Vec3 cut = from->position + t * (to->position - from->position);
            if (fromInside) {
                out.add({cut, 0, from->out, code});
            } else {
                out.add({cut, 0, code, from->out});
            }
        }
        if (toInside) out.add(*to);
        from = to;
        fromHeight = toHeight;
    }
}

}  // namespace

int facingFace(const HullView& incident, const Vec3& normal) {
    if (incident.faces.size() == 1) return 0;
    std::size_t corner = 0;
    float lowest = dot(incident.vertices[0], normal);
    for (std::size_t i = 1; i < incident.vertices.size(); ++i) {
        const float height = dot(incident.vertices[i], normal);
        if (height < lowest) {
            lowest = height;
            corner = i;
        }
    }
    int best = 0;
    float least = 2;
    for (const HullData::Edge& edge : incident.edges) {
        if (edge.from != corner && edge.to != corner) continue;
        for (const std::uint8_t face : {edge.leftFace, edge.rightFace}) {
            const float facing = dot(incident.planes[face].normal, normal);
            if (facing < least || (facing == least && face < best)) {
                least = facing;
                best = face;
            }
        }
    }
    return best;
}

int clipToFace(const HullView& reference, int face, const HullView& incident, float margin, float size, bool flipped,
               std::span<ManifoldPoint> out) {
    const Plane& plane = reference.planes[static_cast<std::size_t>(face)];
    const int incidentFace = facingFace(incident, plane.normal);
    ClipBuffer buffers[2];
    ClipBuffer* polygon = &buffers[0];
    ClipBuffer* next = &buffers[1];
    const auto corners = incident.loop(static_cast<std::size_t>(incidentFace));
    const int cornerCount = static_cast<int>(corners.size());
    for (int i = 0; i < cornerCount; ++i) {
        polygon->add({incident.vertices[corners[static_cast<std::size_t>(i)]], 0,
                      static_cast<std::uint8_t>(i == 0 ? cornerCount - 1 : i - 1), static_cast<std::uint8_t>(i)});
    }
    const auto sides = reference.loop(static_cast<std::size_t>(face));
    Vec3 from = reference.vertices[sides.back()];
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const Vec3 to = reference.vertices[sides[i]];
        const Vec3 outward = normalized(cross(to - from, plane.normal));
        clipBySide(*polygon, *next, outward, dot(outward, from), kOverhang * size,
                   static_cast<std::uint8_t>(128 + static_cast<int>(i)));
        ClipBuffer* const swapped = polygon;
        polygon = next;
        next = swapped;
        from = to;
    }
    int count = 0;
    for (int i = 0; i < polygon->count; ++i) {
        ClipPoint point = polygon->points[i];
        point.separation = dot(plane.normal, point.position) - plane.offset;
        if (point.separation > margin) continue;
        point.position -= 0.5f * point.separation * plane.normal;
        polygon->points[count++] = point;
    }
    if (count > static_cast<int>(out.size())) {
        count = reducePoints(polygon->points, count, plane.normal, kDepthTolerance * size);
    }
    for (int i = 0; i < count; ++i) {
        const ClipPoint& point = polygon->points[i];
        out[static_cast<std::size_t>(i)] = {point.position, point.separation,
                                            faceFeature(point, face, incidentFace, flipped)};
    }
    return count;
}

/// [Ericson 2005, ch. 5.1.9]
ClosestOnSegments closestOnSegments(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e) {
    const auto clamped = [](float v) { return v < 0 ? 0.0f : v > 1 ? 1.0f : v; };
    const Vec3 r = p - q;
    const float dd = lengthSquared(d), ee = lengthSquared(e), de = dot(d, e), dr = dot(d, r), er = dot(e, r);
    const float denominator = dd * ee - de * de;
    ClosestOnSegments out;
    if (dd > 0 && denominator > kParallelSegments * dd * ee) out.s = clamped((de * er - dr * ee) / denominator);
    if (ee > 0) {
        const float t = (de * out.s + er) / ee;
        out.t = clamped(t);
        if (t != out.t && dd > 0) out.s = clamped((de * out.t - dr) / dd);
    } else if (dd > 0) {
        out.s = clamped(-dr / dd);
    }
    out.pointA = p + out.s * d;
    out.pointB = q + out.t * e;
    return out;
}

}  // namespace ragtop
