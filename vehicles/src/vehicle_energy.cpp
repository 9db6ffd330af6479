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
///     slip    −T · (v + lean ẋ − r ω)
///     struts  −N n·v + ẋ lean·T
void VehicleSim::countPatch(std::size_t i, const PointBody& body, float hubSpeed) {
    const WheelPatch& patch = patches[i];
    const Vec3 mean = 0.5f * (patch.speedBefore + patchSpeed(i, body));
    const float tread = 0.5f * specs[i].radius * (patch.spinBefore + drivetrain.spin[i]);
    const float slipX = mean.x + patch.lean.x * hubSpeed - tread, slipY = mean.y + patch.lean.y * hubSpeed;
    lost.slip -= static_cast<double>(patch.tire.x * slipX + patch.tire.y * slipY);
    const float leaning = patch.lean.x * patch.tire.x + patch.lean.y * patch.tire.y;
    lost.struts += static_cast<double>(hubSpeed * leaning - patch.load * mean.z);
}

/// What air and aligning moments have taken from the chassis.
void VehicleSim::countBody(const PointBody& before, const PointBody& after, const CarImpulse& air, const Vec3& turned) {
    lost.air -= workOf(air.linear, before.v, after.v) + workOf(air.angular, before.w, after.w);
    lost.slip -= workOf(turned, before.w, after.w);
}

void VehicleSim::tellEnergy() {
    const DriveWork& work = drivetrain.work;
    telemetry.energy = {
        work.engine,  work.clutch, work.gears,  work.differentials, work.brakes,
        work.rolling, lost.slip,   lost.struts, lost.air,           drivetrain.rotatingEnergy(def.engine)};
}

}  // namespace ragtop
