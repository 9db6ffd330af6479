#include "serve/commands.h"

#include <gtest/gtest.h>

#include <ostream>
#include <random>

namespace ragtop::live {
namespace {

template <class T>
T read(const std::string& text) {
    const Message message = readMessage(text);
    EXPECT_EQ(message.error, "") << text;
    if (!message.command || !std::holds_alternative<T>(*message.command)) {
        ADD_FAILURE() << text << " is another command";
        return {};
    }
    return std::get<T>(*message.command);
}

TEST(Commands, AreReadWithTheirMembers) {
    read<PlayCommand>(R"({"do": "play"})");
    read<PauseCommand>(R"({"do": "pause"})");
    read<RestartCommand>(R"({"do": "reset"})");
    read<ScenesCommand>(R"({"do": "scenes"})");
    read<ReleaseCommand>(R"({"do": "release"})");
    read<HashCommand>(R"({"do": "hash"})");
    EXPECT_EQ(read<StepCommand>(R"({"do": "step", "count": -600})").count, -600);
    EXPECT_EQ(read<SeekCommand>(R"({"do": "seek", "step": 1234567890123})").step, 1234567890123u);
    EXPECT_EQ(read<SpeedCommand>(R"({"do": "speed", "factor": 0.25})").factor, 0.25);
    EXPECT_EQ(read<LoadCommand>(R"({"do": "load", "scene": "crash"})").scene, "crash");
    EXPECT_EQ(read<ResetVehicleCommand>(R"({"do": "resetVehicle", "vehicle": 1})").vehicle, 1u);
    EXPECT_EQ(read<PickCommand>(R"({"do": "pick", "node": 3})").node, 3u);
    EXPECT_FALSE(read<PickCommand>(R"({"do": "pick", "node": null})").node);
    EXPECT_EQ(read<UntuneCommand>(R"({"do": "untune", "path": "a.b"})").path, "a.b");
    EXPECT_EQ(read<SaveTuningCommand>(R"({"do": "saveTuning"})").name, "tuned");
    EXPECT_EQ(read<LoadTuningCommand>(R"({"do": "loadTuning", "name": "soft-2"})").name, "soft-2");
    const auto show = read<ShowCommand>(R"({"do": "show", "joints": true, "bounds": false})");
    ASSERT_EQ(show.options.size(), 2u);
    const auto grab = read<GrabCommand>(R"({"do": "grab", "node": 5, "point": [1, 2, 3], "target": [4, 5, 6]})");
    EXPECT_EQ(grab.node, 5u);
    EXPECT_EQ(grab.point, (Vec3{1, 2, 3}));
    EXPECT_EQ(grab.target, (Vec3{4, 5, 6}));
    EXPECT_EQ(read<DragCommand>(R"({"do": "drag", "target": [4, 5, 6]})").target, (Vec3{4, 5, 6}));
    const auto shoot =
        read<ShootCommand>(R"({"do": "shoot", "origin": [0, 1, 0], "direction": [0, 0, 1], "speed": 5})");
    EXPECT_EQ(shoot.speed, 5);
    EXPECT_EQ(shoot.radius, ShootCommand{}.radius);
}

TEST(Commands, DrivingChangesOnlyWhatIsGiven) {
    const auto drive = read<DriveCommand>(R"({"do": "drive", "vehicle": 0, "throttle": 0.5, "gear": null})");
    EXPECT_EQ(drive.throttle, 0.5f);
    EXPECT_FALSE(drive.brake);
    ASSERT_TRUE(drive.gear);
    EXPECT_FALSE(*drive.gear);
    EXPECT_EQ(**read<DriveCommand>(R"({"do": "drive", "vehicle": 0, "gear": -1})").gear, -1);
}

TEST(Commands, TunedValuesHaveTheTypesOfTunables) {
    const auto value = [](const std::string& json) {
        return read<TuneCommand>(R"({"do": "tune", "path": "p", "value": )" + json + "}").value;
    };
    EXPECT_EQ(value("2.5"), TuneValue(2.5));
    EXPECT_EQ(value("2"), TuneValue(2.0));
    EXPECT_EQ(value("true"), TuneValue(true));
    EXPECT_EQ(value("null"), TuneValue());
    EXPECT_EQ(value("[1, 2, 3]"), TuneValue(DVec3(1, 2, 3)));
    EXPECT_EQ(value("\"open\""), TuneValue(std::string("open")));
}

struct Bad {
    const char* text;
    const char* error;

    friend std::ostream& operator<<(std::ostream& out, const Bad& bad) { return out << bad.text; }
};

class BadCommand : public testing::TestWithParam<Bad> {};

TEST_P(BadCommand, IsOneErrorThatNamesIt) {
    const Message message = readMessage(GetParam().text);
    EXPECT_FALSE(message.command);
    EXPECT_NE(message.error.find(GetParam().error), std::string::npos) << message.error;
    EXPECT_EQ(message.error.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Messages, BadCommand,
    testing::Values(
        Bad{"", "is not JSON"}, Bad{"{", "is not JSON"}, Bad{"[]", "is [], must be an object"},
        Bad{"7", "must be an object"}, Bad{"{}", "do is missing, must be one of play, pause"},
        Bad{R"({"do": 3})", "do is 3, must be one of"}, Bad{R"({"do": "fly"})", "do is \"fly\", must be one of"},
        Bad{R"({"do": "play", "id": 1.5})", "id is 1.5, must be an integer"},
        Bad{R"({"do": "play", "id": "1"})", "id is \"1\", must be an integer"},
        Bad{R"({"do": "play", "loud": true})", "play: \"loud\" is unknown, must be one of do, id"},
        Bad{R"({"do": "play", "do": "pause"})", "\"do\" occurs twice"},
        Bad{R"({"do": "step"})", "step: count is missing, must be an integer in [-600, 600]"},
        Bad{R"({"do": "step", "count": 601})", "step: count is 601, must be an integer in [-600, 600]"},
        Bad{R"({"do": "step", "count": 1.5})", "step: count is 1.5"},
        Bad{R"({"do": "step", "count": 1e999})", "is not JSON"}, Bad{R"({"do": "step", "count": NaN})", "is not JSON"},
        Bad{R"({"do": "step", "count": null})", "step: count is null"},
        Bad{R"({"do": "seek", "step": -1})", "seek: step is -1"},
        Bad{R"({"do": "seek", "step": 18446744073709551615})", "seek: step is 18446744073709551615"},
        Bad{R"({"do": "speed", "factor": 0})", "speed: factor is 0, must be a number in [0.01, 4]"},
        Bad{R"({"do": "speed", "factor": true})", "speed: factor is true"},
        Bad{R"({"do": "load", "scene": 1})", "load: scene is 1, must be a text"},
        Bad{R"({"do": "show", "ghosts": true})", "show: \"ghosts\" is unknown"},
        Bad{R"({"do": "show", "joints": 1})", "show: joints is 1, must be true or false"},
        Bad{R"({"do": "grab", "node": 0, "point": [0, 0], "target": [0, 0, 0]})",
            "grab: point is [0,0], must be three"},
        Bad{R"({"do": "grab", "node": -1, "point": [0, 0, 0], "target": [0, 0, 0]})", "grab: node is -1"},
        Bad{R"({"do": "drag", "target": [0, 1e30, 0]})", "drag: target is 1e+30"},
        Bad{R"({"do": "drag", "target": [0, "1", 0]})", "drag: target is \"1\""},
        Bad{R"({"do": "shoot", "origin": [0, 0, 0], "direction": [0, 0, 1], "speed": 1000})", "shoot: speed is 1000"},
        Bad{R"({"do": "shoot", "origin": [0, 0, 0], "direction": [0, 0, 1], "radius": 0})", "shoot: radius is 0"},
        Bad{R"({"do": "drive", "vehicle": 0, "throttle": 2})", "drive: throttle is 2, must be a number in [0, 1]"},
        Bad{R"({"do": "drive", "throttle": 1})", "drive: vehicle is missing"},
        Bad{R"({"do": "drive", "vehicle": 0, "gear": 1.5})", "drive: gear is 1.5"},
        Bad{R"({"do": "pick"})", "pick: node is missing"}, Bad{R"({"do": "pick", "node": []})", "pick: node is []"},
        Bad{R"({"do": "tune", "path": "x", "value": {}})", "tune: value is {}"},
        Bad{R"({"do": "tune", "path": "x", "value": [1, 2]})", "tune: value is [1,2]"},
        Bad{R"({"do": "tune", "value": 1})", "tune: path is missing"},
        Bad{R"({"do": "saveTuning", "name": "../../etc/passwd"})",
            "saveTuning: name is \"../../etc/passwd\", must be 1 to 64"},
        Bad{R"({"do": "saveTuning", "name": ""})", "saveTuning: name is \"\""},
        Bad{R"({"do": "loadTuning", "name": "a/b"})", "loadTuning: name is \"a/b\""},
        Bad{R"({"do": "loadTuning"})", "loadTuning: name is missing"},
        Bad{"{\"do\": \"load\", \"scene\": \"\xff\xfe\"}", "is not JSON"}));

TEST(Commands, KeepTheIdOfWhatIsWrong) {
    const Message message = readMessage(R"({"id": 12, "do": "fly"})");
    EXPECT_EQ(message.id, 12);
    EXPECT_FALSE(message.error.empty());
}

TEST(Commands, DeepNestingIsRefused) {
    const Message message = readMessage(R"({"do": "tune", "path": "x", "value": )" + std::string(30000, '[') +
                                        std::string(30000, ']') + "}");
    EXPECT_NE(message.error.find("nests deeper"), std::string::npos) << message.error;
}

TEST(Commands, LongValuesAreShownShort) {
    const Message message = readMessage(R"({"do": ")" + std::string(60000, 'x') + "\"}");
    EXPECT_LT(message.error.size(), 400u);
}

/// Bytes changed at random are read or refused, and nothing else happens.
TEST(Commands, SurviveDamage) {
    const std::string good =
        R"({"id": 1, "do": "shoot", "origin": [0, 1.5, -2e3], "direction": [0, 0, 1], "speed": 30})";
    std::mt19937 random(1);
    int understood = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text = good;
        for (unsigned k = 0; k <= random() % 3; ++k) text[random() % text.size()] = static_cast<char>(random());
        const Message message = readMessage(text);
        EXPECT_NE(message.command.has_value(), !message.error.empty());
        understood += message.command.has_value();
    }
    EXPECT_GT(understood, 0);
}

}  // namespace
}  // namespace ragtop::live
