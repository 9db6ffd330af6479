#include "islands/articulations.h"

#include "base/union_find.h"

namespace ragtop {

namespace {

constexpr std::uint32_t kMostBodies = 32;  ///< of a free tree
constexpr float kMostUnequal = 16;         ///< ratio of the masses that a free tree's joint holds together

/// Has neither body another joint, nor the joint a coupling?
bool isIsolated(const ConstTables& t, std::uint32_t joint) {
    const JointRecord& record = t.joints[joint];
    const auto isOnly = [&](std::uint32_t body, std::uint32_t side) {
        return !t.bodies.moves(body) ||
               (t.bodies[body].firstJoint == 2 * joint + side && record.edges[side].next == kNone);
    };
    return record.firstCoupling == kNone && isOnly(record.bodyA, 0) && isOnly(record.bodyB, 1);
}

}  // namespace

/// Groups the bodies of this step's joints. State 0 stands for all that does not move: what is joined to it swings, and
/// is left out, as is what moves along some axes only, and trees whose speeds are those of the middle of a substep.
void Articulations::find(const ConstTables& t, const DirectSet& direct) {
    fresh_ = !known_;
    if (known_) return;
    known_ = true;
    bodies_.clear();
    starts_.clear();
    bool joined = false;
    for (int c = 0; c < t.graph.listCount(); ++c) joined |= !t.graph.color(c).joints.empty();
    if (!joined) return;
    parent_.resizeForOverwrite(t.bodies.size());
    parent_[0] = 0;
    for (const std::uint32_t body : t.bodies.awake) parent_[body] = t.bodies.states[body].locks != 0 ? 0 : body;
    const auto place = [&](std::uint32_t body) { return t.bodies.moves(body) ? rootOf(parent_, body) : 0u; };
    for (int c = 0; c < t.graph.listCount(); ++c)
        for (const std::uint32_t joint : t.graph.color(c).joints)
            unite(parent_, place(t.joints[joint].bodyA), place(t.joints[joint].bodyB));  // what does not move wins
    for (const DirectIsland& island : direct.islands)
        if (island.leapfrog) parent_[place(direct.bodies[island.firstBody])] = 0;
    countJoints(t);
    list(t);
}

/// Counts, then places, per root in the order of the list of awake bodies.
void Articulations::list(const ConstTables& t) {
    const auto place = [&](std::uint32_t body) { return t.bodies.moves(body) ? rootOf(parent_, body) : 0u; };
    place_.resizeForOverwrite(t.bodies.size());
    for (const std::uint32_t body : t.bodies.awake) place_[body] = 0;
    const auto rootOfMember = [&](std::uint32_t body) { return t.bodies[body].firstJoint != kNone ? place(body) : 0u; };
    for (const std::uint32_t body : t.bodies.awake)
        if (const std::uint32_t root = rootOfMember(body); root != 0) ++place_[root];
    std::uint32_t total = 0;
    for (const std::uint32_t body : t.bodies.awake) {
        const std::uint32_t count = place_[body];
        if (count == 0) continue;
        isFreeTree_[body] = count <= kMostBodies && jointCount_[body] + 1 == count ? 1 : 0;
        starts_.push(total);
        place_[body] = total;
        total += count;
    }
    starts_.push(total);
    bodies_.resizeForOverwrite(total);
    masses_.resizeForOverwrite(total);
    for (const std::uint32_t body : t.bodies.awake)
        if (const std::uint32_t root = rootOfMember(body); root != 0) {
            masses_[place_[root]] = t.bodies[body].mass;
            bodies_[place_[root]++] = body;
            parent_[body] = root;
        }
}

/// Per root, kNone where bodies are too unequal for a free tree; what hangs from the world counts for none.
void Articulations::countJoints(const ConstTables& t) {
    jointCount_.resizeForOverwrite(t.bodies.size());
    isFreeTree_.resizeForOverwrite(t.bodies.size());
    jointCount_[0] = isFreeTree_[0] = 0;
    for (const std::uint32_t body : t.bodies.awake) jointCount_[body] = isFreeTree_[body] = 0;
    for (int c = 0; c < t.graph.listCount(); ++c)
        for (const std::uint32_t joint : t.graph.color(c).joints) {
            const JointRecord& record = t.joints[joint];
            std::uint32_t& count =
                jointCount_[rootOf(parent_, t.bodies.moves(record.bodyA) ? record.bodyA : record.bodyB)];
            const float a = t.bodies[record.bodyA].mass, b = t.bodies[record.bodyB].mass;
            const bool unequal = a > kMostUnequal * b || b > kMostUnequal * a;
            count = unequal || count == kNone ? kNone : count + 1;
        }
}

/// A free tree is one of a few dozen bodies, not too unequal, that joints hold together and that hangs from nothing.
/// The iteration comes so close to its solution that its joints need no leak. Of loops, and of heavy loads on chains,
/// they do not. Joints along which bodies travel are not among them: a curved way leaves errors that are not those of
/// turning.
bool Articulations::isOfFreeTree(const ConstTables& t, std::uint32_t joint) const {
    const JointRecord& record = t.joints[joint];
    const JointKind kind = t.joints.sims[joint].kind;
    if (kind != JointKind::ball && kind != JointKind::hinge && kind != JointKind::fixed) return false;
    if (!t.bodies.moves(record.bodyA) || !t.bodies.moves(record.bodyB)) return false;
    return isFreeTree_[parent_[record.bodyA]] != 0;
}

/// With whom a joint is solved.
void Articulations::classify(const ConstTables& t, std::uint32_t joint, JointSim& sim) const {
    sim.ofFreeTree = isOfFreeTree(t, joint) ? 1.0f : 0.0f;
    if (hasAxes(sim.kind)) withAxes(sim).axes.isIsolated = isIsolated(t, joint) ? 1 : 0;
}

void Articulations::move(std::uint32_t i, float h, Bodies& bodies) const {
    const std::uint32_t first = starts_[i], last = starts_[i + 1];
    float mass = 0;
    Vec3 now, before;
    for (std::uint32_t k = first; k < last; ++k) {
        const std::uint32_t body = bodies_[k];
        const float m = masses_[k];
        mass += m;
        now += m * (bodies.states[body].v - bodies.histories[body].velocityBefore);
        before += m * bodies.histories[body].lastChange;
    }
    const float square = lengthSquared(now), along = dot(before, now);
    if (!(square > 0) || !(along > 0)) return;
    const float share = along < square ? along / square : 1.0f;
    const Vec3 smooth = (0.5f * h * share / mass) * now;
    for (std::uint32_t k = first; k < last; ++k) bodies.states[bodies_[k]].dp -= smooth;
}

}  // namespace ragtop
