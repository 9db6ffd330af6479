// Ball chains of trees, in lanes: links on balls from which at most one other hangs, on a ball too. Included by
// tree_kernels.inl.
//
// Their elimination needs nothing larger than 3 × 3. With r and s from the centre of a link to its own joint and to
// that of what hangs from it, and W its inverse inertia, an impulse at one changes the speed of the other by
//   Λ_rs = E/m − [r] W [s].
// Let Y say by what the speed of a joint's point changes per impulse, of all that hangs there, and g what it gains
// without one. The joint between a link and what hangs from it takes
//   λ = D⁻¹ (Λ_sr λ_above + e),  D = Y + Λ_ss + R,  e = d − g,
// after which the link has
//   Y_r = Λ_rr − H Λ_sr,  g_r = −H e,  H = Λ_rs D⁻¹:
// the block Cholesky factorization of J M̂⁻¹ Jᵀ, which is block tridiagonal along a chain.

#pragma once

#include "direct/tree_rows.inl"

namespace ragtop {
namespace {

/// [r]× W, by columns.
template <class R>
RAGTOP_INLINE TreeMat<R> crossTimes(const TreeVec<R>& r, const TreeSym<R>& w) {
    return {cross(r, TreeVec<R>{w.xx, w.xy, w.xz}), cross(r, TreeVec<R>{w.xy, w.yy, w.yz}),
            cross(r, TreeVec<R>{w.xz, w.yz, w.zz})};
}
/// E/m − P [s]×, with P = [r]× W.
template <class R>
RAGTOP_INLINE TreeMat<R> coupling(R invMass, const TreeMat<R>& p, const TreeVec<R>& s) {
    TreeMat<R> m{scaled(s.y, p.z) - scaled(s.z, p.y), scaled(s.z, p.x) - scaled(s.x, p.z),
                 scaled(s.x, p.y) - scaled(s.y, p.x)};
    m.x.x = m.x.x + invMass;
    m.y.y = m.y.y + invMass;
    m.z.z = m.z.z + invMass;
    return m;
}
/// The same for s = r.
template <class R>
RAGTOP_INLINE TreeSym<R> couplingAt(R invMass, const TreeMat<R>& p, const TreeVec<R>& r) {
    return {invMass + (r.y * p.z.x - r.z * p.y.x), r.z * p.x.x - r.x * p.z.x, r.x * p.y.x - r.y * p.x.x,
            invMass + (r.z * p.x.y - r.x * p.z.y), r.x * p.y.y - r.y * p.x.y, invMass + (r.x * p.y.z - r.y * p.x.z)};
}

/// What a joint's point yields to, with its resistance.
template <class R>
RAGTOP_INLINE TreeSym<R> yieldingOf(const TreeNode<R>& node) {
    TreeSym<R> y = node.admittance;
    if constexpr (TreeReal<R>::kYields) {
        y.xx = y.xx + node.resistance;
        y.yy = y.yy + node.resistance;
        y.zz = y.zz + node.resistance;
    }
    return y;
}

/// The inverse inertia of a body whose tension makes it stiff, (W⁻¹ + K)⁻¹. What is not stiff keeps its bits.
template <class R>
RAGTOP_INLINE TreeSym<R> stiffened(const TreeLane<R>& link) {
    if (!link.stiff) return link.inverseInertia;
    R determinant;
    const TreeSym<R>&w = link.inverseInertia, &k = link.stiffness;
    const TreeSym<R> s = inverseOf(inverseOf(w, determinant) + k, determinant);
    const auto is = k.xx + k.yy + k.zz > R(0.0f);
    return {select(is, s.xx, w.xx), select(is, s.xy, w.xy), select(is, s.xz, w.xz),
            select(is, s.yy, w.yy), select(is, s.yz, w.yz), select(is, s.zz, w.zz)};
}

/// First half of the work. `below` hangs from the link, or nothing does.
template <class R, class Test>
RAGTOP_INLINE void eliminateBallChain(TreeLane<R>& link, TreeNode<R>* below, Test& ok) {
    TreeNode<R>& node = link.node;
    node.ease = stiffened(link);
    const TreeMat<R> own = crossTimes(node.armC, node.ease);
    node.admittance = couplingAt(link.invMass, own, node.armC);
    if (!below) return;
    const TreeMat<R> across = coupling(link.invMass, own, below->armP);
    below->give = inverseOfPositive(
        yieldingOf(*below) + couplingAt(link.invMass, crossTimes(below->armP, node.ease), below->armP), ok);
    below->lever = product(across, below->give);
    node.admittance = node.admittance - productTransposed(below->lever, across);
}

/// What hangs from a link that is of no ball chain, or from what does not move, answers its speed alone.
template <class R, class Test>
RAGTOP_INLINE void endBallChain(TreeNode<R>& node, TreeNode<R>* parent, Test& ok) {
    node.give = inverseOfPositive(yieldingOf(node), ok);
    if (parent) addPointMessage(*parent, node.armP, node.give);
}

/// Second half, leaves first.
template <class R>
RAGTOP_INLINE void passLack(TreeNode<R>& node, const TreeNode<R>* below) {
    node.lack = node.d;
    if (below) node.lack = node.lack + below->lever * below->lack;
}
template <class R>
RAGTOP_INLINE void endLack(const TreeNode<R>& node, TreeNode<R>* parent) {
    if (!parent) return;
    const TreeVec<R> f = node.give * node.lack;
    parent->momentum.p = parent->momentum.p - f;
    parent->momentum.l = parent->momentum.l - cross(node.armP, f);
}

/// And back, root first: the impulse where a chain ends,
template <class R>
RAGTOP_INLINE void takeImpulse(TreeNode<R>& node, const TreeNode<R>* parent) {
    TreeVec<R> u = node.lack;
    if (parent) u = u + parent->v + cross(parent->w, node.armP);
    node.force = node.give * u;
}
/// then that of what hangs from each, and the velocity between both.
template <class R>
RAGTOP_INLINE void takeBallChainVelocity(TreeLane<R>& link, TreeNode<R>* below) {
    TreeNode<R>& node = link.node;
    TreeVec<R> force = node.force, moment = cross(node.armC, node.force);
    if (below) {
        below->force = below->give * below->lack + transposed(below->lever, node.force);
        force = force - below->force;
        moment = moment - cross(below->armP, below->force);
    }
    node.v = scaled(link.invMass, force);
    node.w = node.ease * moment;
}

}  // namespace
}  // namespace ragtop
