#include "ragtop/vehicle_file.h"

#include <gtest/gtest.h>

#include <filesystem>

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

}  // namespace
}  // namespace ragtop
