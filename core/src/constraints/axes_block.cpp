#include "constraints/axes_block.h"

#include "constraints/joint_constants.h"

namespace ragtop {
namespace {

PairVector operator*(float s, const PairVector& a) { return {s * a.linear, s * a.angular}; }
void operator+=(PairVector& a, const PairVector& b) {
    a.linear += b.linear;
    a.angular += b.angular;
}

PairVector velocityOf(const PairMass& mass, const PairVector& impulse) {
    return {mass.linear * impulse.linear + transposeTimes(mass.coupling, impulse.angular),
            mass.coupling * impulse.linear + mass.angular * impulse.angular};
}

/// x ← K_rr⁻¹ x
void solveRigid(const AxesBlock& block, float (&x)[AxesBlock::kMostRigid]) {
    const std::uint32_t n = block.rigidRows;
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t k = 0; k < i; ++k) x[i] -= block.lower[i][k] * x[k];
    for (std::uint32_t i = 0; i < n; ++i) x[i] *= block.lower[i][i];
    for (std::uint32_t i = n; i-- > 0;)
        for (std::uint32_t k = i + 1; k < n; ++k) x[i] -= block.lower[k][i] * x[k];
}

void factorRigid(AxesBlock& block, const PairVector (&moved)[AxesBlock::kMostRigid]) {
    float pivots[AxesBlock::kMostRigid] = {};
    for (std::uint32_t j = 0; j < block.rigidRows; ++j) {
        const float diagonal = speedAlong(block.rigid[j], moved[j]);
        float pivot = diagonal;
        for (std::uint32_t k = 0; k < j; ++k) pivot -= block.lower[j][k] * block.lower[j][k] * pivots[k];
        const bool moves = pivot > kZeroPivot * diagonal;
        pivots[j] = moves ? pivot : 0;
        block.lower[j][j] = moves ? 1 / pivot : 0;
        for (std::uint32_t i = j + 1; i < block.rigidRows; ++i) {
            float value = speedAlong(block.rigid[i], moved[j]);
            for (std::uint32_t k = 0; k < j; ++k) value -= block.lower[i][k] * block.lower[j][k] * pivots[k];
            block.lower[i][j] = value * block.lower[j][j];
        }
    }
}

}  // namespace

bool isHeld(const AxesBlock& block) {
    for (std::uint32_t f = 0; f < block.freeRows; ++f)
        if (block.axis[f].atLower.recovery == 0 || block.axis[f].atUpper.recovery == 0) return true;
    return false;
}

void refreshMass(AxesBlock& block, const PairMass& mass) {
    PairVector moved[AxesBlock::kMostRigid];
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) moved[i] = velocityOf(mass, block.rigid[i]);
    factorRigid(block, moved);
    for (std::uint32_t f = 0; f < block.freeRows; ++f) {
        block.axis[f].inverseMass = 0;
        if (block.axis[f].features == 0) continue;
        const float whole = speedAlong(block.free[f], velocityOf(mass, block.free[f]));
        float left = whole;
        for (std::uint32_t i = 0; i < block.rigidRows; ++i) block.gain[f][i] = speedAlong(block.free[f], moved[i]);
        solveRigid(block, block.gain[f]);
        for (std::uint32_t i = 0; i < block.rigidRows; ++i)
            left -= block.gain[f][i] * speedAlong(block.free[f], moved[i]);
        block.axis[f].inverseMass = left > kZeroPivot * whole ? left : 0.0f;
    }
}

PairVector warmStartImpulse(const AxesBlock& block) {
    PairVector sum;
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) sum += block.impulse[i] * block.rigid[i];
    for (std::uint32_t f = 0; f < block.freeRows; ++f) sum += axisImpulse(block.axis[f]) * block.free[f];
    return sum;
}

void beginAxes(AxesBlock& block, const BodyPair& pair, const Arms& arms, float reaction, const JointContext& context) {
    const PairVector u = pair.velocity(arms);
    bool hadImpact = false;
    for (std::uint32_t f = 0; f < block.freeRows; ++f)
        hadImpact |= beginAxis(block.axis[f], coordinateOf(block, f), speedAlong(block.free[f], u), reaction, context,
                               block.freeBend[f]);
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) {
        if (hadImpact) block.impulse[i] = block.startImpulse[i];
        block.startImpulse[i] = block.impulse[i];
    }
}

void rescale(AxesBlock& block, float ratio) {
    for (float& impulse : block.impulse) rescale(impulse, ratio);
    for (float& impulse : block.startImpulse) rescale(impulse, ratio);
    // What a rate changes by within a substep grows with it.
    for (float& bend : block.rigidBend) rescale(bend, ratio);
    for (float& bend : block.freeBend) rescale(bend, ratio);
    for (AxisRows& axis : block.axis) rescale(axis, ratio);
}

PairVector freeImpulse(AxesBlock& block, std::uint32_t coordinate, float amount) {
    PairVector impulse = amount * block.free[coordinate];
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) {
        const float keeps = -amount * block.gain[coordinate][i];
        block.impulse[i] += keeps;
        impulse += keeps * block.rigid[i];
    }
    return impulse;
}

/// As reactionTo: what keeps a rigid row's velocity under all that acts along free coordinates.
static float reactionOf(const AxesBlock& block, std::uint32_t row) {
    float sum = 0;
    for (std::uint32_t f = 0; f < block.freeRows; ++f)
        if (block.axis[f].features != 0) sum -= axisImpulse(block.axis[f]) * block.gain[f][row];
    return sum;
}

BodyPair held(const AxesBlock& block, const BodyPair& pair, const Arms& arms, bool bending) {
    const PairVector u = pair.velocity(arms);
    float impulse[AxesBlock::kMostRigid] = {};
    for (std::uint32_t i = 0; i < block.rigidRows; ++i)
        impulse[i] = -(speedAlong(block.rigid[i], u) + (bending ? block.rigidBend[i] : 0.0f));
    solveRigid(block, impulse);
    PairVector total;
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) total += impulse[i] * block.rigid[i];
    BodyPair holds = pair;
    holds.apply(arms, total);
    return holds;
}

void closeAxes(const AxesBlock& block, const BodyPair& pair, const Arms& arms, float share) {
    float change[AxesBlock::kMostRigid] = {};
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) change[i] = -share * block.error[i];
    solveRigid(block, change);
    PairVector total;
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) total += change[i] * block.rigid[i];
    pair.move(arms, total);
}

namespace {

/// Stops of several coordinates at once: what one gives the others take in part, so that one after the other they lose
/// and give back energy for substeps until they agree. Once two act they are solved together, by iterations of their
/// own over the speeds of the coordinates, u = u₀ + P λ with P = K_ff − K_fr K_rr⁻¹ K_rf: their impulse is then the
/// projection of the velocity on what the stops allow, which only loses energy [Moreau, 1983].
class JointStops {
public:
    JointStops(AxesBlock& block, const BodyPair& pair, const Arms& arms) : block_(block) {
        int act = 0;
        for (std::uint32_t f = 0; f < block.freeRows; ++f) {
            const AxisRows& axis = block.axis[f];
            if (!axis.keepsRange() || !(axis.inverseMass > 0)) continue;
            stops_[count_++] = f;
            act += axis.atLower.impulse != 0 || axis.atUpper.impulse != 0 ? 1 : 0;
        }
        if (act < 2) count_ = 0;
        if (count_ > 0) couple(pair, arms);
    }

    void settle(BodyPair& pair, const Arms& arms, const JointContext& context, bool moving) {
        constexpr int kIterations = 32;  // a bound, by trial
        constexpr float kAgreed = 1e-8f;  // of the energies of the impulses
        for (int iteration = 0; iteration < kIterations && count_ > 0; ++iteration) {
            float changed = 0, whole = 0;
            for (int i = 0; i < count_; ++i) {
                AxisRows& axis = block_.axis[stops_[i]];
                const float change = solveStops(axis, speed_[i], context, moving, block_.freeBend[stops_[i]]);
                for (int k = 0; k < count_; ++k) speed_[k] += response_[k][i] * change;
                total_[i] += change;
                changed += axis.inverseMass * change * change;
                const float impulse = axis.atLower.impulse - axis.atUpper.impulse;
                whole += axis.inverseMass * impulse * impulse;
            }
            if (!(changed > kAgreed * whole)) break;
        }
        for (int i = 0; i < count_; ++i)
            if (total_[i] != 0) pair.apply(arms, freeImpulse(block_, stops_[i], total_[i]));
    }

private:
    void couple(const BodyPair& pair, const Arms& arms) {
        const PairVector u = pair.velocity(arms);
        const PairMass mass = pair.mass(arms);
        for (int i = 0; i < count_; ++i) {
            const std::uint32_t f = stops_[i];
            PairVector along = block_.free[f];
            for (std::uint32_t r = 0; r < block_.rigidRows; ++r) along += -block_.gain[f][r] * block_.rigid[r];
            const PairVector moved = velocityOf(mass, along);
            for (int k = 0; k < count_; ++k) response_[k][i] = speedAlong(block_.free[stops_[k]], moved);
            speed_[i] = speedAlong(block_.free[f], u);
        }
    }

    AxesBlock& block_;
    int count_ = 0;
    std::uint32_t stops_[AxesBlock::kMostFree] = {};
    float response_[AxesBlock::kMostFree][AxesBlock::kMostFree] = {};  ///< P
    float speed_[AxesBlock::kMostFree] = {}, total_[AxesBlock::kMostFree] = {};
};

}  // namespace

void solveAxes(AxesBlock& block, BodyPair& pair, const Arms& arms, const Softness& soft, const JointContext& context,
               bool moving) {
    const PairVector u = pair.velocity(arms);
    float change[AxesBlock::kMostRigid] = {};
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) {
        const float bend = moving ? block.rigidBend[i] : 0.0f;
        change[i] = -(speedAlong(block.rigid[i], u) + bend + soft.biasRate * block.error[i]);
    }
    solveRigid(block, change);
    PairVector total;
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) {
        change[i] = soft.massScale * change[i] - soft.impulseScale * (block.impulse[i] - reactionOf(block, i));
        block.impulse[i] += change[i];
        total += change[i] * block.rigid[i];
    }
    pair.apply(arms, total);
    for (std::uint32_t f = 0; f < block.freeRows; ++f) {
        if (block.axis[f].features == 0) continue;
        const float speed = speedAlong(block.free[f], pair.velocity(arms));
        pair.apply(arms, freeImpulse(block, f, solveAxis(block.axis[f], speed, context, moving, block.freeBend[f])));
    }
    JointStops(block, pair, arms).settle(pair, arms, context, moving);
}

}  // namespace ragtop
