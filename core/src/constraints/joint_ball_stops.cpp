#include "constraints/joint_ball_stops.h"

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
    return turn.stop(side, axis, aimAtStop(side, rows.stop, inverseMass, context, moving), speed, context, true);
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

/// The energy that the relative rotation would have if nothing out of place were brought back.
void recordEnergy(BallRows& rows, const BallTurn& turn, const BodyPair& pair, const Arms& arms) {
    rows.mostEnergy = kNoForceLimit;
    bool recovers = isRecovering(rows.twistLower) || isRecovering(rows.twistUpper);
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) recovers = recovers || isRecovering(rows.swing[i]);
    if (!recovers || rows.stop.stiffness > 0) return;
    HeldRotationOf<float> held(turn, pair, arms);
    if (rows.twistLower.impulse > 0)
        held.hold(rows.lowerTwistAxis(), true);
    else if (rows.twistUpper.impulse > 0)
        held.hold(-rows.upperTwistAxis(), true);
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i)
        if (rows.swing[i].impulse > 0) held.hold(rows.swingAxis[i], true);
    rows.mostEnergy = held.energy();
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
        turn.shed(rows.mostEnergy);
}

}  // namespace ragtop
