#include "contacts/shape_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/nonzero_bytes.h"
#include "contacts/meets_nothing.h"
#include "contacts/tuning.h"

namespace ragtop {

/// m. A mesh or height field that is moved by others has no size of its own and is given none: bounds that are infinite
/// meet everything.
static float enlargement(const ShapeRecord& shape) {
    return std::isfinite(shape.size) ? tuning::kFatMargin * shape.size : 0.0f;
}

static Bounds boundsNow(const ShapeBounds& view, const ShapeRecord& shape) {
    return boundsOf(view.shapes.geometries[shape.geometry].shape, shapePose(view.bodies[shape.body], shape));
}
/// How far what is within `inner` may go in any direction before it leaves `outer`.
static float slackBetween(const Bounds& outer, const Bounds& inner) {
    const Vec3 slack = min(inner.lower - outer.lower, outer.upper - inner.upper);
    return std::min(slack.x, std::min(slack.y, slack.z));
}
static Bounds boundsAlong(const Bounds& now, const Vec3& motion) {
    return {min(now.lower, now.lower + motion), max(now.upper, now.upper + motion)};
}

Bounds ShapeBounds::tightBounds(const ShapeRecord& shape, float ahead) const {
    const Bounds now = boundsNow(*this, shape);
    return bodies[shape.body].type == BodyType::fixed ? now : boundsAlong(now, ahead * bodies.states[shape.body].v);
}

void ShapeBounds::insertProxy(std::uint32_t index) const {
    ShapeRecord& shape = shapes[index];
    const BodyRecord& body = bodies[shape.body];
    shape.isStaticTree = body.type == BodyType::fixed;
    if (meetsNothing(shape.filter)) return;
    const Bounds tight = tightBounds(shape, dt);
    const Bounds fat = shape.isStaticTree ? tight : enlarged(tight, enlargement(shape));
    shape.proxy = broadphase.tree(shape.isStaticTree).insert(fat, shape.filter.category, index);
    markMoved(index);
}

void ShapeBounds::removeProxy(std::uint32_t index) const {
    ShapeRecord& shape = shapes[index];
    broadphase.tree(shape.isStaticTree).remove(shape.proxy);
    shape.proxy = kNone;
    if (!shape.inMoveBuffer) return;
    shape.inMoveBuffer = false;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < broadphase.moved.size(); ++i)
        if (broadphase.moved[i] != index) broadphase.moved[kept++] = broadphase.moved[i];
    while (broadphase.moved.size() > kept) broadphase.moved.pop();
}

void ShapeBounds::markMoved(std::uint32_t shape) const {
    if (shapes[shape].inMoveBuffer || shapes[shape].proxy == kNone) return;
    shapes[shape].inMoveBuffer = true;
    broadphase.moved.push(shape);
}

constexpr float kNearly = 0.99f;  ///< of room that is counted on, for bounds are rounded

void ShapeBounds::giveRoom(std::uint32_t index) const {
    BodyRecord& body = bodies[index];
    if (index < broadphase.left.rooms.size()) broadphase.left.rooms[index].travel = BoundsRoom::kUnknown;
    const bool single = body.firstShape != kNone && shapes[body.firstShape].next == kNone;
    body.room = single && body.type != BodyType::fixed ? kNearly * enlargement(shapes[body.firstShape]) : 0.0f;
}

void ShapeBounds::recordNewVelocity(std::uint32_t index) const {
    if (bodies[index].bounds.newVelocity) return;
    bodies[index].bounds.newVelocity = true;
    broadphase.newVelocities.push(index);
}

void ShapeBounds::coverMotion(std::uint32_t index) const {
    bool left = false;
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next) {
        const ShapeRecord& shape = shapes[s];
        if (shape.isStaticTree || shape.proxy == kNone) continue;
        const Bounds tight = tightBounds(shape, dt);
        if (contains(broadphase.movingTree.bounds(shape.proxy), tight)) continue;
        broadphase.movingTree.enlarge(shape.proxy, enlarged(tight, enlargement(shape)));
        markMoved(s);
        left = true;
    }
    if (left) giveRoom(index);
}

void ShapeBounds::coverNewVelocities(bool all) const {
    for (const std::uint32_t index : broadphase.newVelocities) {
        if (!bodies[index].bounds.newVelocity) continue;
        bodies[index].bounds.newVelocity = false;
        if (!all) coverMotion(index);
    }
    broadphase.newVelocities.clear();
    if (all)
        for (const std::uint32_t index : bodies.awake) coverMotion(index);
}

/// Bounds that a shape is given when it has left its old ones. They count the coming step alone, since all that they
/// meet is to be collided. What swings on joints with nothing near it is given those of several steps, and an eighth of
/// that way aside, for its path bends; it then looks for partners as much more seldom.
static Bounds newBounds(const ShapeBounds& view, const ShapeRecord& shape, const Bounds& now, bool isFree) {
    constexpr float kFreeSteps = 4, kAside = 1.0f / 8;  // steps; share of their way
    const float margin = enlargement(shape), ahead = (isFree ? kFreeSteps : 1) * view.dt;
    const Vec3 motion = ahead * view.bodies.states[shape.body].v;
    return enlarged(boundsAlong(now, motion), isFree ? margin + kAside * length(motion) : margin);
}

/// The room of a body with a single shape, which bounds of several steps leave it.
static void giveFreeRoom(const ShapeBounds& view, std::uint32_t index, const Bounds& now, const Bounds& given) {
    const BodyRecord& body = view.bodies[index];
    if (view.shapes[body.firstShape].next != kNone) return;
    view.broadphase.left.rooms[index] = {kNearly * (now.lower - given.lower), kNearly * (given.upper - now.upper),
                                         body.travel.done};
}

/// Takes from such room what a body has moved and turned by; true where enough is left for the coming step.
static bool keepsToRoom(BoundsRoom& room, const Vec3& moved, float turned, const Vec3& coming, double travel) {
    const Vec3 turn{turned, turned, turned}, none;
    room.below = room.below + moved - turn;
    room.above = room.above - moved - turn;
    room.travel = travel;
    const Vec3 low = room.below + min(coming, none), high = room.above - max(coming, none);
    return low.x > 0 && low.y > 0 && low.z > 0 && high.x > 0 && high.y > 0 && high.z > 0;
}

/// Gives shapes of a body that have left their bounds new ones, and notes how far it may go within those of now;
/// returns how many shapes are not in the move buffer yet.
static std::uint32_t refitBody(const ShapeBounds& view, std::uint32_t index) {
    BodyRecord& body = view.bodies[index];
    const bool isFree = view.bodies.isDirect(index) && body.firstContact == kNone;
    const Vec3 coming = view.dt * view.bodies.states[index].v;
    std::uint32_t moved = 0;
    float slack = std::numeric_limits<float>::infinity();
    Bounds now, given;
    for (std::uint32_t s = body.firstShape; s != kNone; s = view.shapes[s].next) {
        const ShapeRecord& shape = view.shapes[s];
        if (shape.proxy == kNone) continue;
        now = boundsNow(view, shape);
        if (!contains(view.broadphase.movingTree.bounds(shape.proxy), boundsAlong(now, coming))) {
            given = newBounds(view, shape, now, isFree);
            view.broadphase.movingTree.give(shape.proxy, given);
            moved += shape.inMoveBuffer ? 0 : 1;
            body.bounds.left = true;
        }
        slack = std::min(slack, slackBetween(view.broadphase.movingTree.bounds(shape.proxy), now));
    }
    body.room = kNearly * slack;
    if (!body.bounds.left) return 0;
    view.broadphase.left.rooms[index].travel = BoundsRoom::kUnknown;
    if (isFree) giveFreeRoom(view, index, now, given);
    return moved;
}

/// Adds what bodies have moved to their travel and gives shapes that have left their bounds new ones; returns how many
/// of these are not in the move buffer yet.
static std::uint32_t refitBodies(const ShapeBounds& view, std::span<const StartPose> starts, std::size_t begin,
                                 std::size_t end) {
    std::uint32_t moved = 0;
    for (std::size_t place = begin; place < end; ++place) {
        const std::uint32_t index = view.bodies.awake[place];
        const StartPose& start = starts[place];
        BodyRecord& body = view.bodies[index];
        const Quat rotation = body.rotation * conjugate(start.rotation);
        const Vec3 motion = relative(body.center, start.center);
        const float turn = 2 * length(Vec3{rotation.x, rotation.y, rotation.z}) * body.travel.coreRadius;
        const float way = length(motion) + turn;
        const double before = body.travel.done;
        body.travel.done += static_cast<double>(way);
        body.room -= way;
        body.bounds.left = false;
        view.broadphase.left.bodies[place] = 0;
        const Vec3 coming = view.dt * view.bodies.states[index].v;
        // Of what has contacts, or had some since, the room is not known.
        BoundsRoom& room = view.broadphase.left.rooms[index];
        if (body.firstContact == kNone && room.travel == before &&
            keepsToRoom(room, motion, turn, coming, body.travel.done))
            continue;
        if (length(coming) < body.room) continue;
        moved += refitBody(view, index);
        view.broadphase.left.bodies[place] = body.bounds.left ? 1 : 0;
    }
    return moved;
}

void ShapeBounds::refit(std::span<const StartPose> starts, StageRunner& runner) const {
    constexpr std::size_t kAtOnce = 64;  // shapes of a task
    const std::size_t count = bodies.awake.size(), blocks = (count + kAtOnce - 1) / kAtOnce;
    AlignedArray<std::uint32_t>& firsts = broadphase.left.starts;
    broadphase.left.bodies.resizeForOverwrite(count);
    broadphase.left.rooms.resize(bodies.size(), {});
    firsts.resizeForOverwrite(blocks + 1);
    const auto forBlocks = [&](auto&& visit) {
        runner.parallelFor(static_cast<int>(blocks), 1, [&](int begin, int end, int) {
            for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block)
                visit(block, block * kAtOnce, block + 1 < blocks ? (block + 1) * kAtOnce : count);
        });
    };
    forBlocks([&](std::size_t block, std::size_t begin, std::size_t end) {
        firsts[block + 1] = refitBodies(*this, starts, begin, end);
    });
    firsts[0] = static_cast<std::uint32_t>(broadphase.moved.size());
    for (std::size_t block = 0; block < blocks; ++block) firsts[block + 1] += firsts[block];
    broadphase.moved.resizeForOverwrite(firsts[blocks]);
    forBlocks([&](std::size_t block, std::size_t begin, std::size_t end) {
        std::uint32_t next = firsts[block];
        forEachNonzero(broadphase.left.bodies.data() + begin, end - begin, [&](std::size_t i) {
            for (std::uint32_t s = bodies[bodies.awake[begin + i]].firstShape; s != kNone; s = shapes[s].next) {
                if (shapes[s].proxy == kNone || !broadphase.movingTree.wasGiven(shapes[s].proxy)) continue;
                broadphase.movingTree.tellGiven(shapes[s].proxy);
                if (!shapes[s].inMoveBuffer) broadphase.moved[next++] = s;
                shapes[s].inMoveBuffer = true;
            }
        });
    });
    broadphase.movingTree.refitEnlarged(&runner);
}

}  // namespace ragtop
