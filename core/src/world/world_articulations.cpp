#include "world/world_impl.h"

/// Bodies that joints hold together, and nothing else holds: they fly as one body does.
namespace ragtop {

namespace {

constexpr std::uint32_t kMostBodies = 32;  ///< of a free tree
constexpr float kMostUnequal = 16;         ///< ratio of the masses that a free tree's joint holds together

std::uint32_t rootOf(AlignedArray<std::uint32_t>& parent, std::uint32_t body) {
    while (parent[body] != body) {
        parent[body] = parent[parent[body]];
        body = parent[body];
    }
    return body;
}

/// Has neither body another joint, nor the joint a coupling?
bool isIsolated(const WorldImpl& world, std::uint32_t joint) {
    const JointRecord& record = world.joints[joint];
    const auto isOnly = [&](std::uint32_t body, std::uint32_t side) {
        return !world.moves(body) ||
               (world.bodies[body].firstJoint == 2 * joint + side && record.edges[side].next == kNone);
    };
    return record.firstCoupling == kNone && isOnly(record.bodyA, 0) && isOnly(record.bodyB, 1);
}

}  // namespace

/// Groups the bodies of this step's joints. State 0 stands for all that does not move: what is joined to it swings, and
/// is left out, as is what moves along some axes only, and trees whose speeds are those of the middle of a substep.
void WorldImpl::findArticulations() {
    articulations.fresh = !articulations.known;
    if (articulations.known) return;
    articulations.known = true;
    articulations.bodies.clear();
    articulations.starts.clear();
    bool joined = false;
    for (int c = 0; c < graph.listCount(); ++c) joined |= !graph.color(c).joints.empty();
    if (!joined) return;
    articulations.parent.resizeForOverwrite(bodies.size());
    articulations.parent[0] = 0;
    for (const std::uint32_t body : awakeBodies) articulations.parent[body] = states[body].locks != 0 ? 0 : body;
    const auto place = [&](std::uint32_t body) { return moves(body) ? rootOf(articulations.parent, body) : 0u; };
    for (int c = 0; c < graph.listCount(); ++c)
        for (const std::uint32_t joint : graph.color(c).joints) {
            const std::uint32_t a = place(joints[joint].bodyA), b = place(joints[joint].bodyB);
            // The lower index becomes the root, so that what does not move wins.
            articulations.parent[a < b ? b : a] = a < b ? a : b;
        }
    for (const DirectIsland& island : directIslands)
        if (island.leapfrog) articulations.parent[place(directBodies[island.firstBody])] = 0;
    countJointsOfArticulations();
    listArticulations();
}

/// Counts, then places, per root in the order of the list of awake bodies.
void WorldImpl::listArticulations() {
    const auto place = [&](std::uint32_t body) { return moves(body) ? rootOf(articulations.parent, body) : 0u; };
    articulations.place.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : awakeBodies) articulations.place[body] = 0;
    const auto rootOfMember = [&](std::uint32_t body) { return bodies[body].firstJoint != kNone ? place(body) : 0u; };
    for (const std::uint32_t body : awakeBodies)
        if (const std::uint32_t root = rootOfMember(body); root != 0) ++articulations.place[root];
    std::uint32_t total = 0;
    for (const std::uint32_t body : awakeBodies) {
        const std::uint32_t count = articulations.place[body];
        if (count == 0) continue;
        articulations.isFreeTree[body] = count <= kMostBodies && articulations.joints[body] + 1 == count ? 1 : 0;
        articulations.starts.push(total);
        articulations.place[body] = total;
        total += count;
    }
    articulations.starts.push(total);
    articulations.bodies.resizeForOverwrite(total);
    articulations.masses.resizeForOverwrite(total);
    for (const std::uint32_t body : awakeBodies)
        if (const std::uint32_t root = rootOfMember(body); root != 0) {
            articulations.masses[articulations.place[root]] = bodies[body].mass;
            articulations.bodies[articulations.place[root]++] = body;
            articulations.parent[body] = root;
        }
}

/// Per root, kNone where bodies are too unequal for a free tree; what hangs from the world counts for none.
void WorldImpl::countJointsOfArticulations() {
    articulations.joints.resizeForOverwrite(bodies.size());
    articulations.isFreeTree.resizeForOverwrite(bodies.size());
    articulations.joints[0] = articulations.isFreeTree[0] = 0;
    for (const std::uint32_t body : awakeBodies) articulations.joints[body] = articulations.isFreeTree[body] = 0;
    for (int c = 0; c < graph.listCount(); ++c)
        for (const std::uint32_t joint : graph.color(c).joints) {
            const JointRecord& record = joints[joint];
            std::uint32_t& count =
                articulations.joints[rootOf(articulations.parent, moves(record.bodyA) ? record.bodyA : record.bodyB)];
            const float a = bodies[record.bodyA].mass, b = bodies[record.bodyB].mass;
            const bool unequal = a > kMostUnequal * b || b > kMostUnequal * a;
            count = unequal || count == kNone ? kNone : count + 1;
        }
}

/// A free tree is one of a few dozen bodies, not too unequal, that joints hold together and that hangs from nothing.
/// The iteration comes so close to its solution that its joints need no leak. Of loops, and of heavy loads on chains,
/// they do not. Joints along which bodies travel are not among them: a curved way leaves errors that are not those of
/// turning.
bool WorldImpl::isOfFreeTree(std::uint32_t joint) const {
    const JointRecord& record = joints[joint];
    const JointKind kind = jointSims[joint].kind;
    if (kind != JointKind::ball && kind != JointKind::hinge && kind != JointKind::fixed) return false;
    if (!moves(record.bodyA) || !moves(record.bodyB)) return false;
    return articulations.isFreeTree[articulations.parent[record.bodyA]] != 0;
}

/// With whom a joint is solved.
void WorldImpl::classifyJoint(std::uint32_t joint) {
    JointSim& sim = jointSims[joint];
    sim.ofFreeTree = isOfFreeTree(joint) ? 1.0f : 0.0f;
    sim.axes.isIsolated = hasAxes(sim.kind) && isIsolated(*this, joint) ? 1 : 0;
}

/// The position map of integratePositions for the common motion of an articulation: its centre of mass moves by h v − ½
/// h² a with the smooth part of its acceleration, and all its bodies alike, so that no joint is strained.
void WorldImpl::moveArticulation(std::uint32_t i) {
    const std::uint32_t first = articulations.starts[i], last = articulations.starts[i + 1];
    float mass = 0;
    Vec3 now, before;
    for (std::uint32_t k = first; k < last; ++k) {
        const std::uint32_t body = articulations.bodies[k];
        const float m = articulations.masses[k];
        mass += m;
        now += m * (states[body].v - histories[body].velocityBefore);
        before += m * histories[body].lastChange;
    }
    const float square = lengthSquared(now), along = dot(before, now);
    if (!(square > 0) || !(along > 0)) return;
    const float share = along < square ? along / square : 1.0f;
    const Vec3 smooth = (0.5f * context.h * share / mass) * now;
    for (std::uint32_t k = first; k < last; ++k) states[articulations.bodies[k]].dp -= smooth;
}

void WorldImpl::moveArticulations() {
    const int count = articulations.starts.empty() ? 0 : static_cast<int>(articulations.starts.size()) - 1;
    runner.parallelFor(count, 16, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) moveArticulation(static_cast<std::uint32_t>(i));
    });
}

}  // namespace ragtop
