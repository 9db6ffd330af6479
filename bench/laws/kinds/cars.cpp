#include "cars.h"

#include <algorithm>

#include "../../../tests/vehicles/hardpoints.h"

namespace ragtop::laws {
namespace {

float mostly(Dice& dice, float usual, float from, float to) { return coin(dice) ? usual : magnitude(dice, from, to); }

SuspensionDef drawSuspension(Dice& dice, float scale) {
    SuspensionDef def;
    def.frequency = magnitude(dice, 0.8f, 8);
    def.dampingRatio = oneOf(dice, {0.0f, 0.05f, 0.2f, 0.35f, 0.7f, 1.5f});
    def.travelUp = scale * magnitude(dice, 0.02f, 0.2f);
    def.travelDown = scale * magnitude(dice, 0.02f, 0.2f);
    def.bumpStopStiffness = mostly(dice, 10, 1, 100);
    if (coin(dice)) def.droopStopStiffness = magnitude(dice, 1, 100);
    if (dice.below(4) == 0) def.axis = {dice.between(-0.25f, 0.25f), 1, dice.between(-0.25f, 0.25f)};
    return def;
}

void set(MagicFormulaDef& def, std::string_view name, float value) {
    for (std::size_t i = 0; i < kMagicCoefficients.size(); ++i)
        if (kMagicCoefficients[i].tunable.name == name) def.values[i] = value;
}

TireDef drawTire(Dice& dice, float radius, float load) {
    TireDef def;
    def.longitudinalFriction = mostly(dice, 1.05f, 0.5f, 2);
    def.lateralFriction = mostly(dice, 1, 0.5f, 2);
    def.slidingShare = dice.between(0.5f, 1);
    def.slipStiffness = mostly(dice, 18, 5, 60);
    def.corneringStiffness = mostly(dice, 16, 5, 60);
    def.relaxationLength = radius * magnitude(dice, 0.1f, 3);
    def.dampingRatio = oneOf(dice, {0.0f, 0.1f, 0.5f, 1.0f});
    def.rollingResistance = oneOf(dice, {0.0f, 0.012f, 0.1f});
    def.loadSensitivity = oneOf(dice, {0.0f, 0.0f, 0.2f});
    if (coin(dice)) def.radialStiffness = load / (radius * magnitude(dice, 0.01f, 0.15f));
    const std::uint32_t law = dice.below(4);
    if (law == 0) def.slipCurves.emplace();
    if (law == 1) {
        def.magicFormula.emplace();
        // Measured at half to twice the load that it has.
        set(*def.magicFormula, "FNOMIN", load * magnitude(dice, 0.5f, 2));
        set(*def.magicFormula, "UNLOADED_RADIUS", radius);
    }
    return def;
}

void drawDrive(Dice& dice, VehicleDef& def, float scale) {
    const float strength = def.chassis.mass / 1200 * scale * magnitude(dice, 0.3f, 3);
    for (TorquePoint& point : def.engine.torqueCurve) point.torque *= strength;
    def.engine.inertia *= strength * magnitude(dice, 0.2f, 3);
    def.engine.brakeTorque *= strength;
    if (dice.below(4) == 0) def.engine.turbo.emplace();
    if (dice.below(4) == 0)
        def.engine.electric = ElectricMotorDef{300 * strength, 100e3f * strength, oneOf(dice, {0.0f, 0.3f, 1.0f})};
    GearboxDef& gears = def.gearbox;
    gears.coupling = oneOf(dice, {CouplingType::clutch, CouplingType::dualClutch, CouplingType::converter});
    for (ConverterPoint& point : gears.converterMap) point.capacity *= strength;
    gears.continuous = dice.below(4) == 0;
    gears.efficiency = oneOf(dice, {0.6f, 0.92f, 1.0f});
    gears.shiftTime = oneOf(dice, {0.0f, 0.25f, 1.0f});
    for (DifferentialDef* part : {&def.differential, &def.centerDifferential}) {
        part->type =
            static_cast<DifferentialType>(dice.below(static_cast<std::uint32_t>(enumNames(DifferentialType{}).size())));
        part->preload *= strength, part->activeTorque *= strength, part->viscosity *= strength;
    }
}

void drawAir(Dice& dice, VehicleDef& def, float scale) {
    const float area = scale * scale;
    def.aerodynamics.dragArea = oneOf(dice, {0.0f, 0.66f, 3.0f}) * area;
    def.aerodynamics.liftArea = oneOf(dice, {0.0f, 0.0f, -3.0f, 0.5f}) * area;
    def.aerodynamics.sideArea = oneOf(dice, {0.0f, 2.0f}) * area;
    if (dice.below(4) == 0) def.aerodynamics.axleLifts = {{0, -1.5f * area, oneOf(dice, {0.0f, 5.0f}) * area}};
}

/// What wheels are like that all of them share; loads and places come later.
WheelDef drawWheel(Dice& dice, const VehicleDef& def, float scale, std::size_t count) {
    WheelDef wheel;
    wheel.radius = 0.3f * scale * magnitude(dice, 0.6f, 1.8f);
    wheel.width = wheel.radius * dice.between(0.25f, 1);
    const float load = def.chassis.mass * 9.81f / static_cast<float>(count);
    wheel.mass = def.chassis.mass * oneOf(dice, {0.003f, 0.015f, 0.04f}) * 4 / static_cast<float>(count);
    wheel.suspension = drawSuspension(dice, scale);
    wheel.tire = drawTire(dice, wheel.radius, load);
    wheel.brakeTorque = load * wheel.radius * oneOf(dice, {0.6f, 2.0f, 6.0f});
    if (dice.below(4) == 0) wheel.brakeHeatCapacity = 10 * wheel.mass, wheel.brakeFade = oneOf(dice, {0.0f, 0.002f});
    return wheel;
}

/// Wheels of one to four axles, or three wheels.
void addWheels(Dice& dice, VehicleDef& def, float scale, bool isTowed) {
    const bool isThree = dice.below(8) == 0;
    const int axles = isThree ? 2 : oneOf(dice, {2, 2, 2, 3, 4});
    const WheelDef common = drawWheel(dice, def, scale, isThree ? 3 : static_cast<std::size_t>(2 * axles));
    const float base =
        std::max(2.5f * scale * dice.between(0.6f, 1.5f), 2.1f * common.radius * static_cast<float>(axles - 1));
    const float half = 0.74f * scale * dice.between(0.6f, 1.3f);
    const std::uint32_t drive = dice.below(3);
    for (int axle = 0; axle < axles; ++axle) {
        WheelDef wheel = common;
        wheel.axle = static_cast<unsigned>(axle);
        const bool isFirst = axle == 0, isLast = axle + 1 == axles;
        if (isFirst) wheel.steerFactor = 1;
        if (isLast && dice.below(4) == 0) wheel.steerFactor = -0.3f;
        wheel.driveShare = !isTowed && (drive == 2 || (drive == 0 ? isFirst : isLast)) ? 1.0f : 0.0f;
        if (isLast) wheel.handbrakeTorque = wheel.brakeTorque;
        const float z = base * (0.5f - static_cast<float>(axle) / static_cast<float>(axles - 1));
        const bool isSingle = isThree && axle == static_cast<int>(drive % 2);
        for (const float side : isSingle ? std::vector<float>{0} : std::vector<float>{half, -half}) {
            wheel.position = {side, wheel.radius, z};
            def.wheels.push_back(wheel);
        }
        if (!isSingle && dice.below(3) == 0)
            def.antiRollBars.push_back({wheel.axle, def.chassis.mass * magnitude(dice, 1, 50)});
    }
    const float length = 0.5f * base + 0.6f * scale, low = 0.6f * common.radius, tall = 0.25f * scale;
    def.chassis.shapes = {{Box{{half, tall, length}}, {{0, low + tall, 0}, {}}}};
    if (coin(dice))
        def.chassis.shapes.push_back(
            {Box{{0.8f * half, tall, 0.5f * length}}, {{0, low + 3 * tall, -0.1f * length}, {}}});
    def.chassis.centerOfMass = Vec3{0, low + scale * dice.between(0.0f, 0.7f), base * dice.between(-0.15f, 0.15f)};
}

/// The hatchback on a linkage of each kind, of any size.
VehicleDef drawLinked(Dice& dice, float scale, float mass) {
    const LinkageDef fronts[] = {frontStruts(), raceWishbones(), parallelWishbones()};
    VehicleDef def = withLinkages({fronts[dice.below(3)], coin(dice) ? rearArms() : beamOnRods()});
    const auto grow = [&](Vec3& v) { v *= scale; };
    const auto growRod = [&](RodDef& rod) { grow(rod.chassis), grow(rod.carrier); };
    for (LinkageDef& link : def.linkages) {
        if (auto& a = link.doubleWishbone)
            for (Vec3* v : {&a->lowerFront, &a->lowerRear, &a->lowerBall, &a->upperFront, &a->upperRear, &a->upperBall})
                grow(*v);
        if (auto& a = link.mcPherson)
            for (Vec3* v : {&a->lowerFront, &a->lowerRear, &a->lowerBall, &a->strutTop, &a->strutFoot}) grow(*v);
        if (auto& a = link.trailingArm) grow(a->inner), grow(a->outer);
        if (auto& a = link.solidAxle) std::ranges::for_each(a->rods, growRod);
        if (auto& a = link.tieRod) grow(a->inner), grow(a->outer);
        if (link.spring) growRod(*link.spring);
        link.mass *= mass / 1200;
    }
    const float load = mass * 9.81f / 4, torque = load * 0.3f * scale * oneOf(dice, {0.6f, 2.0f, 6.0f});
    const SuspensionDef suspension = drawSuspension(dice, scale);
    const TireDef tire = drawTire(dice, 0.3f * scale, load);
    for (WheelDef& wheel : def.wheels) {
        grow(wheel.position);
        wheel.radius *= scale, wheel.width *= scale, wheel.mass *= mass / 1200;
        wheel.suspension = suspension, wheel.tire = tire;
        wheel.suspension.axis = {0, 1, 0};
        wheel.suspension.travelUp = std::min(suspension.travelUp, 0.09f * scale);
        wheel.suspension.travelDown = std::min(suspension.travelDown, 0.1f * scale);
        wheel.brakeTorque = torque, wheel.handbrakeTorque = wheel.axle == 1 ? torque : 0;
    }
    for (ChassisShape& part : def.chassis.shapes) {
        grow(part.frame.position);
        grow(std::get<Box>(part.shape).halfExtents);
    }
    grow(*def.chassis.centerOfMass);
    *def.chassis.inertia *= mass / 1200 * scale * scale;
    def.chassis.mass = mass;
    return def;
}

}  // namespace

VehicleDef drawCar(Dice& dice, const CarLimits& limits) {
    for (;;) {
        const float scale = magnitude(dice, 0.4f, limits.largest);
        const float mass = std::clamp(1200 * scale * scale * scale * magnitude(dice, 0.4f, 2.5f), 200.0f, 20000.0f);
        const bool isLinked = !limits.isTowed && dice.below(4) == 0;
        VehicleDef def;
        if (isLinked) {
            def = drawLinked(dice, scale, mass);
        } else {
            def.chassis.mass = mass;
            addWheels(dice, def, scale, limits.isTowed);
        }
        def.name = "drawn";
        def.chassis.material = surface(oneOf(dice, {0.1f, 0.3f, 0.8f}));
        if (!limits.isTowed) drawDrive(dice, def, scale);
        drawAir(dice, def, scale);
        const std::uint32_t level = dice.below(8);
        def.level = level == 0              ? VehicleLevel::bicycle
                    : level < 3             ? VehicleLevel::rays
                    : isLinked && level < 7 ? VehicleLevel::linkages
                                            : VehicleLevel::full;
        if (limits.isTowed && level == 0) def.level = VehicleLevel::rays;
        if (whyInvalid(def).empty()) return def;
    }
}

}  // namespace ragtop::laws
