#include "constraints/joint_ball_stops.h"

#include <cmath>

namespace ragtop {
namespace {

/// A stop whose margin grows with the speed about `axis`; `bend` is by what its mean rate over the substep differs from
/// that. Returns the energy of the change of its impulse.
float solveTurnStop(StopSide& side, const Vec3& axis, BallTurn& turn, const BallRows& rows, const JointContext& context,
                    bool moving, float bend = 0) {
    const float speed = dot(axis, turn.speed) + bend;
    if (!(rows.stop.stiffness > 0) && !mayAct(side, aimAtStop(side, rows.stop, 0, context, moving), speed)) return 0;
    const float inverseMass = dot(axis, turn.block.mass.rest * axis);
    if (!(inverseMass > turn.block.noise)) return 0;
    const RowAim aim = aimAtStop(side, rows.stop, inverseMass, context, moving);
    const float change = solveRow(side.impulse, aim, speed, inverseMass, context, true);
    turn.add(change * axis);
    return inverseMass * change * change;
}

/// The sides that a ball has, in the order in which they are solved.
struct BallSides {
    static constexpr int kMost = 2 + SwingLimit::kSides;  ///< two of the twist, and of the swing
    StopSide* side[kMost];
    Vec3 axis[kMost];
    int count = 0;

    explicit BallSides(BallRows& rows) {
        if (rows.features & BallRows::kTwist) {
            add(rows.twistLower, rows.lowerTwistAxis());
            add(rows.twistUpper, rows.upperTwistAxis());
        }
        for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) add(rows.swing[i], rows.swingAxis[i]);
    }

private:
    void add(StopSide& each, const Vec3& about) {
        side[count] = &each;
        axis[count++] = about;
    }
};

/// Sides that are held where they are, and not brought back, would come back all the same: as the bodies turn on, their
/// margin leaves its tangent, by ½ h² in each substep, and the load does work that nothing takes back.
struct HeldBends {
    float bend[BallSides::kMost] = {};

    HeldBends() = default;
    HeldBends(JointSim& joint, const BallSides& sides, const BallTurn& turn, const BodyPair& pair, float h) {
        BodyPair now = pair;
        now.apply(joint.arms, {-(turn.block.mass.gain * turn.total), turn.total});
        BallRows ahead = joint.ball;
        refreshLimits(ahead, placeAhead(locate(joint, pair), joint.arms, now, h));
        const BallSides later(ahead);
        for (int i = 0; i < sides.count; ++i) {
            const Vec3 &axis = sides.axis[i], &next = later.axis[i];
            const float along = dot(axis, next);
            const bool sameEdge = 4 * along * along > 3 * lengthSquared(axis) * lengthSquared(next) && along > 0;
            const bool held = sides.side[i]->recovery == 0 && sides.side[i]->margin < 0;
            if (held && sameEdge) bend[i] = 0.5f * dot(next - axis, turn.speed);
        }
    }
};

/// All sides at once, as JointStops of other joints: one after the other they would lose energy for substeps and give
/// it back.
void solveTogether(JointSim& joint, BallTurn& turn, const BodyPair& pair, const JointContext& context, bool moving) {
    constexpr int kIterations = 32;  // a bound, by trial
    constexpr float kAgreed = 1e-8f;  // of the energy of the first changes
    const BallSides sides(joint.ball);
    HeldBends bends;
    if (moving) bends = HeldBends(joint, sides, turn, pair, context.h);
    float first = 0;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        float changed = 0;
        for (int i = 0; i < sides.count; ++i)
            changed += solveTurnStop(*sides.side[i], sides.axis[i], turn, joint.ball, context, moving, bends.bend[i]);
        if (iteration == 0) first = changed;
        if (!(changed > kAgreed * first)) return;
    }
}

/// A violated stop that brings its margin back; asked in the pass that moves.
bool isRecovering(const StopSide& side) { return side.margin < 0 && side.impulse > 0; }

/// Takes the rates about some axes out of a rotation, n · ω = 0, by impulses about them: each axis is first made
/// P-orthogonal to those before it.
struct HeldAxes {
    const RigidBlock& block;
    Vec3 rotation;
    Vec3 axes[1 + SwingLimit::kSides], responses[1 + SwingLimit::kSides];
    float inverseMasses[1 + SwingLimit::kSides];
    int count = 0;

    void hold(Vec3 axis) {
        for (int i = 0; i < count; ++i) axis -= (dot(axis, responses[i]) / inverseMasses[i]) * axes[i];
        const Vec3 response = block.mass.rest * axis;
        const float inverseMass = dot(axis, response);
        if (!(inverseMass > block.noise)) return;
        rotation -= (dot(axis, rotation) / inverseMass) * response;
        axes[count] = axis;
        responses[count] = response;
        inverseMasses[count++] = inverseMass;
    }
};

/// The energy ½ ω · P⁻¹ ω that the relative rotation would have if nothing out of place were brought back, neither the
/// point nor a margin: what acts would hold.
void recordEnergy(BallRows& rows, const BallTurn& turn, const BodyPair& pair, const Arms& arms) {
    rows.mostEnergy = kNoForceLimit;
    bool recovers = isRecovering(rows.twistLower) || isRecovering(rows.twistUpper);
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) recovers = recovers || isRecovering(rows.swing[i]);
    if (!recovers || rows.stop.stiffness > 0) return;
    const PairVector u = pair.velocity(arms);
    BodyPair still = pair;
    still.apply(arms, {-solve(turn.block.mass.first, u.linear), {}});
    HeldAxes held{turn.block, turn.speed + (still.velocity(arms).angular - u.angular), {}, {}, {}};
    if (rows.twistLower.impulse > 0)
        held.hold(rows.lowerTwistAxis());
    else if (rows.twistUpper.impulse > 0)
        held.hold(-rows.upperTwistAxis());
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i)
        if (rows.swing[i].impulse > 0) held.hold(rows.swingAxis[i]);
    rows.mostEnergy = 0.5f * dot(held.rotation, solve(turn.block.second, held.rotation));
}

/// A cone that closes on what turns in it would spin it up, as arms drawn in spin up a skater. Coming back from beyond
/// a limit is to add no energy: the relative rotation is slowed down to what it had.
void shedEnergy(const BallRows& rows, BallTurn& turn) {
    if (!(rows.mostEnergy < kNoForceLimit)) return;
    const Vec3 momentum = solve(turn.block.second, turn.speed);
    const float energy = 0.5f * dot(turn.speed, momentum);
    if (energy > rows.mostEnergy) turn.add((std::sqrt(rows.mostEnergy / energy) - 1) * momentum);
}

}  // namespace

bool isHeld(const BallRows& rows) {
    const BallSides sides(const_cast<BallRows&>(rows));
    for (int i = 0; i < sides.count; ++i)
        if (sides.side[i]->recovery == 0) return true;
    return false;
}

void solveBallStops(JointSim& joint, BallTurn& turn, const BodyPair& pair, const JointContext& context, bool moving) {
    BallRows& rows = joint.ball;
    if (isHeld(rows)) {
        solveTogether(joint, turn, pair, context, moving);
    } else {
        const BallSides sides(rows);
        for (int i = 0; i < sides.count; ++i) solveTurnStop(*sides.side[i], sides.axis[i], turn, rows, context, moving);
    }
    if (moving)
        recordEnergy(rows, turn, pair, joint.arms);
    else
        shedEnergy(rows, turn);
}

}  // namespace ragtop
