#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "../stability/scenery.h"

/// Scenes that nobody has named: each kind is a family of structures whose numbers a seed draws.
namespace ragtop::laws {

using stability::Dice;

inline double dot(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// A kinematic body that goes to and fro: its velocity along x is 2π f a cos(2π f t).
struct Shaker {
    int body = 0;
    float amplitude = 0;  ///< m
    float frequency = 0;  ///< Hz
};

/// A kinematic body that moves evenly, speeds up, moves evenly, brakes and moves evenly, each for as long.
struct Ride {
    int body = 0;
    Vec3 start;         ///< m/s
    Vec3 acceleration;  ///< m/s²
    double phase = 1;   ///< s

    /// Mean velocity (m/s) from one time to another, s.
    Vec3 velocity(double from, double to) const;
};

/// How a car of the scene, by its index, begins: at any attitude, unlike placements.
struct LaidCar {
    Pose pose;  ///< of the chassis
    Vec3 v, w;  ///< m/s of the centre of mass; rad/s
};

/// A scene and what else is done to it. Laws hold for all of them.
struct Drawn {
    Scene scene;
    std::vector<Shaker> shakers;
    std::vector<Ride> rides;
    std::vector<LaidCar> laid;  ///< the first cars of the scene
    double seconds = 6;         ///< for which the laws are watched
    bool isDriven = false;      ///< by motors and the like, whose work is not counted
    bool stands = false;        ///< statics says that nothing moves against body 0
    bool brakes = false;        ///< cars are braked until they stand
    bool isOnIce = false;       ///< nothing but a floor without friction holds it
    bool falls = false;         ///< statics says that something does
};

/// Sizes and weights in a family of structures, drawn from the dice.
struct Kind {
    std::string name;
    Drawn (*draw)(Dice& dice);
};

std::span<const Kind> allKinds();
/// The scene of a seed; the same on every platform.
Drawn draw(const Kind& kind, std::uint64_t seed);

}  // namespace ragtop::laws
