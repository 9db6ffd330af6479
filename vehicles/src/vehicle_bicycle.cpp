#include <algorithm>
#include <cmath>

#include "brakes.h"
#include "nearby.h"
#include "vehicle_sim.h"

/// Level 0: the chassis is kinematic and goes as bicycle.h has it, over a plane that a ray finds below it now and then.
/// Its height and tilt follow that plane, and the lean of struts in bends, as a critically damped spring does, and
/// never fall faster than freely.
namespace ragtop {
namespace {

constexpr float kRide = 9;          ///< rad/s, of that spring
constexpr float kRolls = 3;         ///< m/s, below which tires roll without slip
constexpr float kSeen = 0.25f;      ///< of a wheelbase, after which the ground is looked for again
constexpr float kStopped = 1e-3f;   ///< m/s, below which a car that does not roll has come to rest
constexpr float kMostSlide = 0.5f;  ///< of the speed, sideways: far beyond what linear tires know

/// A spring of rate kRide to where it is `off`, after h by backward Euler; its rate of change.
Vec3 settled(const Vec3& rate, const Vec3& off, float h) {
    return (1 / (1 + 2 * kRide * h + kRide * kRide * h * h)) * (rate - kRide * kRide * h * off);
}

float driven(const VehicleDef& def) {
    float sum = 0;
    for (const WheelDef& wheel : def.wheels) sum += wheel.driveShare;
    return sum;
}

}  // namespace

/// Where the car is over the ground, by a ray from above its foot.
void VehicleSim::seekBelow(const Pose& pose) {
    WheelState& first = wheels[0];
    const float base = std::max(ride.wheelbase, specs[0].radius);
    if (!first.isPut() && first.ground.moves == 0 && first.ground.found != 0 && unseen < kSeen * base) return;
    const Vec3 up = rotate(pose.rotation, {0, 1, 0});
    const float above = specs[0].strut.travelUp + specs[0].radius, below = base;
    const WheelPath path{transformPoint(pose, ride.foot) + above * up, -(above + below) * up, up, {}, 0, 0};
    findPoint(*world, queryOf(def.chassis.filter, chassis), path, first.ground);
    for (std::size_t i = 1; i < wheels.size(); ++i) wheels[i].ground = first.ground;
    first.squash = 0;
    unseen = 0;
}

/// The speed after h, of a car whose engine turns with its wheels or, where these are too slow, as fast as its clutch
/// takes hold.
float VehicleSim::pushAlong(const BicycleRoad& road, float speed, float h) {
    Drivetrain& d = drivetrain;
    const GearboxDef& gears = def.gearbox;
    const bool apart = d.gearbox.shiftTimer > 0 && gears.coupling == CouplingType::clutch;
    const float ratio = driven(def) > 0 ? gearing(gears, d.gearbox) / meanRadius : 0;  // rad/s per m/s
    const float limiter = radiansPerSecond(def.engine.limiterRpm), shaft = ratio * speed;
    const float share = apart || ratio == 0 ? 0 : 1 - driver.clutch;
    const float holds = share > 0 ? launchSpeed(def.engine, driver.throttle) : idleSpeed(def.engine);
    d.engineSpeed = clampTo(share > 0 ? shaft : 0, holds, std::max(limiter, holds));
    d.boost = boostAfter(def.engine, d.boost, driver.throttle, h);
    const EngineLimits limits = engineLimits(def.engine, d.engineSpeed, driver.throttle, d.boost, limiter, h);
    const bool locked = share > 0 && shaft >= holds;
    d.engine = {limits.throttle / h, 0, locked ? -limits.friction / h : 0};
    d.clutch = share * (d.engine.throttle + d.engine.friction);

    float drive = share * limits.throttle * ratio * gears.efficiency;
    float resist = locked ? share * limits.friction * std::abs(ratio) * gears.efficiency : 0;
    resist += h * road.resistance * road.weight;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        resist += h * brakeCapacity(def.wheels[i], driver.brake, driver.handbrake, 0) / specs[i].radius;
        if (i < driver.wheelTorques.size()) drive += h * driver.wheelTorques[i] / specs[i].radius;
    }
    const float grip = h * road.forwardFriction * road.weight;
    const float inertia = mass + ride.turning + (locked ? def.engine.inertia * ratio * ratio : 0);
    const float free = speed + (clampTo(drive, -grip, grip) + road.air + h * mass * road.downhill) / inertia;
    const float held = std::min(resist, grip) / inertia;
    const float next = std::abs(free) <= held ? 0 : free - (free > 0 ? held : -held);
    const float fastest = ratio != 0 ? limiter / std::abs(ratio) : 0;
    if (!(share > 0) || !(drive * speed > 0) || !(std::abs(next) > fastest)) return next;
    const float most = std::max(fastest, std::min(std::abs(speed), std::abs(next)));
    return next > 0 ? most : -most;
}

void VehicleSim::rollWheels(float speed, float h) {
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        WheelState& wheel = wheels[i];
        const float spin = speed / specs[i].radius;
        drivetrain.spin[i] = spin;
        wheel.rotation += h * spin;
        wheel.rotation -= 2 * kPi * std::floor((wheel.rotation + kPi) / (2 * kPi));
        wheel.touching = wheel.ground.found;
        wheel.load = wheel.touching != 0 ? specs[i].staticLoad : 0;
        peakLoads[i] = wheel.load;
        wheel.bend({});
        wheel.force = {};
        wheel.compression = wheel.hubSpeed = wheel.settleTime = wheel.inclination = wheel.aligning = 0;
        wheel.travel = {speed, 0};
        if (i > 0) wheel.squash = 0;
    }
}

BicycleRoad VehicleSim::roadBelow(const Pose& pose, const Vec3& velocity, float h) const {
    const GroundPlane& ground = wheels[0].ground;
    const Vec3 ahead = rotate(pose.rotation, {0, 0, 1}), fall = world->settings().gravity;
    BicycleRoad road;
    road.normal = ground.found != 0 ? ground.normal : rotate(pose.rotation, {0, 1, 0});
    road.forward = normalized(ahead - dot(ahead, road.normal) * road.normal, ahead);
    road.left = cross(road.normal, road.forward);
    road.air = dot(airImpulse(def.aerodynamics, lifts, {velocity - driver.wind, pose.rotation, 1 / mass}, h).linear,
                   road.forward);
    road.downhill = dot(fall, road.forward);
    if (ground.found == 0) return road;
    road.weight = mass * std::max(-dot(fall, road.normal), 0.0f);
    const TireGround under = groundOf(0);
    road.forwardFriction = under.grip * ride.forwardFriction;
    road.sideFriction = under.grip * ride.sideFriction;
    road.resistance = specs[0].tire.def.rollingResistance + under.drag;
    return road;
}

/// (w, r) after h at a speed, by tires that hold no more than friction lets them.
LateralMotion<float> VehicleSim::steerAlong(const BicycleRoad& road, const LateralMotion<float>& from, float speed,
                                            float acceleration, float h) const {
    const SinCos turned = sinCos(steerAngle);
    const float most = road.sideFriction * road.weight / mass;
    LateralMotion<float> to;
    if (std::abs(speed) < kRolls) {
        to = rollingMotion(ride.car, speed, turned.sin / turned.cos);
    } else if (road.weight > 0) {
        const float shifts = clampTo(acceleration, -0.9f * ride.car.most, 0.9f * ride.car.most);
        to = lateralAfter(lateralLaw(ride.car, speed, shifts, steerAngle), from, h);
    } else {
        to = from;
    }
    const float fastest = most / std::max(std::abs(speed), 1e-3f), slide = kMostSlide * std::abs(speed);
    if (road.weight > 0) to.yaw = clampTo(to.yaw, -fastest, fastest);
    to.side = clampTo(to.side, -slide, slide);
    return to;
}

/// Leads the chassis through a step: at the mean of the velocities before and after it, so that a car on a circle stays
/// there; it has the latter when the step is over.
void VehicleSim::rideBicycle(float h) {
    const Pose pose = world->pose(chassis);
    if (wheels[0].isPut()) seekBelow(pose);
    const Vec3 velocity = world->linearVelocity(chassis), turning = world->angularVelocity(chassis);
    const BicycleRoad road = roadBelow(pose, velocity, h);
    const float along = dot(velocity, road.forward), side = dot(velocity, road.left);
    const float speed = (along < 0 ? -1.0f : 1.0f) * std::sqrt(along * along + side * side);

    const float next = pushAlong(road, speed, h), mean = 0.5f * (speed + next);
    const LateralMotion<float> before{side, dot(turning, road.normal)};
    const LateralMotion<float> after = steerAlong(road, before, mean, (next - speed) / h, h);
    // The angle of drift is kept by what changes the speed.
    const float drift = std::abs(mean) > 1e-3f ? after.side / mean : 0;
    const float ahead = next / std::sqrt(1 + drift * drift), aside = drift * ahead;

    const GroundPlane& ground = wheels[0].ground;
    const Vec3 up = rotate(pose.rotation, {0, 1, 0}), fall = world->settings().gravity;
    const float over =
        ground.found != 0 ? dot(relative(transformPoint(pose, ride.foot), ground.point), road.normal) : 0;
    const float rising = dot(velocity, road.normal), freely = rising + h * dot(fall, road.normal);
    const float climbs = ground.found != 0 ? std::max(settled({rising, 0, 0}, {over, 0, 0}, h).x, freely) : freely;
    const Vec3 leans = ride.rolls * mean * after.yaw * road.left + ride.pitches / h * (next - speed) * road.forward;
    const Vec3 tilting = settled(turning - before.yaw * road.normal, -cross(up, normalized(road.normal - leans)), h);

    const float turn = 0.5f * (before.yaw + after.yaw);
    const auto led = [&](float angle, float forward, float left) {
        const SinCos to = sinCos(angle);
        return (forward * to.cos - left * to.sin) * road.forward + (forward * to.sin + left * to.cos) * road.left +
               climbs * road.normal;
    };
    endVelocity = led(h * turn, ahead, aside);
    endTurning = tilting + after.yaw * road.normal;
    unseen += h * std::abs(mean);
    rollWheels(next, h);
    const bool still = next == 0 && length(endVelocity) + ride.wheelbase * length(endTurning) < kStopped;
    if (still || !holds(endVelocity, endTurning)) {
        if (!still) forgetMotion();
        endVelocity = endTurning = {};
        return leadTo({}, {});
    }
    leadTo(led(0.5f * h * turn, 0.5f * (along + ahead), 0.5f * (side + aside)), tilting + turn * road.normal);
}

/// What stands and is to stand may fall asleep.
void VehicleSim::leadTo(const Vec3& velocity, const Vec3& turning) {
    if (velocity == world->linearVelocity(chassis) && turning == world->angularVelocity(chassis)) return;
    world->setVelocity(chassis, velocity, turning);
}

}  // namespace ragtop
