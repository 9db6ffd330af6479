#include "narrowphase/separating_axis.h"

#include <bit>

#include "base/four_floats.h"
#include "narrowphase/clip.h"

namespace ragtop {
namespace {

constexpr float kAlongFaces = 1e-5f;  // sin² below which the face axes do as well
constexpr int kMaxEdges = 384;        // 3 · 128 − 6

/// Four at a time, so that none waits for the one before.
float lowest(const HullView& hull, const Vec3& direction) {
    const std::size_t count = hull.vertices.size();
    const float first = dot(hull.vertices[0], direction);
    float least[4] = {first, first, first, first};
    const auto take = [&](std::size_t i, float& so_far) {
        const float height = dot(hull.vertices[i], direction);
        so_far = height < so_far ? height : so_far;
    };
    std::size_t i = 1;
    for (; i + 4 <= count; i += 4)
        for (std::size_t k = 0; k < 4; ++k) take(i + k, least[k]);
    for (; i < count; ++i) take(i, least[0]);
    const float low = least[0] < least[1] ? least[0] : least[1], high = least[2] < least[3] ? least[2] : least[3];
    return low < high ? low : high;
}

/// How far the centre of one polyhedron is above each plane of another.
class CenterHeights {
public:
    CenterHeights(const HullView& of, const HullView& other) {
        for (std::size_t i = 0; i < of.planes.size(); ++i)
            heights_[i] = dot(of.planes[i].normal, other.center) - of.planes[i].offset;
    }
    float operator[](std::size_t plane) const { return heights_[plane]; }

private:
    float heights_[256];
};

Vec3 edgeVector(const HullView& hull, const HullData::Edge& edge) {
    return hull.vertices[edge.to] - hull.vertices[edge.from];
}

/// Of equal faces the first. The face that the other one is highest above is tried first: it spares most of the others.
SeparatingAxis bestFace(const HullView& a, const HullView& b, const CenterHeights& heights) {
    std::size_t likely = 0;
    for (std::size_t i = 1; i < a.faces.size(); ++i)
        if (heights[i] > heights[likely]) likely = i;
    const auto separation = [&](std::size_t face) { return lowest(b, a.planes[face].normal) - a.planes[face].offset; };
    std::size_t best = likely;
    float most = separation(likely);
    for (std::size_t i = 0; i < a.faces.size(); ++i) {
        // B reaches below its centre by its inner radius at least, so a face with less to offer need not be tried.
        const float offer = heights[i] - b.innerRadius;
        if (i == likely || offer < most || (offer == most && i > best)) continue;
        const float found = separation(i);
        if (found < most || (found == most && i > best)) continue;
        best = i;
        most = found;
    }
    return {1, static_cast<int>(best), 0, most, a.planes[best].normal};
}

/// Edges of `hull` whose arc of normals holds a direction in which `other` could be more than `least` away: for normals
/// n over the arc the separation is at most max n · c − r with c the way from the edge to the centre of `other`.
int worthyEdges(const HullView& hull, const HullView& other, const CenterHeights& heights, float least,
                std::uint16_t* out) {
    int count = 0;
    const float needed = least + other.innerRadius;
    for (std::size_t i = 0; i < hull.edges.size(); ++i) {
        const HullData::Edge& edge = hull.edges[i];
        const float l = heights[edge.leftFace], r = heights[edge.rightFace];
        if (l <= needed && r <= needed) {
            // No direction of an arc between two that look away looks at the centre.
            if (l < 0 && r < 0) continue;
            const Vec3 way = other.center - hull.vertices[edge.from], e = edgeVector(hull, edge);
            // The way, made perpendicular to the edge, lies in the arc when it is left of `right` and right of `left`.
            if (dot(cross(e, hull.planes[edge.leftFace].normal), way) < 0 ||
                dot(cross(hull.planes[edge.rightFace].normal, e), way) < 0)
                continue;
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

constexpr int toFours(int count) { return (count + 3) / 4 * 4; }

/// Edges as `makesFace` looks at them, four side by side.
class EdgeRows {
public:
    EdgeRows(const HullView& hull, const std::uint16_t* edges, int count) : count_(count) {
        for (int i = 0; i < toFours(count); ++i) {
            Vec3 rows[3] = {};  // an edge of no length makes no face
            if (i < count) {
                const HullData::Edge& edge = hull.edges[edges[i]];
                rows[0] = edgeVector(hull, edge);
                rows[1] = -hull.planes[edge.leftFace].normal;
                rows[2] = -hull.planes[edge.rightFace].normal;
            }
            for (int row = 0; row < 3; ++row)
                for (int axis = 0; axis < 3; ++axis) rows_[row][axis][i] = rows[row][axis];
        }
    }

    /// Calls visit(place in the list) for those that make a face with an edge of A.
    template <class Visit>
    void forEachFace(const HullView& a, const HullData::Edge& edgeA, const Vec3& eA, Visit&& visit) const {
        const Vec3 &left = a.planes[edgeA.leftFace].normal, &right = a.planes[edgeA.rightFace].normal;
        for (int i = 0; i < count_; i += 4) {
            const FourFloats cA = dotRow(1, i, eA), dA = dotRow(2, i, eA);
            const FourFloats aB = dotRow(0, i, left), bB = dotRow(0, i, right);
            unsigned makes = lanesWhere((cA * dA < 0.0f) & (aB * bB < 0.0f) & (cA * bB > 0.0f));
            for (; makes != 0; makes &= makes - 1) visit(i + std::countr_zero(makes));
        }
    }

private:
    FourFloats dotRow(int row, int i, const Vec3& v) const {
        const auto& r = rows_[row];
        return loadFour(r[0] + i) * v.x + loadFour(r[1] + i) * v.y + loadFour(r[2] + i) * v.z;
    }

    int count_;
    float rows_[3][3][toFours(kMaxEdges)];
};

/// The edge pair of greatest separation above `least`; of equal ones the first.
SeparatingAxis bestEdgePair(const HullView& a, const HullView& b, const CenterHeights& heightsA,
                            const CenterHeights& heightsB, float least) {
    SeparatingAxis best;
    best.separation = least;
    std::uint16_t edgesA[kMaxEdges], edgesB[kMaxEdges];
    const int countA = worthyEdges(a, b, heightsA, least, edgesA);
    if (countA == 0) return best;
    const int countB = worthyEdges(b, a, heightsB, least, edgesB);
    if (countB == 0) return best;
    const EdgeRows rowsB(b, edgesB, countB);
    for (int i = 0; i < countA; ++i) {
        const HullData::Edge& edgeA = a.edges[edgesA[i]];
        const Vec3 eA = edgeVector(a, edgeA), pA = a.vertices[edgeA.from];
        rowsB.forEachFace(a, edgeA, eA, [&](int j) {
            const HullData::Edge& edgeB = b.edges[edgesB[j]];
            const Vec3 eB = edgeVector(b, edgeB);
            const Vec3 axis = cross(eA, eB);
            const float length2 = lengthSquared(axis);
            if (length2 <= kAlongFaces * lengthSquared(eA) * lengthSquared(eB)) return;
            const float sense = -dot(a.planes[edgeA.rightFace].normal, eB);
            const Vec3 normal = (sense < 0 ? -1.0f : 1.0f) / std::sqrt(length2) * axis;
            const float separation = dot(normal, b.vertices[edgeB.from] - pA);
            if (separation > best.separation) best = {3, edgesA[i], edgesB[j], separation, normal};
        });
    }
    return best;
}

/// A face of B, seen from A.
SeparatingAxis seenFromA(SeparatingAxis best) {
    best.kind = 2;
    best.indexB = best.indexA;
    best.indexA = 0;
    best.normal = -best.normal;
    return best;
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
    if (length2 <= kAlongFaces * lengthSquared(eA) * lengthSquared(eB)) return none;
    const Vec3 normal = (sense < 0 ? -1.0f : 1.0f) / std::sqrt(length2) * axis;
    return {3, indexA, indexB, dot(normal, b.vertices[edgeB.from] - a.vertices[edgeA.from]), normal};
}

AxisChoice chooseAxis(const HullView& a, const HullView& b, float margin, float size, const SeparatingAxis& before) {
    const float tolerance = kChoiceTolerance * size;
    const CenterHeights heightsA(a, b);
    SeparatingAxis face = bestFace(a, b, heightsA);
    if (face.separation > margin) return {face, {}};
    const CenterHeights heightsB(b, a);
    const SeparatingAxis faceB = seenFromA(bestFace(b, a, heightsB));
    if (faceB.separation > face.separation) face = faceB;
    if (face.separation > margin) return {face, {}};
    if ((before.kind == 1 || before.kind == 2) && before.separation >= face.separation - tolerance) face = before;

    const bool keepEdge = before.kind == 3 && before.separation > face.separation;
    const float toBeat = (keepEdge ? before.separation : face.separation) + tolerance;
    const SeparatingAxis edge = bestEdgePair(a, b, heightsA, heightsB, toBeat < margin ? toBeat : margin);
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
