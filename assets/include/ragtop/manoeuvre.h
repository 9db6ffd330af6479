#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/vehicle.h"

/// The test track: what a car is put through and what is measured of it, as a file. Forward is +z, left +x, up +y.
namespace ragtop {

/// A step up that lies across the way: from `at` on the ground is higher.
struct TrackKerb {
    float height = 0.1f;  ///< m
    float at = 20;        ///< m along z
};

/// A wall across the way that does not yield.
struct TrackWall {
    float height = 1;  ///< m
    float at = 20;     ///< m along z, of its face
};

/// Loose cubes scattered over a strip of 3 m, the same ones in every run.
struct TrackRubble {
    float mass = 5;            ///< kg, of each
    float size = 0.08f;        ///< m, of an edge
    float from = 10, to = 30;  ///< m along z
    int count = 100;
};

/// A looping of triangles: a circle that ends beside where it begins.
struct TrackLoop {
    float radius = 12;  ///< m
    float at = 20;      ///< m along z, of its lowest point
    float aside = 6;    ///< m to the left, of its end
    float width = 8;    ///< m
};

struct TrackGround {
    float friction = 0.6f;                 ///< Material::friction
    std::optional<float> rightFriction{};  ///< of what is right of x = 0; empty: the same
    float slope = 0;                       ///< rise over run along z
    std::optional<float> tiles{};          ///< m, length of the tiles that it is laid of; empty: one piece
    std::optional<TrackKerb> kerb{};
    std::optional<TrackWall> wall{};
    std::optional<TrackRubble> rubble{};
    std::optional<TrackLoop> loop{};
};

/// What a car pulls, by a ball a metre behind its rearmost hub: a box on two close axles, with tires like the car's
/// last.
struct TrackTrailer {
    float mass = 700;        ///< kg
    float length = 3.5f;     ///< m from the hitch to the middle between the axles
    float ahead = 0;         ///< m of the centre of mass before that middle
    float yawInertia = 900;  ///< kg m², about the centre of mass
};

/// How the car is put there.
struct TrackStart {
    float height = 0;     ///< m of its origin above where it stands
    float pitch = 0;      ///< rad about x, nose down
    float heading = 0;    ///< rad about y, to the left
    float roll = 0;       ///< rad about z, to the right
    float speed = 0;      ///< m/s forward, wheels rolling
    float sideSpeed = 0;  ///< m/s to the left
};

/// What the driver does from `time` on; between two points pedals and angle change evenly.
struct TrackInput {
    float time = 0;                                            ///< s
    float throttle = 0, brake = 0, handbrake = 0, clutch = 0;  ///< 0 to 1
    float wheelAngle = 0;  ///< rad, of a wheel in the middle of the front axle, to the left
    std::optional<int> gear{};
};

/// A driver who keeps a speed, and a circle or a line if asked to; overrules pedals, and wheel angle where there is one
/// of them. On a line the driver slows down for bends (driver.h).
struct TrackCruise {
    float speed = 20;               ///< m/s
    float until = 1e6f;             ///< s
    std::optional<float> radius{};  ///< m, to the left
    std::vector<DVec3> line{};      ///< m, points of a smooth line on the ground; empty: none
    bool closed = false;            ///< the line is a lap
};

/// What is known of a car at the end of each step.
enum class TrackChannel : unsigned char {
    time,                 ///< s
    speed,                ///< m/s, forward
    distance,             ///< m travelled, along the ground
    drift,                ///< m from the place at the first step
    height,               ///< m of the origin above where it started
    energy,               ///< J, kinetic and potential of bodies, and of springs and tires; potential 0 at y = 0
    yawRate,              ///< rad/s, to the left
    lateralAcceleration,  ///< m/s², speed times yaw rate
    wheelAngle,           ///< rad, mean of the steered wheels
    load,                 ///< N, of all wheels
    largestLoad,          ///< N, of one wheel
    largestSlip,          ///< of the slip ratios, without sign
    upright,              ///< cosine between the car's up axis and the vertical
    asleep,               ///< 1 when it sleeps
    rpm,                  ///< of the engine
    aside,                ///< m to the left of the cruise's line
    laps,                 ///< of the line, that have been driven
    hitchForce,           ///< N, by which the trailer is pulled along the car
    articulation,         ///< rad, of the trailer to the left of the car
};
struct TrackChannelInfo {
    std::string_view name, unit;
};
inline constexpr std::array<TrackChannelInfo, 19> kTrackChannels{{{"time", "s"},
                                                                  {"speed", "m/s"},
                                                                  {"distance", "m"},
                                                                  {"drift", "m"},
                                                                  {"height", "m"},
                                                                  {"energy", "J"},
                                                                  {"yawRate", "rad/s"},
                                                                  {"lateralAcceleration", "m/s²"},
                                                                  {"wheelAngle", "rad"},
                                                                  {"load", "N"},
                                                                  {"largestLoad", "N"},
                                                                  {"largestSlip", "1"},
                                                                  {"upright", "1"},
                                                                  {"asleep", "1"},
                                                                  {"rpm", "rpm"},
                                                                  {"aside", "m"},
                                                                  {"laps", "1"},
                                                                  {"hitchForce", "N"},
                                                                  {"articulation", "rad"}}};
using TrackSample = std::array<double, kTrackChannels.size()>;
constexpr std::array<std::string_view, kTrackChannels.size()> enumNames(TrackChannel) {
    std::array<std::string_view, kTrackChannels.size()> names;
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = kTrackChannels[i].name;
    return names;
}

/// What is taken of a channel between `from` and `to`.
enum class TrackTake : unsigned char {
    first,
    last,
    smallest,
    largest,
    mean,
    change,     ///< last less first
    overshoot,  ///< largest over last, less 1
    rise,       ///< largest over first, less 1
    timeAbove,  ///< s from `from` until it is first at `level` or above
    timeBelow,  ///< s from `from` until it is first at `level` or below
};
constexpr std::array<std::string_view, 10> enumNames(TrackTake) {
    return {"first", "last", "smallest", "largest", "mean", "change", "overshoot", "rise", "timeAbove", "timeBelow"};
}

/// What a value is compared with, computed from the car.
enum class TrackLaw : unsigned char {
    none,
    lockedStop,  ///< m: ln(1 + c v²/a)/(2 c) from the speed at `from`; locked wheels decelerate by a under the loads
                 ///< that a presses them down with, air by c v²
    coastDown,  ///< s: (m/√(AC)) (atan(v₀√(C/A)) − atan(v√(C/A))) from the speed at `from` to `level`; resistance A + C
                ///< v²
    bicycleYaw,  ///< rad/s: v δ/(L + K v²) of the bicycle with the tires' cornering stiffnesses, of speed and angle at
                 ///< `to`
    bicycleSteer,  ///< rad: L/R + K v²/R of the same, R being the cruise's
    hitchPull,     ///< N: (m + Σ ¾ mᵢ) Δv/Δt and the rolling resistance, of the trailer and its wheels
    hitchSwing,    ///< rad: what is taken of the articulation of the linear single-track car and trailer, on tires that
                   ///< relax, at the speeds and wheel angles of the run
};
constexpr std::array<std::string_view, 7> enumNames(TrackLaw) {
    return {"none", "lockedStop", "coastDown", "bicycleYaw", "bicycleSteer", "hitchPull", "hitchSwing"};
}

/// A value, and when it is good: within its limits, and near its reference where there is one.
struct TrackMeasurement {
    std::string name{};
    TrackChannel channel = TrackChannel::speed;
    TrackTake take = TrackTake::last;
    float from = 0, to = 1e6f;  ///< s
    float level = 0;            ///< in the channel's unit
    TrackLaw law = TrackLaw::none;
    std::optional<float> reference{};  ///< instead of a law
    float tolerance = 0.01f;           ///< of the reference
    std::optional<float> least{}, greatest{};
};

struct Manoeuvre {
    std::string name{}, description{};
    float duration = 10;  ///< s
    TrackGround ground{};
    TrackStart start{};
    std::optional<TrackTrailer> trailer{};
    std::vector<TrackInput> input{};
    std::optional<TrackCruise> cruise{};
    bool sleeping = true;
    VehicleLevel leastLevel = VehicleLevel::full;  ///< that models what is measured
    std::vector<TrackChannel> plot{TrackChannel::speed};
    std::vector<TrackMeasurement> measure{};
};

/// Empty when it can be driven; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const Manoeuvre& manoeuvre);
/// Reads name.json. Throws AssetError: "file:line:column: /pointer is value, must be ...".
Manoeuvre loadManoeuvre(const std::filesystem::path& path);
/// Names of those that come with ragtop.
std::vector<std::string> shippedManoeuvres();
/// The file of a shipped one by name, or a path to any. Throws AssetError.
std::filesystem::path findManoeuvre(std::string_view nameOrPath);

struct TrackOptions {
    float hz = 60;
    std::optional<float> seconds{};       ///< instead of the manoeuvre's duration
    std::optional<float> friction{};      ///< instead of the ground's
    std::optional<VehicleLevel> level{};  ///< instead of the car's
};
struct TrackValue {
    std::string name, unit;
    double value = 0;
    std::optional<double> reference{}, error{};  ///< error: relative to the reference
    bool pass = true;
};
struct TrackRun {
    std::vector<TrackSample> samples;  ///< a row per step
    std::vector<TrackValue> values;
};
/// Drives it. Throws std::invalid_argument on a vehicle or options that cannot be used, as a level below the least.
TrackRun drive(const Manoeuvre& manoeuvre, const VehicleDef& def, const TrackOptions& options = {});

}  // namespace ragtop
