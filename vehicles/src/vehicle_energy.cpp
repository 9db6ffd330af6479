#include <algorithm>

#include "vehicle_sim.h"

namespace ragtop {
namespace {

double workOf(const Vec3& impulse, const Vec3& before, const Vec3& after) {
    return 0.5 * static_cast<double>(dot(impulse, before + after));
}

}  // namespace

Vec3 VehicleSim::patchSpeed(std::size_t i, const PointBody& body) const {
    const WheelPatch& patch = patches[i];
    return {speedAlong(patch.forwardRow, body, *patch.ground), speedAlong(patch.sideRow, body, *patch.ground),
            speedAlong(patch.normalRow, body, *patch.ground)};
}

/// What the patch has taken. Of the tire's impulse T at the mean slip, and of the load N at the mean speed of the
/// chassis over the ground, the strut having the part of T along it:
///
///     slip    −T · (v + lean ẋ + cross ẏ − r ω)
///     struts  −N n·v + ẋ lean·T + ẏ cross·T, ẏ of the other wheel of a beam
void VehicleSim::countPatch(std::size_t i, const PointBody& body, float hubSpeed, float otherSpeed) {
    const WheelPatch& patch = patches[i];
    const Vec3 mean = 0.5f * (patch.speedBefore + patchSpeed(i, body));
    const float tread = 0.5f * specs[i].radius * (patch.spinBefore + drivetrain.spin[i]);
    const Vec2 hub{patch.lean.x * hubSpeed + patch.cross.x * otherSpeed,
                   patch.lean.y * hubSpeed + patch.cross.y * otherSpeed};
    const float slipX = mean.x + hub.x - tread, slipY = mean.y + hub.y;
    lost.slip -= static_cast<double>(patch.tire.x * slipX + patch.tire.y * slipY);
    const float leaning = hub.x * patch.tire.x + hub.y * patch.tire.y;
    lost.struts += static_cast<double>(leaning - patch.load * mean.z);
}

/// What air and aligning moments have taken from the chassis.
void VehicleSim::countBody(const PointBody& before, const PointBody& after, const CarImpulse& air, const Vec3& turned) {
    lost.air -= workOf(air.linear, before.v, after.v) + workOf(air.angular, before.w, after.w);
    lost.slip -= workOf(turned, before.w, after.w);
}

/// Of bristles as they are now, by the slip that the last substep has found.
double VehicleSim::treadEnergy(std::size_t i) const {
    const WheelState& wheel = wheels[i];
    if (!(wheel.load > 0)) return 0;
    const float tread = specs[i].radius * drivetrain.spin[i];
    const TireLaw law = tireLaw(specs[i].tire, groundOf(i), {wheel.travel, tread}, wheel.load, wheel.transport);
    const Vec2 bent = rolledDeflection(law, wheel.deflection, {wheel.travel.x - tread, wheel.travel.y}, wheel.transport,
                                       wheel.settleTime);
    return static_cast<double>(wheel.load) * bentEnergy(law, beforePeak(law, withinPatch(law, bent)));
}

/// Of the impulse that the chassis gets in the next substep.
double VehicleSim::carriedEnergy() const {
    const Vec3 v = world->linearVelocity(chassis), w = world->angularVelocity(chassis);
    const Mat3 inverse = rotated(inverseInertia, world->pose(chassis).rotation);
    return workOf(carried.linear, v, v + (1 / mass) * carried.linear) +
           workOf(carried.angular, w, w + inverse * carried.angular);
}

/// What springs, bars and tires would give back.
double VehicleSim::elasticEnergy() const {
    if (def.level == VehicleLevel::bicycle) return 0;
    double sum = carriedEnergy();
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const StrutSpec& strut = specs[i].strut;
        const auto apart = static_cast<double>(wheels[i].compression - wheels[specs[i].barPartner].compression);
        // Wheels without mass fall away from springs that are slack, which then hold nothing.
        const float slack = -strut.load / strut.stiffness;
        const float compression = hasCarriers() ? wheels[i].compression : std::max(wheels[i].compression, slack);
        sum +=
            springEnergy(strut, compression) + squashEnergy(strut, squashUnder(strut, wheels[i].load)) + treadEnergy(i);
        // Each end of a bar has a half of it.
        sum += 0.25 * static_cast<double>(specs[i].barStiffness) * apart * apart;
    }
    return sum;
}

void VehicleSim::tellEnergy() {
    const DriveWork& work = drivetrain.work;
    telemetry.energy = {
        work.engine,    work.clutch, work.gears,  work.differentials, work.brakes,
        work.rolling,   lost.slip,   lost.struts, lost.air,           drivetrain.rotatingEnergy(def.engine),
        elasticEnergy()};
}

}  // namespace ragtop
