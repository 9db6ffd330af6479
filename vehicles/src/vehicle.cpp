#include "ragtop/vehicle.h"

#include <cmath>
#include <stdexcept>

#include "chassis.h"
#include "vehicle_sim.h"

namespace ragtop {
namespace {

constexpr float kStandardGravity = 9.81f;  ///< m/s², for the springs of a car in a world without gravity

/// The middle of the wheels that do not steer, about which the others are angled; of all if every wheel steers.
Vec3 steeringCenter(const VehicleDef& def) {
    Vec3 fixed, all;
    float count = 0;
    for (const WheelDef& wheel : def.wheels) {
        all += wheel.position;
        if (wheel.steerFactor != 0) continue;
        fixed += wheel.position;
        count += 1;
    }
    return count > 0 ? (1 / count) * fixed : (1 / static_cast<float>(def.wheels.size())) * all;
}

/// Mean radius of the driven wheels; of all where none is driven.
float drivenRadius(const VehicleDef& def) {
    float sum = 0, weight = 0, all = 0;
    for (const WheelDef& wheel : def.wheels) {
        sum += wheel.driveShare * wheel.radius;
        weight += wheel.driveShare;
        all += wheel.radius;
    }
    return weight > 0 ? sum / weight : all / static_cast<float>(def.wheels.size());
}

StepModule moduleOf(VehicleSim& sim) {
    StepModule module;
    module.user = &sim;
    module.name = "vehicle";
    module.beforeStep = [](void* user, World& world, double dt) {
        auto& self = *static_cast<VehicleSim*>(user);
        self.world = &world;
        self.beforeStep(dt);
    };
    module.beforeSubstep = [](void* user, World&, double h) {
        static_cast<VehicleSim*>(user)->beforeSubstep(static_cast<float>(h));
    };
    module.afterStep = [](void* user, World&, double) { static_cast<VehicleSim*>(user)->afterStep(); };
    module.saveSize = [](const void* user) { return static_cast<const VehicleSim*>(user)->saveSize(); };
    module.save = [](const void* user, std::span<std::byte> into) { static_cast<const VehicleSim*>(user)->save(into); };
    module.restore = [](void* user, std::span<const std::byte> from) { static_cast<VehicleSim*>(user)->restore(from); };
    module.hash = [](const void* user) { return static_cast<const VehicleSim*>(user)->hash(); };
    return module;
}

WheelSpec wheelSpec(const WheelDef& wheel, const Vec3& steeringCenter, float load, float gravity) {
    WheelSpec spec;
    spec.position = wheel.position;
    spec.axis = normalized(wheel.suspension.axis);
    spec.steerArm = wheel.position - steeringCenter;
    spec.radius = wheel.radius;
    spec.halfWidth = 0.5f * wheel.width;
    spec.staticLoad = load;
    spec.strut = makeStrut(wheel.suspension, load, gravity);
    spec.tire = makeTireSpec(wheel.tire, load, gravity);
    return spec;
}

}  // namespace

VehicleSim::VehicleSim(World& inWorld, const VehicleDef& inDef, const VehiclePlacement& placement)
    : world(&inWorld), def(inDef) {
    if (const std::string why = whyInvalid(def); !why.empty()) {
        throw std::invalid_argument("vehicle " + def.name + ": " + why);
    }
    if (!isFinite(placement.position) || !std::isfinite(placement.heading) || !std::isfinite(placement.speed)) {
        throw std::invalid_argument("vehicle " + def.name + ": a number of the placement is not finite, must be");
    }
    const MassProperties properties = chassisMass(def.chassis);
    mass = properties.mass;
    inverseInertia = inverseSymmetric(properties.inertia);
    gravity = length(world->settings().gravity);
    if (!(gravity > 0)) gravity = kStandardGravity;
    meanRadius = drivenRadius(def);

    std::vector<Vec3> positions;
    for (const WheelDef& wheel : def.wheels) positions.push_back(wheel.position - properties.center);
    loadsAtRest = staticLoads(positions, mass * gravity);
    const Vec3 center = steeringCenter(def);
    drivetrain = Drivetrain(def);
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        specs.push_back(wheelSpec(def.wheels[i], center, loadsAtRest[i], gravity));
        drivetrain.spin[i] = placement.speed / specs[i].radius;
    }
    drivetrain.startRolling(def, placement.speed / meanRadius);
    wheels.resize(specs.size());
    patches.resize(specs.size());
    grounds.resize(specs.size());
    loads.resize(specs.size());
    wheelTelemetry.resize(specs.size());
    telemetry.wheels = wheelTelemetry;

    chassis = world->create(chassisBody(def, placement));
    module = moduleOf(*this);
    world->add(&module);
    refreshTelemetry();
}

Vehicle::Vehicle(World& world, const VehicleDef& def, const VehiclePlacement& placement)
    : sim_(std::make_unique<VehicleSim>(world, def, placement)), input(sim_->input) {}

Vehicle::Vehicle(Vehicle&& other) noexcept : sim_(std::move(other.sim_)), input(sim_->input) {}

Vehicle::~Vehicle() {
    if (!sim_) return;
    sim_->world->remove(&sim_->module);
    if (sim_->world->isValid(sim_->chassis)) sim_->world->destroy(sim_->chassis);
}

BodyId Vehicle::chassis() const { return sim_->chassis; }
const VehicleDef& Vehicle::def() const { return sim_->def; }
const VehicleTelemetry& Vehicle::telemetry() const {
    if (sim_->stale) sim_->refreshTelemetry();
    return sim_->telemetry;
}
std::span<const float> Vehicle::staticLoads() const { return sim_->loadsAtRest; }

}  // namespace ragtop
