#include "narrowphase/edge_normal.h"
#include "narrowphase/pairs.h"

namespace ragtop::pairs {
namespace {

/// Is the axis of the last step still separating by more than margin? Any direction proves it, so B stays in its own
/// frame and nothing else is looked at.
bool stillSeparated(const HullView& a, const HullView& b, const Frame& bInA, float margin, SeparationCache& cache) {
    const auto iA = static_cast<std::size_t>(indexA(cache)), iB = static_cast<std::size_t>(indexB(cache));
    Vec3 n;
    if (cache.kind == 1 && iA < a.planes.size()) {
        n = a.planes[iA].normal;
    } else if (cache.kind == 2 && iB < b.planes.size()) {
        n = rotate(bInA.rotation, -b.planes[iB].normal);
    } else if (cache.kind == 3 && iA < a.edges.size() && iB < b.edges.size()) {
        const HullData::Edge& edgeA = a.edges[iA];
        const HullData::Edge& edgeB = b.edges[iB];
        n = normalized(cross(a.vertices[edgeA.to] - a.vertices[edgeA.from],
                             rotate(bInA.rotation, b.vertices[edgeB.to] - b.vertices[edgeB.from])));
        if (dot(n, transformPoint(bInA, b.center) - a.center) < 0) n = -n;
    } else {
        return false;
    }
    const Vec3 nB = inverseRotate(bInA.rotation, n);
    float highA = dot(a.vertices[0], n), lowB = dot(b.vertices[0], nB);
    for (const Vec3& vertex : a.vertices) {
        const float height = dot(vertex, n);
        highA = height > highA ? height : highA;
    }
    for (const Vec3& vertex : b.vertices) {
        const float height = dot(vertex, nB);
        lowB = height < lowB ? height : lowB;
    }
    const float separation = lowB + dot(n, bInA.position) - highA;
    if (!(separation > margin)) return false;
    cache.separation = separation;
    return true;
}

void edgeContact(const HullView& a, const HullView& b, const SeparatingAxis& axis, float margin, Manifold& out) {
    const HullData::Edge& edgeA = a.edges[static_cast<std::size_t>(axis.indexA)];
    const HullData::Edge& edgeB = b.edges[static_cast<std::size_t>(axis.indexB)];
    const Vec3 pA = a.vertices[edgeA.from], pB = b.vertices[edgeB.from];
    const ClosestOnSegments near = closestOnSegments(pA, a.vertices[edgeA.to] - pA, pB, b.vertices[edgeB.to] - pB);
    if (axis.separation > 0 && lengthSquared(near.pointB - near.pointA) > margin * margin) return;
    out.normal = axis.normal;
    out.pointCount = 1;
    out.points[0] = {0.5f * (near.pointA + near.pointB), axis.separation, edgeFeature(axis.indexA, axis.indexB)};
}

/// As of boxes (collide_boxes.cpp).
void addAlongEdges(const HullView& a, const HullView& b, const SeparatingAxis& axis, float margin, float size,
                   Manifold& out) {
    if (out.pointCount != 1 || out.points[0].feature != edgeFeature(axis.indexA, axis.indexB)) return;
    const HullData::Edge& edgeA = a.edges[static_cast<std::size_t>(axis.indexA)];
    const HullData::Edge& edgeB = b.edges[static_cast<std::size_t>(axis.indexB)];
    bool flipped = false;
    int face = 0;
    constexpr float kLeaning = 0.8f;  // of faces that lean more no other corner is near, and clipping hulls is dear
    float cosine = kLeaning;
    const auto look = [&](const HullView& hull, std::uint8_t index, const Vec3& n, bool isB) {
        const float each = dot(hull.planes[index].normal, n);
        if (each > cosine) cosine = each, face = index, flipped = isB;
    };
    for (const std::uint8_t index : {edgeA.leftFace, edgeA.rightFace}) look(a, index, axis.normal, false);
    for (const std::uint8_t index : {edgeB.leftFace, edgeB.rightFace}) look(b, index, -axis.normal, true);
    if (cosine == kLeaning) return;
    const HullView &reference = flipped ? b : a, &incident = flipped ? a : b;
    const Vec3 n = flipped ? -axis.normal : axis.normal,
               across = reference.planes[static_cast<std::size_t>(face)].normal;
    ManifoldPoint points[kMaxManifoldPoints];
    const int count = clipToFace(reference, face, incident, margin * cosine, size, flipped, points);
    for (int i = 0; i < count; ++i) {
        const float ahead = points[i].separation;
        points[i].separation = ahead / cosine;
        points[i].position += 0.5f * ahead * across - 0.5f * points[i].separation * n;
    }
    takeAlongEdges({points, static_cast<std::size_t>(count)}, size, out);
}

void faceContact(const HullView& a, const HullView& b, const SeparatingAxis& axis, float margin, float size,
                 Manifold& out) {
    out.normal = axis.normal;
    out.pointCount = axis.kind == 1 ? clipToFace(a, axis.indexA, b, margin, size, false, out.points)
                                    : clipToFace(b, axis.indexB, a, margin, size, true, out.points);
}

}  // namespace

void hullContact(const HullView& a, const HullView& b, const SeparatingAxis& axis, float margin, float size,
                 Manifold& out) {
    out.normal = axis.normal;
    out.pointCount = 0;
    if (axis.kind == 3)
        edgeContact(a, b, axis, margin, out);
    else
        faceContact(a, b, axis, margin, size, out);
    if (out.pointCount > 0) return;
    cornerContact(a.vertices, b.vertices, a.center - b.center, axis, margin, out);
}

/// Corner regions, where no axis of the test is the direction of the distance, or hysteresis kept an axis whose faces no
/// longer face each other.
void cornerContact(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& apart, const SeparatingAxis& axis,
                   float margin, Manifold& out) {
    const gjk::PointsSupport supportA{a.data(), static_cast<int>(a.size())};
    const gjk::PointsSupport supportB{b.data(), static_cast<int>(b.size())};
    const gjk::Closest cores = gjk::closest(supportA, supportB, apart);
    if (cores.overlap) {
        commonPoint(axis.normal, axis.separation, cores.pointB, out);
    } else {
        closestPoint(cores, 0, 0, margin, kPointFeature, out);
    }
}

namespace {

/// The contact along the axis that was chosen, or along the best face where that serves better than an edge pair;
/// returns the axis that it is of.
SeparatingAxis contactAlong(const HullView& a, const HullView& b, const AxisChoice& choice, float margin, float size,
                            Manifold& out) {
    const SeparatingAxis& axis = choice.best;
    if (choice.face.kind != 0 && favoursFace(choice.face.separation, axis.separation)) {
        faceContact(a, b, choice.face, margin, size, out);
        if (showsDepth(out, axis.separation)) return choice.face;
    }
    hullContact(a, b, axis, margin, size, out);
    return axis;
}

/// Does a face of before stay although the corner that is deepest below it is beside it, so that no point shows how
/// deep the hulls are in each other? Another face is as good an axis, and has that corner.
bool hidesDepth(const SeparatingAxis& axis, const SeparatingAxis& before, const Manifold& found, float size) {
    const bool stays =
        axis.kind != 3 && axis.kind == before.kind && axis.indexA == before.indexA && axis.indexB == before.indexB;
    return stays && axis.separation < 0 && !showsDepth(found, axis.separation + kDepthTolerance * size);
}

}  // namespace

void hulls(const HullView& a, const HullView& b, const Frame& bInA, float margin, SeparationCache& cache,
           Manifold& out) {
    out.pointCount = 0;
    if (cache.kind != 0 && stillSeparated(a, b, bInA, margin, cache)) {
        out.gap = cache.separation;
        return;
    }
    const PlacedHull placed(b, bInA);
    const float size = a.innerRadius < b.innerRadius ? a.innerRadius : b.innerRadius;
    SeparatingAxis before;
    if (cache.kind != 0) before = alongAxis(a, placed.view(), cache.kind, indexA(cache), indexB(cache));
    AxisChoice choice = chooseAxis(a, placed.view(), margin, size, before);
    cache = toCache(choice.best);
    if (choice.best.separation > margin) {
        out.gap = choice.best.separation;
        return;
    }
    SeparatingAxis axis = contactAlong(a, placed.view(), choice, margin, size, out);
    if (hidesDepth(axis, before, out, size)) {
        choice = chooseAxis(a, placed.view(), margin, size, {});
        axis = contactAlong(a, placed.view(), choice, margin, size, out);
    }
    cache = toCache(axis);
    if (choice.best.kind != axis.kind) return;
    if (axis.kind == 3) addAlongEdges(a, placed.view(), axis, margin, size, out);
    if (axis.kind == 1) turnToMiddle(a, axis.indexA, placed.view(), size, out);
    if (axis.kind == 2) turnToMiddle(placed.view(), axis.indexB, a, size, out);
}

}  // namespace ragtop::pairs
