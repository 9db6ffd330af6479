#include "world/undone_steps.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "direct/choice.h"
#include "world/group_motion.h"

namespace ragtop {

namespace {

/// Steps since the last one undone, up to which the next is one more in a row: another solver may hold for one.
constexpr std::uint32_t kSoon = 2;
/// Share of the energy of motion that is lost each time: half of the speeds, so that ten times leave a thousandth.
constexpr double kLost = 0.75;

/// One more for all bodies of a group, as many as the most of any of them.
UndoneSteps count(const GuardView& view, std::span<const std::uint32_t> group) {
    UndoneSteps most;
    for (const std::uint32_t b : group) {
        const UndoneSteps& own = view.guard.undone[b];
        const std::uint32_t since = view.step - own.last;
        if (own.inRow > 0 && since <= kSoon) most.inRow = std::max(most.inRow, own.inRow);
        // What fails again soon after its stay stays longer.
        if (own.inRow > 0 && since <= static_cast<std::uint32_t>(2 * direct::kStayingSteps) << own.handed)
            most.handed = std::max(most.handed, own.handed);
    }
    ++most.inRow;
    most.last = view.step;
    for (const std::uint32_t b : group) view.guard.undone[b] = most;
    return most;
}

bool isDirectNow(const GuardView& view, std::span<const std::uint32_t> group) {
    return std::any_of(group.begin(), group.end(),
                       [&](std::uint32_t b) { return view.bodies[b].direct.reason != direct::Reason::none; });
}

/// It is solved directly for a while, if it may be: where the choice finds that it is too large or has rows that only
/// iteration knows, it stays with that.
void askDirect(const GuardView& view, std::span<const std::uint32_t> group, UndoneSteps undone) {
    for (const std::uint32_t b : group) {
        view.bodies[b].direct.steps = direct::kStayingSteps << undone.handed;
        view.bodies[b].direct.reason = direct::Reason::staying;
        if (undone.handed < direct::kMostDoublings) ++view.guard.undone[b].handed;
    }
    view.islands.graphChanged = view.islands.directChanged = true;
}

bool isLocked(const GuardView& view, std::span<const std::uint32_t> group) {
    return std::any_of(group.begin(), group.end(), [&](std::uint32_t b) { return view.bodies.states[b].locks != 0; });
}

/// m/s, that weight and other forces give the centre of mass in the step.
Vec3 gainOfCentre(const GuardView& view, std::span<const std::uint32_t> group) {
    double mass = 0;
    DVec3 force{};
    for (const std::uint32_t b : group) {
        const double m = static_cast<double>(view.bodies[b].mass);
        mass += m;
        force = force + m * DVec3{view.bodies.dynamics[b].acceleration};
    }
    return toVec3((static_cast<double>(view.dt) / mass) * force);
}

/// The way of the centre of mass, for all bodies: as one that does not turn.
void followCentre(const GuardView& view, std::span<const std::uint32_t> group) {
    const Vec3 mean = commonMotion(view.bodies, group).v - 0.5f * gainOfCentre(view, group);
    for (const std::uint32_t b : group) view.bodies.states[b].dp = view.dt * mean;
}

/// m/s and rad/s, that contacts and joints gave a body in the step: beyond what it would have as it is turned now.
PairVector changeByImpulses(const GuardView& view, std::uint32_t body) {
    const BodyDynamics& d = view.bodies.dynamics[body];
    const BodyState& state = view.bodies.states[body];
    const EnergyGuard::Speeds& before = view.guard.speeds[body];
    const Vec3 inertia = view.bodies[body].inertia;
    const Quat &from = view.bodies[body].rotation, to = rotationNow(view.bodies, body);
    const Vec3 momentum = rotate(from, scale(inertia, inverseRotate(from, before.w))) + view.dt * d.torque;
    const Vec3 w = rotate(to, scale(d.inverseInertia, inverseRotate(to, momentum)));
    return {state.v - before.v - view.dt * d.acceleration, state.w - w};
}

}  // namespace

void barDirect(const GuardView& view, std::span<const std::uint32_t> group) {
    bool changed = false;
    for (const std::uint32_t b : group) {
        std::int32_t& steps = view.bodies[b].direct.steps;
        changed |= steps > 0;
        steps = std::min(steps, -direct::kCooldownSteps);
    }
    if (changed) view.islands.graphChanged = view.islands.directChanged = true;
}

/// What is undone again changes its solver and loses motion.
static void leaveRepetition(const GuardView& view, std::span<const std::uint32_t> group, bool isFree) {
    const UndoneSteps undone = count(view, group);
    if (undone.inRow < 2) return;
    // A direct solve that fails is dear: it is tried ever more seldom.
    if (isDirectNow(view, group))
        barDirect(view, group);
    else if (std::has_single_bit(undone.inRow))
        askDirect(view, group, undone);
    const double inner = commonMotion(view.bodies, group).inner;
    view.guard.taken += takeEnergy(view.bodies, view.joints, group, kLost * inner, Keeps::momenta);
    // What joints hold to what does not move gives its momenta too; what merely touches it has given its own to it.
    if (isFree) return;
    for (const std::uint32_t& b : group) {
        if (view.bodies[b].firstJoint == kNone) continue;
        const double whole = kineticEnergy(view.bodies, b, rotationNow(view.bodies, b));
        view.guard.taken += takeEnergy(view.bodies, view.joints, {&b, 1}, kLost * whole, Keeps::nothing);
    }
}

double undoImpulses(const GuardView& view, std::span<const std::uint32_t> group, double energy) {
    if (!(energy > 0)) return 0;
    // K(s) = K(0) + s b + s² c with a share s of the impulses, up to which K may rise to its least.
    double b = 0, c = 0;
    for (const std::uint32_t body : group) {
        const BodyState& state = view.bodies.states[body];
        const PairVector change = changeByImpulses(view, body);
        const Quat q = rotationNow(view.bodies, body);
        const Vec3 spin = inverseRotate(q, change.angular), inertia = view.bodies[body].inertia;
        const double m = static_cast<double>(view.bodies[body].mass);
        const double twice = m * static_cast<double>(lengthSquared(change.linear)) +
                             static_cast<double>(dot(spin, scale(inertia, spin)));
        c += 0.5 * twice;
        b += m * static_cast<double>(dot(state.v, change.linear)) +
             static_cast<double>(dot(inverseRotate(q, state.w), scale(inertia, spin))) - twice;
    }
    if (!(c > 0)) return 0;
    const double least = std::clamp(-b / (2 * c), 0.0, 1.0);
    const double most = b + c - energy;  // K(1) − K(0), less what is taken
    const double root = b * b + 4 * c * most;
    const double share = root > 0 ? std::clamp((std::sqrt(root) - b) / (2 * c), least, 1.0) : least;
    for (const std::uint32_t body : group) {
        const PairVector change = changeByImpulses(view, body);
        const auto undone = static_cast<float>(1 - share);
        const BodyState& state = view.bodies.states[body];
        setVelocity(view.bodies, body, state.v - undone * change.linear, state.w - undone * change.angular);
        scaleLeads(view.bodies, view.joints, body, static_cast<float>(share));
    }
    return (1 - share) * (b + (1 + share) * c);
}

void undoPlaces(const GuardView& view, std::span<const std::uint32_t> group, bool isFree) {
    for (const std::uint32_t b : group) {
        view.bodies.states[b].dp = {};
        view.bodies.states[b].dq = {};
        view.bodies.refreshInertia(b);
        for (std::uint32_t key = view.bodies[b].firstJoint; key != kNone;
             key = view.joints[key >> 1].edges[key & 1].next)
            restoreCounts(view.joints.sims[key >> 1]);
    }
    leaveRepetition(view, group, isFree);
    if (isFree && !isLocked(view, group)) followCentre(view, group);
}

void undoMotion(const GuardView& view, std::span<const std::uint32_t> group, bool isFree) {
    const Vec3 gained = isFree && !isLocked(view, group) ? gainOfCentre(view, group) : Vec3{};
    for (const std::uint32_t b : group) {
        view.bodies.states[b].v = view.guard.speeds[b].v + gained;
        view.bodies.states[b].w = view.guard.speeds[b].w;
        view.bodies.storeMomentum(b);
    }
    if (isDirectNow(view, group)) barDirect(view, group);
    undoPlaces(view, group, isFree);
    for (const std::uint32_t b : group) view.scene.forgetImpulses(b, false);
}

}  // namespace ragtop
