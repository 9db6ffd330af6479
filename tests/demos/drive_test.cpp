#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "support/temporary_path.h"

namespace {

struct Ended {
    int status = 0;
    std::string text;  ///< both streams
};

Ended ragtopDrive(const std::string& arguments) {
    std::FILE* pipe = popen(("'" RAGTOP_PROGRAM "' drive " + arguments + " 2>&1").c_str(), "r");
    Ended ended;
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe)) ended.text += buffer.data();
    ended.status = WEXITSTATUS(pclose(pipe));
    return ended;
}

std::string textOf(const std::filesystem::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

TEST(Drive, WritesARowPerValueAChannelPerColumnAndAPlot) {
    const std::filesystem::path folder = temporaryPath("drive");
    std::filesystem::create_directories(folder);
    const Ended ended = ragtopDrive("hatchback --manoeuvre side --json '" + (folder / "a.json").string() + "' --csv '" +
                                    (folder / "a.csv").string() + "' --svg '" + (folder / "a.svg").string() + "'");
    EXPECT_EQ(ended.status, 0) << ended.text;
    const auto rows = nlohmann::json::parse(textOf(folder / "a.json"));
    ASSERT_EQ(rows.size(), 2u);
    for (const char* key : {"manoeuvre", "car", "hz", "level", "name", "value", "unit", "reference", "error", "pass"})
        EXPECT_TRUE(rows[0].contains(key)) << key;
    EXPECT_EQ(rows[1]["manoeuvre"], "side");
    EXPECT_EQ(textOf(folder / "a.csv").substr(0, 24), "time [s],speed [m/s],dis");
    EXPECT_NE(textOf(folder / "a.svg").find("<polyline"), std::string::npos);
    std::filesystem::remove_all(folder);
}

TEST(Drive, EndsWithOneWhereAValueFailsAndWithTwoOnBadInput) {
    const std::filesystem::path file = temporaryPath("fast.json");
    std::ofstream(file) << R"({"duration": 1, "measure": [{"name": "speed", "channel": "speed", "least": 50}]})";
    EXPECT_EQ(ragtopDrive("hatchback --manoeuvre '" + file.string() + "'").status, 1);
    std::filesystem::remove(file);
    for (const char* bad : {"no_such_car", "hatchback --manoeuvre no_such", "hatchback --hz 1",
                            "hatchback --surface -1", "hatchback --level 3", "hatchback --manoeuvre kerb --level 1"}) {
        const Ended ended = ragtopDrive(bad);
        EXPECT_EQ(ended.status, 2) << ended.text;
        EXPECT_EQ(std::count(ended.text.begin(), ended.text.end(), '\n'), 1) << ended.text;
    }
}

}  // namespace
