#include "contacts/yielding_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "broadphase/broadphase.h"

namespace ragtop {

namespace {

constexpr float kAlong = 0.1f;  ///< sine below the middle of a shape, seen from it, of what it goes over along its way
constexpr float kSide = 0.9f;   ///< cosine to the axle of a push on the side

/// Does a contact push a round shape along its way? It does where all of it is below the middle, whatever side of the
/// shape's hull it meets, and however deep: a push along the axle meets the side of a wheel. `pushed` is its direction
/// and `toShape` takes its places to the frame of the shape.
template <class ToShape>
bool isAlongWay(const Manifold& manifold, const Vec3& pushed, ToShape&& toShape) {
    if (manifold.pointCount == 0 || !(std::abs(pushed.x) < kSide)) return false;
    return std::ranges::all_of(manifold.all(), [&](const ManifoldPoint& point) {
        const Vec3 place = toShape(point.position);
        return -place.y > kAlong * std::sqrt(place.y * place.y + place.z * place.z);
    });
}

/// Of how far a shape reaches from its middle along its way: a step that it goes over, as a tire does over what it is
/// squashed by.
constexpr float kLowStep = 0.05f;
constexpr float kFaces = 0.5f;  ///< cosine to the way, of a face from which nothing leads beside it

float furthestAlong(const ConvexView& shape, const Vec3& direction) {
    if (shape.kind != ConvexKind::hull) return dot(abs(direction), shape.halfExtents) + shape.radius;
    float most = dot(shape.hull->vertices[0], direction);
    for (const Vec3& vertex : shape.hull->vertices) most = std::max(most, dot(vertex, direction));
    return most;
}

/// The face of a box or hull that looks along a way; of others none.
Plane faceAlong(const ConvexView& obstacle, const Vec3& way) {
    Plane best;
    float most = kFaces;
    const auto offer = [&](const Plane& plane) {
        if (!(dot(plane.normal, way) > most)) return;
        most = dot(plane.normal, way);
        best = plane;
    };
    if (obstacle.kind == ConvexKind::hull)
        for (const Plane& plane : obstacle.hull->planes) offer(plane);
    if (obstacle.kind == ConvexKind::box)
        for (const float sign : {-1.0f, 1.0f}) {
            offer({{sign, 0, 0}, obstacle.halfExtents.x});
            offer({{0, sign, 0}, obstacle.halfExtents.y});
            offer({{0, 0, sign}, obstacle.halfExtents.z});
        }
    return best;
}

/// Does no more of an obstacle than a step lie beside the end of a shape that gives way? Then what meets there from the
/// side, as the next slab of a floor, is what the shape stands on, and its contacts along the way are left out.
bool goesOver(const ConvexView& shape, const Frame& inObstacle, const ConvexView& obstacle) {
    const Plane face = faceAlong(obstacle, rotate(inObstacle.rotation, {0, 1, 0}));
    if (face.normal == Vec3{}) return false;
    const float deep = furthestAlong(shape, inverseRotate(inObstacle.rotation, -face.normal)) -
                       (dot(inObstacle.position, face.normal) - face.offset);
    return deep <= kLowStep * furthestAlong(shape, {0, -1, 0});
}

bool goesOver(const Shapes& shapes, const ShapeRecord& shape, const ShapeRecord& obstacle, const Frame& inObstacle) {
    const GeometryEntry &own = shapes.geometryOf(shape), &other = shapes.geometryOf(obstacle);
    return shape.givesWay && !own.isMesh() && !other.isMesh() && goesOver(own.convex, inObstacle, other.convex);
}

/// Bounds of a convex shape by the box about it in its own frame, which is larger where it is turned.
Bounds boundsAround(const ConvexView& shape, const Frame& frame) {
    const bool isHull = shape.kind == ConvexKind::hull;
    const Vec3 reach = shape.halfExtents + Vec3{shape.radius, shape.radius, shape.radius};
    const Bounds own = isHull ? shape.hull->bounds : Bounds{-reach, reach};
    const Mat3 axes = toMat3(frame.rotation);
    const Vec3 middle = frame.position + axes * (0.5f * (own.lower + own.upper)), half = 0.5f * (own.upper - own.lower);
    const Vec3 most = half.x * abs(axes.cx) + half.y * abs(axes.cy) + half.z * abs(axes.cz);
    return {middle - most, middle + most};
}

bool hasBorder(const std::array<std::uint32_t, 3>& neighbours) {
    return std::ranges::find(neighbours, kNoTriangle) != neighbours.end();
}

}  // namespace

bool facesAlong(const MeshData& mesh, const Bounds& near, const Vec3& way) {
    bool faces = true;
    walkTriangles(mesh, near, [&](std::uint32_t i, const TriangleView& triangle) {
        return faces = dot(triangle.normal, way) > kFaces && !hasBorder(mesh.neighbours[i]);
    });
    return faces;
}

bool facesAlong(const HeightFieldData& field, const Bounds& near, const Vec3& way) {
    const CellRange columns = cellsMeeting(near.lower.x, near.upper.x, field.spacing, field.columns - 1);
    const CellRange rows = cellsMeeting(near.lower.z, near.upper.z, field.spacing, field.rows - 1);
    if (columns.first < 1 || columns.last > field.columns - 3 || rows.first < 1 || rows.last > field.rows - 3)
        return false;
    for (int row = rows.first; row <= rows.last; ++row) {
        const std::size_t first = 2 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns - 1) +
                                       static_cast<std::size_t>(columns.first));
        const std::size_t end = first + 2 * static_cast<std::size_t>(columns.last - columns.first + 1);
        for (std::size_t i = first; i < end; ++i)
            if (!(dot(field.normals[i], way) > kFaces)) return false;  // as of a hole, which has none
    }
    return true;
}

bool yieldsToAll(const Shapes& shapes, const ContactRecord& record, const Frame& bInA, float margin) {
    const ShapeRecord& b = shapes[record.shapeB];
    const GeometryEntry &surface = shapes.geometryOf(shapes[record.shapeA]), &shape = shapes.geometryOf(b);
    if (!b.givesWay || !surface.isMesh() || shape.isMesh()) return false;
    const Bounds near = enlarged(boundsAround(shape.convex, bInA), 2 * margin);
    const Vec3 way = rotate(bInA.rotation, {0, 1, 0});
    return surface.field ? facesAlong(*surface.field, near, way) : facesAlong(*surface.mesh, near, way);
}

int keepUnyielding(const Shapes& shapes, const ContactRecord& record, const Frame& bInA, std::span<Manifold> found) {
    const ShapeRecord &a = shapes[record.shapeA], &b = shapes[record.shapeB];
    const int count = static_cast<int>(found.size());
    if (!a.givesWay && !b.givesWay) return count;
    int kept = 0;
    for (const Manifold& manifold : found) {
        const bool yields = (a.givesWay && isAlongWay(manifold, manifold.normal, [](const Vec3& at) { return at; })) ||
                            (b.givesWay && isAlongWay(manifold, inverseRotate(bInA.rotation, manifold.normal),
                                                      [&](const Vec3& at) { return inverseTransformPoint(bInA, at); }));
        if (!yields) found[static_cast<std::size_t>(kept++)] = manifold;
    }
    if (kept > 0 && (goesOver(shapes, b, a, bInA) || goesOver(shapes, a, b, inverse(bInA)))) kept = 0;
    if (kept == 0 && count > 0) found[0].gap = 0;
    return kept;
}

}  // namespace ragtop
