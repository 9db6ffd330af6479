#include "continuous/meetings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contacts/tuning.h"
#include "narrowphase/collide.h"
#include "narrowphase/distance.h"
#include "narrowphase/triangle_contact.h"

namespace ragtop {

namespace {

/// Surfaces stay so many margins apart; going less far into each other is left to their contact.
constexpr float kTarget = 0.25f;

/// What no surface may get into, even of a shape that touches it already: the shape without half of its thickness.
struct SolidCore {
    ConvexView view;
    Vec3 center;  ///< in the frame of the shape
};

SolidCore coreOf(const GeometryEntry& geometry) {
    ConvexView view = geometry.convex;
    switch (view.kind) {
        case ConvexKind::sphere:
        case ConvexKind::capsule:
            view.radius *= 0.5f;
            return {view, {}};
        case ConvexKind::box: {
            const float half = 0.5f * geometry.size;
            view.halfExtents -= Vec3{half, half, half};
            return {view, {}};
        }
        case ConvexKind::hull:
            break;
    }
    return {convexView(Sphere{0.5f * geometry.size}), view.hull->center};
}

/// How far a point of the moving shape, given where it is at a share of the way, goes against a normal in the rest.
float wayAgainst(const Vec3& normal, const Vec3& point, float fraction, const Frame& from, const Frame& to) {
    const Frame there = SweptMotion(from, to).at(fraction);
    return dot(normal, point - transformPoint(to, inverseTransformPoint(there, point)));
}

bool isDeep(const Manifold& touch, float allowed) {
    bool deep = false;
    for (int j = 0; j < touch.pointCount; ++j) deep |= touch.points[j].separation < -allowed;
    return deep;
}

/// The points of a contact that go deeper than is allowed in what is left of the way.
void keepDeepening(Manifold& touch, const Frame& from, const Frame& to, float allowed) {
    int kept = 0;
    for (int j = 0; j < touch.pointCount; ++j) {
        const ManifoldPoint& point = touch.points[j];
        const float room = point.separation > 0 ? point.separation : 0.0f;
        if (wayAgainst(touch.normal, point.position, 0, from, to) > room + allowed) touch.points[kept++] = point;
    }
    touch.pointCount = kept;
}

Manifold pointContact(const SweepHit& hit) {
    Manifold touch;
    touch.normal = hit.normal;
    touch.pointCount = 1;
    touch.points[0].position = hit.point;
    return touch;
}

/// Corners of a shape's core.
template <class Visit>
void forEachCorner(const ConvexView& shape, Visit&& visit) {
    const Vec3& h = shape.halfExtents;
    if (shape.kind == ConvexKind::sphere) {
        visit(Vec3{});
    } else if (shape.kind == ConvexKind::capsule) {
        visit(h), visit(-h);
    } else if (shape.kind == ConvexKind::box) {
        for (int i = 0; i < 8; ++i)
            visit(Vec3{(i & 1) != 0 ? h.x : -h.x, (i & 2) != 0 ? h.y : -h.y, (i & 4) != 0 ? h.z : -h.z});
    } else {
        for (const Vec3& vertex : shape.hull->vertices) visit(vertex);
    }
}

bool isOver(const TriangleView& t, const Vec3& point) {
    return dot(cross(t.normal, t.b - t.a), point - t.a) >= 0 && dot(cross(t.normal, t.c - t.b), point - t.b) >= 0 &&
           dot(cross(t.normal, t.a - t.c), point - t.c) >= 0;
}

/// Adds the corners of a shape that go behind a plane where `isFace` says it is the obstacle's face, the deepest at the
/// end first to stay.
template <class IsFace>
void addCorners(Manifold& touch, const Vec3& onPlane, const ConvexView& shape, const Frame& from, const Frame& to,
                IsFace&& isFace) {
    float ends[kMaxManifoldPoints] = {};
    for (int j = 0; j < touch.pointCount; ++j)
        ends[j] = touch.points[j].separation - wayAgainst(touch.normal, touch.points[j].position, 0, from, to);
    const Vec3 skin = shape.radius * touch.normal;
    forEachCorner(shape, [&](const Vec3& corner) {
        const Vec3 start = transformPoint(from, corner) - skin, end = transformPoint(to, corner) - skin;
        const float height = dot(touch.normal, start - onPlane), last = dot(touch.normal, end - onPlane);
        if (last >= 0) return;
        const float share = height > 0 ? height / (height - last) : 0.0f;
        if (!isFace(start + share * (end - start))) return;
        int place = touch.pointCount;
        if (place == kMaxManifoldPoints) {
            place = 0;
            for (int j = 1; j < kMaxManifoldPoints; ++j) place = ends[j] > ends[place] ? j : place;
            if (last >= ends[place]) return;
        } else {
            ++touch.pointCount;
        }
        ends[place] = last;
        touch.points[place] = {start - 0.5f * height * touch.normal, height, 0};
    });
}

/// What of a shape touches a convex obstacle, or will on the rest of its way.
Manifold touchOf(const ConvexView& obstacle, const ConvexView& shape, const Frame& from, const Frame& to,
                 float margin) {
    Manifold touch;
    SeparationCache cache;
    collide(obstacle, shape, from, margin, cache, touch);
    if (touch.pointCount == 0) return touch;
    const ManifoldPoint& first = touch.points[0];
    const ConvexView point = convexView(Sphere{0.1f * margin});
    addCorners(touch, first.position - 0.5f * first.separation * touch.normal, shape, from, to, [&](const Vec3& at) {
        return distance(obstacle, point, {at, {}}).distance <= 0;
    });
    return touch;
}

/// The same of a triangle, whose face alone counts.
Manifold touchOf(const TriangleView& t, const ConvexView& shape, const Frame& from, const Frame& to, float) {
    Manifold touch;
    touch.normal = t.normal;
    touch.triangle = t.index;
    addCorners(touch, t.a, shape, from, to, [&](const Vec3& at) { return isOver(t, at); });
    return touch;
}

/// May a surface push along a direction? A triangle does not from behind.
bool mayPush(const ConvexView&, const Vec3&) { return true; }
bool mayPush(const TriangleView& t, const Vec3& normal) {
    constexpr float kBehind = 0.01f;  // sine, of rounding
    return dot(normal, t.normal) > -kBehind;
}

/// A shape at a place, ready to be compared with many planes.
struct PlacedShape {
    const ConvexView& shape;
    Vec3 position;
    Mat3 axes;

    PlacedShape(const ConvexView& placed, const Frame& at)
        : shape(placed), position(at.position), axes(toMat3(at.rotation)) {}
};

/// How far a shape is above the plane of a triangle.
float heightOver(const TriangleView& t, const PlacedShape& placed) {
    const ConvexView& shape = placed.shape;
    const float height = dot(t.normal, placed.position - t.a) - shape.radius;
    const Vec3 normal = transposeTimes(placed.axes, t.normal);
    if (shape.kind == ConvexKind::box) return height - dot(abs(normal), shape.halfExtents);
    return height + dot(normal, supportOfCore(shape, -normal));
}

/// Turns a meeting with a flat or concave edge of a triangle, or with a corner between two, to the face: what lies
/// there is met by neighbours, which would push along their own faces. False where the point that is met does not come
/// nearer to the face and nothing ends behind it by more than is allowed.
bool turnToFace(const ConvexView&, const ConvexView&, const Frame&, const Frame&, float, SweepHit&) { return true; }
bool turnToFace(const TriangleView& t, const ConvexView& shape, const Frame& from, const Frame& to, float allowed,
                SweepHit& hit) {
    const TriangleHull hull(t, hit.point);
    const Feature feature = featureAlong(hull, hit.normal);
    const int before = feature.index == 0 ? 2 : feature.index - 1;
    if (feature.kind == Feature::face || edgeIsActive(hull, feature.index)) return true;
    if (feature.kind == Feature::vertex && edgeIsActive(hull, before)) return true;
    const Vec3 turn = rotationVector(to.rotation * conjugate(from.rotation));
    const Vec3 arm = hit.point - SweptMotion(from, to).at(hit.fraction).position;
    if (!(dot(t.normal, to.position - from.position + cross(turn, arm)) < 0))
        return heightOver(t, PlacedShape(shape, to)) < -allowed;
    hit.normal = t.normal;
    return true;
}

/// Does a shape stay in front of the plane of a triangle, by more than where it would touch, or go away from it?
/// Between its ends a point of it leaves its chord by `bulge` at most.
bool cannotMeet(const TriangleView& t, const PlacedShape& from, const PlacedShape& to, float bulge, float target) {
    constexpr float kMore = 2;  // targets, for the rounding
    const float first = heightOver(t, from), last = heightOver(t, to);
    return std::min(first, last) > bulge + kMore * target || last - first >= 2 * bulge;
}

/// How far a shape, or its core, is above a face of a box, from −1 or 1 along an axis.
float heightOver(const ConvexView& box, int axis, float side, const ConvexView& shape, const Frame& at) {
    Vec3 up;
    up[axis] = side;
    const Vec3 upInShape = inverseRotate(at.rotation, up);
    return side * at.position[axis] - box.halfExtents[axis] - shape.radius +
           dot(upInShape, supportOfCore(shape, -upInShape));
}

/// Does a shape go along a face of a box, or over it? Its core stays in front of it, between its ends too, where a
/// point leaves its chord by `bulge` at most, and it ends no deeper behind it than is allowed, as it began: nothing
/// that is asked of it below would find that they meet.
bool passesAlong(const ConvexView& box, const ConvexView& shape, const SolidCore& core, const Frame& from,
                 const Frame& to, float bulge, float allowed) {
    if (box.kind != ConvexKind::box) return false;
    int axis = 0;
    float side = 1, highest = -std::numeric_limits<float>::infinity();
    for (int i = 0; i < 3; ++i) {
        const float facing = from.position[i] < 0 ? -1.0f : 1.0f, height = heightOver(box, i, facing, shape, from);
        if (height > highest) highest = height, axis = i, side = facing;
    }
    const auto ofCore = [&](const Frame& at) {
        return heightOver(box, axis, side, core.view, {transformPoint(at, core.center), at.rotation});
    };
    return highest >= -allowed && heightOver(box, axis, side, shape, to) >= -allowed &&
           std::min(ofCore(from), ofCore(to)) > bulge;
}

/// Is a ball surely away from all bounds of a tree along its way? In doubles, which need no rounding to either side.
bool isAwayFrom(const BoundsTree& tree, const DVec3& from, const DVec3& to, float radius) {
    constexpr double kMore = 1 + 1e-5;  // radii are floats: eighty roundings
    if (tree.empty()) return true;
    const Bounds& all = tree.bounds();
    const double reach = kMore * static_cast<double>(radius);
    const auto beside = [reach](double a, double b, float lower, float upper) {
        return (a < b ? b : a) + reach < static_cast<double>(lower) ||
               (a < b ? a : b) - reach > static_cast<double>(upper);
    };
    return beside(from.x, to.x, all.lower.x, all.upper.x) || beside(from.y, to.y, all.lower.y, all.upper.y) ||
           beside(from.z, to.z, all.lower.z, all.upper.z);
}

/// Between its ends a point of a shape at r that turns by θ leaves its chord by r (1 − cos θ/2) at most.
float bulgeOf(const BodyRecord& body, const Quat& from, const Quat& to) {
    return body.travel.coreRadius * (1 - std::abs((to * conjugate(from)).w));
}

/// Does a body go along a face of what stands still, as firstMeeting would find?
bool passesAlong(const Bodies& bodies, const Shapes& shapes, std::uint32_t index, const Pose& start,
                 std::uint32_t obstacle) {
    const BodyRecord& body = bodies[index];
    const ShapeRecord& other = shapes[obstacle];
    if (other.sensor) return true;
    const GeometryEntry& solid = shapes.geometryOf(other);
    if (solid.isMesh()) return false;
    const BodyRecord& holder = bodies[other.body];
    const Pose end{body.center, body.rotation}, place = Pose{holder.center, holder.rotation} * other.frame;
    const float bulge = bulgeOf(body, start.rotation, end.rotation);
    for (std::uint32_t s = body.firstShape; s != kNone; s = shapes[s].next) {
        const ShapeRecord& shape = shapes[s];
        const GeometryEntry& geometry = shapes.geometryOf(shape);
        if (shape.sensor || shape.givesWay || geometry.field) continue;
        const float allowed = 2 * kTarget * tuning::kSpeculative * shape.size;
        if (geometry.mesh ||
            !passesAlong(solid.convex, geometry.convex, coreOf(geometry), seenFrom(place, start * shape.frame),
                         seenFrom(place, end * shape.frame), bulge, allowed))
            return false;
    }
    return true;
}

}  // namespace

bool mayMeet(const Bodies& bodies, const Shapes& shapes, const Broadphase& broadphase, std::uint32_t index,
             const Pose& start, float dt) {
    constexpr float kAtOnce = 1.4f;  // rad, of a step that is swept in one piece
    const BodyRecord& body = bodies[index];
    if (!body.options.bullet && isAwayFrom(broadphase.fixedTree, start.position, body.center, body.radius))
        return false;
    const Bounds path = boundsOfPath(start.position, body.center, body.radius);
    const bool whole = dt * length(bodies.states[index].w) < kAtOnce || body.travel.coreRadius == 0;
    bool found = false;
    const auto visit = [&](std::uint32_t shape) {
        found = shapes[shape].body != index && !(whole && passesAlong(bodies, shapes, index, start, shape));
        return !found;
    };
    broadphase.fixedTree.query(path, visit);
    if (body.options.bullet && !found)
        broadphase.movingTree.query(path, [&](std::uint32_t shape) {
            found = shapes[shape].body != index;
            return !found;
        });
    return found;
}

SweptPath pathOfStep(const Bodies& bodies, std::span<const StartPose> starts, float dt, std::uint32_t index) {
    const BodyRecord& body = bodies[index];
    const Pose end{body.center, body.rotation};
    if (body.awakeIndex >= starts.size()) return {end, {}, {}};
    const StartPose& start = starts[body.awakeIndex];
    SweptPath path{{start.center, start.rotation}, relative(end.position, start.center), {}};
    path.turn = rotationVector(end.rotation * conjugate(start.rotation));
    const float angle = length(path.turn);
    const Vec3 axis = angle > 0 ? (1 / angle) * path.turn : normalized(bodies.states[index].w);
    const float revolutions = std::floor((dt * dot(bodies.states[index].w, axis) - angle) / (2 * kPi) + 0.5f);
    path.turn += 2 * kPi * revolutions * axis;
    return path;
}

namespace {

/// A convex shape on its way, seen from an obstacle.
struct ShapeSweep {
    const GeometryEntry& geometry;
    const SolidCore& core;
    Frame from, to;
    float margin;  ///< m
    std::uint32_t shape, obstacle;
};

/// Keeps the meeting with a surface where it comes first.
template <class Surface>
void meetSurface(const ShapeSweep& sweep, const Surface& surface, Meeting& first) {
    const float target = kTarget * sweep.margin, allowed = 2 * target;
    const auto touchAt = [&](const Frame& at) {
        return touchOf(surface, sweep.geometry.convex, at, sweep.to, sweep.margin);
    };
    const SweepHit hit = timeOfImpact(surface, sweep.geometry.convex, sweep.from, sweep.to, target);
    if (!hit.hit || (first.hit && hit.fraction >= first.fraction)) return;
    if (hit.fraction == 0) {
        Manifold touch = touchAt(sweep.from);
        keepDeepening(touch, sweep.from, sweep.to, allowed);
        if (touch.pointCount > 0) {
            first = {true, 0, sweep.shape, sweep.obstacle, touch};
            return;
        }
    }
    // What is only grazed, as the side of the next tile of a floor, is no obstacle: the core passes it, and at the end
    // nothing is deep.
    const Frame coreFrom{transformPoint(sweep.from, sweep.core.center), sweep.from.rotation};
    const Frame coreTo{transformPoint(sweep.to, sweep.core.center), sweep.to.rotation};
    const SweepHit deep = timeOfImpact(surface, sweep.core.view, coreFrom, coreTo, 0);
    const bool blocks = deep.hit && deep.fraction > 0;
    if (hit.fraction == 0 ? !blocks : !blocks && !isDeep(touchAt(sweep.to), allowed)) return;
    SweepHit met = hit.fraction == 0 ? deep : hit;
    if (!mayPush(surface, met.normal) || (first.hit && met.fraction >= first.fraction)) return;
    if (!turnToFace(surface, sweep.geometry.convex, sweep.from, sweep.to, allowed, met)) return;
    first = {true, met.fraction, sweep.shape, sweep.obstacle,
             touchAt(SweptMotion(sweep.from, sweep.to).at(met.fraction))};
    if (first.touch.pointCount == 0) first.touch = pointContact(met);
}

}  // namespace

Meeting firstMeeting(const SweepView& view, std::uint32_t index, const Pose& start, const Pose& end, float done,
                     float until) {
    const ConstTables& t = view.tables;
    const BodyRecord& body = t.bodies[index];
    Meeting first;
    for (std::uint32_t s = body.firstShape; s != kNone; s = t.shapes[s].next) {
        const ShapeRecord& shape = t.shapes[s];
        const GeometryEntry& geometry = t.shapes.geometries[shape.geometry];
        if (shape.sensor || shape.givesWay || geometry.field) continue;
        if (geometry.mesh) {
            sweepMesh(view, index, s, start, end, done, until, first);
            continue;
        }
        const Pose shapeStart = start * shape.frame, shapeEnd = end * shape.frame;
        const float bulge = bulgeOf(body, start.rotation, end.rotation);
        const Bounds swept =
            enlarged(merge(boundsOf(geometry.shape, shapeStart), boundsOf(geometry.shape, shapeEnd)), bulge);
        const float target = kTarget * tuning::kSpeculative * shape.size;
        const SolidCore core = coreOf(geometry);
        const auto meet = [&](std::uint32_t other) {
            const ShapeRecord& obstacle = t.shapes[other];
            if (obstacle.body == index || obstacle.sensor || !view.mayCollide(s, other)) return true;
            if (isKeptApart(view.ghosts(), s, other, shapeStart, shapeEnd, bulge)) return true;
            const bool still = t.bodies[obstacle.body].type == BodyType::fixed;
            const SweptPath others =
                still ? SweptPath{{t.bodies[obstacle.body].center, t.bodies[obstacle.body].rotation}, {}, {}}
                      : pathOfStep(view, obstacle.body);
            const Frame& place = obstacle.frame;
            const Frame from = seenFrom(others.at(done) * place, shapeStart);
            const Frame to = seenFrom(others.at(until) * place, shapeEnd);
            const GeometryEntry& solid = t.shapes.geometries[obstacle.geometry];
            if (!solid.isMesh() && passesAlong(solid.convex, geometry.convex, core, from, to, bulge, 2 * target))
                return true;
            const ShapeSweep sweep{geometry, core, from, to, tuning::kSpeculative * shape.size, s, other};
            const auto sweepAt = [&](const auto& surface) { meetSurface(sweep, surface, first); };
            if (!solid.isMesh()) {
                sweepAt(solid.convex);
                return true;
            }
            const Bounds path = enlarged(merge(boundsOf(geometry.shape, from), boundsOf(geometry.shape, to)), bulge);
            const PlacedShape before(geometry.convex, from), after(geometry.convex, to);
            const auto triangle = [&](const TriangleView& face) {
                // Surfaces are met from the front only.
                if (still && cannotMeet(face, before, after, bulge, target)) return true;
                if (dot(face.normal, from.position - face.a) > 0) sweepAt(face);
                return true;
            };
            if (solid.mesh)
                forEachTriangle(*solid.mesh, path, triangle);
            else
                forEachTriangle(*solid.field, path, triangle);
            return true;
        };
        view.broadphase.fixedTree.query(swept, meet);
        if (body.options.bullet) view.broadphase.movingTree.query(swept, meet);
    }
    return first;
}

}  // namespace ragtop
