// Trees of joints of equal topology side by side in lanes. Included by one source per instruction set.

#include "direct/tree_ball_chains.inl"

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
    RAGTOP_INLINE bool isBallChain(int l) const { return group.links[l].below != direct::kNoBallChain; }
    RAGTOP_INLINE bool isBelowBallChain(int l) const { return group.links[l].parent >= 0 && isBallChain(group.links[l].parent); }
    RAGTOP_INLINE TreeNode<R>* nodeBelow(int l) const {
        return group.links[l].below < 0 ? nullptr : &links[group.links[l].below].node;
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

    /// Half of a substep's forces that are not to act yet, or are still to act: `kick` seconds of them.
    RAGTOP_INLINE void push(TreeLane<R>& link, R kick) const {
        link.motion.fine = link.motion.fine + scaled(kick, link.acceleration);
        link.motion.w = link.motion.w + scaled(kick, link.inverseInertia * link.moment);
    }

    /// Masses, poses and velocities, and where the joints are.
    RAGTOP_INLINE void loadAll(const BodyArrays& arrays, TreeMotion<R>& anchor) const {
        loadAnchor(arrays, anchor);
        for (int l = 0; l < group.linkCount; ++l) {
            load(l, arrays);
            place(*this, l, anchor);
            clearSums(links[l]);
        }
    }
    RAGTOP_INLINE void loadAnchor(const BodyArrays& arrays, TreeMotion<R>& anchor) const {
        const R zero(0.0f);
        R none;
        velocities(arrays.states, group.anchors, anchor, none);
        displacements(arrays.states, group.anchors, anchor);
        anchor.fine = {zero, zero, zero};
    }

    /// Velocities from the root on, when all momenta have been handed up.
    template <class Visit>
    RAGTOP_INLINE void takeVelocities(Visit&& visit) const {
        for (int l = 0; l < group.linkCount; ++l) {
            TreeNode<R>& node = links[l].node;
            if (isBallChain(l)) {
                if (!isBelowBallChain(l)) takeImpulse(node, parentNode(l));
                takeBallChainVelocity(links[l], nodeBelow(l));
            } else {
                takeVelocity(node, parentNode(l), group.links[l].joint, isBelowBallChain(l));
            }
            visit(links[l]);
        }
    }
    /// The same to the end. Clears lanes of `ok` that have no answer.
    template <class Visit>
    RAGTOP_INLINE void takeLastVelocities(typename TreeReal<R>::Test& ok, Visit&& visit) const {
        R largest(0.0f);
        takeVelocities([&](TreeLane<R> & link) __attribute__((always_inline)) {
            const TreeNode<R>& node = link.node;
            largest = largest + dot(node.v, node.v) + dot(node.w, node.w);
            visit(link);
        });
        ok = ok & (largest * R(0.0f) < R(1.0f));  // false for what is no finite number
    }

    /// Adds the changes to the bodies, and gives the impulses. What single precision leaves out of a velocity is kept.
    RAGTOP_INLINE void store(const BodyArrays& arrays, typename TreeReal<R>::Test ok) const {
        for (int i = 0; i < group.used; ++i)
            if (!ok.v[i]) group.failed |= 1u << i;
        for (int l = 0; l < group.linkCount; ++l) {
            TreeLane<R>& link = links[l];
            TreeMotion<R>& m = link.motion;
            const TreeVec<R> change = m.fine + link.node.v, v = toSingle(m.v + change), w = m.w + link.node.w;
            m.fine = change - (v - m.v);
            link.written = v;
            const R zero(0.0f);
            const R row[8] = {v.x, v.y, v.z, link.invMass, w.x, w.y, w.z, zero};
            const TreeVec<R>&f = link.force, &t = link.torque;
            const R impulse[8] = {f.x, f.y, f.z, zero, t.x, t.y, t.z, zero};
            float *to[W], *given[W];
            for (int i = 0; i < W; ++i) {
                const bool written = isWritten(i);
                to[i] = written ? reinterpret_cast<float*>(arrays.states + states(l)[i]) : nullptr;
                given[i] = written ? group.impulses[l * W + i].force : nullptr;
            }
            TreeReal<R>::scatter(to, row);
            TreeReal<R>::scatter(given, impulse);
        }
    }
    RAGTOP_INLINE bool isWritten(int lane) const { return lane < group.used && ((group.failed >> lane) & 1u) == 0; }
    static RAGTOP_INLINE TreeVec<R> toSingle(const TreeVec<R>& a) {
        return {TreeReal<R>::toSingle(a.x), TreeReal<R>::toSingle(a.y), TreeReal<R>::toSingle(a.z)};
    }

    /// What velocities lack stays with the bodies between two steps, where nobody asks for their last change.
    RAGTOP_INLINE void storeFine(const BodyArrays& arrays) const {
        for (int l = 0; l < group.linkCount; ++l) {
            R row[8];
            gather(arrays.history, states(l), 0, row);
            const TreeVec<R>& fine = links[l].motion.fine;
            row[4] = fine.x, row[5] = fine.y, row[6] = fine.z;
            float* to[W];
            for (int i = 0; i < W; ++i)
                to[i] = isWritten(i) ? reinterpret_cast<float*>(arrays.history + states(l)[i]) : nullptr;
            TreeReal<R>::scatter(to, row);
        }
    }
    RAGTOP_INLINE void loadFine(int l, const BodyArrays& arrays) const {
        TreeLane<R>& link = links[l];
        R row[8], none;
        velocities(arrays.states, states(l), link.motion, none);
        link.written = link.motion.v;
        gather(arrays.history, states(l), 0, row);
        link.motion.fine = withinRounding({row[4], row[5], row[6]}, link.written);
    }
    /// Adds what rounding left out when the forces of a substep were added to the velocity that was written.
    RAGTOP_INLINE void refine(TreeLane<R>& link, R h) const {
        TreeMotion<R>& m = link.motion;
        m.fine = m.fine + withinRounding(scaled(h, link.acceleration) - (m.v - link.written), m.v);
    }
    /// Others may have changed the velocity: that is no rounding.
    static RAGTOP_INLINE TreeVec<R> withinRounding(const TreeVec<R>& a, const TreeVec<R>& v) {
        const auto within = [](R x, R of) __attribute__((always_inline)) {
            const R limit = R(1.2e-7f) * max(of, -of);
            return select(max(x, -x) < limit, x, R(0.0f));
        };
        return {within(a.x, v.x), within(a.y, v.y), within(a.z, v.z)};
    }
};

template <class R>
void beginTrees(TreeGroup& group, const BodyArrays& arrays) {
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
        lanes.gather(arrays.dynamics, lanes.states(l), 8, row);
        link.acceleration = {row[0], row[1], row[2]};
        link.moment = {row[4], row[5], row[6]};
        lanes.loadFine(l, arrays);
        const R zero(0.0f);
        link.stillTurn = link.node.torque = {zero, zero, zero};
    }
}

/// Stiffness and resistance of a link's joint; `again` under another load.
template <class R>
RAGTOP_INLINE void bear(const TreeLanes<R>& lanes, int l, R h, bool again) {
    TreeLane<R>& link = lanes.links[l];
    const int above = lanes.group.links[l].parent;
    TreeLane<R>* parent = above < 0 ? nullptr : &lanes.links[above];
    addStiffness(link, link.load, link.node.armC, h);
    if (parent) addStiffness(*parent, -link.load, link.node.armP, h);
    if (!TreeReal<R>::kYields || again) return;
    const R both = admittance(link, link.node.armC) + (parent ? admittance(*parent, link.node.armP) : R(0.0f));
    link.node.resistance = R(kTreeResistance) * both;
}

/// Says in which lanes joints are open: what the turns foreseen by the substep before have missed.
template <class R>
RAGTOP_INLINE void recordGaps(const TreeLanes<R>& lanes) {
    using direct::tuning::kClosed, direct::tuning::kOpen;
    TreeGroup& group = lanes.group;
    typename TreeReal<R>::Test open = R(1.0f) < R(0.0f), notClosed = open;
    for (int l = 0; l < group.linkCount; ++l) {
        if (group.links[l].joint == direct::TreeJoint::free) continue;
        const TreeLane<R>& link = lanes.links[l];
        const R gap = dot(link.gap, link.gap), arm = dot(link.rC, link.rC);
        open = open | (gap > R(static_cast<float>(kOpen * kOpen)) * arm);
        notClosed = notClosed | (gap > R(static_cast<float>(kClosed * kClosed)) * arm);
    }
    for (int i = 0; i < group.used; ++i) {
        if (open.v[i]) group.open |= 1u << i;
        if (notClosed.v[i]) group.notClosed |= 1u << i;
    }
}

/// Hands up what a link's joint asks for.
template <class R>
RAGTOP_INLINE void handUp(const TreeLanes<R>& lanes, int l) {
    TreeNode<R>& node = lanes.links[l].node;
    if (!lanes.isBallChain(l)) {
        passMomentum(node, lanes.parentNode(l), lanes.group.links[l].joint, lanes.isBelowBallChain(l));
        return;
    }
    passLack(node, lanes.nodeBelow(l));
    if (!lanes.isBelowBallChain(l)) endLack(node, lanes.parentNode(l));
}
/// The joint is likely to give `share` of its load.
template <class R>
RAGTOP_INLINE void handUp(const TreeLanes<R>& lanes, int l, R share) {
    TreeNode<R>& node = lanes.links[l].node;
    if constexpr (TreeReal<R>::kYields) node.d = node.d + scaled(share * node.resistance, lanes.links[l].load);
    handUp(lanes, l);
}

template <class R, class Test>
RAGTOP_INLINE void eliminateLink(const TreeLanes<R>& lanes, int l, Test& ok) {
    TreeLane<R>& link = lanes.links[l];
    if (!lanes.isBallChain(l)) {
        addInertia(link);
        eliminate(link.node, lanes.parentNode(l), lanes.group.links[l].joint, lanes.isBelowBallChain(l), ok);
        return;
    }
    eliminateBallChain(link, lanes.nodeBelow(l), ok);
    if (!lanes.isBelowBallChain(l)) endBallChain(link.node, lanes.parentNode(l), ok);
}

/// From the leaves to the root, a link's whole work in one visit: its memory is some kilobytes, and waits. `ask(l)`
/// says what joints want. False lanes of `ok` have no answer, those of the result have links that are very taut.
template <class R, class Ask>
RAGTOP_INLINE typename TreeReal<R>::Test eliminateTree(const TreeLanes<R>& lanes, R h, R share, bool again,
                                                       typename TreeReal<R>::Test& ok, Ask&& ask) {
    typename TreeReal<R>::Test taut = R(1.0f) < R(0.0f);
    ok = R(0.0f) < R(1.0f);
    for (int l = lanes.group.linkCount; l-- > 0;) {
        TreeLane<R>& link = lanes.links[l];
        const direct::TreeJoint joint = lanes.group.links[l].joint;
        if (joint != direct::TreeJoint::free) bear(lanes, l, h, again);
        if (link.stiff) taut = taut | isVeryTaut(link);
        if (joint != direct::TreeJoint::free) ask(l);
        eliminateLink(lanes, l, ok);
        handUp(lanes, l, share);
    }
    return taut;
}

/// The same with the factor that is there.
template <class R, class Ask>
RAGTOP_INLINE void askAgain(const TreeLanes<R>& lanes, R share, Ask&& ask) {
    for (int l = lanes.group.linkCount; l-- > 0;) {
        if (lanes.group.links[l].joint == direct::TreeJoint::free) continue;
        ask(l);
        handUp(lanes, l, share);
    }
}

template <class R>
void solveTrees(TreeGroup& group, const BodyArrays& arrays, const direct::TreeSubstep& substep) {
    using Test = typename TreeReal<R>::Test;
    constexpr bool kLeapfrog = TreeReal<R>::kLeapfrog;
    const TreeLanes<R> lanes(group);
    const bool halved = kLeapfrog && substep.first;
    const R h(substep.h), rate(substep.biasRate), share(halved ? 0.5f : 1.0f);
    TreeMotion<R> anchor;
    lanes.loadAll(arrays, anchor);
    if (!kLeapfrog) recordGaps(lanes);
    for (int l = 0; l < group.linkCount; ++l) {
        TreeLane<R>& link = lanes.links[l];
        lanes.refine(link, h);
        if (halved) lanes.push(link, R(-0.5f) * h);
        link.turn = TreeTurn<R>(link.motion.w, h);
        link.load = link.force;
    }
    const TreeTurn<R> anchorTurn(anchor.w, h);
    const auto aimed = [&](int l, bool again) __attribute__((always_inline)) {
        const TreeLink& at = group.links[l];
        aim(lanes.links[l], at, lanes.motionAbove(l, anchor), at.parent < 0 ? anchorTurn : lanes.links[at.parent].turn,
            h, rate, again);
    };
    const auto ask = [&](int l) __attribute__((always_inline)) { aimed(l, false); };
    const auto askAnew = [&](int l) __attribute__((always_inline)) { aimed(l, true); };
    const auto whole = [share](const TreeLane<R>& link) __attribute__((always_inline)) {
        return link.node.force + scaled(R(1.0f) - share, link.load);
    };
    Test ok;
    const Test taut = eliminateTree(lanes, h, share, false, ok, ask);
    group.taut = 0;
    for (int i = 0; i < group.used; ++i)
        if (taut.v[i]) group.taut |= 1u << i;
    const bool anew = group.taut != 0;
    if (kLeapfrog || anew) {
        // What links turn by is known better once it has been solved, and so is the load of those that are taut.
        lanes.takeVelocities([&](TreeLane<R> & link) __attribute__((always_inline)) {
            const TreeVec<R> w = link.motion.w + link.node.w;
            link.turn = TreeTurn<R>(kLeapfrog ? w : choose(taut, w, link.motion.w), h);
            if (anew) {
                link.load = choose(taut, whole(link), link.load);
                clearSums(link);
            } else {
                clearMomentum(link);
            }
        });
        if (anew)
            eliminateTree(lanes, h, share, true, ok, askAnew);
        else
            askAgain(lanes, share, askAnew);
    }
    lanes.takeLastVelocities(
        ok, [&](TreeLane<R> & link) __attribute__((always_inline)) {
            link.force = whole(link);
            link.torque = link.node.torque + scaled(R(1.0f) - share, link.torque);
        });
    lanes.store(arrays, ok);
}

/// What errors of positions brought in is taken back with the factor of the substep.
template <class R>
RAGTOP_INLINE void takeBack(const TreeLanes<R>& lanes, const BodyArrays& arrays) {
    TreeMotion<R> anchor;
    lanes.loadAnchor(arrays, anchor);
    for (int l = 0; l < lanes.group.linkCount; ++l) {
        TreeLane<R>& link = lanes.links[l];
        lanes.velocities(arrays.states, lanes.states(l), link.motion, link.invMass);
        clearMomentum(link);
    }
    for (int l = lanes.group.linkCount; l-- > 0;) {
        TreeLane<R>& link = lanes.links[l];
        const direct::TreeJoint joint = lanes.group.links[l].joint;
        if (joint == direct::TreeJoint::free) continue;
        ask(link, lanes.motionAbove(l, anchor), link.still, link.stillTurn);
        link.node.d = link.node.d - scaled(link.node.resistance, link.force - link.load);
        handUp(lanes, l);
    }
    typename TreeReal<R>::Test ok = R(0.0f) < R(1.0f);
    lanes.takeLastVelocities(
        ok, [](TreeLane<R> & link) __attribute__((always_inline)) {
            link.force = link.force + link.node.force;
            link.torque = link.torque + link.node.torque;
        });
    lanes.store(arrays, ok);
}

/// The forces of the last half substep, and speeds that open no joint where it is now. The next half substep will ask
/// for as much again.
template <class R>
RAGTOP_INLINE void arrive(const TreeLanes<R>& lanes, const BodyArrays& arrays, R h) {
    TreeMotion<R> anchor;
    lanes.loadAll(arrays, anchor);
    for (int l = 0; l < lanes.group.linkCount; ++l) {
        TreeLane<R>& link = lanes.links[l];
        lanes.push(link, R(0.5f) * h);
        link.load = link.force;
    }
    typename TreeReal<R>::Test ok;
    eliminateTree(
        lanes, h, R(0.5f), false, ok, [&](int l) __attribute__((always_inline)) {
            rest(lanes.links[l], lanes.group.links[l], lanes.motionAbove(l, anchor));
        });
    lanes.takeLastVelocities(
        ok, [](TreeLane<R> & link) __attribute__((always_inline)) {
            link.force = scaled(R(2.0f), link.node.force);
            link.torque = scaled(R(2.0f), link.node.torque);
        });
    lanes.store(arrays, ok);
}

template <class R>
void relaxTrees(TreeGroup& group, const BodyArrays& arrays, const direct::TreeSubstep& substep) {
    const TreeLanes<R> lanes(group);
    if (!TreeReal<R>::kLeapfrog)
        takeBack(lanes, arrays);
    else if (substep.last)
        arrive(lanes, arrays, R(substep.h));
    if (substep.last) lanes.storeFine(arrays);
}

template <class R>
void factorTrees(TreeGroup& group) {
    const TreeLanes<R> lanes(group);
    typename TreeReal<R>::Test ok = R(0.0f) < R(1.0f);
    for (int l = 0; l < group.linkCount; ++l)
        if (!lanes.isBallChain(l)) clearNode(lanes.links[l]);
    for (int l = group.linkCount; l-- > 0;) {
        eliminateLink(lanes, l, ok);
        handUp(lanes, l);
    }
    lanes.takeLastVelocities(ok, [](TreeLane<R>&) __attribute__((always_inline)) {});
    for (int i = 0; i < group.used; ++i)
        if (!ok.v[i]) group.failed |= 1u << i;
}

template <class R>
constexpr direct::TreeKernels makeTreeKernels(const char* name) {
    return {name,          TreeReal<R>::kLanes, sizeof(TreeLane<R>), TreeReal<R>::kLeapfrog,
            beginTrees<R>, solveTrees<R>,       relaxTrees<R>,    factorTrees<R>};
}
template <int N>
constexpr direct::TreeTables makeTreeTables(const char* name, const direct::TreeTables* wider = nullptr) {
    return {makeTreeKernels<Lanes<N>>(name), makeTreeKernels<DoubleLanes<N / 2>>(name), wider};
}

}  // namespace
}  // namespace ragtop
