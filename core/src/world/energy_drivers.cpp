#include "world/energy_drivers.h"

#include <algorithm>
#include <cmath>

#include "constraints/lane_view.h"
#include "model/joint_bodies.h"
#include "world/energy_guard.h"

namespace ragtop {

namespace {

void add(AlignedArray<EnergyDriver>& drivers, const DVec3& center, float speed, float turn) {
    if (speed > 0 || turn > 0) drivers.push({center, speed, turn});
}

void addKinematic(const GuardView& view, std::uint32_t body, AlignedArray<EnergyDriver>& drivers) {
    if (view.bodies[body].type != BodyType::kinematic) return;
    const BodyState& state = view.bodies.states[view.bodies[body].state];
    add(drivers, view.bodies[body].center, length(state.v), length(state.w));
}

/// m and rad of a body in the step, or m/s and rad/s when it began and now.
enum class Course { way, before, now };
EnergyGuard::Speeds courseOf(const GuardView& view, std::uint32_t index, std::uint32_t state, Course course) {
    const BodyState& s = view.bodies.states[state];
    const bool moves = view.bodies.moves(index) && view.bodies.isAwake(index);
    if (course == Course::way)
        return moves ? EnergyGuard::Speeds{s.dp, 2 * Vec3{s.dq.x, s.dq.y, s.dq.z}}
                     : EnergyGuard::Speeds{view.dt * s.v, view.dt * s.w};
    return course == Course::before && moves ? view.guard.speeds[index] : EnergyGuard::Speeds{s.v, s.w};
}

/// Along the coordinate of a hinge or slider.
double alongJoint(const GuardView& view, const JointSim& sim, const JointRecord& joint, Course course) {
    const EnergyGuard::Speeds a = courseOf(view, joint.bodyA, sim.stateA, course),
                              b = courseOf(view, joint.bodyB, sim.stateB, course);
    const JointBodiesAtStep at = jointBodies(view.bodies, joint);
    const Vec3 axis = rotate(at.rotationA * sim.localA.rotation, Vec3{1, 0, 0});
    if (sim.kind == JointKind::hinge) return static_cast<double>(dot(axis, b.w - a.w));
    // The point of A that lies where B's does.
    const Vec3 armB = rotate(at.rotationB, sim.localB.position), armA = at.centerOffset + armB;
    return static_cast<double>(dot(axis, b.v + cross(b.w, armB) - a.v - cross(a.w, armA)));
}

constexpr float kBounded = 1e12f;  ///< N or N m; more is no bound

/// N or N m, towards its speed.
float forceOf(const AxisRows& axis) {
    return axis.motor.targetSpeed < 0 ? axis.motor.maxReverse : axis.motor.maxForward;
}

/// J, that a motor with a bound gives in a step at most: it pushes up to its speed, so that what stands, goes the other
/// way or is faster gets none of it. What speeds up goes half a substep later than its mean speed would take it.
double workOfMotor(const GuardView& view, const JointSim& sim, const JointRecord& joint) {
    const double target = static_cast<double>(sim.axis.motor.targetSpeed), ahead = target < 0 ? -1 : 1;
    const auto along = [&](Course course) { return ahead * alongJoint(view, sim, joint, course); };
    const double late = 0.5 * static_cast<double>(view.context.h) * (along(Course::now) - along(Course::before));
    const double way = std::max(0.0, along(Course::way) + std::max(0.0, late));
    return static_cast<double>(forceOf(sim.axis)) * std::min(way, std::fabs(target) * static_cast<double>(view.dt));
}

/// Motors and targets that move, about the place of the joint in the body. J, of those with a bound.
double addJoint(const GuardView& view, std::uint32_t index, std::uint32_t body, AlignedArray<EnergyDriver>& drivers) {
    const JointSim& sim = view.joints.sims[index];
    double work = hasBoundedMotor(sim) ? workOfMotor(view, sim, view.joints[index]) : 0;
    const float arm = std::max(length(sim.localA.position), length(sim.localB.position));
    const auto give = [&](float speed, float force, bool turns) {
        if (force < kBounded)
            work += static_cast<double>(force) * static_cast<double>(std::fabs(speed)) * static_cast<double>(view.dt);
        else
            add(drivers, view.bodies[body].center, std::fabs(speed) * (turns ? arm : 1.0f),
                turns ? std::fabs(speed) : 0);
    };
    const auto giveAxis = [&](const AxisRows& axis, bool turns) {
        if ((axis.features & AxisRows::kMotor) != 0 && !hasBoundedMotor(sim))
            give(axis.motor.targetSpeed, forceOf(axis), turns);
        if (axis.features & AxisRows::kSpring) give(axis.spring.speed, axis.spring.most, turns);
    };
    if (hasAxes(sim.kind))
        for (std::uint32_t i = 0; i < withAxes(sim).axes.freeRows; ++i) giveAxis(withAxes(sim).axes.axis[i], true);
    else
        giveAxis(sim.axis, sim.kind == JointKind::hinge);
    const BodyState &a = view.bodies.states[sim.stateA], &b = view.bodies.states[sim.stateB];
    const float turn = length(a.w) + length(b.w), slide = length(b.v - a.v) + turn * arm;
    if (sim.axis.features & AxisRows::kSpring)
        give(sim.kind == JointKind::hinge ? turn : slide, std::fabs(sim.axis.spring.feedForward), false);
    if (sim.ball.features & BallRows::kDrives) give(turn, length(sim.drives.feedForward), false);
    if (sim.ball.features & BallRows::kDrives) give(length(sim.drives.targetSpeed), sim.ball.spring.most, true);
    return work;
}

/// What a caller has put apart, by setPose or setDef, is drawn together within a step at most.
void addOpened(const GuardView& view, std::uint32_t index, std::uint32_t body, AlignedArray<EnergyDriver>& drivers) {
    JointSim& sim = view.joints.sims[index];
    if (!(sim.apart.way > 0 || sim.apart.turn > 0)) return;
    const JointBodiesAtStep at = jointBodies(view.bodies, view.joints[index]);
    const Opening now = openingOf(sim, jointState(sim, at, view.bodies.states.data(), 0), at);
    sim.apart = {std::min(sim.apart.way, now.way), std::min(sim.apart.turn, now.turn)};
    add(drivers, view.bodies[body].center, sim.apart.way / view.dt, sim.apart.turn / view.dt);
}

/// kg m²/s
double spinOf(const GuardView& view, std::uint32_t body, const Vec3& w) {
    return static_cast<double>(length(scale(view.bodies[body].inertia, inverseRotate(view.bodies[body].rotation, w))));
}

}  // namespace

bool hasBoundedMotor(const JointSim& sim) {
    return !hasAxes(sim.kind) && (sim.axis.features & AxisRows::kMotor) != 0 && forceOf(sim.axis) < kBounded;
}

bool mayDrive(const GuardView& view, std::uint32_t index) {
    const JointRecord& joint = view.joints[index];
    const JointSim& sim = view.joints.sims[index];
    const auto isDriven = [](const AxisRows& axis) {
        return (axis.features & (AxisRows::kMotor | AxisRows::kSpring)) != 0;
    };
    bool drives = isDriven(sim.axis) || (sim.ball.features & BallRows::kDrives) != 0;
    for (std::uint32_t i = 0; hasAxes(sim.kind) && i < withAxes(sim).axes.freeRows; ++i)
        drives = drives || isDriven(withAxes(sim).axes.axis[i]);
    const auto isKinematic = [&](std::uint32_t body) { return view.bodies[body].type == BodyType::kinematic; };
    return drives || sim.apart.way > 0 || sim.apart.turn > 0 || isKinematic(joint.bodyA) || isKinematic(joint.bodyB);
}

double workOfContact(const GuardView& view, const ContactRecord& contact, std::uint32_t body, std::uint32_t other) {
    float speed = 0;
    if (view.shapes.surfacesMove())
        speed = length(view.shapes[contact.shapeA].material.surfaceVelocity) +
                length(view.shapes[contact.shapeB].material.surfaceVelocity);
    if (view.bodies[other].type == BodyType::kinematic) {
        const BodyState& state = view.bodies.states[view.bodies[other].state];
        const float reach = length(toVec3(view.bodies[body].center - view.bodies[other].center));
        speed += length(state.v) + length(state.w) * (reach + view.bodies[body].radius);
    }
    if (!(speed > 0)) return 0;
    float impulse = 0;
    for (const ManifoldRecord& manifold : view.manifolds.of(contact)) {
        if (manifold.place.color == kNone) continue;
        const LaneReader lane(view.graph.lane(manifold.place), view.graph.lanes());
        for (int j = 0; j < manifold.pointCount; ++j)
            impulse += (1 + lane.at(contact::kFriction)) * lane.at(j, contact::kPeak);
    }
    return static_cast<double>(impulse) * static_cast<double>(speed);
}

double addDrivers(const GuardView& view, std::uint32_t body, AlignedArray<EnergyDriver>& drivers) {
    double work = 0;
    if (!view.guard.traits[view.guard.groupOfBody(body)].drives && !view.joints.opened) return 0;
    for (std::uint32_t key = view.bodies[body].firstJoint; key != kNone;
         key = view.joints[key >> 1].edges[key & 1].next) {
        if (!view.joints.isHolding(key >> 1)) continue;
        const JointRecord& joint = view.joints[key >> 1];
        addKinematic(view, (key & 1) != 0 ? joint.bodyA : joint.bodyB, drivers);
        addOpened(view, key >> 1, body, drivers);
        const double own = addJoint(view, key >> 1, body, drivers);
        if ((key & 1) == 0 || !view.bodies.moves(joint.bodyA)) work += own;  // once for both of its bodies
    }
    return work;
}

double workOfMotors(const GuardView& view, std::span<const std::uint32_t> group) {
    const EnergyGuard& guard = view.guard;
    if (view.bodies[group.front()].firstJoint == kNone) return 0;
    const std::uint32_t g = guard.groupOfBody(group.front());
    double work = 0;
    if (!guard.traits[g].isMotored) return work;
    for (const std::uint32_t joint : guard.jointsOf(g))
        if (const JointSim& sim = view.joints.sims[joint]; hasBoundedMotor(sim) && view.joints.isHolding(joint))
            work += workOfMotor(view, sim, view.joints[joint]);
    return work;
}

double drivenEnergy(const GuardView& view, std::span<const std::uint32_t> bodies,
                    std::span<const EnergyDriver> drivers) {
    double energy = 0;
    if (drivers.empty()) return 0;
    for (const std::uint32_t b : bodies) {
        const BodyState& now = view.bodies.states[b];
        const EnergyGuard::Speeds& before = view.guard.speeds[b];
        const BodyDynamics& d = view.bodies.dynamics[b];
        const double momentum = static_cast<double>(
            view.bodies[b].mass * (length(before.v) + length(now.v) + view.dt * length(d.acceleration)));
        const double spin =
            spinOf(view, b, before.w) + spinOf(view, b, now.w) + static_cast<double>(view.dt * length(d.torque));
        double most = 0;
        for (const EnergyDriver& driver : drivers) {
            const double r = static_cast<double>(length(toVec3(view.bodies[b].center - driver.center)));
            const double turn = static_cast<double>(driver.turn);
            most = std::max(most, (static_cast<double>(driver.speed) + turn * r) * momentum + turn * spin);
        }
        energy += most;
    }
    return energy;
}

double givenAtOnce(const GuardView& view, std::span<const std::uint32_t> bodies) {
    double energy = 0;
    for (const std::uint32_t b : bodies) {
        const Vec3 change = view.dt * view.bodies.dynamics[b].acceleration;
        energy += 0.5 * static_cast<double>(view.bodies[b].mass * lengthSquared(change));
    }
    return energy;
}

}  // namespace ragtop
