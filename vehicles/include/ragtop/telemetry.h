#pragma once

#include <string_view>

#include "ragtop/vehicle.h"

/// All that a car tells of itself, declared once: tables, plots and programs go through these lists.
namespace ragtop {

struct TelemetryChannel {
    std::string_view name, unit, meaning;
};

/// Calls visit(channel, value as double) for each number that a wheel tells.
template <class Visit>
void forEachChannel(const WheelTelemetry& wheel, Visit&& visit) {
    const auto tell = [&](std::string_view name, std::string_view unit, std::string_view meaning, auto value) {
        visit(TelemetryChannel{name, unit, meaning}, static_cast<double>(value));
    };
    tell("grounded", "1", "1 where it touches the ground", wheel.grounded);
    tell("load", "N", "normal to the ground", wheel.load);
    tell("peakLoad", "N", "the largest within the last step", wheel.peakLoad);
    tell("longitudinalForce", "N", "of the tire on the car, forward", wheel.longitudinalForce);
    tell("lateralForce", "N", "of the tire on the car, to the left", wheel.lateralForce);
    tell("aligningMoment", "N m", "of the tire on the car about the ground's normal, to the left",
         wheel.aligningMoment);
    tell("gripUsed", "1", "share of the largest friction that the tire uses", wheel.gripUsed);
    tell("slipRatio", "1", "tread less travel speed, over the larger of them or 1 m/s", wheel.slipRatio);
    tell("slipAngle", "rad", "from the heading to the travel, to the left", wheel.slipAngle);
    tell("slipPower", "W", "that the patch turns into heat", wheel.slipPower);
    tell("deflectionForward", "m", "of the tread in the patch", wheel.deflectionForward);
    tell("deflectionLeft", "m", "of the tread in the patch", wheel.deflectionLeft);
    tell("travelForward", "m/s", "of the patch over the ground", wheel.travelForward);
    tell("travelLeft", "m/s", "of the patch over the ground", wheel.travelLeft);
    tell("treadSpeed", "m/s", "of the tread around the axle", wheel.angularSpeed * wheel.radius);
    tell("angularSpeed", "rad/s", "forward", wheel.angularSpeed);
    tell("rotation", "rad", "about the axle", wheel.rotation);
    tell("brakeTorque", "N m", "of pads and rolling resistance on the wheel", wheel.brakeTorque);
    tell("brakeTemperature", "K", "of disc and pads over the air", wheel.brakeTemperature);
    tell("steerAngle", "rad", "to the left", wheel.steerAngle);
    tell("camber", "rad", "of the wheel to the normal of the ground; its top to the left", wheel.camber);
    tell("compression", "m", "of the strut, above its place at rest", wheel.compression);
    tell("springForce", "N", "of spring and stops, along the strut", wheel.springForce);
    tell("damperForce", "N", "of the damper, along the strut; positive presses the wheel down", wheel.damperForce);
    tell("antiRollForce", "N", "of the anti-roll bar, likewise", wheel.antiRollForce);
    tell("tireSquash", "m", "by which the load has pressed the tire in", wheel.tireSquash);
    tell("surface", "1", "Material::surface that it stands on", wheel.surface);
}

/// The same of the car as a whole, without its wheels.
template <class Visit>
void forEachChannel(const VehicleTelemetry& car, Visit&& visit) {
    const auto tell = [&](std::string_view name, std::string_view unit, std::string_view meaning, auto value) {
        visit(TelemetryChannel{name, unit, meaning}, static_cast<double>(value));
    };
    tell("speed", "m/s", "forward", car.speed);
    tell("sideSpeed", "m/s", "to the left", car.sideSpeed);
    tell("climbSpeed", "m/s", "upwards in the world", car.climbSpeed);
    tell("yawRate", "rad/s", "about the car's up axis, to the left", car.yawRate);
    tell("pitchRate", "rad/s", "about the axis to the left, nose down", car.pitchRate);
    tell("rollRate", "rad/s", "about the axis forward, to the right", car.rollRate);
    tell("heading", "rad", "from z to the left", car.heading);
    tell("pitch", "rad", "nose down", car.pitch);
    tell("roll", "rad", "to the right", car.roll);
    tell("kineticEnergy", "J", "of the chassis", car.kineticEnergy);
    tell("drag", "N", "of the air", car.drag);
    tell("lift", "N", "of the air, across its flow", car.lift);
    tell("sideForce", "N", "of the air, to the left", car.sideForce);
    tell("rpm", "rpm", "of the engine", car.engine.rpm);
    tell("engineTorque", "N m", "at the flywheel", car.engine.torque);
    tell("enginePower", "W", "at the flywheel", car.engine.power);
    tell("clutchTorque", "N m", "from the engine into the gearbox", car.clutchTorque);
    tell("gear", "1", "-1 reverse, 0 neutral", car.gear);
    tell("shifting", "1", "1 between two gears", car.shifting);
    tell("engineWork", "J", "since the start, net", car.energy.engine);
    tell("clutchLoss", "J", "since the start", car.energy.clutch);
    tell("gearLoss", "J", "since the start", car.energy.gears);
    tell("differentialLoss", "J", "since the start", car.energy.differentials);
    tell("brakeLoss", "J", "of pads, since the start", car.energy.brakes);
    tell("rollingLoss", "J", "of tires and ground, since the start", car.energy.rolling);
    tell("slipLoss", "J", "of patches, since the start", car.energy.slip);
    tell("strutLoss", "J", "into struts and squashed tires, since the start", car.energy.struts);
    tell("airLoss", "J", "since the start", car.energy.air);
    tell("rotatingEnergy", "J", "of engine and wheels", car.energy.rotating);
    tell("elasticEnergy", "J", "of springs, stops, bars, squashed tires and bent treads", car.energy.elastic);
    tell("throttle", "1", "pedal in the last step", car.throttle);
    tell("brake", "1", "pedal in the last step", car.brake);
    tell("handbrake", "1", "lever in the last step", car.handbrake);
    tell("clutch", "1", "pedal in the last step", car.clutch);
    tell("steerAngle", "rad", "of a wheel in the middle of the front axle, to the left", car.steerAngle);
}

}  // namespace ragtop
