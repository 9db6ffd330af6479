#include "constraints/rows.h"

namespace ragtop {

void compile(AxisRows& rows, const std::optional<Range>& limit, const std::optional<Motor>& motor,
             const std::optional<Spring>& spring, float target, float friction) {
    const AxisRows old = rows;
    rows = {};
    if (limit) {
        rows.features |= limit->lower == limit->upper ? AxisRows::kLocked : AxisRows::kLimit;
        rows.lower = limit->lower;
        rows.upper = limit->upper;
        if ((old.features & (AxisRows::kLimit | AxisRows::kLocked)) ==
            (rows.features & (AxisRows::kLimit | AxisRows::kLocked))) {
            rows.lowerImpulse = old.lowerImpulse;
            rows.upperImpulse = old.upperImpulse;
        }
    }
    if (motor) {
        rows.features |= AxisRows::kMotor;
        rows.targetSpeed = motor->targetSpeed;
        rows.maxForce = motor->maxForce;
        rows.motorImpulse = old.motorImpulse;
    }
    if (spring) {
        rows.features |= AxisRows::kSpring;
        rows.stiffness = spring->stiffness;
        rows.damping = spring->damping;
        rows.target = target;
        rows.springImpulse = old.springImpulse;
    }
    if (friction > 0) {
        rows.features |= AxisRows::kFriction;
        rows.friction = friction;
        rows.frictionImpulse = old.frictionImpulse;
    }
}

float axisImpulse(const AxisRows& rows) {
    return rows.springImpulse + rows.frictionImpulse + rows.motorImpulse + rows.lowerImpulse - rows.upperImpulse;
}

void rescale(AxisRows& rows, float ratio) {
    rows.springImpulse *= ratio;
    rows.frictionImpulse *= ratio;
    rows.motorImpulse *= ratio;
    rows.lowerImpulse *= ratio;
    rows.upperImpulse *= ratio;
}

SpringRow makeSpring(float stiffness, float damping, float h) {
    const float total = damping + h * stiffness;
    if (!(h * total > 0)) return {};
    return {1 / (h * total), stiffness / total, true};
}

float solveLimit(float& impulse, float margin, float speed, float inverseMass, const JointContext& context,
                 bool useBias) {
    Softness soft = kRigid;
    float bias = 0;
    if (margin > 0) {
        bias = margin * context.inverseH;
    } else if (useBias) {
        soft = context.softness;
        bias = soft.biasRate * margin;
    }
    const float old = impulse;
    const float solved = old - soft.massScale * (speed + bias) / inverseMass - soft.impulseScale * old;
    impulse = solved > 0 ? solved : 0.0f;
    return impulse - old;
}

namespace {

constexpr float clamp(float value, float lower, float upper) {
    return value < lower ? lower : value > upper ? upper : value;
}

float solveBounded(float& impulse, float speed, float inverseMass, float bound) {
    const float old = impulse;
    impulse = clamp(old - speed / inverseMass, -bound, bound);
    return impulse - old;
}

float solveLocked(AxisRows& rows, float speed, float inverseMass, const JointContext& context, bool useBias) {
    const Softness soft = useBias ? context.softness : kRigid;
    const float delta = -soft.massScale * (speed + soft.biasRate * rows.lowerMargin) / inverseMass -
                        soft.impulseScale * rows.lowerImpulse;
    rows.lowerImpulse += delta;
    return delta;
}

}  // namespace

float solveAxis(AxisRows& rows, float speed, float inverseMass, const JointContext& context, bool useBias) {
    if (!(inverseMass > 0) || rows.features == 0) return 0;
    float total = 0;
    const auto add = [&](float delta) {
        total += delta;
        speed += inverseMass * delta;
    };
    if (rows.features & AxisRows::kSpring) {
        const SpringRow spring = makeSpring(rows.stiffness, rows.damping, context.h);
        if (spring.active) {
            const float delta = -(speed + spring.beta * rows.springError + spring.gamma * rows.springImpulse) /
                                (inverseMass + spring.gamma);
            rows.springImpulse += delta;
            add(delta);
        }
    }
    if (rows.features & AxisRows::kFriction) {
        add(solveBounded(rows.frictionImpulse, speed, inverseMass, rows.friction * context.h));
    }
    if (rows.features & AxisRows::kMotor) {
        add(solveBounded(rows.motorImpulse, speed - rows.targetSpeed, inverseMass, rows.maxForce * context.h));
    }
    if (rows.features & AxisRows::kLocked) add(solveLocked(rows, speed, inverseMass, context, useBias));
    if (rows.features & AxisRows::kLimit) {
        add(solveLimit(rows.lowerImpulse, rows.lowerMargin, speed, inverseMass, context, useBias));
        add(-solveLimit(rows.upperImpulse, rows.upperMargin, -speed, inverseMass, context, useBias));
    }
    return total;
}

float wrapAbout(float angle, float center) {
    const float x = angle - center;
    if (x > kPi) return angle - 2 * kPi;
    if (x <= -kPi) return angle + 2 * kPi;
    return angle;
}

}  // namespace ragtop
