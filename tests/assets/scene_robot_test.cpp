#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "ragtop/cooked.h"
#include "ragtop/scene.h"
#include "ragtop/scene_tuning.h"
#include "ragtop/start_overlaps.h"
#include "ragtop/world.h"
#include "scene_play.h"

namespace ragtop {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::string kRobotGround =
    R"({"name": "ground", "type": "fixed", "shape": {"box": {"halfExtents": [9, 1, 9]}}, "position": [0, -1, 0]})";

std::string robotEntry(const std::string& name, const std::string& file, const std::string& members = "") {
    return R"({"name": ")" + name + R"(", "file": ")" RAGTOP_SOURCE_DIR "/assets/data/robots/" + file + "\"" + members +
           "}";
}

struct RobotPlay : ScenePlay {
    using ScenePlay::ScenePlay;

    BodyId body(std::size_t robot, const std::string& link) const {
        for (const RobotLink& one : scene.robots[robot].robot->links)
            if (one.name == link) return instance.robots[robot].bodies[static_cast<std::size_t>(one.body)];
        throw std::out_of_range(link);
    }
    double height(std::size_t robot) const { return world.centerOfMass(body(robot, "trunk")).y; }
};

TEST(SceneRobots, StandWhereTheFileSaysWithTheirLowestPointOnTheGround) {
    const Scene scene = sceneOfMembers(R"("robots": [)" + robotEntry("dog", "dog.xml", R"(, "position": [2, 0.5, -1],
        "heading": 1.2, "standing": true)") +
                                       "]");
    const RobotPlay play(scene);
    double lowest = 9;
    for (const BodyId body : play.instance.robots[0].bodies)
        for (const ShapeId shape : play.world.shapes(body))
            lowest = std::min(lowest, static_cast<double>(play.world.bounds(shape).lower.y));
    EXPECT_NEAR(lowest, 0.5, 1e-3);
    const Pose trunk = play.world.pose(play.body(0, "trunk"));
    EXPECT_NEAR(trunk.position.x, 2, 1e-5);
    EXPECT_NEAR(trunk.position.z, -1, 1e-5);
    // x of the description, forwards of the dog, is turned from x by the heading.
    const Vec3 forwards = rotate(trunk.rotation, {1, 0, 0});
    EXPECT_NEAR(forwards.x, std::cos(1.2f), 1e-5f);
    EXPECT_NEAR(forwards.z, -std::sin(1.2f), 1e-5f);
}

/// Knees bear a quarter of the weight 0.12 m from their axes, 5 N m of 40: servos give way by that share of 0.05 rad,
/// and the trunk sinks by 0.12 m times that, and as much again for the hips.
TEST(SceneRobots, ThatHoldKeepTheirPoseAndLimpOnesSink) {
    const Scene scene =
        sceneOfMembers(R"("bodies": [)" + kRobotGround + R"(], "robots": [)" +
                       robotEntry("held", "dog.xml", R"(, "standing": true, "holding": true)") + ", " +
                       robotEntry("limp", "dog.xml", R"(, "standing": true, "position": [3, 0, 0])") + "]");
    RobotPlay play(scene);
    const double start = play.height(0);
    play.until(4);
    EXPECT_NEAR(play.height(0), start, 0.002);
    EXPECT_LT(play.height(1), start - 0.1);
    for (const JointId joint : play.world.joints()) EXPECT_LT(play.world.state(joint).gap, 2e-3f);
}

TEST(SceneRobots, AreJoinedByTheNamesOfTheirLinks) {
    const Scene scene =
        sceneOfMembers(R"("bodies": [)" + kRobotGround + R"(], "robots": [)" +
                       robotEntry("first", "dog.xml", R"(, "position": [5, 2, 0])") + ", " +
                       robotEntry("second", "dog.xml", R"(, "position": [0, 2, 0])") +
                       R"(], "joints": [{"a": "second/front_left_shank", "anchor": [0.2, 2, 0.1], "ball": {}}])");
    RobotPlay play(scene);
    const auto& ball = std::get<BallDef>(play.world.def(play.instance.joints[0]));
    EXPECT_EQ(ball.bodies.a, play.body(1, "front_left_shank"));
    const DVec3 at = transformPoint(play.world.pose(ball.bodies.a), ball.bodies.frameA.position);
    EXPECT_NEAR(at.x, 0.2, 1e-5);
    EXPECT_NEAR(at.y, 2, 1e-5);
    play.until(3);
    const DVec3 hung = transformPoint(play.world.pose(ball.bodies.a), ball.bodies.frameA.position);
    EXPECT_NEAR(hung.y, 2, 2e-3);
}

TEST(SceneJoints, HoldTheChassisOfAVehicleByItsName) {
    const std::string car = R"("vehicles": [{"name": "car", "file": ")" RAGTOP_SOURCE_DIR
                            R"(/assets/data/vehicles/hatchback.car.json", "position": [0, 1, 0], "heading": 1}])";
    const Scene scene =
        sceneOfMembers(R"("bodies": [{"name": "box", "shape": {"box": {}}, "position": [0, 4, 0]}], )" + car +
                       R"(, "joints": [{"a": "car", "b": "box", "anchor": [0, 3, 0], "fixed": {}}])");
    const RobotPlay play(scene);
    const auto& weld = std::get<FixedDef>(play.world.def(play.instance.joints[0]));
    EXPECT_EQ(weld.bodies.a, play.instance.vehicles[0].chassis());
    EXPECT_NEAR(transformPoint(play.world.pose(weld.bodies.a), weld.bodies.frameA.position).y, 3, 1e-5);
}

TEST(SceneRobots, OfOneEntryAreTunedTogetherAndKeepTheirServos) {
    Scene scene =
        sceneOfMembers(R"("robots": [)" +
                       robotEntry("dogs", "dog.xml", R"(, "holding": true, "count": [2, 1, 1], "spacing": [2, 1, 1])") +
                       R"(], "tuning": {"robots.dogs.joints.front_left_knee.friction": 0.75})");
    ASSERT_EQ(scene.robots.size(), 2u);
    EXPECT_EQ(scene.robots[1].name, "dogs 2");
    RobotPlay play(scene);
    const auto knee = static_cast<std::size_t>(scene.robots[0].robot->findJoint("front_left_knee"));
    const auto hinge = [&](std::size_t robot) {
        return std::get<HingeDef>(play.world.def(play.instance.robots[robot].joints[knee]));
    };
    EXPECT_EQ(hinge(1).friction, 0.75f);
    Scene tuned = scene;
    const std::vector<TunedValue> values{{"robots.dogs.joints.front_left_knee.limit.upper", 0.5}};
    const TunedParts parts = tune(tuned, values);
    RunningScene running{&play.world, {}, {}, {}, {}, {}};
    for (const RobotIds& ids : play.instance.robots) running.robots.push_back(&ids);
    apply(tuned, parts, running);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(hinge(i).limit->upper, 0.5f);
        ASSERT_TRUE(hinge(i).spring.has_value());
        EXPECT_EQ(hinge(i).spring->maxForce, 40.0f);
    }
    EXPECT_TRUE(sameStructure(scene, tuned));
    const Scene limp = sceneOfMembers(
        R"("robots": [)" + robotEntry("dogs", "dog.xml", R"(, "count": [2, 1, 1], "spacing": [2, 1, 1])") + "]");
    EXPECT_FALSE(sameStructure(scene, limp));
}

TEST(SceneRobots, GoOnAsBeforeFromASavedState) {
    const Scene scene = loadScene(findScene("robots"));
    RobotPlay play(scene), other(scene);
    play.until(0.5);
    std::vector<std::byte> state(play.world.saveSize());
    state.resize(play.world.save(state));
    play.until(1);
    other.world.restore(state);
    other.until(1);
    EXPECT_EQ(other.world.hash(), play.world.hash());
}

/// J, of the servos that hold robots: springs of hinges, whose torque has a bound.
double storedBySprings(const World& world) {
    double sum = 0;
    for (const JointId joint : world.joints()) {
        const JointDef def = world.def(joint);
        const auto* hinge = std::get_if<HingeDef>(&def);
        if (hinge == nullptr || !hinge->spring || !(hinge->spring->stiffness > 0)) continue;
        const double stiffness = static_cast<double>(hinge->spring->stiffness);
        const double most = static_cast<double>(hinge->spring->maxForce);
        const double turn = std::abs(static_cast<double>(world.state(joint).coordinate - hinge->target));
        const double bounded = std::min(turn, most / stiffness);
        sum += 0.5 * stiffness * bounded * bounded + most * (turn - bounded);
    }
    return sum;
}

/// What moves at the start, falls; after that only joints and the ground act, which give no energy but what springs
/// have stored.
TEST(SceneRobots, ShippedOnesGainNoEnergyAndStayClosed) {
    const Scene scene = loadScene(findScene("robots"));
    RobotPlay play(scene);
    const auto energy = [&] { return play.world.energy() + storedBySprings(play.world); };
    double least = energy();
    const double start = least;
    while (play.world.time() < 8) {
        play.until(play.world.time() + scene.step);
        const double now = energy();
        EXPECT_LT(now, least + 1e-3 * std::abs(start)) << play.world.time();
        least = std::min(least, now);
        for (const JointId joint : play.world.joints())
            ASSERT_LT(play.world.state(joint).gap, 2e-3f) << play.world.time();
    }
    EXPECT_LT(least, start);
}

/// What the file was read from is not looked at again: its description may be gone.
TEST(SceneRobots, ThatAreCookedMoveAsTheImportedOnesToTheBit) {
    const auto hashOf = [](const std::string& file) {
        const Scene scene = sceneOfMembers(R"("bodies": [)" + kRobotGround + R"(], "robots": [{"file": ")" + file +
                                           R"(", "position": [0, 0.6, 0], "holding": true, "count": [2, 1, 1]}])");
        RobotPlay play(scene);
        play.until(1.5);
        return play.world.hash();
    };
    for (const char* name : {"dog.xml", "arm.urdf"}) {
        const std::string description = std::string(RAGTOP_SOURCE_DIR "/assets/data/robots/") + name;
        Cooked asset;
        asset.robot = loadRobot(description);
        const auto cookedFile = temporaryPath("robot_of_scene.ragtop");
        saveCooked(asset, cookedFile);
        EXPECT_EQ(hashOf(cookedFile.string()), hashOf(description)) << name;
        std::filesystem::remove(cookedFile);
    }
    Cooked hull;
    const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    hull.pieces = {ConvexHull(corners)};
    const auto other = temporaryPath("hull_of_scene.ragtop");
    saveCooked(hull, other);
    EXPECT_THAT(faultOfMembers(R"("robots": [{"file": ")" + other.string() + R"("}])"),
                HasSubstr("must name a usable file: " + other.string() + ": has no robot in it"));
    std::filesystem::remove(other);
}

TEST(SceneRobots, ThatBeginInsideOfOthersAreTold) {
    const Scene scene =
        sceneOfMembers(R"("bodies": [)" + kRobotGround + R"(], "robots": [)" +
                       robotEntry("dog", "dog.xml", R"(, "position": [0, -0.3, 0], "standing": true)") + "]");
    EXPECT_THAT(startOverlaps(scene), testing::ElementsAre(HasSubstr("robot \"dog\" begins about")));
    EXPECT_THAT(startOverlaps(sceneOfMembers(R"("bodies": [)" + kRobotGround + R"(], "robots": [)" +
                                             robotEntry("dog", "dog.xml", R"(, "standing": true)") + "]")),
                IsEmpty());
}

TEST(SceneRobots, TellWhatIsWrong) {
    EXPECT_THAT(faultOfMembers(R"("robots": [{"name": "arm"}])"), HasSubstr("/robots/0/file is missing"));
    EXPECT_THAT(faultOfMembers(R"("robots": [)" + robotEntry("arm", "arm.urdf", R"(, "heading": 90)") + "]"),
                HasSubstr("/robots/0/heading is 90, must be a number in"));
    const std::string two = R"("robots": [)" + robotEntry("arm", "arm.urdf") + ", " +
                            robotEntry("arm", "arm.urdf", R"(, "position": [3, 0, 0])") + "]";
    EXPECT_THAT(faultOfMembers(two + R"(, "joints": [{"a": "arm/palm", "anchor": [0, 1, 0], "ball": {}}])"),
                HasSubstr("/joints/0/a is \"arm/palm\", must be a body, a vehicle, or a part of a ragdoll or robot"));
    // The robot is wrong; that the joint has none to hold is no fault of its own.
    EXPECT_THAT(faultOfMembers(R"("robots": [{"name": "arm", "file": "none.urdf"}],
                              "joints": [{"a": "arm/palm", "anchor": [0, 1, 0], "ball": {}}])"),
                testing::Not(HasSubstr("/joints/0")));
}

}  // namespace
}  // namespace ragtop
