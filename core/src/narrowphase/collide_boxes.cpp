#include <bit>

#include "base/four_floats.h"
#include "narrowphase/clip_rectangle.h"
#include "narrowphase/pairs.h"

/// Two boxes with half extents hA, hB, in the frame of A; B's centre is at p, its axes are the columns b_j of R.
///
/// Separating axes [Gottschalk, Lin, Manocha, 1996]. Along a unit vector L the boxes are apart by
///   s(L) = |p · L| − Σ hA_i |a_i · L| − Σ hB_j |b_j · L|,
/// and the largest s over the faces a_i, b_j and the edge pairs a_i × b_j is their separation (negative: overlap). The
/// axis of the step before is kept while another one is better by less than 0.01 sizes, so that contact points
/// persist.
///
/// Contact points. For a face, the incident face of the other box is clipped to the sides of the reference face; each
/// corner that remains and is less than the margin above the face is a point, half way between the surfaces. At most
/// four are kept. For an edge pair, one point is half way between the closest points of both edges; where it is a
/// corner of the clipped faces, which lie nearly along both edges then, these give the others, with their gaps along
/// the axis.
///
/// This is the commonest pair, so it works on plain arrays and tests the axes of a box side by side.
namespace ragtop::pairs {
namespace {

constexpr float kParallelEdges = 1e-5f;  // sin² below which the face axes do as well

struct Boxes {
    alignas(16) float hA[4] = {}, hB[4] = {};
    alignas(16) float p[4] = {};     ///< B's centre in A
    alignas(16) float R[3][4];       ///< R[i][j]: component along A's axis i of B's axis j
    alignas(16) float Q[3][4];       ///< absolute values
    alignas(16) float faceA[4], faceB[4];  ///< separations along the faces of each
    alignas(16) float pB[4];         ///< B's centre along B's axes
    float size;                      ///< smallest half extent
};

using ragtop::absolute;
inline float absolute(float v) { return v < 0 ? -v : v; }
inline int after(int i) { return i == 2 ? 0 : i + 1; }
inline Vec3 toVec3(const float* v) { return {v[0], v[1], v[2]}; }
inline FourFloats inLanes(float x, float y, float z) { return FourFloats{x, y, z, 0}; }

/// Side by side in lanes are the axes of one box; the fourth lane is zero.
inline Boxes prepare(const Vec3& hA, const Vec3& hB, const Frame& bInA) {
    Boxes b;
    const Mat3 m = toMat3(bInA.rotation);
    const Vec3 position = bInA.position;
    const FourFloats columns[3] = {inLanes(m.cx.x, m.cx.y, m.cx.z), inLanes(m.cy.x, m.cy.y, m.cy.z),
                                   inLanes(m.cz.x, m.cz.y, m.cz.z)};
    const FourFloats rows[3] = {inLanes(m.cx.x, m.cy.x, m.cz.x), inLanes(m.cx.y, m.cy.y, m.cz.y),
                                inLanes(m.cx.z, m.cy.z, m.cz.z)};
    const FourFloats p = inLanes(position.x, position.y, position.z);
    const FourFloats pB = rows[0] * position.x + rows[1] * position.y + rows[2] * position.z;
    const FourFloats reachA =
        inLanes(hA.x, hA.y, hA.z) +
        (absolute(columns[0]) * hB.x + absolute(columns[1]) * hB.y + absolute(columns[2]) * hB.z);
    const FourFloats reachB =
        inLanes(hB.x, hB.y, hB.z) + (absolute(rows[0]) * hA.x + absolute(rows[1]) * hA.y + absolute(rows[2]) * hA.z);
    storeFour(b.p, p);
    storeFour(b.pB, pB);
    storeFour(b.faceA, absolute(p) - reachA);
    storeFour(b.faceB, absolute(pB) - reachB);
    b.size = hA.x;
    for (int i = 0; i < 3; ++i) {
        storeFour(b.R[i], rows[i]);
        storeFour(b.Q[i], absolute(rows[i]));
        b.hA[i] = hA[i];
        b.hB[i] = hB[i];
        b.size = hA[i] < b.size ? hA[i] : b.size;
        b.size = hB[i] < b.size ? hB[i] : b.size;
    }
    return b;
}

/// The axes aᵢ × bⱼ for one i, before they are made unit vectors.
struct EdgeAxes {
    FourFloats gap;      ///< |p · L| − rA − rB
    FourFloats length2;  ///< 1 − Rᵢⱼ²
};

inline EdgeAxes edgeAxes(const Boxes& b, int i) {
    const int i1 = after(i), i2 = after(i1);
    const FourFloats r1 = loadFour(b.R[i1]), r2 = loadFour(b.R[i2]), q = loadFour(b.Q[i]), hB = loadFour(b.hB);
    const auto next = [](FourFloats v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); };
    const auto afterNext = [](FourFloats v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); };
    const FourFloats along = r1 * b.p[i2] - r2 * b.p[i1];
    const FourFloats rA = loadFour(b.Q[i2]) * b.hA[i1] + loadFour(b.Q[i1]) * b.hA[i2];
    const FourFloats rB = next(hB) * afterNext(q) + afterNext(hB) * next(q);
    return {absolute(along) - (rA + rB), r1 * r1 + r2 * r2};
}

inline float edgeSeparation(const Boxes& b, int i, int j) {
    const EdgeAxes axes = edgeAxes(b, i);
    return axes.length2[j] > kParallelEdges ? axes.gap[j] / std::sqrt(axes.length2[j]) : -1e30f * b.size;
}

struct Choice {
    int kind = 0;  ///< as in SeparationCache
    int i = 0, j = 0;
    float separation = 0;
};

inline void remember(SeparationCache& cache, const Choice& choice) {
    cache.kind = static_cast<std::uint8_t>(choice.kind);
    cache.indexA = static_cast<std::uint8_t>(choice.i);
    cache.indexB = static_cast<std::uint8_t>(choice.j);
    cache.separation = choice.separation;
}

inline float separationOf(const Boxes& b, const SeparationCache& cache) {
    switch (cache.kind) {
        case 1:
            return b.faceA[cache.indexA];
        case 2:
            return b.faceB[cache.indexB];
        default:
            return edgeSeparation(b, cache.indexA, cache.indexB);
    }
}

/// The axis of least overlap, with the hysteresis of kChoiceTolerance. `edge` receives the best edge pair (kind 0 when
/// none was worth a root). False when an axis separates by more than margin; it is in `face` then.
bool chooseAxis(const Boxes& b, float margin, const Choice& before, Choice& face, Choice& edge) {
    const float tolerance = kChoiceTolerance * b.size;
    for (int axis = 0; axis < 6; ++axis) {
        const int kind = axis < 3 ? 1 : 2, index = axis < 3 ? axis : axis - 3;
        const float s = kind == 1 ? b.faceA[index] : b.faceB[index];
        if (face.kind == 0 || s > face.separation) face = {kind, index, index, s};
        if (s > margin) return false;
    }
    if ((before.kind == 1 || before.kind == 2) && before.separation >= face.separation - tolerance) face = before;

    // An edge axis must beat the face by the tolerance unless it was the one before.
    float toBeat = face.separation + tolerance;
    if (before.kind == 3 && before.separation > face.separation) {
        edge = before;
        toBeat = before.separation + tolerance;
    }
    // gap / length ≤ gap for negative gaps: most axes need no root.
    const auto leastGap = [&toBeat] { return toBeat < 0 ? toBeat : 0; };
    for (int i = 0; i < 3; ++i) {
        const EdgeAxes axes = edgeAxes(b, i);
        unsigned worth = lanesWhere((axes.gap > leastGap()) & (axes.length2 > kParallelEdges));
        for (; worth != 0; worth &= worth - 1) {
            const int j = std::countr_zero(worth);
            if (axes.gap[j] <= leastGap()) continue;
            const float s = axes.gap[j] / std::sqrt(axes.length2[j]);
            if (s > margin) {
                face = {3, i, j, s};
                return false;
            }
            if (s > toBeat) {
                edge = {3, i, j, s};
                toBeat = s;
            }
        }
    }
    return true;
}

/// The incident box seen from the reference box.
struct FaceView {
    const float* hReference;
    const float* hIncident;
    float center[3];
    float columns[3][3];  ///< columns[j]: axis j of the incident box
    int axis;             ///< of the reference face
    float sign;
};

/// The other box seen from the one whose face is the reference.
FaceView viewFrom(const Boxes& b, bool flipped, int axis) {
    FaceView f;
    f.axis = axis;
    f.hReference = flipped ? b.hB : b.hA;
    f.hIncident = flipped ? b.hA : b.hB;
    for (int i = 0; i < 3; ++i) {
        f.center[i] = flipped ? -b.pB[i] : b.p[i];
        for (int j = 0; j < 3; ++j) f.columns[j][i] = flipped ? b.R[j][i] : b.R[i][j];
    }
    f.sign = f.center[axis] < 0 ? -1.0f : 1.0f;
    return f;
}

/// Of B's frame, in A's.
Mat3 rotationOf(const Boxes& b) {
    return {{b.R[0][0], b.R[1][0], b.R[2][0]}, {b.R[0][1], b.R[1][1], b.R[2][1]}, {b.R[0][2], b.R[1][2], b.R[2][2]}};
}

/// Contact points in the frame of the reference box; returns how many.
int clipFaces(const FaceView& f, float margin, float size, bool flipped, ManifoldPoint* out) {
    const int k = f.axis, k1 = after(k), k2 = after(k1);
    int j = 0;
    for (int other = 1; other < 3; ++other) {
        if (absolute(f.columns[other][k]) > absolute(f.columns[j][k])) j = other;
    }
    const int j1 = after(j), j2 = after(j1);
    const float facing = f.sign * f.columns[j][k] > 0 ? -1.0f : 1.0f;
    const auto along = [&](int component, float a, float b) {
        return f.center[component] + facing * f.hIncident[j] * f.columns[j][component] +
               a * f.hIncident[j1] * f.columns[j1][component] + b * f.hIncident[j2] * f.columns[j2][component];
    };
    static constexpr float kCorners[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    const float hu = f.hReference[k1], hv = f.hReference[k2], overhang = kOverhang * size;
    Corner buffers[2][12];
    Corner* polygon = buffers[0];
    int count = 4;
    float mostU = 0, mostV = 0;
    for (int i = 0; i < 4; ++i) {
        const float a = kCorners[i][0], b = kCorners[i][1];
        polygon[i] = {along(k1, a, b), along(k2, a, b), f.sign * along(k, a, b) - f.hReference[k],
                      static_cast<std::uint8_t>((i + 3) & 3), static_cast<std::uint8_t>(i)};
        mostU = absolute(polygon[i].u) > mostU ? absolute(polygon[i].u) : mostU;
        mostV = absolute(polygon[i].v) > mostV ? absolute(polygon[i].v) : mostV;
    }
    clipToRectangle(buffers[0], buffers[1], count, mostU, mostV, hu, hv, overhang);
    ClipPoint points[12];
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        if (polygon[i].w > margin) continue;
        ClipPoint& point = points[kept++];
        point.position[k] = f.sign * (f.hReference[k] + 0.5f * polygon[i].w);
        point.position[k1] = polygon[i].u;
        point.position[k2] = polygon[i].v;
        point.separation = polygon[i].w;
        point.in = polygon[i].in;
        point.out = polygon[i].out;
    }
    Vec3 normal;
    normal[k] = f.sign;
    if (kept > kMaxManifoldPoints) kept = reducePoints(points, kept, normal, kDepthTolerance * size);
    const int referenceFace = 2 * k + (f.sign > 0 ? 1 : 0), incidentFace = 2 * j + (facing > 0 ? 1 : 0);
    for (int i = 0; i < kept; ++i) {
        out[i] = {points[i].position, points[i].separation,
                  faceFeature(points[i], referenceFace, incidentFace, flipped)};
    }
    return kept;
}

void faceContact(const Boxes& b, const Frame& bInA, const Choice& choice, float margin, Manifold& out) {
    const bool flipped = choice.kind == 2;
    const FaceView f = viewFrom(b, flipped, flipped ? choice.j : choice.i);
    out.pointCount = clipFaces(f, margin, b.size, flipped, out.points);
    Vec3 normal;
    normal[f.axis] = f.sign;
    if (!flipped) {
        out.normal = normal;
        return;
    }
    const Mat3 rotation = rotationOf(b);
    out.normal = -(rotation * normal);
    for (int i = 0; i < out.pointCount; ++i) {
        out.points[i].position = bInA.position + rotation * out.points[i].position;
    }
}

/// The edges that lie farthest along the axis; one point between them.
void edgeContact(const Boxes& b, const Choice& choice, float margin, Manifold& out) {
    const int i = choice.i, j = choice.j, i1 = after(i), i2 = after(i1);
    float n[3] = {};
    n[i1] = -b.R[i2][j];
    n[i2] = b.R[i1][j];
    float along = 0;
    for (int c = 0; c < 3; ++c) along += n[c] * b.p[c];
    const float scale = (along < 0 ? -1.0f : 1.0f) / std::sqrt(n[i1] * n[i1] + n[i2] * n[i2]);
    float edgeA[3], edgeB[3] = {b.p[0], b.p[1], b.p[2]}, d[3] = {}, e[3];
    int codeA = 0, codeB = 0;
    for (int c = 0; c < 3; ++c) {
        n[c] *= scale;
        const bool positive = c != i && n[c] > 0;
        edgeA[c] = positive ? b.hA[c] : -b.hA[c];
        codeA = 2 * codeA + (positive ? 1 : 0);
    }
    d[i] = 2 * b.hA[i];
    for (int k = 0; k < 3; ++k) {
        const float nB = n[0] * b.R[0][k] + n[1] * b.R[1][k] + n[2] * b.R[2][k];
        const bool positive = k != j && nB < 0;
        const float side = positive ? b.hB[k] : -b.hB[k];
        codeB = 2 * codeB + (positive ? 1 : 0);
        for (int c = 0; c < 3; ++c) edgeB[c] += side * b.R[c][k];
    }
    for (int c = 0; c < 3; ++c) e[c] = 2 * b.hB[j] * b.R[c][j];
    const ClosestOnSegments near = closestOnSegments(toVec3(edgeA), toVec3(d), toVec3(edgeB), toVec3(e));
    out.normal = toVec3(n);
    if (choice.separation > 0 && lengthSquared(near.pointB - near.pointA) > margin * margin) return;
    out.pointCount = 1;
    out.points[0] = {0.5f * (near.pointA + near.pointB), choice.separation, edgeFeature(8 * i + codeA, 8 * j + codeB)};
}

/// An edge that lies nearly in a face of the other box touches it along its whole way across: one point there lets the
/// other end fall for a step, and light boxes under great loads rock from end to end, ever deeper.
void addAlongEdges(const Boxes& b, const Frame& bInA, float margin, Manifold& out) {
    if (out.pointCount != 1) return;
    const Mat3 rotation = rotationOf(b);
    const Vec3 inA = out.normal, inB = -(transpose(rotation) * out.normal);
    const auto largest = [](const Vec3& n) {
        int axis = 0;
        for (int k = 1; k < 3; ++k) axis = absolute(n[k]) > absolute(n[axis]) ? k : axis;
        return axis;
    };
    const int axisA = largest(inA), axisB = largest(inB);
    const bool flipped = absolute(inB[axisB]) > absolute(inA[axisA]);
    FaceView f = viewFrom(b, flipped, flipped ? axisB : axisA);
    const Vec3 n = flipped ? inB : inA;
    f.sign = n[f.axis] < 0 ? -1.0f : 1.0f;
    const float cosine = absolute(n[f.axis]);
    ManifoldPoint points[kMaxManifoldPoints];
    const int count = clipFaces(f, margin * cosine, b.size, flipped, points);
    for (int i = 0; i < count; ++i) {
        const float ahead = points[i].separation;
        points[i].separation = ahead / cosine;
        points[i].position[f.axis] += 0.5f * f.sign * ahead;
        points[i].position -= 0.5f * points[i].separation * n;
        if (flipped) points[i].position = bInA.position + rotation * points[i].position;
    }
    takeAlongEdges({points, static_cast<std::size_t>(count)}, b.size, out);
}

}  // namespace

void boxes(const Vec3& halfExtentsA, const Vec3& halfExtentsB, const Frame& bInA, float margin, SeparationCache& cache,
           Manifold& out) {
    out.pointCount = 0;
    const Boxes b = prepare(halfExtentsA, halfExtentsB, bInA);
    Choice before;
    if (cache.kind != 0) {
        before = {cache.kind, cache.indexA, cache.indexB, separationOf(b, cache)};
        if (before.separation > margin) {
            cache.separation = before.separation;
            return;
        }
    }
    Choice face, edge;
    if (!chooseAxis(b, margin, before, face, edge)) {
        remember(cache, face);
        return;
    }
    if (edge.kind != 0 && favoursFace(face.separation, edge.separation)) {
        faceContact(b, bInA, face, margin, out);
        if (showsDepth(out, edge.separation)) return remember(cache, face);
        out.pointCount = 0;
    }
    const Choice& best = edge.kind != 0 ? edge : face;
    remember(cache, best);
    if (best.kind == 3) {
        edgeContact(b, best, margin, out);
        addAlongEdges(b, bInA, margin, out);
    } else {
        faceContact(b, bInA, best, margin, out);
    }
    if (out.pointCount > 0) return;
    // Corner regions, where no axis of the fifteen is the direction of the distance, or hysteresis kept an axis whose
    // faces no longer face each other.
    const ConvexView viewA{ConvexKind::box, 0, halfExtentsA, nullptr}, viewB{ConvexKind::box, 0, halfExtentsB, nullptr};
    const gjk::CoreSupport supportA{&viewA};
    const gjk::PlacedCoreSupport supportB(viewB, bInA);
    const gjk::Closest cores = gjk::closest(supportA, supportB, -bInA.position);
    if (cores.overlap) {
        commonPoint(out.normal, best.separation, cores.pointB, out);
    } else {
        closestPoint(cores, 0, 0, margin, kPointFeature, out);
    }
}

}  // namespace ragtop::pairs
