#include "world/energy_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/contact_layout.h"
#include "constraints/stored_energy.h"
#include "direct/choice.h"
#include "model/joint_bodies.h"
#include "world/group_motion.h"
#include "world/jointed_groups.h"
#include "world/undone_steps.h"

namespace ragtop {

namespace {

/// Of the kinetic energy and of the weight times the size: what a first-order integrator trades in a swing and gets
/// back. Chosen, not derived: with it the chains of tests/core/energy_guard_test.cpp are left alone.
constexpr double kRoom = 0.005;

/// The same of what springs hold: they trade more of it within a period, the stiffer they are for a substep.
constexpr double kSpringRoom = 0.1;
/// Share of its energy by which a group that nothing holds is moved as a whole by rounding alone.
constexpr double kThrown = 0.1;
/// Times what there was and what pushing out gives, beyond which a step is undone.
constexpr double kGarbage = 10;

/// J, that forces gave a body along its way.
double workOn(const GuardView& view, std::uint32_t index) {
    const BodyDynamics& d = view.bodies.dynamics[index];
    const BodyState& state = view.bodies.states[index];
    const Vec3 turn = 2 * Vec3{state.dq.x, state.dq.y, state.dq.z};
    return static_cast<double>(view.bodies[index].mass) * static_cast<double>(dot(d.acceleration, state.dp)) +
           static_cast<double>(dot(d.torque, turn));
}

/// J, of springs and soft stops.
struct Stored {
    double before = 0, gained = 0;  ///< when the step began, and since
};

/// Of those joints that are counted with a body.
Stored storedBy(const GuardView& view, std::uint32_t index) {
    Stored stored;
    if (!view.guard.stores) return stored;
    for (std::uint32_t key = view.bodies[index].firstJoint; key != kNone;
         key = view.joints[key >> 1].edges[key & 1].next) {
        if (!view.joints.isHolding(key >> 1)) continue;
        const JointRecord& joint = view.joints[key >> 1];
        const JointSim& sim = view.joints.sims[key >> 1];
        const bool isCounted = (key & 1) == 0 || !view.bodies.moves(joint.bodyA);
        if (!isCounted || !storesEnergy(sim)) continue;
        JointBodiesAtStep at = jointBodies(view.bodies, joint);
        const double before = storedEnergy(sim, at);
        const BodyState &a = view.bodies.states[sim.stateA], &b = view.bodies.states[sim.stateB];
        at.centerOffset += b.dp - a.dp;
        at.rotationA = a.dq * at.rotationA, at.rotationB = b.dq * at.rotationB;
        stored.before += before;
        stored.gained += storedEnergy(sim, at) - before;
    }
    return stored;
}

double excessOf(const GuardView& view, std::uint32_t index) {
    return kineticEnergy(view.bodies, index, rotationNow(view.bodies, index)) -
           static_cast<double>(view.guard.kinetic[index]) + storedBy(view, index).gained - workOn(view, index);
}

/// m, by which bodies that overlap by more than a load presses them are moved apart in a step, at most: by rows, and
/// from far within by places (solve/wide_push.inl).
float wayApart(const GuardView& view, const ContactRecord& contact) {
    float separation = 0;
    for (const ManifoldRecord& manifold : view.manifolds.of(contact))
        for (int j = 0; j < manifold.pointCount; ++j) separation = std::min(separation, manifold.separation[j]);
    if (!(separation < -contact::kDeep * contact.size)) return 0;
    const float beyond = std::max(-separation - contact::kInside * contact.size, 0.0f);
    return std::min(beyond, contact::kInsideMost * contact.size) +
           std::min(-separation, view.context.pushOut * contact.size * view.dt);
}

/// J, of a body that was lifted, as far as being moved apart by such a way does.
double liftOf(const GuardView& view, std::uint32_t index, float way) {
    const Vec3& pull = view.bodies.dynamics[index].acceleration;
    const float lifted = std::clamp(-dot(pull, view.bodies.states[index].dp), 0.0f, way * length(pull));
    return static_cast<double>(view.bodies[index].mass * lifted);
}

/// J, of a body at the speed that overlaps push with.
double pushEnergy(const GuardView& view, std::uint32_t index) {
    const double speed = static_cast<double>(view.context.pushOut * view.bodies[index].size);
    return 0.5 * static_cast<double>(view.bodies[index].mass) * speed * speed;
}

/// What a body touches or is joined to.
template <class OfJoint, class OfContact>
void lookAround(const GuardView& view, std::uint32_t body, OfJoint&& ofJoint, OfContact&& ofContact) {
    for (std::uint32_t key = view.bodies[body].firstJoint; key != kNone;
         key = view.joints[key >> 1].edges[key & 1].next)
        if (view.joints.isHolding(key >> 1))
            ofJoint(view.joints.sims[key >> 1],
                    (key & 1) != 0 ? view.joints[key >> 1].bodyA : view.joints[key >> 1].bodyB);
    for (std::uint32_t key = view.bodies[body].firstContact; key != kNone; key = view.contacts.next(key))
        if (const ContactRecord& contact = view.contacts[key >> 1]; !contact.sensor && contact.firstManifold != kNone)
            ofContact(contact, (key & 1) != 0 ? contact.bodyA : contact.bodyB);
}

/// All that a body touches or is joined to, and so on; each island is looked at once in a step, whatever asks for
/// it.
GuardedIsland& islandOf(const GuardView& view, std::uint32_t first) {
    EnergyGuard& guard = view.guard;
    if (guard.islandOf[first] != kNone) return guard.islands[guard.islandOf[first]];
    const auto number = static_cast<std::uint32_t>(guard.islands.size());
    GuardedIsland look;
    look.begin = static_cast<std::uint32_t>(guard.visited.size());
    look.firstDriver = static_cast<std::uint32_t>(guard.drivers.size());
    const auto reach = [&](std::uint32_t body) {
        if (!view.bodies.moves(body)) {
            look.hangs = true;
        } else if (view.bodies.isAwake(body) && guard.islandOf[body] == kNone) {
            guard.islandOf[body] = number;
            guard.visited.push(body);
        }
    };
    reach(first);
    for (std::size_t i = look.begin; i < guard.visited.size(); ++i) {
        const std::uint32_t body = guard.visited[i];
        look.excess += excessOf(view, body);
        float apart = 0;
        lookAround(
            view, body,
            [&](const JointSim& sim, std::uint32_t other) {
                look.stores |= storesEnergy(sim);
                reach(other);
            },
            [&](const ContactRecord& contact, std::uint32_t other) {
                apart = std::max(apart, wayApart(view, contact));
                reach(other);
            });
        look.lifted += liftOf(view, body, apart);
        look.apart = std::max(look.apart, apart);
        look.driven += addDrivers(view, body, guard.drivers);
    }
    look.lastDriver = static_cast<std::uint32_t>(guard.drivers.size());
    look.end = static_cast<std::uint32_t>(guard.visited.size());
    for (std::size_t i = look.begin; i < look.end && look.apart > 0; ++i)
        look.pushed += pushEnergy(view, guard.visited[i]);
    guard.islands.push(look);
    return guard.islands[number];
}

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

/// J, by which the kinetic energy of a link may differ from that of its place: speeds of trees are those of the middle
/// of a substep, half of one earlier, and so were those that the step began with.
double earlyEnergy(const GuardView& view, std::uint32_t index) {
    const BodyRecord& body = view.bodies[index];
    if (body.direct.reason != direct::Reason::tree) return 0;
    const float early = view.context.h * static_cast<float>(body.direct.pace.stepFactor);
    return static_cast<double>(body.mass * early * length(view.bodies.dynamics[index].acceleration) *
                               length(view.bodies.states[index].v));
}

EnergyAccount accountOf(const GuardView& view, std::span<const std::uint32_t> group) {
    EnergyAccount account;
    double work = 0, weight = 0;
    Stored stored;
    for (const std::uint32_t b : group) {
        const Stored own = storedBy(view, b);
        stored.before += own.before, stored.gained += own.gained;
        account.before += static_cast<double>(view.guard.kinetic[b]);
        account.now += kineticEnergy(view.bodies, b, rotationNow(view.bodies, b));
        work += workOn(view, b);
        weight += static_cast<double>(view.bodies[b].mass * view.bodies[b].size);
        account.room += earlyEnergy(view, b);
    }
    account.excess = account.now - account.before + stored.gained - work;
    weight *= static_cast<double>(length(view.gravity));
    account.lawful = std::max(account.before, account.before + work) + stored.before + weight;
    account.room += kRoom * account.lawful;
    if (stored.before > 0 || stored.gained > 0) account.room += kSpringRoom * (account.before + stored.before);
    return account;
}

/// What a group has left of its room after a step, as a share.
void keepRoom(float& room, double left, double most) {
    room = most > 0 ? static_cast<float>(std::clamp(left / most, 0.0, 1.0)) : 1.0f;
}

/// The share of a group, whatever the order of its bodies.
float& roomOf(EnergyGuard& guard, std::span<const std::uint32_t> group) {
    return guard.room[*std::min_element(group.begin(), group.end())];
}

/// True where a group has gained no more than it has room for, which is noted. What a module has pushed is not looked
/// at.
bool fits(float& room, const EnergyAccount& account) {
    if (account.before == std::numeric_limits<double>::infinity()) {
        room = 1;
        return true;
    }
    const double left = static_cast<double>(room) * account.room - account.excess;
    if (!(left >= 0)) return false;
    keepRoom(room, left, account.room);
    return true;
}

/// What is known of an island once for all of its groups.
void completeAccount(const GuardView& view, GuardedIsland& look) {
    if (look.lawful >= 0) return;
    const EnergyGuard& guard = view.guard;
    const std::span<const std::uint32_t> island{guard.visited.data() + look.begin, look.end - look.begin};
    look.lawful = accountOf(view, island).lawful;
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
    undoMotion(view, {guard.visited.data() + look.begin, look.end - look.begin}, !look.hangs);
    guard.taken += look.excess;
    look.excess = 0;
}

/// A group whose energy is no number; so may be what it touches.
void undoUnbounded(const GuardView& view, std::span<const std::uint32_t> group) {
    if (isThrown(view, group)) return barDirect(view, group);
    const GuardedIsland& look = islandOf(view, group.front());
    ++view.guard.caught;
    undoMotion(view, {view.guard.visited.data() + look.begin, look.end - look.begin}, !look.hangs);
}

/// J, that overlaps lift a group by: the bodies that are in something, and all of it with the one that goes farthest.
struct Lifts {
    double own = 0, whole = 0;
};
Lifts liftsOf(const GuardView& view, const GuardedIsland& look, std::span<const std::uint32_t> group) {
    Lifts lifts;
    if (!(look.apart > 0)) return lifts;
    float farthest = 0;
    for (const std::uint32_t body : group) {
        float apart = 0;
        const auto note = [&](const ContactRecord& contact, std::uint32_t) {
            apart = std::max(apart, wayApart(view, contact));
        };
        lookAround(
            view, body, [](const auto&, std::uint32_t) {}, note);
        lifts.own += liftOf(view, body, apart);
        farthest = std::max(farthest, apart);
    }
    for (const std::uint32_t body : group) lifts.whole += liftOf(view, body, farthest);
    return lifts;
}

/// What nothing holds has nothing to give its momenta to.
Keeps whatStays(const GuardView& view, const GuardedIsland& look, std::span<const std::uint32_t> group) {
    if (!look.hangs) return Keeps::momenta;
    bool held = false;
    const auto note = [&](const auto&, std::uint32_t other) { held |= !view.bodies.moves(other); };
    for (const std::uint32_t body : group) lookAround(view, body, note, note);
    return held ? Keeps::nothing : Keeps::momenta;
}

/// J. An island that nothing holds keeps its momenta; in others, where speeds against each other say nothing, impulses
/// are undone in part, so that none loses what another does not get.
double takeFromIsland(const GuardView& view, std::span<const std::uint32_t> island, const GuardedIsland& look,
                      double energy) {
    return look.hangs ? undoImpulses(view, island, energy)
                      : takeEnergy(view.bodies, view.joints, island, energy, Keeps::momenta);
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
    if (!(beyond > 0)) return;
    const std::span<const std::uint32_t> island{guard.visited.data() + look.begin, look.end - look.begin};
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
        turnToMomentum(view.bodies, group, guard.momentum[g]);
        const double turned = account.now;
        account.now = accountOf(view, group).now;
        beyond += account.now - turned;
    }
    const double whole = beyond;
    // What overlaps is pushed, at a speed that is bounded.
    beyond = std::min(beyond, account.now - look.pushed);
    double taken = takeEnergy(view.bodies, view.joints, group, beyond, whatStays(view, look, group));
    // Momenta too are wrong where impulses were so large that their rounding moves all of the group.
    const double lawful = account.now - beyond;
    if (const double more = accountOf(view, group).now - lawful; more > kThrown * look.lawful) {
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
    const bool isLeft = whole - look.pushed - taken - (lifts.whole - lifts.own) > account.room;
    if (isLeft && (look.stores || !isIsolated)) {
        if (look.hangs)
            undoPlaces(view, island, false);
        else
            undoMotion(view, island, true);
    }
    if (isLeft && look.stores)
        for (const std::uint32_t b : island) view.scene.forgetImpulses(b);
    if (taken > 0) noteTaken(guard, look, taken);
    room = 0;
}

/// What a direct solve that fell back has given to bodies that no joint holds, which are in no group.
void guardFallenBack(const GuardView& view, const DirectIsland& fallen) {
    EnergyGuard& guard = view.guard;
    GuardedIsland& look = islandOf(view, view.directSet.bodies[fallen.firstBody]);
    const std::span<const std::uint32_t> island{guard.visited.data() + look.begin, look.end - look.begin};
    if (!std::isfinite(look.excess)) return;
    completeAccount(view, look);
    const double beyond = look.excess - look.driven - look.lifted - look.pushed - kRoom * look.lawful;
    if (isGarbage(view, island, look, beyond)) return undoStep(view, look);
    const double taken = takeFromIsland(view, island, look, beyond);
    if (!(taken > 0)) return;
    noteTaken(guard, look, taken);
    for (const std::uint32_t b : island) view.scene.forgetImpulses(b, false);  // joints keep their turns
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
    view.runner.parallelFor(static_cast<int>(view.bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            recordKinetic(guard, view.bodies, view.bodies.awake[i]);
    });
    guard.momentum.resizeForOverwrite(guard.groupCount());
    view.runner.parallelFor(static_cast<int>(guard.groupCount()), 4, [&](int begin, int end, int) {
        for (auto g = static_cast<std::size_t>(begin); g < static_cast<std::size_t>(end); ++g)
            if (guard.watched[g] != Watching::none)
                guard.momentum[g] = angularMomentumAtStart(view.bodies, guard.membersOf(g));
    });
}

void recordDriven(EnergyGuard& guard, std::uint32_t body) {
    if (guard.groupCount() > 0) guard.kinetic[body] = std::numeric_limits<float>::infinity();
}

bool hasGainedEnergy(const GuardView& view, std::span<const std::uint32_t> bodies) {
    return !fits(roomOf(view.guard, bodies), accountOf(view, bodies));
}

void guardEnergy(const GuardView& view) {
    EnergyGuard& guard = view.guard;
    const std::size_t groups = guard.groupCount();
    if (groups == 0) return;
    guard.accounts.resizeForOverwrite(groups);
    guard.suspects.resizeForOverwrite(groups);
    // Trees that go alone and have kept their energy have been finished.
    const auto isFinished = [&](std::size_t g) {
        return view.directSet.multirate.independentCount > 0 &&
               (view.directSet.multirate.marks[guard.membersOf(g).front()] & Multirate::kIndependent) != 0;
    };
    view.runner.parallelFor(static_cast<int>(groups), 4, [&](int begin, int end, int) {
        for (auto g = static_cast<std::size_t>(begin); g < static_cast<std::size_t>(end); ++g) {
            guard.suspects[g] = 0;
            if (guard.watched[g] == Watching::none || isFinished(g)) continue;
            const std::span<const std::uint32_t> group = guard.membersOf(g);
            EnergyAccount& account = guard.accounts[g];
            account = accountOf(view, group);
            guard.suspects[g] = guard.watched[g] == Watching::all ? !fits(roomOf(guard, group), account)
                                                                  : !(account.excess <= kGarbage * account.lawful);
        }
    });
    guard.islands.clear();
    guard.drivers.clear();
    guard.islands.reserve(groups + view.directSet.islands.size());
    guard.visited.clear();
    guard.islandOf.resizeForOverwrite(view.bodies.size());
    for (const std::uint32_t body : view.bodies.awake) guard.islandOf[body] = kNone;
    for (std::size_t g = 0; g < groups; ++g)
        if (guard.suspects[g] != 0) guardGroup(view, g);
    for (const DirectIsland& island : view.directSet.islands)
        if (island.fellBack && island.jointCount > 0 && island.contactCount > 0) guardFallenBack(view, island);
}

}  // namespace ragtop
