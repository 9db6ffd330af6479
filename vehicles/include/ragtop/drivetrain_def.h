#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "ragtop/tunables.h"

/// What drives a car: an engine or motor, what couples it to the gears, the gears, and the differentials behind them.
namespace ragtop {

/// A point of the full-throttle torque curve.
struct TorquePoint {
    float rpm = 0;
    float torque = 0;  ///< N m at the flywheel
};

/// A motor with level torque up to where that takes all of its power, and power over speed beyond (field weakening).
struct ElectricMotorDef {
    float torque = 300;         ///< N m
    float power = 100e3f;       ///< W
    float regeneration = 0.3f;  ///< share of its torque at a speed, by which it brakes at closed throttle
};

/// Torque that comes after the throttle: d b/dt = (throttle − b)/spoolTime.
struct TurboDef {
    float share = 0.4f;      ///< of the torque curve that is there at full boost alone
    float spoolTime = 0.4f;  ///< s
};

struct EngineDef {
    std::vector<TorquePoint> torqueCurve{{800, 80}, {1500, 105}, {3500, 135}, {4500, 132}, {6000, 112}, {6600, 90}};
    float inertia = 0.15f;  ///< kg m², with flywheel and clutch
    float idleRpm = 850;
    float limiterRpm = 6400;
    float brakeTorque = 25;    ///< N m that resist at closed throttle
    float brakeViscosity = 0;  ///< N m s/rad, besides
    std::optional<TurboDef> turbo{};
    std::optional<ElectricMotorDef> electric{};  ///< instead of torque curve, idle and what resists
};

/// What is between engine and gears.
enum class CouplingType : unsigned char {
    clutch,      ///< open while gears change
    dualClutch,  ///< hands the engine from gear to gear without a pause in drive
    converter,   ///< hydrodynamic, never open
};

/// Names in files, in the order of the values.
constexpr std::array<std::string_view, 3> enumNames(CouplingType) { return {"clutch", "dualClutch", "converter"}; }

/// A point of the map of a torque converter, by speed of its turbine over that of its pump.
struct ConverterPoint {
    float speedRatio = 0;
    float torqueRatio = 1;  ///< torque of the turbine over that of the pump; no more than keeps power from growing
    float capacity = 0;     ///< N m s²/rad², torque of the pump over the square of its speed
};

struct GearboxDef {
    std::vector<float> ratios{3.6f, 2.0f, 1.35f, 1.0f, 0.8f};
    float reverseRatio = 3.4f;
    float finalDrive = 4.0f;
    bool automatic = true;    ///< picks the forward gears itself
    float shiftUpRpm = 5800;  ///< at full throttle; half as far above shiftDownRpm at none
    float shiftDownRpm = 1800;
    /// Any ratio from the first to the last, chosen for an engine speed from shiftDownRpm to shiftUpRpm by throttle.
    bool continuous = false;
    float shiftTime = 0.25f;   ///< s of a change of gear; continuous: from end to end
    float efficiency = 0.92f;  ///< of all gears together
    CouplingType coupling = CouplingType::clutch;
    std::optional<float> clutchTorque{};  ///< N m; empty: twice the engine's largest
    std::vector<ConverterPoint> converterMap{{0, 2, 0.0028f}, {0.6f, 1.4f, 0.0027f}, {0.85f, 1, 0.0022f}, {1, 1, 0}};
    std::optional<float> lockUpRatio{};  ///< speed ratio from which a clutch bridges the converter; empty: never
};

enum class DifferentialType : unsigned char {
    open,         ///< equal torques
    locked,       ///< equal speeds
    limitedSlip,  ///< plates: torques that differ by at most preload + lockingRatio · torque
    helical,      ///< the larger torque is at most torqueBias times the smaller
    viscous,      ///< viscosity · difference of speeds from the faster to the slower
    active,       ///< up to the driver's differentialLock · activeTorque from the faster to the slower
};

/// Names in files, in the order of the values.
constexpr std::array<std::string_view, 6> enumNames(DifferentialType) {
    return {"open", "locked", "limitedSlip", "helical", "viscous", "active"};
}

struct DifferentialDef {
    DifferentialType type = DifferentialType::open;
    float preload = 40;                        ///< N m, limitedSlip only
    float lockingRatio = 0.3f;                 ///< limitedSlip only
    std::optional<float> coastLockingRatio{};  ///< while the wheels drive the engine; empty: the same
    float torqueBias = 2.5f;                   ///< helical only
    float viscosity = 50;                      ///< N m s/rad, viscous only
    float activeTorque = 800;                  ///< N m, active only
};

constexpr std::array<const char*, 2> requiredFields(const TorquePoint*) { return {"rpm", "torque"}; }
constexpr std::array<const char*, 3> requiredFields(const ConverterPoint*) {
    return {"speedRatio", "torqueRatio", "capacity"};
}
constexpr std::array<const char*, 2> requiredFields(const ElectricMotorDef*) { return {"torque", "power"}; }

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TorquePoint*) {
    visit(Tunable{"rpm", "rpm", 0, 1e6, "engine speed"}, self.rpm);
    visit(Tunable{"torque", "N m", 0, 1e12, "at the flywheel, full throttle"}, self.torque);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ElectricMotorDef*) {
    visit(Tunable{"torque", "N m", 0, 1e12, "at low speed"}, self.torque);
    visit(Tunable{"power", "W", 1e-3, 1e12, "that bounds torque times speed"}, self.power);
    visit(Tunable{"regeneration", "1", 0, 1, "share of the torque that brakes at closed throttle"}, self.regeneration);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TurboDef*) {
    visit(Tunable{"share", "1", 0, 1, "of the torque that is there at full boost alone"}, self.share);
    visit(Tunable{"spoolTime", "s", 0, 100, "until boost is within 1/e of the throttle"}, self.spoolTime);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const EngineDef*) {
    visit(Tunable{"torqueCurve", "", 0, 0, "full throttle, by rising speed"}, self.torqueCurve);
    visit(Tunable{"inertia", "kg m²", 1e-9, 1e12, "with flywheel and clutch"}, self.inertia);
    visit(Tunable{"idleRpm", "rpm", 1, 1e6, "speed at closed throttle"}, self.idleRpm);
    visit(Tunable{"limiterRpm", "rpm", 1, 1e6, "speed that the engine does not pass by itself"}, self.limiterRpm);
    visit(Tunable{"brakeTorque", "N m", 0, 1e12, "that resists at closed throttle"}, self.brakeTorque);
    visit(Tunable{"brakeViscosity", "N m s/rad", 0, 1e9, "that resists besides, over speed"}, self.brakeViscosity);
    visit(Tunable{"turbo", "", 0, 0, "torque that comes after the throttle"}, self.turbo);
    visit(Tunable{"electric", "", 0, 0, "a motor instead of torque curve, idle and what resists"}, self.electric);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ConverterPoint*) {
    visit(Tunable{"speedRatio", "1", 0, 1, "speed of the turbine over that of the pump"}, self.speedRatio);
    visit(Tunable{"torqueRatio", "1", 1, 100, "torque of the turbine over that of the pump"}, self.torqueRatio);
    visit(Tunable{"capacity", "N m s²/rad²", 0, 1e6, "torque of the pump over its speed squared"}, self.capacity);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GearboxDef*) {
    visit(Tunable{"ratios", "1", 0.01, 100, "forward gears, falling"}, self.ratios);
    visit(Tunable{"reverseRatio", "1", 0.01, 100, "of the reverse gear"}, self.reverseRatio);
    visit(Tunable{"finalDrive", "1", 0.01, 100, "that follows every gear"}, self.finalDrive);
    visit(Tunable{"automatic", "", 0, 1, "picks the forward gears itself"}, self.automatic);
    visit(Tunable{"shiftUpRpm", "rpm", 1, 1e6, "to the next gear, at full throttle"}, self.shiftUpRpm);
    visit(Tunable{"shiftDownRpm", "rpm", 1, 1e6, "to the gear before"}, self.shiftDownRpm);
    visit(Tunable{"continuous", "", 0, 1, "any ratio from the first to the last"}, self.continuous);
    visit(Tunable{"shiftTime", "s", 0, 10, "of a change of gear; continuous: from end to end"}, self.shiftTime);
    visit(Tunable{"efficiency", "1", 0.1, 1, "of all gears together"}, self.efficiency);
    visit(Tunable{"coupling", "", 0, 0, "clutch, dualClutch or converter"}, self.coupling);
    visit(Tunable{"clutchTorque", "N m", 0, 1e12, "that it passes on; absent: twice the engine's largest"},
          self.clutchTorque);
    visit(Tunable{"converterMap", "", 0, 0, "of the converter, by rising speed ratio from 0 to 1"}, self.converterMap);
    visit(Tunable{"lockUpRatio", "1", 0, 1, "speed ratio from which a clutch bridges the converter; absent: never"},
          self.lockUpRatio);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DifferentialDef*) {
    visit(Tunable{"type", "", 0, 0, "open, locked, limitedSlip, helical, viscous or active"}, self.type);
    visit(Tunable{"preload", "N m", 0, 1e12, "by which torques may differ without load"}, self.preload);
    visit(Tunable{"lockingRatio", "1", 0, 1, "share of the torque by which torques may differ"}, self.lockingRatio);
    visit(Tunable{"coastLockingRatio", "1", 0, 1, "while the wheels drive the engine; absent: the same"},
          self.coastLockingRatio);
    visit(Tunable{"torqueBias", "1", 1, 1000, "helical: the larger torque over the smaller, at most"}, self.torqueBias);
    visit(Tunable{"viscosity", "N m s/rad", 0, 1e9, "viscous: torque passed over the difference of speeds"},
          self.viscosity);
    visit(Tunable{"activeTorque", "N m", 0, 1e12, "active: torque passed at full differentialLock"}, self.activeTorque);
}

}  // namespace ragtop
