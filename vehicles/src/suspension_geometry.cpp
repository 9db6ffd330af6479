#include "ragtop/suspension_geometry.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "axle_linkage.h"

namespace ragtop {
namespace {

/// The contact of a wheel from its hub, over a ground that is level in the chassis.
DVec3 lowestOf(const DVec3& axle, double radius) {
    const DVec3 down = DVec3{0, -1, 0} + axle.y * axle;
    return (radius / length(down)) * down;
}

/// As the wheel rises alone, and, of a beam, as the other one goes down.
struct WheelRates {
    CarrierRate rise, roll;
};

CarrierRate operator-(const CarrierRate& a, const CarrierRate& b) { return {a.velocity - b.velocity, a.spin - b.spin}; }

/// Velocity of the contact, `arm` from the hub, of a wheel that rolls and so does not turn with its carrier.
DVec3 rollingAt(const CarrierRate& rate, const CarrierPlace& place, const DVec3& hub, const DVec3& axle,
                const DVec3& arm) {
    return LinkageSolver::velocityAt(rate, place, hub) + cross(cross(axle, cross(rate.spin, axle)), arm);
}

WheelPosture postureOf(const LinkageSolver& solver, const CarrierPlace& place, const WheelRates& rates, bool right,
                       double radius) {
    const CarrierRate& rate = rates.rise;
    WheelPosture posture;
    const double side = right ? -1 : 1;
    const DVec3 axle = solver.axle(place, right), turning = cross(rate.spin, axle);
    posture.hub = solver.hub(place, right);
    posture.contact = posture.hub + lowestOf(axle, radius);
    posture.camber = -side * std::asin(axle.y);
    posture.toe = side * std::atan2(axle.z, axle.x);
    posture.motionRatio = solver.springRate(rate, place);
    posture.camberRate = -side * turning.y / std::sqrt(1 - axle.y * axle.y);
    posture.toeRate = side * (turning.z * axle.x - turning.x * axle.z) / (axle.x * axle.x + axle.z * axle.z);
    const DVec3 arm = posture.contact - posture.hub;
    const DVec3 hub = LinkageSolver::velocityAt(rate, place, posture.hub);
    const DVec3 braked = LinkageSolver::velocityAt(rate, place, posture.contact);
    posture.rollCenter = posture.contact.x * rollingAt(rates.roll, place, posture.hub, axle, arm).x / hub.y;
    posture.brakeSlope = braked.z / hub.y;
    posture.driveSlope = hub.z / hub.y;
    if (const auto kingpin = solver.kingpin(place)) {
        const auto& [below, above] = *kingpin;
        const DVec3 axis = above - below, ground = below + ((posture.contact.y - below.y) / axis.y) * axis;
        posture.caster = std::atan2(-axis.z, axis.y);
        posture.kingpin = std::atan2(-axis.x, axis.y);
        posture.trail = ground.z - posture.contact.z;
        posture.scrub = posture.contact.x - ground.x;
    }
    return posture;
}

WheelPosture mirrored(WheelPosture posture) {
    posture.hub.x = -posture.hub.x;
    posture.contact.x = -posture.contact.x;
    return posture;
}

const LinkageDef& linkageOf(const VehicleDef& def, unsigned axle) {
    for (const LinkageDef& linkage : def.linkages)
        if (linkage.axle == axle) return linkage;
    throw std::invalid_argument("vehicle " + def.name + ": /linkages has none of axle " + std::to_string(axle) +
                                ", must have one");
}

LinkageSolver solverOf(const VehicleDef& def, unsigned axle) {
    const LinkageDef& linkage = linkageOf(def, axle);
    const std::string why = whyInvalid(def, linkage, static_cast<std::size_t>(&linkage - def.linkages.data()));
    if (!why.empty()) throw std::invalid_argument("vehicle " + def.name + ": " + why);
    return linkageSolver(def, linkage);
}

CarrierPlace placed(const LinkageSolver& solver, unsigned axle, const LinkageCoordinates& at) {
    if (const auto place = solver.reach(LinkageDrive::rise, at)) return *place;
    char text[160];
    std::snprintf(text, sizeof text, "the wheels of axle %u cannot rise by %.4g m and %.4g m with the rack at %.4g m",
                  axle, at.left, at.right, at.rack);
    throw std::invalid_argument(text);
}

}  // namespace

std::array<WheelPosture, 2> wheelPostures(const VehicleDef& def, unsigned axle, const AxlePlace& place) {
    const LinkageSolver solver = solverOf(def, axle);
    const auto radius = static_cast<double>(def.wheels[axleWheels(def, axle).left].radius);
    const LinkageCoordinates left{place.leftRise, place.rightRise, place.rack};
    const CarrierPlace at = placed(solver, axle, left);
    const auto rates = solver.rates(LinkageDrive::rise, at, left);
    if (solver.isSolid()) {
        const WheelRates leftRates{rates[0], rates[0] - rates[1]}, rightRates{rates[1], rates[1] - rates[0]};
        return {postureOf(solver, at, leftRates, false, radius), postureOf(solver, at, rightRates, true, radius)};
    }
    const LinkageCoordinates right{place.rightRise, place.rightRise, -place.rack};
    const CarrierPlace other = placed(solver, axle, right);
    const CarrierRate rate = solver.rates(LinkageDrive::rise, other, right)[0];
    return {postureOf(solver, at, {rates[0], rates[0]}, false, radius),
            mirrored(postureOf(solver, other, {rate, rate}, false, radius))};
}

double rackTravel(const VehicleDef& def, unsigned axle) { return rackPerAngle(solverOf(def, axle)); }

}  // namespace ragtop
