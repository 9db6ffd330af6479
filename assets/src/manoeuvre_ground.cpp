#include "manoeuvre_ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ragtop {
namespace {

constexpr float kHalfTrack = 2000;  ///< m
constexpr int kMostTiles = 2000;

/// Boxes in the axes of the slope.
struct Layer {
    World& world;
    Quat tilt;

    void operator()(const Vec3& half, const Vec3& at, const Material& material) const {
        world.create(StaticBody{
            .shape = Box{half}, .position = DVec3(rotate(tilt, at)), .rotation = tilt, .material = material});
    }
};

/// Tiles as far as there are any, one piece before and after them.
void layPlane(const Layer& lay, const TrackGround& ground, float side, const Material& material) {
    const auto strip = [&](float from, float to) {
        lay({0.5f * kHalfTrack, 1, 0.5f * (to - from)}, {side * 0.5f * kHalfTrack, -1, 0.5f * (from + to)}, material);
    };
    if (!ground.tiles) return strip(-kHalfTrack, kHalfTrack);
    const float size = *ground.tiles;
    const int count = std::min(kMostTiles, static_cast<int>(kHalfTrack / size));
    strip(-kHalfTrack, 0);
    for (int i = 0; i < count; ++i) strip(static_cast<float>(i) * size, static_cast<float>(i + 1) * size);
    strip(static_cast<float>(count) * size, kHalfTrack + size);
}

/// Evenly scattered by multiples of irrational shares.
void scatter(World& world, const TrackRubble& rubble, const Quat& tilt, const Material& material) {
    constexpr double kAlong = 0.754877666, kAcross = 0.569840291, kTurn = 0.618033989;
    constexpr float kHalfStrip = 1.5f;  // m
    const auto share = [](double step, int i) {
        const double x = step * i;
        return static_cast<float>(x - std::floor(x));
    };
    const float half = 0.5f * rubble.size;
    for (int i = 0; i < rubble.count; ++i) {
        const Vec3 at{kHalfStrip * (2 * share(kAcross, i) - 1), half,
                      rubble.from + (rubble.to - rubble.from) * share(kAlong, i)};
        world.create(DynamicBody{.shape = Box{{half, half, half}},
                                 .density = rubble.mass / (rubble.size * rubble.size * rubble.size),
                                 .position = DVec3(rotate(tilt, at)),
                                 .rotation = tilt * rotationAbout({0, 1, 0}, 2 * kPi * share(kTurn, i)),
                                 .material = material});
    }
}

/// Triangles of 2° of the circle, their fronts inside.
void bend(World& world, const TrackLoop& loop, const Quat& tilt, const Material& material) {
    constexpr unsigned kPieces = 180;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (unsigned i = 0; i <= kPieces; ++i) {
        const float share = static_cast<float>(i) / static_cast<float>(kPieces);
        const Vec3 spoke = rotate(rotationAbout({1, 0, 0}, -2 * kPi * share), {0, -loop.radius, 0});
        for (const float side : {-0.5f, 0.5f}) {
            vertices.push_back(spoke + Vec3{side * loop.width + share * loop.aside, loop.radius, loop.at});
        }
    }
    for (unsigned i = 0; i < 2 * kPieces; i += 2) {
        triangles.push_back({i, i + 2, i + 1});
        triangles.push_back({i + 1, i + 2, i + 3});
    }
    world.create(StaticBody{.shape = TriangleMesh(vertices, triangles), .rotation = tilt, .material = material});
}

}  // namespace

Quat trackTilt(const TrackGround& ground) { return rotationAbout({1, 0, 0}, -arcTan2(ground.slope, 1)); }

void layTrack(World& world, const TrackGround& ground, std::optional<float> friction) {
    const Layer lay{world, trackTilt(ground)};
    const Material left{.friction = friction.value_or(ground.friction)};
    const Material right{.friction = ground.rightFriction.value_or(left.friction)};
    const float half = 0.5f * kHalfTrack;
    if (ground.rightFriction || ground.tiles) {
        layPlane(lay, ground, 1, left);
        layPlane(lay, ground, -1, right);
    } else {
        // Of one piece, whose middle is where cars start: places in a shape are single precision.
        lay({kHalfTrack, 1, kHalfTrack}, {0, -1, 0}, left);
    }
    if (ground.kerb) {
        const float height = 0.5f * ground.kerb->height;
        lay({half, height, half}, {0, height, ground.kerb->at + half}, left);
    }
    if (ground.wall) {
        const float height = 0.5f * ground.wall->height;
        lay({half, height, 1}, {0, height, ground.wall->at + 1}, left);
    }
    if (ground.loop) bend(world, *ground.loop, lay.tilt, left);
    if (ground.rubble) scatter(world, *ground.rubble, lay.tilt, left);
}

}  // namespace ragtop
