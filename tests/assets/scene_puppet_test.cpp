#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "ragtop/scene.h"
#include "ragtop/world.h"
#include "scene_play.h"

namespace ragtop {
namespace {

using testing::HasSubstr;

const std::string kPuppetBody = R"("file": ")" RAGTOP_SOURCE_DIR R"(/assets/data/ragdolls/mannequin.ragdoll.json")";
const std::string kPuppetGround =
    R"({"name": "ground", "type": "fixed", "shape": {"box": {"halfExtents": [9, 1, 9]}}, "position": [0, -1, 0]})";

TEST(ScenePuppet, TakesSmallBlowsStandingFallsOfALargeOneAndGetsUp) {
    const Scene scene = loadScene(findScene("puppet"));
    ScenePlay play(scene);
    const Puppet& puppet = *play.instance.puppets[0];
    play.until(7.9);
    EXPECT_TRUE(puppet.state() == PuppetState::stands || puppet.state() == PuppetState::staggers)
        << nameOf(puppet.state());
    play.until(9.5);
    EXPECT_TRUE(puppet.state() == PuppetState::falls || puppet.state() == PuppetState::lies) << nameOf(puppet.state());
    play.until(scene.duration);
    EXPECT_TRUE(puppet.state() == PuppetState::stands || puppet.state() == PuppetState::staggers)
        << nameOf(puppet.state());
}

TEST(ScenePuppet, StandsWithItsFeetAtItsPosition) {
    const Scene scene = sceneOfMembers(R"("bodies": [)" + kPuppetGround + R"(], "ragdolls": [{)" + kPuppetBody +
                                       R"(, "puppet": true, "position": [2, 0, -1]}])");
    ScenePlay play(scene);
    double lowest = 1;
    for (const BodyId part : play.instance.ragdolls[0].bodies())
        for (const ShapeId shape : play.world.shapes(part))
            lowest = std::min(lowest, static_cast<double>(play.world.bounds(shape).lower.y));
    EXPECT_NEAR(lowest, 0, 5e-3);
    const DVec3 pelvis = play.world.pose(play.instance.ragdolls[0].bodies()[0]).position;
    EXPECT_NEAR(pelvis.x, 2, 0.05);
    EXPECT_NEAR(pelvis.z, -1, 0.2);
}

TEST(SceneBlows, GiveTheirImpulseOnceAtTheirTime) {
    const Scene scene = sceneOfMembers(R"("settings": {"gravity": [0, 0, 0]}, "ragdolls": [{)" + kPuppetBody + R"(,
        "blows": [{"time": 0.1, "part": "chest", "impulse": [10, 0, 0]},
                  {"time": 0.1, "part": "left foot", "impulse": [0, 2, 0]},
                  {"time": 0.3, "part": "head", "impulse": [-4, 0, 0]}]}])");
    ScenePlay play(scene);
    const auto momentum = [&] {
        Vec3 sum;
        for (const BodyId part : play.instance.ragdolls[0].bodies())
            sum += play.world.mass(part).mass * play.world.linearVelocity(part);
        return sum;
    };
    play.until(0.1);
    EXPECT_LT(length(momentum()), 1e-6f);
    play.until(0.2);
    EXPECT_NEAR(momentum().x, 10, 1e-3);
    EXPECT_NEAR(momentum().y, 2, 1e-3);
    play.until(0.5);
    EXPECT_NEAR(momentum().x, 6, 1e-3);
}

TEST(SceneJoints, HoldPartsOfRagdollsWhereTheFileSays) {
    for (const char* puppet : {"false", "true"}) {
        const Scene scene = sceneOfMembers(R"("bodies": [)" + kPuppetGround + R"(, {"name": "hook", "type": "fixed",
            "shape": {"sphere": {"radius": 0.05}}, "position": [1, 3, 0]},
            {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [-3, 1, 0]}],
            "ragdolls": [{"name": "first", )" +
                                           kPuppetBody + R"(, "position": [5, 0, 0]},
                         {"name": "second", )" +
                                           kPuppetBody + R"(, "position": [1, 0, 0], "puppet": )" + puppet + R"(}],
            "joints": [{"a": "hook", "b": "second/left forearm", "anchor": [1.4, 1.3, 0], "ball": {}},
                       {"a": "ground", "anchor": [0, 0, 0], "b": "ball", "ball": {}}])");
        ScenePlay play(scene);
        const auto& ball = std::get<BallDef>(play.world.def(play.instance.joints[0]));
        const Ragdoll& second = play.instance.ragdolls[1];
        int forearm = 0;
        while (second.def().parts[static_cast<std::size_t>(forearm)].name != "left forearm") ++forearm;
        EXPECT_EQ(ball.bodies.a, play.instance.bodies[1]);
        EXPECT_EQ(ball.bodies.b, second.bodies()[static_cast<std::size_t>(forearm)]);
        const DVec3 at = transformPoint(play.world.pose(ball.bodies.b), ball.bodies.frameB.position);
        EXPECT_NEAR(at.x, 1.4, 1e-5);
        EXPECT_NEAR(at.y, 1.3, 1e-5);
        EXPECT_EQ(std::get<BallDef>(play.world.def(play.instance.joints[1])).bodies.a, play.instance.bodies[0]);
    }
}

TEST(SceneJoints, OfIncludedScenesHoldTheirOwnRagdolls) {
    const TemporaryFile hung("hung.json",
                             R"({"ragdolls": [{"name": "hung", )" + kPuppetBody +
                                 R"(}], "joints": [{"b": "hung/head", "anchor": [0, 1.7, 0], "ball": {}}]})");
    const Scene scene =
        sceneOfMembers(R"("include": [")" + hung.path().string() + R"(", ")" + hung.path().string() + R"("])");
    ScenePlay play(scene);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto& ball = std::get<BallDef>(play.world.def(play.instance.joints[i]));
        EXPECT_EQ(ball.bodies.b, play.instance.ragdolls[i].bodies()[3]) << i;
    }
}

TEST(ScenePuppet, TellsWhatIsWrong) {
    const auto ragdoll = [](const std::string& members) {
        return R"("ragdolls": [{"name": "one", )" + kPuppetBody + members + "}]";
    };
    const auto joint = [&](const std::string& to) {
        return ragdoll("") + R"(, "joints": [{"b": ")" + to + R"(", "anchor": [0, 1, 0], "ball": {}}])";
    };
    EXPECT_THAT(faultOfMembers(joint("two/head")),
                HasSubstr("/joints/0/b is \"two/head\", must be a body, a vehicle, or a part"));
    EXPECT_THAT(faultOfMembers(joint("one/hed")), HasSubstr("did you mean \"head\"?"));
    EXPECT_THAT(faultOfMembers(ragdoll(R"(, "blows": [{"time": 1, "part": "tail", "impulse": [1, 0, 0]}])")),
                HasSubstr("/ragdolls/0/blows/0/part is \"tail\", must name one of the 14 parts"));
    EXPECT_THAT(faultOfMembers(ragdoll(R"(, "blows": [{"time": 2, "part": "head", "impulse": [1, 0, 0]},
                                               {"time": 1, "part": "head", "impulse": [1, 0, 0]}])")),
                HasSubstr("/ragdolls/0/blows/1 has the time 1, must not be before 2 s"));
    EXPECT_THAT(faultOfMembers(ragdoll(R"(, "blows": [{"time": 2, "part": "head"}])")), HasSubstr("impulse"));
}

}  // namespace
}  // namespace ragtop
