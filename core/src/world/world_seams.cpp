#include <algorithm>

#include "base/prefetch.h"
#include "constraints/lane_view.h"
#include "narrowphase/pairs.h"
#include "world/world_impl.h"

/// Seams between bodies. What slides from one tile of a floor to the next meets the side of the next one, or its edge,
/// before it is over it: of all directions that keep the two apart the narrow phase takes the one with the widest gap.
/// Where a body already touches something along a plane that has the other obstacle behind it, that plane keeps them
/// apart, and the contact with the other obstacle has nothing to do.
namespace ragtop {

namespace {

/// Of the size: how far shapes may reach through a plane that still separates them. Steps lower than this are no steps.
constexpr float kStep = 0.01f;
/// Of the size: contacts that close by less in a step stop nothing.
constexpr float kClosing = 1e-3f;
/// Contacts that are looked at by a thread in one go.
constexpr int kSeamsAtOnce = 8;

float reachAlong(const ConvexView& shape, const Vec3& direction) {
    if (shape.kind == ConvexKind::hull) {
        float most = dot(shape.hull->vertices[0], direction);
        for (const Vec3& vertex : shape.hull->vertices) {
            const float reach = dot(vertex, direction);
            most = reach > most ? reach : most;
        }
        return most + shape.radius;
    }
    return dot(abs(direction), shape.halfExtents) + shape.radius;
}

/// How far a convex shape at a pose reaches along a direction, from a place in the world.
float extentAlong(const ConvexView& shape, const Pose& pose, const Vec3& direction, const DVec3& from) {
    return dot(direction, relative(pose.position, from)) + reachAlong(shape, inverseRotate(pose.rotation, direction));
}

}  // namespace

/// A body at the beginning of the step: the manifolds of the step belong there.
Pose WorldImpl::startOfStep(std::uint32_t index) const {
    const BodyRecord& body = bodies[index];
    if (!sweptBodies.posesMoved || body.awakeIndex == kNone || body.awakeIndex >= sweptBodies.starts.size())
        return {body.center, body.rotation};
    const StartPose& start = sweptBodies.starts[body.awakeIndex];
    return {start.center, start.rotation};
}

/// The surface that a manifold gives to one of its sides, where they touch within a distance.
TouchedPlane WorldImpl::touchedPlane(const ManifoldRecord& manifold, int side, float within) const {
    const ContactRecord& contact = contacts[manifold.contact];
    const Pose a = startOfStep(contact.bodyA);
    TouchedPlane plane;
    plane.normal = (side == 1 ? 1.0f : -1.0f) * rotate(a.rotation, manifold.normal);
    for (int j = 0; j < manifold.pointCount; ++j) {
        if (manifold.separation[j] > within) continue;
        if (-manifold.separation[j] > plane.depth) plane.depth = -manifold.separation[j];
        if (plane.touches) continue;
        const Pose holder = side == 1 ? a : startOfStep(contact.bodyB);
        const Vec3 anchor = rotate(holder.rotation, (side == 1 ? manifold.anchorA : manifold.anchorB)[j]);
        plane.at = holder.position + (anchor - 0.5f * manifold.separation[j] * plane.normal);
        plane.touches = true;
    }
    return plane;
}

/// Does a plane have one shape in front of it, but for what it overlaps there, and the other behind?
bool WorldImpl::separates(const TouchedPlane& plane, std::uint32_t front, std::uint32_t behind, float slack) const {
    const ShapeRecord &a = shapes[front], &b = shapes[behind];
    const ConvexView &viewA = shapes.geometries[a.geometry].convex, &viewB = shapes.geometries[b.geometry].convex;
    return extentAlong(viewA, startOfStep(a.body) * a.frame, -plane.normal, plane.at) <= slack + plane.depth &&
           extentAlong(viewB, startOfStep(b.body) * b.frame, plane.normal, plane.at) <= slack;
}

/// Calls visit(plane, manifold, side) for what a body touches in other contacts than one, until one says true.
template <class Visit>
bool WorldImpl::anyTouchedPlane(std::uint32_t body, float within, std::uint32_t except, Visit&& visit) const {
    for (std::uint32_t key = bodies[body].firstContact; key != kNone; key = contacts.next(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        if (contact.sensor || key >> 1 == except) continue;
        for (const ManifoldRecord& manifold : manifolds.of(contact)) {
            if (manifold.pointCount == 0 || manifold.place.color == kNone) continue;
            const TouchedPlane plane = touchedPlane(manifold, static_cast<int>(key & 1), within);
            if (plane.touches && visit(plane, manifold, static_cast<int>(key & 1))) return true;
        }
    }
    return false;
}

/// The way of A relative to B in this step at a point of a contact, if the bodies go on as they do.
Vec3 WorldImpl::motionAtPoint(const ContactRecord& record, const ManifoldRecord& manifold, int point) const {
    const auto velocity = [&](std::uint32_t index, const Vec3& anchor) {
        const BodyRecord& body = bodies[index];
        if (body.type == BodyType::fixed) return Vec3{};
        return bodies.states[index].v + cross(bodies.states[index].w, rotate(body.rotation, anchor));
    };
    return dt * (velocity(record.bodyA, manifold.anchorA[point]) - velocity(record.bodyB, manifold.anchorB[point]));
}

/// Is a point closed already, or by the end of this step?
bool WorldImpl::willMeet(const ContactRecord& record, const ManifoldRecord& manifold, int point) const {
    if (manifold.separation[point] <= 0) return true;
    const Vec3 normal = rotate(bodies[record.bodyA].rotation, manifold.normal);
    return manifold.separation[point] <= dot(normal, motionAtPoint(record, manifold, point));
}

/// Does a contact close in this step by more than `least`, and some point of it meet in this step, or in the substep
/// after it, which the last relaxing pass foresees? What does not has nothing to hide.
bool WorldImpl::closes(const ContactRecord& record, const ManifoldRecord& manifold, float least) const {
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const BodyState &stateA = bodies.states[record.bodyA], &stateB = bodies.states[record.bodyB];
    const Vec3 normal = rotate(a.rotation, manifold.normal);
    const Vec3 way =
        dt * ((a.type == BodyType::fixed ? Vec3{} : stateA.v) - (b.type == BodyType::fixed ? Vec3{} : stateB.v));
    const float turning = (a.type == BodyType::fixed ? 0 : length(stateA.w) * a.coreRadius) +
                          (b.type == BodyType::fixed ? 0 : length(stateB.w) * b.coreRadius);
    if (!(dot(way, normal) + dt * turning > least)) return false;
    const float foreseen = 1 + context.h / dt;
    bool nearer = false, meets = false;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const float closing = dot(motionAtPoint(record, manifold, j), normal);
        nearer |= closing > least;
        meets |= manifold.separation[j] <= foreseen * closing + least;
    }
    return nearer && meets;
}

/// Does sliding along a plane, and that alone, close a contact in the time of `closes`? By more than `least`, which also
/// stands for what accelerations add.
bool WorldImpl::slidesInto(const ManifoldRecord& manifold, const Vec3& plane, float least) const {
    const ContactRecord& contact = contacts[manifold.contact];
    const Vec3 normal = rotate(bodies[contact.bodyA].rotation, manifold.normal);
    const Vec3 along = normal - dot(normal, plane) * plane;
    const float foreseen = 1 + context.h / dt;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const Vec3 way = motionAtPoint(contact, manifold, j);
        if (dot(way, along) > least && manifold.separation[j] <= foreseen * dot(way, normal) + least) return true;
    }
    return false;
}

/// Does a body's contact with something else keep the shapes of this one apart? `side` is that of the body.
bool WorldImpl::isSeam(const ManifoldRecord& manifold, int side) const {
    const ContactRecord& contact = contacts[manifold.contact];
    const std::uint32_t shape = side == 1 ? contact.shapeB : contact.shapeA;
    const std::uint32_t obstacle = side == 1 ? contact.shapeA : contact.shapeB;
    const float slack = slackOf(shape, obstacle);
    const auto keepsApart = [&](const TouchedPlane& plane, const ManifoldRecord& other, int otherSide) {
        if (!slidesInto(manifold, plane.normal, kClosing * slack / kStep)) return false;
        if (!separates(plane, shape, obstacle, slack)) return false;
        // Where each of two planes has the other obstacle behind it, the earlier contact stays.
        const ContactRecord& by = contacts[other.contact];
        const std::uint32_t otherShape = otherSide == 1 ? by.shapeB : by.shapeA;
        const std::uint32_t otherObstacle = otherSide == 1 ? by.shapeA : by.shapeB;
        if (other.contact < manifold.contact || shapes.geometries[shapes[otherObstacle].geometry].isMesh()) return true;
        const TouchedPlane own = touchedPlane(manifold, side, slack);
        return !own.touches || !separates(own, otherShape, otherObstacle, slackOf(otherShape, otherObstacle));
    };
    return anyTouchedPlane(shapes[shape].body, slack, manifold.contact, keepsApart);
}

/// The same on a swept path: in front of the plane at both of its ends, and as far as it may bulge between them.
bool WorldImpl::keptApart(std::uint32_t shape, std::uint32_t obstacle, const Pose& start, const Pose& end,
                          float bulge) const {
    const ConvexView& view = shapes.geometries[shapes[shape].geometry].convex;
    const ConvexView& solid = shapes.geometries[shapes[obstacle].geometry].convex;
    const float slack = slackOf(shape, obstacle);
    if (bulge > slack || shapes.geometries[shapes[obstacle].geometry].isMesh()) return false;
    const Pose place = shapePose(shapes[obstacle]);
    return anyTouchedPlane(
        shapes[shape].body, slack, kNone, [&](const TouchedPlane& plane, const ManifoldRecord& by, int side) {
            const ContactRecord& contact = contacts[by.contact];
            if ((side == 1 ? contact.shapeA : contact.shapeB) == obstacle) return false;
            return extentAlong(view, start, -plane.normal, plane.at) <= slack + plane.depth - bulge &&
                   extentAlong(view, end, -plane.normal, plane.at) <= slack + plane.depth - bulge &&
                   extentAlong(solid, place, plane.normal, plane.at) <= slack;
        });
}

float WorldImpl::slackOf(std::uint32_t a, std::uint32_t b) const {
    return kStep * (shapes[a].size < shapes[b].size ? shapes[a].size : shapes[b].size);
}

/// What bears a load already is no seam, or it would have been hidden before it did.
bool WorldImpl::bearsLoad(const ManifoldRecord& manifold) const {
    if (manifold.place.color == kNone) return false;
    const LaneReader lane(graph.lane(manifold.place), graph.lanes());
    for (int j = 0; j < manifold.pointCount; ++j)
        if (lane.at(j, contact::kImpulse) > 0) return true;
    return false;
}

/// Only what moves, closes by more than a little and is about to meet is looked at.
bool WorldImpl::mayBeSeam(const ContactRecord& record, const ManifoldRecord& manifold) const {
    if (record.sensor || record.isMesh) return false;
    if (bodies[record.bodyA].ahead + bodies[record.bodyB].ahead < kClosing * record.size) return false;
    return manifold.pointCount > 0 && closes(record, manifold, kClosing * record.size) && !bearsLoad(manifold);
}

void WorldImpl::hideSeam(ContactRecord& record) {
    const ManifoldRecord& manifold = manifolds[record.firstManifold];
    if (manifold.place.color == kNone) return;
    if (!(bodies.moves(record.bodyA) && isSeam(manifold, 0)) && !(bodies.moves(record.bodyB) && isSeam(manifold, 1)))
        return;
    LaneView(graph.lane(manifold.place), graph.lanes()).setBits(contact::kPointCount, 0);
    record.surfaceOpen = true;
}

/// Asks for the contacts of the bodies of some that close, and then for their manifolds: the lists of all these bodies
/// are walked side by side, since each tells only from its memory where it goes on.
static void prefetchTouched(const WorldImpl& world, const std::uint32_t* closing, int count) {
    constexpr int kMost = 256;
    std::uint32_t keys[2 * kSeamsAtOnce], found[kMost];
    int lists = 0, seen = 0;
    for (int i = 0; i < count; ++i) {
        const ContactRecord& record = world.contacts[closing[i]];
        for (const std::uint32_t body : {record.bodyA, record.bodyB})
            if (world.bodies.moves(body)) keys[lists++] = world.bodies[body].firstContact;
    }
    for (bool more = true; more && seen < kMost - 2 * kSeamsAtOnce;) {
        more = false;
        for (int k = 0; k < lists; ++k) {
            if (keys[k] == kNone) continue;
            prefetch(&world.contacts[keys[k] >> 1]);
            found[seen++] = keys[k] >> 1;
            keys[k] = world.contacts.next(keys[k]);
            more = true;
        }
    }
    constexpr std::size_t kLine = 64;  // bytes, of a cache
    for (int i = 0; i < seen; ++i) {
        const ContactRecord& record = world.contacts[found[i]];
        if (!record.hasPoints || record.firstManifold == kNone) continue;
        const auto* manifold = reinterpret_cast<const char*>(&world.manifolds[record.firstManifold]);
        for (std::size_t line = 0; line < sizeof(ManifoldRecord); line += kLine) prefetch(manifold + line);
    }
}

/// Takes the points of contacts at seams out of this step; their lanes are written anew in the next one. Which may be
/// seams was noted while they were collided; those of bodies that woke since are looked at here.
void WorldImpl::hideSeams() {
    runner.parallelFor(static_cast<int>(contactFinds.closing.size()), kSeamsAtOnce, [&](int begin, int end, int) {
        for (int first = begin; first < end; first += kSeamsAtOnce) {
            const int past = std::min(first + kSeamsAtOnce, end);
            prefetchTouched(*this, &contactFinds.closing[static_cast<std::size_t>(first)], past - first);
            for (int i = first; i < past; ++i) {
                ContactRecord& record = contacts[contactFinds.closing[static_cast<std::size_t>(i)]];
                if (record.hasPoints && mayBeSeam(record, manifolds[record.firstManifold])) hideSeam(record);
            }
        }
    });
}

}  // namespace ragtop
