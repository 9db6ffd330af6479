#include "constraints/stop_ledger.h"

#include <cmath>

#include "constraints/joint_sim.h"
#include "constraints/soft_stops.h"
#include "constraints/stop_trajectory.h"

namespace ragtop {
namespace {

/// Of coordinates that nothing drives: only stops, or stops with what brakes.
constexpr std::uint32_t kPassiveAxis = AxisRows::kLimit | AxisRows::kFriction | AxisRows::kViscous;
constexpr std::uint32_t kStopsOfBall = BallRows::kSwing | BallRows::kTwist;
constexpr std::uint32_t kPassiveBall = kStopsOfBall | BallRows::kFriction | BallRows::kViscous;

bool keepsLedger(const JointSim& joint) {
    if (joint.kind == JointKind::ball) {
        const BallRows& rows = joint.ball;
        return rows.stop.stiffness > 0 && (rows.features & kStopsOfBall) != 0 && (rows.features & ~kPassiveBall) == 0;
    }
    if (joint.kind == JointKind::none || joint.kind == JointKind::fixed) return false;
    bool soft = false, driven = false;
    eachAxis(joint, [&](const AxisRows& axis, const PairVector&) {
        soft = soft || hasSoftStops(axis);
        driven = driven || (axis.features & ~kPassiveAxis) != 0;
    });
    return soft && !driven;
}

/// Does anything take energy and keep it?
bool brakes(const JointSim& joint) {
    if (joint.kind == JointKind::ball) return joint.ball.stop.damping > 0 || (joint.ball.features & ~kStopsOfBall) != 0;
    bool any = false;
    eachAxis(joint, [&](const AxisRows& axis, const PairVector&) {
        const bool hard = (axis.features & AxisRows::kLimit) != 0 && !(axis.stop.stiffness > 0);
        any = any || hard || axis.stop.damping > 0 || (axis.features & ~AxisRows::kLimit) != 0;
    });
    return any;
}

float stored(const JointSim& joint) {
    float sum = 0;
    const auto add = [&](const Stop& stop, const StopSide& side) {
        if (side.margin < 0) sum += 0.5f * stop.stiffness * (side.margin * side.margin);
    };
    if (joint.kind == JointKind::ball)
        eachSide(joint.ball, [&](const StopSide& side, const Vec3&) { add(joint.ball.stop, side); });
    eachAxis(joint, [&](const AxisRows& axis, const PairVector&) {
        if (!hasSoftStops(axis)) return;
        add(axis.stop, axis.atLower);
        add(axis.stop, axis.atUpper);
    });
    return sum;
}

/// A stop that has just let go at its time, or none that gives or will give anything.
bool isFree(const StopSide& side) {
    return side.margin >= 0 && (side.meets == kLeaves ||
                                (side.meets == 0 && !(side.impulse > 0) && !(side.due > 0) && !(side.pressed > 0)));
}

/// A stop has let go, and the other has nothing to give or has been met since.
bool isReleased(const AxisRows& axis) {
    const StopSide &lower = axis.atLower, &upper = axis.atUpper;
    const auto crossed = [](const StopSide& from, const StopSide& to) {
        return from.margin >= 0 && from.meets == kLeaves && to.meets == kArrives;
    };
    return (isFree(lower) && isFree(upper)) || crossed(lower, upper) || crossed(upper, lower);
}

/// Where sides press each other, of balls and of several coordinates, they let go between substeps: when none is
/// violated.
bool isReleased(const JointSim& joint) {
    bool released = true;
    if (joint.kind == JointKind::ball)
        eachSide(joint.ball, [&](const StopSide& side, const Vec3&) { released = released && side.margin >= 0; });
    eachAxis(joint, [&](const AxisRows& axis, const PairVector&) {
        const bool inside = hasAxes(joint.kind) && axis.atLower.margin >= 0 && axis.atUpper.margin >= 0;
        released = released && (!hasSoftStops(axis) || inside || isReleased(axis));
    });
    return released;
}
/// What is settled is no longer pressed.
void letGo(StopSide& side) {
    side.wasSeen = 0;
    if (side.margin >= 0 && !isFree(side)) side.meets = kLeaves;
}

/// Beyond rounding of the speeds that the kicks are differences of.
bool isSteady(const Vec3& kick, const Vec3& last, const Vec3& speed) {
    constexpr float kSameKick = 1e-3f, kRounding = 1e-6f;  // of a kick, by trial; of speeds, eight roundings of a float
    return length(kick - last) <= kSameKick * length(last) + kRounding * length(speed);
}

/// What is moved by other hands gives and takes energy at every turn: a turntable, a body with locks.
bool movesByItself(const BodyState& body) { return body.locks == 0 && (body.invMass > 0 || body.w == Vec3{}); }

/// Of a body between the relaxing pass and the next substep: its spin is only told half a substep ahead, as
/// integrateVelocities does, by
///   f = s ½ h I⁻¹ (L × ω),  s = ω²/(ω² + 4 |½ h I⁻¹ (L × ω)|²),
/// which gives no energy, as I f ⟂ ω. What else Δω holds is a torque's, and the work of that is
///   ω · I Δω + ½ (Δω − f) · I (Δω − f).
struct Torque {
    bool any;
    float work;  ///< J, J of rounding where there is none
};
Torque torqueBetween(const Vec3& before, const Vec3& now, const Sym3& inertia, float h) {
    constexpr float kRounding = 1e-5f;  // of a speed: eighty roundings of a float
    const Vec3 change = now - before;
    const Vec3 gain = 0.5f * h * (inertia * cross(momentumOf(inertia, before), before));
    const float square = lengthSquared(before), both = square + 4 * lengthSquared(gain);
    const Vec3 rest = change - (both > 0 ? square / both : 0.0f) * gain;
    const float work = dot(before, momentumOf(inertia, change)) + 0.5f * dot(rest, momentumOf(inertia, rest));
    return {length(rest) > kRounding * length(before), work};
}

/// A coordinate that a stop has let go at its time: free, or in the other stop already, where rows lag behind its
/// speed.
class Released {
public:
    Released(const AxisRows& axis, float h) {
        if (axis.atLower.meets == kArrives) met_ = &axis.atLower, side_ = 1;
        if (axis.atUpper.meets == kArrives) met_ = &axis.atUpper, side_ = -1;
        if (met_) trajectory_ = {axis.stop, axis.inverseMass, h, axis.upper - axis.lower};
    }
    bool crossed() const { return met_ != nullptr; }
    float speedOf(float row) const {
        return met_ ? static_cast<float>(side_ * trajectory_.speedAt(margin(), side_ * static_cast<double>(row))) : row;
    }
    float rowOf(float speed) const {
        return met_ ? static_cast<float>(side_ * trajectory_.rowSpeedAt(margin(), side_ * static_cast<double>(speed)))
                    : speed;
    }

private:
    double margin() const { return static_cast<double>(met_->margin); }

    const StopSide* met_ = nullptr;
    double side_ = 1;
    StopTrajectory trajectory_;
};

/// J, of the relative motion and the stops. What a row lags behind by is its coordinate's, which turns and moves apart
/// from all others.
float energyOf(const JointSim& joint, const BodyPair& pair, float h) {
    const PairVector u = pair.velocity(joint.arms);
    float beyond = 0;
    eachAxis(joint, [&](const AxisRows& axis, const PairVector& along) {
        if (!hasSoftStops(axis)) return;
        const Released released(axis, h);
        const float row = speedAlong(along, u), speed = released.speedOf(row);
        if (released.crossed()) beyond += 0.5f * (speed - row) * (speed + row) / axis.inverseMass;
    });
    return pair.relativeEnergy() + stored(joint) + beyond;
}

/// Of an energy, never more than a tenth is given, and never all of it taken.
float shareOf(float missing, float energy) {
    constexpr float kMostTaken = 0.99f, kMostGiven = 0.1f;  // as above
    const float asked = missing / energy;
    return asked < -kMostTaken ? -kMostTaken : asked > kMostGiven ? kMostGiven : asked;
}

/// The coordinate gets the energy `missing`:  s'² = s² + 2 w e, of several the one that has most.
void settleAxis(JointSim& joint, BodyPair& pair, float missing, float h) {
    const PairVector u = pair.velocity(joint.arms);
    float most = 0, amount = 0;
    std::uint32_t index = 0, chosen = 0;
    eachAxis(joint, [&](AxisRows& axis, const PairVector& along) {
        const std::uint32_t coordinate = index++;
        if (!hasSoftStops(axis)) return;
        letGo(axis.atLower);
        letGo(axis.atUpper);
        const Released released(axis, h);
        const float row = speedAlong(along, u), speed = released.speedOf(row), w = axis.inverseMass;
        const float energy = 0.5f * speed * speed / w;
        if (!(energy > most)) return;
        most = energy, chosen = coordinate;
        amount = (released.rowOf(std::sqrt(1 + shareOf(missing, energy)) * speed) - row) / w;
    });
    if (most > 0) pair.apply(joint.arms, impulseAlong(joint, chosen, amount));
}

/// All of the relative rotation, ½ ω · P⁻¹ ω, gets it; no side is pressed any more.
void settleBall(JointSim& joint, BodyPair& pair, float missing) {
    RigidBlock& block = joint.block;
    const Vec3 speed = pair.velocity(joint.arms).angular, momentum = solve(block.second, speed);
    const float energy = 0.5f * dot(speed, momentum);
    if (!(energy > 0)) return;
    const Vec3 turn = (std::sqrt(1 + shareOf(missing, energy)) - 1) * momentum;
    pair.apply(joint.arms, {-(block.mass.gain * turn), turn});
    eachSide(joint.ball, [](StopSide& side, const Vec3&) { letGo(side); });
}

}  // namespace

void beginLedger(JointSim& joint, const BodyPair& pair) {
    if (!keepsLedger(joint)) return;
    StopLedger& ledger = joint.ledger;
    ledger = {};
    ledger.known = ledger.steady = ledger.pressed = 1;
    ledger.kept = pair.relativeEnergy() + stored(joint);
    ledger.last = pair.relativeVelocity();
    recordOwn(joint, pair, LedgerPass::none);
}

void openLedger(JointSim& joint, const BodyPair& pair, float h) {
    if (!keepsLedger(joint)) return;
    StopLedger& ledger = joint.ledger;
    const Vec3 speed = pair.relativeVelocity(), kick = speed - ledger.last;
    const Turning spin = pair.turns();
    const Torque a = torqueBetween(ledger.spinA, spin.a, pair.inertiaA, h);
    const Torque b = torqueBetween(ledger.spinB, spin.b, pair.inertiaB, h);
    const bool forced = ledger.begun > 0 && !isSteady(kick, ledger.kick, speed);
    if (!(ledger.known > 0) || forced || a.any || b.any || !movesByItself(pair.stateA()) ||
        !movesByItself(pair.stateB()))
        ledger.steady = 0;
    ledger.kept += a.work + b.work;
    ledger.way = pair.relativeWay();
    ledger.kick = kick;
    ledger.known = ledger.begun = 1;
}

void watchOthers(JointSim& joint, const BodyPair& pair) {
    if (!keepsLedger(joint)) return;
    StopLedger& ledger = joint.ledger;
    const Turning spin = pair.turns();
    // The motion in between turns the spins by itself, once the moving pass is over.
    const bool turned = ledger.pass == LedgerPass::warmStart && !(spin.a == ledger.spinA && spin.b == ledger.spinB);
    if (turned || !(pair.relativeVelocity() == ledger.speed)) ledger.steady = 0;
}

void recordOwn(JointSim& joint, const BodyPair& pair, LedgerPass pass) {
    if (!keepsLedger(joint)) return;
    StopLedger& ledger = joint.ledger;
    ledger.pass = ledger.pass == LedgerPass::none && pass == LedgerPass::moving ? LedgerPass::none : pass;
    ledger.speed = pair.relativeVelocity();
    ledger.spinA = pair.turns().a, ledger.spinB = pair.turns().b;
}

/// Work of a steady force g over a substep: v ends a kick late and places half of one, so that ½ h g Δv is counted
/// twice,
///   W = μ g (Δx − ½ h Δv).
static float workOf(const StopLedger& ledger, const BodyPair& pair, float inverseH) {
    const Vec3 way = pair.relativeWay() - ledger.way, gained = pair.relativeVelocity() - ledger.last;
    return pair.reducedMass() * dot(ledger.kick, inverseH * way - 0.5f * gained);
}

static void settleReleased(JointSim& joint, BodyPair& pair, float h) {
    StopLedger& ledger = joint.ledger;
    if (ledger.steady > 0) {
        const bool braked = brakes(joint);
        const float missing = ledger.kept - energyOf(joint, pair, h);
        if (missing < 0 || (ledger.pressed > 0 && !braked)) {
            if (joint.kind == JointKind::ball)
                settleBall(joint, pair, missing);
            else
                settleAxis(joint, pair, missing, h);
        }
        if (braked && missing > 0) ledger.kept -= missing;
    } else {
        ledger.steady = 1;
        ledger.kept = energyOf(joint, pair, h);
    }
    ledger.pressed = 0;
    eachAxis(joint, [&](const AxisRows& axis, const PairVector&) {
        if (hasSoftStops(axis) && Released(axis, h).crossed()) ledger.pressed = 1;
    });
}

void settleLedger(JointSim& joint, BodyPair& pair, const JointContext& context) {
    if (!keepsLedger(joint) || joint.ledger.pass != LedgerPass::moving) return;
    StopLedger& ledger = joint.ledger;
    ledger.kept += workOf(ledger, pair, context.inverseH);
    if (!isReleased(joint)) {
        ledger.pressed = 1;
    } else {
        settleReleased(joint, pair, context.h);
    }
    ledger.last = pair.relativeVelocity();
    recordOwn(joint, pair, LedgerPass::none);
}

}  // namespace ragtop
