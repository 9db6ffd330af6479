#include "carriers.h"

#include <algorithm>

#include "chassis.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr float kWheelTurning = 0.75f;  ///< of m r², of a rim with its tire about its axle, as Drivetrain has it
constexpr float kUprightReach = 0.5f;   ///< of a wheel's radius: how far an upright's mass is from its hub, about

Mat3 diagonal(float x, float y, float z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}}; }

/// About the hub. Of the wheel what does not turn with it: its two axes across its axle.
MassProperties wheelAndUpright(const WheelDef& wheel, float upright) {
    const float across =
        0.5f * kWheelTurning * wheel.mass * wheel.radius * wheel.radius + wheel.mass * wheel.width * wheel.width / 12;
    const float reach = kUprightReach * wheel.radius, about = upright * reach * reach;
    return {wheel.mass + upright, {}, diagonal(about, across + about, across + about)};
}

CarriedWheel carried(const LinkageSolver& solver, std::size_t wheel, bool right, bool mirror) {
    const CarrierPlace rest = solver.atRest();
    const Vec3 hub = toVec3(solver.hub(rest, right) - rest.middle), axle = toVec3(solver.axle(rest, right));
    // A mirrored wheel has its axle to the left too.
    return {wheel, mirror ? mirrored(hub) : hub, mirror ? -mirrored(axle) : axle};
}

CarrierSpec carrierSpec(const VehicleDef& def, const LinkageDef& linkage, const LinkageSolver& solver, bool right) {
    const AxleWheels wheels = axleWheels(def, linkage.axle);
    CarrierSpec spec;
    spec.mirrored = right;
    spec.middle = toVec3(solver.atRest().middle);
    if (right) spec.middle = mirrored(spec.middle);
    if (solver.isSolid())
        spec.wheels = {carried(solver, wheels.left, false, false), carried(solver, wheels.right, true, false)};
    else
        spec.wheels = {carried(solver, right ? wheels.right : wheels.left, false, right)};
    std::vector<MassProperties> parts;
    for (const CarriedWheel& wheel : spec.wheels)
        parts.push_back(transformed(wheelAndUpright(def.wheels[wheel.wheel], linkage.mass), {wheel.hub, {}}));
    spec.mass = combined(parts);
    if (linkage.spring) {
        spec.sprung = true;
        spec.springTop = right ? mirrored(linkage.spring->chassis) : linkage.spring->chassis;
        spec.springFoot = (right ? mirrored(linkage.spring->carrier) : linkage.spring->carrier) - spec.middle;
        spec.springLength = length(linkage.spring->carrier - linkage.spring->chassis);
        spec.motionRatio = static_cast<float>(solver.motionRatio());
    }
    for (const LinkageHold& hold : solver.holds())
        if (hold.racked) spec.rackEnd = right ? mirrored(toVec3(hold.chassis)) : toVec3(hold.chassis);
    return spec;
}

}  // namespace

std::vector<CarrierSpec> makeCarrierSpecs(const VehicleDef& def) {
    std::vector<CarrierSpec> all;
    for (std::size_t k = 0; k < def.linkages.size(); ++k) {
        const LinkageSolver solver = linkageSolver(def, def.linkages[k]);
        for (const bool right : {false, true}) {
            if (right && solver.isSolid()) continue;
            all.push_back(carrierSpec(def, def.linkages[k], solver, right));
            all.back().linkage = k;
        }
    }
    return all;
}

MassProperties bodyworkMass(const MassProperties& whole, const std::vector<CarrierSpec>& carriers) {
    MassProperties body;
    body.mass = whole.mass;
    Vec3 moment = whole.mass * whole.center;
    for (const CarrierSpec& spec : carriers) {
        body.mass -= spec.mass.mass;
        moment += -spec.mass.mass * (spec.middle + spec.mass.center);
    }
    if (!(body.mass > 0)) return body;
    body.center = (1 / body.mass) * moment;
    body.inertia = whole.inertia;
    const auto take = [&](const Mat3& inertia, float mass, const Vec3& center) {
        const Vec3 r = center - whole.center;
        const auto column = [&](const Vec3& along) { return mass * (dot(r, r) * along - dot(r, along) * r); };
        body.inertia.cx += -1.0f * (inertia.cx + column({1, 0, 0}));
        body.inertia.cy += -1.0f * (inertia.cy + column({0, 1, 0}));
        body.inertia.cz += -1.0f * (inertia.cz + column({0, 0, 1}));
    };
    for (const CarrierSpec& spec : carriers) take(spec.mass.inertia, spec.mass.mass, spec.middle + spec.mass.center);
    take({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, body.mass, body.center);
    return body;
}

std::string whyNoCarriers(const VehicleDef& def) {
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        const unsigned axle = def.wheels[i].axle;
        if (std::ranges::any_of(def.linkages, [&](const LinkageDef& linkage) { return linkage.axle == axle; }))
            continue;
        return "/level is linkages, must be another where /linkages has none of /wheels/" + std::to_string(i) +
               "/axle " + std::to_string(axle);
    }
    BodyDef body;
    body.mass = bodyworkMass(chassisMass(def.chassis), makeCarrierSpecs(def));
    if (whyInvalid(body).empty()) return {};
    return "/level is linkages, must be another where wheels and /linkages/*/mass leave " +
           std::to_string(body.mass->mass) + " kg of /chassis/mass to the body, or no inertia";
}

Carrier makeCarrier(World& world, BodyId chassis, const CarrierSpec& spec, const LinkageSolver& solver,
                    const Shape& shape, const Pose& pose) {
    BodyDef body;
    body.pose = pose;
    body.mass = spec.mass;
    body.continuous = false;
    body.shapes = {{.geometry = shape, .filter = {.category = 0, .mask = 0}}};
    Carrier carrier;
    carrier.body = world.create(body);
    const auto onSide = [&](const Vec3& point) { return spec.mirrored ? mirrored(point) : point; };
    const auto between = [&](const DVec3& onChassis, const DVec3& onCarrier) {
        JointBodies bodies{.a = chassis, .b = carrier.body};
        bodies.frameA.position = onSide(toVec3(onChassis));
        bodies.frameB.position = onSide(toVec3(onCarrier - solver.atRest().middle));
        return bodies;
    };
    const auto& holds = solver.holds();
    const auto firstOf = [&](HoldKind kind) {
        return std::ranges::find_if(holds, [&](const LinkageHold& hold) { return hold.kind == kind; });
    };
    // All planes are of one hinge, all lines of one strut.
    if (const auto plane = firstOf(HoldKind::plane); plane != holds.end()) {
        HingeDef hinge{.bodies = between(plane->chassis, plane->carrier)};
        hinge.bodies.frameA.rotation = rotationBetween({1, 0, 0}, onSide(toVec3(plane->normal)));
        hinge.bodies.frameB.rotation = hinge.bodies.frameA.rotation;
        world.create(hinge);
    }
    if (const auto line = firstOf(HoldKind::line); line != holds.end()) {
        // The top stays on the strut's axis, which is x of the carrier's frame.
        const JointBodies ends = between(line->chassis, line->carrier);
        SixDofDef slide;
        slide.bodies = {.a = carrier.body, .b = chassis};
        const Vec3 along = onSide(toVec3(unit(line->chassis - line->carrier)));
        slide.bodies.frameA = {ends.frameB.position, rotationBetween({1, 0, 0}, along)};
        slide.bodies.frameB = {ends.frameA.position, slide.bodies.frameA.rotation};
        slide.y.limit = slide.z.limit = Range{0, 0};
        world.create(slide);
    }
    for (const LinkageHold& hold : holds) {
        if (hold.kind != HoldKind::rod) continue;
        const auto size = static_cast<float>(hold.length);
        const JointId rod =
            world.create(DistanceDef{.bodies = between(hold.chassis, hold.carrier), .limit = Range{size, size}});
        if (hold.racked) carrier.tieRod = rod;
    }
    return carrier;
}

void steerCarrier(World& world, const CarrierSpec& spec, Carrier& carrier, float rack) {
    if (carrier.tieRod.isNull() || carrier.rack == rack) return;
    auto rod = std::get<DistanceDef>(world.def(carrier.tieRod));
    rod.bodies.frameA.position = *spec.rackEnd + Vec3{rack, 0, 0};
    world.setDef(carrier.tieRod, rod);
    carrier.rack = rack;
}

}  // namespace ragtop
