#include "ragtop/vehicle.h"

#include <cmath>
#include <stdexcept>

#include "chassis.h"
#include "definition_digest.h"
#include "vehicle_level.h"
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
    module.look = [](void* user, const World&, double dt) { return static_cast<VehicleSim*>(user)->look(dt); };
    module.beforeSubstep = [](void* user, World&, double h) {
        static_cast<VehicleSim*>(user)->beforeSubstep(static_cast<float>(h));
    };
    module.afterStep = [](void* user, World&, double) { static_cast<VehicleSim*>(user)->afterStep(); };
    module.saveSize = [](const void* user) { return static_cast<const VehicleSim*>(user)->saveSize(); };
    module.save = [](const void* user, std::span<std::byte> into) { static_cast<const VehicleSim*>(user)->save(into); };
    module.fits = [](const void* user, std::span<const std::byte> from) {
        return static_cast<const VehicleSim*>(user)->fits(from);
    };
    module.restore = [](void* user, std::span<const std::byte> from) { static_cast<VehicleSim*>(user)->restore(from); };
    module.hash = [](const void* user) { return static_cast<const VehicleSim*>(user)->hash(); };
    return module;
}

WheelSpec wheelSpec(const WheelDef& wheel, const Vec3& steeringCenter, float load, float gravity, VehicleLevel level) {
    WheelSpec spec;
    spec.position = wheel.position;
    spec.axis = normalized(wheel.suspension.axis);
    spec.steerArm = wheel.position - steeringCenter;
    spec.radius = wheel.radius;
    spec.halfWidth = 0.5f * wheel.width;
    spec.staticLoad = load;
    spec.strut = makeStrut(wheel, load, gravity);
    spec.tire = makeTireSpec(level >= VehicleLevel::full ? wheel.tire : asBrush(wheel.tire, load), load, gravity);
    return spec;
}

void requireUsable(const VehicleDef& def) {
    if (const std::string why = whyInvalid(def); !why.empty()) {
        throw std::invalid_argument("vehicle " + def.name + ": " + why);
    }
}

void requireFinite(const VehicleDef& def, const VehiclePlacement& placement) {
    if (isFinite(placement.position) && std::isfinite(placement.heading) && std::isfinite(placement.speed)) return;
    throw std::invalid_argument("vehicle " + def.name + ": a number of the placement is not finite, must be");
}

void requireSameParts(const VehicleDef& now, const VehicleDef& next) {
    const auto refuse = [&](const std::string& what) {
        throw std::invalid_argument("vehicle " + next.name + ": " + what);
    };
    const auto require = [&](const char* what, std::size_t has, std::size_t wants) {
        if (has == wants) return;
        refuse(std::string(what) + " has " + std::to_string(wants) + " elements, must keep " + std::to_string(has));
    };
    require("/wheels", now.wheels.size(), next.wheels.size());
    require("/chassis/shapes", now.chassis.shapes.size(), next.chassis.shapes.size());
    for (std::size_t i = 0; i < now.wheels.size(); ++i) {
        const std::string what = whyAnotherShape(now.wheels[i], next.wheels[i]);
        if (!what.empty()) refuse("/wheels/" + std::to_string(i) + what + ", because its shape is made with the car");
    }
}

bool sameMass(const MassProperties& a, const MassProperties& b) {
    return a.mass == b.mass && a.center == b.center && a.inertia.cx == b.inertia.cx && a.inertia.cy == b.inertia.cy &&
           a.inertia.cz == b.inertia.cz;
}

}  // namespace

VehicleSim::VehicleSim(World& inWorld, const VehicleDef& inDef, const VehiclePlacement& placement)
    : world(&inWorld), def(inDef) {
    requireUsable(def);
    requireFinite(def, placement);
    gravity = length(world->settings().gravity);
    if (!(gravity > 0)) gravity = kStandardGravity;
    linkages = axleLinkages(def);
    carrierSpecs = makeCarrierSpecs(def);
    carriers.resize(carrierSpecs.size());
    takeDef();
    start(placement.speed);
    patches.resize(specs.size());
    ways.resize(specs.size());
    courses.resize(specs.size());
    curves.resize(specs.size());
    lines.resize(specs.size());
    aheads.resize(specs.size());
    grounds.resize(specs.size());
    groundOfWheel.resize(specs.size());
    resistances.resize(specs.size());
    touched.reserve(specs.size() + 1);
    wheelTelemetry.resize(specs.size());
    telemetry.wheels = wheelTelemetry;

    chassis = world->create(chassisBody(def, placement));
    takeLevel();
    if (hasCarriers()) makeCarriers();
    module = moduleOf(*this);
    world->add(&module);
    refreshTelemetry();
}

/// What follows from the definition alone.
void VehicleSim::takeDef() {
    const MassProperties properties = chassisMass(def.chassis);
    carMass = properties;
    mass = properties.mass;
    inverseInertia = inverseSymmetric(properties.inertia);
    meanRadius = drivenRadius(def);
    lifts = liftPoints(def, properties.center);
    std::vector<Vec3> positions;
    for (const WheelDef& wheel : def.wheels) positions.push_back(wheel.position - properties.center);
    loadsAtRest = staticLoads(positions, mass * gravity);
    const Vec3 center = steeringCenter(def);
    specs.clear();
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        specs.push_back(wheelSpec(def.wheels[i], center, loadsAtRest[i], gravity, def.level));
        specs.back().beamPartner = i;
    }
    findGuides();
    if (hasCarriers()) {
        // Springs bear what they did: carriers stand on their tires.
        for (const CarrierSpec& spec : carrierSpecs)
            for (const CarriedWheel& held : spec.wheels)
                specs[held.wheel].strut.load -= gravity * spec.mass.mass / static_cast<float>(spec.wheels.size());
    }
    for (const AntiRollBarDef& bar : def.antiRollBars) takeBar(bar);
    ride = makeRide(def, properties, specs);
    digest = definitionDigest(def, properties, gravity);
}

/// Its axle has two wheels (whyInvalid).
void VehicleSim::takeBar(const AntiRollBarDef& bar) {
    std::vector<std::size_t> ends;
    for (std::size_t i = 0; i < specs.size(); ++i) {
        if (def.wheels[i].axle == bar.axle) ends.push_back(i);
    }
    specs[ends.front()].barPartner = ends.back();
    specs[ends.back()].barPartner = ends.front();
    specs[ends.front()].barStiffness = specs[ends.back()].barStiffness = bar.stiffness;
}

/// The state of a car that rolls at `speed` and has touched nothing yet.
void VehicleSim::start(float speed) {
    driver = {};
    steerAngle = 0;
    drivetrain = Drivetrain(def);
    for (std::size_t i = 0; i < specs.size(); ++i) drivetrain.spin[i] = speed / specs[i].radius;
    drivetrain.startRolling(def, speed / meanRadius);
    wheels.assign(specs.size(), {});
    peakLoads.assign(specs.size(), 0);
    carried = {};
    lost = {};
    unseen = 0;
}

void VehicleSim::setDef(const VehicleDef& next) {
    requireUsable(next);
    requireSameParts(def, next);
    const bool heavier = !sameMass(chassisMass(def.chassis), chassisMass(next.chassis));
    const auto shapes = world->shapes(chassis);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Material material = shapeMaterial(next, i);
        if (material != world->material(shapes[i])) world->setMaterial(shapes[i], material);
    }
    if (hasCarriers()) removeCarriers();
    const bool meetsOthers = next.chassis.filter != def.chassis.filter;
    const VehicleLevel level = def.level;
    def = next;
    def.level = level;
    if (meetsOthers) takeFilters();
    linkages = axleLinkages(def);
    carrierSpecs = makeCarrierSpecs(def);
    carriers.assign(carrierSpecs.size(), {});
    takeDef();
    drivetrain = Drivetrain(def, std::move(drivetrain));
    if (heavier) world->setMass(chassis, chassisMass(def.chassis));
    if (hasCarriers() && next.level == level) makeCarriers();
    setLevel(next.level);
    world->wake(chassis);
    stale = true;
}

void VehicleSim::place(const VehiclePlacement& placement) {
    requireFinite(def, placement);
    const BodyDef body = chassisBody(def, placement);
    if (hasCarriers()) removeCarriers();
    world->setPose(chassis, body.pose);
    world->setVelocity(chassis, body.linearVelocity, body.angularVelocity);
    start(placement.speed);
    if (hasCarriers()) makeCarriers();
    stale = true;
}

void VehicleSim::setVelocity(const Vec3& linear, const Vec3& angular) {
    const Pose pose = world->pose(chassis);
    if (hasCarriers()) followPose(pose);
    const DVec3 center = transformPoint(pose, carMass.center);
    const auto give = [&](BodyId body) {
        world->setVelocity(body, linear + cross(angular, relative(world->centerOfMass(body), center)), angular);
    };
    give(chassis);
    if (hasCarriers())
        for (const Carrier& carrier : carriers) give(carrier.body);
    stale = true;
}

Vehicle::Vehicle(World& world, const VehicleDef& def, const VehiclePlacement& placement)
    : sim_(std::make_unique<VehicleSim>(world, def, placement)), input(sim_->input) {}

Vehicle::Vehicle(Vehicle&& other) noexcept : sim_(std::move(other.sim_)), input(sim_->input) {}

Vehicle::~Vehicle() {
    if (!sim_) return;
    sim_->world->remove(&sim_->module);
    for (const Carrier& carrier : sim_->carriers)
        if (sim_->world->isValid(carrier.body)) sim_->world->destroy(carrier.body);
    if (sim_->world->isValid(sim_->chassis)) sim_->world->destroy(sim_->chassis);
}

BodyId Vehicle::chassis() const { return sim_->chassis; }
const VehicleDef& Vehicle::def() const { return sim_->def; }
void Vehicle::setDef(const VehicleDef& def) { sim_->setDef(def); }
void Vehicle::setLevel(VehicleLevel level) { sim_->setLevel(level); }
void Vehicle::place(const VehiclePlacement& placement) { sim_->place(placement); }
void Vehicle::setVelocity(const Vec3& linear, const Vec3& angular) { sim_->setVelocity(linear, angular); }
const VehicleTelemetry& Vehicle::telemetry() const { return sim_->tell(); }
std::span<const float> Vehicle::staticLoads() const { return sim_->loadsAtRest; }

}  // namespace ragtop
