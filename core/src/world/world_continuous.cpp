#include <cmath>

#include "narrowphase/collide.h"
#include "narrowphase/distance.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// What no surface may get into, even of a shape that touches it already: the shape without half of its thickness.
struct Core {
    ConvexView view;
    Vec3 center;  ///< in the frame of the shape
};

Core coreOf(const GeometryEntry& geometry) {
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

}  // namespace

/// Is a ball surely away from all bounds of a tree along its way? In doubles, which need no rounding to either side.
static bool isAwayFrom(const BoundsTree& tree, const DVec3& from, const DVec3& to, float radius) {
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

/// Does the ball that holds a body come near anything on which a sweep from `start` could end?
bool WorldImpl::mayMeet(std::uint32_t index, const DVec3& start) const {
    const BodyRecord& body = bodies[index];
    if (!body.bullet && isAwayFrom(broadphase.fixedTree, start, body.center, body.radius)) return false;
    const Bounds path = boundsOfPath(start, body.center, body.radius);
    bool found = false;
    const auto visit = [&](std::uint32_t shape) {
        found = shapes[shape].body != index;
        return !found;
    };
    broadphase.fixedTree.query(path, visit);
    if (body.bullet && !found) broadphase.movingTree.query(path, visit);
    return found;
}

/// Bodies that moved far for their size are swept along their path, so that they do not pass what their contacts did
/// not foresee. Serial and in order of the list, but for those that meet nothing.
void WorldImpl::sweepFastBodies() {
    sweptBodies.impacts.clear();
    if (!settings.continuous) return;
    const std::size_t count = bodies.awake.size();
    sweptBodies.posesMoved = true;
    if (runner.workers() > 1) clearPaths();
    for (std::size_t i = 0; i < count; ++i)
        if (sweptBodies.flags[i] == kToSweep && bodies.moves(bodies.awake[i])) sweepBody(bodies.awake[i]);
    sweptBodies.posesMoved = false;
}

void WorldImpl::recordSwept(std::uint32_t index) { sweptBodies.flags[bodies[index].awakeIndex] = kSwept; }

/// What is swept past obstacles that stand still alone, and meets none, depends on nothing that other sweeps change;
/// one that pushes it on lets it be swept after all.
void WorldImpl::clearPaths() {
    runner.parallelFor(static_cast<int>(bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            const std::uint32_t body = bodies.awake[static_cast<std::size_t>(i)];
            BodyFlag& flag = sweptBodies.flags[static_cast<std::size_t>(i)];
            if (flag == kToSweep && bodies.moves(body) && !bodies[body].bullet && !meetsAnything(body))
                flag = kFastClear;
        }
    });
}

namespace {

constexpr int kMaxPieces = 64;  ///< of 1.5 rad: 15 turns in a step

/// The share of a path that is swept at once: long turns are swept piece by piece.
float firstPiece(const SweptPath& path) {
    constexpr float kPiece = 1.5f;  // rad
    return 1 / (1 + std::floor(length(path.turn) / kPiece));
}

SweptPath afterPiece(const SweptPath& path, float share) {
    return {path.at(share), (1 - share) * path.way, (1 - share) * path.turn};
}

}  // namespace

bool WorldImpl::meetsAnything(std::uint32_t index) const {
    SweptPath path = pathOfStep(index);
    float done = 0;
    for (int piece = 0; piece < kMaxPieces && done < 1; ++piece) {
        const float share = firstPiece(path);
        const float until = share < 1 ? done + (1 - done) * share : 1.0f;
        if (firstMeeting(index, path.from, path.at(share), done, until).hit) return true;
        path = afterPiece(path, share);
        done = until;
    }
    return false;
}

/// How a body moved in this step: straight, and turning evenly, as many revolutions as its speed tells.
SweptPath WorldImpl::pathOfStep(std::uint32_t index) const {
    const BodyRecord& body = bodies[index];
    const Pose end{body.center, body.rotation};
    if (body.awakeIndex == kNone || body.awakeIndex >= sweptBodies.starts.size()) return {end, {}, {}};
    const StartPose& start = sweptBodies.starts[body.awakeIndex];
    SweptPath path{{start.center, start.rotation}, relative(end.position, start.center), {}};
    path.turn = rotationVector(end.rotation * conjugate(start.rotation));
    const float angle = length(path.turn);
    const Vec3 axis = angle > 0 ? (1 / angle) * path.turn : normalized(bodies.states[index].w);
    const float revolutions = std::floor((dt * dot(bodies.states[index].w, axis) - angle) / (2 * kPi) + 0.5f);
    path.turn += 2 * kPi * revolutions * axis;
    return path;
}

/// Takes what is left behind on an obstacle that moves on along with it, or the obstacle would pass it.
void WorldImpl::rideAlong(std::uint32_t obstacle, float done, Pose& pose) const {
    if (bodies[obstacle].type == BodyType::fixed) return;
    const SweptPath way = pathOfStep(obstacle);
    const Frame beside = relative(way.at(done), pose);
    pose = way.at(1) * beside;
    pose.rotation = normalized(pose.rotation);
}

/// Plays the impacts of a body one after the other, each with the rest of its time. What is left after the last impact,
/// or piece, is lost, but for the way of what it lies on.
void WorldImpl::sweepBody(std::uint32_t index) {
    constexpr int kMaxImpacts = 8, kMaxStuck = 3;
    SweptPath path = pathOfStep(index);
    Quat velocityAt = bodies[index].rotation;
    float done = 0;
    int impacts = 0, stuck = 0;
    for (int piece = 0; piece < kMaxPieces && done < 1; ++piece) {
        const float share = firstPiece(path);
        const Pose to = path.at(share);
        const float until = share < 1 ? done + (1 - done) * share : 1.0f;
        const Meeting meeting = firstMeeting(index, path.from, to, done, until);
        if (!meeting.hit) {
            path = afterPiece(path, share);
            done = until;
            continue;
        }
        const float met = share * meeting.fraction;
        path = afterPiece(path, met);
        done += (until - done) * meeting.fraction;
        if (++impacts > kMaxImpacts) {
            rideAlong(shapes[meeting.obstacle].body, done, path.from);
            break;
        }
        // What meets a surface again and again at once rattles on it: its turn is lost, and it slides along.
        stuck = meeting.fraction == 0 ? stuck + 1 : 0;
        if (stuck > kMaxStuck) {
            const SweptPath others = pathOfStep(shapes[meeting.obstacle].body);
            const Quat place = others.at(done).rotation * shapes[meeting.obstacle].frame.rotation;
            const Vec3 normal = rotate(place, meeting.touch.normal);
            const float into = dot(path.way - (1 - done) * others.way, normal);
            path.way -= (into < 0 ? into : 0.0f) * normal;
            path.turn = {};
            continue;
        }
        if (!solveMeeting(index, meeting, done, velocityAt, path)) break;
    }
    if (impacts == 0) return;
    turnVelocity(index, velocityAt, path.from.rotation);
    bodies[index].center = path.from.position;
    bodies[index].rotation = path.from.rotation;
    bodies.refreshInertia(index);
    recordSwept(index);
}

/// The first surface that a body would go into on its way from a pose at the share `done` of the step to one at
/// `until`.
Meeting WorldImpl::firstMeeting(std::uint32_t index, const Pose& start, const Pose& end, float done,
                                float until) const {
    const BodyRecord& body = bodies[index];
    Meeting first;
    for (std::uint32_t s = body.firstShape; s != kNone; s = shapes[s].next) {
        const ShapeRecord& shape = shapes[s];
        const GeometryEntry& geometry = shapes.geometries[shape.geometry];
        if (shape.sensor || shape.givesWay || geometry.field) continue;
        if (geometry.mesh) {
            sweepMesh(index, s, start, end, done, until, first);
            continue;
        }
        const Pose shapeStart = start * shape.frame, shapeEnd = end * shape.frame;
        // A point at r that turns by θ leaves its chord by r (1 − cos θ/2) at most.
        const float bulge = body.coreRadius * (1 - std::abs((end.rotation * conjugate(start.rotation)).w));
        const Bounds swept =
            enlarged(merge(boundsOf(geometry.shape, shapeStart), boundsOf(geometry.shape, shapeEnd)), bulge);
        // Surfaces stay a little apart; going less far into each other is left to their contact.
        const float target = 0.25f * tuning::kSpeculative * shape.size, allowed = 2 * target;
        const Core core = coreOf(geometry);
        const auto meet = [&](std::uint32_t other) {
            const ShapeRecord& obstacle = shapes[other];
            if (obstacle.body == index || obstacle.sensor || !maySweepInto(s, other)) return true;
            if (keptApart(s, other, shapeStart, shapeEnd, bulge)) return true;
            const bool still = bodies[obstacle.body].type == BodyType::fixed;
            const SweptPath others =
                still ? SweptPath{{bodies[obstacle.body].center, bodies[obstacle.body].rotation}, {}, {}}
                      : pathOfStep(obstacle.body);
            const Frame& place = obstacle.frame;
            const Frame from = seenFrom(others.at(done) * place, shapeStart);
            const Frame to = seenFrom(others.at(until) * place, shapeEnd);
            const GeometryEntry& solid = shapes.geometries[obstacle.geometry];
            const auto sweepAt = [&](const auto& view) {
                const auto touchAt = [&](const Frame& at) {
                    return touchOf(view, geometry.convex, at, to, tuning::kSpeculative * shape.size);
                };
                const SweepHit hit = timeOfImpact(view, geometry.convex, from, to, target);
                if (!hit.hit || (first.hit && hit.fraction >= first.fraction)) return;
                if (hit.fraction == 0) {
                    Manifold touch = touchAt(from);
                    keepDeepening(touch, from, to, allowed);
                    if (touch.pointCount > 0) {
                        first = {true, 0, s, other, touch};
                        return;
                    }
                }
                // What is only grazed, as the side of the next tile of a floor, is no obstacle: the core passes it, and
                // at the end nothing is deep.
                const Frame coreFrom{transformPoint(from, core.center), from.rotation};
                const Frame coreTo{transformPoint(to, core.center), to.rotation};
                const SweepHit deep = timeOfImpact(view, core.view, coreFrom, coreTo, 0);
                const bool blocks = deep.hit && deep.fraction > 0;
                if (hit.fraction == 0 ? !blocks : !blocks && !isDeep(touchAt(to), allowed)) return;
                const SweepHit& met = hit.fraction == 0 ? deep : hit;
                if (first.hit && met.fraction >= first.fraction) return;
                first = {true, met.fraction, s, other, touchAt(SweptMotion(from, to).at(met.fraction))};
                if (first.touch.pointCount == 0) first.touch = pointContact(met);
            };
            if (!solid.isMesh()) {
                sweepAt(solid.convex);
                return true;
            }
            const Bounds path = enlarged(merge(boundsOf(geometry.shape, from), boundsOf(geometry.shape, to)), bulge);
            const auto triangle = [&](const TriangleView& view) {
                // Surfaces are met from the front only.
                if (dot(view.normal, from.position - view.a) > 0) sweepAt(view);
                return true;
            };
            if (solid.mesh)
                forEachTriangle(*solid.mesh, path, triangle);
            else
                forEachTriangle(*solid.field, path, triangle);
            return true;
        };
        broadphase.fixedTree.query(swept, meet);
        if (body.bullet) broadphase.movingTree.query(swept, meet);
    }
    return first;
}

bool WorldImpl::maySweepInto(std::uint32_t shape, std::uint32_t obstacle) const {
    const ShapeRecord &a = shapes[shape], &b = shapes[obstacle];
    if (!shouldCollide(a, b)) return false;
    return !callbacks.filter || callbacks.filter({shapes.id(shape), shapes.id(obstacle), bodies.id(a.body),
                                                  bodies.id(b.body), a.userData, b.userData});
}

}  // namespace ragtop
