#pragma once

#include "gearbox.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

/// What the coupling between engine and gears is offered in a substep.
struct CouplingInput {
    float engineSpeed = 0, shaftSpeed = 0;  ///< rad/s
    float throttle = 0, pedal = 0;          ///< 0 to 1
    float engineTorque = 0;                 ///< N m that the engine makes by itself
    float shiftTimer = 0;                   ///< s until the gear is in
};

/// How it passes torque T from engine to shaft in a substep: within a bound, and slipping by T · give. The shaft gets
/// torqueRatio of it.
struct CouplingLaw {
    float bound = 0;        ///< N m
    float give = 0;         ///< rad/s per N m
    float torqueRatio = 1;  ///< above 1 through the stator of a converter
};

/// A clutch slips at the bound, which is nothing while gears change. Of two clutches the one that takes over passes
///
///     T = T_engine + I (ω_e − ω_s)/t,
///
/// which has the engine at the new gear's speed when the rest t of the shift is over, without a pause in drive. A
/// converter passes K(ν) ω_e² from pump to turbine, ν = ω_s/ω_e, and R(ν) times that on to the shaft
/// [Kiencke, Nielsen, Automotive Control Systems, 2005, 5.2]; what turns faster is the pump, and R is 1 where that is
/// the shaft. It is a damper of c = K ω_e²/(ω_e − ω_s), so that the slip at the end of a substep is what it asks for.
CouplingLaw couplingLaw(const VehicleDef& def, const CouplingInput& in);

/// The map at a speed ratio in [0, 1], straight between its points.
ConverterPoint converterAt(const GearboxDef& def, float speedRatio);

}  // namespace ragtop
