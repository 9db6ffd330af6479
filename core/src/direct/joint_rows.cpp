#include "direct/joint_rows.h"

#include <limits>
#include <utility>

#include "constraints/joint_types.h"
#include "constraints/spring_drags.h"
#include "direct/rotation.h"
#include "direct/taut_stiffness.h"

namespace ragtop::direct {

namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();
constexpr float kFarAway = 1e9f;  ///< rad: no stop is there
constexpr DVec3 kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< of the world

/// Both bodies of a joint, now or a part of a substep ahead.
struct Ends {
    BodyState states[3];
    BodyInertia inertias[3];

    Ends(const BodyArrays& arrays, const JointSim& joint) {
        states[1] = arrays.states[joint.stateA], states[2] = arrays.states[joint.stateB];
        inertias[1] = arrays.inertia[joint.stateA], inertias[2] = arrays.inertia[joint.stateB];
    }
    void advance(float time) {
        for (BodyState* s : {&states[1], &states[2]}) {
            s->dp += time * s->v;
            s->dq = toFloat(turnBy(static_cast<double>(time) * DVec3(s->w)) * direct::toDouble(s->dq));
        }
    }
    BodyPair pair() { return {states, inertias, 1, 2}; }
};

double admittance(const SystemBody& body, const DVec3& linear, const DVec3& angular) {
    const double* w = body.inverseMass;
    return w[0] * linear.x * linear.x + w[1] * linear.y * linear.y + w[2] * linear.z * linear.z +
           dot(angular, body.inverseInertia * angular);
}
/// The inverse mass of a row, or 1 where nothing moves. Locked movements have none.
double admittance(const SystemRow& row, const SystemPair& pair, const SystemBody* bodies) {
    double k = 0;
    const auto add = [&](std::int32_t body, const DVec3& arm) {
        if (body == kFixed) return;
        k += row.shape == RowShape::turning ? dot(row.turn, bodies[body].inverseInertia * row.turn)
                                            : admittance(bodies[body], row.linear, cross(arm, row.linear) + row.turn);
    };
    add(pair.a, pair.armA);
    add(pair.b, pair.armB);
    return k > 0 ? k : 1;
}
/// What a body does at an arm, without what it is locked in.
Twist motionAt(const BodyState& state, std::uint32_t locks, const DVec3& arm) {
    const Twist of = unlocked(locks, {toDouble(state.v), toDouble(state.w)});
    return {of.linear + cross(of.turn, arm), of.turn};
}

/// λ = push − h c (u − speed) within ± most, with u the mean speed of the substep.
struct SpringRow {
    float push = 0, speed = 0, most = kNoForceLimit;  ///< N s, of the error and what is fed forward; m/s; N s
};

/// The directions of a joint's rows and what they share.
class RowWriter {
public:
    RowWriter(const JointRowBuilder& builder, const JointSim& joint, std::uint32_t index, const SystemPair& pair)
        : builder_(builder), index_(index), pair_(pair) {
        const auto add = [&](std::int32_t body, std::uint32_t state, double sign, const DVec3& arm) {
            const std::uint32_t locks = body == kFixed ? 0 : builder.bodies[body].locks;
            const Twist u = motionAt(builder.arrays.states[state], locks, arm);
            Twist& sum = body == kFixed ? driven_ : free_;
            sum = {sum.linear + sign * u.linear, sum.turn + sign * u.turn};
        };
        add(pair.a, joint.stateA, -1, pair.armA);
        add(pair.b, joint.stateB, 1, pair.armB);
    }

    SystemRow along(const PairVector& d) const { return row(toDouble(d.linear), toDouble(d.angular)); }
    SystemRow linear(const DVec3& d) const { return row(d, {}); }
    SystemRow angular(const DVec3& d) const { return row({}, d, RowShape::turning); }
    /// Along an axis of the world.
    SystemRow linear(int axis) const {
        constexpr RowShape kShapes[] = {RowShape::alongX, RowShape::alongY, RowShape::alongZ};
        return row(kAxes[axis], {}, kShapes[axis]);
    }

    void push(SystemRow& row, RowKind kind, double load, double target, const RestingAim& resting) const {
        row.kind = kind;
        row.load = load;
        row.target = target;
        row.resting = resting;
        builder_.rows.push(row);
    }
    /// `ahead` is the error where free motion leads.
    void rigid(SystemRow&& row, RowKind kind, double load, double error, double ahead) const {
        row.lower = -kNoBound, row.upper = kNoBound;
        row.resistance = resistanceOf(row);
        if (builder_.aims == RowAims::closing) return push(row, kind, 0, -error * inverseH(), {});
        if (builder_.aims == RowAims::resting) return push(row, kind, 0, -alongRow(row, driven_), {});
        const double still = curving(row, error, ahead);
        const double bias = -static_cast<double>(builder_.context.softness.biasRate) * error;
        push(row, kind, load, still + bias, {still, row.resistance, -kNoBound, kNoBound});
    }
    /// A row as the iteration has it; `bend` is the speed along it at which its coordinate does not change.
    void scalar(SystemRow&& row, RowKind kind, double load, const RowAim& moving, const RowAim& resting,
                double inverseMass, double bend) const {
        if (builder_.aims == RowAims::closing && moving.drag > 0) return hold(row, kind, moving.drag);
        if (builder_.aims != RowAims::substep) return;
        row.lower = moving.lower, row.upper = moving.upper;
        RestingAim rest{bend + resting.target, 0, resting.lower, resting.upper};
        row.compliant = moving.drag >= 0;
        if (!row.compliant) {
            row.resistance = rest.resistance = resistanceOf(row);
            return push(row, kind, load, bend + moving.target, rest);
        }
        row.resistance = resistanceOf(moving.drag, inverseMass);
        rest.resistance = resistanceOf(resting.drag, inverseMass);
        // What the second pass pushes with beyond the first, as a speed.
        rest.target = static_cast<double>(resting.push - moving.push) * rest.resistance;
        push(row, kind, moving.push, 0, rest);
    }
    SpringDrags dragsOf(const TunedSpring& spring, float inverseMass) const {
        const auto drags = builder_.touches || builder_.aims != RowAims::substep ? separateDrags : springDrags;
        return drags(spring.stiffness, spring.damping, inverseMass, builder_.context.h);
    }
    /// λ₁ = push − moving (u₁ − speed),  λ₂ = push + follows (λ₁ − push) − resting (u₂ − speed): what λ₁ is the second
    /// pass adds (IslandSystem::aimAtVelocities).
    void spring(SystemRow&& row, RowKind kind, const SpringRow& spring, const SpringDrags& drags,
                float inverseMass) const {
        const auto [first, second, follows] = drags;
        if (builder_.aims == RowAims::closing && first > 0) return hold(row, kind, first);
        if (builder_.aims != RowAims::substep) return;
        const double given = spring.push, speed = spring.speed, most = spring.most, pushed = given + first * speed;
        RestingAim rest{0, resistanceOf(second, inverseMass), -most, most, follows, inverseMass};
        rest.target = ((1 - follows) * given + second * speed - pushed) * rest.resistance;
        row.lower = -most, row.upper = most;
        row.compliant = true;
        row.resistance = resistanceOf(first, inverseMass);
        push(row, kind, pushed, 0, rest);
    }
    /// Springs and soft stops make ways that stretch them long ones.
    void hold(SystemRow& row, RowKind kind, double drag) const {
        row.resistance = 1 / drag;
        row.compliant = true;
        row.lower = -kNoBound, row.upper = kNoBound;
        push(row, kind, 0, 0, {});
    }
    /// The way that brings what is beyond a stop back to it, or that may be used up until it is met. A joint that was
    /// made beyond its stop comes back by itself.
    void close(SystemRow& row, RowKind kind, const StopSide& side) const {
        row.lower = 0, row.upper = kNoBound;
        row.resistance = resistanceOf(row);
        const bool held = side.recovery == 0 && side.margin < 0;
        push(row, kind, 0, held ? 0.0 : -static_cast<double>(side.margin) * inverseH(), {});
    }
    RowAims aims() const { return builder_.aims; }
    double inverseH() const { return builder_.context.inverseH; }
    /// The speed along the row at which an error would not change: what free motion has, less the change it makes.
    double curving(const SystemRow& row, double error, double ahead) const {
        return alongRow(row, free_) - (ahead - error) * static_cast<double>(builder_.context.inverseH);
    }
    const JointContext& context() const { return builder_.context; }
    /// The stiffness of tension T across a line of length L: a spring h γ T/L about the free motion.
    void across(const DVec3& d, double weight) const {
        if (builder_.aims != RowAims::substep) return;
        SystemRow r = linear(d);
        r.resistance = 1 / weight;
        r.compliant = true;
        r.lower = -kNoBound, r.upper = kNoBound;
        const double speed = alongRow(r, free_);
        push(r, RowKind::across, 0, speed, {speed, r.resistance, -kNoBound, kNoBound});
    }

private:
    static double resistanceOf(double drag, double inverseMass) {
        const double least = kNoDrag / inverseMass;
        return 1 / (drag > least ? drag : least);
    }
    SystemRow row(const DVec3& linear, const DVec3& turn, RowShape shape = RowShape::whole) const {
        SystemRow r;
        r.joint = index_;
        r.shape = shape;
        r.linear = linear, r.turn = turn;
        return r;
    }
    double resistanceOf(const SystemRow& row) const {
        return tuning::kRowResistance * admittance(row, pair_, builder_.bodies);
    }

    const JointRowBuilder& builder_;
    std::uint32_t index_;
    const SystemPair& pair_;
    Twist free_, driven_;  ///< of B beside A, of bodies that impulses move and of those that they do not
};

const Vec3& columnOf(const Mat3& m, int k) { return k == 0 ? m.cx : k == 1 ? m.cy : m.cz; }

RowKind after(RowKind kind, int k) { return static_cast<RowKind>(static_cast<int>(kind) + k); }

/// What a joint's rows have where free motion leads: errors of rigid rows, margins of stops.
struct Ahead {
    struct Range {
        float lower = 0, upper = 0;
    };
    Vec3 errorFirst, errorSecond;
    float error[AxesBlock::kMostRigid] = {};
    Range axis[AxesBlock::kMostFree], twist;  ///< without an AxesBlock there is the first axis
    float swing[SwingLimit::kSides] = {};

    explicit Ahead(const JointSim& joint) {
        const auto rangeOf = [](const auto& lower, const auto& upper) { return Range{lower.margin, upper.margin}; };
        if (hasAxes(joint.kind)) {
            const AxesBlock& axes = withAxes(joint).axes;
            for (std::uint32_t i = 0; i < axes.rigidRows; ++i) error[i] = axes.error[i];
            for (std::uint32_t f = 0; f < axes.freeRows; ++f)
                axis[f] = rangeOf(axes.axis[f].atLower, axes.axis[f].atUpper);
            return;
        }
        errorFirst = joint.block.errorFirst, errorSecond = joint.block.errorSecond;
        axis[0] = rangeOf(joint.axis.atLower, joint.axis.atUpper);
        twist = rangeOf(joint.ball.twistLower, joint.ball.twistUpper);
        for (int i = 0; i < SwingLimit::kSides; ++i) swing[i] = joint.ball.swing[i].margin;
    }
};

/// The rigid rows: three of the first half, then those of the second, in the order of the block's basis.
void addBlock(const RowWriter& writer, const RigidBlock& block, const Ahead& ahead) {
    const bool linear = block.linearFirst != 0;
    for (int k = 0; k < 3; ++k)
        writer.rigid(linear ? writer.linear(k) : writer.angular(kAxes[k]), after(RowKind::first, k),
                     block.impulseFirst[k], block.errorFirst[k], ahead.errorFirst[k]);
    const Vec3 columns[3] = {block.basis.cx, block.basis.cy, block.basis.cz};
    for (int k = 0; k < static_cast<int>(block.rigidRows); ++k) {
        const DVec3 d = toDouble(columns[k]);
        writer.rigid(linear ? writer.angular(d) : writer.linear(d), after(RowKind::second, k),
                     dot(block.impulseSecond, columns[k]), block.errorSecond[k], ahead.errorSecond[k]);
    }
}

void turnRound(SystemRow& row) {
    row.linear = -1.0 * row.linear;
    row.turn = -1.0 * row.turn;
}

/// All at once, a stop does not know yet whether it will be met: a margin that may be used up may be so in both passes.
RowAim restingAim(const StopSide& side, const Stop& stop, float inverseMass, const JointContext& context) {
    const bool within = side.margin > 0 && !(side.rebound > 0) && !(stop.stiffness > 0);
    return aimAtStop(side, stop, inverseMass, context, within);
}

TunedSpring tunedOf(const AxisRows& axis, AxisSlot slot) {
    return slot == AxisSlot::viscous ? TunedSpring{0, axis.resistance.viscous}
                                     : axis.spring.tuning.at(axis.inverseMass);
}
SpringRow springOf(const AxisRows& axis, AxisSlot slot, float h) {
    if (slot == AxisSlot::viscous) return {};
    return {h * (axis.spring.feedForward - axis.springStiffness * axis.springError), axis.spring.speed,
            h * axis.spring.most};
}

/// The rows along a coordinate.
void addAxis(const RowWriter& writer, const SystemRow& row, const AxisRows& axis, const Ahead::Range& ahead,
             RowKind first = RowKind::axis) {
    const double w = axis.inverseMass;
    if (!(w > 0)) return;
    for (int i = 0; i < kAxisSlots; ++i) {
        const auto slot = static_cast<AxisSlot>(i);
        if (!axis.has(slot)) continue;
        const bool upper = slot == AxisSlot::upper, stops = upper || slot == AxisSlot::lower;
        SystemRow along = row;
        if (upper) turnRound(along);
        const StopSide& now = upper ? axis.atUpper : axis.atLower;
        const double bend = stops ? writer.curving(along, now.margin, upper ? ahead.upper : ahead.lower) : 0.0;
        const bool stop = stops && (axis.features & AxisRows::kLimit) != 0;
        if (writer.aims() == RowAims::closing) {
            if (stop && !(axis.stop.stiffness > 0)) writer.close(along, after(first, i), now);
            if (slot != AxisSlot::spring && !(stop && axis.stop.stiffness > 0)) continue;
        }
        if (slot == AxisSlot::spring || slot == AxisSlot::viscous) {
            writer.spring(std::move(along), after(first, i), springOf(axis, slot, writer.context().h),
                          writer.dragsOf(tunedOf(axis, slot), axis.inverseMass), axis.inverseMass);
            continue;
        }
        writer.scalar(std::move(along), after(first, i), axis.impulse(slot), aimOf(axis, slot, writer.context(), true),
                      stop ? restingAim(now, axis.stop, axis.inverseMass, writer.context())
                           : aimOf(axis, slot, writer.context(), false),
                      w, bend);
    }
}

void addAxes(const RowWriter& writer, const AxesBlock& block, const Ahead& ahead) {
    for (std::uint32_t i = 0; i < block.rigidRows; ++i)
        writer.rigid(writer.along(block.rigid[i]), after(RowKind::rigid, static_cast<int>(i)), block.impulse[i],
                     block.error[i], ahead.error[i]);
    if (writer.aims() == RowAims::resting) return;
    for (std::uint32_t f = 0; f < block.freeRows; ++f)
        addAxis(writer, writer.along(block.free[f]), block.axis[f], ahead.axis[f],
                after(RowKind::axes, static_cast<int>(f) * kAxisSlots));
}

/// A stop of the rotation; the margins of rows without a direction mean nothing.
void addTurnStop(const RowWriter& writer, RowKind kind, const Vec3& axis, const StopSide& side, float ahead,
                 const JointSim& joint) {
    const float w = dot(axis, joint.block.mass.rest * axis);
    if (!(w > joint.block.noise)) return;
    SystemRow row = writer.angular(toDouble(axis));
    const bool isThere = ahead < kFarAway && side.margin < kFarAway;
    const double bend = isThere ? writer.curving(row, side.margin, ahead) : 0.0;
    const Stop& stop = joint.ball.stop;
    if (writer.aims() == RowAims::closing) {
        if (isThere && !(stop.stiffness > 0)) writer.close(row, kind, side);
        if (!(isThere && stop.stiffness > 0)) return;
    }
    writer.scalar(std::move(row), kind, side.impulse, aimAtStop(side, stop, w, writer.context(), true),
                  restingAim(side, stop, w, writer.context()), w, bend);
}

void addBall(const RowWriter& writer, const JointSim& joint, const Ahead& ahead) {
    const BallRows& ball = joint.ball;
    const float h = writer.context().h, most = h * ball.spring.most;
    const float w = joint.block.mass.rest.xx + joint.block.mass.rest.yy + joint.block.mass.rest.zz;
    const float easy = easiest(joint.block);
    if (ball.features == 0 || !(easy > 0)) return;
    SpringDrags drags, viscous;
    if (ball.features & BallRows::kSpring) drags = writer.dragsOf(ball.spring.tuning.at(easy), easy);
    if (ball.features & BallRows::kViscous) viscous = writer.dragsOf({0, ball.resistance.viscous}, easy);
    for (int k = 0; k < 3; ++k) {
        const auto row = [&] { return writer.angular(kAxes[k]); };
        if (ball.features & BallRows::kSpring) {
            const float given = -h * ball.springStiffness * ball.springError[k];
            writer.spring(row(), after(RowKind::ballSpring, k), {given, 0, most}, drags, easy);
        }
        if (ball.features & BallRows::kDrives) {
            const BallDrives& drives = joint.drives;
            if (k == 0 || (k == 1 && drives.apart)) drags = writer.dragsOf(tunedDrive(drives, k, easy), easy);
            writer.spring(writer.angular(toDouble(columnOf(drives.basis, k))), after(RowKind::ballSpring, k),
                          {drives.push[k], drives.speed[k], most}, drags, easy);
        }
        if (writer.aims() == RowAims::closing) continue;
        if (ball.features & BallRows::kViscous) writer.spring(row(), after(RowKind::ballViscous, k), {}, viscous, easy);
        if (ball.features & BallRows::kFriction) {
            RowAim moving, resting;
            moving.upper = ball.dry.boundOf(true), resting.upper = ball.dry.boundOf(false);
            moving.lower = -moving.upper, resting.lower = -resting.upper;
            writer.scalar(row(), after(RowKind::ballFriction, k), ball.frictionImpulse[k], moving, resting, w, 0);
        }
    }
    if (ball.features & BallRows::kTwist) {
        addTurnStop(writer, RowKind::twistLower, ball.lowerTwistAxis(), ball.twistLower, ahead.twist.lower, joint);
        addTurnStop(writer, RowKind::twistUpper, ball.upperTwistAxis(), ball.twistUpper, ahead.twist.upper, joint);
    }
    if (ball.features & BallRows::kSwing)
        for (int i = 0; i < SwingLimit::kSides; ++i)
            addTurnStop(writer, after(RowKind::swing, i), ball.swingAxis[i], ball.swing[i], ahead.swing[i], joint);
}

/// A rope under tension is stiff across its line.
void addAcross(const RowWriter& writer, const JointSim& joint, const DVec3& line, double h) {
    const double tension = -static_cast<double>(axisImpulse(joint.axis));
    const double distance = static_cast<double>(length(joint.block.errorFirst));
    if (!(tension > 0) || !(distance > 0)) return;
    const double weight = tuning::kImplicit * h * tension / distance;
    const DVec3 other = line.x * line.x < 0.5 ? DVec3{1, 0, 0} : DVec3{0, 1, 0};
    DVec3 across = cross(line, other);
    across = (1 / length(across)) * across;
    writer.across(across, weight);
    writer.across(cross(line, across), weight);
}

/// The rows of what is free.
void addFree(const RowWriter& writer, const JointSim& joint, const Ahead& ahead) {
    const DVec3 free = toDouble(joint.block.basis.cz);
    switch (joint.kind) {
        case JointKind::ball:
            addBall(writer, joint, ahead);
            break;
        case JointKind::hinge:
            addAxis(writer, writer.angular(free), joint.axis, ahead.axis[0]);
            break;
        case JointKind::slider:
            addAxis(writer, writer.linear(free), joint.axis, ahead.axis[0]);
            break;
        case JointKind::distance:
            addAxis(writer, writer.linear(free), joint.axis, ahead.axis[0]);
            addAcross(writer, joint, free, writer.context().h);
            break;
        default:
            break;
    }
}

/// The joint's Jacobians now, with what its rows have where free motion leads.
Ahead refresh(JointSim& joint, const JointRowBuilder& builder) {
    Ends ends(builder.arrays, joint);
    if (builder.aims != RowAims::substep) {  // nothing moves on from where it is
        refreshJoint(joint, ends.pair(), {builder.context, builder.begins});
        return Ahead(joint);
    }
    Ends later = ends;
    later.advance(builder.context.h);
    refreshJoint(joint, later.pair(), {builder.context, false, true});
    const Ahead ahead(joint);
    refreshJoint(joint, ends.pair(), {builder.context, builder.begins});
    return ahead;
}

}  // namespace

void JointRowBuilder::add(JointSim& joint, std::uint32_t index, std::int32_t a, std::int32_t b) const {
    const Ahead ahead = refresh(joint, *this);
    if (aims == RowAims::substep) {
        const double h = context.h;
        const DVec3 force = toDouble(warmStartImpulse(joint).linear);
        if (a != kFixed) addStiffness(bodies[a], -1.0 * force, toDouble(joint.arms.a), h);
        if (b != kFixed) addStiffness(bodies[b], force, toDouble(joint.arms.b), h);
    }
    SystemPair pair;
    pair.a = a, pair.b = b;
    pair.first = static_cast<std::uint32_t>(rows.size());
    pair.armA = toDouble(joint.arms.a), pair.armB = toDouble(joint.arms.b);
    const RowWriter writer(*this, joint, index, pair);
    if (hasAxes(joint.kind)) {
        addAxes(writer, withAxes(joint).axes, ahead);
    } else {
        if (joint.kind != JointKind::distance && joint.kind != JointKind::none) addBlock(writer, joint.block, ahead);
        if (aims != RowAims::resting) addFree(writer, joint, ahead);
    }
    pair.count = static_cast<std::uint32_t>(rows.size()) - pair.first;
    pairs.push(pair);
}

SystemRow closingRow(const ClosingPoint& point, const SystemPair& pair, const SystemBody* bodies) {
    SystemRow row;
    row.kind = RowKind::closingPoint;
    row.linear = point.normal;
    row.lower = 0, row.upper = kNoBound;
    row.side = Side::lower;
    row.resistance = tuning::kPointResistance * admittance(row, pair, bodies);
    return row;
}

void storeImpulses(const AlignedArray<SystemRow>& rows, JointSim* const* joints) {
    for (const SystemRow& row : rows) {
        JointSim& joint = *joints[row.joint];
        const auto impulse = static_cast<float>(row.impulse);
        const int kind = static_cast<int>(row.kind);
        const auto index = [&](RowKind from) { return kind - static_cast<int>(from); };
        const auto isOf = [&](RowKind from) { return index(from) >= 0 && index(from) < 3; };
        if (isOf(RowKind::first)) {
            joint.block.impulseFirst[index(RowKind::first)] = impulse;
        } else if (isOf(RowKind::second)) {
            const Mat3& basis = joint.block.basis;
            if (row.kind == RowKind::second) joint.block.impulseSecond = {};
            const int k = index(RowKind::second);
            joint.block.impulseSecond += impulse * (k == 0 ? basis.cx : k == 1 ? basis.cy : basis.cz);
        } else if (isOf(RowKind::ballSpring)) {
            // Without drives their basis is that of the world.
            if (row.kind == RowKind::ballSpring) joint.ball.springImpulse = {};
            joint.ball.springImpulse += impulse * columnOf(joint.drives.basis, index(RowKind::ballSpring));
        } else if (isOf(RowKind::ballViscous)) {
            joint.ball.viscousImpulse[index(RowKind::ballViscous)] = impulse;
        } else if (isOf(RowKind::ballFriction)) {
            joint.ball.frictionImpulse[index(RowKind::ballFriction)] = impulse;
        } else if (row.kind >= RowKind::axes) {
            const int at = index(RowKind::axes);
            withAxes(joint).axes.axis[at / kAxisSlots].impulse(static_cast<AxisSlot>(at % kAxisSlots)) = impulse;
        } else if (row.kind >= RowKind::rigid) {
            withAxes(joint).axes.impulse[index(RowKind::rigid)] = impulse;
        } else if (row.kind < RowKind::swing) {
            joint.axis.impulse(static_cast<AxisSlot>(index(RowKind::axis))) = impulse;
        } else if (row.kind < RowKind::twistLower) {
            joint.ball.swing[index(RowKind::swing)].impulse = impulse;
        } else if (row.kind == RowKind::twistLower) {
            joint.ball.twistLower.impulse = impulse;
        } else if (row.kind == RowKind::twistUpper) {
            joint.ball.twistUpper.impulse = impulse;
        }
    }
}

}  // namespace ragtop::direct
