// Trees of joints: which there are, and their passes within the substep (direct/tree_kernels.inl).

#include <algorithm>
#include <chrono>

#include "constraints/joint_counts.h"
#include "constraints/joint_types.h"
#include "islands/direct_view.h"

namespace ragtop {

namespace {

constexpr float kSingleRatio = 30;  ///< ratio of masses up to which single precision has digits enough

direct::TreeJoint treeJoint(JointKind kind) {
    switch (kind) {
        case JointKind::ball:
            return direct::TreeJoint::ball;
        case JointKind::hinge:
            return direct::TreeJoint::hinge;
        case JointKind::fixed:
            return direct::TreeJoint::fixed;
        default:
            return direct::TreeJoint::free;  // none that trees know
    }
}

/// Nothing but rigid rows.
bool isBare(const JointSim& joint) {
    return joint.kind == JointKind::ball ? joint.ball.features == 0 : joint.axis.features == 0;
}

/// Its state is followed, or it may break: its impulses are wanted after every substep.
bool isWatched(const JointSim& joint) { return joint.kind == JointKind::hinge || joint.breakable != 0; }

void put(const Vec3& from, float to[3]) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }
void put(const Quat& from, float to[4]) { to[0] = from.x, to[1] = from.y, to[2] = from.z, to[3] = from.w; }
Vec3 get(const float from[3]) { return {from[0], from[1], from[2]}; }

/// Loads are those of `stepFactor` substeps, of which the joint knows one.
void fillRow(const JointSim& joint, bool childIsB, int stepFactor, direct::TreeJointRow& row) {
    const float sign = childIsB ? 1.0f : -1.0f, share = sign * static_cast<float>(stepFactor);
    put(sign * joint.centerOffset, row.offset);
    put(childIsB ? joint.anchorB : joint.anchorA, row.anchorC);
    put(childIsB ? joint.anchorA : joint.anchorB, row.anchorP);
    put(childIsB ? joint.frameB : joint.frameA, row.frameC);
    put(childIsB ? joint.frameA : joint.frameB, row.frameP);
    put(share * joint.block.impulseFirst, row.force);
    put(share * joint.block.impulseSecond, row.torque);
}

}  // namespace

bool isTreeJoint(const JointSim& joint) { return treeJoint(joint.kind) != direct::TreeJoint::free && isBare(joint); }
bool turnsFreely(const Bodies& bodies, std::uint32_t body) {
    return bodies.states[body].locks == 0 && bodies.dynamics[body].spins > 0;
}

/// Links breadth first from the root.
static void layLinks(const DirectView& d, std::uint32_t root, BuiltTree& built) {
    float lightest = d.bodies[root].mass, heaviest = lightest;
    d.directSet.treeBodies.clear();
    const auto push = [&](std::uint32_t body, std::int32_t parent, std::uint32_t key) {
        direct::TreeLink link;
        link.parent = parent;
        if (key != kNone) {
            link.joint = treeJoint(d.joints.sims[key >> 1].kind);
            link.childIsB = d.joints[key >> 1].bodyB == body ? 1 : 0;
        }
        d.directSet.treeBodies.push(body);
        d.directSet.trees.push(link, d.bodies[body].state, key == kNone ? kNone : key >> 1);
        lightest = d.bodies[body].mass < lightest ? d.bodies[body].mass : lightest;
        heaviest = d.bodies[body].mass > heaviest ? d.bodies[body].mass : heaviest;
    };
    const auto otherOf = [&](std::uint32_t key) {
        return (key & 1) != 0 ? d.joints[key >> 1].bodyA : d.joints[key >> 1].bodyB;
    };
    const auto next = [&](std::uint32_t key) { return d.joints[key >> 1].edges[key & 1].next; };
    std::uint32_t held = kNone;
    for (std::uint32_t key = d.bodies[root].firstJoint; key != kNone; key = next(key))
        if (d.joints.isHolding(key >> 1) && !d.bodies.moves(otherOf(key))) held = key;
    push(root, -1, held);
    for (std::size_t i = 0; i < d.directSet.treeBodies.size(); ++i) {
        const std::uint32_t body = d.directSet.treeBodies[i], above = d.directSet.trees.builtJoint(i);
        for (std::uint32_t key = d.bodies[body].firstJoint; key != kNone; key = next(key))
            if ((key >> 1) != above && d.bodies.moves(otherOf(key)))
                push(otherOf(key), static_cast<std::int32_t>(i), key);
    }
    built.doublePrecision = heaviest > kSingleRatio * lightest;
}

/// Draws up the tree of joints that holds `start`, from what it hangs from, or its first body. False, and nothing is
/// built, when it is no tree, or has joints or bodies that trees do not know.
static bool buildTree(const DirectView& d, std::uint32_t start, BuiltTree& built) {
    built = {};
    d.directSet.treeBodies.clear();
    d.directSet.treeBodies.push(start);
    d.directSet.treeMark[start] = start;
    std::uint32_t root = start, counted = 0;
    bool known = true;
    for (std::size_t i = 0; i < d.directSet.treeBodies.size(); ++i) {
        const std::uint32_t body = d.directSet.treeBodies[i];
        known &= turnsFreely(d.bodies, body) && d.bodies.isAwake(body);
        if (built.anchor == kNone && body < root) root = body;
        for (std::uint32_t key = d.bodies[body].firstJoint; key != kNone; key = d.joints.next(key)) {
            if (!d.joints.isHolding(key >> 1)) continue;
            const JointRecord& joint = d.joints[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
            const JointSim& sim = d.joints.sims[key >> 1];
            known &= isTreeJoint(sim);
            built.watched |= isWatched(sim);
            counted += d.bodies.moves(other) ? 1 : 2;
            if (!d.bodies.moves(other)) {
                known &= built.anchor == kNone;
                built.anchor = other;
                root = body;
            } else if (d.directSet.treeMark[other] != start) {
                d.directSet.treeMark[other] = start;
                d.directSet.treeBodies.push(other);
            }
        }
    }
    built.bodies = static_cast<std::uint32_t>(d.directSet.treeBodies.size());
    built.joints = counted / 2;
    // Every joint but those to what does not move has been met from both of its bodies.
    if (!known || built.joints != built.bodies - (built.anchor == kNone ? 1 : 0)) return false;
    layLinks(d, root, built);
    return true;
}

/// Does a module name bodies of it, to push them? What watches all bodies names none, and changes nothing.
static bool isNamed(const DirectView& d, const DirectIsland& island) {
    const std::uint32_t* first = d.directSet.bodies.data() + island.firstBody;
    return std::any_of(first, first + island.bodyCount, [&](std::uint32_t body) { return d.moduleWork.names(body); });
}

void planChains(const DirectView& d) {
    d.directSet.trees.clear();
    if (d.directSet.islands.empty()) return;
    d.directSet.treeMark.resizeForOverwrite(d.bodies.size());
    for (const std::uint32_t body : d.bodies.awake) d.directSet.treeMark[body] = kNone;
    for (std::size_t i = 0; i < d.directSet.islands.size(); ++i) {
        DirectIsland& island = d.directSet.islands[i];
        island.tree = island.watched = island.leapfrog = island.multirate = false;
        if (island.contactCount > 0 || island.jointCount == 0) continue;
        BuiltTree tree;
        if (!buildTree(d, d.directSet.bodies[island.firstBody], tree)) continue;
        island.tree = tree.joints == island.jointCount && tree.bodies == island.bodyCount;
        island.watched = tree.watched;
        tree.doublePrecision |= isNamed(d, island);
        island.leapfrog = island.tree && !tree.doublePrecision;
        island.multirate = island.tree && tree.doublePrecision && tree.anchor != kNone && !tree.watched;
        if (island.tree)
            d.directSet.trees.keep(tree.anchor == kNone ? 0 : d.bodies[tree.anchor].state,
                                   static_cast<std::uint32_t>(i), tree.doublePrecision);
        else
            d.directSet.trees.drop();
    }
}

void beginGroup(const DirectView& d, direct::TreePlan::Group& group) {
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const direct::TreePlan::Tree& tree = d.directSet.trees.treeOf(group, lane);
        d.directSet.islands[tree.owner].begin();
        for (int l = 0; l < group.lanes.linkCount; ++l) {
            direct::TreeJointRow& row = d.directSet.trees.row(group, l, lane);
            row = {};
            const direct::TreeLink& link = d.directSet.trees.linkOf(tree, l);
            if (link.joint != direct::TreeJoint::free)
                fillRow(d.joints.sims[d.directSet.trees.jointOf(tree, l)], link.childIsB != 0, tree.stepFactor, row);
        }
    }
    d.directSet.trees.repeatRows(group);
    group.lanes.failed = group.lanes.open = group.lanes.notClosed = 0;
    group.kernels->begin(group.lanes, d.bodies.arrays());
}

/// In parallel, those that take part in the substeps of the world.
template <class Visit>
static void forEachChainGroup(const DirectView& d, Visit&& visit) {
    direct::TreePlan& trees = d.directSet.trees;
    d.runner.parallelFor(static_cast<int>(trees.groupCount(false)), 1, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) visit(trees.groupAt(false, static_cast<std::size_t>(i)));
    });
}

void beginChains(const DirectView& d) {
    forEachChainGroup(d, [&](direct::TreePlan::Group& group) { beginGroup(d, group); });
}

static void storeImpulses(const DirectView& d, const direct::TreePlan::Group& group, int lane) {
    const direct::TreePlan::Tree& tree = d.directSet.trees.treeOf(group, lane);
    for (int l = 0; l < group.lanes.linkCount; ++l) {
        const direct::TreeLink& link = d.directSet.trees.linkOf(tree, l);
        if (link.joint == direct::TreeJoint::free) continue;
        JointSim& joint = d.joints.sims[d.directSet.trees.jointOf(tree, l)];
        const direct::TreeImpulse& impulse = d.directSet.trees.impulse(group, l, lane);
        const float sign = (link.childIsB != 0 ? 1.0f : -1.0f) / static_cast<float>(tree.stepFactor);
        joint.block.impulseFirst = sign * get(impulse.force);
        joint.block.impulseSecond = sign * get(impulse.torque);
        if (!isWatched(joint)) continue;
        // Turns of a hinge are counted.
        refreshJoint(joint, BodyPair(d.bodies.states.data(), d.bodies.inertias.data(), joint.stateA, joint.stateB),
                     {d.jointContext, false});
        recordLoad(joint);
    }
}

void solveGroup(const DirectView& d, direct::TreePlan::Group& group, DirectPass pass, int number) {
    const bool moves = pass == DirectPass::positions;
    const int stepFactor = d.directSet.trees.stepFactorOf(group);
    if (number % stepFactor != 0) return;
    const auto start = std::chrono::steady_clock::now();
    const auto substeps = static_cast<float>(stepFactor);
    const bool last = number + stepFactor >= d.substeps;
    const direct::TreeSubstep substep{d.context.h * substeps, d.jointContext.softness.biasRate / substeps, number == 0,
                                      last};
    const bool relaxes = !group.kernels->leapfrog || last;
    (moves ? group.kernels->solve : group.kernels->relax)(group.lanes, d.bodies.arrays(), substep);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const direct::TreePlan::Tree& tree = d.directSet.trees.treeOf(group, lane);
        DirectIsland& island = d.directSet.islands[tree.owner];
        const auto has = [lane](std::uint32_t bits) { return ((bits >> lane) & 1u) != 0; };
        island.ms += ms / group.lanes.used;
        island.open = has(group.lanes.open);
        island.notClosed = has(group.lanes.notClosed);
        if (island.fellBack) {
            iterateIsland(d, island, pass);
            continue;
        }
        if (has(group.lanes.failed)) {
            fallBack(d, island, pass);
            continue;
        }
        if (moves) {
            const bool taut = has(group.lanes.taut);
            island.report.iterations += taut || group.kernels->leapfrog ? 2 : 1;
            island.report.factorizations += taut ? 2 : 1;
        } else {
            island.report.iterations += relaxes;
            island.report.factorizations += relaxes && group.kernels->leapfrog;
            if (last || island.watched) storeImpulses(d, group, lane);
        }
    }
}

void solveChains(const DirectView& d, DirectPass pass) {
    forEachChainGroup(d, [&](direct::TreePlan::Group& group) { solveGroup(d, group, pass, d.context.substep); });
}

void recordGaps(const DirectView& d, const DirectIsland& island) {
    constexpr std::uint8_t kHysteresisSteps = 16;  // a quarter of a second at 60 Hz
    const BodyRecord& first = d.bodies[d.directSet.bodies[island.firstBody]];
    int stepFactor = first.direct.pace.allowedFactor, calm = island.notClosed ? 0 : first.direct.pace.calm;
    if (island.open || island.fellBack) {
        stepFactor = std::max(stepFactor / 2, 1);
    } else if (!island.notClosed && ++calm >= kHysteresisSteps) {
        stepFactor = std::min(2 * stepFactor, direct::TreePlan::kLongestFactor);
        calm = 0;
    }
    if (island.fellBack)
        rescaleJoints(d.joints, d.directSet, island, 1 / static_cast<float>(first.direct.pace.stepFactor));
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const std::uint32_t body = d.directSet.bodies[island.firstBody + i];
        d.bodies[body].direct.pace.allowedFactor = static_cast<std::uint8_t>(stepFactor) & 7u;
        d.bodies[body].direct.pace.calm = static_cast<std::uint8_t>(calm);
    }
}

}  // namespace ragtop
