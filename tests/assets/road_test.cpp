#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "ragtop/scene.h"
#include "ragtop/world.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

Scene sceneOf(const std::string& text) {
    const auto path = temporaryPath("road.json");
    std::ofstream(path) << text;
    return loadScene(path);
}

std::string whyNot(const std::string& text) {
    try {
        sceneOf(text);
    } catch (const AssetError& error) {
        return error.what();
    }
    return "";
}

double distance(const DVec3& a, const DVec3& b) { return std::hypot(a.x - b.x, a.z - b.z); }

TEST(Road, GoesThroughItsPointsWithoutGaps) {
    const Scene scene =
        sceneOf(R"({"roads": [{"name": "ring", "points": [[50, 1, 0], [0, 2, 50], [-50, 3, 0], [0, 1, -50]]}]})");
    ASSERT_EQ(scene.roads.size(), 1u);
    const auto& line = scene.roads[0].line;
    for (std::size_t i = 0; i < line.size(); ++i) EXPECT_LT(distance(line[i], line[(i + 1) % line.size()]), 3);
    for (const DVec3& point : {DVec3(50, 1, 0), DVec3(0, 2, 50), DVec3(-50, 3, 0), DVec3(0, 1, -50)}) {
        EXPECT_TRUE(std::any_of(line.begin(), line.end(), [&](const DVec3& p) { return p == point; }));
    }
}

/// From above there is road at the height of the line wherever the line and its edges are.
TEST(Road, IsASurfaceThatFacesUp) {
    const Scene scene = loadScene(findScene("track"));
    World world(scene.settings);
    const SceneInstance instance(scene, world);
    const auto& line = scene.roads[0].line;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const DVec3& next = line[(i + 1) % line.size()];
        const Vec3 along = normalized(relative(next, line[i]));
        for (const float side : {-3.5f, 0.0f, 3.5f}) {
            const DVec3 above = line[i] + side * Vec3{along.z, 0, -along.x} + Vec3{0, 5, 0};
            const Hit hit = world.castRay({above, {0, -20, 0}}, {.ignore = instance.vehicles[0].chassis()});
            ASSERT_TRUE(hit) << i;
            EXPECT_NEAR(hit.point.y, line[i].y, 0.3) << i;
            EXPECT_GT(hit.normal.y, 0.9f) << i;
        }
    }
}

TEST(Road, OpenRoadsEnd) {
    const Scene scene = sceneOf(R"({"roads": [{"closed": false, "points": [[0, 0, 0], [0, 0, 20]]}]})");
    EXPECT_EQ(scene.roads[0].line.front(), DVec3(0, 0, 0));
    EXPECT_EQ(scene.roads[0].line.back(), DVec3(0, 0, 20));
}

TEST(Road, TooFewPointsAndUnknownRoadsAreRefused) {
    EXPECT_THAT(whyNot(R"({"roads": [{"points": [[0, 0, 0], [1, 0, 0]]}]})"),
                testing::HasSubstr("has 2 points, must have 3 or more"));
    const std::string car = std::string(RAGTOP_SOURCE_DIR) + "/assets/data/vehicles/hatchback.car.json";
    EXPECT_THAT(whyNot(R"({"vehicles": [{"file": ")" + car + R"(", "driver": {"road": "nowhere"}}]})"),
                testing::HasSubstr("must be the name of one of the 0 roads"));
    EXPECT_THAT(whyNot(R"({"bodies": [{"shape": {"sphere": {}}, "color": "red"}]})"),
                testing::HasSubstr("must be like \"#8a9a86\""));
}

/// The shipped lap: a driver goes round it, on the road all the way.
TEST(Road, TheDriverOfTheTrackDrivesLaps) {
    const Scene scene = loadScene(findScene("track"));
    World world(scene.settings);
    SceneInstance instance(scene, world);
    const auto& line = scene.roads[0].line;
    double farthest = 0;
    std::size_t laps = 0, before = 0;
    for (int i = 0; i < 7200 && laps < 2; ++i) {
        instance.drive(world.time());
        world.step(scene.step);
        const DVec3 at = world.pose(instance.vehicles[0].chassis()).position;
        const auto nearest = std::min_element(line.begin(), line.end(), [&](const DVec3& a, const DVec3& b) {
            return distance(a, at) < distance(b, at);
        });
        farthest = std::max(farthest, distance(*nearest, at));
        const auto place = static_cast<std::size_t>(nearest - line.begin());
        if (before > line.size() * 3 / 4 && place < line.size() / 4) ++laps;
        before = place;
    }
    EXPECT_EQ(laps, 2u);
    // Half the road less half the car.
    EXPECT_LT(farthest, 0.5 * static_cast<double>(scene.roads[0].width) - 0.8);
}

TEST(Road, TheDriverStopsWhereTheRoadEnds) {
    const std::string car = std::string(RAGTOP_SOURCE_DIR) + "/assets/data/vehicles/hatchback.car.json";
    const Scene scene = sceneOf(
        R"({"bodies": [{"type": "fixed", "shape": {"box": {"halfExtents": [200, 1, 200]}}, "position": [0, -1.01, 0]}],
        "roads": [{"name": "lane", "closed": false, "foot": -1, "points": [[0, 0, -10], [0, 0, 120]]}],
        "vehicles": [{"file": ")" +
        car + R"(", "position": [0, 0, 0], "driver": {"road": "lane", "speed": 20}}]})");
    World world(scene.settings);
    SceneInstance instance(scene, world);
    for (int i = 0; i < 1200; ++i) {
        instance.drive(world.time());
        world.step(scene.step);
    }
    EXPECT_LT(std::abs(instance.vehicles[0].telemetry().speed), 0.2f);
    EXPECT_NEAR(world.pose(instance.vehicles[0].chassis()).position.z, 120, 6);
}

}  // namespace
}  // namespace ragtop
