#include "world/shape_queries.h"

#include <cmath>

#include "broadphase/swept_box.h"
#include "shapes/geometry.h"

namespace ragtop {

namespace {

/// The nearest hit among triangles; of equally near ones the first met.
struct Nearest {
    float closer;
    SweepHit hit{};
    std::uint32_t triangle = 0;

    void offer(const SweepHit& other, std::uint32_t index) {
        if (!other.hit || other.fraction > closer || (hit.hit && other.fraction >= closer)) return;
        hit = other;
        closer = other.fraction;
        triangle = index;
    }
    bool done() const { return hit.hit && closer <= 0; }
};

/// Offers test(view, closer) for each triangle that the box may meet. Nearer branches come first.
template <class Test>
void castAtTriangles(const MeshData& mesh, const SweptBox& box, Nearest& nearest, const Test& test) {
    struct Waiting {
        std::uint32_t first, count;  ///< as in MeshBranch
        float enter;
    };
    Waiting waiting[kMostWaiting];
    int count = 0;
    // In front of those that are entered sooner, and of equal ones that come before it.
    const auto push = [&](const Waiting& child, int bottom) {
        int at = count++;
        for (; at > bottom && waiting[at - 1].enter <= child.enter; --at) waiting[at] = waiting[at - 1];
        waiting[at] = child;
    };
    if (const float enter = box.enter(mesh.bounds, nearest.closer); enter != SweptBox::kMiss) push({0, 0, enter}, 0);
    while (count > 0 && !nearest.done()) {
        const Waiting next = waiting[--count];
        if (next.enter > nearest.closer * (1 + 8 * SweptBox::kEpsilon)) continue;
        if (next.count == 0) {
            const MeshBranch& branch = mesh.branches[next.first];
            const int bottom = count, children = branch.children();
            for (int i = 0; i < children; ++i)
                if (const float enter = box.enter(branch.bounds(i), nearest.closer); enter != SweptBox::kMiss)
                    push({branch.first[i], branch.count[i], enter}, bottom);
        }
        for (std::uint32_t i = next.first; i < next.first + next.count && !nearest.done(); ++i) {
            const TriangleView view = triangleOf(mesh, i);
            if (box.enter(boundsOfTriangle(view.a, view.b, view.c), nearest.closer) == SweptBox::kMiss) continue;
            nearest.offer(test(view, nearest.closer), view.index);
        }
    }
}

/// The same on a grid: the part of the way over the field is walked in pieces about as long as a cell, or as the box,
/// so that the bounds of each piece hold few cells.
template <class Test>
void castAtTriangles(const HeightFieldData& field, const SweptBox& box, Nearest& nearest, const Test& test) {
    const Bounds all{{0, field.lowest, 0},
                     {static_cast<float>(field.columns - 1) * field.spacing, field.highest,
                      static_cast<float>(field.rows - 1) * field.spacing}};
    float from = 0;
    float to = nearest.closer;
    if (!box.clip(all, from, to)) return;
    const Vec3 size = abs(box.translation);
    const float way = (to - from) * (size.x > size.z ? size.x : size.z);
    const float width = 2 * (box.extents.x > box.extents.z ? box.extents.x : box.extents.z);
    const float pieces = std::floor(way / (width > field.spacing ? width : field.spacing)) + 1;
    // The ends of the pieces are rounded.
    const Vec3 reach = box.extents + 8 * SweptBox::kEpsilon * (abs(box.origin) + size);
    for (float piece = 0; piece < pieces; ++piece) {
        const float start = from + (to - from) * (piece / pieces);
        const float end = from + (to - from) * ((piece + 1) / pieces);
        if (start > nearest.closer || nearest.done()) return;
        const Vec3 a = box.origin + start * box.translation;
        const Vec3 b = box.origin + end * box.translation;
        forEachTriangle(field, {min(a, b) - reach, max(a, b) + reach}, [&](const TriangleView& view) {
            if (box.enter(boundsOfTriangle(view.a, view.b, view.c), nearest.closer) != SweptBox::kMiss) {
                nearest.offer(test(view, nearest.closer), view.index);
            }
            return !nearest.done();
        });
    }
}

template <class Test>
SweepHit nearestTriangle(const Shape& target, const SweptBox& box, float closer, std::uint32_t& triangle,
                         const Test& test) {
    Nearest nearest{closer};
    if (const auto* mesh = std::get_if<TriangleMesh>(&target)) {
        castAtTriangles(mesh->data(), box, nearest, test);
    } else {
        castAtTriangles(std::get<HeightField>(target).data(), box, nearest, test);
    }
    if (nearest.hit.hit) triangle = nearest.triangle;
    return nearest.hit;
}

bool isOfTriangles(const Shape& shape) {
    return std::holds_alternative<TriangleMesh>(shape) || std::holds_alternative<HeightField>(shape);
}

}  // namespace

SweepHit castRayAtShape(const Shape& target, const Pose& pose, const Ray& ray, float closer, std::uint32_t& triangle) {
    const Vec3 origin = inverseTransformPoint(pose, ray.origin);
    const Vec3 translation = inverseRotate(pose.rotation, ray.translation);
    if (!isOfTriangles(target)) return castRay(convexView(target), origin, translation, closer);
    return nearestTriangle(
        target, SweptBox(origin, translation, {}), closer, triangle,
        [&](const TriangleView& view, float limit) { return castRay(view, origin, translation, limit); });
}

SweepHit sweepShapeAtShape(const Shape& moving, const Quat& rotation, const Ray& path, const Shape& target,
                           const Pose& targetPose, float closer, std::uint32_t& triangle) {
    const ConvexView view = convexView(moving);
    const Frame start = relative(targetPose, Pose{path.origin, rotation});
    const Vec3 translation = inverseRotate(targetPose.rotation, path.translation);
    if (!isOfTriangles(target)) return sweep(convexView(target), view, start, translation, closer);
    const Bounds bounds = boundsOf(moving, start);
    const Vec3 center = 0.5f * (bounds.lower + bounds.upper);
    const Vec3 halfSize = max(bounds.upper - center, center - bounds.lower);
    return nearestTriangle(
        target, SweptBox(center, translation, halfSize), closer, triangle,
        [&](const TriangleView& face, float limit) { return sweep(face, view, start, translation, limit); });
}

bool overlapsShape(const Shape& query, const Pose& queryPose, const Shape& target, const Pose& targetPose) {
    const ConvexView view = convexView(query);
    const Frame frame = relative(targetPose, queryPose);
    if (!isOfTriangles(target)) return distance(convexView(target), view, frame).distance <= 0;
    bool touches = false;
    const auto test = [&](const TriangleView& face) {
        touches = distance(face, view, frame).distance <= 0;
        return !touches;
    };
    const Bounds bounds = boundsOf(query, frame);
    if (const auto* mesh = std::get_if<TriangleMesh>(&target)) {
        forEachTriangle(mesh->data(), bounds, test);
    } else {
        forEachTriangle(std::get<HeightField>(target).data(), bounds, test);
    }
    return touches;
}

}  // namespace ragtop
