#include <algorithm>
#include <cmath>

#include "vehicle_sim.h"

namespace ragtop {
namespace {

constexpr int kMaxSweeps = 24;
constexpr float kConverged = 1e-5f;  ///< largest change in a sweep, over the impulse of the weight
constexpr float kFlattest = 0.2f;    ///< sine between axle and normal below which a wheel lies on its side

Vec3 velocityOverGround(const WheelPatch& patch, const PointBody& body) {
    return velocityAt(body, patch.arm) - velocityAt(patch.ground, patch.groundArm);
}

Vec2 slipOf(const WheelPatch& patch, const PointBody& body, float treadSpeed) {
    const Vec3 velocity = velocityOverGround(patch, body);
    return {dot(velocity, patch.forward) - treadSpeed, dot(velocity, patch.side)};
}

Vec3 impulseOf(const WheelPatch& patch) {
    return patch.load * patch.normal + patch.tire.x * patch.forward + patch.tire.y * patch.side;
}

/// Inverse effective mass of the two bodies at the patch between directions d and e.
float inverseMassAt(const WheelPatch& patch, const PointBody& body, const Vec3& d, const Vec3& e) {
    return inverseMassBetween(body, patch.arm, d, e) + inverseMassBetween(patch.ground, patch.groundArm, d, e);
}

}  // namespace

/// Everything the car does to itself and the ground in a substep, as one implicit solve: struts (suspension.h), tires
/// (tire.h) and drivetrain (drivetrain.h) are swept until they agree on the velocities that gravity and all their
/// impulses give. The world then integrates these velocities, with its contacts and joints; the bristles of the tires
/// follow the velocities that come out of that, so that a trailer or a rope cannot make a braked car creep.
void VehicleSim::beforeSubstep(float h) {
    if (!active) return;
    const Pose pose = world->pose(chassis);
    const DVec3 center = world->centerOfMass(chassis);
    PointBody body{world->linearVelocity(chassis), world->angularVelocity(chassis), 1 / mass,
                   rotated(inverseInertia, pose.rotation)};
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        preparePatch(i, pose, center, body);
        loads[i] = wheels[i].load;
    }

    // Lift and drag act where the definition says; their arm is short, so drag stays implicit in the speed alone.
    Vec3 linear = airImpulse(body, pose.rotation, h);
    const Vec3 airArm = rotate(pose.rotation, def.aerodynamics.center);
    Vec3 angular = cross(airArm, linear);
    push(body, airArm, linear);
    body.v += h * world->settings().gravity;

    solve(body, h);
    for (std::size_t i = 0; i < wheels.size(); ++i) finishWheel(i, body, h, linear, angular);
    // What is no number the world leaves out, and what is beyond all measure it stops.
    world->applyImpulse(chassis, linear, center);
    world->applyAngularImpulse(chassis, angular);
    if (!holds(linear, angular)) forgetMotion();
}

void VehicleSim::solve(PointBody& body, float h) {
    drivetrain.begin(def, {driver.throttle, driver.brake, driver.handbrake, driver.clutch}, loads, h);
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        WheelPatch& patch = patches[i];
        if (!patch.touching) continue;
        patch.load = h * wheels[i].load;
        patch.tire = {h * wheels[i].force.x, h * wheels[i].force.y};
        pushPatch(i, body, impulseOf(patch));
        drivetrain.spin[i] -= specs[i].radius * patch.tire.x / drivetrain.inertia()[i];
    }
    const float enough = kConverged * h * mass * gravity;
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        float change = drivetrain.sweep(def, h) / meanRadius;
        for (std::size_t i = 0; i < wheels.size(); ++i) change = std::max(change, visitWheel(i, body, h));
        if (change <= enough) break;
    }
    drivetrain.end(h);
}

/// Drag ½ ρ A |v| v, implicit in v so that it never reverses the car, and lift ½ ρ A v² across the flow, which takes no
/// power. With v̂ the direction of travel, u the car's up axis and a = h ½ ρ A |v|/m, lift turns v̂ to v̂ + a u, normalized:
/// a (u − (u·v̂) v̂) where a is small, and u itself at most.
Vec3 VehicleSim::airImpulse(const PointBody& body, const Quat& rotation, float h) const {
    constexpr float kMostTurn = 1e6f;
    const AerodynamicsDef& air = def.aerodynamics;
    const float speed = length(body.v);
    if (!(speed > 0)) return {};
    const float pressure = 0.5f * air.airDensity * speed * h;
    const float drag = pressure * air.dragArea;
    const Vec3 up = rotate(rotation, {0, 1, 0}), along = (1 / speed) * body.v;
    const float a = clampTo(pressure * air.liftArea * body.inverseMass, -kMostTurn, kMostTurn);
    const float longer = a * (2 * dot(along, up) + a), turned = std::sqrt(std::max(1 + longer, 0.0f));
    const Vec3 lift = turned > 0 ? speed / (turned * body.inverseMass) * (a * up - longer / (1 + turned) * along) : Vec3{};
    return (-drag / (1 + drag * body.inverseMass)) * body.v + lift;
}

void VehicleSim::pushPatch(std::size_t i, PointBody& body, const Vec3& impulse) {
    push(body, patches[i].arm, impulse);
    push(patches[i].ground, patches[i].groundArm, -impulse);
}

void VehicleSim::preparePatch(std::size_t i, const Pose& pose, const DVec3& center, const PointBody& body) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    patch.spinBefore = drivetrain.spin[i];
    patch.axle = rotate(wheelFrame(i, pose).rotation, {1, 0, 0});
    patch.touching = placePatch(i, pose, center);
    patch.load = 0;
    patch.tire = {};
    if (!patch.touching) {
        wheel.load = wheel.settleTime = 0;
        wheel.force = wheel.deflection = wheel.travel = {};
        return;
    }
    takeGround(i);
    const float radius = specs[i].radius, inertia = drivetrain.inertia()[i];
    patch.strutK = inverseMassAt(patch, body, patch.normal, patch.normal);
    patch.tireK = {inverseMassAt(patch, body, patch.forward, patch.forward) + radius * radius / inertia,
                   inverseMassAt(patch, body, patch.forward, patch.side),
                   inverseMassAt(patch, body, patch.side, patch.side)};
    patch.transport = std::abs(radius * drivetrain.spin[i]);
    patch.law = tireLaw(specs[i].tire, wheel.load, patch.transport, wheel.ground.friction);
    settleTire(i, body);
    patch.secant = brushSecant(patch.law, wheel.deflection);
}

/// Where the wheel touches its plane. The hub sits at p + x a, x the compression; the lowest point of the rim is
/// r d from it, with d the direction in the plane of the wheel that goes straight down: (p + x a + r d − point)·n = 0.
bool VehicleSim::placePatch(std::size_t i, const Pose& pose, const DVec3& center) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    const WheelSpec& spec = specs[i];
    wheel.compression = -spec.strut.travelDown;
    if (wheel.ground.found == 0) return false;

    DVec3 point = wheel.ground.point;
    patch.normal = wheel.ground.normal;
    if (wheel.ground.moves != 0) movePlane(wheel.ground, world->pose(wheel.ground.body), point, patch.normal);
    const Vec3 axis = rotate(pose.rotation, spec.axis);
    const Vec3 inWheel = patch.normal - dot(patch.normal, patch.axle) * patch.axle;
    const float across = length(inWheel);
    patch.slant = dot(axis, patch.normal);
    if (!(across > kFlattest) || !(patch.slant > kFlattest)) return false;
    const Vec3 down = (-spec.radius / across) * inWheel;
    const DVec3 hub = transformPoint(pose, spec.position);
    const float x = -dot(relative(hub, point) + down, patch.normal) / patch.slant;
    if (!(x > -spec.strut.travelDown)) return false;

    wheel.compression = x;
    patch.point = hub + (x * axis + down);
    patch.arm = relative(patch.point, center);
    patch.forward = normalized(cross(patch.axle, patch.normal));
    patch.side = cross(patch.normal, patch.forward);
    return true;
}

/// Copies the motion of what the wheel stands on. The share of the load that a light body cannot pass on is left out
/// of its impulses, which for the solve is the same as that much more inertia.
void VehicleSim::takeGround(std::size_t i) {
    WheelPatch& patch = patches[i];
    const GroundPlane& plane = wheels[i].ground;
    patch.ground = {};
    patch.groundArm = {};
    if (plane.moves != 0) {
        patch.groundArm = relative(patch.point, world->centerOfMass(plane.body));
        patch.ground.v = world->linearVelocity(plane.body);
        patch.ground.w = world->angularVelocity(plane.body);
        patch.ground.inverseMass = grounds[i].inverseMass;
        patch.ground.inverseInertia = rotated(grounds[i].inverseInertia, world->pose(plane.body).rotation);
    }
    patch.ground.v += plane.surfaceVelocity;
}

/// Brings the bristles up to now: (1) of tire.h with the slip that the last substep really had.
void VehicleSim::settleTire(std::size_t i, const PointBody& body) {
    WheelState& wheel = wheels[i];
    const WheelPatch& patch = patches[i];
    if (wheel.settleTime > 0) {
        const Vec2 slip = slipOf(patch, body, specs[i].radius * drivetrain.spin[i]);
        wheel.deflection = rolledDeflection(patch.law, wheel.deflection, slip, wheel.transport, wheel.settleTime);
        wheel.settleTime = 0;
    }
    wheel.deflection = withinPatch(patch.law, wheel.deflection);
}

/// One visit to a strut and its tire; the largest change of an impulse.
float VehicleSim::visitWheel(std::size_t i, PointBody& body, float h) {
    WheelPatch& patch = patches[i];
    if (!patch.touching) return 0;
    const WheelState& wheel = wheels[i];
    const float radius = specs[i].radius;

    const float apart = dot(velocityOverGround(patch, body), patch.normal) - patch.strutK * patch.load;
    const float load = solveStrut(specs[i].strut, wheel.compression, patch.slant, h, patch.strutK, apart);
    const float loadChange = load - patch.load;
    patch.load = load;
    pushPatch(i, body, loadChange * patch.normal);

    const Vec2 slip = slipOf(patch, body, radius * drivetrain.spin[i]);
    const Sym2& K = patch.tireK;
    const Vec2 free{slip.x - K.xx * patch.tire.x - K.xy * patch.tire.y,
                    slip.y - K.xy * patch.tire.x - K.yy * patch.tire.y};
    const TireVisit visit = solveTire(patch.law, patch.secant, wheel.deflection, patch.transport, load, h, K, free);
    const Vec2 change{visit.impulse.x - patch.tire.x, visit.impulse.y - patch.tire.y};
    patch.tire = visit.impulse;
    patch.sliding = visit.sliding;
    pushPatch(i, body, change.x * patch.forward + change.y * patch.side);
    drivetrain.spin[i] -= radius * change.x / drivetrain.inertia()[i];
    if (load > 0) {
        const Vec2 force{visit.impulse.x / h, visit.impulse.y / h};
        patch.secant =
            visit.sliding
                ? 1.0f / 3
                : brushSecant(patch.law, deflectionOf(patch.law, patch.secant, wheel.deflection, force, load / h, h));
    }
    return std::max({std::abs(loadChange), std::abs(change.x), std::abs(change.y)});
}

/// Keeps what the next substep needs, and adds the wheel's part to the impulse on the chassis. A wheel that is spun up
/// turns the chassis the other way.
void VehicleSim::finishWheel(std::size_t i, const PointBody& body, float h, Vec3& linear, Vec3& angular) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    const float spin = drivetrain.spin[i];
    angular -= drivetrain.inertia()[i] * (spin - patch.spinBefore) * patch.axle;
    wheel.rotation += h * spin;
    wheel.rotation -= 2 * kPi * std::floor((wheel.rotation + kPi) / (2 * kPi));
    wheel.touching = patch.touching ? 1 : 0;
    if (!patch.touching) return;

    const Vec3 impulse = impulseOf(patch);
    linear += impulse;
    angular += cross(patch.arm, impulse);
    if (grounds[i].inverseMass > 0) {
        world->applyImpulse(wheel.ground.body, -grounds[i].share * impulse, patch.point);
    }
    const Vec3 velocity = velocityOverGround(patch, body);
    wheel.travel = {dot(velocity, patch.forward), dot(velocity, patch.side)};
    wheel.load = patch.load / h;
    wheel.force = {patch.tire.x / h, patch.tire.y / h};
    if (patch.sliding) {
        wheel.deflection =
            withinPatch(patch.law, deflectionOf(patch.law, 1.0f / 3, wheel.deflection, wheel.force, wheel.load, h));
        wheel.settleTime = 0;
    } else {
        wheel.settleTime = wheel.load > 0 ? h : 0;
        wheel.transport = patch.transport;
        if (!(wheel.load > 0)) wheel.deflection = {};
    }
}

}  // namespace ragtop
