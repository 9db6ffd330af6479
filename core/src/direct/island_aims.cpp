// What an island's system asks for in each pass.

#include <cmath>

#include "direct/island_system.h"

namespace ragtop::direct {

/// rotate(q, v) − v without cancellation.
static DVec3 turned(const Quat& q, const DVec3& v) {
    const DVec3 u{q.x, q.y, q.z};
    const DVec3 t = 2.0 * cross(u, v);
    return static_cast<double>(q.w) * t + cross(u, t);
}

void IslandSystem::updateGaps(const BodyArrays& arrays) {
    for (const SystemContact& c : equations_.contacts) {
        const BodyState &a = arrays.states[c.stateA], &b = arrays.states[c.stateB];
        const DVec3 moved = toDouble(b.dp) - toDouble(a.dp);
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = equations_.points[c.first + j];
            // What turns is a round shape's core; its surface stays round.
            const DVec3 turn = turned(b.dq, p.armB + c.roundB * c.normal) - turned(a.dq, p.armA - c.roundA * c.normal);
            p.gap = p.startGap + dot(c.normal, moved + turn);
        }
    }
}

/// Apart, a gap may be used up within the substep; touching, errors decay as in the soft row. Points within kContactGap
/// count as touching, so that rounding of gaps does not decide who bears a load.
void IslandSystem::aimAtPositions(const BodyArrays& arrays, const SolverContext& context) {
    updateGaps(arrays);
    const double inverseH = context.inverseH;
    for (const SystemContact& c : equations_.contacts) {
        const bool fixed = c.a == kFixed || c.b == kFixed;
        const double rate = fixed ? context.softStatic.biasRate : context.soft.biasRate;
        const double near = c.near, rounded = c.rounded;
        const double push = static_cast<double>(context.pushOut) * c.size;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = equations_.points[c.first + j];
            const double error = p.gap > rounded ? p.gap - rounded : p.gap < -rounded ? p.gap + rounded : 0.0;
            if (p.gap > near)
                p.target = -(p.gap - near) * inverseH - rate * (near - rounded);
            else
                p.target = -rate * error < push ? -rate * error : push;
        }
    }
}

/// The speeds by which other bounds and drags of a row may change it.
template <class Note>
static void recordRest(const SystemRow& row, Note&& note) {
    const double stiffer = row.resistance / row.resting.resistance - 1;
    note(stiffer < 1 ? stiffer * row.speed : row.speed);
    // A load at a bound that moves.
    const double admittance = row.resistance / tuning::kRowResistance;
    if (row.resting.upper != row.upper && row.impulse >= row.upper) note(admittance * row.upper);
    if (row.resting.lower != row.lower && row.impulse <= row.lower) note(admittance * row.lower);
}

/// Springs and dampers know the mean speed from what they gave in the pass that moved; what was at a bound stays there.
/// `note` is told the change of load as a speed.
template <class Note>
static void follow(SystemRow& row, Note&& note) {
    RestingAim& rest = row.resting;
    if (row.impulse >= row.upper || row.impulse <= row.lower) {
        rest.resistance = rest.inverseMass / kNoDrag;
        rest.target = (row.impulse - row.load) * rest.resistance;
        return;
    }
    rest.target += rest.follows * row.impulse * rest.resistance;
    note(rest.inverseMass * (row.load + (rest.target - row.speed) / rest.resistance - row.impulse));
}

bool IslandSystem::aimAtVelocities(const BodyArrays& arrays, const SolverContext& context, const JointContext& joints) {
    if (equations_.stopped) return false;  // nothing was pushed
    updateGaps(arrays);
    double largest = 0;
    bool bears = false, hasSprings = false;
    const auto note = [&](double change) {
        const double size = std::fabs(change);
        if (size > largest) largest = size;
    };
    for (const SystemContact& c : equations_.contacts) {
        const double near = c.near;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = equations_.points[c.first + j];
            bears |= p.impulse[0] > 0;
            // What is to bounce comes to the surface with its own speed; the next substep reflects it there.
            if (c.restitution > 0 && p.speed[0] < -static_cast<double>(context.restitutionSpeed)) continue;
            const double target = p.gap > near ? -(p.gap - near) * static_cast<double>(context.inverseH) : 0.0;
            if (p.impulse[0] > 0 || p.speed[0] < target) note(target - p.target);
            p.target = target;
        }
    }
    const auto recordRow = [&](double change) { note(tuning::kAtRest / tuning::kSkip * change); };
    for (SystemRow& row : equations_.rows) {
        if (row.resting.follows > 0) {
            follow(row, recordRow);
        } else {
            recordRow(0.1 * (row.resting.target - row.target));
            recordRest(row, recordRow);
        }
        hasSprings |= row.compliant && row.kind != RowKind::across;
        row.target = row.resting.target;
        row.lower = row.resting.lower;
        row.upper = row.resting.upper;
        if (row.resting.resistance != row.resistance) row.factored = row.side != Side::within;
        row.resistance = row.resting.resistance;
    }
    if (largest <= tuning::kAtRest * equations_.gravityStep) return false;
    const bool moved = hasSprings && !bears;
    if (moved) moveRows(arrays, joints);
    // A load that errors of positions ask for in vain, because bodies that touch at many points cannot heed them all,
    // is shifted to other points with every substep until none is asked for.
    equations_.takePointLoads();
    // What moving the positions did to the velocities (spins turn with their bodies) belongs to the free motion.
    for (std::size_t i = 0; i < equations_.bodies.size(); ++i) {
        const BodyState& state = arrays.states[equations_.bodies[i].state];
        for (int k = 0; k < 3; ++k) {
            equations_.free[6 * i + static_cast<std::size_t>(k)] +=
                static_cast<double>(state.v[k]) - static_cast<double>(written_[2 * i][k]);
            equations_.free[6 * i + 3 + static_cast<std::size_t>(k)] +=
                static_cast<double>(state.w[k]) - static_cast<double>(written_[2 * i + 1][k]);
        }
        store(toDouble(state.v), equations_.velocity.data() + 6 * i);
        store(toDouble(state.w), equations_.velocity.data() + 6 * i + 3);
    }
    if (moved) equations_.freeBefore(equations_.velocity.data());
    return true;
}

}  // namespace ragtop::direct
