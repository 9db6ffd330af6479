#include "world/closing_touches.h"

#include <algorithm>

#include "contacts/contacts.h"
#include "continuous/meetings.h"
#include "narrowphase/collide.h"
#include "world/joint_closing.h"
#include "world/jointed_groups.h"

namespace ragtop {

namespace {

/// Between two bodies.
struct PlacedTouch {
    Vec3 normal;      ///< world axes, from A to B
    Vec3 armA, armB;  ///< m, from the centres of mass
    float separation = 0;
};

/// Where two bodies are.
struct PairPoses {
    Pose a, b;
};

PlacedTouch placeTouch(const ClosingTouch& touch, const PairPoses& at) {
    PlacedTouch placed;
    placed.normal = rotate(at.a.rotation, touch.normal);
    placed.armA = rotate(at.a.rotation, touch.anchorA);
    placed.armB = rotate(at.b.rotation, touch.anchorB);
    placed.separation =
        touch.separation + dot(placed.normal, relative(at.b.position, at.a.position) + placed.armB - placed.armA);
    return placed;
}

PairPoses posesNow(const ClosingView& world, std::uint32_t a, std::uint32_t b) {
    const auto pose = [&](std::uint32_t body) { return Pose{world.bodies[body].center, world.bodies[body].rotation}; };
    return {pose(a), pose(b)};
}

PairPoses posesAtStart(const ClosingView& world, std::uint32_t a, std::uint32_t b) {
    const std::span<const StartPose> starts = world.sweptBodies.startPoses();
    const auto pose = [&](std::uint32_t body) {
        const BodyRecord& record = world.bodies[body];
        if (record.awakeIndex >= starts.size()) return Pose{record.center, record.rotation};
        return Pose{starts[record.awakeIndex].center, starts[record.awakeIndex].rotation};
    };
    return {pose(a), pose(b)};
}

/// Calls visit(contact, isInner) for the contacts of a group with itself and with what is fixed, each once.
template <class Visit>
void forEachContact(const ClosingView& world, std::span<const std::uint32_t> group, Visit&& visit) {
    for (const std::uint32_t body : group)
        for (std::uint32_t key = world.bodies[body].firstContact; key != kNone; key = world.contacts.next(key)) {
            const ContactRecord& contact = world.contacts[key >> 1];
            if (contact.sensor) continue;
            const std::uint32_t other = (key & 1) == 0 ? contact.bodyB : contact.bodyA;
            const bool isInner = areGrouped(world.bodies, world.energyGuard, body, other);
            if (isInner ? (key & 1) == 0 : world.bodies[other].type == BodyType::fixed) visit(contact, isInner);
        }
}

/// Anchors and normals that turn further with a body in a step tell no more where it touches.
bool hasTurnedFar(const ClosingView& world, std::uint32_t body) {
    constexpr float kFarTurn = 0.5f;  // rad
    return world.dt * world.dt * lengthSquared(world.bodies.states[body].w) > kFarTurn * kFarTurn;
}
bool haveTurnedFar(const ClosingView& world, const ContactRecord& contact) {
    return hasTurnedFar(world, contact.bodyA) || hasTurnedFar(world, contact.bodyB);
}

/// Calls visit(touch) for the points of a contact that the step found.
template <class Visit>
void forEachPoint(const ClosingView& world, const ContactRecord& contact, bool isInner, Visit&& visit) {
    if (!contact.hasPoints || haveTurnedFar(world, contact)) return;
    ClosingTouch touch;
    touch.bodyA = contact.bodyA, touch.bodyB = contact.bodyB;
    touch.isInner = isInner;
    const float sizeA = world.bodies[touch.bodyA].size, sizeB = world.bodies[touch.bodyB].size;
    touch.size = isInner ? std::min(sizeA, sizeB) : world.bodies.moves(touch.bodyA) ? sizeA : sizeB;
    const PairPoses start = posesAtStart(world, touch.bodyA, touch.bodyB);
    Manifolds::forEach(contact, [&](std::uint32_t index) {
        const ManifoldRecord& manifold = world.manifolds[index];
        touch.normal = manifold.normal;
        for (int j = 0; j < manifold.pointCount; ++j) {
            touch.anchorA = manifold.anchorA[j];
            touch.anchorB = manifold.anchorB[j];
            touch.separation = manifold.separation[j];
            touch.least = std::min(0.0f, placeTouch(touch, start).separation);
            visit(touch);
        }
    });
}

float depthOf(const ClosingView& world, const ClosingTouch& touch) {
    if (!touch.isInner || !(touch.size > 0)) return 0;
    const PlacedTouch now = placeTouch(touch, posesNow(world, touch.bodyA, touch.bodyB));
    return std::max(0.0f, touch.least - now.separation) / touch.size;
}

/// How two shapes went by each other in a step.
struct PairPath {
    const ShapeRecord &shapeA, &shapeB;
    const ConvexView &a, &b;
    SweptPath pathA, pathB;

    /// What is found after a share of it.
    Frame collideAt(float share, SeparationCache cache, Manifold& found) const {
        const Frame bInA = seenFrom(pathA.at(share) * shapeA.frame, pathB.at(share) * shapeB.frame);
        collide(a, b, bInA, 0, cache, found);
        return bInA;
    }
};

PairPath pathOf(const ClosingView& world, const ContactRecord& contact) {
    const ShapeRecord &a = world.shapes[contact.shapeA], &b = world.shapes[contact.shapeB];
    const auto path = [&](std::uint32_t body) {
        return pathOfStep(world.bodies, world.sweptBodies.startPoses(), world.dt, body);
    };
    return {a,
            b,
            world.shapes.geometryOf(a).convex,
            world.shapes.geometryOf(b).convex,
            path(contact.bodyA),
            path(contact.bodyB)};
}

/// Where two parts have come into each other.
struct Overlap {
    Manifold found;
    Frame bInA;
    float least = 0;  ///< m, as of a touch

    float depth() const { return found.pointCount > 0 ? std::max(0.0f, least - leastSeparation(found.all())) : 0; }
};

/// Where a step has taken two convex parts.
Overlap overlapOf(const PairPath& path, const SeparationCache& cache) {
    Overlap overlap;
    overlap.bInA = path.collideAt(1, cache, overlap.found);
    if (overlap.found.pointCount == 0) return overlap;
    Manifold start;
    path.collideAt(0, cache, start);
    if (start.pointCount > 0) overlap.least = std::min(0.0f, leastSeparation(start.all()));
    return overlap;
}

/// From deep within the nearest way out may be the far side: what counts is the side by which B came in, where the path
/// is halved for it.
void findEntry(const PairPath& path, const SeparationCache& cache, float shallow, Overlap& overlap) {
    constexpr int kHalvings = 6;  // to a sixty-fourth of the path
    float apart = 0, inside = 1;
    for (int i = 0; i < kHalvings && leastSeparation(overlap.found.all()) < -shallow; ++i) {
        const float share = 0.5f * (apart + inside);
        Manifold there;
        const Frame at = path.collideAt(share, cache, there);
        if (there.pointCount == 0) {
            apart = share;
            continue;
        }
        inside = share;
        overlap.found = there;
        overlap.bInA = at;
    }
}

}  // namespace

void findTouches(const ClosingView& world, std::span<const std::uint32_t> group, AlignedArray<ClosingTouch>& touches) {
    touches.clear();
    forEachContact(world, group, [&](const ContactRecord& contact, bool isInner) {
        forEachPoint(world, contact, isInner, [&](const ClosingTouch& touch) { touches.push(touch); });
    });
}

bool addMissedTouches(const ClosingView& world, std::span<const std::uint32_t> group, float sizes, bool again,
                      AlignedArray<ClosingTouch>& touches) {
    constexpr float kShallow = 0.25f;  // of the size: overlaps whose nearest way out is the way in
    const std::size_t before = touches.size();
    forEachContact(world, group, [&](const ContactRecord& contact, bool isInner) {
        if (!isInner || contact.isMesh) return;
        const PairPath path = pathOf(world, contact);
        Overlap overlap = overlapOf(path, contact.cache);
        if (!(overlap.depth() > sizes * contact.size)) return;
        if (overlap.least == 0 && !again) findEntry(path, contact.cache, kShallow * contact.size, overlap);
        const Frame &a = path.shapeA.frame, &b = path.shapeB.frame;
        for (const ManifoldPoint& point : overlap.found.all())
            touches.push({.bodyA = contact.bodyA,
                          .bodyB = contact.bodyB,
                          .normal = rotate(a.rotation, overlap.found.normal),
                          .anchorA = transformPoint(a, point.position),
                          .anchorB = transformPoint(b, inverseTransformPoint(overlap.bInA, point.position)),
                          .separation = point.separation,
                          .least = overlap.least,
                          .size = contact.size,
                          .isInner = true});
    });
    return touches.size() > before;
}

void placeTouches(const ClosingView& world, std::span<const ClosingTouch> touches,
                  AlignedArray<direct::ClosingPoint>& points) {
    points.clear();
    for (const ClosingTouch& touch : touches) {
        const PlacedTouch at = placeTouch(touch, posesNow(world, touch.bodyA, touch.bodyB));
        points.push({.stateA = touch.bodyA,
                     .stateB = touch.bodyB,
                     .normal = direct::toDouble(at.normal),
                     .armA = direct::toDouble(at.armA),
                     .armB = direct::toDouble(at.armB),
                     .room = static_cast<double>(at.separation - touch.least),
                     .isFar = at.separation > touch.size});
    }
}

float deepestTouch(const ClosingView& world, std::span<const ClosingTouch> touches) {
    float deepest = 0;
    for (const ClosingTouch& touch : touches) deepest = std::max(deepest, depthOf(world, touch));
    return deepest;
}

float deepestTouch(const ClosingView& world, std::span<const std::uint32_t> group) {
    const bool anyFast =
        std::any_of(group.begin(), group.end(), [&](std::uint32_t body) { return hasTurnedFar(world, body); });
    float deepest = 0;
    const auto note = [&](const ContactRecord& contact) {
        if (anyFast && haveTurnedFar(world, contact) && !contact.isMesh)
            deepest = std::max(deepest, overlapOf(pathOf(world, contact), contact.cache).depth() / contact.size);
        else
            forEachPoint(world, contact, true,
                         [&](const ClosingTouch& touch) { deepest = std::max(deepest, depthOf(world, touch)); });
    };
    // Most contacts have no points, and few of those that have are of a group with itself.
    for (const std::uint32_t body : group)
        for (std::uint32_t key = world.bodies[body].firstContact; key != kNone; key = world.contacts.next(key)) {
            if ((key & 1) != 0) continue;
            const ContactRecord& contact = world.contacts[key >> 1];
            if (contact.sensor || !(contact.hasPoints || anyFast)) continue;
            if (areGrouped(world.bodies, world.energyGuard, body, contact.bodyB)) note(contact);
        }
    return deepest;
}

}  // namespace ragtop
