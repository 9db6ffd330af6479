#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>
#include "support/temporary_path.h"

namespace {

/// What the program prints; it must end well.
std::string printedBy(const std::string& arguments) {
    std::FILE* pipe = popen(("'" RAGTOP_PROGRAM "' " + arguments + " 2>/dev/null").c_str(), "r");
    std::string text;
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe)) text += buffer.data();
    EXPECT_EQ(pclose(pipe), 0) << arguments;
    return text;
}

std::string hashOf(const std::string& summary) {
    const auto at = summary.find("\"hash\": \"");
    return at == std::string::npos ? "none" : summary.substr(at + 9, 16);
}

/// The keys of the outermost object, in their order.
std::vector<std::string> keysOf(const std::string& summary) {
    std::vector<std::string> keys;
    for (std::size_t at = summary.find("\n  \""); at != std::string::npos; at = summary.find("\n  \"", at + 1)) {
        keys.push_back(summary.substr(at + 4, summary.find('"', at + 4) - at - 4));
    }
    return keys;
}

std::string contentOf(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string folder(const std::string& name) {
    const auto path = temporaryPath(name);
    std::filesystem::create_directories(path);
    return path.string();
}

TEST(Run, SummaryHasExactlyItsKeys) {
    const std::vector<std::string> keys{"hash",
                                        "steps",
                                        "finite",
                                        "real_time_factor",
                                        "real_time_factor_min",
                                        "ms_per_step",
                                        "contacts",
                                        "penetration_max_m",
                                        "penetration_p99_m",
                                        "joint_gap_max_m",
                                        "moved_max_m",
                                        "max_speed_m_s",
                                        "energy_j",
                                        "warnings"};
    const std::string out = folder("run_summary");
    const std::string printed = printedBy("run tower --steps 20 --out '" + out + "'");
    EXPECT_EQ(keysOf(printed), keys);
    for (const char* file : {"recording.glb", "telemetry.csv", "summary.json"}) {
        EXPECT_GT(std::filesystem::file_size(std::filesystem::path(out) / file), 100u) << file;
    }
    std::filesystem::remove_all(out);
}

/// In what it prints, in summary.json and on the terminal.
TEST(Run, WarnsOfWhatBeginsInTheGround) {
    const std::string out = folder("run_warnings");
    const auto scene = fileWith("sunk.json", R"({"bodies": [
        {"name": "ground", "type": "fixed", "position": [0, -1, 0], "shape": {"box": {"halfExtents": [50, 1, 50]}}},
        {"name": "crate", "position": [0, 0.2, 0], "shape": {"box": {}}}]})");
    const std::string warning = "body \"crate\" begins about 0.3 m inside of body \"ground\"";
    const std::string terminal = out + "/terminal.txt";
    const std::string run = "'" RAGTOP_PROGRAM "' run '" + scene.string() + "' --steps 2 --out '" + out + "'";
    ASSERT_EQ(std::system((run + " >/dev/null 2>'" + terminal + "'").c_str()), 0);
    EXPECT_THAT(contentOf(terminal), testing::StartsWith("warning: " + warning + "\n"));
    std::string quoted = warning;
    for (std::size_t at = 0; (at = quoted.find('"', at)) != std::string::npos; at += 2) quoted.insert(at, "\\");
    const auto tells = testing::HasSubstr("\"warnings\": [\n    \"" + quoted + "\"\n  ]");
    EXPECT_THAT(contentOf(out + "/summary.json"), tells);
    EXPECT_THAT(printedBy("run '" + scene.string() + "' --steps 2"), tells);
    std::filesystem::remove_all(out);
}

TEST(Run, PosesAreWrittenEachSecondAndAtTheEnd) {
    const std::string out = folder("run_poses");
    printedBy("run tower --steps 70 --poses '" + out + "/poses.csv'");
    std::ifstream file(out + "/poses.csv");
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "step,time_s,body,x_m,y_m,z_m,qx,qy,qz,qw");
    std::map<std::string, int> bodiesAtStep;
    while (std::getline(file, line)) ++bodiesAtStep[line.substr(0, line.find(','))];
    // The ground and twelve boxes.
    EXPECT_EQ(bodiesAtStep, (std::map<std::string, int>{{"60", 13}, {"70", 13}}));
    std::filesystem::remove_all(out);
}

// Unoptimised and instrumented builds are slow: they go a part of the way.
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
constexpr int kSteps = 600;
#else
constexpr int kSteps = 40;
#endif

class SceneRun : public testing::TestWithParam<std::string> {
protected:
    static std::string steps(int count) { return " --steps " + std::to_string(count); }
};

/// With four lanes and with sixteen; with eight on two threads, saving a state half way; and from that on one thread.
TEST_P(SceneRun, EndsAlikeWithAnyWidthAndThreadsAndWithAStopOnTheWay) {
    const std::string out = folder("run_" + GetParam()), run = "run " + GetParam() + steps(kSteps);
    const std::string half = std::to_string(kSteps / 2);
    const std::string reference = hashOf(printedBy(run + " --lanes 4"));
    EXPECT_NE(reference, "none");
    EXPECT_EQ(hashOf(printedBy(run + " --lanes 16")), reference);
    EXPECT_EQ(hashOf(printedBy(run + " --lanes 8 --threads 2 --save-at " + half + " --out '" + out + "'")), reference);
    EXPECT_EQ(hashOf(printedBy(run + " --lanes 8 --restore '" + out + "/state_" + half + ".bin'")), reference);
    std::filesystem::remove_all(out);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneRun,
                         testing::Values("cape", "crash", "dummy", "hills", "puppet", "rain", "parade", "robots",
                                         "tower", "track", "wrecker"),
                         [](const testing::TestParamInfo<std::string>& scene) { return scene.param; });

TEST(Run, SettingsChangeWhatHappens) {
    const std::string rest = hashOf(printedBy("run tower --steps 30 --set gravity=[0,0,0]"));
    EXPECT_NE(rest, hashOf(printedBy("run tower --steps 30")));
}

TEST(Version, IsPrinted) {
    EXPECT_THAT(printedBy("--version"), testing::MatchesRegex("ragtop [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Inspect, TellsWhatAVehicleAndASceneHave) {
    EXPECT_NE(printedBy("inspect tower").find("13 bodies"), std::string::npos);
    EXPECT_NE(printedBy("inspect '" RAGTOP_SOURCE_DIR "/assets/data/vehicles/hatchback.car.json'").find("4 wheels"),
              std::string::npos);
}

}  // namespace
