#include "constraints/rows.h"

namespace ragtop {
namespace {

Vec3 inverseMassOf(const BodyState& state) {
    const float m = state.invMass;
    return {state.locks & 1u ? 0.0f : m, state.locks & 2u ? 0.0f : m, state.locks & 4u ? 0.0f : m};
}

/// The inverse inertia, none of what nothing moves.
Sym3 inertiaOf(const BodyState& state, const BodyInertia& i) {
    return state.invMass > 0 ? Sym3{i.xx, i.xy, i.xz, i.yy, i.yz, i.zz} : Sym3{};
}
float shareOf(const BodyState& state, const BodyInertia& i) {
    return state.invMass > 0 ? TautBody::share(i.taut) : 1.0f;
}

}  // namespace

BodyPair::BodyPair(BodyState* states, const BodyInertia* inertia, std::uint32_t a, std::uint32_t b)
    : PairMotion<float>{states[a].v,
                        states[a].w,
                        states[b].v,
                        states[b].w,
                        inverseMassOf(states[a]),
                        inverseMassOf(states[b]),
                        inertiaOf(states[a], inertia[a]),
                        inertiaOf(states[b], inertia[b]),
                        shareOf(states[a], inertia[a]),
                        shareOf(states[b], inertia[b])},
      stateA_(states + a),
      stateB_(states + b) {}

/// `pull` is h F · r.
static void addPull(BodyState& state, const Sym3& inertia, const Vec3& arm, float pull) {
    const float ratio = pull * easeAcross(inertia, arm);
    if (state.invMass > 0 && ratio > 0) state.pull += ratio;
}

void BodyPair::recordPull(const Arms& arms, const Vec3& impulse, float h) const {
    addPull(*stateA_, inertiaA, arms.a, -h * dot(arms.a, impulse));
    addPull(*stateB_, inertiaB, arms.b, h * dot(arms.b, impulse));
}

/// q ← (½ θ, 1) q, normalised.
static Quat turned(const Quat& q, const Vec3& turn) {
    return normalized(Quat{0.5f * turn.x, 0.5f * turn.y, 0.5f * turn.z, 1.0f} * q);
}

void BodyPair::move(const Arms& arms, const PairVector& impulse) const {
    BodyState &a = *stateA_, &b = *stateB_;
    if (a.invMass > 0) {
        a.dp -= scale(inverseMassA, impulse.linear);
        a.dq = turned(a.dq, -turnA(arms, impulse));
    }
    if (b.invMass > 0) {
        b.dp += scale(inverseMassB, impulse.linear);
        b.dq = turned(b.dq, turnB(arms, impulse));
    }
}

void BodyPair::store() const {
    if (stateA_->invMass > 0) {
        stateA_->v = vA;
        stateA_->w = wA;
    }
    if (stateB_->invMass > 0) {
        stateB_->v = vB;
        stateB_->w = wB;
    }
}

Vec3 momentumOf(const Sym3& inertia, const Vec3& w) { return solve(factorize(inertia, diagonal(inertia)), w); }

float BodyPair::reducedMass() const {
    const float inverse = stateA_->invMass + stateB_->invMass;
    return inverse > 0 ? 1 / inverse : 0.0f;
}

float BodyPair::relativeEnergy() const {
    return 0.5f * (reducedMass() * lengthSquared(relativeVelocity()) + dot(wA, momentumOf(inertiaA, wA)) +
                   dot(wB, momentumOf(inertiaB, wB)));
}

}  // namespace ragtop
