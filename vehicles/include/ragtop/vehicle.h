#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

class World;

/// What the driver does. Values beyond their range count as its end, values that are no number as zero.
struct VehicleInput {
    float throttle = 0;          ///< 0 to 1
    float brake = 0;             ///< 0 to 1
    float steer = 0;             ///< −1 full left to 1 full right
    float handbrake = 0;         ///< 0 to 1
    float clutch = 0;            ///< 0 automatic to 1 pedal fully down
    std::optional<int> gear{};   ///< −1 reverse, 0 neutral, 1 and up; empty: the gearbox decides, or keeps its gear
    float differentialLock = 0;  ///< 0 to 1, of active differentials
    std::array<float, 16> wheelTorques{};  ///< N m forward on the first wheels, beside engine and brakes
    Vec3 wind{};                           ///< m/s of the air about the car, in the world

    bool operator==(const VehicleInput&) const = default;
};

/// Where a car starts.
struct VehiclePlacement {
    DVec3 position{};   ///< m, of the chassis frame
    float heading = 0;  ///< rad about y; 0 looks along +z, π/2 along +x
    float speed = 0;    ///< m/s forward, wheels rolling
};

/// What a wheel does, at the end of the last step. Its numbers are listed in ragtop/telemetry.h.
struct WheelTelemetry {
    bool grounded = false;
    float load = 0;               ///< N, normal to the ground
    float peakLoad = 0;           ///< N, largest within the last step
    float longitudinalForce = 0;  ///< N on the car, forward
    float lateralForce = 0;       ///< N on the car, to the left
    float aligningMoment = 0;     ///< N m on the car about the ground's normal, to the left
    float slipRatio = 0;          ///< tread less travel speed, over the larger of them or 1 m/s; −1 is a locked wheel
    float slipAngle =
        0;  ///< rad from the heading to the travel, fading below 1 m/s; positive when it drifts to the left
    float angularSpeed = 0;  ///< rad/s, positive forward
    float rotation = 0;      ///< rad about the axle, in (−π, π]
    float steerAngle = 0;    ///< rad, positive to the left
    float compression = 0;   ///< m above the place at rest
    float springForce = 0;   ///< N of spring and stops, along the strut
    float damperForce = 0,
          antiRollForce = 0;  ///< N of damper and bar, along the strut; positive presses the wheel down
    float tireSquash = 0;     ///< m by which the load has pressed the tire in
    float gripUsed = 0;       ///< share of the largest friction that the tire uses
    float slipPower = 0;      ///< W that the patch turns into heat
    float deflectionForward = 0, deflectionLeft = 0;  ///< m of the tread in the patch
    float travelForward = 0, travelLeft = 0;          ///< m/s of the patch over the ground
    float brakeTorque = 0;                            ///< N m of pads and rolling resistance on the wheel
    float brakeTemperature = 0;                       ///< K of disc and pads over the air
    float camber = 0;      ///< rad of the wheel to the normal of the ground; positive with its top to the left
    float radius = 0;      ///< m
    DVec3 contactPoint{};  ///< m, on the ground; the last one when in the air
    Vec3 contactNormal{0, 1, 0};
    BodyId ground{};            ///< what it stands on
    std::uint32_t surface = 0;  ///< Material::surface there
    Pose pose{};                ///< of the hub, for drawing: x to the left along the axle, turned by `rotation`
};

struct EngineTelemetry {
    float rpm = 0;
    float torque = 0;  ///< N m at the flywheel, negative when the engine brakes
    float power = 0;   ///< W there
};

/// Where the engine's work has gone since the car was put where it started, J:
///
///     engine = Δ(kinetic + potential energy of the chassis) + Δrotating + all that follows
struct EnergyTelemetry {
    double engine = 0;                                ///< net of what resists; and of wheelTorques
    double clutch = 0, gears = 0, differentials = 0;  ///< lost
    double brakes = 0, rolling = 0;                   ///< lost to pads; to tires and ground that roll
    double slip = 0;                                  ///< into patches: heat, and what bends treads
    double struts = 0;                                ///< into dampers, springs and squashed tires
    double air = 0;                                   ///< lost
    double rotating = 0;                              ///< of engine and wheels about their axles, now
    double elastic = 0;                               ///< of springs, stops, bars, squashed tires and bent treads, now
};

/// What the car does, at the end of the last step.
struct VehicleTelemetry {
    float speed = 0;                                 ///< m/s forward, negative backwards
    float sideSpeed = 0, climbSpeed = 0;             ///< m/s to the left; up in the world
    float yawRate = 0, pitchRate = 0, rollRate = 0;  ///< rad/s to the left, nose down, to the right; in the car's axes
    float heading = 0, pitch = 0, roll = 0;          ///< rad to the left of z, nose down, to the right
    float kineticEnergy = 0;                         ///< J of the chassis
    float drag = 0, lift = 0, sideForce = 0;         ///< N of the air: against the way, up, to the left
    EngineTelemetry engine{};
    int gear = 0;  ///< −1 reverse, 0 neutral
    bool shifting = false;
    EnergyTelemetry energy{};
    float clutchTorque = 0;                                    ///< N m from the engine into the gearbox
    float throttle = 0, brake = 0, handbrake = 0, clutch = 0;  ///< 0 to 1, of the last step
    float steerAngle = 0;                                      ///< rad of a wheel in the middle of the front axle, left
    std::span<const WheelTelemetry> wheels{};  ///< in the order of the definition; there as long as the car
};

struct VehicleSim;

/// A car in a world: one rigid body for the chassis, and wheels on struts that live in this module. It takes part in
/// the world's steps, saves and hashes. The world must outlive it; destroying the car destroys its chassis.
///
/// Save and restore keep the input too, so that a restored world goes on by itself as the saved one did.
class Vehicle {
public:
    /// Throws std::invalid_argument that says which field is wrong.
    Vehicle(World& world, const VehicleDef& def, const VehiclePlacement& placement = {});
    Vehicle(Vehicle&& other) noexcept;
    ~Vehicle();

private:
    std::unique_ptr<VehicleSim> sim_;

public:
    VehicleInput& input;  ///< read at the beginning of each step

    BodyId chassis() const;
    const VehicleDef& def() const;
    /// Changes what the car is made from while it drives: it keeps its motion, and its engine, wheels and tires theirs.
    /// The number of wheels, their radii, widths and struts' axes, and the shapes of the chassis stay as they are.
    /// Throws std::invalid_argument that says which field is wrong, and changes nothing then.
    void setDef(const VehicleDef& def);
    /// Changes how much of the car is modelled, as it drives: it keeps place and velocity, and its wheels, tires and
    /// engine what both levels know of them. Saved and restored with the car. At VehicleLevel::bicycle the chassis is
    /// kinematic; at VehicleLevel::linkages the car has more bodies, on joints to the chassis, which go with the level.
    /// Throws std::invalid_argument where it has no linkages for that, and, within a step, std::logic_error.
    void setLevel(VehicleLevel level);
    /// Puts the car somewhere, upright, as if it had been made there; the input stays. Throws std::invalid_argument.
    void place(const VehiclePlacement& placement);
    /// Sets how the whole car moves, as one body: the velocity of its centre of mass, m/s, and its angular velocity,
    /// rad/s, in the world; wheels go on turning as they do. World::setVelocity of the chassis leaves alone what
    /// carries wheels at VehicleLevel::linkages, and joints then share its momentum. Throws as that does.
    void setVelocity(const Vec3& linear, const Vec3& angular);
    /// Of now; what it returned before is brought up to date by the next call. Costs nothing where nobody asks.
    const VehicleTelemetry& telemetry() const;
    /// Loads on the wheels of the car that stands on level ground, N.
    std::span<const float> staticLoads() const;
};

}  // namespace ragtop
