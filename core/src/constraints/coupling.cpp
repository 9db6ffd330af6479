#include "constraints/coupling.h"

#include <limits>

#include "constraints/joint_types.h"

namespace ragtop {
namespace {

/// Where a coordinate of a joint is kept.
AxisRows& axisOf(JointSim& joint, std::uint32_t coordinate) {
    return hasAxes(joint.kind) ? withAxes(joint).axes.axis[coordinate] : joint.axis;
}

/// What the coordinate takes of the joint's relative motion.
PairVector rowOf(const JointSim& joint, std::uint32_t coordinate) {
    if (hasAxes(joint.kind)) return withAxes(joint).axes.free[coordinate];
    const Vec3& axis = joint.block.basis.cz;
    return joint.kind == JointKind::hinge ? PairVector{{}, axis} : PairVector{axis, {}};
}

double valueOf(const JointSim& joint, std::uint32_t coordinate) {
    const AxisRows& axis = axisOf(const_cast<JointSim&>(joint), coordinate);
    if (axis.angle.tracked) return unwrapped(axis, axis.angle.last);
    if (hasAxes(joint.kind)) return coordinateOf(withAxes(joint).axes, coordinate);
    return static_cast<double>(joint.kind == JointKind::slider ? joint.block.errorSecond.z
                                                               : length(joint.block.errorFirst));
}

/// The impulse along the coordinate together with what keeps the rigid rows' velocity, which the block notes.
PairVector push(JointSim& joint, std::uint32_t coordinate, float amount) {
    if (hasAxes(joint.kind)) return freeImpulse(withAxes(joint).axes, coordinate, amount);
    if (joint.kind == JointKind::distance) return {amount * joint.block.basis.cz, {}};
    return freeImpulse(joint.block, amount);
}

/// Bodies that have no velocity yet, to see what an impulse does to them.
class Trial {
public:
    Trial(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states, const BodyInertia* inertia) {
        for (std::uint32_t i = 0; i < coupling.count; ++i) {
            const JointSim& joint = *joints[coupling.joints[i]];
            a_[i] = placeOf(joint.stateA, states, inertia);
            b_[i] = placeOf(joint.stateB, states, inertia);
        }
    }
    BodyPair pair(std::uint32_t i) { return {states_, inertia_, a_[i], b_[i]}; }

private:
    std::uint32_t placeOf(std::uint32_t index, const BodyState* states, const BodyInertia* inertia) {
        for (std::uint32_t k = 0; k < used_; ++k)
            if (index_[k] == index) return k;
        states_[used_] = states[index];
        states_[used_].v = states_[used_].w = {};
        inertia_[used_] = inertia[index];
        index_[used_] = index;
        return used_++;
    }

    static constexpr int kMost = 2 * CouplingSim::kMost;  ///< two bodies for each joint
    std::uint32_t used_ = 0, a_[CouplingSim::kMost] = {}, b_[CouplingSim::kMost] = {}, index_[kMost] = {};
    BodyState states_[kMost];
    BodyInertia inertia_[kMost];
};

/// Speed of the sum per impulse along it. Blocks note what they are given, so copies of them are pushed.
float inverseMassOf(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
                    const BodyInertia* inertia) {
    Trial trial(coupling, joints, states, inertia);
    for (std::uint32_t i = 0; i < coupling.count; ++i) {
        AxesJointSim joint = copyOf(*joints[coupling.joints[i]]);
        BodyPair pair = trial.pair(i);
        pair.apply(joint.arms, push(joint, coupling.coordinates[i], coupling.ratios[i]));
        pair.store();
    }
    float speed = 0;
    for (std::uint32_t i = 0; i < coupling.count; ++i) {
        const JointSim& joint = *joints[coupling.joints[i]];
        const PairVector u = trial.pair(i).velocity(joint.arms);
        speed += coupling.ratios[i] * speedAlong(rowOf(joint, coupling.coordinates[i]), u);
    }
    return speed;
}

double sumOf(const CouplingSim& coupling, JointSim* const* joints) {
    double sum = 0;
    for (std::uint32_t i = 0; i < coupling.count; ++i)
        sum += static_cast<double>(coupling.ratios[i]) * valueOf(*joints[coupling.joints[i]], coupling.coordinates[i]);
    return sum;
}

/// Σ ratio · what(joint, coordinate, its bodies)
template <class What>
float sumOverParts(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
                   const BodyInertia* inertia, What&& what) {
    float sum = 0;
    for (std::uint32_t i = 0; i < coupling.count; ++i) {
        const JointSim& joint = *joints[coupling.joints[i]];
        // Nothing is written without BodyPair::store.
        const BodyPair pair(const_cast<BodyState*>(states), inertia, joint.stateA, joint.stateB);
        sum += coupling.ratios[i] * what(joint, coupling.coordinates[i], pair);
    }
    return sum;
}

float speedOf(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
              const BodyInertia* inertia) {
    return sumOverParts(coupling, joints, states, inertia,
                        [](const JointSim& joint, std::uint32_t coordinate, const BodyPair& pair) {
                            return speedAlong(rowOf(joint, coordinate), pair.velocity(joint.arms));
                        });
}

float bendOf(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states, const BodyInertia* inertia,
             float h) {
    return sumOverParts(coupling, joints, states, inertia,
                        [&](const JointSim& joint, std::uint32_t coordinate, const BodyPair& pair) {
                            return bendOf(joint, coordinate, pair, h);
                        });
}

void pushAll(const CouplingSim& coupling, JointSim* const* joints, BodyState* states, const BodyInertia* inertia,
             float amount) {
    if (amount == 0) return;
    for (std::uint32_t i = 0; i < coupling.count; ++i) {
        JointSim& joint = *joints[coupling.joints[i]];
        const float share = coupling.ratios[i] * amount;
        axisOf(joint, coupling.coordinates[i]).coupledImpulse += share;
        BodyPair pair(states, inertia, joint.stateA, joint.stateB);
        pair.apply(joint.arms, push(joint, coupling.coordinates[i], share));
        pair.store();
    }
}

}  // namespace

bool hasCoordinate(JointKind kind, int coordinate) {
    switch (kind) {
        case JointKind::hinge:
        case JointKind::slider:
        case JointKind::distance:
        case JointKind::screw:
        case JointKind::path:
            return coordinate == 0;
        case JointKind::cylindrical:
        case JointKind::universal:
            return coordinate < 2;
        case JointKind::plane:
            return coordinate < 3;
        case JointKind::sixDof:
            return coordinate < 6;
        default:
            return false;
    }
}

bool coordinateTurns(JointKind kind, int coordinate) {
    switch (kind) {
        case JointKind::hinge:
        case JointKind::screw:
        case JointKind::universal:
            return true;
        case JointKind::cylindrical:
        case JointKind::plane:
            return coordinate == 0;
        case JointKind::sixDof:
            return coordinate < 3;
        default:
            return false;
    }
}

void compileCoupling(const CouplingDef& def, JointSim* const* joints, CouplingSim& into) {
    into.count = static_cast<std::uint32_t>(def.count);
    for (std::uint32_t i = 0; i < into.count; ++i) {
        into.joints[i] = def.parts[i].joint.index;
        into.coordinates[i] = static_cast<std::uint32_t>(def.parts[i].coordinate);
        into.ratios[i] = def.parts[i].ratio;
    }
    const AxisDef& sum = def.sum;
    const bool turns = coordinateTurns(joints[into.joints[0]]->kind, def.parts[0].coordinate);
    compile(into.axis, {sum.limit, sum.stop, sum.motor, sum.spring, sum.target, sum.friction, sum.bearing, turns});
}

void markCoupled(const CouplingSim& coupling, JointSim* const* joints) {
    for (std::uint32_t i = 0; i < coupling.count; ++i)
        axisOf(*joints[coupling.joints[i]], coupling.coordinates[i]).features |= AxisRows::kCoupled;
}

void clearCoupled(JointSim& joint, bool coupled) {
    const auto clear = [&](AxisRows& axis) {
        axis.coupledImpulse = 0;
        if (!coupled) axis.features &= ~AxisRows::kCoupled;
    };
    clear(joint.axis);
    if (!hasAxes(joint.kind)) return;
    for (AxisRows& axis : withAxes(joint).axes.axis) clear(axis);
}

void warmStartCoupling(const CouplingSim& coupling, JointSim* const* joints) {
    const float carried = axisImpulse(coupling.axis);
    for (std::uint32_t i = 0; i < coupling.count; ++i) {
        AxisRows& axis = axisOf(*joints[coupling.joints[i]], coupling.coordinates[i]);
        axis.coupledImpulse += coupling.ratios[i] * carried;
    }
}

void beginCoupling(CouplingSim& coupling, JointSim* const* joints, BodyState* states, const BodyInertia* inertia,
                   const JointContext& context) {
    AxisRows& axis = coupling.axis;
    axis.inverseMass = inverseMassOf(coupling, joints, states, inertia);
    const double sum = sumOf(coupling, joints);
    setMargins(axis, sum);
    // What is carried over has acted with the joints already.
    const float carried = axisImpulse(axis);
    const float speed = speedOf(coupling, joints, states, inertia) - axis.inverseMass * carried;
    beginAxis(axis, sum, speed, 0, context);
    pushAll(coupling, joints, states, inertia, axisImpulse(axis) - carried);
}

void refreshCoupling(CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
                     const BodyInertia* inertia) {
    coupling.axis.inverseMass = inverseMassOf(coupling, joints, states, inertia);
    setMargins(coupling.axis, sumOf(coupling, joints));
}

void solveCoupling(CouplingSim& coupling, JointSim* const* joints, BodyState* states, const BodyInertia* inertia,
                   const JointContext& context, bool moving) {
    const float speed = speedOf(coupling, joints, states, inertia);
    const float bend =
        moving && coupling.axis.keepsRange() ? bendOf(coupling, joints, states, inertia, context.h) : 0.0f;
    pushAll(coupling, joints, states, inertia, solveAxis(coupling.axis, speed, context, moving, bend));
}

CouplingState couplingState(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
                            const BodyInertia* inertia, float inverseSubstep) {
    CouplingSim now = coupling;
    for (std::uint32_t i = 0; i < now.count; ++i) now.joints[i] = i;
    CouplingState state;
    state.sum = sumOf(now, joints);
    state.speed = static_cast<double>(speedOf(now, joints, states, inertia));
    state.force = inverseSubstep * axisImpulse(now.axis);
    state.limitMargin = std::numeric_limits<float>::infinity();
    if (!(now.axis.features & (AxisRows::kLimit | AxisRows::kLocked))) return state;
    setMargins(now.axis, state.sum);
    const float lower = now.axis.atLower.margin, upper = now.axis.atUpper.margin;
    state.limitMargin = lower < upper ? lower : upper;
    return state;
}

namespace {

CouplingDef pairOf(JointId a, float ratioA, JointId b, float ratioB, const Range& limit) {
    CouplingDef def;
    def.count = 2;
    def.parts[0] = {a, 0, ratioA};
    def.parts[1] = {b, 0, ratioB};
    def.sum.limit = limit;
    return def;
}

}  // namespace

CouplingDef gear(JointId driver, JointId driven, float ratio) { return pairOf(driven, 1, driver, -ratio, {}); }

CouplingDef rackAndPinion(JointId pinion, JointId rack, float radius) { return pairOf(rack, 1, pinion, -radius, {}); }

CouplingDef pulley(JointId a, JointId b, float length, float ratio) { return pairOf(a, 1, b, ratio, {0, length}); }

}  // namespace ragtop
