#include "constraints/spring_lead.h"

#include <cmath>

#include "constraints/joint_types.h"
#include "constraints/oscillator.h"
#include "constraints/soft_stops.h"

namespace ragtop {
namespace {

/// For z = (ωh)² up to 1 and x = 2ζωh. The exact course of the damped oscillator from C with speed v to C', v',
///   C' = E₁₁ C + E₁₂ v,  and that of rows,  C' = C + q₁ (h u − z C),
/// agree where v = (q₁ h/E₁₂) u − (β z/h) C, with z q₁ = 1 − 2 e cos b + e²:
///   β z = (e − cos b + a s)/s,  a = x/2, b = √(z − a²), e = e^{−a}, s = sin b/b.
/// The first factor is 1 + (ωh)²/12 and is left out.
double exactShare(double z, double x) {
    constexpr double kLittle = 1e-6, kCritical = 1e-8;  // below which series stand for quotients of differences
    const double a = 0.5 * x, under = z - a * a, left = 1 - oscillator::fading(a);
    if (!(z > kLittle * (1 + x * x))) return x > 1e-3 ? 1 + 1 / x - 1 / oscillator::fading(x) : 0.5 - x / 12;
    if (under > kCritical) {
        const double b = std::sqrt(under), half = oscillator::shortSine(0.5 * b);
        const double ratio = 2 * half * std::sqrt(1 - half * half) / b, cosine = 1 - 2 * half * half;
        return (left - cosine + a * ratio) / (z * ratio);
    }
    if (under > -kCritical) return (left - 1 + a) / z;
    const double root = std::sqrt(-under), slow = 1 - oscillator::fading(z / (a + root)),
                 fast = 1 - oscillator::fading(a + root), apart = (slow - fast) / (2 * root);
    return (left * left - 0.5 * (slow + fast) + a * apart) / (z * apart);
}

/// What a joint's springs push along their rows and how that divides between before and after a motion.
struct Leading {
    JointSim& joint;
    BodyPair& pair;
    const BodyKicks& kicks;
    float h;
    bool ends;  ///< the substep's change of speed is known

    PairVector kick() const {
        const Arms& arms = joint.arms;
        return {kicks.vB + cross(kicks.wB, arms.b) - kicks.vA - cross(kicks.wA, arms.a), kicks.wB - kicks.wA};
    }
};

/// Of what acts in this substep only as much is a load as did before, or as holds against the spring: an impact is
/// over.
float steadyOf(float now, float before, float push) {
    const auto less = [](float a, float b) { return (a < 0 ? -a : a) < (b < 0 ? -b : b) ? a : b; };
    const float same = now * before > 0 ? less(now, before) : 0.0f, holds = now * push < 0 ? less(now, -push) : 0.0f;
    return same == less(same, holds) ? holds : same;
}
Vec3 steadyOf(const Vec3& now, const Vec3& before, const Vec3& push) {
    const float square = lengthSquared(now), along = dot(now, before), against = -dot(now, push);
    const Vec3 same = !(along > 0) ? Vec3{} : along < square ? (along / square) * now : now;
    const float whole = lengthSquared(push);
    const Vec3 holds = !(against > 0) ? Vec3{} : against < whole ? -(against / whole) * push : -push;
    return lengthSquared(same) > lengthSquared(holds) ? same : holds;
}

float clamped(float value, float most) { return value > most ? most : value < -most ? -most : value; }

/// The speed that a spring along a coordinate leads by.
float leadOf(AxisRows& rows, double coordinate, float speed, float kick, const Leading& leading) {
    const float w = rows.inverseMass, h = leading.h;
    if (!(rows.features & AxisRows::kSpring) || !(w > 0)) return 0;
    const TunedSpring spring = rows.spring.tuning.at(w);
    const float load = leading.ends ? (speed - rows.springStart + kick) / w - rows.springImpulse : kick / w;
    const auto error = static_cast<float>(coordinate - static_cast<double>(rows.spring.target));
    const float whole = h * (rows.spring.feedForward - spring.stiffness * error);
    const float push = clamped(whole, h * rows.spring.most);
    const float steady = leading.ends ? steadyOf(load, rows.springLoad, push) : load;
    rows.springLoad = load;
    return leadShare(spring.stiffness, spring.damping, w, h) * w * (push + steady);
}

PairVector leadAxis(Leading& leading) {
    JointSim& joint = leading.joint;
    RigidBlock& block = joint.block;
    const Vec3 line = block.basis.cz;
    const bool turns = joint.kind == JointKind::hinge;
    const auto along = [&](const PairVector& u) { return dot(line, turns ? u.angular : u.linear); };
    const double coordinate = joint.kind == JointKind::hinge    ? unwrapped(joint.axis, joint.axis.angle.last)
                              : joint.kind == JointKind::slider ? static_cast<double>(block.errorSecond.z)
                                                                : static_cast<double>(length(block.errorFirst));
    const float speed = along(leading.pair.velocity(joint.arms));
    const float lead = leadOf(joint.axis, coordinate, speed, along(leading.kick()), leading);
    if (!(joint.axis.inverseMass > 0)) return {};
    const float amount = lead / joint.axis.inverseMass;
    if (joint.kind == JointKind::distance) return {amount * line, {}};
    const Vec3 first = block.impulseFirst, second = block.impulseSecond;
    const PairVector impulse = freeImpulse(block, amount);
    block.impulseFirst = first;
    block.impulseSecond = second;
    return impulse;
}

/// What one coordinate leads by moves the others: in turn, until each has its own.
PairVector leadAxes(Leading& leading) {
    constexpr int kIterations = 4;  // by trial
    JointSim& joint = leading.joint;
    AxesBlock axes = withAxes(joint).axes;
    BodyPair pair = leading.pair;
    float wanted[AxesBlock::kMostFree] = {};
    const PairVector before = pair.velocity(joint.arms), kick = leading.kick();
    for (std::uint32_t f = 0; f < axes.freeRows; ++f) {
        const float speed = speedAlong(axes.free[f], before);
        wanted[f] = speed + leadOf(axes.axis[f], coordinateOf(axes, f), speed, speedAlong(axes.free[f], kick), leading);
    }
    PairVector total;
    for (int iteration = 0; iteration < kIterations; ++iteration)
        for (std::uint32_t f = 0; f < axes.freeRows; ++f) {
            const AxisRows& rows = axes.axis[f];
            if (!(rows.features & AxisRows::kSpring) || !(rows.inverseMass > 0)) continue;
            const float missing = wanted[f] - speedAlong(axes.free[f], pair.velocity(joint.arms));
            const PairVector impulse = freeImpulse(axes, f, missing / rows.inverseMass);
            pair.apply(joint.arms, impulse);
            total.linear += impulse.linear;
            total.angular += impulse.angular;
        }
    return total;
}

Vec3 lengthClamped(const Vec3& a, float most) {
    const float size = length(a);
    return size > most ? (most / size) * a : a;
}

PairVector leadBall(Leading& leading) {
    JointSim& joint = leading.joint;
    BallRows& rows = joint.ball;
    const RigidBlock& block = joint.block;
    const float w = easiest(block), h = leading.h;
    if (!(w > 0)) return {};
    const JointPlace place = locate(joint, leading.pair);
    const Vec3 kick = leading.kick().angular, spin = leading.pair.velocity(joint.arms).angular;
    const Vec3 load = leading.ends ? solve(block.second, spin - rows.springStart + kick) - rows.springImpulse
                                   : solve(block.second, kick);
    const Vec3 before = rows.springLoad;
    rows.springLoad = load;
    Vec3 torque;
    if (rows.features & BallRows::kSpring) {
        const TunedSpring spring = rows.spring.tuning.at(w);
        const Vec3 whole = -(h * spring.stiffness) * turnVector(place.b * conjugate(place.a * rows.target));
        const Vec3 push = lengthClamped(whole, h * rows.spring.most);
        const Vec3 steady = leading.ends ? steadyOf(load, before, push) : load;
        torque = leadShare(spring.stiffness, spring.damping, w, h) * (push + steady);
    } else {
        torque = leadDrives(joint, place, w, h, leading.ends ? steadyOf(load, before, {}) : load);
    }
    return {-(block.mass.gain * torque), torque};
}

PairVector leadNow(Leading& leading) {
    switch (leading.joint.kind) {
        case JointKind::none:
        case JointKind::fixed:
            return {};
        case JointKind::ball:
            return leadBall(leading);
        case JointKind::hinge:
        case JointKind::slider:
        case JointKind::distance:
            return leadAxis(leading);
        default:
            return leadAxes(leading);
    }
}

/// What is left of the kicks once rigid rows have taken what they do not allow.
BodyKicks fittedKicks(JointSim& joint, const BodyState* states, const BodyInertia* inertia, const BodyKicks& kicks) {
    BodyState pushed[2] = {states[joint.stateA], states[joint.stateB]};
    const BodyInertia both[2] = {inertia[joint.stateA], inertia[joint.stateB]};
    pushed[0].v = kicks.vA, pushed[0].w = kicks.wA, pushed[1].v = kicks.vB, pushed[1].w = kicks.wB;
    fitted(joint, BodyPair(pushed, both, 0, 1)).store();
    return {pushed[0].v, pushed[0].w, pushed[1].v, pushed[1].w};
}

}  // namespace

float leadShare(float stiffness, float damping, float inverseMass, float h) {
    const double w = inverseMass, step = h;
    const double z = step * step * static_cast<double>(stiffness) * w, x = step * static_cast<double>(damping) * w;
    // What exceeds a radian per substep is implicit, and rests on the place where it ends.
    return static_cast<float>(z <= 1 ? exactShare(z, x) : exactShare(1, x / std::sqrt(z)) / z);
}

bool hasSprings(const JointSim& joint) {
    if (joint.kind == JointKind::ball) return (joint.ball.features & (BallRows::kSpring | BallRows::kDrives)) != 0;
    if (!hasAxes(joint.kind)) return (joint.axis.features & AxisRows::kSpring) != 0;
    for (std::uint32_t f = 0; f < withAxes(joint).axes.freeRows; ++f)
        if (withAxes(joint).axes.axis[f].features & AxisRows::kSpring) return true;
    return false;
}

bool leads(const JointSim& joint) { return hasSprings(joint) || hasSoftStops(joint); }

void beginLead(JointSim& joint, BodyState* states, const BodyInertia* inertia, const BodyKicks& kicks, float h) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB);
    if (joint.leads == 0) {
        joint.lead = {};
        if (!hasSprings(joint)) return;
        refreshJoint(joint, pair, {{}, false});
        const BodyKicks left = fittedKicks(joint, states, inertia, kicks);
        Leading leading{joint, pair, left, h, false};
        joint.lead = leadNow(leading);
    }
    pair.apply(joint.arms, {-joint.lead.linear, -joint.lead.angular});
    pair.store();
}

void endLead(JointSim& joint, BodyState* states, const BodyInertia* inertia, const BodyKicks& kicks, float h) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB);
    refreshJoint(joint, pair, {{}, false});
    joint.lead = {};
    Leading leading{joint, pair, kicks, h, true};
    if (hasSprings(joint)) joint.lead = leadNow(leading);
    if (hasSoftStops(joint)) {
        const PairVector stops = leadStops(joint, pair, leading.kick(), h);
        joint.lead.linear += stops.linear;
        joint.lead.angular += stops.angular;
    }
    joint.leads = 1;
    pair.apply(joint.arms, joint.lead);
    pair.store();
}

}  // namespace ragtop
