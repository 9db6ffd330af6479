// What an island's system asks for in each pass.

#include <cmath>

#include "constraints/contact_layout.h"
#include "direct/island_system.h"

namespace ragtop::direct {

/// rotate(q, v) − v without cancellation.
static DVec3 turned(const Quat& q, const DVec3& v) {
    const DVec3 u{q.x, q.y, q.z};
    const DVec3 t = 2.0 * cross(u, v);
    return static_cast<double>(q.w) * t + cross(u, t);
}

/// 2 tan θ/2 along the axis of a turn by θ: what turns from r to r' has moved by this × (r + r')/2.
static DVec3 turnOf(const Quat& q) { return (2 / static_cast<double>(q.w)) * DVec3{q.x, q.y, q.z}; }

/// How far B has moved beside A in this step. Bodies that have moved by more than half a size are no longer where they
/// touched, but what a carrier takes along as it turns has not.
static DVec3 displacementOf(const SystemContact& c, const BodyState& a, const BodyState& b) {
    const DVec3 way = toDouble(b.dp) - toDouble(a.dp), middle = c.offset + 0.5 * way;
    const double reach = 0.5 * c.size;
    const auto isFar = [&](const DVec3& moved) { return dot(moved, moved) > reach * reach; };
    const bool far = isFar(way) && isFar(way - cross(turnOf(a.dq), middle)) && isFar(way - cross(turnOf(b.dq), middle));
    return far ? DVec3{} : way;
}

void IslandSystem::moveArms(SystemContact& c, const BodyArrays& arrays) {
    const DVec3 moved = displacementOf(c, arrays.states[c.stateA], arrays.states[c.stateB]), more = moved - c.moved;
    c.moved = moved;
    for (std::uint32_t j = 0; j < c.count; ++j) {
        SystemPoint& p = equations_.points[c.first + j];
        p.armA = p.armA + c.follow * more;
        p.armB = p.armB - (1 - c.follow) * more;
    }
}

/// What turning adds by the end of the substep to the speed of B beside A: the point goes on with B, by a share f,
///   d/dt (ωB × rB − ωA × rA) = −ω × (vB − vA),   ω = f ωA + (1 − f) ωB.
/// Places follow by the mean of the speeds before and after a substep; with 5/12 for the half of its series' next term
/// that mean is the chord of a circle, up to (ω h)⁴. What is less than rounding leaves alone what rests.
static DVec3 speedAhead(const SystemContact& c, const BodyState& a, const BodyState& b, double h, double rounding) {
    const DVec3 speed = toDouble(b.v) - toDouble(a.v);
    const DVec3 spin = toDouble(b.w) + c.follow * (toDouble(a.w) - toDouble(b.w));
    if (h * h * dot(spin, spin) > static_cast<double>(contact::kAhead * contact::kAhead)) return {};
    const DVec3 change = (-h) * cross(spin, speed + (5.0 / 12 * h) * cross(spin, speed));
    return dot(change, change) > rounding * rounding ? change : DVec3{};
}

bool IslandSystem::setDrifts(const SystemContact& c, const BodyArrays& arrays) {
    const BodyState &a = arrays.states[c.stateA], &b = arrays.states[c.stateB];
    const auto driven = [](const BodyState& state, const DVec3& arm) {
        return state.invMass > 0 ? DVec3{} : toDouble(state.v) + cross(toDouble(state.w), arm);
    };
    const bool fixed = c.stateA == 0 || c.stateB == 0;
    const DVec3 ahead = fixed ? DVec3{} : speedAhead(c, a, b, h_, tuning::kAtRest * equations_.gravityStep);
    const DVec3 surface{field(c, contact::kSurface), field(c, contact::kSurface + 1), field(c, contact::kSurface + 2)};
    bool any = false;
    for (std::uint32_t j = 0; j < c.count; ++j) {
        SystemPoint& p = equations_.points[c.first + j];
        const DVec3 drift = driven(b, p.armB) - driven(a, p.armA) + ahead;
        p.drift[0] = dot(drift, c.normal);
        p.drift[1] = dot(drift + surface, c.tangent1);
        p.drift[2] = dot(drift + surface, c.tangent2);
        any |= p.drift[0] != 0 || p.drift[1] != 0 || p.drift[2] != 0;
    }
    return any;
}

void IslandSystem::updateGaps(const BodyArrays& arrays) {
    for (const SystemContact& c : equations_.contacts) {
        const BodyState &a = arrays.states[c.stateA], &b = arrays.states[c.stateB];
        const DVec3 moved = toDouble(b.dp) - toDouble(a.dp);
        // To the cores of where arms were when the step began.
        const DVec3 backA = c.follow * c.moved + c.roundA * c.normal;
        const DVec3 onB = (1 - c.follow) * c.moved + c.roundB * c.normal;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = equations_.points[c.first + j];
            // What turns is a round shape's core; its surface stays round.
            const DVec3 turn = turned(b.dq, p.armB + onB) - turned(a.dq, p.armA - backA);
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
        const double push = static_cast<double>(context.pushSpeed(static_cast<float>(c.size)));
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
