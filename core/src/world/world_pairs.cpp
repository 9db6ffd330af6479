#include <algorithm>
#include <cmath>
#include <limits>

#include "base/nonzero_bytes.h"
#include "base/prefetch.h"
#include "world/edge_list.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

bool filtersAgree(const Filter& a, const Filter& b) {
    if (a.group == b.group && a.group != 0) return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

}  // namespace

Bounds WorldImpl::enlarged(const Bounds& bounds, float margin) {
    const Vec3 m{margin, margin, margin};
    return {bounds.lower - m, bounds.upper + m};
}

/// m. A mesh or height field that is moved by others has no size of its own and is given none: bounds that are infinite
/// meet everything.
static float enlargement(const ShapeRecord& shape) {
    return std::isfinite(shape.size) ? tuning::kFatMargin * shape.size : 0.0f;
}

static Bounds boundsNow(const WorldImpl& world, const ShapeRecord& shape) {
    return boundsOf(world.geometries[shape.geometry].shape, world.shapePose(shape));
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
    return bodies[shape.body].type == BodyType::fixed ? now : boundsAlong(now, ahead * states[shape.body].v);
}

void WorldImpl::insertProxy(std::uint32_t index) {
    ShapeRecord& shape = shapes[index];
    const BodyRecord& body = bodies[shape.body];
    shape.isStaticTree = body.type == BodyType::fixed;
    const Bounds tight = tightBounds(shape, dt);
    const Bounds fat = shape.isStaticTree ? tight : enlarged(tight, enlargement(shape));
    shape.proxy = tree(shape).insert(fat, shape.filter.category, index);
    markMoved(index);
}

void WorldImpl::removeProxy(std::uint32_t index) {
    ShapeRecord& shape = shapes[index];
    tree(shape).remove(shape.proxy);
    shape.proxy = kNone;
    if (!shape.inMoveBuffer) return;
    shape.inMoveBuffer = false;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < moveBuffer.size(); ++i)
        if (moveBuffer[i] != index) moveBuffer[kept++] = moveBuffer[i];
    while (moveBuffer.size() > kept) moveBuffer.pop();
}

void WorldImpl::markMoved(std::uint32_t shape) {
    if (shapes[shape].inMoveBuffer) return;
    shapes[shape].inMoveBuffer = true;
    moveBuffer.push(shape);
}

constexpr float kNearly = 0.99f;  ///< of room that is counted on, for bounds are rounded

/// Bounds that are made now leave room; where there are several shapes, the one that has least is not known.
void WorldImpl::giveRoom(std::uint32_t index) {
    BodyRecord& body = bodies[index];
    if (index < boundsLeft.rooms.size()) boundsLeft.rooms[index].travel = BoundsRoom::kUnknown;
    const bool single = body.firstShape != kNone && shapes[body.firstShape].next == kNone;
    body.room = single && body.type != BodyType::fixed ? kNearly * enlargement(shapes[body.firstShape]) : 0.0f;
}

/// Bounds made at the end of a step count the motion of the next one, going on as it does; what was set going since is
/// not in them.
void WorldImpl::recordNewVelocity(std::uint32_t index) {
    if (bodies[index].hasNewVelocity) return;
    bodies[index].hasNewVelocity = true;
    newVelocityBodies.push(index);
}

void WorldImpl::coverMotion(std::uint32_t index) {
    bool left = false;
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next) {
        const ShapeRecord& shape = shapes[s];
        if (shape.isStaticTree || shape.proxy == kNone) continue;
        const Bounds tight = tightBounds(shape, dt);
        if (contains(movingTree.bounds(shape.proxy), tight)) continue;
        movingTree.enlarge(shape.proxy, enlarged(tight, enlargement(shape)));
        markMoved(s);
        left = true;
    }
    if (left) giveRoom(index);
}

/// `all`: this step is longer than the one that bounds were made for, as the first one is. What moves is met in this
/// step; obstacles that stand still are swept to, and looked for in the next one.
void WorldImpl::coverNewVelocities(bool all) {
    for (const std::uint32_t index : newVelocityBodies) {
        if (!bodies[index].hasNewVelocity) continue;
        bodies[index].hasNewVelocity = false;
        if (!all) coverMotion(index);
    }
    newVelocityBodies.clear();
    if (all)
        for (const std::uint32_t index : awakeBodies) coverMotion(index);
    if (!moveBuffer.empty()) findPairsOfMoved(false);
}

/// Bounds that a shape is given when it has left its old ones. They count the coming step alone, since all that they meet
/// is to be collided. What swings on joints with nothing near it is given those of several steps, and an eighth of that
/// way aside, for its path bends; it then looks for partners as much more seldom.
static Bounds newBounds(const WorldImpl& world, const ShapeRecord& shape, const Bounds& now, bool isFree) {
    constexpr float kFreeSteps = 4, kAside = 1.0f / 8;
    const float margin = enlargement(shape), ahead = (isFree ? kFreeSteps : 1) * world.dt;
    const Vec3 motion = ahead * world.states[shape.body].v;
    return WorldImpl::enlarged(boundsAlong(now, motion), isFree ? margin + kAside * length(motion) : margin);
}

/// The room of a body with a single shape, which bounds of several steps leave it.
static void giveFreeRoom(WorldImpl& world, std::uint32_t index, const Bounds& now, const Bounds& given) {
    const BodyRecord& body = world.bodies[index];
    if (world.shapes[body.firstShape].next != kNone) return;
    world.boundsLeft.rooms[index] = {kNearly * (now.lower - given.lower), kNearly * (given.upper - now.upper), body.travel};
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
    const bool isFree = world.isDirect(index) && body.firstContact == kNone;
    const Vec3 coming = world.dt * world.states[index].v;
    std::uint32_t moved = 0;
    float slack = std::numeric_limits<float>::infinity();
    Bounds now, given;
    for (std::uint32_t s = body.firstShape; s != kNone; s = world.shapes[s].next) {
        const ShapeRecord& shape = world.shapes[s];
        now = boundsNow(world, shape);
        if (!contains(world.movingTree.bounds(shape.proxy), boundsAlong(now, coming))) {
            given = newBounds(world, shape, now, isFree);
            world.movingTree.give(shape.proxy, given);
            moved += shape.inMoveBuffer ? 0 : 1;
            body.refitted = true;
        }
        slack = std::min(slack, slackBetween(world.movingTree.bounds(shape.proxy), now));
    }
    body.room = kNearly * slack;
    if (!body.refitted) return 0;
    world.boundsLeft.rooms[index].travel = BoundsRoom::kUnknown;
    if (isFree) giveFreeRoom(world, index, now, given);
    return moved;
}

/// Adds what bodies have moved to their travel and gives shapes that have left their bounds new ones; returns how many
/// of these are not in the move buffer yet.
static std::uint32_t refitBodies(WorldImpl& world, std::size_t begin, std::size_t end) {
    std::uint32_t moved = 0;
    for (std::size_t place = begin; place < end; ++place) {
        const std::uint32_t index = world.awakeBodies[place];
        const StartPose& start = world.startPoses[place];
        BodyRecord& body = world.bodies[index];
        const Quat rotation = body.rotation * conjugate(start.rotation);
        const Vec3 motion = relative(body.center, start.center);
        const float turn = 2 * length(Vec3{rotation.x, rotation.y, rotation.z}) * body.coreRadius;
        const float way = length(motion) + turn;
        const double before = body.travel;
        body.travel += static_cast<double>(way);
        body.room -= way;
        body.refitted = false;
        world.boundsLeft.bodies[place] = 0;
        const Vec3 coming = world.dt * world.states[index].v;
        // Of what has contacts, or had some since, the room is not known.
        BoundsRoom& room = world.boundsLeft.rooms[index];
        if (body.firstContact == kNone && room.travel == before && keepsToRoom(room, motion, turn, coming, body.travel))
            continue;
        if (length(coming) < body.room) continue;
        moved += refitBody(world, index);
        world.boundsLeft.bodies[place] = body.refitted ? 1 : 0;
    }
    return moved;
}

/// Bounds that were left are enlarged in place; their shapes look for partners in the next step, in the order of the
/// bodies.
void WorldImpl::refitBounds() {
    constexpr std::size_t kAtOnce = 64;
    const std::size_t count = awakeBodies.size(), blocks = (count + kAtOnce - 1) / kAtOnce;
    AlignedArray<std::uint32_t>& starts = boundsLeft.starts;
    boundsLeft.bodies.resizeForOverwrite(count);
    boundsLeft.rooms.resize(bodies.size(), {});
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
    starts[0] = static_cast<std::uint32_t>(moveBuffer.size());
    for (std::size_t block = 0; block < blocks; ++block) starts[block + 1] += starts[block];
    moveBuffer.resizeForOverwrite(starts[blocks]);
    forBlocks([&](std::size_t block, std::size_t begin, std::size_t end) {
        std::uint32_t next = starts[block];
        forEachNonzero(boundsLeft.bodies.data() + begin, end - begin, [&](std::size_t i) {
            for (std::uint32_t s = bodies[awakeBodies[begin + i]].firstShape; s != kNone; s = shapes[s].next) {
                if (!movingTree.wasGiven(shapes[s].proxy)) continue;
                movingTree.tellGiven(shapes[s].proxy);
                if (!shapes[s].inMoveBuffer) moveBuffer[next++] = s;
                shapes[s].inMoveBuffer = true;
            }
        });
    });
    movingTree.refitEnlarged(&runner);
}

bool WorldImpl::shouldCollide(const ShapeRecord& a, const ShapeRecord& b) const {
    if (a.body == b.body || !(moves(a.body) || moves(b.body))) {
        const bool sensorPair = (a.sensor || b.sensor) && a.body != b.body;
        if (!sensorPair) return false;
    }
    if (geometries[a.geometry].isMesh() && geometries[b.geometry].isMesh() && !moves(a.body) && !moves(b.body))
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
    for (const std::uint32_t shape : moveBuffer) shapes[shape].inMoveBuffer = false;
    moveBuffer.clear();
}

/// Pairs whose bounds a shape has met, few at a time: by the time the table of pairs is asked for them, in which they lie in
/// no order, its memory is on the way.
class WorldImpl::PairsMet {
public:
    PairsMet(const WorldImpl& world, std::pmr::vector<PairFound>& found) : world_(world), found_(found) {}
    void add(std::uint32_t shape, std::uint32_t other) {
        ragtop::prefetch(&world_.shapes[other].filter);
        world_.pairs.prefetch(pairKey(shape, other));
        met_[count_++] = {shape, other};
        if (count_ == kMost) ask();
    }
    /// Of obstacles in the move buffer, with what moves and has not found them itself.
    void addObstacles() {
        for (const std::uint32_t index : world_.moveBuffer) {
            const ShapeRecord& shape = world_.shapes[index];
            if (!shape.isStaticTree) continue;
            world_.movingTree.query(world_.staticTree.bounds(shape.proxy), [&](std::uint32_t other) {
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
    static constexpr int kMost = 64;

    bool isNew(const PairFound& pair) const {
        const ShapeRecord &a = world_.shapes[pair.a], &b = world_.shapes[pair.b];
        if (!filtersAgree(a.filter, b.filter)) return false;
        if (world_.pairs.contains(pairKey(pair.a, pair.b)) || !world_.shouldCollide(a, b)) return false;
        return !world_.callbacks.filter ||
               world_.callbacks.filter({world_.shapeId(pair.a), world_.shapeId(pair.b), world_.id(a.body),
                                        world_.id(b.body), a.userData, b.userData});
    }

    const WorldImpl& world_;
    std::pmr::vector<PairFound>& found_;
    PairFound met_[kMost];
    int count_ = 0;
};

/// Pairs of moving shapes in the move buffer together: the trees are gone down once for all of them.
static std::size_t findPairsOfMany(WorldImpl& world, bool obstaclesToo) {
    constexpr std::size_t kMostBranches = 64;
    constexpr std::size_t kShapesPerBranch = 32;
    BoundsTree& tree = world.movingTree;
    for (const std::uint32_t shape : world.moveBuffer)
        if (!world.shapes[shape].isStaticTree) tree.seek(world.shapes[shape].proxy);
    const std::size_t few = std::min(world.moveBuffer.size() / kShapesPerBranch, kMostBranches);
    auto& branches = world.pairSearch.branches;
    auto& found = world.pairSearch.found;
    branches.clear();
    tree.collectSeeking(tree, few, branches);
    const std::size_t amongMoving = branches.size();
    if (obstaclesToo) tree.collectSeeking(world.staticTree, few, branches);
    while (found.size() < branches.size()) found.emplace_back(world.memory);
    world.runner.parallelFor(static_cast<int>(branches.size()), 1, [&](int begin, int end, int) {
        for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block) {
            found[block].clear();
            WorldImpl::PairsMet met(world, found[block]);
            tree.forPairs(block < amongMoving ? tree : world.staticTree, branches[block],
                          [&](std::uint32_t a, std::uint32_t b) { met.add(a, b); });
            met.ask();
        }
    });
    for (const std::uint32_t shape : world.moveBuffer)
        if (!world.shapes[shape].isStaticTree) tree.stopSeeking(world.shapes[shape].proxy);
    return branches.size();
}

/// The same where few of many have moved: branches that hold one of them are far larger than it, and would meet much that
/// it does not. Of two that both seek, the first one in the order of shapes finds the other.
static std::size_t findPairsOfFew(WorldImpl& world, bool obstaclesToo) {
    constexpr std::size_t kAtOnce = 64;
    auto& found = world.pairSearch.found;
    auto& waiting = world.pairSearch.waiting;
    const std::size_t count = world.moveBuffer.size(), blocks = (count + kAtOnce - 1) / kAtOnce;
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
                const ShapeRecord& shape = world.shapes[world.moveBuffer[i]];
                if (shape.isStaticTree) continue;
                seekers[seeking] = world.moveBuffer[i];
                sought[seeking++] = world.movingTree.bounds(shape.proxy);
            }
            auto& scratch = waiting[static_cast<std::size_t>(worker)];
            world.movingTree.queryAll({sought, seeking}, scratch, [&](std::uint32_t place, std::uint32_t other) {
                const std::uint32_t own = seekers[place];
                if (own < other || (own != other && !world.shapes[other].inMoveBuffer)) met.add(own, other);
            });
            if (obstaclesToo)
                world.staticTree.queryAll({sought, seeking}, scratch, [&](std::uint32_t place, std::uint32_t other) {
                    met.add(seekers[place], other);
                });
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
    const auto all = static_cast<std::size_t>(movingTree.proxyCount());
    const bool few = all > kNear && kFew * moveBuffer.size() < all;
    std::size_t blocks = few ? findPairsOfFew(*this, obstaclesToo) : findPairsOfMany(*this, obstaclesToo);
    auto& found = pairSearch.found;
    bool obstacles = false;
    for (const std::uint32_t shape : moveBuffer) obstacles |= shapes[shape].isStaticTree;
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
    const bool meshA = geometries[shapes[a].geometry].isMesh(), meshB = geometries[shapes[b].geometry].isMesh();
    const bool movesA = moves(shapes[a].body), movesB = moves(shapes[b].body);
    const bool swap = meshA != meshB ? meshB : meshA && movesA != movesB ? movesA : movesA != movesB ? movesB : b < a;
    if (swap) std::swap(a, b);
    const ShapeRecord &shapeA = shapes[a], &shapeB = shapes[b];
    const std::uint32_t index = contactSlots.acquire();
    ++contactsMade;
    if (index >= contacts.size()) contacts.resize(index + 1, {}), contactLinks.resize(index + 1, {});
    ContactRecord& contact = contacts[index];
    contact = {};
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
        const bool walks = geometries[shapeA.geometry].mesh && !meetAsSurfaces(contact);
        contact.nearTriangles = walks ? meshMemory.acquire() : kNone;
    }
    if (contact.sensor) {  // what it overlaps is told at the end of a step, when nothing may grow
        contact.firstManifold = allotManifolds(contact.manifoldCapacity);
        for (ManifoldRecord& manifold : manifoldsOf(contact)) manifold = {}, manifold.contact = index;
    }
    link(contactLinks, bodies[contact.bodyA].firstContact, 2 * index);
    link(contactLinks, bodies[contact.bodyB].firstContact, 2 * index + 1);
    pairs.insert(pairKey(a, b), index);
    if (isAwake(contact.bodyA) || isAwake(contact.bodyB)) addAwakeContact(index);
}

void WorldImpl::destroyContact(std::uint32_t index) {
    ContactRecord& contact = contacts[index];
    forEachManifold(contact, [&](std::uint32_t manifold) {
        manifolds[manifold].pointCount = 0;
        removeFromGraph(manifold);
    });
    releaseManifolds(contact);
    if (contact.isMesh && contact.nearTriangles != kNone) meshMemory.release(contact.nearTriangles);
    if (contact.awakeIndex != kNone) removeAwakeContact(index);
    if (contact.touching) {
        auto& list =
            contact.sensor ? (stepping ? sensorEnds : sensorEndsBetweenSteps) : (stepping ? ends : endsBetweenSteps);
        list.push_back({shapeId(contact.shapeA), shapeId(contact.shapeB), id(contact.bodyA), id(contact.bodyB)});
    }
    unlink(contactLinks, bodies[contact.bodyA].firstContact, 2 * index);
    unlink(contactLinks, bodies[contact.bodyB].firstContact, 2 * index + 1);
    pairs.erase(pairKey(contact.shapeA, contact.shapeB));
    contactSlots.release(index);
}

void WorldImpl::addAwakeContact(std::uint32_t index) {
    contacts[index].awakeIndex = static_cast<std::uint32_t>(awakeContacts.size());
    if (contacts[index].sensor) anySensor.store(true, std::memory_order_relaxed);
    awakeContacts.push(index);
    closingContacts.push(index);
    dirtyContacts.push(index);
}

void WorldImpl::removeAwakeContact(std::uint32_t index) {
    const std::uint32_t place = contacts[index].awakeIndex;
    const std::uint32_t last = awakeContacts.back();
    awakeContacts[place] = last;
    contacts[last].awakeIndex = place;
    awakeContacts.pop();
    contacts[index].awakeIndex = kNone;
}

}  // namespace ragtop
