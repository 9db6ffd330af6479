#include <algorithm>
#include <cmath>
#include <limits>

#include "vehicle_sim.h"

namespace ragtop {
namespace {

/// When sweeps end.
struct Patience {
    int sweeps = 0;
    float converged = 0;  ///< largest change in a sweep, over the impulse of the weight
};

/// What sweeps leave lets a car creep that stands, and is nothing to one that goes: at level 2 it may be in proportion
/// to the speed, from where tires travel and do not sway, up to what it is at level 1.
Patience patienceAt(VehicleLevel level, float speed, float slowest) {
    constexpr float kStanding = 1e-5f, kGoing = 1e-4f;
    if (level < VehicleLevel::full) return {12, kGoing};
    return {24, clampTo(kStanding * speed / slowest, kStanding, kGoing)};
}

constexpr float kAgreeing = 0.5f;  ///< of a sweep's change to the one before's, of sweeps that agree

/// What sweeps to come would still change, as a geometric series by the last two of them.
float restAfter(float change, float before) {
    return change < before ? change * change / (before - change) : std::numeric_limits<float>::infinity();
}

/// m/s along their struts: of a wheel's hub, and of that at the other end of its beam.
struct HubSpeeds {
    float own = 0, other = 0;
};

/// Velocity of the wheel's side of the patch over the ground, its hub rising along the strut: forward, left.
inline Vec2 travelOf(const WheelPatch& patch, const PointBody& body, const HubSpeeds& hub) {
    return {speedAlong(patch.forwardRow, body, *patch.ground) + patch.lean.x * hub.own + patch.cross.x * hub.other,
            speedAlong(patch.sideRow, body, *patch.ground) + patch.lean.y * hub.own + patch.cross.y * hub.other};
}

Vec2 slipOf(const WheelPatch& patch, const PointBody& body, const HubSpeeds& hub, float treadSpeed) {
    const Vec2 travel = travelOf(patch, body, hub);
    return {travel.x - treadSpeed, travel.y};
}

/// Of what a tread is bent by, in a substep: less is what sways and settles, of which edge and core keep a memory.
constexpr float kBent = 0.1f;

float lengthOf(const Vec2& a) { return std::sqrt(a.x * a.x + a.y * a.y); }

bool isBrush(const TireDef& def) { return !def.magicFormula && !def.slipCurves; }

void takeLoad(WheelState& wheel, float load) {
    const Tread tread = underLoad(wheel.tread(), load);
    wheel.deflection = tread.mean;
    wheel.core = tread.core;
    wheel.load = tread.load;
    wheel.coreLoad = tread.coreLoad;
}

/// What slides or gives way does so all over.
void bendTo(WheelState& wheel, const Vec2& bent) {
    if (!(bent == wheel.deflection)) wheel.bend(bent);
}

Vec3 impulseOf(const WheelPatch& patch) {
    return patch.load * patch.normal + patch.tire.x * patch.forward + patch.tire.y * patch.side;
}

/// Where a body is after h, by velocities that stay.
Pose gone(const Pose& pose, const Vec3& center, const PointBody& body, float h) {
    const float speed = length(body.w);
    const Quat rotation = speed > 0 ? normalized(rotationAbout(body.w, h * speed) * pose.rotation) : pose.rotation;
    return {transformPoint(pose, center) + (h * body.v - rotate(rotation, center)), rotation};
}

/// What a rotation in single precision has turned beyond ω in h, rad/s, where that is no more than what it is rounded
/// by: a car that leans by less than that a substep stays as it is, and bristles that followed ω would let it creep.
Vec3 unturned(const Vec3& w, const Quat& before, const Quat& now, float h) {
    constexpr float kRounding = 4e-7f;  // rad
    const Quat turn = now * conjugate(before);
    const Vec3 rest = (2 / h) * (turn.w < 0 ? -1.0f : 1.0f) * Vec3{turn.x, turn.y, turn.z} - w;
    return h * length(rest) < kRounding ? rest : Vec3{};
}

}  // namespace

/// Everything the car does to itself and the ground in a substep, as one implicit solve: struts (suspension.h), tires
/// (tire.h) and drivetrain (drivetrain.h) are swept until they agree on the velocities that gravity and all their
/// impulses give. The world then integrates these velocities, with its contacts and joints; the bristles of the tires
/// follow the velocities that come out of that, so that a trailer or a rope cannot make a braked car creep.
void VehicleSim::beforeSubstep(float h) {
    if (!active) return;
    if (hasCarriers()) return actOnCarriers(h);
    if (together > 1) return actTogether(h);
    Pose pose = world->pose(chassis);
    const DVec3 center = world->centerOfMass(chassis);
    const PointBody first = bodyAt(pose);
    const Vec3 centerInChassis = inverseRotate(pose.rotation, relative(center, pose.position));
    const float each = h / static_cast<float>(parts), share = 1 / static_cast<float>(parts);
    const Vec3 fall = each * world->settings().gravity;
    PointBody body = first;
    CarImpulse sum = carried, given;
    const auto move = [&](float falls) {
        body.v = first.v + falls * fall + first.inverseMass * sum.linear;
        body.w = first.w + first.inverseInertia * sum.angular;
    };
    move(0);
    beginGrounds();
    for (part = 0; part < parts; ++part) {
        if (part > 0) pose = gone(pose, centerInChassis, body, each);
        act(pose, transformPoint(pose, centerInChassis), body, each, sum);
        pushGrounds(1);
        move(static_cast<float>(part + 1));
        // What is given moves the car as far in the substep as all of its parts do; the rest follows in the next one.
        given.linear += share * sum.linear - (mass * share * static_cast<float>(parts - 1 - part)) * fall;
        given.angular += share * sum.angular;
    }
    if (parts == 1) given = sum;
    carried = {sum.linear - given.linear, sum.angular - given.angular};
    // What is no number the world leaves out, and what is beyond all measure it stops.
    world->applyImpulse(chassis, given.linear, center);
    world->applyAngularImpulse(chassis, given.angular);
    if (!holds(sum.linear, sum.angular)) forgetMotion();
    ++substep;
}

/// One solve for several substeps, each of which gets its share. Struts and tires are implicit, so that they hold at
/// that length too; what is light is pushed and answers within a substep.
void VehicleSim::actTogether(float h) {
    const DVec3 center = world->centerOfMass(chassis);
    const int place = substep % together;
    if (place == 0) {
        const Pose pose = world->pose(chassis);
        inOne = std::min(together, world->settings().substeps - substep);
        whole = carried;
        carried = {};
        beginGrounds();
        act(pose, center, bodyAt(pose), h * static_cast<float>(inOne), whole);
    }
    const float share = 1 / static_cast<float>(inOne);
    world->applyImpulse(chassis, share * whole.linear, center);
    world->applyAngularImpulse(chassis, share * whole.angular);
    pushGrounds(share);
    if (place == 0 && !holds(whole.linear, whole.angular)) forgetMotion();
    ++substep;
}

PointBody VehicleSim::bodyAt(const Pose& pose) const {
    return {world->linearVelocity(chassis), world->angularVelocity(chassis), 1 / mass,
            rotated(inverseInertia, pose.rotation)};
}

/// What the car has got of bodies under its wheels they get the other way.
void VehicleSim::pushGrounds(float share) {
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const WheelPatch& patch = patches[i];
        if (!patch.touching || !(patch.ground->inverseMass > 0)) continue;
        world->applyAngularImpulse(wheels[i].ground.body, -share * patch.turned);
        world->applyImpulse(wheels[i].ground.body, -share * patch.given, patch.point);
    }
}

/// Over h, from where the car is. Adds what it gives to the chassis, besides gravity.
void VehicleSim::act(const Pose& pose, const DVec3& center, PointBody body, float h, CarImpulse& sum) {
    PointBody moved = body;
    moved.w += unturned(body.w, substepRotation, pose.rotation, h);
    substepRotation = pose.rotation;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        preparePatch(i, pose, center, body, moved, h);
        resistances[i] = resistanceOf(i);
    }

    // Arms are short, so what the air does is implicit in the speed alone.
    const PointBody start = body;
    takeHeights();
    const auto [airLinear, airAngular] =
        airImpulse(def.aerodynamics, lifts, {body.v - driver.wind, pose.rotation, body.inverseMass}, h);
    Vec3 linear = airLinear, angular = airAngular;
    body.v += body.inverseMass * linear;
    body.w += body.inverseInertia * angular;
    const Vec3 fall = h * world->settings().gravity;
    body.v += fall;
    unforced = start;
    unforced.v += fall;
    for (GroundBody& ground : grounds) pressGround(ground, fall);

    const Vec3 turned = solve(body, h);
    angular += turned;
    solved = body;
    for (std::size_t i = 0; i < wheels.size(); ++i) finishWheel(i, body, h, linear, angular);
    for (WheelPatch& patch : patches) patch.way = 0;
    countBody(start, body, {airLinear, airAngular}, turned);
    sum.linear += linear;
    sum.angular += angular;
}

/// Of lifts that depend on how high struts hold the body.
void VehicleSim::takeHeights() {
    for (LiftPoint& lift : lifts) {
        if (lift.perHeight == 0) continue;
        float compression = 0, count = 0;
        for (std::size_t i = 0; i < wheels.size(); ++i) {
            if (def.wheels[i].axle != lift.axle) continue;
            compression += wheels[i].compression;
            count += 1;
        }
        lift.area = lift.restArea - lift.perHeight * compression / count;
    }
}

/// What tires turn the car by, besides.
Vec3 VehicleSim::solve(PointBody& body, float h) {
    drivetrain.begin(
        def,
        {driver.throttle, driver.brake, driver.handbrake, driver.clutch, driver.differentialLock, driver.wheelTorques},
        resistances, h);
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        WheelPatch& patch = patches[i];
        if (!patch.touching) continue;
        patch.load = h * wheels[i].load;
        patch.tire = {h * wheels[i].force.x, h * wheels[i].force.y};
        pushPatch(i, body, patch.load, patch.tire);
        drivetrain.spin[i] -= specs[i].radius * patch.tire.x / drivetrain.inertia()[i];
    }
    Vec3 turned;
    for (std::size_t i = 0; i < wheels.size(); ++i) turned += expectTire(i, body, h);
    body.w += body.inverseInertia * turned;
    const Patience patience = patienceAt(def.level, length(body.v), specs[0].tire.slowest);
    const float enough = patience.converged * h * mass * gravity;
    gripTrusted = 1;
    for (std::size_t i = 0; i < wheels.size() && !linkages.empty(); ++i) {
        carryPads(i, h);
        patches[i].held = drivetrain.mayHold(i);
    }
    float before = 0;
    for (int sweep = 0; sweep < patience.sweeps; ++sweep) {
        float change = 0;
        for (std::size_t i = 0; i < wheels.size(); ++i) change = std::max(change, visitWheel(i, body, h));
        for (GroundBody& ground : grounds) change = std::max(change, visitSupports(ground));
        change = std::max(change, drivetrain.sweep(def, h) / meanRadius);
        if (change <= enough || restAfter(change, before) <= enough) break;
        // Tires that do not take what shafts leave to them throw light wheels to and fro.
        if (sweep > 0 && change > kAgreeing * before) gripTrusted *= 0.5f;
        before = change;
    }
    // What is left of the last change of a tire would turn a wheel that is held, and the car would creep.
    drivetrain.holdWheels();
    if (!linkages.empty()) lost.struts -= drivetrain.workOnCarriers();
    for (std::size_t i = 0; i < wheels.size() && hasCarriers(); ++i)
        patches[i].heldShare = patches[i].held ? drivetrain.padShare(i) : 0;
    drivetrain.end(def, h);
    return turned;
}

/// Where the bristles come to if all goes on as it does, and N m s by which the tire turns its wheel there, and with it
/// the car.
Vec3 VehicleSim::expectTire(std::size_t i, const PointBody& body, float h) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    if (!patch.touching) return {};
    const Vec2 slip = slipOf(patch, body, {wheel.hubSpeed, wheels[specs[i].beamPartner].hubSpeed},
                             specs[i].radius * drivetrain.spin[i]);
    patch.bent = withinPatch(patch.law, rolledDeflection(patch.law, wheel.deflection, slip, patch.transport, h));
    const SlipForces forces = forcesAt(patch.law, patch.bent);
    patch.line = tireLine(patch.law, patch.bent, forces);
    patch.lineDue = patch.sliding = false;
    wheel.aligning = aligningMoment(patch.law, patch.bent, forces, wheel.load, wheel.travel.x);
    patch.turned = h * wheel.aligning * patch.normal;
    return patch.turned;
}

void VehicleSim::pushPatch(std::size_t i, PointBody& body, float load, const Vec2& tire) {
    const WheelPatch& patch = patches[i];
    push(patch.normalRow, body, *patch.ground, load);
    push(patch.forwardRow, body, *patch.ground, tire.x);
    push(patch.sideRow, body, *patch.ground, tire.y);
}

/// `moved` has the velocities of the way that the body really went in the last substep.
void VehicleSim::preparePatch(std::size_t i, const Pose& pose, const DVec3& center, const PointBody& body,
                              const PointBody& moved, float h) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    patch.spinBefore = drivetrain.spin[i];
    // A strut's line stays through the step.
    if (specs[i].linkage >= 0) takeLine(i);
    // As it is in the middle of h: a car that turns would else slip by half of what it turns in that time.
    const Vec3 axle = rotate(pose.rotation, lines[i].axle);
    patch.axle = normalized(axle + 0.5f * h * cross(body.w, axle));
    if (def.level >= VehicleLevel::full && (substep > 0 || part > 0)) takePiece(i, transformPoint(pose, lines[i].base));
    const bool known = placePatch(i, pose, center);
    patch.touching = known && sinkGround(i, body, h);
    patch.load = patch.way = patch.strutGive = 0;
    patch.tire = {};
    patch.given = patch.turned = {};
    patch.crossSlant = 0;
    patch.lean = patch.cross = {};
    if (hasCarriers()) {
        takeInertia(i, pose, center);
        patch.way = h * wheel.hubSpeed;
    }
    if (!patch.touching) {
        if (!hasCarriers()) letFall(i, h);
        wheel.load = wheel.settleTime = wheel.sunk = 0;
        wheel.bend({});
        wheel.force = wheel.travel = {};
        wheel.inclination = wheel.aligning = 0;
        if (!hasCarriers()) wheel.hubSpeed = 0;
        return;
    }
    patch.lean = {dot(patch.forward, patch.axis), dot(patch.side, patch.axis)};
    if (specs[i].beamPartner != i) takeCross(i, pose);
    const float radius = specs[i].radius, inertia = drivetrain.inertia()[i];
    patch.strutK = inverseMassBetween(patch.normalRow, patch.normalRow);
    patch.tireK = {inverseMassBetween(patch.forwardRow, patch.forwardRow) + radius * radius / inertia,
                   inverseMassBetween(patch.forwardRow, patch.sideRow),
                   inverseMassBetween(patch.sideRow, patch.sideRow)};
    const float lean = clampTo(dot(patch.axle, patch.normal), -1, 1);
    // No other law asks for it.
    if (specs[i].tire.def.magicFormula) wheel.inclination = arcTan2(lean, std::sqrt(1 - lean * lean));
    patch.speedBefore = patchSpeed(i, body);
    const TireMotion motion{travelOf(patch, body, {wheel.hubSpeed, wheels[specs[i].beamPartner].hubSpeed}),
                            radius * drivetrain.spin[i]};
    // Bristles leave with the tread; slip is over the speed of travel.
    patch.transport = isBrush(specs[i].tire.def) ? std::abs(motion.tread) : lengthOf(motion.travel);
    patch.law = tireLaw(specs[i].tire, groundOf(i), motion, wheel.load, patch.transport);
    settleTire(i, moved);
    wheel.travel = motion.travel;
}

TireGround VehicleSim::groundOf(std::size_t i) const {
    TireGround ground = tireGround(specs[i].tire.def, wheels[i].ground.friction, wheels[i].ground.surface);
    ground.inclination = wheels[i].inclination;
    return ground;
}

/// The torque by which tire and ground resist rolling.
float VehicleSim::resistanceOf(std::size_t i) const {
    return (specs[i].tire.def.rollingResistance + groundOf(i).drag) * wheels[i].load * specs[i].radius;
}

void VehicleSim::letFall(std::size_t i, float h) {
    wheels[i].compression += fallOfWheel(specs[i].strut, wheels[i].compression, h, barOf(i));
}

void VehicleSim::beginGrounds() {
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const GroundPlane& plane = wheels[i].ground;
        if (groundOfWheel[i] != i || plane.found == 0 || plane.moves == 0) continue;
        beginGround(*world, plane.body, grounds[i]);
    }
}

/// Brings the bristles up to now: (1) of tire.h with the slip that the last substep really had.
void VehicleSim::settleTire(std::size_t i, const PointBody& moved) {
    WheelState& wheel = wheels[i];
    const WheelPatch& patch = patches[i];
    if (wheel.settleTime > 0) {
        const Vec2 slip = slipOf(patch, moved, {wheel.hubSpeed, wheels[specs[i].beamPartner].hubSpeed},
                                 specs[i].radius * drivetrain.spin[i]);
        const bool turns = slip.x * wheel.deflection.x + slip.y * wheel.deflection.y > 0;
        if (turns) bendTo(wheel, beforePeak(patch.law, wheel.deflection));
        const Vec2 before = wheel.deflection;
        for (Vec2* bent : {&wheel.deflection, &wheel.core})
            *bent = rolledDeflection(patch.law, *bent, slip, wheel.transport, wheel.settleTime);
        const Vec2 change{wheel.deflection.x - before.x, wheel.deflection.y - before.y};
        if (lengthOf(change) > kBent * lengthOf(before)) wheel.bend(wheel.deflection);
        wheel.settleTime = 0;
    }
    bendTo(wheel, withinPatch(patch.law, wheel.deflection));
}

/// One visit to a strut and its tire; the largest change of an impulse.
float VehicleSim::visitWheel(std::size_t i, PointBody& body, float h) {
    WheelPatch& patch = patches[i];
    if (!patch.touching) return hasCarriers() ? visitFree(i, body, h) : 0;
    const WheelState& wheel = wheels[i];
    const float wayBefore = patch.way;
    if (patch.held && specs[i].linkage >= 0) patch.held = holdOnPads(i, h, 0);

    const float apart = speedAlong(patch.normalRow, body, *patch.ground) - patch.strutK * patch.load +
                        patch.crossSlant * patches[specs[i].beamPartner].way / h;
    const float rub = (patch.lean.x * patch.tire.x + patch.lean.y * patch.tire.y) / h;
    const StrutVisit strut = solveStrut(specs[i].strut, wheel.compression, patch.squash, patch.slant, h, patch.strutK,
                                        apart, rub, pullOn(i, body, h));
    const float loadChange = strut.impulse - patch.load;
    patch.load = strut.impulse;
    patch.way = strut.way;
    patch.strutGive = 1 / (h * h * strut.stiffness);
    push(patch.normalRow, body, *patch.ground, loadChange);

    if (patch.lineDue) patch.line = lineAfter(patch.law, patch.bent, patch.sliding);
    patch.lineDue = false;
    const float change = pushTire(i, body, h);
    if (hasCarriers()) swing(i, patch.way - wayBefore, body);
    return std::max(std::abs(loadChange), change);
}

/// Of its tire, under the load that its strut has found: what that has along the strut moves the hub.
float VehicleSim::pushTire(std::size_t i, PointBody& body, float h) {
    WheelPatch& patch = patches[i];
    const WheelState& wheel = wheels[i];
    const float radius = specs[i].radius, way = patch.way;
    const float own = radius * radius / drivetrain.inertia()[i], give = patch.strutGive;
    const Vec2 bent = meanUnder(wheel.tread(), patch.load / h);
    Sym2 K;
    Vec2 free, change;
    float carGive = 0;
    // `lean`: how the tread goes with the strut.
    const auto visitTire = [&](const Vec2& lean, float spin, float wheelGive) {
        K = {patch.tireK.xx - own + give * lean.x * lean.x, patch.tireK.xy + give * lean.x * lean.y,
             patch.tireK.yy + give * lean.y * lean.y};
        carGive = K.xx;
        K.xx += wheelGive;
        const Vec2 slip = slipOf(patch, body, {way / h, patches[specs[i].beamPartner].way / h}, radius * spin);
        free = {slip.x - K.xx * patch.tire.x - K.xy * patch.tire.y, slip.y - K.xy * patch.tire.x - K.yy * patch.tire.y};
        const TireVisit visit = solveTire(patch.law, patch.line, bent, patch.transport, patch.load, h, K, free);
        change = {visit.impulse.x - patch.tire.x, visit.impulse.y - patch.tire.y};
        patch.way = way + h * give * (lean.x * change.x + lean.y * change.y);
        return visit;
    };
    // A wheel that its brake holds is solved with it: light ones have hardly an inertia to agree by.
    TireVisit visit;
    carryPads(i, h);
    patch.held = drivetrain.mayHold(i);
    if (patch.held) {
        const float turn = lines[i].spinRate * drivetrain.padShare(i);
        visit = visitTire({patch.lean.x - radius * turn, patch.lean.y}, drivetrain.stillSpin(i), 0);
        patch.held = holdOnPads(i, h, radius * change.x);
    }
    if (!patch.held) {
        visit = visitTire(patch.lean, drivetrain.spin[i], own);
        carryPads(i, h);
        drivetrain.spin[i] -= radius * change.x / drivetrain.inertia()[i];
    }
    patch.tire = visit.impulse;
    patch.sliding = visit.sliding;
    // The car gives way too, by what its wheel does not.
    drivetrain.grip(i, radius, gripTrusted * visit.grip / (1 + visit.grip * carGive));
    push(patch.forwardRow, body, *patch.ground, change.x);
    push(patch.sideRow, body, *patch.ground, change.y);
    if (patch.load > 0) {
        const Vec2 end{free.x + K.xx * patch.tire.x + K.xy * patch.tire.y,
                       free.y + K.xy * patch.tire.x + K.yy * patch.tire.y};
        const Vec2 after = deflectionAfter(patch.law, patch.line, bent, visit, end, patch.transport, patch.load, h);
        patch.bent = {bent.x + visit.end.x * (after.x - bent.x), bent.y + visit.end.y * (after.y - bent.y)};
        patch.lineDue = true;
    }
    return std::max(std::abs(change.x), std::abs(change.y));
}

/// Keeps what the next substep needs, and adds the wheel's part to the impulse on the chassis. A wheel that is spun up
/// turns the chassis the other way.
void VehicleSim::finishWheel(std::size_t i, const PointBody& body, float h, Vec3& linear, Vec3& angular) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    const float spin = drivetrain.spin[i];
    angular -= drivetrain.inertia()[i] * (spin - patch.spinBefore) * patch.axle;
    wheel.rotation += h * spin;
    wheel.rotation -= 2 * kPi * std::floor((wheel.rotation + kPi) / (2 * kPi));
    wheel.touching = patch.touching && (patch.squash > 0 || patch.load > 0) ? 1 : 0;
    wheel.squash = patch.touching ? std::max(patch.squash, 0.0f) : 0;
    patch.wayAfter = patch.way / h;
    if (!patch.touching) return;

    const Vec3 impulse = impulseOf(patch);
    linear += impulse;
    angular += cross(patch.arm, impulse);
    patch.given = impulse;
    wheel.compression += patch.way;
    wheel.hubSpeed = patch.way / h;
    const HubSpeeds hub{wheel.hubSpeed, patches[specs[i].beamPartner].way / h};
    countPatch(i, body, hub.own, hub.other);
    wheel.travel = travelOf(patch, body, hub);
    takeLoad(wheel, patch.load / h);
    peakLoads[i] = std::max(peakLoads[i], wheel.load);
    wheel.force = {patch.tire.x / h, patch.tire.y / h};
    if (patch.sliding && patch.law.isBrush()) {
        const TireVisit visit{patch.tire, true};
        wheel.bend(withinPatch(patch.law,
                               deflectionAfter(patch.law, patch.line, wheel.deflection, visit, {}, 0, patch.load, h)));
        wheel.settleTime = 0;
    } else {
        wheel.settleTime = wheel.load > 0 ? h : 0;
        wheel.transport = patch.transport;
        if (!(wheel.load > 0)) wheel.bend({});
    }
}

}  // namespace ragtop
