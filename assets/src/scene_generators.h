#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "json_value.h"
#include "ragtop/scene.h"
#include "scene_file.h"

namespace ragtop {

/// SplitMix64 [Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, 2014]: the same numbers everywhere.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    /// In [−1, 1).
    float symmetric();
    /// Every rotation equally likely.
    Quat rotation();

private:
    float unit();
    std::uint64_t state_;
};

Pose poseOf(const PlaceInFile& place);
/// Bodies, ragdolls and robots of a scene: more take seconds to look through, and gigabytes.
inline constexpr std::size_t kMostBodies = 200'000;

/// The places of the grid's members, x fastest; `at` is where the file has it.
std::vector<Pose> posesOf(const GridInFile& grid, const Pose& first, const JsonValue& at);

void addWall(const BricksInFile& wall, const Material& material, std::vector<SceneBody>& bodies);
void addHouse(const BricksInFile& house, const Material& material, std::vector<SceneBody>& bodies);
void addTower(const TowerInFile& tower, const Material& material, std::vector<SceneBody>& bodies);
/// The surface of a road, and its centre line. Needs three points, two where it is not closed.
SceneBody roadBody(const RoadInFile& road, const Material& material, SceneRoad& line);
void addStairs(const StairsInFile& stairs, const Material& material, std::vector<SceneBody>& bodies);

}  // namespace ragtop
