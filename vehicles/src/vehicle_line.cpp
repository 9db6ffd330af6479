#include <cmath>

#include "chassis.h"
#include "steering.h"
#include "vehicle_sim.h"

namespace ragtop {

/// Of wheels as they are made, on struts.
void VehicleSim::findGuides() {
    for (std::size_t k = 0; k < linkages.size(); ++k) {
        const AxleWheels& both = linkages[k].wheels;
        for (const std::size_t i : {both.left, both.right}) {
            specs[i].linkage = static_cast<int>(k);
            specs[i].isRight = i == both.right;
            if (linkages[k].solid) specs[i].beamPartner = both.left + both.right - i;
        }
    }
    for (std::size_t k = 0; k < carrierSpecs.size(); ++k) {
        for (const CarriedWheel& held : carrierSpecs[k].wheels) {
            specs[held.wheel].carrier = k;
            specs[held.wheel].hubOnCarrier = held.hub;
            specs[held.wheel].axleOnCarrier = held.axle;
        }
    }
}

/// Of a wheel with a linkage.
const SuspensionCurves& VehicleSim::curvesOf(std::size_t i) const {
    return linkages[static_cast<std::size_t>(specs[i].linkage)].curves[specs[i].isRight ? 1 : 0];
}

/// What else moves the wheel: the other wheel of its beam, or a rack.
float VehicleSim::otherOf(std::size_t i) const {
    const WheelSpec& spec = specs[i];
    if (spec.beamPartner != i) return wheels[spec.beamPartner].compression;
    return def.wheels[i].steerFactor * steerAngle * linkages[static_cast<std::size_t>(spec.linkage)].rackTravel;
}

WheelCurve VehicleSim::curveOf(std::size_t i) const {
    return specs[i].linkage < 0 ? WheelCurve{} : curvesOf(i).with(otherOf(i));
}

WheelLine VehicleSim::lineOf(std::size_t i, const Vec3& ahead, const WheelCurve& curve) const {
    const WheelSpec& spec = specs[i];
    const float risen = wheels[i].compression;
    WheelLine line;
    line.hub = spec.position + risen * spec.axis;
    line.base = spec.position;
    line.along = line.axis = spec.axis;
    line.axle = {ahead.z, 0, -ahead.x};
    if (spec.linkage < 0) return line;
    const WheelGuide guide = curve.at(risen);
    line.hub = spec.position + guide.hub;
    line.base = line.hub - risen * guide.hubRate;
    line.along = normalized(guide.hubRate, spec.axis);
    line.axis = guide.hubRate;
    line.axle = guide.axle;
    line.tilting = cross(guide.axle, guide.axleRate);
    line.spinRate = guide.spinRate;
    if (hasCarriers()) takeCarrier(i, line);
    if (spec.beamPartner == i) return line;
    // As it goes with the other coordinate, which is a curve too: its values are rates.
    const WheelCurve change = curvesOf(i).changeWith(otherOf(i));
    line.crossAxis = change.values(risen, 0);
    line.crossTilting = cross(guide.axle, change.values(risen, 3));
    return line;
}

/// Into which a wheel on a strut rolls, unit, in the chassis.
Vec3 VehicleSim::headingOf(std::size_t i) const {
    return wheelDirection(def.steering, def.wheels[i].steerFactor, specs[i].steerArm, steerAngle);
}

/// For those that ask between steps.
WheelLine VehicleSim::lineNow(std::size_t i) const { return lineOf(i, headingOf(i), curveOf(i)); }

void VehicleSim::takeLine(std::size_t i) {
    if (specs[i].beamPartner != i) curves[i] = curveOf(i);
    lines[i] = lineOf(i, aheads[i], curves[i]);
}

/// As the rack is through the step.
void VehicleSim::steerWheels() {
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        aheads[i] = headingOf(i);
        if (specs[i].linkage >= 0) curves[i] = curveOf(i);
        takeLine(i);
    }
}

/// The hub with its steering, without its rotation.
Pose VehicleSim::wheelFrame(std::size_t i, const Pose& pose) const {
    const WheelLine line = lineNow(i);
    return pose * Frame{line.hub, wheelRotation(line.axle)};
}

}  // namespace ragtop
