// Leaf-to-root elimination of a tree of joints, in lanes. Included by tree_kernels.inl.
//
// Changes of velocity Δ solve  M̂ Δ = Jᵀ λ,  J Δ = d,  with M̂ block diagonal (masses, and the stiffness of tension). A
// link c that hangs from p by rows at the shared point moves there with (u, w), of which its joint leaves some free. It
// is eliminated in these coordinates: what is free is minimised over, and what remains is an inertia and an impulse
// that the parent feels at the point [Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7; Baraff, Linear-Time
// Dynamics using Lagrange Multipliers, 1996]. One visit per link, leaves first, and one back; no fill.

#pragma once

#include "direct/tree_lanes.inl"
#include "direct/tree_layout.h"

namespace ragtop {
namespace {

/// The inertia ½ uᵀ L u + uᵀ X w + ½ wᵀ A w − p · u − l · w of a link and all that hangs from it.
template <class R>
struct TreeInertia {
    TreeSym<R> L;
    TreeMat<R> X;
    TreeSym<R> A;
};
template <class R>
struct TreeMomentum {
    TreeVec<R> p, l;
};

/// A link while it is solved.
template <class R>
struct TreeNode {
    TreeInertia<R> inertia;  ///< about the centre, then what the parent feels at the point; of a ball: L'', G, A'⁻¹
    TreeMomentum<R> momentum;
    TreeVec<R> armC, armP;     ///< m, from both centres to the shared point
    TreeVec<R> axis;           ///< of a hinge, free
    TreeVec<R> y, z;           ///< of a hinge: momentum per speed about the axis
    R inverse;                 ///< of a hinge: speed about the axis per moment
    R carry;                   ///< of a hinge: moment about the axis
    R resistance;              ///< m/s per N s, by which the point gives way
    TreeSym<R> yielding;       ///< (E + resistance L'')⁻¹ of what is not rigid
    TreeVec<R> d, e;           ///< asked of u and w, child minus parent
    TreeVec<R> v, w;           ///< Δ
    TreeVec<R> force, torque;  ///< N s, N m s that the link receives at the point
    // Of ball chains, see tree_ball_chains.inl.
    TreeSym<R> ease;        ///< W
    TreeSym<R> admittance;  ///< Y, of what hangs from a link of a ball chain too
    TreeSym<R> give;        ///< D⁻¹; where a chain ends (Y + R)⁻¹
    TreeMat<R> lever;       ///< H
    TreeVec<R> lack;        ///< e
};

template <class R>
RAGTOP_INLINE void addMessage(TreeNode<R>& parent, const TreeVec<R>& r, const TreeInertia<R>& m) {
    const TreeMat<R> moved = m.X - timesCross(m.L, r);
    parent.inertia.L = parent.inertia.L + m.L;
    parent.inertia.X = parent.inertia.X + moved;
    parent.inertia.A = parent.inertia.A + m.A - crossBoth(r, moved, m.X);
}
/// Of what turns freely about the point.
template <class R>
RAGTOP_INLINE void addPointMessage(TreeNode<R>& parent, const TreeVec<R>& r, const TreeSym<R>& inertia) {
    const TreeMat<R> lever = timesCross(inertia, r);
    parent.inertia.L = parent.inertia.L + inertia;
    parent.inertia.X = parent.inertia.X - lever;
    parent.inertia.A = parent.inertia.A + crossLeft(r, lever);
}

/// Moves a link's inertia from its centre to the point.
template <class R>
RAGTOP_INLINE void moveToPoint(TreeInertia<R>& m, const TreeVec<R>& r) {
    const TreeMat<R> moved = m.X + timesCross(m.L, r);
    m.A = m.A + crossBoth(r, moved, m.X);
    m.X = moved;
}

/// Clears lanes of `ok` where the matrix is not positive.
template <class R, class Test>
RAGTOP_INLINE TreeSym<R> inverseOfPositive(const TreeSym<R>& m, Test& ok) {
    R determinant;
    const TreeSym<R> inverse = inverseOf(m, determinant);
    ok = ok & (determinant > R(0.0f)) & (m.xx > R(0.0f));
    return inverse;
}

/// The inertia that is left when the rotation is free.
template <class R, class Test>
RAGTOP_INLINE void freeRotation(TreeInertia<R>& m, Test& ok) {
    m.A = inverseOfPositive(m.A, ok);
    const TreeMat<R> gain = product(m.X, m.A);
    m.L = m.L - productTransposed(gain, m.X);
    m.X = gain;
}

/// M N, of two that commute.
template <class R>
RAGTOP_INLINE TreeSym<R> productOfCommuting(const TreeSym<R>& m, const TreeSym<R>& n) {
    const TreeVec<R> x = m * TreeVec<R>{n.xx, n.xy, n.xz}, y = m * TreeVec<R>{n.xy, n.yy, n.yz},
                     z = m * TreeVec<R>{n.xz, n.yz, n.zz};
    return {x.x, y.x, z.x, y.y, z.y, z.z};
}

/// A point that gives way, u = u_p + d − R λ, is felt as less than it is: with B = E + R L'',
///   L'' ← L'' B⁻¹,  X'' ← B⁻¹ X'',  A'' ← A'' − R X''ᵀ B⁻¹ X''.
template <class R>
RAGTOP_INLINE void giveWay(TreeNode<R>& node, bool turns) {
    if constexpr (!TreeReal<R>::kYields) return;
    TreeInertia<R>& m = node.inertia;
    const R r = node.resistance, one(1.0f);
    R determinant;
    node.yielding =
        inverseOf(TreeSym<R>{one + r * m.L.xx, r * m.L.xy, r * m.L.xz, one + r * m.L.yy, r * m.L.yz, one + r * m.L.zz},
                  determinant);
    m.L = productOfCommuting(node.yielding, m.L);
    if (!turns) return;
    const TreeMat<R> moved{node.yielding * m.X.x, node.yielding * m.X.y, node.yielding * m.X.z};
    m.A = m.A - TreeSym<R>{r * dot(m.X.x, moved.x), r * dot(m.X.x, moved.y), r * dot(m.X.x, moved.z),
                           r * dot(m.X.y, moved.y), r * dot(m.X.y, moved.z), r * dot(m.X.z, moved.z)};
    m.X = moved;
}

/// First half of the work: inertias of `node` are about its centre and complete. A ball chain above is told how much the
/// point yields.
template <class R, class Test>
RAGTOP_INLINE void eliminate(TreeNode<R>& node, TreeNode<R>* parent, direct::TreeJoint joint, bool belowBallChain,
                             Test& ok) {
    if (joint == direct::TreeJoint::free) {
        freeRotation(node.inertia, ok);
        node.inertia.L = inverseOfPositive(node.inertia.L, ok);
        return;
    }
    moveToPoint(node.inertia, node.armC);
    if (joint == direct::TreeJoint::ball) {
        freeRotation(node.inertia, ok);
    } else if (joint == direct::TreeJoint::hinge) {
        TreeInertia<R>& m = node.inertia;
        node.y = m.X * node.axis;
        node.z = m.A * node.axis;
        const R about = dot(node.axis, node.z);
        ok = ok & (about > R(0.0f));
        node.inverse = R(1.0f) / about;
        m.L = m.L - outer(node.inverse, node.y);
        m.X = m.X - outer(node.inverse, node.y, node.z);
        m.A = m.A - outer(node.inverse, node.z);
    }
    if (belowBallChain) {
        node.admittance = inverseOfPositive(node.inertia.L, ok);
        return;
    }
    const bool turns = joint != direct::TreeJoint::ball;  // else X is G, which belongs to the link alone
    giveWay(node, turns);
    if (!parent) return;
    if (turns)
        addMessage(*parent, node.armP, node.inertia);
    else
        addPointMessage(*parent, node.armP, node.inertia.L);
}

/// Second half, leaves first: momenta of `node` are complete.
template <class R>
RAGTOP_INLINE void passMomentum(TreeNode<R>& node, TreeNode<R>* parent, direct::TreeJoint joint, bool belowBallChain) {
    if (joint == direct::TreeJoint::free) return;
    const TreeInertia<R>& m = node.inertia;
    TreeVec<R>&p = node.momentum.p, &l = node.momentum.l;
    l = l - cross(node.armC, p);
    if (joint == direct::TreeJoint::ball) {
        p = p - m.X * l;
        if (belowBallChain) {
            node.lack = node.d - node.admittance * p;
            return;
        }
        if constexpr (TreeReal<R>::kYields) p = node.yielding * p;
        if (!parent) return;
        const TreeVec<R> f = p - m.L * node.d;
        parent->momentum.p = parent->momentum.p + f;
        parent->momentum.l = parent->momentum.l + cross(node.armP, f);
        return;
    }
    if (joint == direct::TreeJoint::hinge) {
        node.carry = dot(node.axis, l);
        const R share = node.inverse * node.carry;
        p = p - scaled(share, node.y);
        l = l - scaled(share, node.z);
    }
    if constexpr (TreeReal<R>::kYields) {
        l = l - scaled(node.resistance, transposed(m.X, p));
        p = node.yielding * p;
    }
    if (!parent) return;
    const TreeVec<R> f = p - m.L * node.d - m.X * node.e;
    const TreeVec<R> t = l - transposed(m.X, node.d) - m.A * node.e;
    parent->momentum.p = parent->momentum.p + f;
    parent->momentum.l = parent->momentum.l + t + cross(node.armP, f);
}

/// And back, root first. A ball chain above has found the force.
template <class R>
RAGTOP_INLINE void takeVelocity(TreeNode<R>& node, const TreeNode<R>* parent, direct::TreeJoint joint, bool belowBallChain) {
    const TreeInertia<R>& m = node.inertia;
    const TreeVec<R>&p = node.momentum.p, &l = node.momentum.l;
    const TreeVec<R> zero{R(0.0f), R(0.0f), R(0.0f)};
    if (joint == direct::TreeJoint::free) {
        node.v = m.L * (p - m.X * l);
        node.w = m.A * l - transposed(m.X, node.v);
        node.force = node.torque = zero;
        return;
    }
    TreeVec<R> u = node.d;
    if (parent) u = u + parent->v + cross(parent->w, node.armP);
    if (joint == direct::TreeJoint::ball) {
        if (!belowBallChain) node.force = m.L * u - p;
        node.torque = zero;
        if constexpr (TreeReal<R>::kYields) u = u - scaled(node.resistance, node.force);
        node.w = m.A * l - transposed(m.X, u);
    } else {
        TreeVec<R> w = node.e;
        if (parent) w = w + parent->w;
        node.force = m.L * u + m.X * w - p;
        node.torque = transposed(m.X, u) + m.A * w - l;
        if constexpr (TreeReal<R>::kYields) u = u - scaled(node.resistance, node.force);
        if (joint == direct::TreeJoint::hinge)
            w = w + scaled(node.inverse * (node.carry - dot(node.y, u) - dot(node.z, w)), node.axis);
        node.w = w;
    }
    node.v = u - cross(node.w, node.armC);
}

}  // namespace
}  // namespace ragtop
