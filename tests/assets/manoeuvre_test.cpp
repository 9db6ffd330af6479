#include "ragtop/manoeuvre.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "ragtop/data_folder.h"
#include "ragtop/vehicle_file.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

VehicleDef hatchbackFile() { return loadVehicle(dataFolder() / "vehicles" / "hatchback.car.json"); }

/// What a file of this text is refused with; empty where it is not.
std::string refusal(const std::string& text) {
    const auto path = temporaryPath("manoeuvre.json");
    std::ofstream(path) << text;
    std::string what;
    try {
        loadManoeuvre(path);
    } catch (const AssetError& error) {
        what = error.what();
    }
    std::filesystem::remove(path);
    return what;
}

TEST(Manoeuvre, ShippedOnesAreReadAndNamedAsTheirFiles) {
    const auto names = shippedManoeuvres();
    EXPECT_GE(names.size(), 17u);
    for (const std::string& name : names) EXPECT_EQ(loadManoeuvre(findManoeuvre(name)).name, name);
    EXPECT_THROW(findManoeuvre("no such"), AssetError);
}

TEST(Manoeuvre, BadFilesGetALineThatNamesPlaceAndValue) {
    const std::string measure = R"("measure": [{"name": "v", "channel": "speed"}])";
    const struct {
        std::string text, part;
    } cases[] = {
        {"{}", "measure"},
        {"{\"duration\": -1, " + measure + "}", "/duration is -1"},
        {"{\"durations\": 1, " + measure + "}", "durations"},
        {R"({"measure": []})", "/measure is empty"},
        {R"({"measure": [{"name": "v", "channel": "sped"}]})", "/measure/0/channel"},
        {R"({"measure": [{"name": "v", "channel": "speed", "from": 3, "to": 2}]})", "/measure/0"},
        {R"({"measure": [{"name": "v", "channel": "wheelAngle", "law": "bicycleSteer"}]})", "/measure/0/law"},
        {"{\"input\": [{\"time\": 1}, {\"time\": 1}], " + measure + "}", "/input/1/time"},
        {"{\"ground\": {\"kerb\": {\"height\": 5}}, " + measure + "}", "/ground/kerb/height is 5"},
        {"{\"ground\": {\"rubble\": {\"mass\": 0}}, " + measure + "}", "/ground/rubble/mass is 0"},
        {"{\"ground\": {\"tiles\": 0}, " + measure + "}", "/ground/tiles is 0"},
        {"{\"cruise\": {\"line\": [[0, 0, 0]]}, " + measure + "}", "/cruise/line has 1 point"},
        {"{\"cruise\": {\"radius\": 9, \"line\": [[0, 0, 0], [0, 0, 9]]}, " + measure + "}", "/cruise/line is there"},
        {R"({"measure": [{"name": "v", "channel": "laps"}]})", "/measure/0/channel is of a line"},
        {R"({"measure": [{"name": "v", "channel": "hitchForce"}]})", "/measure/0 is of a trailer"},
        {R"({"trailer": {"mass": 0}, "measure": [{"name": "v", "channel": "hitchForce"}]})", "/trailer/mass is 0"},
        {R"({"trailer": {}, "measure": [{"name": "v", "channel": "speed", "law": "hitchSwing"}]})",
         "/measure/0/law is hitchSwing"},
        {"{\"start\": ", ":"},
    };
    for (const auto& wrong : cases) {
        const std::string what = refusal(wrong.text);
        EXPECT_NE(what.find(wrong.part), std::string::npos) << wrong.text << "\n" << what;
        EXPECT_NE(what.find("manoeuvre.json"), std::string::npos) << what;
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
}

/// Level ground, no driver: speed 0, and nothing that is measured wrongly passes.
TEST(Manoeuvre, MeasuresFailBeyondTheirLimitsAndWhereThereIsNoValue) {
    Manoeuvre still;
    still.duration = 1;
    still.input = {{.time = 0, .brake = 1}};
    still.measure = {{.name = "in", .greatest = 1e-3f},
                     {.name = "out", .least = 1},
                     {.name = "near", .channel = TrackChannel::load, .reference = 1200 * 9.81f},
                     {.name = "never", .take = TrackTake::timeAbove, .level = 5}};
    const TrackRun run = drive(still, hatchbackFile());
    ASSERT_EQ(run.values.size(), 4u);
    EXPECT_TRUE(run.values[0].pass);
    EXPECT_FALSE(run.values[1].pass);
    EXPECT_TRUE(run.values[2].pass) << run.values[2].value;
    EXPECT_NEAR(*run.values[2].error, 0, 0.01);
    EXPECT_FALSE(run.values[3].pass);
    EXPECT_TRUE(std::isnan(run.values[3].value));
    EXPECT_EQ(run.samples.size(), 61u);
    EXPECT_THROW(drive(still, hatchbackFile(), {.hz = 0}), std::invalid_argument);
}

/// What hangs on the hitch is its mass times its acceleration, and how it swings is its linear model's but for the roll
/// that this does not have, whatever the trailer and the step.
TEST(Manoeuvre, TowsAnyTrailerAsItsLawsSay) {
    const VehicleDef car = hatchbackFile();
    Manoeuvre tow = loadManoeuvre(findManoeuvre("tow"));
    for (const float mass : {300.0f, 700.0f, 1400.0f}) {
        tow.trailer->mass = mass;
        for (const float hz : {30.0f, 60.0f, 120.0f})
            for (const TrackValue& value : drive(tow, car, {.hz = hz}).values)
                EXPECT_TRUE(value.pass) << value.name << " is " << value.value << ", " << mass << " kg, " << hz
                                        << " Hz";
    }
}

/// The laws are those of all of the car, not of what its carriers leave of it.
TEST(Manoeuvre, LawsOfACarOnCarriersAreThoseOnStruts) {
    const VehicleDef car = loadVehicle(dataFolder() / "vehicles" / "hatchback_linkages.car.json");
    for (const char* name : {"brake", "step-steer", "tow"}) {
        const Manoeuvre manoeuvre = loadManoeuvre(findManoeuvre(name));
        const TrackRun struts = drive(manoeuvre, car, {.level = VehicleLevel::full});
        const TrackRun carriers = drive(manoeuvre, car, {.level = VehicleLevel::linkages});
        ASSERT_EQ(struts.values.size(), carriers.values.size());
        for (std::size_t i = 0; i < struts.values.size(); ++i) {
            const TrackValue &one = struts.values[i], &other = carriers.values[i];
            EXPECT_TRUE(other.pass) << name << ", " << other.name << " is " << other.value;
            ASSERT_EQ(one.reference.has_value(), other.reference.has_value());
            if (!one.reference) continue;
            EXPECT_NEAR(*other.reference, *one.reference, 2e-3 * std::abs(*one.reference)) << one.name;
        }
    }
}

TEST(Manoeuvre, TheHatchbackPassesWhatItsLevelModels) {
    const VehicleDef car = hatchbackFile();
    for (const VehicleLevel level : {VehicleLevel::bicycle, VehicleLevel::rays})
        for (const std::string& name : shippedManoeuvres()) {
            const Manoeuvre manoeuvre = loadManoeuvre(findManoeuvre(name));
            if (level < manoeuvre.leastLevel) {
                EXPECT_THROW(drive(manoeuvre, car, {.level = level}), std::invalid_argument) << name;
                continue;
            }
            for (const TrackValue& value : drive(manoeuvre, car, {.level = level}).values)
                EXPECT_TRUE(value.pass) << name << ", " << value.name << " is " << value.value << " at level "
                                        << static_cast<int>(level);
        }
}

TEST(Manoeuvre, TheHatchbackPassesTheShippedOnes) {
    for (const std::string& name : shippedManoeuvres()) {
        const TrackRun run = drive(loadManoeuvre(findManoeuvre(name)), hatchbackFile());
        for (const TrackValue& value : run.values)
            EXPECT_TRUE(value.pass) << name << ": " << value.name << " " << value.value;
    }
}

/// Wheels that are bodies take from the springs what throws them down, and lie still with their car.
TEST(Manoeuvre, ACarOnCarriersFallsAndLiesAsTheyAsk) {
    const VehicleDef car = loadVehicle(dataFolder() / "vehicles" / "hatchback_linkages.car.json");
    for (const char* name : {"drop", "side"})
        for (const float hz : {30.0f, 36.0f, 45.0f, 50.0f, 55.0f, 58.0f, 60.0f, 65.0f, 75.0f, 90.0f, 100.0f, 110.0f,
                               120.0f, 144.0f, 240.0f})
            for (const TrackValue& value :
                 drive(loadManoeuvre(findManoeuvre(name)), car, {.hz = hz, .level = VehicleLevel::linkages}).values)
                EXPECT_TRUE(value.pass) << name << ": " << value.name << " " << value.value << " at " << hz << " Hz";
}

}  // namespace
}  // namespace ragtop
