#include "serve/session.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "live_support.h"
#include "ragtop/world.h"

namespace ragtop::live {
namespace {

std::uint32_t word(const FrameBytes& frame, std::size_t index) {
    std::uint32_t value = 0;
    std::memcpy(&value, frame->data() + 4 * index, sizeof value);
    return value;
}

TEST_F(SessionTest, APageLearnsTheScenesTheSceneAndTheState) {
    openYard();
    const auto& texts = pages_.texts[kPage];
    ASSERT_GE(texts.size(), 3u);
    EXPECT_EQ(texts[0]["type"], "hello");
    EXPECT_EQ(texts[0]["protocol"], 1);
    EXPECT_EQ(texts[0]["scene"], "yard");
    EXPECT_EQ(texts[0]["scenes"][0]["name"], "yard");
    EXPECT_EQ(texts[0]["scenes"][0]["description"], "bricks and a car");
    EXPECT_EQ(texts[1]["type"], "scene");
    EXPECT_EQ(texts[2]["type"], "status");
    const Json& scene = texts[1];
    EXPECT_EQ(scene["nodes"].size(), world().bodies().size() + 4);
    EXPECT_EQ(scene["vehicles"][0]["wheels"].size(), 4u);
    EXPECT_EQ(scene["ragdolls"][0]["parts"].size(), 14u);
    EXPECT_EQ(scene["ragdolls"][0]["parts"][0]["parent"], -1);
    EXPECT_GT(scene["tunables"].size(), 200u);
    for (const Json& node : scene["nodes"]) {
        for (const Json& part : node["parts"]) EXPECT_LT(part["geometry"], scene["geometries"].size());
    }
}

TEST_F(SessionTest, APageIsWarnedOfWhatBeginsInTheGround) {
    openYard();
    EXPECT_TRUE(pages_.last(kPage, "scene")["warnings"].empty());
    std::string sunk = yard();
    const std::string place = "[4, 0, 0]";
    sunk.replace(sunk.find(place), place.size(), "[4, -1, 0]");
    open(folder_.write("sunk.json", sunk).string());
    const Json warnings = pages_.last(kPage, "scene")["warnings"];
    ASSERT_EQ(warnings.size(), 1u);
    const auto warning = warnings[0].get<std::string>();
    EXPECT_TRUE(warning.starts_with("vehicle \"car\" begins about ")) << warning;
    EXPECT_TRUE(warning.ends_with(" inside of body \"ground\"")) << warning;
}

/// Bricks of one size share their geometry.
TEST_F(SessionTest, GeometriesAreToldOnce) {
    openYard();
    const Json scene = pages_.last(kPage, "scene");
    // Ground, two sizes of brick, two chassis shapes, ragdoll parts in pairs, one wheel.
    EXPECT_LE(scene["geometries"].size(), 16u);
}

TEST_F(SessionTest, FramesHoldWhatHasChangedSinceThePageGotOne) {
    openYard();
    session_->advance(0);
    ASSERT_EQ(pages_.frames[kPage].size(), 1u);
    const FrameBytes first = pages_.frames[kPage][0];
    EXPECT_EQ(word(first, 0), 1u);
    EXPECT_EQ(word(first, 2), 0u);
    EXPECT_EQ(word(first, 3), world().bodies().size() + 4);
    pages_.slow[kPage] = true;
    steps(1);
    steps(1);
    EXPECT_EQ(pages_.frames[kPage].size(), 1u);
    pages_.slow[kPage] = false;
    session_->advance(0);
    ASSERT_EQ(pages_.frames[kPage].size(), 2u);
    EXPECT_EQ(word(pages_.frames[kPage][1], 2), 2u);
    // The ground stays.
    EXPECT_EQ(word(pages_.frames[kPage][1], 3), world().bodies().size() + 3);
}

TEST_F(SessionTest, RealTimeMakesTheStepsThatAreDue) {
    openYard();
    expectOk({{"do", "play"}});
    for (int i = 0; i < 30; ++i) session_->advance(1.0 / 60);
    EXPECT_NEAR(static_cast<double>(session_->live().now()), 30, 1);
    expectOk({{"do", "speed"}, {"factor", 0.1}});
    const auto before = session_->live().now();
    for (int i = 0; i < 60; ++i) session_->advance(1.0 / 60);
    EXPECT_NEAR(static_cast<double>(session_->live().now() - before), 6, 1);
    EXPECT_NEAR(pages_.last(kPage, "status")["realTimeFactor"].get<double>(), 0.1, 0.04);
    expectOk({{"do", "pause"}});
    const auto paused = session_->live().now();
    for (int i = 0; i < 60; ++i) session_->advance(1.0 / 60);
    EXPECT_EQ(session_->live().now(), paused);
}

/// However late it comes, no more than a few steps are made at once: a slow machine slows the world.
TEST_F(SessionTest, LostTimeIsNotMadeUpFor) {
    openYard();
    expectOk({{"do", "play"}});
    session_->advance(100);
    EXPECT_LE(session_->live().now(), 4u);
}

TEST_F(SessionTest, WithoutPagesTheWorldWaits) {
    openYard();
    expectOk({{"do", "play"}});
    session_->leave(kPage);
    for (int i = 0; i < 60; ++i) session_->advance(1.0 / 60);
    EXPECT_EQ(session_->live().now(), 0u);
    EXPECT_GE(session_->idle(), 0.1);
}

TEST_F(SessionTest, StepsAndSeeksEndAtTheSameHash) {
    openYard();
    steps(90);
    const std::string there = hash();
    EXPECT_EQ(expectOk({{"do", "step"}, {"count", -60}})["step"], 30);
    EXPECT_NE(hash(), there);
    EXPECT_EQ(expectOk({{"do", "step"}, {"count", 60}})["step"], 90);
    EXPECT_EQ(hash(), there);
    EXPECT_EQ(expectOk({{"do", "seek"}, {"step", 5}})["step"], 5);
    EXPECT_EQ(expectOk({{"do", "seek"}, {"step", 90}})["step"], 90);
    EXPECT_EQ(hash(), there);
    EXPECT_EQ(errorOf({{"do", "seek"}, {"step", 91}}), "seek: step is 91, must be in [0, 90]");
    EXPECT_EQ(expectOk({{"do", "step"}, {"count", -600}})["step"], 0);
    EXPECT_EQ(pages_.last(kPage, "status")["playing"], false);
}

/// Of seeks that come at once only the last is made; all are answered.
TEST_F(SessionTest, ADraggedSliderSeeksOnce) {
    openYard();
    steps(60);
    const std::size_t frames = pages_.frames[kPage].size();
    for (int step = 50; step >= 10; --step) {
        session_->receive(kPage, text({{"do", "seek"}, {"step", step}, {"id", 1000 + step}}));
    }
    session_->advance(0);
    EXPECT_EQ(session_->live().now(), 10u);
    EXPECT_EQ(pages_.frames[kPage].size(), frames + 1);
    int answers = 0;
    for (const Json& message : pages_.texts[kPage]) answers += message["type"] == "re" && message["re"] >= 1000;
    EXPECT_EQ(answers, 41);
}

TEST_F(SessionTest, HashesAreThoseOfARunWithoutPages) {
    openYard();
    steps(120);
    const std::string served = hash();
    const Scene scene = loadScene(folder_ / "yard.json");
    World plain(scene.settings);
    SceneInstance instance(scene, plain);
    for (int i = 0; i < 120; ++i) {
        instance.drive(plain.time());
        plain.step(scene.step);
    }
    EXPECT_EQ(std::stoull(served, nullptr, 16), plain.hash());
}

TEST_F(SessionTest, ShotBallsAreNodesThatComeAndGo) {
    openYard();
    steps(10);
    const Json shot = expectOk({{"do", "shoot"}, {"origin", {0, 1, 0}}, {"direction", {0, 0, 1}}});
    const Json added = pages_.last(kPage, "nodes");
    ASSERT_EQ(added["added"].size(), 1u);
    EXPECT_EQ(added["added"][0]["node"], shot["node"]);
    EXPECT_EQ(added["added"][0]["name"], "ball");
    EXPECT_EQ(added["geometries"][0]["kind"], "sphere");
    steps(10);
    expectOk({{"do", "seek"}, {"step", 5}});
    EXPECT_EQ(pages_.last(kPage, "nodes")["removed"], Json::array({shot["node"]}));
    expectOk({{"do", "seek"}, {"step", 15}});
    // It is the same again.
    EXPECT_EQ(pages_.last(kPage, "nodes")["added"][0]["node"], shot["node"]);
    expectOk({{"do", "seek"}, {"step", 5}});
    const Json other = expectOk({{"do", "shoot"}, {"origin", {0, 1, 0}}, {"direction", {0, 0, 1}}, {"radius", 0.5}});
    // Another ball, though the world gives it the name that the first had.
    EXPECT_NE(other["node"], shot["node"]);
    EXPECT_EQ(pages_.last(kPage, "nodes")["geometries"][0]["radius"], 0.5);
}

TEST_F(SessionTest, AGrabbedBrickMovesAndIsLetGoWhenItsPageLeaves) {
    openYard();
    const std::uint32_t brick = nodeNamed("brick 20");
    session_->join(8);
    EXPECT_NE(ask({{"do", "drag"}, {"target", {0, 0, 0}}})["error"], Json());
    expectOk({{"do", "grab"}, {"node", brick}, {"point", {0, 0, 0}}, {"target", {0, 3, 8}}});
    EXPECT_EQ(errorOf({{"do", "grab"}, {"node", nodeNamed("ground")}, {"point", {0, 0, 0}}, {"target", {0, 3, 8}}}),
              "grab: the body does not move, must be a dynamic one");
    steps(120);
    EXPECT_GT(world().pose(session_->live().hand().held()).position.y, 2.5);
    session_->receive(8, R"({"do": "drag", "target": [0, 0, 0], "id": 1})");
    EXPECT_EQ(pages_.last(8, "re")["error"], "drag: this page has grabbed nothing");
    session_->leave(kPage);
    EXPECT_TRUE(session_->live().hand().held().isNull());
}

TEST_F(SessionTest, LettingGoOfWhatWasNotYetHeldKeepsTheFuture) {
    openYard();
    steps(10);
    expectOk({{"do", "grab"}, {"node", nodeNamed("brick 20")}, {"point", {0, 0, 0}}, {"target", {0, 3, 8}}});
    steps(20);
    expectOk({{"do", "seek"}, {"step", 5}});
    expectOk({{"do", "release"}});
    session_->leave(kPage);
    EXPECT_EQ(session_->live().last(), 30u);
}

TEST_F(SessionTest, WhatIsNotThereIsRefused) {
    openYard();
    const std::string before = hash();
    EXPECT_EQ(errorOf({{"do", "drive"}, {"vehicle", 1}, {"throttle", 1}}),
              "drive: vehicle is 1, must be below 1, their number");
    EXPECT_EQ(errorOf({{"do", "resetVehicle"}, {"vehicle", 9}}),
              "resetVehicle: vehicle is 9, must be below 1, their number");
    EXPECT_EQ(errorOf({{"do", "pick"}, {"node", 99999}}), "pick: node is 99999, must be the number of a body");
    EXPECT_EQ(errorOf({{"do", "load"}, {"scene", "../../../etc/passwd"}}),
              "load: scene is \"../../../etc/passwd\", must be one of the list");
    EXPECT_NE(errorOf({{"do", "loadTuning"}, {"name", "none"}}).find("no such file"), std::string::npos);
    EXPECT_EQ(errorOf({{"do", "release"}}), "release: this page has grabbed nothing");
    EXPECT_EQ(errorOf({{"do", "shoot"}, {"origin", {0, 0, 0}}, {"direction", {0, 0, 0}}}),
              "shoot: direction is [0, 0, 0], must have a direction");
    EXPECT_EQ(hash(), before);
}

TEST_F(SessionTest, DrivingTakesTheCarAndResetGivesItBack) {
    openYard();
    expectOk({{"do", "drive"}, {"vehicle", 0}, {"throttle", 1}});
    steps(120);
    EXPECT_EQ(pages_.last(kPage, "status")["driven"], Json::array({0}));
    const Json telemetry = pages_.last(kPage, "telemetry");
    EXPECT_GT(telemetry["vehicles"][0]["speed"].get<double>(), 3);
    EXPECT_EQ(telemetry["vehicles"][0]["throttle"], 1);
    EXPECT_EQ(telemetry["vehicles"][0]["wheels"].size(), 4u);
    EXPECT_GT(telemetry["vehicles"][0]["wheels"][0]["load"].get<double>(), 1000);
    expectOk({{"do", "reset"}});
    EXPECT_EQ(pages_.last(kPage, "status")["driven"], Json::array());
    EXPECT_EQ(session_->live().now(), 0u);
}

TEST_F(SessionTest, ThePickedBodyTellsItsNumbers) {
    openYard();
    const std::uint32_t forearm = nodeNamed("person left forearm"), brick = nodeNamed("brick 1");
    steps(30);
    expectOk({{"do", "pick"}, {"node", forearm}});
    const Json bone = pages_.last(kPage, "telemetry")["picked"];
    EXPECT_EQ(bone["name"], "person left forearm");
    EXPECT_NEAR(bone["mass"].get<double>(), 1.7, 1e-5);
    EXPECT_EQ(bone["joint"]["margins"][0]["axis"], "angle");
    EXPECT_NEAR(bone["joint"]["margins"][0]["lower"].get<double>(), -2.2, 1e-6);
    EXPECT_GT(bone["joint"]["torque"].get<double>(), 0);
    expectOk({{"do", "pick"}, {"node", brick}});
    steps(60);
    // A brick of the lowest course carries those above: the ground pushes it up by more than its weight, and those
    // above push it down; together they carry its weight.
    const Json carried = pages_.last(kPage, "telemetry")["picked"];
    const double weight = 9.81 * carried["mass"].get<double>();
    EXPECT_NEAR(carried["contactForce"][1].get<double>(), weight, 0.05 * weight);
    EXPECT_GE(carried["contacts"].get<int>(), 2);
    EXPECT_FALSE(carried.contains("joint"));
    expectOk({{"do", "pick"}, {"node", nullptr}});
    EXPECT_FALSE(pages_.last(kPage, "telemetry").contains("picked"));
}

TEST_F(SessionTest, DebugLinesComeWhileTheyAreShownAndOnceEmpty) {
    openYard();
    steps(60);
    const auto frames = [&](std::uint32_t type) {
        std::vector<std::uint32_t> counts;
        for (const FrameBytes& frame : pages_.frames[kPage]) {
            if (word(frame, 0) == type) counts.push_back(word(frame, type == 1 ? 3 : 2));
        }
        return counts;
    };
    EXPECT_TRUE(frames(2).empty());
    for (const char* option : {"contacts", "joints", "bounds", "centers", "wheels", "skeleton"}) {
        const std::size_t before = frames(2).size();
        expectOk({{"do", "show"}, {option, true}});
        ASSERT_EQ(frames(2).size(), before + 1) << option;
        EXPECT_GT(frames(2).back(), 0u) << option;
        steps(1);
        EXPECT_EQ(frames(2).size(), before + 2) << option;
        expectOk({{"do", "show"}, {option, false}});
        EXPECT_EQ(frames(2).size(), before + 3) << option;
        EXPECT_EQ(frames(2).back(), 0u) << option;
        steps(1);
        EXPECT_EQ(frames(2).size(), before + 3) << option;
    }
    expectOk({{"do", "show"}, {"islands", true}});
    ASSERT_EQ(frames(3).size(), 1u);
    EXPECT_EQ(frames(3)[0], world().bodies().size() - 1);
    expectOk({{"do", "show"}, {"islands", false}});
    const FrameBytes off = pages_.frames[kPage].back();
    EXPECT_EQ(word(off, 0), 3u);
    EXPECT_EQ(word(off, 5), 0xffffffffu);
}

/// A page that was too slow to see that the lines were switched off learns it when it has caught up.
TEST_F(SessionTest, ASlowPageLosesNoSwitch) {
    openYard();
    expectOk({{"do", "show"}, {"centers", true}});
    pages_.slow[kPage] = true;
    expectOk({{"do", "show"}, {"centers", false}});
    steps(1);
    steps(1);
    pages_.slow[kPage] = false;
    session_->advance(0);
    const FrameBytes last = pages_.frames[kPage].back();
    EXPECT_EQ(word(last, 0), 2u);
    EXPECT_EQ(word(last, 2), 0u);
}

TEST_F(SessionTest, AnotherSceneIsLoadedForAllPages) {
    openYard();
    session_->join(8);
    expectOk({{"do", "pick"}, {"node", 0}});
    expectOk({{"do", "load"}, {"scene", "tower"}});
    for (const ClientId page : {kPage, ClientId{8}}) EXPECT_EQ(pages_.last(page, "scene")["name"], "tower");
    EXPECT_EQ(pages_.last(kPage, "status")["picked"], Json());
    steps(10);
    EXPECT_EQ(pages_.last(kPage, "telemetry")["step"], 10);
    // The one that was started with stays in the list.
    expectOk({{"do", "load"}, {"scene", "yard"}});
    EXPECT_EQ(pages_.last(kPage, "scene")["name"], "yard");
}

TEST_F(SessionTest, ModelsOfTheCastArePublishedOnce) {
    open(folder_.write("yard.json", yard()).string(), {});
    const Json scene = pages_.last(kPage, "scene");
    ASSERT_EQ(scene["visuals"].size(), 1u);
    const std::string url = scene["visuals"][0]["url"];
    ASSERT_TRUE(url.starts_with("/visual/car_")) << url;
    EXPECT_EQ(scene["visuals"][0]["kind"], "car");
    EXPECT_GT(pages_.published.at(url.substr(8)), 1000u);
    EXPECT_EQ(scene["visuals"][0]["nodes"]["chassis"], scene["vehicles"][0]["chassis"]);
    int hidden = 0;
    for (const Json& node : scene["nodes"]) hidden += node.value("hidden", false);
    EXPECT_EQ(hidden, 5);
    expectOk({{"do", "reset"}});
    expectOk({{"do", "load"}, {"scene", "tower"}});
    expectOk({{"do", "load"}, {"scene", "yard"}});
    EXPECT_EQ(pages_.published.size(), 1u);
    EXPECT_EQ(pages_.last(kPage, "scene")["visuals"][0]["url"], url);
}

/// Whatever pages say, the world goes its way: the hashes are those of a session that heard nothing.
TEST_F(SessionTest, HostileMessagesChangeNothing) {
    openYard();
    std::vector<std::string> quiet;
    for (int i = 0; i < 20; ++i) {
        steps(1);
        quiet.push_back(hash());
    }
    expectOk({{"do", "reset"}});
    std::mt19937 random(3);
    const std::vector<std::string> seeds{
        R"({"do": "tune", "path": "settings.gravity", "value": [0, 1e400, 0], "id": 1})",
        R"({"do": "shoot", "origin": [0, 1e9, 0], "direction": [0, 0, 1]})",
        R"({"do": "grab", "node": 4294967295, "point": [0, 0, 0], "target": [0, 0, 0]})",
        R"({"do": "load", "scene": "/etc/passwd"})",
        R"({"do": "saveTuning", "name": "..\/..\/x"})",
        R"({"do": "step", "count": 1e3, "id": 5})",
        R"({"do": "drive", "vehicle": 0, "throttle": "full"})",
        R"([[[[[[[[[[[[]]]]]]]]]]]])",
        std::string("\0\0\0", 3),
    };
    for (int i = 0; i < 20; ++i) {
        for (int k = 0; k < 20; ++k) {
            std::string message = seeds[random() % seeds.size()];
            if (k % 2 != 0) message.resize(random() % (message.size() + 1));
            session_->receive(kPage, message);
        }
        steps(1);
        ASSERT_EQ(hash(), quiet[static_cast<std::size_t>(i)]) << i;
    }
}

TEST_F(SessionTest, StrangersAreNotHeard) {
    openYard();
    session_->receive(99, R"({"do": "play", "id": 1})");
    EXPECT_FALSE(session_->playing());
    EXPECT_TRUE(pages_.texts[99].empty());
}

TEST_F(SessionTest, FarScenesAreToldFromTheirMiddle) {
    std::string far = R"({"bodies": [
        {"name": "ground", "type": "fixed", "shape": {"box": {"halfExtents": [10, 1, 10]}}, "position": [1e6, -1, 2e6]},
        {"name": "box", "shape": {"box": {"halfExtents": [0.5, 0.5, 0.5]}}, "position": [1e6, 0.5, 2e6]}]})";
    open(folder_.write("far.json", far).string());
    const Json scene = pages_.last(kPage, "scene");
    EXPECT_EQ(scene["origin"], Json::array({1e6, 1.0, 2e6}));
    EXPECT_NEAR(scene["nodes"][1]["pose"][1].get<double>(), -0.5, 1e-6);
    expectOk({{"do", "grab"}, {"node", 1}, {"point", {0, 0, 0}}, {"target", {2, 1, 0}}});
    steps(120);
    EXPECT_NEAR(world().pose(session_->live().hand().held()).position.x, 1e6 + 2, 0.1);
}

}  // namespace
}  // namespace ragtop::live
