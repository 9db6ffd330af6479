#include "serve/live_tuning.h"

#include <gtest/gtest.h>

#include <cmath>

#include "live_support.h"
#include "ragtop/world.h"

namespace ragtop::live {
namespace {

class LiveTuning : public SessionTest {
protected:
    void SetUp() override { openYard(); }

    Json tune(const std::string& path, const Json& value) {
        return expectOk({{"do", "tune"}, {"path", path}, {"value", value}})["value"];
    }
    const TunableField& field(const std::string& path) { return session_->stage().tuning().field(path); }
    double height() { return world().pose(car().chassis()).position.y; }
    TuneState values() { return *session_->stage().tuning().state(); }
    /// Changes the file of the scene and lets the session see it.
    void rewrite(const std::string& from, const std::string& to) {
        std::string text = yard();
        const auto at = text.find(from);
        ASSERT_NE(at, std::string::npos);
        text.replace(at, from.size(), to);
        const auto file = folder_.write("yard.json", text);
        // Times of files may be coarser than this test is quick.
        std::filesystem::last_write_time(file,
                                         std::filesystem::last_write_time(file) + std::chrono::seconds(++seconds_));
        session_->advance(1);
    }
    int seconds_ = 0;
};

TEST_F(LiveTuning, EveryTunableMayHaveTheValueThatItHas) {
    for (const TunableField& one : session_->stage().tuning().fields()) {
        EXPECT_EQ(whyInvalid(one, one.value), "");
        EXPECT_FALSE(one.label.empty());
        EXPECT_FALSE(one.group.empty());
        EXPECT_FALSE(one.meaning.empty()) << one.path;
        EXPECT_LE(one.minimum, one.maximum);
    }
    const TuneState before = values();
    const std::vector<TunableField> all = session_->stage().tuning().fields();
    for (const TunableField& one : all) tune(one.path, tuneJson(one.value));
    EXPECT_EQ(values(), before);
}

/// The spring carries the same weight with less compression: F = k x, so that the car rises by x₀ (1 − k₀/k).
TEST_F(LiveTuning, StifferSpringsLiftTheCar) {
    steps(300);
    const double before = height();
    const std::vector<std::string> wheels{"front left", "front right", "rear left", "rear right"};
    for (const std::string& wheel : wheels) {
        const std::string path = "vehicles.car.wheels." + wheel + ".suspension.stiffness";
        tune(path, 1.25 * std::get<double>(field(path).value));
    }
    steps(600);
    const auto rise = [&](float compression) { return static_cast<double>(compression) * (1 - 1 / 1.25); };
    const double front = rise(0.1366f), rear = rise(0.1104f);
    // The frame of the chassis is midway between the axles.
    EXPECT_NEAR(height() - before, 0.5 * (front + rear), 5e-4);
    EXPECT_LT(length(world().linearVelocity(car().chassis())), 1e-3);
}

TEST_F(LiveTuning, TheCarKeepsItsMotion) {
    expectOk({{"do", "drive"}, {"vehicle", 0}, {"throttle", 1}});
    steps(120);
    const Vec3 speed = world().linearVelocity(car().chassis());
    const float rpm = car().telemetry().engine.rpm;
    tune("vehicles.car.wheels.front left.suspension.stiffness", 50000);
    tune("vehicles.car.steering.maxAngle", 0.4);
    tune("vehicles.car.aerodynamics.dragArea", 0.3);
    tune("vehicles.car.gearbox.finalDrive", 4.2);
    EXPECT_EQ(world().linearVelocity(car().chassis()), speed);
    EXPECT_EQ(car().telemetry().engine.rpm, rpm);
    EXPECT_GT(car().telemetry().wheels[0].load, 1000);
}

TEST_F(LiveTuning, ReachesEveryKindOfThing) {
    tune("settings.gravity", {0, -1.6, 0});
    EXPECT_EQ(world().settings().gravity, (Vec3{0, -1.6f, 0}));
    tune("settings.sleeping", false);
    EXPECT_FALSE(world().settings().sleeping);
    tune("settings.solver", "direct");
    EXPECT_EQ(world().settings().solver, SolverChoice::direct);
    tune("settings.substeps", 8);
    EXPECT_EQ(world().settings().substeps, 8);
    tune("materials.brick.friction", 0.1);
    const BodyId brick = world().bodies()[nodeNamed("brick 3")];
    EXPECT_EQ(world().material(world().shapes(brick)[0]).friction, 0.1f);
    tune("vehicles.car.differential.type", "locked");
    EXPECT_EQ(car().def().differential.type, DifferentialType::locked);
    tune("vehicles.car.engine.torqueCurve.2.torque", 200);
    EXPECT_EQ(car().def().engine.torqueCurve[2].torque, 200);
    tune("vehicles.car.gearbox.clutchTorque", 300);
    EXPECT_EQ(car().def().gearbox.clutchTorque, 300.0f);
    EXPECT_EQ(tune("vehicles.car.gearbox.clutchTorque", nullptr), Json());
    EXPECT_FALSE(car().def().gearbox.clutchTorque);
    tune("ragdolls.person.joints.left forearm.limit.lower", -1);
    tune("ragdolls.person.parts.head.mass", 9);
    const Ragdoll& person = *session_->stage().cast().ragdolls[0].ragdoll;
    EXPECT_EQ(world().mass(person.body("head")).mass, 9);
    bool found = false;
    for (const JointId joint : world().jointsOf(person.body("left forearm"))) {
        const auto* hinge = std::get_if<HingeDef>(&world().def(joint));
        found = found || (hinge && hinge->limit && hinge->limit->lower == -1);
    }
    EXPECT_TRUE(found);
    steps(60);
}

TEST_F(LiveTuning, WhatCannotBeIsRefusedAndChangesNothing) {
    const TuneState before = values();
    const std::string hashBefore = hash();
    const auto refused = [&](const std::string& path, const Json& value) {
        return errorOf({{"do", "tune"}, {"path", path}, {"value", value}});
    };
    EXPECT_NE(refused("settings.warp", 1).find("path is \"settings.warp\", must be that of one of the"),
              std::string::npos);
    EXPECT_EQ(refused("settings.substeps", 0), "tune: settings.substeps is 0, must be an integer in [1, 64]");
    EXPECT_EQ(refused("settings.substeps", true), "tune: settings.substeps is true, must be an integer in [1, 64]");
    EXPECT_EQ(refused("settings.sleeping", 1), "tune: settings.sleeping is 1, must be true or false");
    EXPECT_EQ(refused("settings.solver", 1),
              "tune: settings.solver is 1, must be one of \"automatic\", \"iterative\", \"direct\"");
    EXPECT_EQ(refused("settings.gravity", 9.81),
              "tune: settings.gravity is 9.81, must be three numbers in [-1000, 1000] m/s²");
    EXPECT_EQ(refused("vehicles.car.chassis.mass", -1),
              "tune: vehicles.car.chassis.mass is -1, must be a number in [0.001, 1e+09] kg");
    EXPECT_EQ(refused("vehicles.car.chassis.mass", nullptr),
              "tune: vehicles.car.chassis.mass is null, must be a number in [0.001, 1e+09] kg");
    EXPECT_EQ(refused("vehicles.car.differential.type", "none"),
              "tune: vehicles.car.differential.type is \"none\", must be one of \"open\", \"locked\", \"limitedSlip\", "
              "\"helical\", \"viscous\", \"active\"");
    // Good by itself, but not with the others.
    EXPECT_NE(refused("vehicles.car.engine.limiterRpm", 100).find("must be above idleRpm"), std::string::npos);
    EXPECT_NE(refused("vehicles.car.wheels.front left.position", {0, 0.3, -5}).find("carry"), std::string::npos);
    EXPECT_NE(refused("ragdolls.person.joints.left forearm.limit.lower", 1), "");
    EXPECT_EQ(values(), before);
    EXPECT_EQ(hash(), hashBefore);
}

TEST_F(LiveTuning, AllPagesLearnWhatChanged) {
    session_->join(8);
    tune("settings.substeps", 6);
    for (const ClientId page : {kPage, ClientId{8}}) {
        const Json values = pages_.last(page, "tunables")["values"];
        ASSERT_EQ(values.size(), 1u);
        EXPECT_EQ(values[0]["path"], "settings.substeps");
        EXPECT_EQ(values[0]["value"], 6);
    }
    steps(5);
    expectOk({{"do", "untune"}, {"path", "settings.substeps"}});
    EXPECT_EQ(pages_.last(8, "tunables")["values"][0]["value"], 4);
    // Back before that, it is tuned again.
    expectOk({{"do", "seek"}, {"step", 2}});
    EXPECT_EQ(pages_.last(8, "tunables")["values"][0]["value"], 6);
}

TEST_F(LiveTuning, SavedAndLoadedValuesAreEqual) {
    tune("settings.gravity", {0.1, -3.3, 0});
    tune("vehicles.car.wheels.rear left.suspension.stiffness", 31234.5);
    tune("vehicles.car.gearbox.clutchTorque", 333.25);
    tune("vehicles.car.differential.type", "limitedSlip");
    tune("ragdolls.person.joints.head.swingLimit", 0.321);
    tune("ragdolls.person.parts.chest.mass", 13.7);
    tune("materials.brick.friction", 0.44);
    const TuneState tuned = values();
    const std::string file = expectOk({{"do", "saveTuning"}, {"name", "soft"}})["file"];
    EXPECT_TRUE(std::filesystem::exists(file));
    EXPECT_LT(std::filesystem::file_size(file), 1000u);

    // As a scene of its own, with what it extends.
    const Scene scene = loadScene(file);
    TuneState loaded;
    std::size_t i = 0;
    const auto& fields = session_->stage().tuning().fields();
    for (const TunableField& one : tunablesOf(scene)) {
        EXPECT_EQ(one.path, fields[i].path);
        EXPECT_EQ(one.minimum, fields[i].minimum);
        EXPECT_EQ(one.maximum, fields[i].maximum);
        EXPECT_EQ(one.unit, fields[i].unit);
        loaded.push_back(one.value);
        ++i;
    }
    EXPECT_EQ(loaded, tuned);

    // Into the running one.
    steps(10);
    for (const TunedValue& one : session_->stage().tuning().changed())
        expectOk({{"do", "untune"}, {"path", one.first}});
    EXPECT_TRUE(session_->stage().tuning().changed().empty());
    EXPECT_EQ(expectOk({{"do", "loadTuning"}, {"name", "soft"}})["changed"], 7);
    EXPECT_EQ(values(), tuned);
    EXPECT_EQ(session_->live().now(), 10u);

    // And a world made from that file begins like this one begun again.
    expectOk({{"do", "reset"}});
    steps(30);
    World plain(scene.settings);
    SceneInstance instance(scene, plain);
    for (int step = 0; step < 30; ++step) {
        instance.drive(plain.time());
        plain.step(scene.step);
    }
    EXPECT_EQ(std::stoull(hash(), nullptr, 16), plain.hash());
}

TEST_F(LiveTuning, TuningsOfOtherScenesAreRefused) {
    expectOk({{"do", "saveTuning"}, {"name", "mine"}});
    std::filesystem::copy(folder_ / "tuning" / "yard_mine.json", folder_ / "tuning" / "tower_mine.json");
    expectOk({{"do", "load"}, {"scene", "tower"}});
    EXPECT_NE(errorOf({{"do", "loadTuning"}, {"name", "mine"}}).find("is another scene, must extend"),
              std::string::npos);
}

TEST_F(LiveTuning, AChangedFileIsTakenUpWhileItRuns) {
    steps(30);
    tune("settings.substeps", 7);
    rewrite("\"friction\": 0.6", "\"friction\": 0.2");
    const Json file = pages_.last(kPage, "file");
    EXPECT_TRUE(file["ok"].get<bool>()) << file["message"];
    EXPECT_EQ(session_->live().now(), 30u);
    EXPECT_EQ(field("materials.brick.friction").value, TuneValue(0.2));
    EXPECT_EQ(pages_.last(kPage, "tunables")["tunables"].size(), values().size());
    // What the file says is the new default; what was tuned stays.
    EXPECT_EQ(expectOk({{"do", "untune"}, {"path", "materials.brick.friction"}})["value"], 0.2);
    EXPECT_EQ(world().settings().substeps, 7);
    // And it is one input more, that goes back with the world.
    expectOk({{"do", "seek"}, {"step", 20}});
    EXPECT_EQ(field("materials.brick.friction").value, TuneValue(0.6));
}

TEST_F(LiveTuning, AnErrorInAFileIsToldWithItsLineAndChangesNothing) {
    steps(30);
    const TuneState before = values();
    rewrite("\"friction\": 0.6", "\"friction\": -0.6");
    Json file = pages_.last(kPage, "file");
    EXPECT_FALSE(file["ok"].get<bool>());
    EXPECT_NE(file["message"].get<std::string>().find("yard.json:3:"), std::string::npos) << file["message"];
    rewrite("\"friction\": 0.6", "\"friction\": 0.6,,");
    file = pages_.last(kPage, "file");
    EXPECT_FALSE(file["ok"].get<bool>());
    EXPECT_NE(file["message"].get<std::string>().find("is not JSON"), std::string::npos) << file["message"];
    EXPECT_EQ(values(), before);
    EXPECT_EQ(session_->live().now(), 30u);
    rewrite("\"friction\": 0.6", "\"friction\": 0.5");
    EXPECT_TRUE(pages_.last(kPage, "file")["ok"].get<bool>());
}

TEST_F(LiveTuning, MoreThanValuesMakesTheSceneAnew) {
    steps(30);
    rewrite("\"bricks\": 5", "\"bricks\": 6");
    EXPECT_TRUE(pages_.last(kPage, "file")["ok"].get<bool>());
    EXPECT_EQ(session_->live().now(), 0u);
    nodeNamed("brick 24");
}

TEST_F(LiveTuning, OverridesOfTheCommandLineMayTuneToo) {
    LiveSceneOptions options{.visuals = false};
    options.overrides = {{"tuning.vehicles.car.chassis.mass", "1500"}, {"substeps", "5"}};
    open((folder_ / "yard.json").string(), options);
    EXPECT_EQ(car().def().chassis.mass, 1500);
    EXPECT_EQ(world().settings().substeps, 5);
}

}  // namespace
}  // namespace ragtop::live
