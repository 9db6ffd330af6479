#include "world/energy_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "constraints/contact_layout.h"
#include "constraints/stored_energy.h"
#include "direct/choice.h"
#include "world/energy_account.h"
#include "world/group_motion.h"
#include "world/guarded_islands.h"
#include "world/jointed_groups.h"
#include "world/undone_steps.h"

namespace ragtop {

namespace {

/// Share of its energy by which a group that nothing holds is moved as a whole by rounding alone.
constexpr double kThrown = 0.1;
/// Times what there was and what pushing out gives, beyond which a step is undone.
constexpr double kGarbage = 10;
constexpr double kRounding = 1e-6;  ///< of its room, which sums of an island are wrong by

/// Has a force or velocity beyond all measure taken some body out of the range of numbers? Then it is stopped alone.
bool isThrown(const GuardView& view, std::span<const std::uint32_t> group) {
    constexpr float kBeyond = 1e12f;  // m/s², rad/s² and J
    for (const std::uint32_t b : group) {
        const BodyDynamics& d = view.bodies.dynamics[b];
        const bool pushed = length(d.acceleration) > kBeyond || length(view.bodies.inertias[b] * d.torque) > kBeyond;
        if (pushed || !(view.guard.kinetic[b] < kBeyond)) return true;
    }
    return false;
}

/// Did some body go farther than so much energy, J, would take it, beside a way that it was moved? Four times as far is
/// not what bodies of a group hand each other in a step.
bool overran(const GuardView& view, std::span<const std::uint32_t> group, double energy, float moved) {
    constexpr double kFar = 16;  // in squares of the way
    for (const std::uint32_t b : group) {
        const float way = std::max(length(view.bodies.states[b].dp) - moved, 0.0f);
        const double speed = static_cast<double>(way) / static_cast<double>(view.dt);
        if (0.5 * static_cast<double>(view.bodies[b].mass) * speed * speed > kFar * energy) return true;
    }
    return false;
}

/// Its share of the room, whatever the order of its bodies.
float& roomOf(EnergyGuard& guard, std::span<const std::uint32_t> group) {
    return guard.room[guard.parent[group.front()]];
}

/// What is known of an island once for all of its groups.
void completeAccount(const GuardView& view, GuardedIsland& look) {
    if (std::exchange(look.isComplete, true)) return;
    const EnergyGuard& guard = view.guard;
    const std::span<const std::uint32_t> island = bodiesOf(guard, look);
    look.atOnce = givenAtOnce(view, island);
    look.driven +=
        drivenEnergy(view, island, {guard.drivers.data() + look.firstDriver, look.lastDriver - look.firstDriver});
}

/// Did a step give so much more than there was, or take bodies so far, that its velocities are no estimate of anything,
/// nor the work of forces along its ways?
bool isGarbage(const GuardView& view, std::span<const std::uint32_t> island, const GuardedIsland& look, double beyond) {
    const double most = look.lawful + look.pushed + look.atOnce;
    return beyond > kGarbage * most || (beyond > look.pushed && overran(view, island, most + look.driven, look.apart));
}

void undoStep(const GuardView& view, GuardedIsland& look) {
    EnergyGuard& guard = view.guard;
    ++guard.caught;
    undoMotion(view, bodiesOf(guard, look), !look.hangs);
    guard.taken += look.excess;
    look.excess = 0;
    look.isDone = true;
}

/// Where springs or heights hold what motion cannot pay: the way that led there is not gone.
void undoWay(const GuardView& view, std::span<const std::uint32_t> island, GuardedIsland& look) {
    if (look.hangs)
        undoPlaces(view, island, false);
    else
        undoMotion(view, island, true);
    look.isDone = true;
}

/// A group whose energy is no number; so may be what it touches.
void undoUnbounded(const GuardView& view, std::span<const std::uint32_t> group) {
    if (isThrown(view, group)) return barDirect(view, group);
    const GuardedIsland& look = islandOf(view, group.front());
    ++view.guard.caught;
    undoMotion(view, bodiesOf(view.guard, look), !look.hangs);
}

/// What nothing holds has nothing to give its momenta to.
Keeps whatStays(const GuardView& view, const GuardedIsland& look, std::span<const std::uint32_t> group) {
    if (!look.hangs) return Keeps::momenta;
    bool held = view.guard.traits[view.guard.groupOfBody(group.front())].hangs;
    for (std::size_t i = 0; i < group.size() && !held; ++i)
        forEachTouch(view, group[i], [&](const auto&, std::uint32_t other) { held |= !view.bodies.moves(other); });
    return held ? Keeps::nothing : Keeps::momenta;
}

/// J. An island that nothing holds keeps its momenta; in others, where speeds against each other say nothing, impulses
/// are undone in part, so that none loses what another does not get.
double takeFromIsland(const GuardView& view, std::span<const std::uint32_t> island, const GuardedIsland& look,
                      double energy) {
    return look.hangs ? undoImpulses(view, island, energy)
                      : takeEnergy(view.bodies, view.joints, island, energy, Keeps::momenta);
}

/// kg m²/s, angular, about its centre of mass; records tell where bodies were until poses move.
Vec3 momentumAtStart(const GuardView& view, std::span<const std::uint32_t> group) {
    return angularMomentum(view.bodies, group, [&](std::uint32_t b) {
        const EnergyGuard::Speeds& before = view.guard.speeds[b];
        return MovingPose{view.bodies[b].center, view.bodies[b].rotation, before.v, before.w};
    });
}

void noteTaken(EnergyGuard& guard, GuardedIsland& look, double energy) {
    ++guard.caught;
    guard.taken += energy;
    look.excess -= energy;
}

void guardGroup(const GuardView& view, std::size_t g) {
    EnergyGuard& guard = view.guard;
    const std::span<const std::uint32_t> group = guard.membersOf(g);
    float& room = roomOf(guard, group);
    EnergyAccount account = guard.accounts[g];
    if (!std::isfinite(account.excess)) {
        room = 0;
        return undoUnbounded(view, group);
    }
    const double left = static_cast<double>(room) * account.room;
    GuardedIsland& look = islandOf(view, group.front());
    const Lifts lifts = liftsOf(view, look, group);
    double beyond = std::min(account.excess - lifts.own, look.excess - look.lifted) - left;
    if (!(beyond > 0) || look.isDone) return;
    const std::span<const std::uint32_t> island = bodiesOf(guard, look);
    completeAccount(view, look);
    beyond -= look.driven;
    if (!(beyond > 0)) return;
    const bool isIsolated = !look.hangs && look.driven == 0 && island.size() == group.size();
    if (isGarbage(view, island, look, beyond)) {
        room = 0;
        return undoStep(view, look);
    }
    if (guard.watched[g] != Watching::all) return;
    if (isIsolated) {
        turnToMomentum(view.bodies, group, momentumAtStart(view, group));
        const double turned = account.now;
        account.now = kineticNow(view, group);
        beyond += account.now - turned;
        look.excess += account.now - turned;
    }
    const double whole = beyond;
    // What overlaps is pushed, at a speed that is bounded.
    beyond = std::min(beyond, account.now - look.pushed);
    double taken = takeEnergy(view.bodies, view.joints, group, beyond, whatStays(view, look, group));
    // Momenta too are wrong where impulses were so large that their rounding moves all of the group.
    const double lawful = account.now - beyond;
    if (const double more = kineticNow(view, group) - lawful; more > kThrown * look.lawful) {
        if (isIsolated) {  // whose momenta are known
            room = 0;
            return undoStep(view, look);
        }
        taken += takeFromIsland(view, island, look, more);
    }
    // What touches the group may have got some of it.
    if (island.size() > group.size())
        taken +=
            takeFromIsland(view, island, look, look.excess - left - look.driven - look.lifted - look.pushed - taken);
    // Springs have the rest, or heights of what is held, not of what is lifted out: the way there is not gone.
    const double rest = whole - look.pushed - taken, followed = std::clamp(rest, 0.0, lifts.whole - lifts.own);
    look.lifted += followed;
    const bool isLeft = rest - followed > account.room;
    if (isLeft && (look.stores || !isIsolated)) undoWay(view, island, look);
    if (isLeft && look.stores)
        for (const std::uint32_t b : island) view.scene.forgetImpulses(b);
    if (taken > 0) noteTaken(guard, look, taken);
    room = 0;
}

/// What parts of an island have room for, how much of it is left, and what they owe, J.
struct Rooms {
    double most = 0, left = 0, owed = 0;
};

/// Of an island, as its step began.
Rooms roomsOf(const GuardView& view, std::span<const std::uint32_t> island) {
    const EnergyGuard& guard = view.guard;
    Rooms rooms;
    for (const std::uint32_t b : island) {
        if (!keepsLedger(view, b)) continue;
        const bool joined = isJoined(view, b);
        const double most = joined ? guard.accounts[guard.groupOfBody(b)].room : accountOf(view, {&b, 1}).room;
        const float loose = guard.looseAsked[b] == view.step ? guard.looseShare[b] : guard.room[b];
        const float share = joined ? guard.accounts[guard.groupOfBody(b)].share : loose;
        rooms.most += most;
        rooms.left += static_cast<double>(share) * most;
        rooms.owed += static_cast<double>(guard.owed[b]);
    }
    return rooms;
}

/// Divides what is left and owed among the parts of an island.
void keepRooms(const GuardView& view, std::span<const std::uint32_t> island, const Rooms& rooms) {
    const auto parts = static_cast<double>(
        std::count_if(island.begin(), island.end(), [&](std::uint32_t b) { return keepsLedger(view, b); }));
    for (const std::uint32_t b : island) {
        if (!keepsLedger(view, b)) continue;
        keepRoom(view.guard.room[b], rooms.left, rooms.most);
        view.guard.owed[b] = static_cast<float>(rooms.owed / parts);
    }
}

/// What an island gained as a whole is charged to all of its parts; what it has no room for is taken.
void guardIsland(const GuardView& view, GuardedIsland& look) {
    EnergyGuard& guard = view.guard;
    if (!look.isJoined || look.isDone || look.watched != Watching::all || !std::isfinite(look.excess)) return;
    const std::span<const std::uint32_t> island = bodiesOf(guard, look);
    completeAccount(view, look);
    Rooms rooms = roomsOf(view, island);
    if (!std::isfinite(rooms.most)) return;
    // What drives it gives what it takes at most, and no room beside, nor does what lifts it out; what pushes it gives
    // what there is no room for.
    const double gained = std::max(0.0, look.excess - look.driven), lifted = std::min(gained, look.lifted);
    const double pushed = std::clamp(gained - lifted - rooms.left, 0.0, look.pushed);
    rooms.owed += pushed;
    rooms.left -= gained - lifted - pushed;
    if (look.excess < 0) pay(rooms.left, rooms.most, rooms.owed, -look.excess);
    const double beyond = -rooms.left;
    rooms.left = std::max(0.0, rooms.left);
    keepRooms(view, island, rooms);
    if (!(beyond > kRounding * rooms.most)) return;
    if (isGarbage(view, island, look, beyond)) return undoStep(view, look);
    const double taken = takeFromIsland(view, island, look, beyond);
    if (beyond - taken > rooms.most) undoWay(view, island, look);
    if (!(taken > 0)) return;
    noteTaken(guard, look, taken);
    if (!look.fellBack) return;
    for (const std::uint32_t b : island) view.scene.forgetImpulses(b, false);  // joints keep their turns
}

/// Has a body without joints gained more than it has room for? Each is asked once in a step.
void suspectLoose(const GuardView& view, std::uint32_t body) {
    EnergyGuard& guard = view.guard;
    if (!view.bodies.moves(body) || isJoined(view, body) || !view.bodies.isAwake(body)) return;
    if (guard.looseAsked[body] == view.step) return;
    guard.looseAsked[body] = view.step;
    guard.looseShare[body] = guard.room[body];
    if (!fits(guard.room[body], guard.owed[body], accountOf(view, {&body, 1}))) guard.looseSuspects.push(body);
}

/// Bodies that no joint holds may have what they gained from a group: those that touch one, and all that are solved
/// directly with one. To ask others too costs a pile with a single joint a fifth of its step.
void suspectLoose(const GuardView& view) {
    EnergyGuard& guard = view.guard;
    guard.looseSuspects.clear();
    if (view.bodies.awake.size() == guard.bodies.size()) return;
    for (const DirectIsland& island : view.directSet.islands)
        for (std::uint32_t i = 0; island.jointCount > 0 && island.contactCount > 0 && i < island.bodyCount; ++i)
            suspectLoose(view, view.directSet.bodies[island.firstBody + i]);
    for (const std::uint32_t body : guard.bodies)
        forEachTouch(view, body, [&](const ContactRecord&, std::uint32_t other) { suspectLoose(view, other); });
}

}  // namespace

void recordKinetic(EnergyGuard& guard, const Bodies& bodies, std::uint32_t body) {
    guard.kinetic[body] = static_cast<float>(kineticEnergy(bodies, body, bodies[body].rotation));
    guard.speeds[body] = {bodies.states[body].v, bodies.states[body].w};
}

void beginGuard(const GuardView& view) {
    findGroups(view);
    EnergyGuard& guard = view.guard;
    if (guard.groupCount() == 0) return;
    guard.kinetic.resizeForOverwrite(view.bodies.size());
    guard.speeds.resizeForOverwrite(view.bodies.size());
    guard.undone.resize(view.bodies.size(), UndoneSteps{});
    guard.room.resize(view.bodies.size(), 1.0f);
    guard.owed.resize(view.bodies.size(), 0.0f);
    guard.looseShare.resizeForOverwrite(view.bodies.size());
    guard.looseAsked.resize(view.bodies.size(), kNone);
    guard.looseSuspects.reserve(view.bodies.awake.size());
    view.runner.parallelFor(static_cast<int>(view.bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            recordKinetic(guard, view.bodies, view.bodies.awake[i]);
    });
}

void recordDriven(EnergyGuard& guard, std::uint32_t body, double given) {
    guard.kinetic[body] = static_cast<float>(static_cast<double>(guard.kinetic[body]) + given);
}

bool hasGainedEnergy(const GuardView& view, std::span<const std::uint32_t> bodies) {
    return !fits(roomOf(view.guard, bodies), view.guard.owed[view.guard.parent[bodies.front()]],
                 accountOf(view, bodies));
}

void guardEnergy(const GuardView& view) {
    EnergyGuard& guard = view.guard;
    const std::size_t groups = guard.groupCount();
    if (groups == 0) return;
    guard.accounts.resizeForOverwrite(groups);
    guard.suspects.resizeForOverwrite(groups);
    view.runner.parallelFor(static_cast<int>(groups), 4, [&](int begin, int end, int) {
        for (auto g = static_cast<std::size_t>(begin); g < static_cast<std::size_t>(end); ++g) {
            guard.suspects[g] = 0;
            if (!isAccountKept(view, g)) continue;
            const std::span<const std::uint32_t> group = guard.membersOf(g);
            const EnergyAccount& account = keepAccount(view, g);
            guard.suspects[g] = guard.watched[g] == Watching::all
                                    ? !fits(roomOf(guard, group), guard.owed[guard.parent[group.front()]], account)
                                    : !(account.excess <= kGarbage * account.lawful);
        }
    });
    suspectLoose(view);
    guard.islands.clear();
    guard.drivers.clear();
    guard.islands.reserve(groups + view.directSet.islands.size());
    guard.visited.clear();
    guard.islandOf.resizeForOverwrite(view.bodies.size());
    for (const std::uint32_t body : view.bodies.awake) guard.islandOf[body] = kNone;
    for (std::size_t g = 0; g < groups; ++g)
        if (guard.suspects[g] != 0) guardGroup(view, g);
    for (const std::uint32_t body : guard.looseSuspects) islandOf(view, body);
    for (const DirectIsland& island : view.directSet.islands)
        if (island.fellBack && island.jointCount > 0 && island.contactCount > 0)
            islandOf(view, view.directSet.bodies[island.firstBody]).fellBack = true;
    for (GuardedIsland& look : guard.islands) guardIsland(view, look);
}

}  // namespace ragtop
