#include "constraints/soft_account.h"

#include <cmath>

#include "constraints/joint_sim.h"
#include "constraints/soft_course.h"

namespace ragtop {
namespace {

/// Only stops, or stops with what brakes: nothing drives the coordinate.
bool keepsAccount(const JointSim& joint) {
    constexpr std::uint32_t kPassive = AxisRows::kLimit | AxisRows::kFriction | AxisRows::kViscous;
    const AxisRows& axis = joint.axis;
    return (joint.kind == JointKind::hinge || joint.kind == JointKind::slider) && axis.stop.stiffness > 0 &&
           (axis.features & AxisRows::kLimit) != 0 && (axis.features & ~kPassive) == 0 && axis.inverseMass > 0;
}

float stored(const AxisRows& axis) {
    const float lower = axis.atLower.margin < 0 ? axis.atLower.margin : 0.0f;
    const float upper = axis.atUpper.margin < 0 ? axis.atUpper.margin : 0.0f;
    return 0.5f * axis.stop.stiffness * (lower * lower + upper * upper);
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

/// Beyond rounding of the speeds that the kicks are differences of.
bool isSteady(const Vec3& kick, const Vec3& last, const Vec3& speed) {
    constexpr float kSame = 1e-3f, kRounding = 1e-6f;
    return length(kick - last) <= kSame * length(last) + kRounding * length(speed);
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
Torque torqueBetween(const Vec3& before, const Vec3& now, const BodyInertia& inertia, float h) {
    constexpr float kRounding = 1e-5f;
    const Vec3 change = now - before;
    const Vec3 gain = 0.5f * h * (inertia * cross(momentumOf(inertia, before), before));
    const float square = lengthSquared(before), both = square + 4 * lengthSquared(gain);
    const Vec3 rest = change - (both > 0 ? square / both : 0.0f) * gain;
    const float work = dot(before, momentumOf(inertia, change)) + 0.5f * dot(rest, momentumOf(inertia, rest));
    return {length(rest) > kRounding * length(before), work};
}

float freeSpeed(const JointSim& joint, const BodyPair& pair) {
    const PairVector u = pair.velocity(joint.arms);
    return dot(joint.block.basis.cz, joint.block.linearFirst ? u.angular : u.linear);
}

/// A coordinate that a stop has let go at its time: free, or in the other stop already, where rows lag behind its
/// speed.
class Released {
public:
    Released(const AxisRows& axis, float h) {
        if (axis.atLower.meets == kArrives) met_ = &axis.atLower, side_ = 1;
        if (axis.atUpper.meets == kArrives) met_ = &axis.atUpper, side_ = -1;
        if (met_) course_ = {axis.stop, axis.inverseMass, h, axis.upper - axis.lower};
    }
    bool crossed() const { return met_ != nullptr; }
    float speedOf(float row) const {
        return met_ ? static_cast<float>(side_ * course_.speedAt(margin(), side_ * static_cast<double>(row))) : row;
    }
    float rowOf(float speed) const {
        return met_ ? static_cast<float>(side_ * course_.rowSpeedAt(margin(), side_ * static_cast<double>(speed)))
                    : speed;
    }

private:
    double margin() const { return static_cast<double>(met_->margin); }

    const StopSide* met_ = nullptr;
    double side_ = 1;
    SoftCourse course_;
};

/// J, of the relative motion and the stop. What a row lags behind by is the free coordinate's, which turns and moves
/// apart from all others.
float energyOf(const JointSim& joint, const BodyPair& pair, const Released& released) {
    const float row = freeSpeed(joint, pair), speed = released.speedOf(row);
    const float beyond = released.crossed() ? 0.5f * (speed - row) * (speed + row) / joint.axis.inverseMass : 0.0f;
    return pair.relativeEnergy() + stored(joint.axis) + beyond;
}

/// The coordinate gets the energy `missing`:  s'² = s² + 2 w e. Never more than a tenth of what it has, and never all
/// of it is taken.
void settle(JointSim& joint, BodyPair& pair, const Released& released, float missing) {
    constexpr float kMostTaken = 0.75f, kMostGiven = 0.1f;
    RigidBlock& block = joint.block;
    const float row = freeSpeed(joint, pair), speed = released.speedOf(row), w = joint.axis.inverseMass;
    const float energy = 0.5f * speed * speed / w;
    if (!(energy > 0)) return;
    const float asked = missing / energy;
    const float share = asked < -kMostTaken ? -kMostTaken : asked > kMostGiven ? kMostGiven : asked;
    const Vec3 first = block.impulseFirst, second = block.impulseSecond;
    pair.apply(joint.arms, freeImpulse(block, (released.rowOf(std::sqrt(1 + share) * speed) - row) / w));
    block.impulseFirst = first;
    block.impulseSecond = second;
    joint.axis.atLower.wasSeen = joint.axis.atUpper.wasSeen = 0;
}

}  // namespace

void beginAccount(JointSim& joint, const BodyPair& pair) {
    if (!keepsAccount(joint)) return;
    SoftAccount& account = joint.account;
    account = {};
    account.known = account.steady = account.pressed = 1;
    account.kept = pair.relativeEnergy() + stored(joint.axis);
    account.last = pair.relativeVelocity();
    noteOwn(joint, pair, AccountPass::none);
}

void openAccount(JointSim& joint, const BodyPair& pair, float h) {
    if (!keepsAccount(joint)) return;
    SoftAccount& account = joint.account;
    const Vec3 speed = pair.relativeVelocity(), kick = speed - account.last;
    const Turning spin = pair.turns();
    const Torque a = torqueBetween(account.spinA, spin.a, pair.inertiaA(), h);
    const Torque b = torqueBetween(account.spinB, spin.b, pair.inertiaB(), h);
    const bool forced = account.begun > 0 && !isSteady(kick, account.kick, speed);
    if (!(account.known > 0) || forced || a.any || b.any || !movesByItself(pair.stateA()) ||
        !movesByItself(pair.stateB()))
        account.steady = 0;
    account.kept += a.work + b.work;
    account.way = pair.relativeWay();
    account.kick = kick;
    account.known = account.begun = 1;
}

void watchOthers(JointSim& joint, const BodyPair& pair) {
    if (!keepsAccount(joint)) return;
    SoftAccount& account = joint.account;
    const Turning spin = pair.turns();
    // The motion in between turns the spins by itself, once the moving pass is over.
    const bool turned = account.pass == AccountPass::warmStart && !(spin.a == account.spinA && spin.b == account.spinB);
    if (turned || !(pair.relativeVelocity() == account.speed)) account.steady = 0;
}

void noteOwn(JointSim& joint, const BodyPair& pair, AccountPass pass) {
    if (!keepsAccount(joint)) return;
    SoftAccount& account = joint.account;
    account.pass = account.pass == AccountPass::none && pass == AccountPass::moving ? AccountPass::none : pass;
    account.speed = pair.relativeVelocity();
    account.spinA = pair.turns().a, account.spinB = pair.turns().b;
}

/// Work of a steady force g over a substep: v ends a kick late and places half of one, so that ½ h g Δv is counted
/// twice,
///   W = μ g (Δx − ½ h Δv).
static float workOf(const SoftAccount& account, const BodyPair& pair, float inverseH) {
    const Vec3 way = pair.relativeWay() - account.way, gained = pair.relativeVelocity() - account.last;
    return pair.reducedMass() * dot(account.kick, inverseH * way - 0.5f * gained);
}

void settleAccount(JointSim& joint, BodyPair& pair, const JointContext& context) {
    if (!keepsAccount(joint) || joint.account.pass != AccountPass::moving) return;
    SoftAccount& account = joint.account;
    const AxisRows& axis = joint.axis;
    account.kept += workOf(account, pair, context.inverseH);
    if (!isReleased(axis)) {
        account.pressed = 1;
    } else {
        const Released released(axis, context.h);
        if (account.steady > 0) {
            const bool brakes = axis.stop.damping > 0 || axis.features != AxisRows::kLimit;
            const float missing = account.kept - energyOf(joint, pair, released);
            if (missing < 0 || (account.pressed > 0 && !brakes)) settle(joint, pair, released, missing);
            if (brakes && missing > 0) account.kept -= missing;
        } else {
            account.steady = 1;
            account.kept = energyOf(joint, pair, released);
        }
        account.pressed = released.crossed() ? 1.0f : 0.0f;
    }
    account.last = pair.relativeVelocity();
    noteOwn(joint, pair, AccountPass::none);
}

}  // namespace ragtop
