#include "ragtop/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <string>

#include "ragtop/ragdoll_file.h"
#include "ragtop/world.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

using testing::HasSubstr;

TEST(Scene, ShipsWhatTheProgramLists) {
    EXPECT_THAT(shippedScenes(),
                testing::IsSupersetOf({"chain", "crash", "crash_unhit", "crowd", "door", "hills", "ledge", "mechanisms",
                                       "puppet", "rain", "stairs", "tower", "track", "wrecker"}));
    for (const std::string& name : shippedScenes()) {
        EXPECT_NE(sceneDescription(findScene(name)), "") << name;
        EXPECT_TRUE(loadScene(findScene(name)).camera) << name;
    }
    EXPECT_THROW(findScene("no such scene"), AssetError);
}

TEST(Scene, HouseIsAClosedRingInRunningBond) {
    const Scene scene = loadScene(findScene("crash_unhit"));
    ASSERT_GE(scene.bodies.size(), 2001u);
    EXPECT_FALSE(scene.settings.sleeping);
    // No brick overlaps another, and each but the lowest rests on two: their footprints meet below it.
    const auto boundsOf = [&](const SceneBody& body) {
        const Vec3 half = std::get<Box>(body.def.shapes[0].geometry).halfExtents, p = toVec3(body.def.pose.position);
        return Bounds{p - half, p + half};
    };
    std::size_t masonry = 0;
    for (const SceneBody& brick : scene.bodies) {
        if (!brick.masonry) continue;
        ++masonry;
        const Bounds own = boundsOf(brick);
        int below = 0;
        for (const SceneBody& other : scene.bodies) {
            if (&other == &brick || !other.masonry) continue;
            const Bounds b = boundsOf(other);
            const Vec3 shared = min(own.upper, b.upper) - max(own.lower, b.lower);
            EXPECT_FALSE(shared.x > 1e-4f && shared.y > 1e-4f && shared.z > 1e-4f);
            if (shared.x > 1e-4f && shared.z > 1e-4f && std::abs(own.lower.y - b.upper.y) < 1e-4f) ++below;
        }
        EXPECT_EQ(below, own.lower.y < 0.1f ? 0 : 2);
    }
    EXPECT_GE(masonry, 2000u);
}

TEST(Scene, WallLosesNoLengthToItsHalfBricks) {
    const Scene scene = loadScene(fileWith("wall.json", R"({"walls": [{"courses": 2, "bricks": 5, "gap": 0.01}]})"));
    ASSERT_EQ(scene.bodies.size(), 11u);
    double ends[2][2] = {{1e9, -1e9}, {1e9, -1e9}};
    for (const SceneBody& brick : scene.bodies) {
        const double half = std::get<Box>(brick.def.shapes[0].geometry).halfExtents.x, x = brick.def.pose.position.x;
        double* end = ends[brick.def.pose.position.y > 0.2 ? 1 : 0];
        end[0] = std::min(end[0], x - half);
        end[1] = std::max(end[1], x + half);
    }
    EXPECT_NEAR(ends[0][0], ends[1][0], 1e-6);
    EXPECT_NEAR(ends[0][1], ends[1][1], 1e-6);
}

TEST(Scene, RepeatsWithTheSameRandomNumbersEveryTime) {
    const auto path = fileWith("repeat.json", R"({"repeat": [{"body": {"shape": {"sphere": {}}, "position": [1, 2, 3]},
        "count": [2, 3, 4], "spacing": [2, 2, 2], "scatter": 0.1, "tumble": true, "seed": 5}]})");
    const Scene a = loadScene(path), b = loadScene(path);
    ASSERT_EQ(a.bodies.size(), 24u);
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
        EXPECT_EQ(a.bodies[i].def.pose, b.bodies[i].def.pose);
        const Quat q = a.bodies[i].def.pose.rotation;
        EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-6);
    }
    EXPECT_NEAR(a.bodies[23].def.pose.position.z, 9, 0.1);
}

TEST(Scene, OverridesByPathAndByNameOfASetting) {
    const SceneOverride overrides[] = {{"sleeping", "false"}, {"settings.substeps", "7"}, {"towers.0.count", "3"}};
    const Scene scene = loadScene(findScene("tower"), overrides);
    EXPECT_FALSE(scene.settings.sleeping);
    EXPECT_EQ(scene.settings.substeps, 7);
    EXPECT_EQ(scene.bodies.size(), 4u);
}

TEST(Scene, JointsHoldWhereTheFileSays) {
    const auto path = fileWith("door.json", R"({
      "settings": {"gravity": [0, 0, 0]},
      "bodies": [{"name": "door", "shape": {"box": {"halfExtents": [0.5, 1, 0.05]}}, "position": [3, 1, 2]}],
      "joints": [{"b": "door", "anchor": [2.5, 1, 2], "axis": [0, 1, 0], "hinge": {"limit": {"lower": -1, "upper": 1}}}]})");
    const Scene scene = loadScene(path);
    World world(scene.settings);
    const SceneInstance instance(scene, world);
    const auto& hinge = std::get<HingeDef>(world.def(instance.joints[0]));
    EXPECT_TRUE(hinge.bodies.a.isNull());
    EXPECT_EQ(hinge.bodies.b, instance.bodies[0]);
    EXPECT_NEAR(hinge.bodies.frameA.position.x, 2.5, 1e-6);
    EXPECT_NEAR(hinge.bodies.frameB.position.x, -0.5, 1e-6);
    EXPECT_NEAR(rotate(hinge.bodies.frameA.rotation, {1, 0, 0}).y, 1, 1e-6);
}

TEST(Scene, CouplesJointsAndAnimatesBodies) {
    const auto path = fileWith("coupled.json", R"({
      "settings": {"gravity": [0, 0, 0]},
      "bodies": [{"name": "a", "shape": {"sphere": {"radius": 0.2}}, "position": [0, 0, 0]},
                 {"name": "b", "shape": {"sphere": {"radius": 0.2}}, "position": [1, 0, 0]},
                 {"name": "door", "shape": {"sphere": {"radius": 0.2}}, "position": [5, 0, 0]}],
      "joints": [{"name": "first", "b": "a", "anchor": [0, 0, 0], "hinge": {"motor": {"targetSpeed": 3, "maxForce": 1e4}}},
                 {"name": "second", "b": "b", "anchor": [1, 0, 0], "hinge": {}}],
      "couplings": [{"parts": [{"joint": "second"}, {"joint": "first", "ratio": 2}],
                     "sum": {"limit": {"lower": 0, "upper": 0}}}],
      "animated": [{"body": "door", "maxForce": 50, "whenBlocked": "yield",
                    "keys": [{"time": 0, "position": [5, 0, 0]}, {"time": 0.5, "position": [5, 1, 0]}]}]})");
    const Scene scene = loadScene(path);
    World world(scene.settings);
    const SceneInstance instance(scene, world);
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    EXPECT_NEAR(world.angularVelocity(instance.bodies[1]).x, -6, 1e-2);
    EXPECT_NEAR(world.pose(instance.bodies[2]).position.y, 1, 1e-3);
    EXPECT_THROW(loadScene(fileWith("uncoupled.json", R"({"bodies": [], "joints": [],
      "couplings": [{"parts": [{"joint": "none"}]}]})")),
                 AssetError);
}

TEST(Scene, EveryShippedSceneStepsWithFiniteNumbers) {
    for (const char* name : {"tower", "track", "hills", "rain", "wrecker"}) {
        const Scene scene = loadScene(findScene(name));
        World world(scene.settings);
        SceneInstance instance(scene, world);
        for (int i = 0; i < 30; ++i) {
            instance.drive(world.time());
            world.step(scene.step);
        }
        for (const BodyId body : world.bodies()) EXPECT_TRUE(isFinite(world.pose(body).position)) << name;
    }
}

TEST(Scene, DriverFollowsTheScript) {
    const Scene scene = loadScene(findScene("hills"));
    World world(scene.settings);
    SceneInstance instance(scene, world);
    instance.drive(0);
    EXPECT_EQ(instance.vehicles[0].input.throttle, 0);
    instance.drive(0.5);
    EXPECT_EQ(instance.vehicles[0].input.throttle, 0.5f);
    instance.drive(17.5);
    EXPECT_EQ(instance.vehicles[0].input.throttle, 0);
    EXPECT_EQ(instance.vehicles[0].input.brake, 0.8f);
}

TEST(RagdollFile, ReadsBackWhatItWroteBitForBit) {
    const auto shipped = findScene("tower").parent_path().parent_path() / "ragdolls/mannequin.ragdoll.json";
    const RagdollDef def = loadRagdoll(shipped);
    EXPECT_EQ(def.parts.size(), 14u);
    const auto first = fileWith("first.ragdoll.json", ""), second = fileWith("second.ragdoll.json", "");
    saveRagdoll(def, first);
    const RagdollDef back = loadRagdoll(first);
    saveRagdoll(back, second);
    const auto text = [](const auto& path) {
        std::ifstream in(path);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    EXPECT_EQ(text(first), text(second));
    for (std::size_t i = 0; i < def.parts.size(); ++i) {
        EXPECT_EQ(back.parts[i].bind, def.parts[i].bind);
        EXPECT_EQ(back.parts[i].frame, def.parts[i].frame);
        EXPECT_EQ(back.parts[i].mass, def.parts[i].mass);
    }
}

}  // namespace
}  // namespace ragtop
