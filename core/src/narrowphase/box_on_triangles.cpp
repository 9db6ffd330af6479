#include "narrowphase/box_on_triangles.h"

#include <algorithm>
#include <cmath>

#include "narrowphase/clip.h"
#include "narrowphase/clip_rectangle.h"

namespace ragtop {
namespace {

constexpr float kAlongTriangle = 1e-5f;  // sin² below which the face axes do as well

int after(int i) { return i == 2 ? 0 : i + 1; }
FourFloats along(const FourVectors& v, const Vec3& axis) { return v.x * axis.x + v.y * axis.y + v.z * axis.z; }
FourFloats squareWithSign(FourFloats v) { return v * absolute(v); }

/// Triangles seen from the box: corners and normals along its axes.
struct SeenFromBox {
    FourFloats corner[3][3];  ///< by corner and axis
    FourFloats normal[3];

    SeenFromBox(const TurnedBox& box, const FourTriangles& t) {
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) corner[k][i] = along(t.v[k], box.axes[i]);
            normal[i] = along(t.n, box.axes[i]);
        }
    }
};

/// The face of the box that each triangle is farthest in front of.
struct BoxFaces {
    FourFloats separation = {};
    FourInts axis = {};
    FourFloats outside = {};  ///< m², squared distance of the box and the bounds of the triangle along its axes

    BoxFaces(const TurnedBox& box, const SeenFromBox& t) {
        for (int i = 0; i < 3; ++i) {
            const FourFloats a = t.corner[0][i], b = t.corner[1][i], c = t.corner[2][i];
            const FourFloats above = lesser(lesser(a, b), c) - box.half[i];
            const FourFloats below = -greater(greater(a, b), c) - box.half[i];
            const FourInts up = above > below;
            const FourFloats s = up ? above : below, apart = greater(s, FourFloats{});
            outside += apart * apart;
            const FourInts index = (up & spread(1)) + (1 + 2 * i);
            const FourInts better = i == 0 ? FourInts{-1, -1, -1, -1} : s > separation;
            separation = better ? s : separation;
            axis = better ? index : axis;
        }
    }
};

/// Edge pairs of separation above `least`. With e an edge of the triangle and aᵢ an axis of the box, L = ±(e × aᵢ) is
/// the direction that leads out of the triangle over that edge, so that e is what lies farthest along it:
///   separation = (−L · v − Σ |L · aⱼ| hⱼ)/|L|,   e × aᵢ = e_q a_p − e_p a_q   with i, p, q in cyclic order.
struct EdgePairs {
    FourFloats separation;
    FourInts axis = {};  ///< 0: none

    EdgePairs(const TurnedBox& box, const SeenFromBox& t, FourFloats least) : separation(least) {
        for (int k = 0; k < 3; ++k) {
            const FourFloats* const v = t.corner[k];
            FourFloats e[3];
            for (int i = 0; i < 3; ++i) e[i] = t.corner[after(k)][i] - v[i];
            const FourFloats square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
            for (int i = 0; i < 3; ++i) {
                const int p = after(i), q = after(p);
                const FourFloats length2 = e[p] * e[p] + e[q] * e[q], across = e[q] * v[p] - e[p] * v[q];
                const FourFloats outwards = t.normal[i] > 0.0f ? across : -across;
                const FourFloats gap = -outwards - (absolute(e[q]) * box.half[p] + absolute(e[p]) * box.half[q]);
                const FourInts valid = length2 > kAlongTriangle * square;
                if (lanesWhere(valid & (squareWithSign(gap) > squareWithSign(separation) * length2)) == 0) continue;
                const FourFloats s = gap / squareRoot(valid ? length2 : FourFloats{1, 1, 1, 1});
                const FourInts better = valid & (s > separation);
                separation = better ? s : separation;
                axis = better ? spread(BoxAxes::kFirstEdges + 3 * k + i) : axis;
            }
        }
    }
};

/// A corner of a face of the box while it is cut to a triangle.
struct Cut {
    FourFloats position;
    FourFloats heights;  ///< outside the three sides, and above the plane
    std::uint8_t in, out;
};

int cutBySide(const Cut* in, int count, Cut* out, int side, float overhang) {
    int kept = 0;
    const Cut* from = &in[count - 1];
    const auto code = static_cast<std::uint8_t>(128 + side);
    for (int i = 0; i < count; ++i) {
        const Cut* to = &in[i];
        const float fromHeight = from->heights[side], toHeight = to->heights[side];
        const bool fromInside = fromHeight <= overhang, toInside = toHeight <= overhang;
        if (fromInside != toInside) {
            float t = fromHeight / (fromHeight - toHeight);
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            out[kept++] = {from->position + t * (to->position - from->position),
                           from->heights + t * (to->heights - from->heights), fromInside ? from->out : code,
                           fromInside ? code : from->out};
        }
        if (toInside) out[kept++] = *to;
        from = to;
    }
    return kept;
}

/// The sides of a triangle and its plane as four planes, less inside.
struct TriangleSides {
    FourVectors normals;
    FourFloats offsets;

    explicit TriangleSides(const CornersAndNormal& t) {
        const Vec3 &a = t.v[0], &b = t.v[1], &c = t.v[2], ab = b - a, bc = c - b, ca = a - c;
        const FourVectors from{FourFloats{a.x, b.x, c.x, a.x}, FourFloats{a.y, b.y, c.y, a.y},
                               FourFloats{a.z, b.z, c.z, a.z}};
        const FourVectors edges{FourFloats{ab.x, bc.x, ca.x, ab.x}, FourFloats{ab.y, bc.y, ca.y, ab.y},
                                FourFloats{ab.z, bc.z, ca.z, ab.z}};
        const FourVectors outward = cross(edges, spread(t.normal));
        normals = (1.0f / length(outward)) * outward;
        normals.x[3] = t.normal.x, normals.y[3] = t.normal.y, normals.z[3] = t.normal.z;
        offsets = dot(normals, from);
    }
    FourFloats heights(const Vec3& point) const { return dot(normals, spread(point)) - offsets; }
};

/// In cyclic order round a face.
constexpr float kCorners[4][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};

}  // namespace

TurnedBox::TurnedBox(const Vec3& halfExtents, const Quat& rotation) : half(halfExtents) {
    const Mat3 turn = toMat3(rotation);
    axes[0] = turn.cx, axes[1] = turn.cy, axes[2] = turn.cz;
    const float xy = half.x < half.y ? half.x : half.y;
    size = xy < half.z ? xy : half.z;
}

BoxAxes findBoxAxes(const TurnedBox& box, const FourTriangles& triangles, float margin, float behind) {
    constexpr float kRounding = 1e-5f;  // some 80 units in the last place
    const SeenFromBox t(box, triangles);
    const FourFloats height = -dot(triangles.n, triangles.v[0]);
    const FourFloats own = height - (absolute(t.normal[0]) * box.half.x + absolute(t.normal[1]) * box.half.y +
                                     absolute(t.normal[2]) * box.half.z);
    const BoxFaces faces(box, t);
    const float farthest = (1 + kRounding) * margin * margin;
    BoxAxes out;
    out.touches = lanesWhere((height >= -behind) & (own <= margin) & (faces.outside <= farthest));
    if (out.touches == 0) return out;

    const float tolerance = kChoiceTolerance * box.size;
    const FourInts ofTriangle = own >= faces.separation - tolerance;
    const FourFloats face = ofTriangle ? own : faces.separation, toBeat = face + tolerance;
    const EdgePairs edges(box, t, lesser(toBeat, FourFloats{margin, margin, margin, margin}));
    const FourInts ofEdges = edges.axis != 0;
    out.separation = ofEdges ? edges.separation : face;
    out.axis = ofEdges ? edges.axis : ofTriangle ? FourInts{} : faces.axis;
    out.touches &= lanesWhere(out.separation <= margin);
    return out;
}

int boxFaceOnTriangle(const TurnedBox& box, const CornersAndNormal& t, float margin,
                      ManifoldPoint (&out)[kMostBoxPoints]) {
    float facing[3];
    for (int i = 0; i < 3; ++i) facing[i] = dot(t.normal, box.axes[i]);
    int face = 0;
    for (int i = 1; i < 3; ++i)
        if (std::fabs(facing[i]) > std::fabs(facing[face])) face = i;
    const int p = after(face), q = after(p);
    const bool positive = facing[face] < 0;
    const Vec3 middle = (positive ? box.half[face] : -box.half[face]) * box.axes[face];
    const Vec3 alongP = box.half[p] * box.axes[p], alongQ = box.half[q] * box.axes[q];
    const TriangleSides sides(t);

    Cut buffers[2][kMostBoxPoints];
    Cut* polygon = buffers[0];
    Cut* next = buffers[1];
    const float overhang = kOverhang * box.size;
    unsigned cutsSome = 0, cutsAll = 7;
    int count = 4;
    for (int i = 0; i < count; ++i) {
        const Vec3 at = middle + kCorners[i][0] * alongP + kCorners[i][1] * alongQ;
        polygon[i] = {FourFloats{at.x, at.y, at.z, 0}, sides.heights(at), static_cast<std::uint8_t>((i + 3) & 3),
                      static_cast<std::uint8_t>(i)};
        const unsigned outside = lanesWhere(polygon[i].heights > overhang) & 7u;
        cutsSome |= outside;
        cutsAll &= outside;
    }
    if (cutsAll != 0) return 0;
    for (int side = 0; side < 3 && count > 0; ++side) {
        if ((cutsSome >> side & 1) == 0) continue;
        count = cutBySide(polygon, count, next, side, overhang);
        Cut* const swapped = polygon;
        polygon = next;
        next = swapped;
    }
    const int name = 2 * face + (positive ? 1 : 0);
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        const Cut& cut = polygon[i];
        const float separation = cut.heights[3];
        if (separation > margin) continue;
        const Vec3 at{cut.position[0], cut.position[1], cut.position[2]};
        out[kept++] = {at - 0.5f * separation * t.normal, separation,
                       faceFeature({{}, 0, cut.in, cut.out}, 0, name, false)};
    }
    return kept;
}

int triangleOnBoxFace(const TurnedBox& box, const CornersAndNormal& t, int axis, float margin, Vec3& normal,
                      ManifoldPoint (&out)[kMostBoxPoints]) {
    const int face = (axis - 1) / 2, p = after(face), q = after(p);
    const float sign = (axis - 1) % 2 == 1 ? 1.0f : -1.0f;
    const Vec3 outward = sign * box.axes[face];
    normal = -outward;
    pairs::Corner buffers[2][kMostBoxPoints];
    pairs::Corner* const polygon = buffers[0];
    float mostU = 0, mostV = 0;
    int count = 3;
    for (int i = 0; i < count; ++i) {
        polygon[i] = {dot(t.v[i], box.axes[p]), dot(t.v[i], box.axes[q]), dot(t.v[i], outward) - box.half[face],
                      static_cast<std::uint8_t>((i + 2) % 3), static_cast<std::uint8_t>(i)};
        mostU = std::max(mostU, std::fabs(polygon[i].u));
        mostV = std::max(mostV, std::fabs(polygon[i].v));
    }
    pairs::clipToRectangle(buffers[0], buffers[1], count, mostU, mostV, box.half[p], box.half[q], kOverhang * box.size);
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        const pairs::Corner& corner = polygon[i];
        if (corner.w > margin) continue;
        const Vec3 at = corner.u * box.axes[p] + corner.v * box.axes[q] + (box.half[face] + 0.5f * corner.w) * outward;
        out[kept++] = {at, corner.w, faceFeature({{}, 0, corner.in, corner.out}, axis - 1, 0, true)};
    }
    return kept;
}

int edgesOfBoxAndTriangle(const TurnedBox& box, const CornersAndNormal& t, int axis, float separation, float margin,
                          Vec3& normal, ManifoldPoint (&out)[kMostBoxPoints]) {
    const int k = (axis - BoxAxes::kFirstEdges) / 3, i = (axis - BoxAxes::kFirstEdges) % 3;
    const int p = after(i), q = after(p);
    const Vec3 e = t.v[after(k)] - t.v[k], direction = cross(e, box.axes[i]);
    const float sign = dot(t.normal, box.axes[i]) > 0 ? 1.0f : -1.0f;
    normal = (sign / length(direction)) * direction;
    // The edge of the box that lies farthest against the normal.
    const bool positiveP = dot(normal, box.axes[p]) < 0, positiveQ = dot(normal, box.axes[q]) < 0;
    const Vec3 alongBox = box.half[i] * box.axes[i];
    const Vec3 middle =
        (positiveP ? box.half[p] : -box.half[p]) * box.axes[p] + (positiveQ ? box.half[q] : -box.half[q]) * box.axes[q];
    const ClosestOnSegments near = closestOnSegments(t.v[k], e, middle - alongBox, 2 * alongBox);
    if (separation > 0 && lengthSquared(near.pointB - near.pointA) > margin * margin) return 0;
    out[0] = {0.5f * (near.pointA + near.pointB), separation,
              edgeFeature(k, 4 * i + 2 * (positiveP ? 1 : 0) + (positiveQ ? 1 : 0))};
    return 1;
}

}  // namespace ragtop
