#include "narrowphase/separating_axis.h"

#include "narrowphase/clip.h"

namespace ragtop {
namespace {

constexpr float kParallelEdges = 1e-5f;  // sin² below which the face axes do as well
constexpr int kMaxEdges = 384;           // 3 · 128 − 6

float lowest(const HullView& hull, const Vec3& direction) {
    float least = dot(hull.vertices[0], direction);
    for (std::size_t i = 1; i < hull.vertices.size(); ++i) {
        const float height = dot(hull.vertices[i], direction);
        least = height < least ? height : least;
    }
    return least;
}

Vec3 edgeVector(const HullView& hull, const HullData::Edge& edge) {
    return hull.vertices[edge.to] - hull.vertices[edge.from];
}

SeparatingAxis bestFace(const HullView& a, const HullView& b) {
    SeparatingAxis best;
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        const Plane& plane = a.planes[i];
        // B reaches below its centre by its inner radius at least, so a face with less to offer need not be tried.
        if (best.kind != 0 && dot(plane.normal, b.center) - plane.offset - b.innerRadius <= best.separation) continue;
        const float separation = lowest(b, plane.normal) - plane.offset;
        if (best.kind == 0 || separation > best.separation)
            best = {1, static_cast<int>(i), 0, separation, plane.normal};
    }
    return best;
}

/// Edges of `hull` whose arc of normals holds a direction in which `other` could be more than `least` away: for normals
/// n over the arc the separation is at most max n · c − r with c the way from the edge to the centre of `other`.
int worthyEdges(const HullView& hull, const HullView& other, float least, std::uint16_t* out) {
    int count = 0;
    const float needed = least + other.innerRadius;
    for (std::size_t i = 0; i < hull.edges.size(); ++i) {
        const HullData::Edge& edge = hull.edges[i];
        const Vec3 way = other.center - hull.vertices[edge.from];
        const Vec3& left = hull.planes[edge.leftFace].normal;
        const Vec3& right = hull.planes[edge.rightFace].normal;
        const float l = dot(left, way), r = dot(right, way);
        if (l <= needed && r <= needed) {
            const Vec3 e = edgeVector(hull, edge);
            // The way, made perpendicular to the edge, lies in the arc when it is left of `right` and right of `left`.
            if (dot(cross(e, left), way) < 0 || dot(cross(right, e), way) < 0) continue;
            const float ee = lengthSquared(e), we = dot(way, e);
            if (needed > 0 && lengthSquared(way) - we * we / ee <= needed * needed) continue;
        }
        out[count++] = static_cast<std::uint16_t>(i);
    }
    return count;
}

/// Do the arcs of two edges cross on the sphere of normals, so that they make a face of A − B [Gregorius, GDC 2013]?
/// B's normals are taken negative. `sense` tells which of ± eA × eB is the outward normal.
bool makesFace(const HullView& a, const HullData::Edge& edgeA, const Vec3& eA, const HullView& b,
               const HullData::Edge& edgeB, const Vec3& eB, float& sense) {
    const float cA = -dot(b.planes[edgeB.leftFace].normal, eA), dA = -dot(b.planes[edgeB.rightFace].normal, eA);
    if (cA * dA >= 0) return false;
    const float aB = dot(a.planes[edgeA.leftFace].normal, eB), bB = dot(a.planes[edgeA.rightFace].normal, eB);
    sense = -bB;
    return aB * bB < 0 && cA * bB > 0;
}

}  // namespace

PlacedHull::PlacedHull(const HullView& hull, const Frame& frame) {
    const Mat3 rotation = toMat3(frame.rotation);
    for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
        std::construct_at(&vertices_[i], frame.position + rotation * hull.vertices[i]);
    }
    for (std::size_t i = 0; i < hull.planes.size(); ++i) {
        const Vec3 normal = rotation * hull.planes[i].normal;
        std::construct_at(&planes_[i], Plane{normal, hull.planes[i].offset + dot(normal, frame.position)});
    }
    view_ = hull;
    view_.vertices = {vertices_, hull.vertices.size()};
    view_.planes = {planes_, hull.planes.size()};
    view_.center = frame.position + rotation * hull.center;
}

SeparatingAxis bestFaceOfA(const HullView& a, const HullView& b) { return bestFace(a, b); }

SeparatingAxis bestFaceOfB(const HullView& a, const HullView& b) {
    SeparatingAxis best = bestFace(b, a);
    best.kind = 2;
    best.indexB = best.indexA;
    best.indexA = 0;
    best.normal = -best.normal;
    return best;
}

SeparatingAxis bestEdgePair(const HullView& a, const HullView& b, float least) {
    SeparatingAxis best;
    best.separation = least;
    std::uint16_t edgesA[kMaxEdges], edgesB[kMaxEdges];
    const int countA = worthyEdges(a, b, least, edgesA);
    if (countA == 0) return best;
    const int countB = worthyEdges(b, a, least, edgesB);
    for (int i = 0; i < countA; ++i) {
        const HullData::Edge& edgeA = a.edges[edgesA[i]];
        const Vec3 eA = edgeVector(a, edgeA), pA = a.vertices[edgeA.from];
        for (int j = 0; j < countB; ++j) {
            const HullData::Edge& edgeB = b.edges[edgesB[j]];
            const Vec3 eB = edgeVector(b, edgeB);
            float sense = 0;
            if (!makesFace(a, edgeA, eA, b, edgeB, eB, sense)) continue;
            const Vec3 axis = cross(eA, eB);
            const float length2 = lengthSquared(axis);
            if (length2 <= kParallelEdges * lengthSquared(eA) * lengthSquared(eB)) continue;
            const Vec3 normal = (sense < 0 ? -1.0f : 1.0f) / std::sqrt(length2) * axis;
            const float separation = dot(normal, b.vertices[edgeB.from] - pA);
            if (separation > best.separation) best = {3, edgesA[i], edgesB[j], separation, normal};
        }
    }
    return best;
}

SeparatingAxis alongAxis(const HullView& a, const HullView& b, int kind, int indexA, int indexB) {
    const auto iA = static_cast<std::size_t>(indexA), iB = static_cast<std::size_t>(indexB);
    SeparatingAxis none;
    if (kind == 1) {
        if (iA >= a.faces.size()) return none;
        const Plane& plane = a.planes[iA];
        return {1, indexA, 0, lowest(b, plane.normal) - plane.offset, plane.normal};
    }
    if (kind == 2) {
        if (iB >= b.faces.size()) return none;
        const Plane& plane = b.planes[iB];
        return {2, 0, indexB, lowest(a, plane.normal) - plane.offset, -plane.normal};
    }
    if (kind != 3 || iA >= a.edges.size() || iB >= b.edges.size()) return none;
    const HullData::Edge& edgeA = a.edges[iA];
    const HullData::Edge& edgeB = b.edges[iB];
    const Vec3 eA = edgeVector(a, edgeA), eB = edgeVector(b, edgeB);
    float sense = 0;
    if (!makesFace(a, edgeA, eA, b, edgeB, eB, sense)) return none;
    const Vec3 axis = cross(eA, eB);
    const float length2 = lengthSquared(axis);
    if (length2 <= kParallelEdges * lengthSquared(eA) * lengthSquared(eB)) return none;
    const Vec3 normal = (sense < 0 ? -1.0f : 1.0f) / std::sqrt(length2) * axis;
    return {3, indexA, indexB, dot(normal, b.vertices[edgeB.from] - a.vertices[edgeA.from]), normal};
}

AxisChoice chooseAxis(const HullView& a, const HullView& b, float margin, float size, const SeparatingAxis& before) {
    const float tolerance = kChoiceTolerance * size;
    SeparatingAxis face = bestFaceOfA(a, b);
    if (face.separation > margin) return {face, {}};
    const SeparatingAxis faceB = bestFaceOfB(a, b);
    if (faceB.separation > face.separation) face = faceB;
    if (face.separation > margin) return {face, {}};
    if ((before.kind == 1 || before.kind == 2) && before.separation >= face.separation - tolerance) face = before;

    const bool keepEdge = before.kind == 3 && before.separation > face.separation;
    const float toBeat = (keepEdge ? before.separation : face.separation) + tolerance;
    const SeparatingAxis edge = bestEdgePair(a, b, toBeat < margin ? toBeat : margin);
    if (edge.kind != 0 && (edge.separation > margin || edge.separation > toBeat)) return {edge, face};
    if (keepEdge) return {before, face};
    return {face, {}};
}

SeparationCache toCache(const SeparatingAxis& axis) {
    SeparationCache cache;
    cache.kind = static_cast<std::uint8_t>(axis.kind);
    cache.indexA = static_cast<std::uint8_t>(axis.indexA & 255);
    cache.indexB = static_cast<std::uint8_t>(axis.indexB & 255);
    cache.pad = static_cast<std::uint8_t>((axis.indexA >> 8 & 1) | (axis.indexB >> 8 & 1) << 1);
    cache.separation = axis.separation;
    return cache;
}

}  // namespace ragtop
