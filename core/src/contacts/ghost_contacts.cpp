#include "contacts/ghost_contacts.h"

#include <algorithm>

#include "base/prefetch.h"
#include "constraints/contact_layout.h"
#include "constraints/lane_view.h"

namespace ragtop {

namespace {

/// Of the size: how far shapes may reach through a plane that still separates them. Steps lower than this are no steps.
constexpr float kStep = 0.01f;
/// Of the size: contacts that close by less in a step stop nothing.
constexpr float kClosing = 1e-3f;
/// Contacts that a thread looks at in one go.
constexpr int kGhostsAtOnce = 8;

/// Where a body touches a side of another one.
struct TouchedPlane {
    bool touches = false;
    DVec3 at;
    Vec3 normal;      ///< towards the body that touches it
    float depth = 0;  ///< m, of the overlap
};

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

/// A body at the beginning of the step: the manifolds of the step belong there.
Pose startOfStep(const GhostView& view, std::uint32_t index) {
    const BodyRecord& body = view.tables.bodies[index];
    if (body.awakeIndex >= view.starts.size()) return {body.center, body.rotation};
    const StartPose& start = view.starts[body.awakeIndex];
    return {start.center, start.rotation};
}

/// The surface that a manifold gives to one of its sides, where they touch within a distance.
TouchedPlane touchedPlane(const GhostView& view, const ManifoldRecord& manifold, int side, float within) {
    const ConstTables& t = view.tables;
    const ContactRecord& contact = t.contacts[manifold.contact];
    const Pose a = startOfStep(view, contact.bodyA);
    TouchedPlane plane;
    plane.normal = (side == 1 ? 1.0f : -1.0f) * rotate(a.rotation, manifold.normal);
    for (int j = 0; j < manifold.pointCount; ++j) {
        if (manifold.separation[j] > within) continue;
        if (-manifold.separation[j] > plane.depth) plane.depth = -manifold.separation[j];
        if (plane.touches) continue;
        const Pose holder = side == 1 ? a : startOfStep(view, contact.bodyB);
        const Vec3 anchor = rotate(holder.rotation, (side == 1 ? manifold.anchorA : manifold.anchorB)[j]);
        plane.at = holder.position + (anchor - 0.5f * manifold.separation[j] * plane.normal);
        plane.touches = true;
    }
    return plane;
}

/// Does a plane have one shape in front of it, but for what it overlaps there, and the other behind?
bool separates(const GhostView& view, const TouchedPlane& plane, std::uint32_t front, std::uint32_t behind,
               float slack) {
    const ConstTables& t = view.tables;
    const ShapeRecord &a = t.shapes[front], &b = t.shapes[behind];
    const ConvexView &viewA = t.shapes.geometryOf(a).convex, &viewB = t.shapes.geometryOf(b).convex;
    return extentAlong(viewA, startOfStep(view, a.body) * a.frame, -plane.normal, plane.at) <= slack + plane.depth &&
           extentAlong(viewB, startOfStep(view, b.body) * b.frame, plane.normal, plane.at) <= slack;
}

/// Calls visit(plane, manifold, side) for what a body touches in other contacts than one, until one says true.
template <class Visit>
bool anyTouchedPlane(const GhostView& view, std::uint32_t body, float within, std::uint32_t except, Visit&& visit) {
    const ConstTables& t = view.tables;
    for (std::uint32_t key = t.bodies[body].firstContact; key != kNone; key = t.contacts.next(key)) {
        const ContactRecord& contact = t.contacts[key >> 1];
        if (contact.sensor || key >> 1 == except) continue;
        for (const ManifoldRecord& manifold : t.manifolds.of(contact)) {
            if (manifold.pointCount == 0 || manifold.place.color == kNone) continue;
            const TouchedPlane plane = touchedPlane(view, manifold, static_cast<int>(key & 1), within);
            if (plane.touches && visit(plane, manifold, static_cast<int>(key & 1))) return true;
        }
    }
    return false;
}

/// The way of A relative to B in this step at a point of a contact, if the bodies go on as they do.
Vec3 motionAtPoint(const GhostView& view, const ContactRecord& record, const ManifoldRecord& manifold, int point) {
    const ConstTables& t = view.tables;
    const auto velocity = [&](std::uint32_t index, const Vec3& anchor) {
        const BodyRecord& body = t.bodies[index];
        if (body.type == BodyType::fixed) return Vec3{};
        return t.bodies.states[index].v + cross(t.bodies.states[index].w, rotate(body.rotation, anchor));
    };
    return view.dt *
           (velocity(record.bodyA, manifold.anchorA[point]) - velocity(record.bodyB, manifold.anchorB[point]));
}

/// Does a contact close in this step by more than `least`, and some point of it meet in this step, or in the substep
/// after it, which the last relaxing pass foresees? What does not has nothing to leave out.
bool closes(const GhostView& view, const ContactRecord& record, const ManifoldRecord& manifold, float least) {
    const ConstTables& t = view.tables;
    const BodyRecord &a = t.bodies[record.bodyA], &b = t.bodies[record.bodyB];
    const BodyState &stateA = t.bodies.states[record.bodyA], &stateB = t.bodies.states[record.bodyB];
    const Vec3 normal = rotate(a.rotation, manifold.normal);
    const Vec3 way =
        view.dt * ((a.type == BodyType::fixed ? Vec3{} : stateA.v) - (b.type == BodyType::fixed ? Vec3{} : stateB.v));
    const float turning = (a.type == BodyType::fixed ? 0 : length(stateA.w) * a.travel.coreRadius) +
                          (b.type == BodyType::fixed ? 0 : length(stateB.w) * b.travel.coreRadius);
    if (!(dot(way, normal) + view.dt * turning > least)) return false;
    const float foreseen = 1 + view.h / view.dt;
    bool nearer = false, meets = false;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const float closing = dot(motionAtPoint(view, record, manifold, j), normal);
        nearer |= closing > least;
        meets |= manifold.separation[j] <= foreseen * closing + least;
    }
    return nearer && meets;
}

/// Does sliding along a plane, and that alone, close a contact in the time of `closes`? By more than `least`, which
/// also stands for what accelerations add.
bool slidesInto(const GhostView& view, const ManifoldRecord& manifold, const Vec3& plane, float least) {
    const ConstTables& t = view.tables;
    const ContactRecord& contact = t.contacts[manifold.contact];
    const Vec3 normal = rotate(t.bodies[contact.bodyA].rotation, manifold.normal);
    const Vec3 along = normal - dot(normal, plane) * plane;
    const float foreseen = 1 + view.h / view.dt;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const Vec3 way = motionAtPoint(view, contact, manifold, j);
        if (dot(way, along) > least && manifold.separation[j] <= foreseen * dot(way, normal) + least) return true;
    }
    return false;
}

float slackOf(const GhostView& view, std::uint32_t a, std::uint32_t b) {
    const ConstTables& t = view.tables;
    return kStep * (t.shapes[a].size < t.shapes[b].size ? t.shapes[a].size : t.shapes[b].size);
}

/// Does a body's contact with something else keep the shapes of this one apart? `side` is that of the body.
bool isGhost(const GhostView& view, const ManifoldRecord& manifold, int side) {
    const ConstTables& t = view.tables;
    const ContactRecord& contact = t.contacts[manifold.contact];
    const std::uint32_t shape = side == 1 ? contact.shapeB : contact.shapeA;
    const std::uint32_t obstacle = side == 1 ? contact.shapeA : contact.shapeB;
    const float slack = slackOf(view, shape, obstacle);
    const auto keepsApart = [&](const TouchedPlane& plane, const ManifoldRecord& other, int otherSide) {
        if (!slidesInto(view, manifold, plane.normal, kClosing * slack / kStep)) return false;
        if (!separates(view, plane, shape, obstacle, slack)) return false;
        // Where each of two planes has the other obstacle behind it, the earlier contact stays.
        const ContactRecord& by = t.contacts[other.contact];
        const std::uint32_t otherShape = otherSide == 1 ? by.shapeB : by.shapeA;
        const std::uint32_t otherObstacle = otherSide == 1 ? by.shapeA : by.shapeB;
        if (other.contact < manifold.contact || t.shapes.geometryOf(t.shapes[otherObstacle]).isMesh()) return true;
        const TouchedPlane own = touchedPlane(view, manifold, side, slack);
        return !own.touches ||
               !separates(view, own, otherShape, otherObstacle, slackOf(view, otherShape, otherObstacle));
    };
    return anyTouchedPlane(view, t.shapes[shape].body, slack, manifold.contact, keepsApart);
}

/// What bears a load already is no ghost, or it would have been left out before it did.
bool bearsLoad(const GhostView& view, const ManifoldRecord& manifold) {
    const ConstTables& t = view.tables;
    if (manifold.place.color == kNone) return false;
    const LaneReader lane(t.graph.lane(manifold.place), t.graph.lanes());
    for (int j = 0; j < manifold.pointCount; ++j)
        if (lane.at(j, contact::kImpulse) > 0) return true;
    return false;
}

/// Asks for the contacts of the bodies of some that close, and then for their manifolds: the lists of all these bodies
/// are walked side by side, since each tells only from its memory where it goes on.
void prefetchTouched(const ConstTables& t, const std::uint32_t* closing, int count) {
    constexpr int kMostTouched = 256;  // a bound: asking ahead changes no result
    std::uint32_t keys[2 * kGhostsAtOnce], found[kMostTouched];
    int lists = 0, seen = 0;
    for (int i = 0; i < count; ++i) {
        const ContactRecord& record = t.contacts[closing[i]];
        for (const std::uint32_t body : {record.bodyA, record.bodyB})
            if (t.bodies.moves(body)) keys[lists++] = t.bodies[body].firstContact;
    }
    for (bool more = true; more && seen < kMostTouched - 2 * kGhostsAtOnce;) {
        more = false;
        for (int k = 0; k < lists; ++k) {
            if (keys[k] == kNone) continue;
            prefetch(&t.contacts[keys[k] >> 1]);
            found[seen++] = keys[k] >> 1;
            keys[k] = t.contacts.next(keys[k]);
            more = true;
        }
    }
    constexpr std::size_t kLine = 64;  // bytes, of a cache
    for (int i = 0; i < seen; ++i) {
        const ContactRecord& record = t.contacts[found[i]];
        if (!record.hasPoints || record.firstManifold == kNone) continue;
        const auto* manifold = reinterpret_cast<const char*>(&t.manifolds[record.firstManifold]);
        for (std::size_t line = 0; line < sizeof(ManifoldRecord); line += kLine) prefetch(manifold + line);
    }
}

}  // namespace

bool willMeet(const GhostView& view, const ContactRecord& record, const ManifoldRecord& manifold, int point) {
    const ConstTables& t = view.tables;
    if (manifold.separation[point] <= 0) return true;
    const Vec3 normal = rotate(t.bodies[record.bodyA].rotation, manifold.normal);
    return manifold.separation[point] <= dot(normal, motionAtPoint(view, record, manifold, point));
}

bool mayBeGhost(const GhostView& view, const ContactRecord& record, const ManifoldRecord& manifold) {
    const ConstTables& t = view.tables;
    if (record.sensor || record.isMesh) return false;
    if (t.bodies[record.bodyA].travel.ahead + t.bodies[record.bodyB].travel.ahead < kClosing * record.size)
        return false;
    return manifold.pointCount > 0 && closes(view, record, manifold, kClosing * record.size) &&
           !bearsLoad(view, manifold);
}

bool isKeptApart(const GhostView& view, std::uint32_t shape, std::uint32_t obstacle, const Pose& start, const Pose& end,
                 float bulge) {
    const ConstTables& t = view.tables;
    const GeometryEntry& own = t.shapes.geometryOf(t.shapes[shape]);
    const GeometryEntry& solid = t.shapes.geometryOf(t.shapes[obstacle]);
    const float slack = slackOf(view, shape, obstacle);
    if (bulge > slack || solid.isMesh()) return false;
    const BodyRecord& holder = t.bodies[t.shapes[obstacle].body];
    const Pose place = Pose{holder.center, holder.rotation} * t.shapes[obstacle].frame;
    const auto keepsApart = [&](const TouchedPlane& plane, const ManifoldRecord& by, int side) {
        const ContactRecord& contact = t.contacts[by.contact];
        if ((side == 1 ? contact.shapeA : contact.shapeB) == obstacle) return false;
        return extentAlong(own.convex, start, -plane.normal, plane.at) <= slack + plane.depth - bulge &&
               extentAlong(own.convex, end, -plane.normal, plane.at) <= slack + plane.depth - bulge &&
               extentAlong(solid.convex, place, plane.normal, plane.at) <= slack;
    };
    return anyTouchedPlane(view, t.shapes[shape].body, slack, kNone, keepsApart);
}

void leaveOutGhosts(const GhostView& view, std::span<const std::uint32_t> closing, Contacts& contacts,
                    ConstraintGraph& graph, StageRunner& runner) {
    const ConstTables& t = view.tables;
    const auto leaveOut = [&](ContactRecord& record, const ManifoldRecord& manifold) {
        if (manifold.place.color == kNone) return;
        if (!(t.bodies.moves(record.bodyA) && isGhost(view, manifold, 0)) &&
            !(t.bodies.moves(record.bodyB) && isGhost(view, manifold, 1)))
            return;
        LaneView(graph.lane(manifold.place), graph.lanes()).setBits(contact::kPointCount, 0);
        record.surfaceOpen = true;
    };
    runner.parallelFor(static_cast<int>(closing.size()), kGhostsAtOnce, [&](int begin, int end, int) {
        for (int first = begin; first < end; first += kGhostsAtOnce) {
            const int past = std::min(first + kGhostsAtOnce, end);
            prefetchTouched(t, &closing[static_cast<std::size_t>(first)], past - first);
            for (int i = first; i < past; ++i) {
                ContactRecord& record = contacts[closing[static_cast<std::size_t>(i)]];
                if (!record.hasPoints) continue;
                // Noted while it was collided; what woke since is looked at here.
                const ManifoldRecord& manifold = t.manifolds[record.firstManifold];
                if (mayBeGhost(view, record, manifold)) leaveOut(record, manifold);
            }
        }
    });
}

}  // namespace ragtop
