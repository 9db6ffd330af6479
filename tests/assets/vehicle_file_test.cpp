#include "ragtop/vehicle_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "ragtop/asset_error.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

VehicleDef shippedCar() {
    return loadVehicle(std::filesystem::path(RAGTOP_SOURCE_DIR) / "assets/data/vehicles/hatchback.car.json");
}

/// Written and read again.
VehicleDef copied(const VehicleDef& def) {
    const auto path = temporaryPath("copy.car.json");
    saveVehicle(def, path);
    VehicleDef copy = loadVehicle(path);
    std::filesystem::remove(path);
    return copy;
}

TEST(VehicleFile, KeepsCurvesStopsAndBars) {
    VehicleDef def = shippedCar();
    SuspensionDef& suspension = def.wheels[2].suspension;
    suspension.compressionCurve = {{0.05f, 300}, {0.3f, 600}};
    suspension.reboundCurve = {{0.1f, 800}};
    suspension.bumpStopProgression = 3;
    suspension.droopStopStiffness = 2.0f;
    def.antiRollBars = {{0, 20000}, {1, 8000}};
    const VehicleDef copy = copied(def);
    const SuspensionDef& read = copy.wheels[2].suspension;
    ASSERT_EQ(read.compressionCurve.size(), 2u);
    EXPECT_EQ(read.compressionCurve[1].speed, 0.3f);
    EXPECT_EQ(read.compressionCurve[1].force, 600);
    ASSERT_EQ(read.reboundCurve.size(), 1u);
    EXPECT_EQ(read.bumpStopProgression, 3);
    EXPECT_EQ(read.droopStopStiffness, 2.0f);
    ASSERT_EQ(copy.antiRollBars.size(), 2u);
    EXPECT_EQ(copy.antiRollBars[1].axle, 1u);
    EXPECT_EQ(copy.antiRollBars[1].stiffness, 8000);
    EXPECT_TRUE(copy.wheels[0].suspension.compressionCurve.empty());
}

TEST(VehicleFile, KeepsHardpoints) {
    const VehicleDef def =
        loadVehicle(std::filesystem::path(RAGTOP_SOURCE_DIR) / "assets/data/vehicles/hatchback_linkages.car.json");
    EXPECT_EQ(def.wheels.size(), 4u);
    const VehicleDef copy = copied(def);
    ASSERT_EQ(copy.linkages.size(), 2u);
    ASSERT_TRUE(copy.linkages[0].mcPherson && copy.linkages[0].tieRod && copy.linkages[1].trailingArm);
    EXPECT_EQ(copy.linkages[0].mcPherson->strutTop, (Vec3{0.56f, 0.85f, 1.235f}));
    EXPECT_EQ(copy.linkages[1].spring->carrier, (Vec3{0.55f, 0.28f, -1.20f}));
    EXPECT_EQ(copy.linkages[1].mass, 12);
    EXPECT_FALSE(copy.linkages[1].tieRod);
}

/// Where in the file, and what would do.
TEST(VehicleFile, SaysWhichHardpointCannotBe) {
    const auto base = std::filesystem::path(RAGTOP_SOURCE_DIR) / "assets/data/vehicles/hatchback.car.json";
    const auto path = temporaryPath("wrong.car.json");
    const auto whyOf = [&](const std::string& linkage) {
        std::ofstream(path) << "{\"extends\": \"" << base.string() << "\",\n\"linkages\": [\n" << linkage << "]}";
        std::string why;
        try {
            loadVehicle(path);
        } catch (const AssetError& error) {
            why = error.what();
        }
        std::filesystem::remove(path);
        EXPECT_EQ(std::count(why.begin(), why.end(), '\n'), 0) << why;
        return why;
    };
    using testing::HasSubstr;
    EXPECT_THAT(whyOf(R"({"axle": 1, "trailingArm": {"inner": [0.4, 0.3, -0.8]}})"),
                HasSubstr(":3:28: /linkages/0/trailingArm/outer is missing"));
    EXPECT_THAT(whyOf(R"({"axle": 1, "trailingArm": {"inner": [0.4, 0.3, -0.8], "outer": [0.4, 0.3, -0.8]}})"),
                HasSubstr("/linkages/0/trailingArm/outer is (0.4, 0.3, -0.8) m, must be apart from inner"));
    EXPECT_THAT(whyOf(R"({"axle": 1, "trailingArm": {"inner": [0.4, 0.3, -1.2], "outer": [0.6, 0.3, -1.2]}})"),
                HasSubstr("/linkages/0/trailingArm/"));
}

}  // namespace
}  // namespace ragtop
