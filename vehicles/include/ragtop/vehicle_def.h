#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/drivetrain_def.h"
#include "ragtop/linkage_def.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tire_laws.h"
#include "ragtop/tunables.h"

/// What a car is made from. In the frame of the chassis z points forward, y up and x, to complete a right-handed
/// frame, to the left. Its origin is wherever the author likes; the wheels say where they are.
namespace ragtop {

/// A piece of the body that collides.
struct ChassisShape {
    Shape shape = Box{};  ///< convex
    Frame frame{};        ///< of the shape in the chassis
};

/// The rigid body of the car.
struct ChassisDef {
    std::vector<ChassisShape> shapes{};
    float mass = 1200;                    ///< kg, of the whole car, wheels included
    std::optional<Vec3> centerOfMass{};   ///< m; empty: that of the shapes
    std::optional<Vec3> inertia{};        ///< kg m², about x, y, z at the centre; empty: that of the shapes
    /// Of the bodywork. It resists rolling by at least 0.14 mean radii of the wheels, and their sides by 0.06 of
    /// theirs: edges that nothing dents would rock for longer.
    Material material{.friction = 0.3f};
    Filter filter{};                      ///< of the bodywork, and of what the wheels stand on
};

/// A point of a damper's curve, at the wheel.
struct DamperPoint {
    float speed = 0;  ///< m/s
    float force = 0;  ///< N against it
};

/// A strut with a linear spring, a damper and stops at both ends of its travel. Unless the compression of the spring is
/// given it is preloaded so that the standing car has its wheels where the definition puts them; with it, the car
/// stands higher on stiffer springs and lower with more mass.
struct SuspensionDef {
    Vec3 axis{0, 1, 0};                        ///< along which the hub rises, in the chassis
    float travelUp = 0.09f;                    ///< m from rest to the bump stop; metal is met half as far again
    float travelDown = 0.10f;                  ///< m from rest to the droop stop; likewise where that yields
    float frequency = 1.4f;                    ///< Hz, undamped, of the load at rest on the spring
    float dampingRatio = 0.35f;                ///< of that oscillation
    std::optional<float> stiffness{};          ///< N/m at the wheel, instead of the frequency
    std::optional<float> springCompression{};  ///< m, with the wheel at its place; empty: what carries the standing car
    std::optional<float> compressionDamping{};  ///< N s/m at the wheel, instead of the ratio
    std::optional<float> reboundDamping{};      ///< N s/m at the wheel, instead of the ratio
    /// Force over speed instead, through (0, 0) and on from the last point as before it: both rise from point to point.
    std::vector<DamperPoint> compressionCurve{}, reboundCurve{};
    float bumpStopStiffness = 10;               ///< over the spring's, where it is first met
    float bumpStopProgression = 0;              ///< share by which it is stiffer where metal is met
    std::optional<float> droopStopStiffness{};  ///< over the spring's, where it is first met; empty: rigid
    float droopStopProgression = 0;             ///< share by which it is stiffer where metal is met
};

/// What a tire makes of a kind of ground.
struct TireSurface {
    std::uint32_t surface = 0;  ///< Material::surface of the ground
    float grip = 1;             ///< its frictions there over those of the tire
    float stiffness = 1;        ///< its stiffnesses there over those of the tire
    float drag = 0;             ///< force over load that resists rolling besides the tire's own, as of sand
};

/// How the tire grips: a brush of bristles whose share that slides grows with slip until all of it does. From there on
/// friction falls to that of a locked wheel.
struct TireDef {
    float longitudinalFriction = 1.05f;  ///< largest force over load along the wheel, at the load of rest
    float lateralFriction = 1.0f;        ///< the same across; both are axes of an ellipse
    float slidingShare = 0.85f;          ///< friction of a locked wheel over the largest
    float referenceSurface = 0.6f;  ///< Material::friction of the ground on which that holds; proportional on others
    std::vector<TireSurface> surfaces{};  ///< grounds on which something else holds, whatever their friction
    float loadSensitivity = 0;            ///< share of the friction lost when the load doubles
    float slipStiffness = 18;             ///< longitudinal force over load per unit of slip, at small slip
    float corneringStiffness = 16;        ///< lateral force over load per radian of slip angle, at small slip
    float relaxationLength = 0.3f;        ///< m rolled until a force has grown to 1 − 1/e of what the slip asks for
    float dampingRatio = 0.5f;            ///< of the car that sways on its standing tires
    float rollingResistance = 0.012f;     ///< resisting force over load
    std::optional<float> radialStiffness{};  ///< N/m; empty: the standing car squashes it by a twentieth of its radius
    /// Laws that hold instead of frictions, slidingShare, loadSensitivity and stiffnesses above; one of them at most.
    std::optional<MagicFormulaDef> magicFormula{};
    std::optional<SlipCurvesDef> slipCurves{};
    /// Of a tire property file (.tir), which loadVehicle reads; empty in a definition that is used.
    std::string file{};
};

/// What a tire does at a load, whatever its law: over the load, on ground that is as the law's own.
struct TireNumbers {
    float longitudinalFriction = 0, lateralFriction = 0;  ///< largest
    float slidingFriction = 0;                            ///< of a locked wheel, along it
    float slipStiffness = 0, corneringStiffness = 0;      ///< per unit of slip; per rad
};
TireNumbers tireNumbers(const TireDef& def, float load);

struct WheelDef {
    std::string name{};
    Vec3 position{};            ///< m, of the hub in the chassis when the car stands
    float radius = 0.3f;        ///< m
    float width = 0.2f;         ///< m
    float mass = 18;            ///< kg, spun as ¾ m r²; part of the chassis's mass
    unsigned axle = 0;          ///< wheels of one axle share a differential; 0 is the foremost
    float steerFactor = 0;      ///< share of the steering angle; negative steers against it
    float driveShare = 0;       ///< of the engine's torque, relative to the sum over the wheels
    float brakeTorque = 1500;   ///< N m, pedal fully down
    float handbrakeTorque = 0;  ///< N m, lever fully up
    std::optional<float> brakeHeatCapacity{};  ///< J/K, of disc and pads; empty: they stay as cold as the air
    float brakeCooling = 10;                   ///< W/K, of a wheel that stands
    float brakeCoolingPerSpeed = 2;            ///< W/K per m/s of its tread, besides
    float brakeFade = 0;  ///< 1/K: pads hold 1/(1 + fade ΔT) of their torque where they are ΔT warmer than the air
    SuspensionDef suspension{};
    TireDef tire{};
};

/// A bar that twists where the wheels of an axle are not equally high: each is pressed down by its stiffness times what
/// it is higher than the other.
struct AntiRollBarDef {
    unsigned axle = 0;    ///< WheelDef::axle, of two wheels
    float stiffness = 0;  ///< N/m, force on each wheel over the difference of their compressions
};

struct SteeringDef {
    float maxAngle = 0.6f;                  ///< rad, of a wheel in the middle of the front axle
    float rate = 1.5f;                      ///< rad/s, fastest change
    std::optional<float> halfAngleSpeed{};  ///< m/s at which half of the angle is left; empty: all at any speed
    float ackermann = 1;                    ///< 1: all wheels turn about one point; 0: all turn by the same angle
};

/// Lift that acts at an axle, besides that of the whole car.
struct AxleLiftDef {
    unsigned axle = 0;   ///< WheelDef::axle
    float liftArea = 0;  ///< m², lift coefficient times area; negative presses the axle down
    float perHeight = 0;  ///< m²/m: of that area more where the struts hold the axle's body higher than at rest
};

/// Forces of the air that the car goes through: ½ ρ v² over areas, and over lengths of moments.
struct AerodynamicsDef {
    float dragArea = 0.65f;                ///< m², drag coefficient times frontal area
    float liftArea = 0;                    ///< m², lift coefficient times area; negative presses the car down
    std::vector<AxleLiftDef> axleLifts{};  ///< one to an axle at most
    float sideArea = 0;                    ///< m², over the sine of the angle at which it drifts, and against that
    float yawVolume = 0;                   ///< m³, likewise; positive turns the nose to where it drifts, as fins do
    Vec3 center{0, 0, 0};                  ///< m from the centre of mass, where lift, drag and side force act
    float airDensity = 1.2f;               ///< kg/m³
};

/// What the car looks like; nothing that moves depends on it.
struct VehicleVisualDef {
    std::string chassis{};                  ///< model file, of the bodywork or of the whole car
    Frame frame{};                          ///< of the model in the chassis
    float scale = 1;                        ///< over the size in the file
    std::string wheel{};                    ///< model file of every wheel: axle along x, outside towards +x
    std::vector<std::string> wheelNodes{};  ///< or the nodes of the model that are its wheels, in the order of those
};

/// How much of a car is modelled; all levels have the same controls, telemetry and state. What a level leaves out is
/// told as zero, and listed in docs/vehicles.md.
enum class VehicleLevel : unsigned char {
    bicycle,   ///< 0: kinematic, on the ground as a single-track model with linear tires
    rays,      ///< 1: wheels are rays, one solve for the whole step, brush tires; no sides of wheels
    full,      ///< 2: wheels on struts, or on the curves of their linkages
    linkages,  ///< 3: and what carries them is bodies on joints; of cars whose wheels all have a linkage
};
constexpr std::array<std::string_view, 4> enumNames(VehicleLevel) { return {"bicycle", "rays", "full", "linkages"}; }

struct VehicleDef {
    std::string name{};
    VehicleLevel level = VehicleLevel::full;  ///< Vehicle::setLevel changes it
    ChassisDef chassis{};
    std::vector<WheelDef> wheels{};              ///< three or more
    std::vector<AntiRollBarDef> antiRollBars{};  ///< one to an axle at most
    std::vector<LinkageDef> linkages{};          ///< one to an axle at most; wheels of others go along their struts
    SteeringDef steering{};
    EngineDef engine{};
    GearboxDef gearbox{};
    DifferentialDef differential{};        ///< between the wheels of each driven axle
    DifferentialDef centerDifferential{};  ///< between driven axles, where there are several
    AerodynamicsDef aerodynamics{};
    std::optional<VehicleVisualDef> visual{};  ///< empty: its shapes are drawn
};

/// Empty when the definition is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const VehicleDef& def);

/// What a file must say.
constexpr std::array<const char*, 1> requiredFields(const ChassisShape*) { return {"shape"}; }
constexpr std::array<const char*, 2> requiredFields(const ChassisDef*) { return {"shapes", "mass"}; }
constexpr std::array<const char*, 2> requiredFields(const DamperPoint*) { return {"speed", "force"}; }
constexpr std::array<const char*, 2> requiredFields(const AntiRollBarDef*) { return {"axle", "stiffness"}; }
constexpr std::array<const char*, 2> requiredFields(const AxleLiftDef*) { return {"axle", "liftArea"}; }
constexpr std::array<const char*, 2> requiredFields(const TireSurface*) { return {"surface", "grip"}; }
constexpr std::array<const char*, 2> requiredFields(const WheelDef*) { return {"position", "radius"}; }
constexpr std::array<const char*, 1> requiredFields(const VehicleVisualDef*) { return {"chassis"}; }
constexpr std::array<const char*, 2> requiredFields(const VehicleDef*) { return {"chassis", "wheels"}; }

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ChassisShape*) {
    visit(Tunable{"shape", "", 0, 0, "a box, sphere, capsule or hull"}, self.shape);
    visit(Tunable{"frame", "", 0, 0, "of the shape in the chassis"}, self.frame);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ChassisDef*) {
    visit(Tunable{"shapes", "", 0, 0, "pieces of the body that collide"}, self.shapes);
    visit(Tunable{"mass", "kg", 1e-3, 1e9, "of the whole car, wheels included"}, self.mass);
    visit(Tunable{"centerOfMass", "m", -1e4, 1e4, "in the chassis; absent: that of the shapes"}, self.centerOfMass);
    visit(Tunable{"inertia", "kg m²", 1e-9, 1e15, "about x, y, z at the centre of mass; absent: that of the shapes"},
          self.inertia);
    visit(Tunable{"material", "", 0, 0, "of the bodywork"}, self.material);
    visit(Tunable{"filter", "", 0, 0, "what bodywork and wheels collide with"}, self.filter);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DamperPoint*) {
    visit(Tunable{"speed", "m/s", 1e-6, 1e4, "of the damper, at the wheel"}, self.speed);
    visit(Tunable{"force", "N", 0, 1e12, "against it"}, self.force);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const AntiRollBarDef*) {
    visit(Tunable{"axle", "", 0, 255, "of two wheels"}, self.axle);
    visit(Tunable{"stiffness", "N/m", 0, 1e12, "force on each wheel over the difference of their compressions"},
          self.stiffness);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SuspensionDef*) {
    visit(Tunable{"axis", "", -1, 1, "along which the hub rises, in the chassis"}, self.axis);
    visit(Tunable{"travelUp", "m", 1e-4, 1e3, "from rest to the bump stop"}, self.travelUp);
    visit(Tunable{"travelDown", "m", 1e-4, 1e3, "from rest to the droop stop"}, self.travelDown);
    visit(Tunable{"frequency", "Hz", 0.1, 20, "of the load at rest on the spring"}, self.frequency);
    visit(Tunable{"dampingRatio", "1", 0, 5, "of that oscillation"}, self.dampingRatio);
    visit(Tunable{"stiffness", "N/m", 1e-3, 1e12, "at the wheel, instead of the frequency"}, self.stiffness);
    visit(
        Tunable{"springCompression", "m", 0, 1e3, "with the wheel at its place; absent: what carries the standing car"},
        self.springCompression);
    visit(Tunable{"compressionDamping", "N s/m", 0, 1e12, "at the wheel, instead of the ratio"},
          self.compressionDamping);
    visit(Tunable{"reboundDamping", "N s/m", 0, 1e12, "at the wheel, instead of the ratio"}, self.reboundDamping);
    visit(Tunable{"compressionCurve", "", 0, 0, "force over speed as it is compressed, instead"},
          self.compressionCurve);
    visit(Tunable{"reboundCurve", "", 0, 0, "force over speed as it extends, instead"}, self.reboundCurve);
    visit(Tunable{"bumpStopStiffness", "1", 0, 1000, "of the bump stop over that of the spring, where it is first met"},
          self.bumpStopStiffness);
    visit(Tunable{"bumpStopProgression", "1", 0, 1000, "share by which it is stiffer where metal is met"},
          self.bumpStopProgression);
    visit(Tunable{"droopStopStiffness", "1", 1e-3, 1000,
                  "of the droop stop over that of the spring, where it is first met; absent: rigid"},
          self.droopStopStiffness);
    visit(Tunable{"droopStopProgression", "1", 0, 1000, "share by which it is stiffer where metal is met"},
          self.droopStopProgression);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TireSurface*) {
    visit(Tunable{"surface", "", 0, 4294967295.0, "the ground's name for itself, as its material has it"},
          self.surface);
    visit(Tunable{"grip", "1", 0, 10, "frictions there over those of the tire"}, self.grip);
    visit(Tunable{"stiffness", "1", 0.01, 10, "stiffnesses there over those of the tire"}, self.stiffness);
    visit(Tunable{"drag", "1", 0, 1, "force over load that resists rolling there"}, self.drag);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TireDef*) {
    visit(Tunable{"longitudinalFriction", "1", 0, 10, "largest force over load along the wheel"},
          self.longitudinalFriction);
    visit(Tunable{"lateralFriction", "1", 0, 10, "largest force over load across the wheel"}, self.lateralFriction);
    visit(Tunable{"slidingShare", "1", 0.1, 1, "friction of a locked wheel over the largest"}, self.slidingShare);
    visit(Tunable{"referenceSurface", "1", 1e-3, 10, "friction of the ground on which that holds"},
          self.referenceSurface);
    visit(Tunable{"surfaces", "", 0, 0, "grounds on which something else holds"}, self.surfaces);
    visit(Tunable{"loadSensitivity", "1", 0, 0.5, "share of the friction lost when the load doubles"},
          self.loadSensitivity);
    visit(Tunable{"slipStiffness", "1", 1, 100, "longitudinal force over load per unit of slip"}, self.slipStiffness);
    visit(Tunable{"corneringStiffness", "1/rad", 1, 100, "lateral force over load per slip angle"},
          self.corneringStiffness);
    visit(Tunable{"relaxationLength", "m", 1e-3, 1e3, "rolled until a force has grown to 63 % of its end value"},
          self.relaxationLength);
    visit(Tunable{"dampingRatio", "1", 0, 1, "of the car that sways on its standing tires"}, self.dampingRatio);
    visit(Tunable{"rollingResistance", "1", 0, 1, "resisting force over load"}, self.rollingResistance);
    visit(Tunable{"radialStiffness", "N/m", 1, 1e12,
                  "of the tire; absent: the standing car squashes it by a twentieth of its radius"},
          self.radialStiffness);
    visit(Tunable{"magicFormula", "", 0, 0, "coefficients of the Magic Formula, instead of frictions and stiffnesses"},
          self.magicFormula);
    visit(Tunable{"slipCurves", "", 0, 0, "curves of friction over slip, instead of frictions and stiffnesses"},
          self.slipCurves);
    visit(Tunable{"file", "", 0, 0,
                  "a tire property file (.tir) that gives magicFormula, radial stiffness and relaxation"},
          self.file);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const WheelDef*) {
    visit(Tunable{"name"}, self.name);
    visit(Tunable{"position", "m", -1e4, 1e4, "of the hub in the chassis when the car stands"}, self.position);
    visit(Tunable{"radius", "m", 1e-3, 1e3, "of the tire"}, self.radius);
    visit(Tunable{"width", "m", 1e-4, 1e3, "of the tire"}, self.width);
    visit(Tunable{"mass", "kg", 1e-4, 1e8, "of wheel and tire, spun as ¾ m r²"}, self.mass);
    visit(Tunable{"axle", "", 0, 255, "wheels of one axle share a differential; 0 is the foremost"}, self.axle);
    visit(Tunable{"steerFactor", "1", -1, 1, "share of the steering angle"}, self.steerFactor);
    visit(Tunable{"driveShare", "1", 0, 1000, "of the engine's torque, relative to the other wheels"}, self.driveShare);
    visit(Tunable{"brakeTorque", "N m", 0, 1e12, "pedal fully down"}, self.brakeTorque);
    visit(Tunable{"handbrakeTorque", "N m", 0, 1e12, "lever fully up"}, self.handbrakeTorque);
    visit(Tunable{"brakeHeatCapacity", "J/K", 1, 1e12, "of disc and pads; absent: they stay as cold as the air"},
          self.brakeHeatCapacity);
    visit(Tunable{"brakeCooling", "W/K", 0, 1e9, "of a wheel that stands"}, self.brakeCooling);
    visit(Tunable{"brakeCoolingPerSpeed", "W s/(K m)", 0, 1e9, "besides, of the speed of its tread"},
          self.brakeCoolingPerSpeed);
    visit(Tunable{"brakeFade", "1/K", 0, 1, "pads hold 1/(1 + fade dT) of their torque, dT warmer than the air"},
          self.brakeFade);
    visit(Tunable{"suspension", "", 0, 0, "spring, damper and travel"}, self.suspension);
    visit(Tunable{"tire", "", 0, 0, "how the tire grips"}, self.tire);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SteeringDef*) {
    visit(Tunable{"maxAngle", "rad", 0, 1.5, "of a wheel in the middle of the front axle"}, self.maxAngle);
    visit(Tunable{"rate", "rad/s", 1e-3, 1e4, "fastest change of the angle"}, self.rate);
    visit(Tunable{"halfAngleSpeed", "m/s", 1e-3, 1e5, "at which half of the angle is left; absent: all at any speed"},
          self.halfAngleSpeed);
    visit(Tunable{"ackermann", "1", 0, 1, "1: all wheels turn about one point; 0: by the same angle"}, self.ackermann);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const AxleLiftDef*) {
    visit(Tunable{"axle", "", 0, 255, "at whose wheels it acts"}, self.axle);
    visit(Tunable{"liftArea", "m²", -1e6, 1e6, "lift coefficient times area; negative presses down"}, self.liftArea);
    visit(Tunable{"perHeight", "m²/m", -1e6, 1e6, "more of it where struts hold the axle's body higher than at rest"},
          self.perHeight);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const AerodynamicsDef*) {
    visit(Tunable{"dragArea", "m²", 0, 1e6, "drag coefficient times frontal area"}, self.dragArea);
    visit(Tunable{"liftArea", "m²", -1e6, 1e6, "lift coefficient times area; negative presses down"}, self.liftArea);
    visit(Tunable{"axleLifts", "", 0, 0, "lift at axles, besides"}, self.axleLifts);
    visit(Tunable{"sideArea", "m²", 0, 1e6, "side force coefficient times area, over the sine of the angle of drift"},
          self.sideArea);
    visit(Tunable{"yawVolume", "m³", -1e6, 1e6, "yaw moment likewise; positive turns the nose to where it drifts"},
          self.yawVolume);
    visit(Tunable{"center", "m", -1e4, 1e4, "where drag, lift and side force act, from the centre of mass"},
          self.center);
    visit(Tunable{"airDensity", "kg/m³", 0, 1e4, "of the air"}, self.airDensity);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VehicleVisualDef*) {
    visit(Tunable{"chassis", "", 0, 0, "model file, of the bodywork or of the whole car"}, self.chassis);
    visit(Tunable{"frame", "", 0, 0, "of the model in the chassis"}, self.frame);
    visit(Tunable{"scale", "1", 1e-6, 1e6, "over the size in the file"}, self.scale);
    visit(Tunable{"wheel", "", 0, 0, "model file of every wheel: axle along x, outside towards +x"}, self.wheel);
    visit(Tunable{"wheelNodes", "", 0, 0, "or the nodes of the model that are its wheels, in the order of those"},
          self.wheelNodes);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VehicleDef*) {
    visit(Tunable{"name"}, self.name);
    visit(Tunable{"level", "", 0, 0, "how much of it is modelled"}, self.level);
    visit(Tunable{"chassis", "", 0, 0, "the rigid body"}, self.chassis);
    visit(Tunable{"wheels", "", 0, 0, "three or more"}, self.wheels);
    visit(Tunable{"antiRollBars", "", 0, 0, "between the wheels of an axle"}, self.antiRollBars);
    visit(Tunable{"linkages", "", 0, 0, "hardpoints of axles, instead of struts' axes"}, self.linkages);
    visit(Tunable{"steering", "", 0, 0, "from the input to the wheels"}, self.steering);
    visit(Tunable{"engine", "", 0, 0, "torque and inertia"}, self.engine);
    visit(Tunable{"gearbox", "", 0, 0, "gears, clutch and shifting"}, self.gearbox);
    visit(Tunable{"differential", "", 0, 0, "between the wheels of each driven axle"}, self.differential);
    visit(Tunable{"centerDifferential", "", 0, 0, "between driven axles"}, self.centerDifferential);
    visit(Tunable{"aerodynamics", "", 0, 0, "drag and lift"}, self.aerodynamics);
    visit(Tunable{"visual", "", 0, 0, "what it looks like; absent: its shapes are drawn"}, self.visual);
}

}  // namespace ragtop
