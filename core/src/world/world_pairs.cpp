#include <algorithm>
#include <cmath>
#include <limits>

#include "base/nonzero_bytes.h"
#include "base/prefetch.h"
#include "model/edge_list.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

bool filtersAgree(const Filter& a, const Filter& b) {
    if (a.group == b.group && a.group != 0) return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

}  // namespace

/// m. A mesh or height field that is moved by others has no size of its own and is given none: bounds that are infinite
/// meet everything.
static float enlargement(const ShapeRecord& shape) {
    return std::isfinite(shape.size) ? tuning::kFatMargin * shape.size : 0.0f;
}

static Bounds boundsNow(const WorldImpl& world, const ShapeRecord& shape) {
    return boundsOf(world.shapes.geometries[shape.geometry].shape, world.shapePose(shape));
}
/// How far what is within `inner` may go in any direction before it leaves `outer`.
static float slackBetween(const Bounds& outer, const Bounds& inner) {
    const Vec3 slack = min(inner.lower - outer.lower, outer.upper - inner.upper);
    return std::min(slack.x, std::min(slack.y, slack.z));
}
static Bounds boundsAlong(const Bounds& now, const Vec3& motion) {
    return {min(now.lower, now.lower + motion), max(now.upper, now.upper + motion)};
}

/// Where a shape is and, going on as it does, will be after dt.
Bounds WorldImpl::tightBounds(const ShapeRecord& shape, float ahead) const {
    const Bounds now = boundsNow(*this, shape);
    return bodies[shape.body].type == BodyType::fixed ? now : boundsAlong(now, ahead * bodies.states[shape.body].v);
}

void WorldImpl::insertProxy(std::uint32_t index) {
    ShapeRecord& shape = shapes[index];
    const BodyRecord& body = bodies[shape.body];
    shape.isStaticTree = body.type == BodyType::fixed;
    const Bounds tight = tightBounds(shape, dt);
    const Bounds fat = shape.isStaticTree ? tight : enlarged(tight, enlargement(shape));
    shape.proxy = broadphase.tree(shape.isStaticTree).insert(fat, shape.filter.category, index);
    markMoved(index);
}

void WorldImpl::removeProxy(std::uint32_t index) {
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

void WorldImpl::markMoved(std::uint32_t shape) {
    if (shapes[shape].inMoveBuffer || shapes[shape].proxy == kNone) return;
    shapes[shape].inMoveBuffer = true;
    broadphase.moved.push(shape);
}

constexpr float kNearly = 0.99f;  ///< of room that is counted on, for bounds are rounded

/// Bounds that are made now leave room; where there are several shapes, the one that has least is not known.
void WorldImpl::giveRoom(std::uint32_t index) {
    BodyRecord& body = bodies[index];
    if (index < broadphase.left.rooms.size()) broadphase.left.rooms[index].travel = BoundsRoom::kUnknown;
    const bool single = body.firstShape != kNone && shapes[body.firstShape].next == kNone;
    body.room = single && body.type != BodyType::fixed ? kNearly * enlargement(shapes[body.firstShape]) : 0.0f;
}

/// Bounds made at the end of a step count the motion of the next one, going on as it does; what was set going since is
/// not in them.
void WorldImpl::recordNewVelocity(std::uint32_t index) {
    if (bodies[index].hasNewVelocity) return;
    bodies[index].hasNewVelocity = true;
    broadphase.newVelocities.push(index);
}

void WorldImpl::coverMotion(std::uint32_t index) {
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

/// `all`: this step is longer than the one that bounds were made for, as the first one is. What moves is met in this
/// step; obstacles that stand still are swept to, and looked for in the next one.
void WorldImpl::coverNewVelocities(bool all) {
    for (const std::uint32_t index : broadphase.newVelocities) {
        if (!bodies[index].hasNewVelocity) continue;
        bodies[index].hasNewVelocity = false;
        if (!all) coverMotion(index);
    }
    broadphase.newVelocities.clear();
    if (all)
        for (const std::uint32_t index : bodies.awake) coverMotion(index);
    if (!broadphase.moved.empty()) findPairsOfMoved(false);
}

/// Bounds that a shape is given when it has left its old ones. They count the coming step alone, since all that they meet
/// is to be collided. What swings on joints with nothing near it is given those of several steps, and an eighth of that
/// way aside, for its path bends; it then looks for partners as much more seldom.
static Bounds newBounds(const WorldImpl& world, const ShapeRecord& shape, const Bounds& now, bool isFree) {
    constexpr float kFreeSteps = 4, kAside = 1.0f / 8;
    const float margin = enlargement(shape), ahead = (isFree ? kFreeSteps : 1) * world.dt;
    const Vec3 motion = ahead * world.bodies.states[shape.body].v;
    return enlarged(boundsAlong(now, motion), isFree ? margin + kAside * length(motion) : margin);
}

/// The room of a body with a single shape, which bounds of several steps leave it.
static void giveFreeRoom(WorldImpl& world, std::uint32_t index, const Bounds& now, const Bounds& given) {
    const BodyRecord& body = world.bodies[index];
    if (world.shapes[body.firstShape].next != kNone) return;
    world.broadphase.left.rooms[index] = {kNearly * (now.lower - given.lower), kNearly * (given.upper - now.upper),
                                          body.travel};
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

/// Gives shapes of a body that have left their bounds new ones, and notes how far it may go within those of now; returns how
/// many shapes are not in the move buffer yet.
static std::uint32_t refitBody(WorldImpl& world, std::uint32_t index) {
    BodyRecord& body = world.bodies[index];
    const bool isFree = world.bodies.isDirect(index) && body.firstContact == kNone;
    const Vec3 coming = world.dt * world.bodies.states[index].v;
    std::uint32_t moved = 0;
    float slack = std::numeric_limits<float>::infinity();
    Bounds now, given;
    for (std::uint32_t s = body.firstShape; s != kNone; s = world.shapes[s].next) {
        const ShapeRecord& shape = world.shapes[s];
        now = boundsNow(world, shape);
        if (!contains(world.broadphase.movingTree.bounds(shape.proxy), boundsAlong(now, coming))) {
            given = newBounds(world, shape, now, isFree);
            world.broadphase.movingTree.give(shape.proxy, given);
            moved += shape.inMoveBuffer ? 0 : 1;
            body.refitted = true;
        }
        slack = std::min(slack, slackBetween(world.broadphase.movingTree.bounds(shape.proxy), now));
    }
    body.room = kNearly * slack;
    if (!body.refitted) return 0;
    world.broadphase.left.rooms[index].travel = BoundsRoom::kUnknown;
    if (isFree) giveFreeRoom(world, index, now, given);
    return moved;
}

/// Adds what bodies have moved to their travel and gives shapes that have left their bounds new ones; returns how many
/// of these are not in the move buffer yet.
static std::uint32_t refitBodies(WorldImpl& world, std::size_t begin, std::size_t end) {
    std::uint32_t moved = 0;
    for (std::size_t place = begin; place < end; ++place) {
        const std::uint32_t index = world.bodies.awake[place];
        const StartPose& start = world.sweptBodies.starts[place];
        BodyRecord& body = world.bodies[index];
        const Quat rotation = body.rotation * conjugate(start.rotation);
        const Vec3 motion = relative(body.center, start.center);
        const float turn = 2 * length(Vec3{rotation.x, rotation.y, rotation.z}) * body.coreRadius;
        const float way = length(motion) + turn;
        const double before = body.travel;
        body.travel += static_cast<double>(way);
        body.room -= way;
        body.refitted = false;
        world.broadphase.left.bodies[place] = 0;
        const Vec3 coming = world.dt * world.bodies.states[index].v;
        // Of what has contacts, or had some since, the room is not known.
        BoundsRoom& room = world.broadphase.left.rooms[index];
        if (body.firstContact == kNone && room.travel == before && keepsToRoom(room, motion, turn, coming, body.travel))
            continue;
        if (length(coming) < body.room) continue;
        moved += refitBody(world, index);
        world.broadphase.left.bodies[place] = body.refitted ? 1 : 0;
    }
    return moved;
}

/// Bounds that were left are enlarged in place; their shapes look for partners in the next step, in the order of the
/// bodies.
void WorldImpl::refitBounds() {
    constexpr std::size_t kAtOnce = 64;  // shapes of a task
    const std::size_t count = bodies.awake.size(), blocks = (count + kAtOnce - 1) / kAtOnce;
    AlignedArray<std::uint32_t>& starts = broadphase.left.starts;
    broadphase.left.bodies.resizeForOverwrite(count);
    broadphase.left.rooms.resize(bodies.size(), {});
    starts.resizeForOverwrite(blocks + 1);
    const auto forBlocks = [&](auto&& visit) {
        runner.parallelFor(static_cast<int>(blocks), 1, [&](int begin, int end, int) {
            for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block)
                visit(block, block * kAtOnce, block + 1 < blocks ? (block + 1) * kAtOnce : count);
        });
    };
    forBlocks([&](std::size_t block, std::size_t begin, std::size_t end) {
        starts[block + 1] = refitBodies(*this, begin, end);
    });
    starts[0] = static_cast<std::uint32_t>(broadphase.moved.size());
    for (std::size_t block = 0; block < blocks; ++block) starts[block + 1] += starts[block];
    broadphase.moved.resizeForOverwrite(starts[blocks]);
    forBlocks([&](std::size_t block, std::size_t begin, std::size_t end) {
        std::uint32_t next = starts[block];
        forEachNonzero(broadphase.left.bodies.data() + begin, end - begin, [&](std::size_t i) {
            for (std::uint32_t s = bodies[bodies.awake[begin + i]].firstShape; s != kNone; s = shapes[s].next) {
                if (!broadphase.movingTree.wasGiven(shapes[s].proxy)) continue;
                broadphase.movingTree.tellGiven(shapes[s].proxy);
                if (!shapes[s].inMoveBuffer) broadphase.moved[next++] = s;
                shapes[s].inMoveBuffer = true;
            }
        });
    });
    broadphase.movingTree.refitEnlarged(&runner);
}

bool WorldImpl::shouldCollide(const ShapeRecord& a, const ShapeRecord& b) const {
    if (a.body == b.body || !(bodies.moves(a.body) || bodies.moves(b.body))) {
        const bool sensorPair = (a.sensor || b.sensor) && a.body != b.body;
        if (!sensorPair) return false;
    }
    if (shapes.geometries[a.geometry].isMesh() && shapes.geometries[b.geometry].isMesh() && !bodies.moves(a.body) &&
        !bodies.moves(b.body))
        return false;
    if (!filtersAgree(a.filter, b.filter)) return false;
    for (std::uint32_t key = bodies[a.body].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
        const JointRecord& joint = joints[key >> 1];
        const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
        if (other != b.body) continue;
        if (!std::visit([](const auto& def) { return def.bodies.collide; }, joint.def)) return false;
    }
    return true;
}

void WorldImpl::findPairs() {
    findPairsOfMoved(true);
    for (const std::uint32_t shape : broadphase.moved) shapes[shape].inMoveBuffer = false;
    broadphase.moved.clear();
}

/// Pairs whose bounds a shape has met, few at a time: by the time the table of pairs is asked for them, in which they lie in
/// no order, its memory is on the way.
class WorldImpl::PairsMet {
public:
    PairsMet(const WorldImpl& world, std::pmr::vector<PairFound>& found) : world_(world), found_(found) {}
    void add(std::uint32_t shape, std::uint32_t other) {
        ragtop::prefetch(&world_.shapes[other].filter);
        world_.broadphase.pairs.prefetch(pairKey(shape, other));
        met_[count_++] = {shape, other};
        if (count_ == kMost) ask();
    }
    /// Of obstacles in the move buffer, with what moves and has not found them itself.
    void addObstacles() {
        for (const std::uint32_t index : world_.broadphase.moved) {
            const ShapeRecord& shape = world_.shapes[index];
            if (!shape.isStaticTree) continue;
            world_.broadphase.movingTree.query(world_.broadphase.fixedTree.bounds(shape.proxy),
                                               [&](std::uint32_t other) {
                                                   if (!world_.shapes[other].inMoveBuffer) add(index, other);
                                                   return true;
                                               });
        }
    }
    void ask() {
        for (int i = 0; i < count_; ++i)
            if (isNew(met_[i])) found_.push_back(met_[i]);
        count_ = 0;
    }

private:
    static constexpr int kMost = 64;  ///< pairs that are asked for at once

    bool isNew(const PairFound& pair) const {
        const ShapeRecord &a = world_.shapes[pair.a], &b = world_.shapes[pair.b];
        if (!filtersAgree(a.filter, b.filter)) return false;
        if (world_.broadphase.pairs.contains(pairKey(pair.a, pair.b)) || !world_.shouldCollide(a, b)) return false;
        return !world_.callbacks.filter ||
               world_.callbacks.filter({world_.shapes.id(pair.a), world_.shapes.id(pair.b), world_.bodies.id(a.body),
                                        world_.bodies.id(b.body), a.userData, b.userData});
    }

    const WorldImpl& world_;
    std::pmr::vector<PairFound>& found_;
    PairFound met_[kMost];
    int count_ = 0;
};

/// Pairs of moving shapes in the move buffer together: the trees are gone down once for all of them.
static std::size_t findPairsOfMany(WorldImpl& world, bool obstaclesToo) {
    constexpr std::size_t kMostBranches = 64;  // tasks
    constexpr std::size_t kShapesPerBranch = 32;  // of a task, by trial
    BoundsTree& tree = world.broadphase.movingTree;
    for (const std::uint32_t shape : world.broadphase.moved)
        if (!world.shapes[shape].isStaticTree) tree.seek(world.shapes[shape].proxy);
    const std::size_t few = std::min(world.broadphase.moved.size() / kShapesPerBranch, kMostBranches);
    auto& branches = world.broadphase.search.branches;
    auto& found = world.broadphase.search.found;
    branches.clear();
    tree.collectSeeking(tree, few, branches);
    const std::size_t amongMoving = branches.size();
    if (obstaclesToo) tree.collectSeeking(world.broadphase.fixedTree, few, branches);
    while (found.size() < branches.size()) found.emplace_back(world.memory);
    world.runner.parallelFor(static_cast<int>(branches.size()), 1, [&](int begin, int end, int) {
        for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block) {
            found[block].clear();
            WorldImpl::PairsMet met(world, found[block]);
            tree.forPairs(block < amongMoving ? tree : world.broadphase.fixedTree, branches[block],
                          [&](std::uint32_t a, std::uint32_t b) { met.add(a, b); });
            met.ask();
        }
    });
    for (const std::uint32_t shape : world.broadphase.moved)
        if (!world.shapes[shape].isStaticTree) tree.stopSeeking(world.shapes[shape].proxy);
    return branches.size();
}

/// The same where few of many have moved: branches that hold one of them are far larger than it, and would meet much that
/// it does not. Of two that both seek, the first one in the order of shapes finds the other.
static std::size_t findPairsOfFew(WorldImpl& world, bool obstaclesToo) {
    constexpr std::size_t kAtOnce = 64;  // shapes of a task
    auto& found = world.broadphase.search.found;
    auto& waiting = world.broadphase.search.waiting;
    const std::size_t count = world.broadphase.moved.size(), blocks = (count + kAtOnce - 1) / kAtOnce;
    while (found.size() < blocks) found.emplace_back(world.memory);
    while (waiting.size() < static_cast<std::size_t>(world.runner.workers())) waiting.emplace_back(world.memory);
    world.runner.parallelFor(static_cast<int>(blocks), 1, [&](int begin, int end, int worker) {
        for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block) {
            found[block].clear();
            WorldImpl::PairsMet met(world, found[block]);
            std::uint32_t seekers[kAtOnce];
            Bounds sought[kAtOnce];
            std::size_t seeking = 0;
            for (std::size_t i = block * kAtOnce; i < std::min(count, (block + 1) * kAtOnce); ++i) {
                const ShapeRecord& shape = world.shapes[world.broadphase.moved[i]];
                if (shape.isStaticTree) continue;
                seekers[seeking] = world.broadphase.moved[i];
                sought[seeking++] = world.broadphase.movingTree.bounds(shape.proxy);
            }
            auto& scratch = waiting[static_cast<std::size_t>(worker)];
            world.broadphase.movingTree.queryAll(
                {sought, seeking}, scratch, [&](std::uint32_t place, std::uint32_t other) {
                    const std::uint32_t own = seekers[place];
                    if (own < other || (own != other && !world.shapes[other].inMoveBuffer)) met.add(own, other);
                });
            if (obstaclesToo)
                world.broadphase.fixedTree.queryAll(
                    {sought, seeking}, scratch,
                    [&](std::uint32_t place, std::uint32_t other) { met.add(seekers[place], other); });
            met.ask();
            // What one shape has met lies together, as its contacts then do.
            std::sort(found[block].begin(), found[block].end(),
                      [](const PairFound& x, const PairFound& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
        }
    });
    return blocks;
}

/// Pairs of all shapes in the move buffer, and of obstacles one by one, since few come anew.
void WorldImpl::findPairsOfMoved(bool obstaclesToo) {
    constexpr std::size_t kFew = 16;     // one of so many
    constexpr std::size_t kNear = 4096;  // shapes whose tree a cache holds
    const auto all = static_cast<std::size_t>(broadphase.movingTree.proxyCount());
    const bool few = all > kNear && kFew * broadphase.moved.size() < all;
    std::size_t blocks = few ? findPairsOfFew(*this, obstaclesToo) : findPairsOfMany(*this, obstaclesToo);
    auto& found = broadphase.search.found;
    bool obstacles = false;
    for (const std::uint32_t shape : broadphase.moved) obstacles |= shapes[shape].isStaticTree;
    if (obstacles) {
        if (found.size() == blocks) found.emplace_back(memory);
        found[blocks].clear();
        PairsMet met(*this, found[blocks++]);
        met.addObstacles();
        met.ask();
    }
    for (std::size_t block = 0; block < blocks; ++block)
        for (const PairFound& pair : found[block]) createContact(pair.a, pair.b);
}

void WorldImpl::createContact(std::uint32_t a, std::uint32_t b) {
    // A mesh comes first, and of meshes one that does not move, as height fields; else a body that moves, because the
    // narrow phase works in A's frame near its centre.
    const bool meshA = shapes.geometries[shapes[a].geometry].isMesh(),
               meshB = shapes.geometries[shapes[b].geometry].isMesh();
    const bool movesA = bodies.moves(shapes[a].body), movesB = bodies.moves(shapes[b].body);
    const bool swap = meshA != meshB ? meshB : meshA && movesA != movesB ? movesA : movesA != movesB ? movesB : b < a;
    if (swap) std::swap(a, b);
    const ShapeRecord &shapeA = shapes[a], &shapeB = shapes[b];
    const std::uint32_t index = contacts.acquire();
    ContactRecord& contact = contacts[index];
    contact.shapeA = a;
    contact.shapeB = b;
    contact.bodyA = shapeA.body;
    contact.bodyB = shapeB.body;
    contact.size = shapeA.size < shapeB.size ? shapeA.size : shapeB.size;
    contact.isMesh = meshA || meshB;
    contact.sensor = shapeA.sensor || shapeB.sensor;
    contact.reportsMotion = shapeA.reportsMotion || shapeB.reportsMotion;
    contact.manifoldCapacity = contact.isMesh ? kMaxManifolds : 1;
    if (contact.isMesh) {
        const bool walks = shapes.geometries[shapeA.geometry].mesh && !meetAsSurfaces(contact);
        contact.nearTriangles = walks ? manifolds.meshMemory.acquire() : kNone;
    }
    if (contact.sensor) {  // what it overlaps is told at the end of a step, when nothing may grow
        contact.firstManifold = manifolds.acquire(contact.manifoldCapacity);
        for (ManifoldRecord& manifold : manifolds.of(contact)) manifold = {}, manifold.contact = index;
    }
    link(contacts.links, bodies[contact.bodyA].firstContact, 2 * index);
    link(contacts.links, bodies[contact.bodyB].firstContact, 2 * index + 1);
    broadphase.pairs.insert(pairKey(a, b), index);
    if (bodies.isAwake(contact.bodyA) || bodies.isAwake(contact.bodyB)) addAwakeContact(index);
}

void WorldImpl::destroyContact(std::uint32_t index) {
    ContactRecord& contact = contacts[index];
    Manifolds::forEach(contact, [&](std::uint32_t manifold) {
        manifolds[manifold].pointCount = 0;
        removeFromGraph(manifold);
    });
    manifolds.release(contact);
    if (contact.isMesh && contact.nearTriangles != kNone) manifolds.meshMemory.release(contact.nearTriangles);
    if (contact.awakeIndex != kNone) contacts.removeAwake(index);
    if (contact.touching) {
        events.end(
            {shapes.id(contact.shapeA), shapes.id(contact.shapeB), bodies.id(contact.bodyA), bodies.id(contact.bodyB)},
            contact.sensor);
    }
    unlink(contacts.links, bodies[contact.bodyA].firstContact, 2 * index);
    unlink(contacts.links, bodies[contact.bodyB].firstContact, 2 * index + 1);
    broadphase.pairs.erase(pairKey(contact.shapeA, contact.shapeB));
    contacts.release(index);
}

void WorldImpl::addAwakeContact(std::uint32_t index) {
    contacts.addAwake(index);
    if (contacts[index].sensor) contactFinds.anySensor.store(true, std::memory_order_relaxed);
    contactFinds.closing.push(index);
    contactFinds.dirty.push(index);
}

}  // namespace ragtop
