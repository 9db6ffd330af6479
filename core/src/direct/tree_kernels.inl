// Trees of joints of equal topology side by side in lanes. Included by one source per instruction set.

#include "direct/tree_rows.inl"

namespace ragtop {
namespace {

using direct::TreeGroup;
using direct::TreeLink;

/// The lanes of a group: which bodies they are, and who may be written.
template <class R>
struct TreeLanes {
    static constexpr int W = TreeReal<R>::kLanes;
    TreeGroup& group;
    TreeLane<R>* links;

    RAGTOP_INLINE explicit TreeLanes(TreeGroup& g) : group(g), links(reinterpret_cast<TreeLane<R>*>(g.memory)) {}
    RAGTOP_INLINE TreeNode<R>* parentNode(int l) const {
        return group.links[l].parent < 0 ? nullptr : &links[group.links[l].parent].node;
    }
    template <class Row>
    RAGTOP_INLINE void gather(const Row* rows, const std::uint32_t* index, int offset, R out[8]) const {
        const float* p[W];
        for (int i = 0; i < W; ++i) p[i] = reinterpret_cast<const float*>(rows + index[i]) + offset;
        TreeReal<R>::gather(p, out);
    }
    RAGTOP_INLINE void velocities(const BodyState* states, const std::uint32_t* index, TreeMotion<R>& to,
                                  R& invMass) const {
        R row[8];
        gather(states, index, 0, row);
        to.v = {row[0], row[1], row[2]};
        to.w = {row[4], row[5], row[6]};
        invMass = row[3];
    }
    RAGTOP_INLINE void displacements(const BodyState* states, const std::uint32_t* index, TreeMotion<R>& to) const {
        R row[8];
        gather(states, index, 8, row);
        to.dp = {row[0], row[1], row[2]};
        to.dq = {row[4], row[5], row[6], row[7]};
    }
    const std::uint32_t* states(int l) const { return group.states + l * W; }

    const TreeMotion<R>& motionAbove(int l, const TreeMotion<R>& anchor) const {
        return group.links[l].parent < 0 ? anchor : links[group.links[l].parent].motion;
    }

    /// Mass, pose and velocity of a link.
    RAGTOP_INLINE void load(int l, const BodyArrays& arrays) const {
        TreeLane<R>& link = links[l];
        velocities(arrays.states, states(l), link.motion, link.invMass);
        displacements(arrays.states, states(l), link.motion);
        R row[8];
        gather(arrays.inertia, states(l), 0, row);
        link.inverseInertia = {row[0], row[1], row[2], row[3], row[4], row[5]};
    }

    /// Velocities from the root on, when all momenta have been handed up. Clears lanes of `ok` that have no answer.
    template <class Visit>
    RAGTOP_INLINE void takeVelocities(typename TreeReal<R>::Test& ok, Visit&& visit) const {
        R largest(0.0f);
        for (int l = 0; l < group.linkCount; ++l) {
            TreeNode<R>& node = links[l].node;
            takeVelocity(node, parentNode(l), group.links[l].joint);
            largest = largest + dot(node.v, node.v) + dot(node.w, node.w);
            visit(links[l]);
        }
        ok = ok & (largest * R(0.0f) < R(1.0f));  // false for what is no finite number
    }

    /// Adds the changes to the bodies, and gives the impulses.
    RAGTOP_INLINE void store(const BodyArrays& arrays, typename TreeReal<R>::Test ok) const {
        for (int i = 0; i < group.used; ++i)
            if (!ok.v[i]) group.failed |= 1u << i;
        for (int l = 0; l < group.linkCount; ++l) {
            TreeLane<R>& link = links[l];
            const TreeNode<R>& node = link.node;
            const TreeVec<R> v = link.motion.v + node.v, w = link.motion.w + node.w;
            const R zero(0.0f);
            const R row[8] = {v.x, v.y, v.z, link.invMass, w.x, w.y, w.z, zero};
            const TreeVec<R>&f = link.force, &t = link.torque;
            const R impulse[8] = {f.x, f.y, f.z, zero, t.x, t.y, t.z, zero};
            float *to[W], *given[W];
            for (int i = 0; i < W; ++i) {
                const bool written = i < group.used && ((group.failed >> i) & 1u) == 0;
                to[i] = written ? reinterpret_cast<float*>(arrays.states + states(l)[i]) : nullptr;
                given[i] = written ? group.impulses[l * W + i].force : nullptr;
            }
            TreeReal<R>::scatter(to, row);
            TreeReal<R>::scatter(given, impulse);
        }
    }
};

template <class R>
void beginTrees(TreeGroup& group) {
    const TreeLanes<R> lanes(group);
    constexpr int W = TreeReal<R>::kLanes;
    for (int l = 0; l < group.linkCount; ++l) {
        R row[24];
        for (int part = 0; part < 3; ++part) {
            const float* p[W];
            for (int i = 0; i < W; ++i) p[i] = reinterpret_cast<const float*>(group.joints + l * W + i) + 8 * part;
            TreeReal<R>::gather(p, row + 8 * part);
        }
        TreeLane<R>& link = lanes.links[l];
        link.offset = {row[0], row[1], row[2]};
        link.anchorC = {row[3], row[4], row[5]};
        link.anchorP = {row[6], row[7], row[8]};
        link.frameC = {row[9], row[10], row[11], row[12]};
        link.frameP = {row[13], row[14], row[15], row[16]};
        link.force = {row[17], row[18], row[19]};
        link.torque = {row[20], row[21], row[22]};
    }
}

/// Target, stiffness and resistance of a link's joint, about the spins in `about`.
template <class R>
RAGTOP_INLINE void setUp(const TreeLanes<R>& lanes, int l, const TreeMotion<R>& anchor, R h, R rate) {
    const TreeLink& at = lanes.group.links[l];
    if (at.joint == direct::TreeJoint::free) return;
    TreeLane<R>& link = lanes.links[l];
    TreeLane<R>* parent = at.parent < 0 ? nullptr : &lanes.links[at.parent];
    aim(link, at, lanes.motionAbove(l, anchor), parent ? parent->about : anchor.w, h, rate);
    addStiffness(link, link.load, link.node.armC, h);
    if (parent) addStiffness(*parent, -link.load, link.node.armP, h);
    const R both = admittance(link, link.node.armC) + (parent ? admittance(*parent, link.node.armP) : R(0.0f));
    link.node.resistance = R(kTreeResistance) * both;
    link.node.d = link.node.d + scaled(link.node.resistance, link.load);
}

/// One linearisation from the leaves to the root, a link's whole work in one visit: its memory is some kilobytes, and
/// waits. False lanes of `ok` have no answer, those of the result have links that are very taut.
template <class R>
RAGTOP_INLINE typename TreeReal<R>::Test eliminateTree(const TreeLanes<R>& lanes, const TreeMotion<R>& anchor, R h,
                                                       R rate, typename TreeReal<R>::Test& ok) {
    typename TreeReal<R>::Test taut = R(1.0f) < R(0.0f);
    ok = R(0.0f) < R(1.0f);
    for (int l = lanes.group.linkCount; l-- > 0;) {
        TreeLane<R>& link = lanes.links[l];
        const direct::TreeJoint joint = lanes.group.links[l].joint;
        setUp(lanes, l, anchor, h, rate);
        taut = taut | isVeryTaut(link);
        addInertia(link);
        eliminate(link.node, lanes.parentNode(l), joint, ok);
        passMomentum(link.node, lanes.parentNode(l), joint);
    }
    return taut;
}

template <class R>
void solveTrees(TreeGroup& group, const BodyArrays& arrays, float substep, const Softness& soft) {
    using Test = typename TreeReal<R>::Test;
    const TreeLanes<R> lanes(group);
    const R h(substep), rate(soft.biasRate);
    TreeMotion<R> anchor;
    R none;
    lanes.velocities(arrays.states, group.anchors, anchor, none);
    lanes.displacements(arrays.states, group.anchors, anchor);
    for (int l = 0; l < group.linkCount; ++l) {
        TreeLane<R>& link = lanes.links[l];
        lanes.load(l, arrays);
        link.about = link.motion.w;
        link.load = link.force;
        place(lanes, l, anchor);
        clearSums(link);
    }
    Test ok;
    const Test taut = eliminateTree(lanes, anchor, h, rate, ok);
    group.taut = 0;
    for (int i = 0; i < group.used; ++i)
        if (taut.v[i]) group.taut |= 1u << i;
    if (group.taut != 0) {
        // What taut links turn by is known better once it has been solved.
        lanes.takeVelocities(
            ok, [&](TreeLane<R> & link) __attribute__((always_inline)) {
                link.about = choose(taut, link.motion.w + link.node.w, link.motion.w);
                link.load = choose(taut, link.node.force, link.load);
                clearSums(link);
            });
        eliminateTree(lanes, anchor, h, rate, ok);
    }
    lanes.takeVelocities(
        ok, [](TreeLane<R> & link) __attribute__((always_inline)) {
            link.force = link.node.force;
            link.torque = link.node.torque;
        });
    lanes.store(arrays, ok);
}

template <class R>
void relaxTrees(TreeGroup& group, const BodyArrays& arrays) {
    const TreeLanes<R> lanes(group);
    const TreeVec<R> zero{R(0.0f), R(0.0f), R(0.0f)};
    TreeMotion<R> anchor;
    R none;
    lanes.velocities(arrays.states, group.anchors, anchor, none);
    for (int l = 0; l < group.linkCount; ++l) {
        TreeLane<R>& link = lanes.links[l];
        lanes.velocities(arrays.states, lanes.states(l), link.motion, link.invMass);
        link.node.momentum = {zero, zero};
    }
    for (int l = group.linkCount; l-- > 0;) {
        TreeLane<R>& link = lanes.links[l];
        const direct::TreeJoint joint = group.links[l].joint;
        if (joint == direct::TreeJoint::free) continue;
        ask(link, lanes.motionAbove(l, anchor), link.still, link.stillTurn);
        link.node.d = link.node.d - scaled(link.node.resistance, link.force - link.load);
        passMomentum(link.node, lanes.parentNode(l), joint);
    }
    typename TreeReal<R>::Test ok = R(0.0f) < R(1.0f);
    lanes.takeVelocities(
        ok, [](TreeLane<R> & link) __attribute__((always_inline)) {
            link.force = link.force + link.node.force;
            link.torque = link.torque + link.node.torque;
        });
    lanes.store(arrays, ok);
}

template <class R>
constexpr direct::TreeKernels makeTreeKernels(const char* name) {
    return {name, TreeReal<R>::kLanes, sizeof(TreeLane<R>), beginTrees<R>, solveTrees<R>, relaxTrees<R>};
}
template <int N>
constexpr direct::TreeTables makeTreeTables(const char* name) {
    return {makeTreeKernels<Lanes<N>>(name), makeTreeKernels<DoubleLanes<N / 2>>(name)};
}

}  // namespace
}  // namespace ragtop
