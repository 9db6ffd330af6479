#include <algorithm>
#include <cmath>

#include "chassis.h"
#include "steering.h"
#include "vehicle_sim.h"

namespace ragtop {
namespace {

constexpr float kPlaced = 0.01f;  ///< radii, and rad, by which a wheel's shape may be where its wheel is not
constexpr float kStill = 1e-3f;   ///< over a wheel's radius: how far the ground of a sleeping car may move

/// Clamps to [lower, 1]; what is no number counts as 0.
float within(float x, float lower) { return x > lower ? std::min(x, 1.0f) : x <= lower ? lower : 0; }

}  // namespace

bool isElsewhere(const Pose& now, const Pose& before) {
    constexpr float kLeast = 1e-5f;  // m and rad
    const Quat turn = conjugate(before.rotation) * now.rotation;
    return length(relative(now.position, before.position)) > kLeast ||
           2 * length(Vec3{turn.x, turn.y, turn.z}) > kLeast;
}

VehicleSim::Driver VehicleSim::driverOf(const VehicleInput& input) {
    Driver driver;
    driver.throttle = within(input.throttle, 0);
    driver.brake = within(input.brake, 0);
    driver.steer = within(input.steer, -1);
    driver.handbrake = within(input.handbrake, 0);
    driver.clutch = within(input.clutch, 0);
    driver.differentialLock = within(input.differentialLock, 0);
    for (std::size_t i = 0; i < input.wheelTorques.size(); ++i)
        driver.wheelTorques[i] = std::isfinite(input.wheelTorques[i]) ? input.wheelTorques[i] : 0;
    driver.wind = isFinite(input.wind) ? input.wind : Vec3{};
    driver.gear = input.gear.value_or(0);
    driver.gearGiven = input.gear ? 1 : 0;
    return driver;
}

bool VehicleSim::Driver::drives(std::int32_t inGear) const {
    return (throttle > 0 && inGear != 0) || std::ranges::any_of(wheelTorques, [](float t) { return t != 0; });
}

/// A sleeping car goes on sleeping while nobody touches the controls and what it stands on stays where it was. Where
/// that is fixed it is asked for only when something fixed has been moved.
bool VehicleSim::mayRest(const Driver& wanted) {
    if (!(wanted == driver) || wanted.drives(drivetrain.gearbox.gear)) return false;
    const std::uint64_t version = world->fixedVersion();
    bool moves = false;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const GroundPlane& plane = wheels[i].ground;
        if (wheels[i].touching == 0) continue;
        if (!world->isValid(plane.body)) return false;
        moves |= plane.moves != 0;
        DVec3 point;
        Vec3 normal;
        movePlane(plane, world->pose(plane.body), point, normal);
        const float moved = length(relative(point, plane.point)) + specs[i].radius * length(normal - plane.normal);
        if (moved > kStill * specs[i].radius) return false;
    }
    if (!moves) {
        restsOnFixed = version;
        inputAtRest = input;
    }
    return true;
}

/// Do struts swing by more than what changes their load N by this share? On stiff ones that is too slow for the world
/// to see, and the car would sleep beside its balance: ½ N/g u̇² is ½ k times that amplitude squared.
bool VehicleSim::swings() const {
    constexpr float kSwing = 0.005f;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const float speed = wheels[i].touching != 0 ? wheels[i].hubSpeed : 0;
        if (specs[i].strut.stiffness * speed * speed > kSwing * kSwing * specs[i].staticLoad * gravity) return true;
    }
    return false;
}

/// Where the car stands and how it is driven; what the wheels find is looked for when all others have moved what they
/// move.
void VehicleSim::beforeStep(double dt) {
    const bool there = isThere(), awake = there && world->isAwake(chassis);
    const bool untouched = !active && restsOnFixed == world->fixedVersion() && input == inputAtRest;
    active = awake;
    if (!there || (!awake && untouched)) return;
    const Driver wanted = driverOf(input);
    active = awake || !mayRest(wanted);
    if (!active) return;
    restsOnFixed.reset();
    driver = wanted;
    workBefore = drivetrain.work;
    lostBefore = lost;
    if (!world->isAwake(chassis) || driver.drives(drivetrain.gearbox.gear) || swings()) world->wake(chassis);

    const Pose pose = world->pose(chassis);
    followPose(pose);
    const float forwardSpeed = dot(world->linearVelocity(chassis), rotate(pose.rotation, {0, 0, 1}));
    const auto step = static_cast<float>(dt);
    steerAngle = steeredAngle(def.steering, steerAngle, driver.steer, forwardSpeed, step);
    const std::optional<int> gear = driver.gearGiven != 0 ? std::optional<int>(driver.gear) : std::nullopt;
    shift(def.gearbox, drivetrain.gearbox, gear, forwardSpeed / meanRadius, driver.throttle, step);
    if (def.level == VehicleLevel::bicycle) return rideBicycle(step);
    if (hasCarriers()) {
        steerCarriers();
        readCarriers();
    }
    steerWheels();
    if (def.level >= VehicleLevel::full) placeShapes();
}

/// Where somebody has put the chassis elsewhere all of the car is there.
void VehicleSim::followPose(const Pose& pose) {
    if (!isElsewhere(pose, endPose)) return;
    for (WheelState& wheel : wheels) wheel.squash = WheelState::kPut;
    carried = {};
    if (hasCarriers()) bringCarriers(pose);
    endPose = pose;
}

/// What meets wheels from the side finds them where their struts and the steering have them.
void VehicleSim::placeShapes() {
    const auto all = world->shapes(chassis);
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const ShapeId shape = all[def.chassis.shapes.size() + i];
        const WheelLine& line = lines[i];
        const Frame now = world->frame(shape), next = wheelShapeFrame(def.wheels[i], line.hub, line.axle);
        const Quat turn = conjugate(now.rotation) * next.rotation;
        const float turned = 2 * length(Vec3{turn.x, turn.y, turn.z});
        if (length(next.position - now.position) > kPlaced * specs[i].radius || turned > kPlaced)
            world->setFrame(shape, next);
    }
}

std::span<const BodyId> VehicleSim::look(double dt) {
    touched.clear();
    if (!active) return touched;
    const Pose pose = world->pose(chassis);
    if (def.level == VehicleLevel::bicycle) {
        seekBelow(pose);
        return touched;
    }
    const auto step = static_cast<float>(dt);
    const bool full = def.level >= VehicleLevel::full;
    for (std::size_t i = 0; i < wheels.size(); ++i) ways[i] = wayOf(i, pose, step);
    Bounds all = boundsOf(ways[0]);
    for (const WheelWay& way : ways) all = merge(all, boundsOf(way));
    const QueryFilter query = nearby.among(*world, queryOf(def.chassis.filter, chassis), all);
    for (std::size_t i = 0; i < wheels.size(); ++i) full ? seekGround(i, query) : seekPoint(i, query);
    parts = def.level == VehicleLevel::full ? partsOfSubstep(step) : 1;
    together = substepsTogether(step);
    substep = part = 0;
    for (std::size_t i = 0; full && i < wheels.size(); ++i) takePiece(i, courses[i].from);
    std::ranges::fill(peakLoads, 0.0f);
    findGrounds();
    touched.push_back(chassis);
    if (hasCarriers())
        for (const Carrier& carrier : carriers) touched.push_back(carrier.body);
    return touched;
}

/// Where a hub goes in the step, going on as it does.
WheelWay VehicleSim::wayOf(std::size_t i, const Pose& pose, float dt) const {
    const WheelSpec& spec = specs[i];
    WheelWay way;
    const WheelLine& line = lines[i];
    way.from = transformPoint(pose, line.base);
    const Vec3 went = dt * world->velocityAt(chassis, way.from);
    way.to = way.from + went;
    way.axis = rotate(pose.rotation, line.along);
    way.axle = rotate(pose.rotation, line.axle);
    way.radius = spec.radius;
    way.halfWidth = spec.halfWidth;
    way.above = spec.strut.travelUp + spec.radius;
    // What the wheel may reach within the step counts as ground already.
    way.below = -spec.strut.travelLeast + 0.5f * spec.radius + length(went);
    way.seconds = dt;
    way.tireSquash = spec.strut.tireSquash;
    way.stands = wheels[i].touching != 0;
    return way;
}

void VehicleSim::seekGround(std::size_t i, const QueryFilter& query) {
    WheelState& wheel = wheels[i];
    if (wheel.isPut()) wheel.ahead.found = 0;
    if (wheel.touching == 0) wheel.below = 0;
    findCourse(*world, query, ways[i], world->settings().substeps, {wheel.ahead, wheel.below}, courses[i]);
}

/// At level 1: one plane, where a ray along the strut through the hub meets the ground at the end of the step.
void VehicleSim::seekPoint(std::size_t i, const QueryFilter& query) {
    WheelState& wheel = wheels[i];
    if (wheel.isPut()) wheel.ahead.found = 0;
    if (wheel.touching == 0) wheel.below = 0;
    findPlane(*world, query, ways[i], {wheel.ahead, wheel.below}, wheel.ground);
}

/// As many as the finest course of a wheel has to a substep, or as it takes to follow a tire that springs back, by a
/// share of its squash each; what moves is solved with the car in whole ones.
int VehicleSim::partsOfSubstep(float dt) const {
    const int substeps = world->settings().substeps, fine = finePieces(dt, substeps);
    const Pose pose = world->pose(chassis);
    int most = 1;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const WheelCourse& course = courses[i];
        const GroundPlane& plane = course.pieces[0];
        if (plane.found != 0 && plane.moves != 0) return 1;
        most = std::max(most, course.count / substeps);
        if (wheels[i].touching == 0 || plane.found == 0) continue;
        const Vec3 axis = rotate(pose.rotation, lines[i].axis);
        const float closing = -dot(world->velocityAt(chassis, plane.point), plane.normal);
        const float squashed = std::abs(closing - dot(axis, plane.normal) * wheels[i].hubSpeed) * dt;
        const float each = kThrown * specs[i].strut.tireSquash * static_cast<float>(substeps);
        most = std::max(
            most, squashed > static_cast<float>(fine) * each ? fine : static_cast<int>(std::ceil(squashed / each)));
    }
    return most;
}

bool VehicleSim::standsOnWhatMoves() const {
    const bool full = def.level >= VehicleLevel::full;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const GroundPlane& plane = full ? courses[i].pieces[0] : wheels[i].ground;
        if (plane.found != 0 && plane.moves != 0) return true;
    }
    return false;
}

/// Does each wheel that has ground below stand on one plane through the step?
bool VehicleSim::standsEvenly() const {
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const WheelCourse& course = courses[i];
        if (course.count > 1 || (course.pieces[0].found != 0 && wheels[i].touching == 0)) return false;
    }
    return true;
}

/// Of level 1 all. At level 2 two, where these are short beside the time in which a car sways on its tires: slaloms
/// then agree with those of the shortest steps to half a percent. Over what moves, and where a wheel goes from plane to
/// plane, is thrown or lands, each is solved.
int VehicleSim::substepsTogether(float dt) const {
    constexpr float kLongest = 0.048f;  // of √(σ/g), 1/120 s of a passenger car, with its rounding
    const int substeps = world->settings().substeps;
    if (hasCarriers() || parts > 1 || standsOnWhatMoves()) return 1;
    if (def.level == VehicleLevel::rays) return substeps;
    const float sway = std::sqrt(specs[0].tire.def.relaxationLength / gravity);
    const bool isShort = 2 * dt <= kLongest * sway * static_cast<float>(substeps);
    return isShort && standsEvenly() ? std::min(2, substeps) : 1;
}

/// The piece of the ground that a wheel is on.
void VehicleSim::takePiece(std::size_t i, const DVec3& hub) {
    WheelCourse& course = courses[i];
    const auto all = static_cast<float>(world->settings().substeps * parts);
    const int piece = pieceAt(course, static_cast<float>(substep * parts + part) / all, hub);
    if (piece == course.taken) return;
    course.taken = piece;
    wheels[i].ground = course.pieces[static_cast<std::size_t>(piece)];
}

/// Bodies under several wheels count once, so that each wheel knows what the others do to them.
void VehicleSim::findGrounds() {
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const GroundPlane& plane = wheels[i].ground;
        const bool moves = plane.found != 0 && plane.moves != 0;
        std::size_t first = i;
        for (std::size_t k = i; moves && k-- > 0;) {
            const GroundPlane& other = wheels[k].ground;
            if (other.found != 0 && other.moves != 0 && other.body == plane.body) first = k;
        }
        groundOfWheel[i] = first;
        if (first != i) continue;
        if (moves) touched.push_back(plane.body);
        findSupports(*world, moves ? plane.body : BodyId{}, chassis, grounds[i]);
    }
}

void VehicleSim::afterStep() {
    if (!active) return;
    if (def.level == VehicleLevel::bicycle) leadTo(endVelocity, endTurning);
    if (hasCarriers()) followJoints();
    endPose = world->pose(chassis);
    // Rest is judged by whether the ground has moved since the end of the last step that the car was awake.
    for (WheelState& wheel : wheels) {
        if (wheel.ground.moves == 0 || wheel.touching == 0 || !world->isValid(wheel.ground.body)) continue;
        const Pose now = world->pose(wheel.ground.body);
        movePlane(wheel.ground, now, wheel.ground.point, wheel.ground.normal);
        wheel.ground.pose = now;
    }
    stale.store(true, std::memory_order_relaxed);
}

}  // namespace ragtop
