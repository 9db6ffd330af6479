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
    TreeVec<R> fine;  ///< m/s, beside v
    TreeVec<R> dp;    ///< m, since the step began
    TreeQuat<R> dq;
};

/// The turn by h ω, by its series: θ = |ω| h. Links of trees turn by less than a radian.
template <class R>
struct TreeTurn {
    TreeVec<R> w;
    R h, square;      ///< θ²
    R second, third;  ///< h (1 − cos θ)/θ², 1 − sin θ/θ

    TreeTurn() = default;
    RAGTOP_INLINE TreeTurn(const TreeVec<R>& about, R substep) : w(about), h(substep) {
        square = min(h * h * dot(w, w), R(10.0f));
        second = h * (R(0.5f) - square * (R(1.0f / 24) - square * R(1.0f / 720)));
        third = square * (R(1.0f / 6) - square * (R(1.0f / 120) - square * R(1.0f / 5040)));
    }

    /// What it adds to an arm in 1/h, beside ω × r:  h (1 − cos θ)/θ² ω × (ω × r) − (1 − sin θ/θ) ω × r.
    RAGTOP_INLINE TreeVec<R> curving(const TreeVec<R>& r) const {
        const TreeVec<R> once = cross(w, r);
        return scaled(second, cross(w, once)) - scaled(third, once);
    }
    RAGTOP_INLINE TreeVec<R> operator()(const TreeVec<R>& r) const { return r + scaled(h, cross(w, r) + curving(r)); }
    RAGTOP_INLINE TreeQuat<R> operator()(const TreeQuat<R>& q) const {
        const R x = R(0.25f) * square;
        const R sine = R(0.5f) * h * (R(1.0f) - x * (R(1.0f / 6) - x * (R(1.0f / 120) - x * R(1.0f / 5040))));
        const R cosine = R(1.0f) - x * (R(0.5f) - x * (R(1.0f / 24) - x * R(1.0f / 720)));
        return TreeQuat<R>{sine * w.x, sine * w.y, sine * w.z, cosine} * q;
    }
};

/// A link in lanes: a body, and the joint that holds it.
template <class R>
struct TreeLane {
    // Of the step.
    TreeVec<R> offset, anchorC, anchorP;
    TreeQuat<R> frameC, frameP;
    TreeVec<R> acceleration, moment;  ///< m/s² and N m, forces on the body
    TreeVec<R> written;               ///< m/s, the speed that the body was given last
    // Carried from substep to substep, N s and N m s.
    TreeVec<R> force, torque;  ///< in all
    TreeVec<R> load;           ///< λ̂, about which the point gives way
    // Of the substep.
    TreeMotion<R> motion;
    R invMass;
    TreeSym<R> inverseInertia, stiffness;
    bool stiff;                   ///< some lane has stiffness
    TreeTurn<R> turn;             ///< by which errors are predicted
    TreeVec<R> wanted;            ///< of the point, beside what the turn asks for
    TreeVec<R> rC, rP, gap;       ///< m: from the centres to the anchors, and C's anchor minus P's
    TreeVec<R> still, stillTurn;  ///< relative speeds at which errors do not change
    TreeNode<R> node;
};

/// Before anything hangs from the link.
template <class R>
RAGTOP_INLINE void clearMomentum(TreeLane<R>& link) {
    const TreeVec<R> none{R(0.0f), R(0.0f), R(0.0f)};
    link.node.momentum = {none, none};
}
template <class R>
RAGTOP_INLINE void clearNode(TreeLane<R>& link) {
    const R zero(0.0f);
    const TreeVec<R> none{zero, zero, zero};
    const TreeSym<R> nothing{zero, zero, zero, zero, zero, zero};
    link.node.inertia = {nothing, {none, none, none}, nothing};
    clearMomentum(link);
}
template <class R>
RAGTOP_INLINE void clearSums(TreeLane<R>& link) {
    const R zero(0.0f);
    link.stiffness = {zero, zero, zero, zero, zero, zero};
    link.stiff = false;
    clearNode(link);
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

/// Relative speed of a joint's point, from the velocities in `motion`.
template <class R>
RAGTOP_INLINE TreeVec<R> opening(const TreeLane<R>& link, const TreeMotion<R>& p) {
    const TreeMotion<R>& c = link.motion;
    return ((c.v - p.v) + (c.fine - p.fine)) + (cross(c.w, link.node.armC) - cross(p.w, link.node.armP));
}
/// What the rows still need to reach relative speeds `u` and `w`.
template <class R>
RAGTOP_INLINE void ask(TreeLane<R>& link, const TreeMotion<R>& p, const TreeVec<R>& u, const TreeVec<R>& w) {
    link.node.d = u - opening(link, p);
    link.node.e = w - (link.motion.w - p.w);
}

/// Targets of a joint, with errors predicted for the turns of its link and of its parent; `again` about other turns.
template <class R>
RAGTOP_INLINE void aim(TreeLane<R>& link, const direct::TreeLink& at, const TreeMotion<R>& p, const TreeTurn<R>& turnP,
                       R h, R rate, bool again) {
    const TreeTurn<R>& turnC = link.turn;
    if (!again) link.wanted = -(scaled(rate, link.gap) + opening(link, p));
    link.still = turnP.curving(link.rP) - turnC.curving(link.rC) - cross(scaled(R(0.5f), turnC.w + turnP.w), link.gap);
    link.node.d = link.wanted + link.still;
    if (!turnsWithParent<R>(at.joint)) return;
    const TreeQuat<R> qC = link.motion.dq * link.frameC, qP = p.dq * link.frameP;
    TreeVec<R> error, ahead;
    if (at.joint == direct::TreeJoint::hinge) {
        const TreeVec<R> xC = axisX(qC), xP = axisX(qP);
        link.node.axis = at.childIsB ? xC : xP;
        error = errorOfAxes(xP, xC);
        ahead = errorOfAxes(turnP(xP), turnC(xC));
    } else {
        error = errorOfFrames(qP, qC);
        ahead = errorOfFrames(turnP(qP), turnC(qC));
    }
    link.stillTurn = turnC.w - turnP.w - scaled(R(1.0f) / h, ahead - error);
    link.node.e = link.stillTurn - scaled(rate, error) - (link.motion.w - p.w);
}

/// The speeds at which a joint rests, where it is now.
template <class R>
RAGTOP_INLINE void rest(TreeLane<R>& link, const direct::TreeLink& at, const TreeMotion<R>& p) {
    const TreeVec<R> none{R(0.0f), R(0.0f), R(0.0f)};
    if (at.joint == direct::TreeJoint::hinge)
        link.node.axis = at.childIsB ? axisX(link.motion.dq * link.frameC) : axisX(p.dq * link.frameP);
    ask(link, p, none, none);
}

/// The larger part of ∂²/∂θ² of a force's work on an arm, (F · r) E − ½ (r Fᵀ + F rᵀ): what is not negative.
template <class R>
RAGTOP_APART TreeSym<R> tautStiffness(const TreeVec<R>& force, const TreeVec<R>& arm, R f, R r, R share) {
    const R zero(0.0f), one(1.0f), largest = f * r, along = dot(force, arm);
    const R inverse = one / select(largest > zero, largest, one), inverseR = inverse * f, inverseF = inverse * r;
    const TreeVec<R> axis = cross(arm, force), apart = scaled(inverseR, arm) - scaled(inverseF, force);
    const R sine2 = dot(axis, axis), spread2 = dot(apart, apart);
    const auto bent = (sine2 > R(1e-12f) * largest * largest) & (spread2 > R(1e-12f));
    const R pulls = select(along > zero, share, zero);
    // In line: F r across the arm, if it pulls.
    const R stiff = select(bent, zero, pulls * largest);
    const TreeSym<R> across = outer(-(stiff * (inverseR * inverseR)), arm);
    const R first = select(bent, pulls * along / select(bent, sine2, one), zero);
    const R second = select(bent, R(0.5f) * share * (along + largest) / select(bent, spread2, one), zero);
    return TreeSym<R>{stiff, zero, zero, stiff, zero, stiff} + across + outer(first, axis) + outer(second, apart);
}

/// The most that a moment turns the link about an axis across the arm, or a little more: what tension minds.
template <class R>
RAGTOP_INLINE R easeAcross(const TreeSym<R>& i, const TreeVec<R>& arm) {
    const R square = dot(arm, arm), along = dot(arm, i * arm), largest = max(i.xx, max(i.yy, i.zz));
    if (!TreeReal<R>::kLeapfrog) return largest;
    return min(largest, i.xx + i.yy + i.zz - along / max(square, R(1e-30f)));
}

/// For a thin link T = |impulse|/h, r = L/2 and I = m L²/12, so 4 T h²/(m L) = ⅔ h |impulse| r / I.
template <class R>
RAGTOP_INLINE void addStiffness(TreeLane<R>& link, const TreeVec<R>& impulse, const TreeVec<R>& arm, R h) {
    const TreeSym<R>& i = link.inverseInertia;
    const R factor = R(2.0f / 3 / kTreeStiffLink) * h, f2 = dot(impulse, impulse), r2 = dot(arm, arm);
    const R bound = factor * max(i.xx, max(i.yy, i.zz));
    if (!any(f2 * r2 * (bound * bound) > R(0.99f))) return;  // the ratio below is less than one for certain
    link.stiff = true;
    const R f = sqrt(f2), r = sqrt(r2), ratio = factor * f * r * easeAcross(i, arm);
    const R share = max(R(0.0f), min(R(1.0f), ratio - R(1.0f)));
    link.stiffness = link.stiffness + tautStiffness(impulse, arm, f, r, share * R(kTreeImplicit) * h);
}

template <class R>
RAGTOP_INLINE typename TreeReal<R>::Test isVeryTaut(const TreeLane<R>& link) {
    const TreeSym<R>&k = link.stiffness, &i = link.inverseInertia;
    return max(k.xx * i.xx, max(k.yy * i.yy, k.zz * i.zz)) > R(kTreeVeryTaut);
}

}  // namespace
}  // namespace ragtop
