#include <gmock/gmock.h>

#include <sstream>
#include <vector>

#include "import_support.h"
#include "ragtop/ragdoll_file.h"
#include "ragtop/scene.h"
#include "ragtop/start_overlaps.h"
#include "ragtop/vehicle_file.h"
#include "ragtop/world.h"
#include "scene_play.h"

namespace ragtop {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// What a scene with these members is refused for, a line each.
std::vector<std::string> faultsOf(const std::string& members) {
    const TemporaryFile file("faults.json", "{\n" + members + "\n}");
    try {
        loadScene(file.path());
    } catch (const AssetError& error) {
        return linesOf(error.what());
    }
    return {};
}

/// What is told of where things begin.
std::vector<std::string> overlapsIn(const std::string& members) {
    const Scene scene = sceneOfMembers(members);
    return startOverlaps(scene);
}

TEST(SceneFaults, AreToldAllAtOnceInTheOrderOfTheFile) {
    EXPECT_THAT(faultsOf(R"("settings": {"gravty": [0, 0, 0], "substeps": 0},
"duration": "ten",
"bodies": [{"name": "a", "shape": {"sphere": {"radius": -0.5}}},
           {"name": "b", "shape": {"bix": {}}},
           {"name": "c"}])"),
                ElementsAre(AllOf(HasSubstr(":2:"), HasSubstr("/settings/gravty is unknown")),
                            AllOf(HasSubstr(":2:"), HasSubstr("/settings/substeps is 0")),
                            AllOf(HasSubstr(":3:"), HasSubstr("/duration is \"ten\"")),
                            AllOf(HasSubstr(":4:"), HasSubstr("/bodies/0/shape/sphere/radius is -0.5")),
                            AllOf(HasSubstr(":5:"), HasSubstr("/bodies/1/shape/bix is unknown")),
                            AllOf(HasSubstr(":6:"), HasSubstr("/bodies/2/shape is missing"))));
}

/// Numbers out of range, names of nothing and shapes that are none are found by different readers.
TEST(SceneFaults, OfDifferentKindsAreToldTogether) {
    EXPECT_THAT(
        faultsOf(R"("materials": {"ice": {"friction": 0.1}},
"bodies": [{"name": "a", "shape": {"sphere": {}}, "heading": 90},
           {"name": "b", "shape": {"sphere": {}}, "material": "icy"},
           {"name": "c", "shape": {"hull": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}},
           {"name": "d", "shape": {"sphere": {}}, "rotation": [0, 0, 0.5, 0.5]},
           {"name": "e", "shape": {"sphere": {}}}],
"joints": [{"a": "e", "b": "nobody", "anchor": [0, 0, 0], "ball": {}},
           {"a": "e", "anchor": [0, 0, 0], "axis": [0, 0, 0], "hinge": {}}],
"vehicles": [{"file": "no.car.json"}])"),
        ElementsAre(HasSubstr("/bodies/0/heading is 90, must be a number in [-6.2832, 6.2832] rad"),
                    HasSubstr("/bodies/1/material is \"icy\""), HasSubstr("/bodies/2/shape/hull makes no shape"),
                    HasSubstr("/bodies/3/rotation is [0,0,0.5,0.5] of length"), HasSubstr("/joints/0/b is \"nobody\""),
                    HasSubstr("/joints/1/axis is [0, 0, 0]"), HasSubstr("/vehicles/0/file is \"no.car.json\"")));
}

TEST(SceneFaults, OfOneThingAreToldTogether) {
    EXPECT_THAT(faultsOf(R"("bodies": [{"name": "a", "colour": "red", "color": "red", "material": "icy", "heading": 180,
            "rotation": [0, 0, 0, 0], "shape": {"compound": [{"shape": {"hull": [[0, 0, 0]]}}, {"shape": {"box": {"halfExtents": [0, 1, 1]}}}]}}],
"joints": [{"a": "x", "b": "y", "anchor": [0, 0], "axis": [0, 0, 0], "hinge": {"limit": {"lower": 1, "upper": 0}}, "ball": {}}],
"vehicles": [{"file": "no.car.json", "script": [{"time": 2}, {"time": 1, "throttle": 2}, {"time": 0}], "driver": {"road": "none"}}],
"ragdolls": [{"file": "no.ragdoll.json", "options": {}, "heading": -90}])"),
                ElementsAre(HasSubstr("/bodies/0/colour is unknown"), HasSubstr("/bodies/0/color is \"red\""),
                            HasSubstr("/bodies/0/material is \"icy\""), HasSubstr("/bodies/0/heading is 180"),
                            HasSubstr("/bodies/0/rotation is [0,0,0,0]"),
                            HasSubstr("/bodies/0/shape/compound/0/shape/hull makes no shape"),
                            HasSubstr("/bodies/0/shape/compound/1/shape/box/halfExtents/0 is 0"),
                            HasSubstr("/joints/0 has 2 kinds"), HasSubstr("/joints/0/a is \"x\""),
                            HasSubstr("/joints/0/b is \"y\""), HasSubstr("/joints/0/anchor is [0,0]"),
                            HasSubstr("/joints/0/axis is [0, 0, 0]"),
                            HasSubstr("/joints/0/hinge/limit/lower is 1, must be at most \"upper\", 0"),
                            HasSubstr("/vehicles/0/file is"), HasSubstr("/vehicles/0/script/1/throttle is 2"),
                            HasSubstr("/vehicles/0/driver goes without a \"script\""), HasSubstr("/ragdolls/0/file is"),
                            HasSubstr("/ragdolls/0/options goes with"), HasSubstr("/ragdolls/0/heading is -90")));
}

TEST(SceneFaults, OfPlacesAndAbsentValuesAreTold) {
    EXPECT_THAT(
        faultsOf(R"("bodies": [{"name": "a", "shape": null}, 5, {"shape": {}},
        {"shape": {"sphere": {}}, "rotation": {"axis": [0, 0, 0], "angle": 90}}],
        "animated": [{"body": "a", "keys": [{"time": 0, "position": [0, 0, 0]}]}])"),
        ElementsAre(HasSubstr("/bodies/0/shape is null, must be an object with one of"),
                    HasSubstr("/bodies/1 is 5, must be an object"), HasSubstr("/bodies/2/shape is {}"),
                    HasSubstr("/bodies/3/rotation/axis is [0, 0, 0]"), HasSubstr("/bodies/3/rotation/angle is 90"),
                    HasSubstr("/animated/0/keys is not usable: keys: 1 are given")));
}

TEST(SceneFaults, OfATuningAreToldWithOthersWhereItsThingsAreThere) {
    EXPECT_THAT(faultsOf(R"("step": -1,
"bodies": [{"name": "a", "shape": {"sphere": {}}}],
"joints": [{"name": "j", "a": "a", "anchor": [0, 0, 0], "hinge": {"limits": 1}}],
"tuning": {"settings.substeps": 5000, "joints.j.friction": -1, "setings.sleeping": true, "settings.gravity": "down"})"),
                ElementsAre(HasSubstr("/step is -1"), HasSubstr("/joints/0/hinge/limits is unknown"),
                            HasSubstr("/tuning/settings.substeps is not usable"),
                            HasSubstr("/tuning/setings.sleeping is not usable"),
                            HasSubstr("/tuning/settings.gravity is not usable")));
}

/// A joint with a body that is wrong itself has no fault of its own; a tuning may be right once the rest is.
TEST(SceneFaults, WithoutThoseThatFollow) {
    EXPECT_THAT(faultsOf(R"("bodies": [{"name": "a", "shape": {"sphere": {"radius": 0}}},
{"name": "b", "shape": {"sphere": {}}}],
"joints": [{"name": "j", "a": "a", "b": "b", "anchor": [0, 0, 0], "ball": {}}],
"couplings": [{"parts": [{"joint": "j"}]}],
"tuning": {"joints.j.friction": 1})"),
                ElementsAre(HasSubstr("/bodies/0/shape/sphere/radius is 0")));
    // A misspelled member is one mistake, whatever it was to say.
    EXPECT_THAT(faultsOf(R"("bodies": [{"nmae": "a", "shape": {"sphere": {}}}, {"name": "b", "shpe": {"sphere": {}}}],
"joints": [{"a": "a", "b": "b", "anchor": [0, 0, 0], "bal": {}}],
"ragdolls": [{"fle": "x.ragdoll.json"}])"),
                ElementsAre(HasSubstr("/bodies/0/nmae is unknown"), HasSubstr("/bodies/1/shpe is unknown"),
                            HasSubstr("/joints/0/bal is unknown"), HasSubstr("/ragdolls/0/fle is unknown")));
    EXPECT_THAT(faultsOf(R"("bodis": [{"name": "a", "shape": {"sphere": {}}}],
"joints": [{"a": "a", "anchor": [0, 0, 0], "ball": {}}], "tuning": {"joints.0.friction": 1})"),
                ElementsAre(HasSubstr("/bodis is unknown")));
}

TEST(SceneFaults, OfIncludedFilesAreToldToo) {
    const TemporaryFile inner("inner.json",
                              R"({"bodies": [{"shape": {"box": {"halfExtents": [1, 1]}}}, {"mass": 3}]})");
    EXPECT_THAT(
        faultsOf("\"include\": [\"" + inner.path().filename().string() + "\"], \"step\": 5"),
        ElementsAre(HasSubstr("/bodies/0/shape/box/halfExtents is [1,1]"), HasSubstr("/bodies/1/shape is missing"),
                    HasSubstr("/bodies/1/mass is unknown"), HasSubstr("/step is 5")));
    // Twice the same file has the same mistakes.
    EXPECT_THAT(faultsOf("\"include\": [\"" + inner.path().filename().string() + "\", \"" +
                         inner.path().filename().string() + "\"]"),
                SizeIs(3));
}

TEST(SceneFaults, OfMoreBodiesThanAreAllowedAreToldBeforeTheyAreMade) {
    const std::string ball = R"({"body": {"shape": {"sphere": {"radius": 1}}}, "count": )";
    EXPECT_THAT(faultsOf("\"repeat\": [" + ball + "[10000, 10000, 10000]}]"),
                ElementsAre(HasSubstr(":2:68: /repeat/0/count makes 1000000000000, at most 200000 are allowed")));
    EXPECT_THAT(faultsOf("\"repeat\": [" + ball + "[100, 100, 20]},\n" + ball + "[1, 1, 1]},\n" + ball + "[1, 1, 1]}]"),
                ElementsAre(HasSubstr(":3:1: /repeat/1 brings the scene to 200001 bodies, ragdolls and robots, at most "
                                      "200000 are allowed")));
}

TEST(SceneFaults, ThatAreManyAreCounted) {
    std::string bodies;
    for (int i = 0; i < 50; ++i) bodies += (i ? ",\n" : "") + std::string(R"({"shape": {"sphere": {"radius": 0}}})");
    const auto lines = faultsOf("\"bodies\": [" + bodies + "]");
    ASSERT_EQ(lines.size(), 21u);
    EXPECT_EQ(lines.back(), "and 30 more");
}

TEST(SceneFaults, OfAVehicleAreToldAllAtOnce) {
    const TemporaryFile file("faults.car.json", R"({"chassis": {"mass": -5, "shapes": []}, "wheels": 3, "engin": {}})");
    try {
        loadVehicle(file.path());
        FAIL();
    } catch (const AssetError& error) {
        EXPECT_THAT(linesOf(error.what()), ElementsAre(HasSubstr("/chassis/mass is -5"), HasSubstr("/wheels is 3"),
                                                       HasSubstr("/engin is unknown")));
    }
}

TEST(SceneFaults, OfARagdollAreToldAllAtOnce) {
    const TemporaryFile file("faults.ragdoll.json", R"({
"bones": [{"name": "hip", "part": "hips"}, {"name": "knee", "parent": "hop", "part": "leg"}],
"parts": [{"name": "hips", "bone": "hip", "mass": 0, "shape": {"sphere": {}}},
          {"name": "leg", "bone": "ankle", "mass": 5, "shape": {"sphere": {}}}],
"joints": [{"parent": "hips", "child": "leg", "frameA": {"rotation": [1, 1, 1, 1]}, "hinge": {"limit": {"lower": -90, "upper": 5}}}]})");
    try {
        loadRagdoll(file.path());
        FAIL();
    } catch (const AssetError& error) {
        EXPECT_THAT(linesOf(error.what()),
                    ElementsAre(HasSubstr("/bones/1/parent is \"hop\""), HasSubstr("/parts/0/mass is 0"),
                                HasSubstr("/parts/1/bone is \"ankle\""), HasSubstr("/joints/0 turns more than once"),
                                HasSubstr("/joints/0/frameA/rotation is")));
    }
}

TEST(Scene, RefusesANameOfTwoWhereOneIsMeant) {
    const std::string two = R"("bodies": [{"name": "box", "shape": {"sphere": {}}},
{"name": "box", "position": [3, 0, 0], "shape": {"sphere": {}}}])";
    EXPECT_THAT(faultsOf(two), IsEmpty());
    EXPECT_THAT(
        faultsOf(two + R"(,
"joints": [{"a": "box", "anchor": [0, 0, 0], "ball": {}}])"),
        ElementsAre(AllOf(HasSubstr(":4:"), HasSubstr("/joints/0/a is \"box\", must be the name of one thing alone; "
                                                      "it is that of 2 of the named bodies"))));
    EXPECT_THAT(faultsOf(R"("bodies": [{"name": "a", "shape": {"sphere": {}}}, {"name": "b", "shape": {"sphere": {}}}],
"joints": [{"name": "j", "a": "a", "anchor": [0, 0, 0], "ball": {}}, {"name": "j", "a": "b", "anchor": [0, 0, 0], "ball": {}}],
"couplings": [{"parts": [{"joint": "j"}]}])"),
                ElementsAre(HasSubstr("/couplings/0/parts/0/joint is \"j\", must be the name of one thing alone")));
}

TEST(Scene, TakesNoDegreesForRadians) {
    EXPECT_THAT(faultsOf(R"("vehicles": [{"file": "x.car.json", "heading": 90}])"),
                ElementsAre(HasSubstr("/vehicles/0/file is"),
                            HasSubstr("/vehicles/0/heading is 90, must be a number in [-6.2832, 6.2832] rad")));
    EXPECT_THAT(faultsOf(R"("bodies": [{"shape": {"sphere": {}}, "rotation": {"axis": [0, 1, 0], "angle": -45}}])"),
                ElementsAre(HasSubstr("/bodies/0/rotation/angle is -45, must be a number in [-6.2832, 6.2832] rad")));
    EXPECT_THAT(faultsOf(R"("bodies": [{"shape": {"sphere": {}}, "heading": -6.2832}])"), IsEmpty());
    // Doors do not wind, winches do.
    const std::string door = R"("bodies": [{"name": "a", "shape": {"sphere": {}}}],
"joints": [{"name": "j", "a": "a", "anchor": [0, 0, 0], "hinge": {"limit": {"lower": -1.5, "upper": )";
    EXPECT_THAT(sceneOfMembers(door + "90}}}]").warnings,
                ElementsAre(HasSubstr("joint \"j\" may turn more than once round")));
    EXPECT_THAT(sceneOfMembers(door + "1.5}}}]").warnings, IsEmpty());
}

const std::string kGround =
    R"("bodies": [{"name": "ground", "type": "fixed", "position": [0, -1, 0], "shape": {"box": {"halfExtents": [50, 1, 50]}}})";

TEST(StartOverlaps, AreToldWithTheBodiesAndTheDepth) {
    EXPECT_THAT(overlapsIn(kGround + R"(, {"name": "crate", "position": [0, 0.2, 0], "shape": {"box": {}}}])"),
                ElementsAre("body \"crate\" begins about 0.3 m inside of body \"ground\""));
    EXPECT_THAT(overlapsIn(kGround + R"(, {"name": "ball", "position": [0, 0.4, 0], "shape": {"sphere": {}}}])"),
                ElementsAre("body \"ball\" begins about 0.1 m inside of body \"ground\""));
    EXPECT_THAT(overlapsIn(kGround + R"(, {"position": [0, -0.9, 0], "shape": {"capsule": {}}}])"),
                ElementsAre(AllOf(HasSubstr("body 1 begins"), HasSubstr("inside of body \"ground\""))));
    EXPECT_THAT(overlapsIn(kGround + R"(, {"position": [0, 0.2, 0],
        "shape": {"hull": [[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [0, -0.5, 0.5], [0, 0.5, 0]]}}])"),
                ElementsAre(HasSubstr("body 1 begins")));
}

TEST(StartOverlaps, OfEqualThingsAreOneLineAndOfManyTheDeepest) {
    EXPECT_THAT(
        overlapsIn(kGround + R"(], "repeat": [{"body": {"name": "crate", "position": [0, 0.4, 0], "shape": {"box": {}}},
        "count": [3, 1, 3], "spacing": [2, 1, 2]}])"),
        ElementsAre("body \"crate\" begins about 0.1 m inside of body \"ground\" (9 times)"));
    std::string bodies;
    for (int i = 0; i < 7; ++i)
        bodies += ", {\"position\": [" + std::to_string(2 * i) + ", 0." + std::to_string(i) +
                  R"(, 0], "shape": {"box": {}}})";
    EXPECT_THAT(overlapsIn(kGround + bodies + "]"), ElementsAre("body 1 begins about 0.5 m inside of body \"ground\"",
                                                                "body 2 begins about 0.4 m inside of body \"ground\"",
                                                                "body 3 begins about 0.3 m inside of body \"ground\"",
                                                                "body 4 begins about 0.2 m inside of body \"ground\"",
                                                                "body 5 begins about 0.1 m inside of body \"ground\""));
}

TEST(StartOverlaps, OfThingsThatMoveAreTold) {
    EXPECT_THAT(overlapsIn(R"("bodies": [{"name": "a", "shape": {"box": {}}},
        {"name": "b", "position": [0.7, 0, 0], "shape": {"box": {}}}])"),
                ElementsAre("body \"b\" begins about 0.3 m inside of body \"a\""));
}

TEST(StartOverlaps, KnowPartsMeshesAndWhatIsDeepDown) {
    EXPECT_THAT(overlapsIn(kGround + R"(, {"name": "deep", "position": [0, -0.9, 0], "shape": {"box": {}}}])"),
                ElementsAre("body \"deep\" begins about 1.4 m inside of body \"ground\""));
    EXPECT_THAT(overlapsIn(kGround + R"(, {"name": "table", "position": [0, 0.2, 0], "shape": {"compound": [
        {"shape": {"box": {"halfExtents": [1, 0.1, 1]}}},
        {"shape": {"capsule": {"radius": 0.1, "halfHeight": 0.15}}, "frame": {"position": [0, -0.15, 0]}}]}}])"),
                ElementsAre("body \"table\" begins about 0.2 m inside of body \"ground\""));
    // A tetrahedron around the ball, as a mesh.
    const std::string rock = R"("bodies": [{"name": "rock", "type": "fixed", "shape": {"mesh": {
        "vertices": [[-9, -3, -9], [9, -3, -9], [0, -3, 9], [0, 9, 0]], "triangles": [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]}}})";
    EXPECT_THAT(overlapsIn(rock + R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.2}}}])"),
                ElementsAre("body \"ball\" begins about 3 m inside of body \"rock\""));
    EXPECT_THAT(
        overlapsIn(rock + R"(, {"name": "ball", "position": [0, -5, 0], "shape": {"sphere": {"radius": 0.2}}}])"),
        IsEmpty());
}

/// A twentieth of the half height is rounding; touching, sensors, filters and joints are meant.
TEST(StartOverlaps, AreNoneWhereBodiesLieOrPassOrAreJoined) {
    EXPECT_THAT(overlapsIn(kGround + R"(, {"position": [0, 0.5, 0], "shape": {"box": {}}},
        {"position": [3, 0.48, 0], "shape": {"box": {}}}, {"position": [6, 0.48, 0], "shape": {"sphere": {}}}])"),
                IsEmpty());
    EXPECT_THAT(
        overlapsIn(kGround + R"(, {"position": [0, 0, 0], "type": "kinematic", "shape": {"box": {}}, "sensor": true},
        {"position": [3, 0, 0], "shape": {"box": {}}, "filter": {"mask": 2}},
        {"name": "post", "position": [6, 0, 0], "shape": {"box": {}}}],
        "joints": [{"a": "ground", "b": "post", "anchor": [6, 0, 0], "hinge": {}}])"),
        IsEmpty());
}

TEST(StartOverlaps, KnowSurfacesWithoutVolume) {
    const std::string field = R"("bodies": [{"name": "hill", "type": "fixed", "position": [-10, 0, -10],
        "shape": {"heightField": {"spacing": 10, "heights": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]}}})";
    EXPECT_THAT(overlapsIn(field + R"(, {"name": "ball", "position": [1, 0.1, 2], "shape": {"sphere": {}}}])"),
                ElementsAre(HasSubstr("\"ball\" begins about 0.4 m inside of body \"hill\"")));
    EXPECT_THAT(overlapsIn(field + R"(, {"name": "ball", "position": [1, -3, 2], "shape": {"sphere": {}}}])"),
                ElementsAre(HasSubstr("\"ball\" begins about 3 m inside of body \"hill\"")));
    EXPECT_THAT(overlapsIn(field + R"(, {"name": "ball", "position": [1, 0.5, 2], "shape": {"sphere": {}}}])"),
                IsEmpty());
}

/// A sheet of triangles is a roof over what has a floor, and the ground over what has none.
TEST(StartOverlaps, KnowRoofsFromGround) {
    const std::string sheet = R"({"name": "sheet", "type": "fixed", "position": [0, 5, 0], "shape": {"mesh": {
        "vertices": [[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]], "triangles": [[0, 2, 1], [0, 3, 2]]}}},
        {"name": "ball", "position": [0, 1, 0], "shape": {"sphere": {}}}])";
    EXPECT_THAT(overlapsIn(kGround + ", " + sheet), IsEmpty());
    EXPECT_THAT(
        overlapsIn(kGround + R"(, {"name": "stuck", "position": [3, 4.8, 0], "shape": {"sphere": {}}}, )" + sheet),
        ElementsAre("body \"stuck\" begins about 0.2 m inside of body \"sheet\""));
    EXPECT_THAT(overlapsIn("\"bodies\": [" + sheet),
                ElementsAre("body \"ball\" begins about 4 m inside of body \"sheet\""));
}

TEST(StartOverlaps, OfCarsCountTheirWheels) {
    const std::string car = std::string(R"(], "vehicles": [{"name": "car", "file": ")") + RAGTOP_SOURCE_DIR +
                            "/assets/data/vehicles/hatchback.car.json\", \"position\": [0, ";
    EXPECT_THAT(overlapsIn(kGround + car + "0, 0]}]"), IsEmpty());
    // Below the bump stops, with the bodywork still above the ground.
    EXPECT_THAT(overlapsIn(kGround + car + "-0.14, 0]}]"),
                ElementsAre(AllOf(HasSubstr("vehicle \"car\" begins"), HasSubstr("inside of body \"ground\""))));
}

TEST(StartOverlaps, AreNoneInTheShippedScenes) {
    for (const std::string& name : shippedScenes()) {
        const Scene scene = loadScene(findScene(name));
        EXPECT_THAT(startOverlaps(scene), IsEmpty()) << name;
        // What comes along is sound; of somebody else's models there is something to be told, or they are not there.
        const auto ofOthers = [](const std::string& warning) {
            return warning.find("samples:") != std::string::npos || warning.find("testmodels:") != std::string::npos;
        };
        std::vector<std::string> warnings = scene.warnings;
        std::erase_if(warnings, ofOthers);
        EXPECT_THAT(warnings, IsEmpty()) << name;
    }
}

}  // namespace
}  // namespace ragtop
