#include "constraints/soft_account.h"

#include <cmath>

#include "constraints/joint_sim.h"

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

/// The coordinate gets the energy `missing`:  s'² = s² + 2 w e. Never more than a tenth of what it has, and never all
/// of it is taken.
void settle(JointSim& joint, BodyPair& pair, float missing) {
    constexpr float kMostTaken = 0.75f, kMostGiven = 0.1f;
    RigidBlock& block = joint.block;
    const PairVector u = pair.velocity(joint.arms);
    const float speed = dot(block.basis.cz, block.linearFirst ? u.angular : u.linear), w = joint.axis.inverseMass;
    const float energy = 0.5f * speed * speed / w;
    if (!(energy > 0)) return;
    const float asked = missing / energy;
    const float share = asked < -kMostTaken ? -kMostTaken : asked > kMostGiven ? kMostGiven : asked;
    const Vec3 first = block.impulseFirst, second = block.impulseSecond;
    pair.apply(joint.arms, freeImpulse(block, (std::sqrt(1 + share) - 1) * speed / w));
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

void settleAccount(JointSim& joint, BodyPair& pair, float inverseH) {
    if (!keepsAccount(joint) || joint.account.pass != AccountPass::moving) return;
    SoftAccount& account = joint.account;
    const AxisRows& axis = joint.axis;
    account.kept += workOf(account, pair, inverseH);
    if (!isFree(axis.atLower) || !isFree(axis.atUpper)) {
        account.pressed = 1;
    } else if (account.steady > 0) {
        const bool brakes = axis.stop.damping > 0 || axis.features != AxisRows::kLimit;
        const float missing = account.kept - pair.relativeEnergy();
        if (missing < 0 || (account.pressed > 0 && !brakes)) settle(joint, pair, missing);
        if (brakes && missing > 0) account.kept -= missing;
        account.pressed = 0;
    } else {
        account.pressed = 0;
        account.steady = 1;
        account.kept = pair.relativeEnergy();
    }
    account.last = pair.relativeVelocity();
    noteOwn(joint, pair, AccountPass::none);
}

}  // namespace ragtop
