#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ragtop/vehicle.h"
#include "terrain.h"

namespace ragtop::fleet {

/// Cars in rows, each of which goes round in a circle of its own to the right: with its wheels at a fixed angle, and a
/// throttle that falls as its speed grows.
struct Course {
    int cars = 100;
    std::string ground = "hills";
    int threads = 1;
    VehicleLevel level = VehicleLevel::full;
    bool asleep = false;         ///< braked, from when all sleep
    bool processorTime = false;  ///< of all processors together, instead of what passes
    static constexpr double kStep = 1.0 / 60;
    static constexpr int kWarmSteps = 180, kSteps = 300, kMostSteps = 3600;
    static constexpr double kApart = 40;              ///< m between cars
    static constexpr float kRadius = 10, kSpeed = 7;  ///< m, about; m/s

    int side() const;
    DVec3 placeOf(int car) const;  ///< on the plane, where the circle begins
    float reach() const;
    /// rad, of a wheel in the middle of the front axle, to the left.
    static float wheelAngle(const VehicleDef& def);
    /// 0 to 1.
    static float throttleAt(float speed);
};

/// Means over the steps that are timed.
struct Result {
    double microseconds = 0;                            ///< per car and step, all that a step does
    std::vector<std::pair<std::string, double>> parts;  ///< of these
    double stateBytes = 0;                              ///< per car, of a saved world
    double allocations = 0;                             ///< per step
    double speed = 0;                                   ///< m/s, mean of all cars at the end
    int driving = 0;                                    ///< cars that stand on their wheels and move at the end
};

Result driveRagtop(const Course& course, const Terrain& terrain, const VehicleDef& def);
/// btRaycastVehicle with the same wheels, struts and masses; empty where the program was built without Bullet.
std::optional<Result> driveBullet(const Course& course, const Terrain& terrain, const VehicleDef& def);

/// What one car costs others that it has nothing to do with, in microseconds per step.
struct Tax {
    std::string others;
    double without = 0, with = 0, car = 0;  ///< others alone; with a car; the car alone

    double share() const { return (with - car) / without - 1; }
};
std::vector<Tax> measureTaxes(const Course& course, const VehicleDef& def);

/// Seconds, of the clock that the course asks for.
double now(const Course& course);

}  // namespace ragtop::fleet
