#include "ragdoll_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ragdoll_command.h"
#include "ragdoll_watch.h"
#include "ragtop/data_folder.h"
#include "ragtop/ragdoll_file.h"
#include "support/temporary_path.h"

namespace ragtop::demos {
namespace {

RagdollPart part(const std::string& name, int bone, const Vec3& place) {
    RagdollPart part;
    part.name = name;
    part.bone = bone;
    part.bind.position = place;
    part.shape = Capsule{0.05f, 0.1f};
    part.mass = 2;
    return part;
}

/// Two capsules on a hinge between them, which turns by ±0.5 rad.
RagdollSubject pair() {
    RagdollDef def;
    def.parts = {part("lower", 0, {}), part("upper", 1, {0, 0.4f, 0})};
    def.bones = {{"lower", -1, 0, {}}, {"upper", 0, 1, {}}};
    HingeDef hinge;
    hinge.bodies.frameA.position = {0, 0.2f, 0};
    hinge.bodies.frameB.position = {0, -0.2f, 0};
    hinge.limit = Range{-0.5f, 0.5f};
    hinge.friction = 0.1f;
    def.joints = {{0, 1, hinge}};
    return {"pair", def};
}

/// A capsule alone.
RagdollSubject single() {
    RagdollDef def;
    def.parts = {part("only", 0, {})};
    def.bones = {{"only", -1, 0, {}}};
    return {"single", def};
}

RagdollFigure figureOf(const RagdollSubject& subject, const std::string& test, const std::string& name) {
    for (const RagdollTest& each : ragdollTests()) {
        if (each.name != test) continue;
        for (const RagdollFigure& figure : each.run(subject, {.seeds = 3}))
            if (figure.name == name) return figure;
    }
    ADD_FAILURE() << test << " has no " << name;
    return {};
}

TEST(RagdollTrial, OnlyHumansAreToldToStand) {
    for (const RagdollTest& each : ragdollTests()) {
        const bool ofHumans = each.name == "balance" || each.name == "brace" || each.name == "getup";
        EXPECT_TRUE(!ofHumans || each.run(pair(), {.seeds = 1}).empty()) << each.name;
    }
}

TEST(RagdollTrial, AnOpenJointIsMeasuredAndNamed) {
    RagdollStage stage(pair(), {});
    WholenessWatch watch;
    watch.observe(stage, "before");
    Pose pose = stage.world.pose(stage.bodies[1]);
    pose.position.x += 0.03;
    stage.world.setPose(stage.bodies[1], pose);
    watch.observe(stage, "after");
    std::vector<RagdollFigure> figures;
    watch.tell("drop", figures);
    ASSERT_EQ(figures.size(), 2u);
    EXPECT_NEAR(figures[0].value, 0.03, 1e-6);
    EXPECT_EQ(figures[0].where, "after, upper at 0.00 s");
    EXPECT_FALSE(figures[0].passes());
    EXPECT_EQ(figures[1].value, 0);
    EXPECT_TRUE(figures[1].passes());
}

TEST(RagdollTrial, APassedLimitIsMeasuredInDegrees) {
    RagdollStage stage(pair(), {});
    // About the hinge's axis and place, by 0.3 rad more than it may.
    const Quat turn = rotationAbout({1, 0, 0}, 0.8f);
    stage.world.setPose(stage.bodies[1], {DVec3{0, 0.2, 0} + rotate(turn, {0, 0.2f, 0}), turn});
    WholenessWatch watch;
    watch.observe(stage, "bent");
    std::vector<RagdollFigure> figures;
    watch.tell("drop", figures);
    EXPECT_NEAR(figures[1].value, 0.3 * 180 / M_PI, 1e-3);
    EXPECT_NEAR(figures[0].value, 0, 1e-6);
}

TEST(RagdollTrial, WhatIsNoNumberIsTheWorst) {
    Worst worst;
    worst.add(3, "a");
    worst.add(std::numeric_limits<double>::quiet_NaN(), "b");
    worst.add(4, "c");
    const RagdollFigure figure{"drop", "joint_gap_max_m", worst.value(), 5, false, worst.where()};
    EXPECT_TRUE(std::isnan(figure.value));
    EXPECT_EQ(figure.where, "b");
    EXPECT_FALSE(figure.passes());
}

TEST(RagdollTrial, RestIsTheMeanOfSquaresOfTheLastQuarterSecond) {
    RagdollStage stage(pair(), {});
    RestWatch rest(20);
    stage.world.setVelocity(stage.bodies[0], {9, 0, 0}, {});
    rest.observe(stage);
    stage.world.setVelocity(stage.bodies[0], {3, 4, 0}, {});
    for (int i = 0; i < 5; ++i) rest.observe(stage);
    EXPECT_NEAR(rest.speed(), 5 / std::sqrt(2.0), 1e-6);
}

TEST(RagdollTrial, MomentumIsThatOfARigidBody) {
    RagdollStage stage(single(), {{0, 3, 0}, {}});
    stage.world.setVelocity(stage.bodies[0], {1, 2, 3}, {0, 5, 0});
    EXPECT_NEAR(stage.momentum().z, 6, 1e-5);
    const double about = static_cast<double>(stage.world.mass(stage.bodies[0]).inertia.cy.y);
    EXPECT_NEAR(stage.angularMomentum().y, 5 * about, 1e-6);
    EXPECT_NEAR(stage.lowestPoint(), 3 - 0.15, 1e-3);
}

TEST(RagdollTrial, AFallingBodyFollowsItsParabola) {
    EXPECT_TRUE(figureOf(single(), "flight", "path_error_max_m").passes());
    EXPECT_TRUE(figureOf(pair(), "flight", "path_error_max_m").passes());
}

/// The energy of a rigid body is what the hand gave it; of one that its joint brakes, less.
TEST(RagdollTrial, TheHandGivesWhatIsGained) {
    EXPECT_TRUE(figureOf(single(), "shake", "energy_gain_max_ratio").passes());
    EXPECT_TRUE(figureOf(pair(), "hang", "energy_gain_max_ratio").passes());
}

TEST(RagdollTrial, ACapsuleFallsAsleep) {
    const RagdollFigure asleep = figureOf(single(), "drop", "asleep_within_5_s_share");
    EXPECT_EQ(asleep.value, 1) << asleep.where;
    EXPECT_TRUE(figureOf(single(), "drop", "resting_speed_rms_m_s").passes());
}

TEST(RagdollTrial, ItsFiguresAreTheSameTwice) {
    const RagdollSubject mannequin = loadRagdollSubject((dataFolder() / "ragdolls/mannequin.ragdoll.json").string());
    EXPECT_EQ(figureOf(mannequin, "drop", "joint_gap_max_m").value,
              figureOf(mannequin, "drop", "joint_gap_max_m").value);
}

/// How the program ends, and what it prints.
int tryRagdoll(const std::string& arguments, std::string& text) {
    std::FILE* pipe = popen(("'" RAGTOP_PROGRAM "' ragdoll " + arguments + " 2>&1").c_str(), "r");
    char buffer[4096];
    text.clear();
    while (std::fgets(buffer, sizeof buffer, pipe)) text += buffer;
    return pclose(pipe) >> 8;
}

TEST(RagdollProgram, TellsWhatACharacterWasTakenFor) {
    const std::string json = temporaryPath("body.json").string();
    std::string text;
    ASSERT_EQ(
        tryRagdoll("'" RAGTOP_SOURCE_DIR "/tests/data/rigs/human_one_armed.gltf' --test none --json '" + json + "'",
                   text),
        0)
        << text;
    const auto body = nlohmann::json::parse(std::ifstream(json)).at("body");
    EXPECT_EQ(body.at("plan"), "human");
    EXPECT_EQ(body.at("roles").size(), 13u);
    for (const auto& role : body.at("roles")) {
        EXPECT_GE(role.at("confidence"), 0);
        EXPECT_LE(role.at("confidence"), 1);
    }
    ASSERT_EQ(body.at("warnings").size(), 1u);
    EXPECT_EQ(body.at("warnings")[0], "one arm is missing");
    EXPECT_NEAR(body.at("bones")[0].at("position")[1].get<double>(), 0.96, 1e-4);
    double mass = 0;
    for (const auto& part : body.at("parts")) mass += part.at("mass").get<double>();
    EXPECT_NEAR(mass, 24.49 * 1.73 * 1.73, 3);
}

TEST(RagdollProgram, TellsEachFigureAndFailsWithThem) {
    const std::string good = temporaryPath("single.ragdoll.json").string(),
                      json = temporaryPath("figures.json").string();
    saveRagdoll(std::get<RagdollDef>(single().def), good);
    std::string text;
    EXPECT_EQ(tryRagdoll("'" + good + "' --test drop --seeds 2 --json '" + json + "'", text), 0) << text;
    EXPECT_NE(text.find("joint_gap_max_m"), std::string::npos);
    std::ifstream file(json);
    std::stringstream figures;
    figures << file.rdbuf();
    EXPECT_NE(figures.str().find("\"name\": \"limit_passed_max_deg\", \"value\": 0, \"most\": 2, \"passes\": true"),
              std::string::npos)
        << figures.str();
    // A ball without rolling resistance rolls for good.
    RagdollDef ball = std::get<RagdollDef>(single().def);
    ball.parts[0].shape = Sphere{0.1f};
    const std::string bad = temporaryPath("ball.ragdoll.json").string();
    saveRagdoll(ball, bad);
    EXPECT_EQ(tryRagdoll("'" + bad + "' --test push --seeds 1 --push 4", text), 1) << text;
    EXPECT_NE(text.find("FAILS"), std::string::npos);
}

TEST(RagdollProgram, SaysWhatIsWrongInOneLine) {
    std::string text;
    EXPECT_EQ(tryRagdoll("nothing.glb", text), 2);
    EXPECT_EQ(text, "nothing.glb: no such file\n");
    EXPECT_EQ(tryRagdoll("nothing.glb --test fly", text), 2);
    EXPECT_EQ(text, "ragtop: --test: fly not in {drop,push,hang,shake,flight,balance,brace,getup,track,lod,none}\n");
    EXPECT_EQ(tryRagdoll("nothing.glb --hz 0", text), 2);
    const std::string hollow = temporaryPath("hollow.urdf").string();
    std::ofstream(hollow) << "<robot name='hollow'><link name='only'><inertial><mass value='1'/>"
                             "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";
    EXPECT_EQ(tryRagdoll("'" + hollow + "' --test drop", text), 2);
    EXPECT_NE(text.find("has no shapes, must have some to fall on the ground with\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace ragtop::demos
