#include "direct/joint_rows.h"

#include <limits>

#include "constraints/joint_types.h"

namespace ragtop::direct {

namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();

DVec3 toDouble(const Vec3& a) { return DVec3(a); }

/// The larger part of ∂²/∂θ² of a force's work on an arm, (F · r) E − ½ (r Fᵀ + F rᵀ): what is not negative.
DSym3 tautStiffness(const DVec3& force, const DVec3& arm) {
    const double f = length(force), r = length(arm);
    if (!(f > 0) || !(r > 0)) return {};
    const double along = dot(force, arm), largest = f * r;
    const DVec3 axis = cross(arm, force), apart = (1 / r) * arm - (1 / f) * force;
    const double sine = length(axis), spread = length(apart);
    if (sine <= 1e-6 * largest || spread <= 1e-6) {
        if (!(along > 0)) return {};
        const DSym3 across = outer(-largest / (r * r), arm);
        return across + DSym3{largest, 0, 0, largest, 0, largest};
    }
    const DSym3 first = along > 0 ? outer(along / (sine * sine), axis) : DSym3{};
    return first + outer(0.5 * (along + largest) / (spread * spread), apart);
}

void addStiffness(SystemBody& body, const DVec3& impulse, const DVec3& arm, double h) {
    const double turning = h * length(impulse) * length(arm);
    const DSym3& i = body.inverseInertia;
    const double least = i.xx > i.yy ? (i.xx > i.zz ? i.xx : i.zz) : (i.yy > i.zz ? i.yy : i.zz);
    // For a thin link T = |impulse|/h, r = L/2 and I = m L²/12, so 4 T h²/(m L) = ⅔ h |impulse| r / I.
    const double ratio = (2.0 / 3) * turning * least / tuning::kStiffLink;
    if (!(ratio > 1)) return;
    const double share = ratio < 2 ? ratio - 1 : 1;
    body.stiffness = body.stiffness + scaled(tautStiffness(impulse, arm), share * tuning::kImplicit * h);
}

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
            const Vec3 half = 0.5f * time * s->w;
            s->dq = normalized(Quat{half.x, half.y, half.z, 1} * s->dq);
        }
    }
    BodyPair pair() { return {states, inertias, 1, 2, TautBodies{}}; }
};

/// The directions of a joint's rows and what they share.
class RowWriter {
public:
    RowWriter(const JointRowBuilder& builder, const JointSim& joint, std::uint32_t index, std::int32_t a,
              std::int32_t b)
        : builder_(builder),
          index_(index),
          a_(a),
          b_(b),
          armA_(toDouble(joint.arms.a)),
          armB_(toDouble(joint.arms.b)) {}

    SystemRow linear(const DVec3& d) const { return row(d, cross(armA_, d), cross(armB_, d)); }
    SystemRow angular(const DVec3& d) const { return row({}, d, d); }

    void push(SystemRow row, RowKind kind, double load, double target, double bias, double lower, double upper) const {
        row.kind = kind;
        row.load = load;
        row.target = target;
        row.bias = bias;
        row.lower = lower;
        row.upper = upper;
        builder_.rows.push(row);
    }
    /// `ahead` is the error where free motion leads.
    void rigid(const SystemRow& row, RowKind kind, double load, double error, double ahead) const {
        const double bias = -static_cast<double>(builder_.context.softness.biasRate) * error;
        push(row, kind, load, curving(row, error, ahead) + bias, bias, -kNoBound, kNoBound);
    }
    /// A margin that grows with the row's speed.
    void limit(const SystemRow& row, RowKind kind, double load, double margin, double ahead) const {
        const bool within = margin > 0;
        const double rate = within ? builder_.context.inverseH : builder_.context.softness.biasRate;
        const double bias = -rate * margin;
        push(row, kind, load, curving(row, margin, ahead) + bias, within ? 0.0 : bias, 0, kNoBound);
    }
    void bounded(const SystemRow& row, RowKind kind, double load, double speed, double bound) const {
        push(row, kind, load, speed, 0, -bound, bound);
    }
    void spring(SystemRow row, RowKind kind, float stiffness, float damping, double error, double bound) const {
        const SpringRow s = makeSpring(stiffness, damping, builder_.context.h);
        if (!s.active) return;
        row.resistance = s.gamma;
        push(row, kind, 0, -static_cast<double>(s.beta) * error, 0, -bound, bound);
    }
    /// The stiffness of tension T across a line of length L: a spring h γ T/L about the free motion.
    void across(const DVec3& d, double weight) const {
        SystemRow r = linear(d);
        r.resistance = 1 / weight;
        push(r, RowKind::across, 0, freeSpeed(r), 0, -kNoBound, kNoBound);
    }

private:
    /// The speed along the row at which an error would not change: what free motion has, less the change it makes.
    double curving(const SystemRow& row, double error, double ahead) const {
        return freeSpeed(row) - (ahead - error) * static_cast<double>(builder_.context.inverseH);
    }
    SystemRow row(const DVec3& d, const DVec3& turnA, const DVec3& turnB) const {
        SystemRow r;
        r.a = a_, r.b = b_, r.joint = index_;
        store(-1.0 * d, r.ja), store(-1.0 * turnA, r.ja + 3);
        store(d, r.jb), store(turnB, r.jb + 3);
        mask(r.a, r.ja), mask(r.b, r.jb);
        const double k = admittance(r.a, r.ja) + admittance(r.b, r.jb);
        r.resistance = tuning::kRowResistance * (k > 0 ? k : 1);
        return r;
    }
    /// Locked movements feel nothing.
    void mask(std::int32_t body, double j[6]) const {
        if (body == kFixed) return;
        const SystemBody& s = builder_.bodies[body];
        for (int k = 0; k < 3; ++k)
            if (!(s.inverseMass[k] > 0)) j[k] = 0;
        if (!(s.inverseInertia.xx > 0)) j[3] = 0;
        if (!(s.inverseInertia.yy > 0)) j[4] = 0;
        if (!(s.inverseInertia.zz > 0)) j[5] = 0;
    }
    double admittance(std::int32_t body, const double j[6]) const {
        if (body == kFixed) return 0;
        const SystemBody& s = builder_.bodies[body];
        double k = 0;
        for (int i = 0; i < 3; ++i) k += s.inverseMass[i] * j[i] * j[i];
        return k + dot(load(j + 3), s.inverseInertia * load(j + 3));
    }
    double freeSpeed(const SystemRow& r) const {
        double u = 0;
        const auto part = [&](std::int32_t body, const double j[6]) {
            if (body == kFixed) return;
            const BodyState& s = builder_.arrays.states[builder_.bodies[body].state];
            for (int k = 0; k < 3; ++k)
                u += j[k] * static_cast<double>(s.v[k]) + j[3 + k] * static_cast<double>(s.w[k]);
        };
        part(r.a, r.ja);
        part(r.b, r.jb);
        return u;
    }

    const JointRowBuilder& builder_;
    std::uint32_t index_;
    std::int32_t a_, b_;
    DVec3 armA_, armB_;
};

RowKind after(RowKind kind, int k) { return static_cast<RowKind>(static_cast<int>(kind) + k); }

/// The rigid rows: three of the first half, then those of the second, in the order of the block's basis.
void addBlock(const RowWriter& writer, const RigidBlock& block, const RigidBlock& ahead) {
    const DVec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const bool linear = block.linearFirst != 0;
    for (int k = 0; k < 3; ++k)
        writer.rigid(linear ? writer.linear(axes[k]) : writer.angular(axes[k]), after(RowKind::first, k),
                     block.impulseFirst[k], block.errorFirst[k], ahead.errorFirst[k]);
    const Vec3 columns[3] = {block.basis.cx, block.basis.cy, block.basis.cz};
    for (int k = 0; k < static_cast<int>(block.rigidRows); ++k) {
        const DVec3 d = toDouble(columns[k]);
        writer.rigid(linear ? writer.angular(d) : writer.linear(d), after(RowKind::second, k),
                     dot(block.impulseSecond, columns[k]), block.errorSecond[k], ahead.errorSecond[k]);
    }
}

/// The rows along a coordinate.
void addAxis(const RowWriter& writer, const SystemRow& row, const AxisRows& axis, const AxisRows& ahead, double h) {
    SystemRow opposite = row;
    for (int k = 0; k < 6; ++k) opposite.ja[k] = -row.ja[k], opposite.jb[k] = -row.jb[k];
    if (axis.features & AxisRows::kSpring)
        writer.spring(row, RowKind::axisSpring, axis.stiffness, axis.damping, axis.springError, kNoBound);
    if (axis.features & AxisRows::kFriction)
        writer.bounded(row, RowKind::axisFriction, axis.frictionImpulse, 0, static_cast<double>(axis.friction) * h);
    if (axis.features & AxisRows::kMotor)
        writer.bounded(row, RowKind::axisMotor, axis.motorImpulse, axis.targetSpeed,
                       static_cast<double>(axis.maxForce) * h);
    if (axis.features & AxisRows::kLocked)
        writer.rigid(row, RowKind::axisLower, axis.lowerImpulse, axis.lowerMargin, ahead.lowerMargin);
    if (axis.features & AxisRows::kLimit) {
        writer.limit(row, RowKind::axisLower, axis.lowerImpulse, axis.lowerMargin, ahead.lowerMargin);
        writer.limit(opposite, RowKind::axisUpper, axis.upperImpulse, axis.upperMargin, ahead.upperMargin);
    }
}

void addBall(const RowWriter& writer, const BallRows& ball, const BallRows& ahead, double h) {
    const DVec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; ++k) {
        if (ball.features & BallRows::kSpring)
            writer.spring(writer.angular(axes[k]), after(RowKind::ballSpring, k), ball.stiffness, ball.damping,
                          ball.springError[k], static_cast<double>(ball.maxSpringTorque) * h);
        if (ball.features & BallRows::kFriction)
            writer.bounded(writer.angular(axes[k]), after(RowKind::ballFriction, k), ball.frictionImpulse[k], 0,
                           static_cast<double>(ball.friction) * h);
    }
    const DVec3 twist = toDouble(ball.twistAxis), swing = toDouble(ball.swingAxis);
    if ((ball.features & BallRows::kTwist) && dot(twist, twist) > 0) {
        writer.limit(writer.angular(twist), RowKind::twistLower, ball.twistLowerImpulse, ball.twistLowerMargin,
                     ahead.twistLowerMargin);
        writer.limit(writer.angular(-1.0 * twist), RowKind::twistUpper, ball.twistUpperImpulse, ball.twistUpperMargin,
                     ahead.twistUpperMargin);
    }
    if ((ball.features & BallRows::kSwing) && dot(swing, swing) > 0)
        writer.limit(writer.angular(-1.0 * swing), RowKind::swing, ball.swingImpulse, ball.swingMargin,
                     ahead.swingMargin);
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

}  // namespace

void JointRowBuilder::add(JointSim& joint, std::uint32_t index, std::int32_t a, std::int32_t b) const {
    Ends ends(arrays, joint);
    joint.taut = {};
    Ends later = ends;
    later.advance(context.h);
    refreshJoint(joint, later.pair(), false);
    const RigidBlock blockAhead = joint.block;
    const AxisRows axisAhead = joint.axis;
    const BallRows ballAhead = joint.ball;
    refreshJoint(joint, ends.pair(), true);

    const double h = context.h;
    const DVec3 force = toDouble(carriedImpulse(joint).linear);
    if (a != kFixed) addStiffness(bodies[a], -1.0 * force, toDouble(joint.arms.a), h);
    if (b != kFixed) addStiffness(bodies[b], force, toDouble(joint.arms.b), h);

    const RowWriter writer(*this, joint, index, a, b);
    const DVec3 free = toDouble(joint.block.basis.cz);
    if (joint.kind != JointKind::distance && joint.kind != JointKind::none) addBlock(writer, joint.block, blockAhead);
    switch (joint.kind) {
        case JointKind::ball:
            addBall(writer, joint.ball, ballAhead, h);
            break;
        case JointKind::hinge:
            addAxis(writer, writer.angular(free), joint.axis, axisAhead, h);
            break;
        case JointKind::slider:
            addAxis(writer, writer.linear(free), joint.axis, axisAhead, h);
            break;
        case JointKind::distance:
            addAxis(writer, writer.linear(free), joint.axis, axisAhead, h);
            addAcross(writer, joint, free, h);
            break;
        case JointKind::fixed:
        case JointKind::none:
            break;
    }
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
            joint.ball.springImpulse[index(RowKind::ballSpring)] = impulse;
        } else if (isOf(RowKind::ballFriction)) {
            joint.ball.frictionImpulse[index(RowKind::ballFriction)] = impulse;
        } else {
            switch (row.kind) {
                case RowKind::axisSpring:
                    joint.axis.springImpulse = impulse;
                    break;
                case RowKind::axisFriction:
                    joint.axis.frictionImpulse = impulse;
                    break;
                case RowKind::axisMotor:
                    joint.axis.motorImpulse = impulse;
                    break;
                case RowKind::axisLower:
                    joint.axis.lowerImpulse = impulse;
                    break;
                case RowKind::axisUpper:
                    joint.axis.upperImpulse = impulse;
                    break;
                case RowKind::twistLower:
                    joint.ball.twistLowerImpulse = impulse;
                    break;
                case RowKind::twistUpper:
                    joint.ball.twistUpperImpulse = impulse;
                    break;
                case RowKind::swing:
                    joint.ball.swingImpulse = impulse;
                    break;
                default:
                    break;
            }
        }
    }
}

}  // namespace ragtop::direct
