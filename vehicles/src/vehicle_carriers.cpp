#include <algorithm>

#include "vehicle_sim.h"

namespace ragtop {

// Level 3. The solve of a substep is that of level 2, with what a carrier weighs against the way u of its spring,
//
//     M ΔV + Σ b Δu̇ = P,   bᵀ ΔV + m Δu̇ = p,   b = m_c (s_v, r × s_v) + (0, I s_ω),   m = m_c s_v² + s_ωᵀ I s_ω,
//
// V the velocity of the car as one body, P and p what acts on it and on u, s how the carrier goes with u, in the
// chassis, and r where it is. Each body then gets the change of its own momentum that follows, m_c (ΔV + s Δu̇) or what
// is left of P: joints need not find the forces that go through arms, which would open them by millimetres in soft
// rows, and hold what the solve does not know, as curved ways, turning racks, and walls.

namespace {

/// Velocity and turning of a carrier in the chassis by u̇ of one of its wheels, in the chassis.
struct CarrierGoing {
    Vec3 velocity, spin;
};

CarrierGoing goingOf(const WheelLine& line, const Vec3& fromHub) {
    const Vec3 spin = line.tilting + line.spinRate * line.axle;
    return {line.axis + cross(spin, fromHub), spin};
}

struct Momentum {
    Vec3 linear, angular;
};

/// About a point.
Momentum momentumOf(const World& world, BodyId body, const DVec3& about) {
    const MassProperties mass = world.mass(body);
    const Vec3 v = world.linearVelocity(body), w = world.angularVelocity(body);
    const Mat3 inertia = rotated(mass.inertia, world.pose(body).rotation);
    return {mass.mass * v, cross(relative(world.centerOfMass(body), about), mass.mass * v) + inertia * w};
}

}  // namespace

/// Whether nobody has destroyed any of its bodies.
bool VehicleSim::isThere() const {
    const auto exists = [&](const Carrier& carrier) { return world->isValid(carrier.body); };
    return world->isValid(chassis) && (!hasCarriers() || std::ranges::all_of(carriers, exists));
}

/// Where a carrier is in the chassis.
Frame VehicleSim::carrierFrame(std::size_t k) const {
    const Pose pose = world->pose(chassis), carrier = world->pose(carriers[k].body);
    return {inverseTransformPoint(pose, carrier.position), conjugate(pose.rotation) * carrier.rotation};
}

/// The line of a wheel from where its carrier really is; rates are those of its curve.
void VehicleSim::takeCarrier(std::size_t i, WheelLine& line) const {
    const WheelSpec& spec = specs[i];
    const Frame frame = carrierFrame(spec.carrier);
    line.hub = frame.position + rotate(frame.rotation, spec.hubOnCarrier);
    line.axle = normalized(rotate(frame.rotation, spec.axleOnCarrier));
    line.base = line.hub - wheels[i].compression * line.axis;
}

/// How far springs are compressed, and how fast.
void VehicleSim::readCarriers() {
    const Pose pose = world->pose(chassis);
    for (std::size_t k = 0; k < carriers.size(); ++k) {
        const CarrierSpec& spec = carrierSpecs[k];
        const BodyId body = carriers[k].body;
        const Pose place = world->pose(body);
        for (const CarriedWheel& held : spec.wheels) {
            WheelState& wheel = wheels[held.wheel];
            const DVec3 foot = transformPoint(place, spec.sprung ? spec.springFoot : held.hub);
            if (spec.sprung) {
                const DVec3 top = transformPoint(pose, spec.springTop);
                const Vec3 along = relative(foot, top);
                const float size = length(along);
                const Vec3 speed = world->velocityAt(body, foot) - world->velocityAt(chassis, top);
                wheel.compression = (spec.springLength - size) / spec.motionRatio;
                wheel.hubSpeed = -dot(speed, along) / (size * spec.motionRatio);
            } else {
                const Vec3 speed = world->velocityAt(body, foot) - world->velocityAt(chassis, foot);
                wheel.compression = (inverseTransformPoint(pose, foot) - spec.middle - held.hub).y;
                wheel.hubSpeed = dot(speed, rotate(pose.rotation, {0, 1, 0}));
            }
        }
    }
}

/// The same after a solve. Where joints have made carriers go otherwise than it found, wheels that their brakes hold go
/// with them, so that treads do not creep by the difference.
void VehicleSim::followJoints() {
    for (std::size_t i = 0; i < wheels.size(); ++i) patches[i].wayBefore = wheels[i].hubSpeed;
    readCarriers();
    const auto turned = [&](std::size_t i) { return lines[i].spinRate * (wheels[i].hubSpeed - patches[i].wayBefore); };
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        if (patches[i].heldShare == 0) continue;
        const std::size_t other = specs[i].beamPartner;
        drivetrain.spin[i] += patches[i].heldShare * (other == i ? turned(i) : turned(i) + turned(other));
    }
}

float VehicleSim::rackOf(const CarrierSpec& spec) const {
    return def.wheels[spec.wheels[0].wheel].steerFactor * steerAngle * linkages[spec.linkage].rackTravel;
}

void VehicleSim::steerCarriers() {
    for (std::size_t k = 0; k < carriers.size(); ++k)
        steerCarrier(*world, carrierSpecs[k], carriers[k], rackOf(carrierSpecs[k]));
}

/// The place of a carrier by its wheels' compressions.
CarrierPlace VehicleSim::placeOf(const CarrierSpec& spec, LinkageCoordinates& at) const {
    const LinkageSolver& solver = linkages[spec.linkage].solver;
    const double rack = static_cast<double>(rackOf(spec));
    at = {wheels[spec.wheels.front().wheel].compression, wheels[spec.wheels.back().wheel].compression,
          spec.mirrored ? -rack : rack};
    // Beyond what it is made for it begins where it stands.
    if (const auto place = solver.reach(LinkageDrive::spring, at)) return *place;
    at = {0, 0, spec.mirrored ? -rack : rack};
    if (const auto place = solver.reach(LinkageDrive::spring, at)) return *place;
    at = {};
    return solver.atRest();
}

/// At its place by its wheels' compressions, going as the chassis does and as these change.
void VehicleSim::createCarrier(std::size_t k, const Pose& pose) {
    const CarrierSpec& spec = carrierSpecs[k];
    const LinkageSolver& solver = linkages[spec.linkage].solver;
    LinkageCoordinates at;
    const CarrierPlace place = placeOf(spec, at);
    const auto rates = solver.rates(LinkageDrive::spring, place, at);
    Vec3 middle = toVec3(place.middle), velocity, spin;
    Quat turn{static_cast<float>(place.turn.x), static_cast<float>(place.turn.y), static_cast<float>(place.turn.z),
              static_cast<float>(place.turn.w)};
    for (std::size_t n = 0; n < spec.wheels.size(); ++n) {
        const float speed = wheels[spec.wheels[n].wheel].hubSpeed;
        velocity += speed * toVec3(rates[n].velocity);
        spin += speed * toVec3(rates[n].spin);
    }
    if (spec.mirrored) {
        middle = mirrored(middle);
        velocity = mirrored(velocity);
        spin = mirroredTurn(spin);
        turn = {turn.x, -turn.y, -turn.z, turn.w};
    }
    const Pose there = pose * Frame{middle, normalized(turn)};
    const ShapeId wheel = world->shapes(chassis)[def.chassis.shapes.size() + spec.wheels[0].wheel];
    const Shape shape = world->geometry(wheel);
    carriers[k] = makeCarrier(*world, chassis, spec, solver, shape, there);
    steerCarrier(*world, spec, carriers[k], rackOf(spec));
    world->setVelocity(carriers[k].body, world->velocityAt(chassis, there.position) + rotate(pose.rotation, velocity),
                       world->angularVelocity(chassis) + rotate(pose.rotation, spin));
}

/// The car keeps its momentum: all of it gets what carriers that go by themselves have taken.
void VehicleSim::makeCarriers() {
    const Pose pose = world->pose(chassis);
    if (isElsewhere(pose, endPose)) {
        for (WheelState& wheel : wheels) wheel.squash = WheelState::kPut;
    }
    endPose = pose;
    const DVec3 center = transformPoint(pose, carMass.center);
    const Mat3 inertia = rotated(carMass.inertia, pose.rotation);
    Momentum lacking{mass * world->linearVelocity(chassis), inertia * world->angularVelocity(chassis)};
    world->setMass(chassis, bodyworkMass(carMass, carrierSpecs));
    for (std::size_t k = 0; k < carriers.size(); ++k) createCarrier(k, pose);
    const auto each = [&](auto&& visit) {
        visit(chassis);
        for (const Carrier& carrier : carriers) visit(carrier.body);
    };
    each([&](BodyId body) {
        const Momentum has = momentumOf(*world, body, center);
        lacking.linear += -has.linear;
        lacking.angular += -has.angular;
    });
    // As one body, so that joints stay closed.
    const Vec3 push = (1 / mass) * lacking.linear, turn = inverseSymmetric(inertia) * lacking.angular;
    each([&](BodyId body) {
        const Vec3 arm = relative(world->centerOfMass(body), center);
        world->setVelocity(body, world->linearVelocity(body) + push + cross(turn, arm),
                           world->angularVelocity(body) + turn);
    });
    readCarriers();
}

void VehicleSim::removeCarriers() {
    const Pose pose = world->pose(chassis);
    const DVec3 center = transformPoint(pose, carMass.center);
    Momentum all = momentumOf(*world, chassis, center);
    for (Carrier& carrier : carriers) {
        if (!world->isValid(carrier.body)) continue;
        const Momentum has = momentumOf(*world, carrier.body, center);
        all.linear += has.linear;
        all.angular += has.angular;
        world->destroy(carrier.body);
        carrier = {};
    }
    world->setMass(chassis, carMass);
    world->setVelocity(chassis, (1 / mass) * all.linear, rotated(inverseInertia, pose.rotation) * all.angular);
}

/// Somebody has put the chassis elsewhere: it takes them along.
void VehicleSim::bringCarriers(const Pose& pose) {
    const Vec3 w = world->angularVelocity(chassis);
    for (const Carrier& carrier : carriers) {
        const Pose was = world->pose(carrier.body);
        const Frame in{inverseTransformPoint(endPose, was.position), conjugate(endPose.rotation) * was.rotation};
        const Pose now = pose * in;
        world->setPose(carrier.body, {now.position, normalized(now.rotation)});
        world->setVelocity(carrier.body, world->velocityAt(chassis, now.position), w);
    }
    readCarriers();
}

/// What the carrier of a wheel weighs in the solve.
void VehicleSim::takeInertia(std::size_t i, const Pose& pose, const DVec3& center) {
    WheelPatch& patch = patches[i];
    const CarrierSpec& spec = carrierSpecs[specs[i].carrier];
    const CarrierGoing going =
        goingOf(lines[i], rotate(carrierFrame(specs[i].carrier).rotation, -specs[i].hubOnCarrier));
    const Vec3 turning = spec.mass.inertia * going.spin;
    patch.inertia = spec.mass.mass * dot(going.velocity, going.velocity) + dot(going.spin, turning);
    patch.crossInertia = 0;
    const std::size_t other = specs[i].beamPartner;
    if (other != i) {
        const CarrierGoing beyond =
            goingOf(lines[other], rotate(carrierFrame(specs[i].carrier).rotation, -specs[other].hubOnCarrier));
        patch.crossInertia = spec.mass.mass * dot(going.velocity, beyond.velocity) + dot(beyond.spin, turning);
    }
    const Vec3 arm = relative(world->centerOfMass(carriers[specs[i].carrier].body), center);
    patch.momentum = spec.mass.mass * rotate(pose.rotation, going.velocity);
    patch.turning = cross(arm, patch.momentum) + rotate(pose.rotation, turning);
    patch.wayBefore = wheels[i].hubSpeed;
}

/// What a carrier resists with: m (w/h − u̇₀)/h + (bᵀ ΔV)/h, and by the other wheel of a beam.
void VehicleSim::addInertia(std::size_t i, const PointBody& body, float h, BarPull& pull) const {
    const WheelPatch& patch = patches[i];
    float sum = dot(patch.momentum, body.v - unforced.v) + dot(patch.turning, body.w - unforced.w);
    const std::size_t other = specs[i].beamPartner;
    if (other != i) sum += patch.crossInertia * (patches[other].way / h - patches[other].wayBefore);
    pull.force += (sum - patch.inertia * patch.wayBefore) / h;
    pull.stiffness += patch.inertia / (h * h);
}

/// Where the way of a wheel has changed by Δu.
void VehicleSim::swing(std::size_t i, float way, PointBody& body) {
    const WheelPatch& patch = patches[i];
    const float speed = -way / substepLength;
    body.v += speed * body.inverseMass * patch.momentum;
    body.w += speed * (body.inverseInertia * patch.turning);
}

/// One visit to a wheel in the air: what swings between strut and stops.
float VehicleSim::visitFree(std::size_t i, PointBody& body, float h) {
    WheelPatch& patch = patches[i];
    const float before = patch.way;
    if (patch.held) patch.held = holdOnPads(i, h, 0);
    patch.way = swingOfWheel(specs[i].strut, wheels[i].compression, h, pullOn(i, body, h));
    patch.held = holdOnPads(i, h, 0);
    swing(i, patch.way - before, body);
    return patch.inertia * std::abs(patch.way - before) / h;
}

void VehicleSim::actOnCarriers(float h) {
    substep == 0 ? readCarriers() : followJoints();
    const Pose pose = world->pose(chassis);
    const DVec3 center = transformPoint(pose, carMass.center);
    PointBody body = bodyAt(pose);
    body.v = world->velocityAt(chassis, center);
    CarImpulse sum;
    beginGrounds();
    substepLength = h;
    part = 0;
    act(pose, center, body, h, sum);
    pushGrounds(1);
    for (std::size_t k = 0; k < carriers.size(); ++k) giveToCarrier(k, pose, sum);
    world->applyImpulse(chassis, sum.linear, center);
    world->applyAngularImpulse(chassis, sum.angular);
    if (!holds(sum.linear, sum.angular)) forgetMotion();
    ++substep;
}

/// What carrier `k` gets of the car's impulse, which the chassis then has not: by what it goes with it, and with u.
void VehicleSim::giveToCarrier(std::size_t k, const Pose& pose, CarImpulse& sum) {
    const CarrierSpec& spec = carrierSpecs[k];
    const BodyId id = carriers[k].body;
    const Vec3 v = solved.v - unforced.v, w = solved.w - unforced.w;
    const DVec3 at = world->centerOfMass(id);
    const Vec3 arm = relative(at, transformPoint(pose, carMass.center));
    Vec3 linear = spec.mass.mass * (v + cross(w, arm));
    Vec3 angular = rotated(spec.mass.inertia, pose.rotation) * w;
    for (const CarriedWheel& held : spec.wheels) {
        const WheelPatch& patch = patches[held.wheel];
        const float change = patch.wayAfter - patch.wayBefore;
        linear += change * patch.momentum;
        angular += change * (patch.turning - cross(arm, patch.momentum));
    }
    world->applyImpulse(id, linear, at);
    world->applyAngularImpulse(id, angular);
    sum.linear += -linear;
    sum.angular += -(angular + cross(arm, linear));
}

}  // namespace ragtop
