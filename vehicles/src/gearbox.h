#pragma once

#include <cstdint>
#include <optional>

#include "ragtop/vehicle_def.h"

namespace ragtop {

struct GearboxState {
    std::int32_t gear = 1;  ///< −1 reverse, 0 neutral
    float shiftTimer = 0;   ///< s until drive is back
    float ratio = 0;        ///< of a continuous gearbox; 0 before it has been chosen
    bool operator==(const GearboxState&) const = default;
};

/// Engine speed over speed of the driven axles; negative in reverse, 0 in neutral.
float gearing(const GearboxDef& def, int gear);
/// With what a continuous gearbox has chosen.
float gearing(const GearboxDef& def, const GearboxState& state);
/// The highest gear that can be asked for.
int highestGear(const GearboxDef& def);

/// Picks the gear for the coming step of dt. `axleSpeed` is that of the driven axles if their wheels did not slip,
/// rad/s: wheels that spin do not hurry the gearbox on. A gear asked for is clamped to those there are.
void shift(const GearboxDef& def, GearboxState& state, std::optional<int> wanted, float axleSpeed, float throttle,
           float dt);

/// rad/s of the engine at which the clutch holds fully: the higher the more throttle there is.
float launchSpeed(const EngineDef& def, float throttle);

/// The torque that the clutch passes on at most. It takes hold as the engine rises above idle, later the more
/// throttle there is, and whatever the engine does once the gearbox turns fast enough to carry it.
/// Speeds in rad/s; `pedal` 0 to 1.
float clutchCapacity(const VehicleDef& def, float engineSpeed, float shaftSpeed, float throttle, float pedal);

}  // namespace ragtop
