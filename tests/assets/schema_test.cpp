#include "schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "described_file.h"
#include "ragtop/asset_error.h"
#include "ragtop/settings.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {
namespace {

using testing::HasSubstr;

template <class T>
T read(const std::string& text) {
    const JsonDocument document = JsonDocument::parse(text, "f.json");
    Faults faults(document);
    T value = readDocument<T>(document, faults);
    faults.throwIfAny();
    return value;
}

template <class T>
std::string complaintOf(const std::string& text) {
    try {
        read<T>(text);
    } catch (const AssetError& error) {
        return error.what();
    }
    return "";
}

TEST(Schema, GivesEveryNumberItsUnitRangeDefaultAndMeaning) {
    const Json schema = objectSchema(WorldSettings{});
    for (const auto& item : schema["properties"].items()) {
        EXPECT_TRUE(item.value().contains("meaning")) << item.key();
        EXPECT_TRUE(item.value().contains("default")) << item.key();
        if (item.value()["type"] == "number") {
            EXPECT_TRUE(item.value().contains("minimum") && item.value().contains("maximum")) << item.key();
            EXPECT_TRUE(item.value().contains("unit")) << item.key();
        }
    }
}

TEST(Schema, KeepsDefaultsOfAbsentFields) {
    const auto settings = read<WorldSettings>("{\"substeps\": 8}");
    EXPECT_EQ(settings.substeps, 8);
    EXPECT_EQ(settings.contactDamping, WorldSettings{}.contactDamping);
}

TEST(Schema, ReadsAndWritesASolverByItsName) {
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::iterative, SolverChoice::direct}) {
        const WorldSettings written{.solver = solver};
        EXPECT_EQ(read<WorldSettings>(writeValue(written).dump()).solver, solver);
    }
    EXPECT_EQ(read<WorldSettings>("{\"solver\": \"direct\"}").solver, SolverChoice::direct);
    EXPECT_EQ(complaintOf<WorldSettings>("{\"solver\": 2}"),
              "f.json:1:12: /solver is 2, must be one of \"automatic\", \"iterative\", \"direct\"");
}

TEST(Schema, NamesRangeAndUnitOfAWrongNumber) {
    EXPECT_EQ(complaintOf<WorldSettings>("{\n  \"sleepTime\": -1\n}"),
              "f.json:2:16: /sleepTime is -1, must be a number in [0, 1000] s");
    EXPECT_THAT(complaintOf<WorldSettings>("{\"substeps\": 2.5}"), HasSubstr("is 2.5, must be an integer in [1, 64]"));
    EXPECT_THAT(complaintOf<WorldSettings>("{\"sleeping\": 1}"), HasSubstr("must be a boolean"));
    EXPECT_THAT(complaintOf<WorldSettings>("{\"gravity\": [0, \"down\", 0]}"),
                HasSubstr("/gravity/1 is \"down\", must be a number in [-1000, 1000] m/s²"));
}

TEST(Schema, SuggestsTheNearestName) {
    EXPECT_THAT(complaintOf<WorldSettings>("{\"substep\": 3}"), HasSubstr("did you mean \"substeps\"?"));
    EXPECT_EQ(nearestName("colour", {"mass", "radius"}), "");
    EXPECT_EQ(nearestName("Radius", {"mass", "radius"}), "radius");
}

TEST(Schema, AppliesTheRangeOfALimitToItsEnds) {
    EXPECT_THAT(complaintOf<BallDef>("{\"twistLimit\": {\"lower\": -4, \"upper\": 1}}"),
                HasSubstr("/twistLimit/lower is -4, must be a number in [-3.1416, 3.1416] rad"));
    EXPECT_THAT(complaintOf<HingeDef>("{\"limit\": {\"lower\": 1}}"), HasSubstr("/limit/upper is missing"));
    EXPECT_THAT(complaintOf<HingeDef>("{\"limit\": {\"lower\": 1, \"upper\": 0}}"), HasSubstr("at most \"upper\""));
    EXPECT_FALSE(read<HingeDef>("{\"limit\": null}").limit.has_value());
}

TEST(Schema, ReadsRotationsAsQuaternionOrAxisAndAngle) {
    const auto turned = read<ChassisShape>(
        "{\"shape\": {\"sphere\": {}}, \"frame\": {\"rotation\": {\"axis\": [0, 2, 0], \"angle\": 1.5707964}}}");
    EXPECT_NEAR(turned.frame.rotation.y, std::sqrt(0.5), 1e-6);
    EXPECT_THAT(complaintOf<ChassisShape>("{\"shape\": {\"sphere\": {}}, \"frame\": {\"rotation\": [0, 0, 0, 0]}}"),
                HasSubstr("unit quaternion"));
}

TEST(Schema, WritesWhatReadsBackBitForBit) {
    VehicleDef car;
    car.name = "test \"car\"";
    car.chassis.shapes = {{Box{{0.1f, 1.0f / 3, 2e-4f}}, {{1e-3f, -0.7f, 3}, normalized(Quat{1, 2, 3, 4})}},
                          {Capsule{0.3f, 0.123456789f}, {}}};
    car.chassis.inertia = Vec3{1.1f, 2.2f, 3.3f};
    car.wheels = {{.name = "a", .position = {0.7f, 0.1f, 1.3f}}, {.radius = 0.31f}, {.driveShare = 0.1f}};
    car.differential.type = DifferentialType::limitedSlip;
    const Json json = writeValue(car);
    const auto back = read<VehicleDef>(json.dump());
    EXPECT_EQ(writeValue(back), json);
    EXPECT_EQ(back.chassis.shapes[0].frame, car.chassis.shapes[0].frame);
    EXPECT_EQ(std::get<Capsule>(back.chassis.shapes[1].shape).halfHeight, 0.123456789f);
    EXPECT_EQ(*back.chassis.inertia, *car.chassis.inertia);
    EXPECT_EQ(back.differential.type, DifferentialType::limitedSlip);
}

TEST(Schema, RoundTripsFloatsOfAllSizes) {
    std::uint32_t bits = 1;
    for (int i = 0; i < 20000; ++i) {
        bits = bits * 1664525u + 1013904223u;
        float value;
        static_assert(sizeof value == sizeof bits);
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) continue;
        EXPECT_EQ(Json::parse(writeNumber(value).dump()).get<float>(), value);
    }
}

}  // namespace
}  // namespace ragtop
