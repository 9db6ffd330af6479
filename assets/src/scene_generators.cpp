#include "scene_generators.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace ragtop {
namespace {

SceneBody boxBody(const Vec3& size, const Pose& pose, float density, const Material& material) {
    SceneBody body;
    body.def.shapes.push_back({.geometry = Box{0.5f * size}, .density = density, .material = material});
    body.def.pose = pose;
    return body;
}

/// Lays bricks; `length` along the brick, `along` and `across` where its middle is, in the frame of the building.
class Layer {
public:
    Layer(const BricksInFile& bricks, const Material& material, std::vector<SceneBody>& bodies)
        : bricks_(bricks), material_(material), bodies_(bodies), origin_(poseOf(bricks.place)) {}

    void lay(float length, unsigned course, float x, float z, bool turned) {
        const float height = bricks_.size.y, thickness = bricks_.size.z;
        const Vec3 size = turned ? Vec3{thickness, height, length} : Vec3{length, height, thickness};
        const Vec3 middle{x, (static_cast<float>(course) + 0.5f) * height, z};
        SceneBody body = boxBody(size, origin_ * Frame{middle, {}}, bricks_.density, material_);
        body.name = bricks_.name.empty() ? "" : bricks_.name + " " + std::to_string(++count_);
        body.masonry = bricks_.masonry;
        bodies_.push_back(std::move(body));
    }

private:
    const BricksInFile& bricks_;
    const Material& material_;
    std::vector<SceneBody>& bodies_;
    Pose origin_;
    int count_ = 0;
};

}  // namespace

float Random::unit() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
}

float Random::symmetric() { return 2 * unit() - 1; }

Quat Random::rotation() {
    // [Shoemake, Uniform Random Rotations, Graphics Gems III, 1992]
    const float u = unit();
    const SinCos a = sinCos(2 * kPi * unit()), b = sinCos(2 * kPi * unit());
    const float s = std::sqrt(1 - u), t = std::sqrt(u);
    return {s * a.sin, s * a.cos, t * b.sin, t * b.cos};
}

Pose poseOf(const PlaceInFile& place) {
    if (place.heading == 0) return {place.position, place.rotation};
    return {place.position, rotationAbout({0, 1, 0}, place.heading) * place.rotation};
}

std::vector<Pose> posesOf(const GridInFile& grid, const Pose& first, const JsonValue& at) {
    if (grid.size() > kMostBodies)
        at.at("count").fail(fmt::format("makes {}, at most {} are allowed", grid.size(), kMostBodies));
    Random random(grid.seed);
    std::vector<Pose> poses;
    for (unsigned z = 0; z < grid.count[2]; ++z) {
        for (unsigned y = 0; y < grid.count[1]; ++y) {
            for (unsigned x = 0; x < grid.count[0]; ++x) {
                const Vec3 cell{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
                Pose pose{first.position + scale(cell, grid.spacing), first.rotation};
                if (grid.scatter > 0) {
                    const float dx = random.symmetric(), dy = random.symmetric(), dz = random.symmetric();
                    pose.position = pose.position + grid.scatter * Vec3{dx, dy, dz};
                }
                if (grid.tumble) pose.rotation = random.rotation();
                poses.push_back(pose);
            }
        }
    }
    return poses;
}

void addWall(const BricksInFile& wall, const Material& material, std::vector<SceneBody>& bodies) {
    Layer layer(wall, material, bodies);
    const float pitch = wall.size.x + wall.gap;
    const float left = -0.5f * pitch * static_cast<float>(wall.bricks);
    const float half = 0.5f * (wall.size.x - wall.gap);
    for (unsigned course = 0; course < wall.courses; ++course) {
        // Every other course begins and ends with half a brick.
        const bool odd = course % 2 == 1;
        const float start = left + (odd ? half + wall.gap : 0);
        const unsigned whole = wall.bricks - (odd ? 1 : 0);
        if (odd) layer.lay(half, course, left + 0.5f * half, 0, false);
        for (unsigned i = 0; i < whole; ++i) {
            layer.lay(wall.size.x, course, start + static_cast<float>(i) * pitch + 0.5f * wall.size.x, 0, false);
        }
        if (odd) layer.lay(half, course, start + static_cast<float>(whole) * pitch + 0.5f * half, 0, false);
    }
}

void addHouse(const BricksInFile& house, const Material& material, std::vector<SceneBody>& bodies) {
    Layer layer(house, material, bodies);
    const float pitch = house.size.x + house.gap;
    // Each wall runs from the outer face of one corner to just before the next wall: a ring without half bricks.
    const float turn = house.size.z + house.gap;
    const float side = static_cast<float>(house.bricks - 1) * pitch + house.size.x + turn;
    const float middle = 0.5f * (side - house.size.z);
    for (unsigned course = 0; course < house.courses; ++course) {
        const float shift = course % 2 == 1 ? turn : 0;
        for (unsigned i = 0; i < house.bricks; ++i) {
            const float at = 0.5f * house.size.x + static_cast<float>(i) * pitch + shift - 0.5f * side;
            layer.lay(house.size.x, course, at, -middle, false);
            layer.lay(house.size.x, course, middle, at, true);
            layer.lay(house.size.x, course, -at, middle, false);
            layer.lay(house.size.x, course, -middle, -at, true);
        }
    }
}

void addTower(const TowerInFile& tower, const Material& material, std::vector<SceneBody>& bodies) {
    Random random(tower.seed);
    const Pose foot = poseOf(tower.place);
    for (unsigned i = 0; i < tower.count; ++i) {
        Vec3 middle{0, (static_cast<float>(i) + 0.5f) * tower.size.y, 0};
        if (tower.scatter > 0) {
            middle.x = tower.scatter * random.symmetric();
            middle.z = tower.scatter * random.symmetric();
        }
        SceneBody body = boxBody(tower.size, foot * Frame{middle, {}}, tower.density, material);
        if (!tower.name.empty()) body.name = tower.name + " " + std::to_string(i + 1);
        bodies.push_back(std::move(body));
    }
}

void addStairs(const StairsInFile& stairs, const Material& material, std::vector<SceneBody>& bodies) {
    const Pose foot = poseOf(stairs.place);
    for (unsigned i = 0; i < stairs.steps; ++i) {
        const float height = static_cast<float>(i + 1) * stairs.rise;
        const Vec3 middle{0, 0.5f * height, (static_cast<float>(i) + 0.5f) * stairs.tread};
        SceneBody body = boxBody({stairs.width, height, stairs.tread}, foot * Frame{middle, {}}, 1000, material);
        body.def.type = BodyType::fixed;
        if (!stairs.name.empty()) body.name = stairs.name + " " + std::to_string(i + 1);
        bodies.push_back(std::move(body));
    }
}

}  // namespace ragtop
