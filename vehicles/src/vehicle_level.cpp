#include "vehicle_level.h"

#include <cmath>
#include <stdexcept>

#include "ragtop/driver.h"
#include "vehicle_sim.h"

namespace ragtop {
namespace {

/// N m/rad by which struts and tires resist a lean of wheels apart along an axis.
float stiffnessAbout(const std::vector<WheelSpec>& wheels, const Vec3& center, int along) {
    float sum = 0;
    for (const WheelSpec& wheel : wheels) {
        const StrutSpec& strut = wheel.strut;
        const float apart = (wheel.position - center)[along];
        const float other = (wheels[wheel.barPartner].position - center)[along];
        const float bar = wheel.barStiffness * (apart - other) * apart;
        sum += apart * apart * strut.stiffness * strut.tireStiffness / (strut.stiffness + strut.tireStiffness) + bar;
    }
    return sum;
}

/// Rad per m/s² of a weight on springs that its own lean loads too; none where these cannot hold it.
float leanOf(float moment, float weight, float stiffness) {
    return stiffness > weight ? moment / (stiffness - weight) : 0;
}

}  // namespace

BicycleSpec makeRide(const VehicleDef& def, const MassProperties& mass, const std::vector<WheelSpec>& wheels) {
    BicycleSpec ride;
    std::vector<BicycleAxle<float>> axles;
    float ground = 0, load = 0;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const WheelDef& wheel = def.wheels[i];
        const TireNumbers tire = tireNumbers(wheel.tire, wheels[i].staticLoad);
        axles.push_back(
            {wheel.position.z - mass.center.z, wheels[i].staticLoad, tire.corneringStiffness, wheel.steerFactor});
        ground += (wheel.position.y - wheel.radius) / static_cast<float>(wheels.size());
        load += wheels[i].staticLoad;
        ride.forwardFriction += wheels[i].staticLoad * tire.longitudinalFriction;
        ride.sideFriction += wheels[i].staticLoad * tire.lateralFriction;
        ride.turning += 0.75f * wheel.mass;
    }
    ride.forwardFriction /= load;
    ride.sideFriction /= load;
    ride.wheelbase = wheelbase(def);
    ride.foot = {mass.center.x, ground, mass.center.z};
    const float height = mass.center.y - ground;
    ride.car = makeBicycle<float>(axles, mass.mass, mass.inertia.cy.y, height);
    ride.rolls = leanOf(mass.mass * height, load * height, stiffnessAbout(wheels, mass.center, 0));
    ride.pitches = leanOf(mass.mass * height, load * height, stiffnessAbout(wheels, mass.center, 2));
    return ride;
}

/// Below level 2 nothing meets a wheel but the ray that is it.
Filter VehicleSim::filterOf(std::size_t shape) const {
    if (shape < def.chassis.shapes.size() || def.level >= VehicleLevel::full) return def.chassis.filter;
    return {.category = 0, .mask = 0};
}

void VehicleSim::takeFilters() {
    const auto shapes = world->shapes(chassis);
    for (std::size_t i = 0; i < shapes.size(); ++i) world->setFilter(shapes[i], filterOf(i));
}

/// Of a body as it is made, for the full car.
void VehicleSim::takeLevel() {
    if (def.level >= VehicleLevel::full) return;
    takeFilters();
    if (def.level == VehicleLevel::bicycle) world->setType(chassis, BodyType::kinematic);
}

namespace {

void requireCarriers(const VehicleDef& def) {
    if (const std::string why = whyNoCarriers(def); !why.empty())
        throw std::invalid_argument("vehicle " + def.name + ": " + why);
}

}  // namespace

void VehicleSim::setLevel(VehicleLevel level) {
    const VehicleLevel before = def.level;
    if (level == before || !world->isValid(chassis)) return;
    if (level == VehicleLevel::linkages) requireCarriers(def);
    // Refuses within a step, whatever the type.
    world->setType(chassis, before == VehicleLevel::bicycle ? BodyType::kinematic : BodyType::dynamic);
    if (before == VehicleLevel::linkages) removeCarriers();
    world->setType(chassis, level == VehicleLevel::bicycle ? BodyType::kinematic : BodyType::dynamic);
    // What the chassis has not got yet it gets at once.
    const Vec3 velocity = world->linearVelocity(chassis) + (1 / mass) * carried.linear;
    const Mat3 inverse = rotated(inverseInertia, world->pose(chassis).rotation);
    world->setVelocity(chassis, velocity, world->angularVelocity(chassis) + inverse * carried.angular);
    carried = {};
    def.level = level;
    takeDef();
    takeFilters();
    for (WheelState& wheel : wheels) {
        wheel.ahead.found = 0;
        wheel.below = 0;
    }
    if (level == VehicleLevel::linkages) {
        if (before == VehicleLevel::bicycle) standOnGround();
        makeCarriers();
    }
    if (before == VehicleLevel::bicycle) leaveBicycle();
    if (level == VehicleLevel::bicycle) wheels[0].squash = WheelState::kPut;
    world->wake(chassis);
    stale = true;
}

/// Springs as far as wheels on the ground compress them, before there are carriers.
void VehicleSim::standOnGround() {
    def.level = VehicleLevel::full;
    const Pose pose = world->pose(chassis);
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        WheelState& wheel = wheels[i];
        wheel.compression = wheel.hubSpeed = 0;
        // Twice, because the contact goes along a curve.
        for (int pass = 0; pass < 2; ++pass) {
            lines[i] = lineNow(i);
            patches[i].axle = rotate(pose.rotation, lines[i].axle);
            if (placePatch(i, pose, world->centerOfMass(chassis)))
                wheel.compression = clampTo(patches[i].rise, specs[i].strut.travelLeast, specs[i].strut.travelMost);
        }
    }
    def.level = VehicleLevel::linkages;
}

/// Wheels stand under their static loads, and tires are bent as they roll: u = −σ s/V.
void VehicleSim::leaveBicycle() {
    const Pose pose = world->pose(chassis);
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        WheelState& wheel = wheels[i];
        wheel.squash = WheelState::kPut;
        if (wheel.ground.found == 0) continue;
        const WheelLine line = lineNow(i);
        const Vec3 axle = rotate(pose.rotation, line.axle);
        const DVec3 hub = transformPoint(pose, line.hub);
        const Vec3 velocity = world->velocityAt(chassis, hub - DVec3(specs[i].radius * wheel.ground.normal));
        const float along = length(velocity - dot(velocity, axle) * axle), across = dot(velocity, axle);
        const float speed = std::max(along, specs[i].tire.swaySpeed);
        wheel.bend({0, -specs[i].tire.def.relaxationLength * across / speed});
    }
}

}  // namespace ragtop
