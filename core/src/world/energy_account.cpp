#include "world/energy_account.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/stored_energy.h"
#include "direct/choice.h"
#include "model/joint_bodies.h"
#include "world/energy_drivers.h"
#include "world/group_motion.h"

namespace ragtop {

namespace {

/// Of the kinetic energy and of the weight times the size: what a first-order integrator trades in a swing and gets
/// back. Chosen, not derived: with it the chains of tests/core/energy_guard_test.cpp are left alone.
constexpr double kRoom = 0.005;

/// The same of what springs hold: they trade more of it within a period, the stiffer they are for a substep.
constexpr double kSpringRoom = 0.1;
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

/// J, by which the kinetic energy of a link may differ from that of its place: speeds of trees are those of the middle
/// of a substep, half of one earlier, and so were those that the step began with.
double earlyEnergy(const GuardView& view, std::uint32_t index) {
    const BodyRecord& body = view.bodies[index];
    if (body.direct.reason != direct::Reason::tree) return 0;
    const float early = view.context.h * static_cast<float>(body.direct.pace.stepFactor);
    return static_cast<double>(body.mass * early * length(view.bodies.dynamics[index].acceleration) *
                               length(view.bodies.states[index].v));
}

}  // namespace

double kineticNow(const GuardView& view, std::span<const std::uint32_t> group) {
    double sum = 0;
    for (const std::uint32_t b : group) sum += kineticEnergy(view.bodies, b, rotationNow(view.bodies, b));
    return sum;
}

double lawfulOf(const EnergyAccount& account) {
    return std::max(account.before, account.before + account.work) + account.held;
}

EnergyAccount accountOf(const GuardView& view, std::span<const std::uint32_t> group) {
    EnergyAccount account;
    double weight = 0;
    Stored stored;
    for (const std::uint32_t b : group) {
        const Stored own = storedBy(view, b);
        stored.before += own.before, stored.gained += own.gained;
        account.before += static_cast<double>(view.guard.kinetic[b]);
        account.now += kineticEnergy(view.bodies, b, rotationNow(view.bodies, b));
        account.work += workOn(view, b);
        weight += static_cast<double>(view.bodies[b].mass * view.bodies[b].size);
        account.room += earlyEnergy(view, b);
    }
    account.excess = account.now - account.before + stored.gained - account.work;
    account.held = stored.before + weight * static_cast<double>(length(view.gravity));
    account.lawful = lawfulOf(account);
    account.room += kRoom * account.lawful;
    if (account.excess > 0) account.driven = workOfMotors(view, group);
    if (stored.before > 0 || stored.gained > 0) account.room += kSpringRoom * (account.before + stored.before);
    return account;
}

void keepRoom(float& room, double left, double most) {
    room = most > 0 ? static_cast<float>(std::clamp(left / most, 0.0, 1.0)) : 1.0f;
}

void pay(double& left, double most, double& owed, double paid) {
    const double room = std::min(paid, std::max(0.0, most - left));
    left += room;
    owed = std::max(0.0, owed - (paid - room));
}

bool fits(float& room, float& owed, const EnergyAccount& account) {
    if (account.before == std::numeric_limits<double>::infinity()) {
        room = 1;
        owed = 0;
        return true;
    }
    double left = static_cast<double>(room) * account.room, debt = static_cast<double>(owed);
    const double gained = std::max(0.0, account.excess - account.driven);
    if (!(account.excess <= left + account.driven)) return false;
    if (account.excess > 0)
        left -= gained;
    else
        pay(left, account.room, debt, -account.excess);
    keepRoom(room, left, account.room);
    owed = static_cast<float>(debt);
    return true;
}

}  // namespace ragtop
