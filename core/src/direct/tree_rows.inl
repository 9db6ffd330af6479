// What the joints of trees ask for, and the stiffness of their tension, in lanes. Included by tree_kernels.inl.
//
// The equations are those of direct/joint_rows.h: forces pull along the Jacobian of the substep's beginning, errors are
// to vanish at its end, taut links are implicit, points give way by the same resistance. None needs a search.

#pragma once

#include "direct/joint_tuning.h"
#include "direct/tree_elimination.inl"

namespace ragtop {
namespace {

constexpr float kTreeImplicit = static_cast<float>(direct::tuning::kImplicit);
constexpr float kTreeStiffLink = static_cast<float>(direct::tuning::kStiffLink);
constexpr float kTreeVeryTaut = static_cast<float>(direct::tuning::kVeryTaut);
constexpr float kTreeResistance = static_cast<float>(direct::tuning::kRowResistance);

template <class R>
struct TreeQuat {
    R x, y, z, w;
};
template <class R>
RAGTOP_INLINE TreeVec<R> rotate(const TreeQuat<R>& q, const TreeVec<R>& v) {
    const TreeVec<R> u{q.x, q.y, q.z};
    TreeVec<R> t = cross(u, v);
    t = t + t;
    return v + scaled(q.w, t) + cross(u, t);
}
template <class R>
RAGTOP_INLINE TreeQuat<R> operator*(const TreeQuat<R>& a, const TreeQuat<R>& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
/// First axis of a frame.
template <class R>
RAGTOP_INLINE TreeVec<R> axisX(const TreeQuat<R>& q) {
    const R two(2.0f);
    return {R(1.0f) - two * (q.y * q.y + q.z * q.z), two * (q.x * q.y + q.w * q.z), two * (q.x * q.z - q.w * q.y)};
}

template <class R>
struct TreeMotion {
    TreeVec<R> v, w;  ///< m/s, rad/s
    TreeVec<R> dp;    ///< m, since the step began
    TreeQuat<R> dq;
};

/// A link in lanes: a body, and the joint that holds it.
template <class R>
struct TreeLane {
    // Of the step.
    TreeVec<R> offset, anchorC, anchorP;
    TreeQuat<R> frameC, frameP;
    // Carried from substep to substep, N s and N m s.
    TreeVec<R> force, torque;  ///< in all
    TreeVec<R> load;           ///< λ̂, about which the point gives way
    // Of the substep.
    TreeMotion<R> motion;
    R invMass;
    TreeSym<R> inverseInertia, stiffness;
    TreeVec<R> about;             ///< rad/s, the spin about which errors are predicted
    TreeVec<R> rC, rP, gap;       ///< m: from the centres to the anchors, and C's anchor minus P's
    TreeVec<R> turnError;         ///< rad
    TreeVec<R> still, stillTurn;  ///< relative speeds at which errors do not change
    TreeNode<R> node;
};

/// Before anything hangs from the link.
template <class R>
RAGTOP_INLINE void clearSums(TreeLane<R>& link) {
    const R zero(0.0f);
    const TreeVec<R> none{zero, zero, zero};
    const TreeSym<R> nothing{zero, zero, zero, zero, zero, zero};
    link.stiffness = nothing;
    link.node.inertia = {nothing, {none, none, none}, nothing};
    link.node.momentum = {none, none};
}

/// The link's own, beside what hangs from it.
template <class R>
RAGTOP_INLINE void addInertia(TreeLane<R>& link) {
    const R mass = R(1.0f) / link.invMass;
    TreeInertia<R>& m = link.node.inertia;
    R determinant;
    m.L.xx = m.L.xx + mass;
    m.L.yy = m.L.yy + mass;
    m.L.zz = m.L.zz + mass;
    m.A = m.A + (inverseOf(link.inverseInertia, determinant) + link.stiffness);
}

template <class R>
RAGTOP_INLINE bool turnsWithParent(direct::TreeJoint joint) {
    return joint == direct::TreeJoint::hinge || joint == direct::TreeJoint::fixed;
}

/// J M⁻¹ Jᵀ of one body at an arm, mean of all directions.
template <class R>
RAGTOP_INLINE R admittance(const TreeLane<R>& link, const TreeVec<R>& arm) {
    const TreeSym<R>& i = link.inverseInertia;
    return link.invMass + R(1.0f / 3) * (dot(arm, arm) * (i.xx + i.yy + i.zz) - dot(arm, i * arm));
}

/// Error of the x axes, child's against parent's (axisError in constraints/joint_types.h).
template <class R>
RAGTOP_INLINE TreeVec<R> errorOfAxes(const TreeVec<R>& p, const TreeVec<R>& c) {
    const R onePlusCos = max(R(1.0f) + dot(p, c), R(1e-6f));
    return scaled(sqrt(R(2.0f) / onePlusCos), cross(p, c));
}
/// Twice the vector part of the rotation from parent to child.
template <class R>
RAGTOP_INLINE TreeVec<R> errorOfFrames(const TreeQuat<R>& p, const TreeQuat<R>& c) {
    const TreeQuat<R> q = c * TreeQuat<R>{-p.x, -p.y, -p.z, p.w};
    const R s = select(q.w < R(0.0f), R(-2.0f), R(2.0f));
    return {s * q.x, s * q.y, s * q.z};
}

/// Where a link's joint is now.
template <class Group, class R>
RAGTOP_INLINE void place(const Group& lanes, int l, const TreeMotion<R>& anchor) {
    const direct::TreeLink& at = lanes.group.links[l];
    if (at.joint == direct::TreeJoint::free) return;
    TreeLane<R>& link = lanes.links[l];
    const TreeMotion<R>&c = link.motion, &p = at.parent < 0 ? anchor : lanes.links[at.parent].motion;
    link.rC = rotate(c.dq, link.anchorC);
    link.rP = rotate(p.dq, link.anchorP);
    link.gap = link.offset + (c.dp - p.dp) + (link.rC - link.rP);
    const TreeVec<R> half = scaled(R(0.5f), link.gap);
    link.node.armC = link.rC - half;
    link.node.armP = link.rP + half;
}

/// What the turn by tan(angle/2) = |t| about t adds to an arm, in 1/h and without its first order 2 t × r/h.
template <class R>
RAGTOP_INLINE TreeVec<R> curving(const TreeVec<R>& t, const TreeVec<R>& r, R twoPerH) {
    const TreeVec<R> once = cross(t, r);
    const R square = dot(t, t);
    return scaled(twoPerH / (R(1.0f) + square), cross(t, once) - scaled(square, once));
}
/// The same turn of a unit vector or frame.
template <class R>
RAGTOP_INLINE TreeVec<R> turned(const TreeVec<R>& t, const TreeVec<R>& r) {
    return r + scaled(R(2.0f) / (R(1.0f) + dot(t, t)), cross(t, r + cross(t, r)));
}
template <class R>
RAGTOP_INLINE TreeQuat<R> turned(const TreeVec<R>& t, const TreeQuat<R>& q) {
    const R norm = R(1.0f) / sqrt(R(1.0f) + dot(t, t));
    return TreeQuat<R>{norm * t.x, norm * t.y, norm * t.z, norm} * q;
}

/// What the rows still need to reach relative speeds `u` and `w` from the velocities in `motion`.
template <class R>
RAGTOP_INLINE void ask(TreeLane<R>& link, const TreeMotion<R>& p, const TreeVec<R>& u, const TreeVec<R>& w) {
    const TreeMotion<R>& c = link.motion;
    link.node.d = u - (c.v + cross(c.w, link.node.armC) - p.v - cross(p.w, link.node.armP));
    link.node.e = w - (c.w - p.w);
}

/// Targets of a joint, with errors predicted for the spins `about` of its link and of its parent.
template <class R>
RAGTOP_INLINE void aim(TreeLane<R>& link, const direct::TreeLink& at, const TreeMotion<R>& p, const TreeVec<R>& aboutP,
                       R h, R rate) {
    const TreeVec<R> tC = scaled(R(0.5f) * h, link.about), tP = scaled(R(0.5f) * h, aboutP);
    const R twoPerH = R(2.0f) / h;
    link.still = curving(tP, link.rP, twoPerH) - curving(tC, link.rC, twoPerH) -
                 cross(scaled(R(0.5f), link.about + aboutP), link.gap);
    const TreeVec<R> u = link.still - scaled(rate, link.gap);
    TreeVec<R> w{R(0.0f), R(0.0f), R(0.0f)};
    if (turnsWithParent<R>(at.joint)) {
        const TreeQuat<R> qC = link.motion.dq * link.frameC, qP = p.dq * link.frameP;
        TreeVec<R> ahead;
        if (at.joint == direct::TreeJoint::hinge) {
            const TreeVec<R> xC = axisX(qC), xP = axisX(qP);
            link.node.axis = at.childIsB ? xC : xP;
            link.turnError = errorOfAxes(xP, xC);
            ahead = errorOfAxes(turned(tP, xP), turned(tC, xC));
        } else {
            link.turnError = errorOfFrames(qP, qC);
            ahead = errorOfFrames(turned(tP, qP), turned(tC, qC));
        }
        link.stillTurn = link.about - aboutP - scaled(R(1.0f) / h, ahead - link.turnError);
        w = link.stillTurn - scaled(rate, link.turnError);
    } else {
        link.stillTurn = w;
    }
    ask(link, p, u, w);
}

/// The larger part of ∂²/∂θ² of a force's work on an arm, (F · r) E − ½ (r Fᵀ + F rᵀ): what is not negative.
template <class R>
RAGTOP_INLINE TreeSym<R> tautStiffness(const TreeVec<R>& force, const TreeVec<R>& arm, R f, R r, R share) {
    const R zero(0.0f), one(1.0f), largest = f * r, along = dot(force, arm);
    const R safeF = select(f > zero, f, one), safeR = select(r > zero, r, one);
    const TreeVec<R> axis = cross(arm, force), apart = scaled(one / safeR, arm) - scaled(one / safeF, force);
    const R sine2 = dot(axis, axis), spread2 = dot(apart, apart);
    const auto bent = (sine2 > R(1e-12f) * largest * largest) & (spread2 > R(1e-12f));
    const R pulls = select(along > zero, share, zero);
    // In line: F r across the arm, if it pulls.
    const R stiff = select(bent, zero, pulls * largest);
    const TreeSym<R> across = outer(-(stiff / (safeR * safeR)), arm);
    const R first = select(bent, pulls * along / select(bent, sine2, one), zero);
    const R second = select(bent, R(0.5f) * share * (along + largest) / select(bent, spread2, one), zero);
    return TreeSym<R>{stiff, zero, zero, stiff, zero, stiff} + across + outer(first, axis) + outer(second, apart);
}

/// For a thin link T = |impulse|/h, r = L/2 and I = m L²/12, so 4 T h²/(m L) = ⅔ h |impulse| r / I.
template <class R>
RAGTOP_INLINE void addStiffness(TreeLane<R>& link, const TreeVec<R>& impulse, const TreeVec<R>& arm, R h) {
    const TreeSym<R>& i = link.inverseInertia;
    const R f = sqrt(dot(impulse, impulse)), r = sqrt(dot(arm, arm));
    const R ratio = R(2.0f / 3 / kTreeStiffLink) * h * f * r * max(i.xx, max(i.yy, i.zz));
    const R share = max(R(0.0f), min(R(1.0f), ratio - R(1.0f)));
    if (!any(share > R(0.0f))) return;
    link.stiffness = link.stiffness + tautStiffness(impulse, arm, f, r, share * R(kTreeImplicit) * h);
}

template <class R>
RAGTOP_INLINE typename TreeReal<R>::Test isVeryTaut(const TreeLane<R>& link) {
    const TreeSym<R>&k = link.stiffness, &i = link.inverseInertia;
    return max(k.xx * i.xx, max(k.yy * i.yy, k.zz * i.zz)) > R(kTreeVeryTaut);
}

}  // namespace
}  // namespace ragtop
