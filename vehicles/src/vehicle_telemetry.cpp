#include <algorithm>
#include <cmath>

#include "vehicle_sim.h"

namespace ragtop {
namespace {

/// m/s, the lowest speed over which slip is told, as in tire property files (VXLOW): what sways on standing tires does
/// not travel, and slip over its speed is any number.
constexpr float kSlowest = 1;

float share(float part, float carMass) { return carMass > 0 ? part / carMass : 0; }

/// Share of the ellipse of (4) in tire.h, with the largest frictions.
float gripUsed(const WheelState& wheel, const TireSpec& tire, const TireGround& ground) {
    const float x = share(wheel.force.x, ground.grip * tire.friction.x * wheel.load);
    const float y = share(wheel.force.y, ground.grip * tire.friction.y * wheel.load);
    return std::sqrt(x * x + y * y);
}

}  // namespace

/// Telemetry is worked out when somebody asks for it, by the first of those that do.
const VehicleTelemetry& VehicleSim::tell() {
    if (stale.load(std::memory_order_acquire)) {
        const std::lock_guard<std::mutex> lock(telling);
        if (stale.load(std::memory_order_relaxed) && isThere()) refreshTelemetry();
        stale.store(false, std::memory_order_release);
    }
    return telemetry;
}

void VehicleSim::refreshTelemetry() {
    const Pose pose = world->pose(chassis);
    tellMotion(pose);
    telemetry.engine.rpm = revolutionsPerMinute(drivetrain.engineSpeed);
    telemetry.engine.torque = drivetrain.engine.throttle + drivetrain.engine.idle + drivetrain.engine.friction;
    telemetry.engine.power = telemetry.engine.torque * drivetrain.engineSpeed;
    telemetry.gear = drivetrain.gearbox.gear;
    telemetry.shifting = drivetrain.gearbox.shiftTimer > 0;
    telemetry.clutchTorque = drivetrain.clutch;
    tellEnergy();
    telemetry.throttle = driver.throttle;
    telemetry.brake = driver.brake;
    telemetry.handbrake = driver.handbrake;
    telemetry.clutch = driver.clutch;
    telemetry.steerAngle = steerAngle;
    for (std::size_t i = 0; i < wheels.size(); ++i) tellWheel(i, pose);
}

void VehicleSim::tellMotion(const Pose& pose) {
    const Vec3 velocity = world->velocityAt(chassis, transformPoint(pose, carMass.center)),
               turning = world->angularVelocity(chassis);
    const Vec3 left = rotate(pose.rotation, {1, 0, 0}), up = rotate(pose.rotation, {0, 1, 0}),
               forward = rotate(pose.rotation, {0, 0, 1});
    telemetry.speed = dot(velocity, forward);
    telemetry.sideSpeed = dot(velocity, left);
    telemetry.climbSpeed = velocity.y;
    telemetry.yawRate = dot(turning, up);
    telemetry.pitchRate = dot(turning, left);
    telemetry.rollRate = dot(turning, forward);
    telemetry.heading = arcTan2(forward.x, forward.z);
    telemetry.pitch = arcTan2(-forward.y, std::sqrt(forward.x * forward.x + forward.z * forward.z));
    telemetry.roll = arcTan2(left.y, up.y);
    const Vec3 spin = inverseRotate(pose.rotation, turning);
    telemetry.kineticEnergy = 0.5f * (mass * dot(velocity, velocity) + dot(spin, carMass.inertia * spin));
    const AerodynamicsDef& air = def.aerodynamics;
    const Vec3 flow = velocity - driver.wind;
    const float speed = length(flow), pressure = 0.5f * air.airDensity * speed * speed;
    telemetry.drag = pressure * air.dragArea;
    telemetry.sideForce = -0.5f * air.airDensity * air.sideArea * speed * dot(flow, left);
    telemetry.lift = 0;
    for (const LiftPoint& lift : lifts) telemetry.lift += pressure * lift.area;
}

void VehicleSim::tellWheel(std::size_t i, const Pose& pose) {
    const WheelState& wheel = wheels[i];
    const WheelSpec& spec = specs[i];
    WheelTelemetry& out = wheelTelemetry[i];
    const float tread = drivetrain.spin[i] * spec.radius;
    const float along = std::abs(wheel.travel.x), across = wheel.travel.y;
    const float travel = std::sqrt(along * along + across * across);
    out.radius = spec.radius;
    out.grounded = wheel.touching != 0;
    out.load = wheel.load;
    out.peakLoad = peakLoads[i];
    out.longitudinalForce = wheel.force.x;
    out.lateralForce = wheel.force.y;
    out.aligningMoment = wheel.aligning;
    out.gripUsed = gripUsed(wheel, spec.tire, groundOf(i));
    const float larger = std::max({std::abs(tread), along, kSlowest});
    out.slipRatio = out.grounded ? (tread - wheel.travel.x) / larger : 0;
    out.slipAngle = out.grounded ? arcTan2(wheel.travel.y, along + std::max(kSlowest - travel, 0.0f)) : 0;
    out.slipPower = wheel.force.x * (tread - wheel.travel.x) - wheel.force.y * wheel.travel.y;
    out.deflectionForward = wheel.deflection.x;
    out.deflectionLeft = wheel.deflection.y;
    out.travelForward = wheel.travel.x;
    out.travelLeft = wheel.travel.y;
    out.angularSpeed = drivetrain.spin[i];
    out.rotation = wheel.rotation;
    out.brakeTorque = drivetrain.brake[i];
    out.brakeTemperature = drivetrain.brakeWarmth(def.wheels[i], i);
    const Vec3 axle = lineNow(i).axle;
    out.steerAngle = arcTan2(-axle.z, axle.x);
    out.compression = wheel.compression;
    out.springForce = springForce(spec.strut, wheel.compression);
    out.damperForce = damperForce(spec.strut, wheel.hubSpeed);
    out.antiRollForce = spec.barStiffness * (wheel.compression - wheels[spec.barPartner].compression);
    out.tireSquash = squashUnder(spec.strut, wheel.load);
    out.contactNormal = wheel.ground.normal;
    out.ground = out.grounded ? wheel.ground.body : BodyId{};
    out.surface = wheel.ground.surface;
    out.pose = wheelFrame(i, pose);
    const float lean = clampTo(dot(rotate(out.pose.rotation, {1, 0, 0}), out.contactNormal), -1, 1);
    out.camber = out.grounded ? arcTan2(-lean, std::sqrt(1 - lean * lean)) : 0;
    out.contactPoint = out.pose.position - (spec.radius + spec.strut.tireSquash - out.tireSquash) * out.contactNormal;
    out.pose.rotation = out.pose.rotation * rotationAbout({1, 0, 0}, wheel.rotation);
}

}  // namespace ragtop
