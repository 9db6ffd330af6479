// Trees of joints: which there are, and their passes within the substep (direct/tree_kernels.inl).

#include <algorithm>

#include "constraints/joint_types.h"
#include "world/fallback.h"
#include "world/multirate.h"

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

bool WorldImpl::isTreeJoint(const JointSim& joint) {
    return treeJoint(joint.kind) != direct::TreeJoint::free && isBare(joint);
}
bool WorldImpl::turnsFreely(std::uint32_t body) const {
    return bodies.states[body].locks == 0 && bodies.dynamics[body].spins > 0;
}

/// Draws up the tree of joints that holds `start`, from what it hangs from, or its first body. False, and nothing is
/// built, when it is no tree, or has joints or bodies that trees do not know.
bool WorldImpl::buildTree(std::uint32_t start, BuiltTree& built) {
    built = {};
    directSet.treeBodies.clear();
    directSet.treeBodies.push(start);
    directSet.treeMark[start] = start;
    std::uint32_t root = start, counted = 0;
    bool known = true;
    for (std::size_t i = 0; i < directSet.treeBodies.size(); ++i) {
        const std::uint32_t body = directSet.treeBodies[i];
        known &= turnsFreely(body) && bodies.isAwake(body);
        if (built.anchor == kNone && body < root) root = body;
        for (std::uint32_t key = bodies[body].firstJoint; key != kNone; key = joints.next(key)) {
            if (!joints.isHolding(key >> 1)) continue;
            const JointRecord& joint = joints[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
            const JointSim& sim = joints.sims[key >> 1];
            known &= isTreeJoint(sim);
            built.watched |= isWatched(sim);
            counted += bodies.moves(other) ? 1 : 2;
            if (!bodies.moves(other)) {
                known &= built.anchor == kNone;
                built.anchor = other;
                root = body;
            } else if (directSet.treeMark[other] != start) {
                directSet.treeMark[other] = start;
                directSet.treeBodies.push(other);
            }
        }
    }
    built.bodies = static_cast<std::uint32_t>(directSet.treeBodies.size());
    built.joints = counted / 2;
    // Every joint but those to what does not move has been met from both of its bodies.
    if (!known || built.joints != built.bodies - (built.anchor == kNone ? 1 : 0)) return false;
    layLinks(root, built);
    return true;
}

/// Links breadth first from the root.
void WorldImpl::layLinks(std::uint32_t root, BuiltTree& built) {
    float lightest = bodies[root].mass, heaviest = lightest;
    directSet.treeBodies.clear();
    const auto push = [&](std::uint32_t body, std::int32_t parent, std::uint32_t key) {
        direct::TreeLink link;
        link.parent = parent;
        if (key != kNone) {
            link.joint = treeJoint(joints.sims[key >> 1].kind);
            link.childIsB = joints[key >> 1].bodyB == body ? 1 : 0;
        }
        directSet.treeBodies.push(body);
        directSet.trees.push(link, bodies[body].state, key == kNone ? kNone : key >> 1);
        lightest = bodies[body].mass < lightest ? bodies[body].mass : lightest;
        heaviest = bodies[body].mass > heaviest ? bodies[body].mass : heaviest;
    };
    const auto otherOf = [&](std::uint32_t key) {
        return (key & 1) != 0 ? joints[key >> 1].bodyA : joints[key >> 1].bodyB;
    };
    const auto next = [&](std::uint32_t key) { return joints[key >> 1].edges[key & 1].next; };
    std::uint32_t held = kNone;
    for (std::uint32_t key = bodies[root].firstJoint; key != kNone; key = next(key))
        if (joints.isHolding(key >> 1) && !bodies.moves(otherOf(key))) held = key;
    push(root, -1, held);
    for (std::size_t i = 0; i < directSet.treeBodies.size(); ++i) {
        const std::uint32_t body = directSet.treeBodies[i], above = directSet.trees.builtJoint(i);
        for (std::uint32_t key = bodies[body].firstJoint; key != kNone; key = next(key))
            if ((key >> 1) != above && bodies.moves(otherOf(key)))
                push(otherOf(key), static_cast<std::int32_t>(i), key);
    }
    built.doublePrecision = heaviest > kSingleRatio * lightest;
}

/// Does a module name bodies of it, to push them? What watches all bodies names none, and changes nothing.
static bool isNamed(const WorldImpl& world, const DirectIsland& island) {
    const ModuleWork& work = world.moduleWork;
    const std::uint32_t* first = world.directSet.bodies.data() + island.firstBody;
    return std::any_of(first, first + island.bodyCount,
                       [&](std::uint32_t body) { return body < work.namer.size() && work.namer[body] != 0; });
}

/// Direct islands that are trees of rigid rows and touch nothing; chooseStepFactors groups them. Leapfrog trees have
/// half of their forces in a step's first substep: a module that holds them against all of them would move them.
void WorldImpl::planChains() {
    directSet.trees.clear();
    if (directSet.islands.empty()) return;
    directSet.treeMark.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : bodies.awake) directSet.treeMark[body] = kNone;
    for (std::size_t i = 0; i < directSet.islands.size(); ++i) {
        DirectIsland& island = directSet.islands[i];
        island.tree = island.watched = island.leapfrog = island.multirate = false;
        if (island.contactCount > 0 || island.jointCount == 0) continue;
        BuiltTree tree;
        if (!buildTree(directSet.bodies[island.firstBody], tree)) continue;
        island.tree = tree.joints == island.jointCount && tree.bodies == island.bodyCount;
        island.watched = tree.watched;
        tree.doublePrecision |= isNamed(*this, island);
        island.leapfrog = island.tree && !tree.doublePrecision;
        island.multirate = island.tree && tree.doublePrecision && tree.anchor != kNone && !tree.watched;
        if (island.tree)
            directSet.trees.keep(tree.anchor == kNone ? 0 : bodies[tree.anchor].state, static_cast<std::uint32_t>(i),
                                 tree.doublePrecision);
        else
            directSet.trees.drop();
    }
}

/// Rows and loads of this step.
void WorldImpl::beginGroup(direct::TreePlan::Group& group) {
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const direct::TreePlan::Tree& tree = directSet.trees.treeOf(group, lane);
        directSet.islands[tree.owner].begin();
        for (int l = 0; l < group.lanes.linkCount; ++l) {
            direct::TreeJointRow& row = directSet.trees.row(group, l, lane);
            row = {};
            const direct::TreeLink& link = directSet.trees.linkOf(tree, l);
            if (link.joint != direct::TreeJoint::free)
                fillRow(joints.sims[directSet.trees.jointOf(tree, l)], link.childIsB != 0, tree.stepFactor, row);
        }
    }
    directSet.trees.repeatRows(group);
    group.lanes.failed = group.lanes.open = group.lanes.notClosed = 0;
    group.kernels->begin(group.lanes, bodies.arrays());
}

/// In parallel, those that take part in the substeps of the world.
template <class Visit>
static void forEachChainGroup(WorldImpl& world, Visit&& visit) {
    direct::TreePlan& trees = world.directSet.trees;
    world.runner.parallelFor(static_cast<int>(trees.groupCount(false)), 1, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) visit(trees.groupAt(false, static_cast<std::size_t>(i)));
    });
}
void WorldImpl::beginChains() {
    forEachChainGroup(*this, [&](direct::TreePlan::Group& group) { beginGroup(group); });
}
void WorldImpl::solveChains(DirectPass pass) {
    forEachChainGroup(*this, [&](direct::TreePlan::Group& group) { solveGroup(group, pass, context.substep); });
}

/// What is to be done in a substep of the world.
void WorldImpl::solveGroup(direct::TreePlan::Group& group, DirectPass pass, int number) {
    const bool moves = pass == DirectPass::positions;
    const int stepFactor = directSet.trees.stepFactorOf(group);
    if (number % stepFactor != 0) return;
    const auto start = std::chrono::steady_clock::now();
    const auto substeps = static_cast<float>(stepFactor);
    const bool last = number + stepFactor >= settings.substeps;
    const direct::TreeSubstep substep{context.h * substeps, jointContext.softness.biasRate / substeps, number == 0, last};
    const bool relaxes = !group.kernels->leapfrog || last;
    (moves ? group.kernels->solve : group.kernels->relax)(group.lanes, bodies.arrays(), substep);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const direct::TreePlan::Tree& tree = directSet.trees.treeOf(group, lane);
        DirectIsland& island = directSet.islands[tree.owner];
        const auto has = [lane](std::uint32_t bits) { return ((bits >> lane) & 1u) != 0; };
        island.ms += ms / group.lanes.used;
        island.open = has(group.lanes.open);
        island.notClosed = has(group.lanes.notClosed);
        if (island.fellBack) {
            iterateIsland(*this, island, pass);
            continue;
        }
        if (has(group.lanes.failed)) {
            fallBack(*this, island, pass);
            continue;
        }
        if (moves) {
            const bool taut = has(group.lanes.taut);
            island.report.iterations += taut || group.kernels->leapfrog ? 2 : 1;
            island.report.factorizations += taut ? 2 : 1;
        } else {
            island.report.iterations += relaxes;
            island.report.factorizations += relaxes && group.kernels->leapfrog;
            if (last || island.watched) storeImpulses(group, lane);
        }
    }
}

void WorldImpl::storeImpulses(const direct::TreePlan::Group& group, int lane) {
    const direct::TreePlan::Tree& tree = directSet.trees.treeOf(group, lane);
    for (int l = 0; l < group.lanes.linkCount; ++l) {
        const direct::TreeLink& link = directSet.trees.linkOf(tree, l);
        if (link.joint == direct::TreeJoint::free) continue;
        JointSim& joint = joints.sims[directSet.trees.jointOf(tree, l)];
        const direct::TreeImpulse& impulse = directSet.trees.impulse(group, l, lane);
        const float sign = (link.childIsB != 0 ? 1.0f : -1.0f) / static_cast<float>(tree.stepFactor);
        joint.block.impulseFirst = sign * get(impulse.force);
        joint.block.impulseSecond = sign * get(impulse.torque);
        if (!isWatched(joint)) continue;
        // Turns of a hinge are counted.
        refreshJoint(joint, BodyPair(bodies.states.data(), bodies.inertias.data(), joint.stateA, joint.stateB),
                     {jointContext, false});
        recordLoad(joint);
    }
}

}  // namespace ragtop
