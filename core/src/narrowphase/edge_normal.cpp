#include "narrowphase/edge_normal.h"

#include "narrowphase/clip.h"

namespace ragtop {
namespace {

/// A side of a face, and the face beyond it.
struct Side {
    bool found = false;
    Vec3 at, along;  ///< along is a unit vector
    Vec3 beyond;     ///< normal of that face
};

/// The side of a face on which all points lie, all but for `slack`.
Side sideWith(const HullView& hull, int face, const Manifold& manifold, float slack) {
    const auto loop = hull.loop(static_cast<std::size_t>(face));
    const Vec3& normal = hull.planes[static_cast<std::size_t>(face)].normal;
    Side side;
    std::size_t from = loop.back();
    for (const std::size_t to : loop) {
        side.at = hull.vertices[from];
        side.along = normalized(hull.vertices[to] - side.at);
        const Vec3 outward = cross(side.along, normal);
        side.found = true;
        for (int i = 0; i < manifold.pointCount; ++i) {
            const float beside = dot(outward, manifold.points[i].position - side.at);
            side.found &= beside <= slack && beside >= -slack;
        }
        for (const HullData::Edge& edge : hull.edges) {
            if (!side.found || !((edge.from == from && edge.to == to) || (edge.from == to && edge.to == from)))
                continue;
            side.beyond = hull.planes[edge.leftFace == face ? edge.rightFace : edge.leftFace].normal;
            return side;
        }
        from = to;
    }
    side.found = false;
    return side;
}

/// Is x on the shorter way from p to q, all three at right angles to `about`?
bool isBetween(const Vec3& x, const Vec3& p, const Vec3& q, const Vec3& about) {
    const float sense = dot(about, cross(p, q)) < 0 ? -1.0f : 1.0f;
    return sense * dot(about, cross(p, x)) >= 0 && sense * dot(about, cross(x, q)) >= 0;
}

/// Does the second hull lie beyond the first along a direction, all but for `slack`?
bool separates(const HullView& a, const HullView& b, const Vec3& direction, float slack) {
    float highest = dot(a.vertices[0], direction), lowest = dot(b.vertices[0], direction);
    for (const Vec3& vertex : a.vertices) highest = dot(vertex, direction) > highest ? dot(vertex, direction) : highest;
    for (const Vec3& vertex : b.vertices) lowest = dot(vertex, direction) < lowest ? dot(vertex, direction) : lowest;
    return lowest - highest >= -slack;
}

}  // namespace

void turnToMiddle(const HullView& reference, int face, const HullView& incident, float size, Manifold& manifold) {
    constexpr float kFlush = 0.99f;           // cosine of the angle between faces that lie on each other, 8°
    constexpr std::size_t kNamedFaces = 128;  // that a feature tells apart
    if (manifold.pointCount < 2 || incident.planes.size() > kNamedFaces) return;
    const Vec3 normal = reference.planes[static_cast<std::size_t>(face)].normal;
    const int incidentFace = incidentFaceOf(manifold.points[0].feature);
    if (incidentFace < 0) return;
    const Vec3 facing = -incident.planes[static_cast<std::size_t>(incidentFace)].normal;
    if (dot(facing, normal) > kFlush) return;
    const float slack = kChoiceTolerance * size;
    // Of what is deep the shortest way out counts.
    for (int i = 0; i < manifold.pointCount; ++i)
        if (manifold.points[i].separation > slack || manifold.points[i].separation < -slack) return;
    const Side onReference = sideWith(reference, face, manifold, slack);
    if (!onReference.found) return;
    const Side onIncident = sideWith(incident, incidentFace, manifold, slack);
    if (!onIncident.found) return;
    // Every direction in the arcs of normals of both edges separates as well: from the face's to the last of them.
    const Vec3 about = onReference.along, beyond = -onIncident.beyond;
    Vec3 last = normal;
    for (const Vec3& end : {facing, beyond})
        if (isBetween(end, normal, onReference.beyond, about) && dot(end, normal) < dot(last, normal)) last = end;
    if (isBetween(onReference.beyond, facing, beyond, about) && dot(onReference.beyond, normal) < dot(last, normal))
        last = onReference.beyond;
    const Vec3 middle = normalized(normal + last);
    if (!separates(reference, incident, middle, 2 * slack)) return;
    for (int i = 0; i < manifold.pointCount; ++i) {
        ManifoldPoint& point = manifold.points[i];
        const auto beside = [&](const Side& side) {
            const Vec3 arm = point.position - side.at;
            return arm - dot(arm, side.along) * side.along;
        };
        point.separation = dot(middle, beside(onReference) - beside(onIncident));
    }
    manifold.normal = dot(manifold.normal, normal) < 0 ? -middle : middle;
}

}  // namespace ragtop
