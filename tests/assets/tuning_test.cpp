#include "ragtop/tuning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "ragtop/scene_tuning.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

struct Wind {
    Vec3 velocity{};
    float gusts = 0.5f;
    std::optional<float> limit{};
    int layers = 3;
    bool on = true;
    std::vector<float> heights{1, 10};
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Wind*) {
    visit(Tunable{"velocity", "m/s", -100, 100, "of the air"}, self.velocity);
    visit(Tunable{"gusts", "1", 0, 1, "share that comes and goes"}, self.gusts);
    visit(Tunable{"limit", "m/s", 0, 200, "of gusts; absent: none"}, self.limit);
    visit(Tunable{"layers", "", 1, 10, "of the air"}, self.layers);
    visit(Tunable{"on", "", 0, 1, "does it blow?"}, self.on);
    visit(Tunable{"heights", "m", 0, 100, "of the layers"}, self.heights);
}

std::vector<std::string> pathsOf(const Scene& scene) {
    std::vector<std::string> paths;
    for (const TunableField& field : tunablesOf(scene)) paths.push_back(field.path);
    return paths;
}

TuneValue valueOf(const Scene& scene, const std::string& path) {
    for (const TunableField& field : tunablesOf(scene)) {
        if (field.path == path) return field.value;
    }
    ADD_FAILURE() << path;
    return {};
}

TEST(Tuning, AStructOfOnesOwnHasTunables) {
    Wind wind;
    std::vector<TunableRef> refs;
    addTunables(wind, "wind", "weather", refs);
    ASSERT_EQ(refs.size(), 7u);
    EXPECT_EQ(refs[0].field.path, "wind.velocity");
    EXPECT_EQ(refs[0].field.kind, TunableKind::vector);
    EXPECT_EQ(refs[1].field.unit, "1");
    EXPECT_EQ(refs[1].field.value, TuneValue(0.5));
    EXPECT_TRUE(refs[2].field.optional);
    EXPECT_EQ(refs[2].field.value, TuneValue());
    EXPECT_EQ(refs[6].field.path, "wind.heights.1");
    EXPECT_EQ(refs[6].field.group, "weather / heights");
    refs[0].set(DVec3(1, 2, 3));
    refs[2].set(12.5);
    refs[3].set(4.0);
    refs[4].set(false);
    refs[6].set(20.0);
    EXPECT_EQ(wind.velocity, (Vec3{1, 2, 3}));
    EXPECT_EQ(wind.limit, 12.5f);
    EXPECT_EQ(wind.layers, 4);
    EXPECT_FALSE(wind.on);
    EXPECT_EQ(wind.heights[1], 20);
    refs[2].set({});
    EXPECT_FALSE(wind.limit);
}

TEST(Tuning, ValuesAreCheckedAgainstKindAndRange) {
    Wind wind;
    std::vector<TunableRef> refs;
    addTunables(wind, "wind", "weather", refs);
    const auto why = [&](std::size_t i, const TuneValue& value) { return whyInvalid(refs[i].field, value); };
    EXPECT_EQ(why(1, 0.7), "");
    EXPECT_EQ(why(1, 1.5), "wind.gusts is 1.5, must be a number in [0, 1]");
    EXPECT_EQ(why(1, std::nan("")), "wind.gusts is nan, must be a number in [0, 1]");
    EXPECT_EQ(why(1, {}), "wind.gusts is null, must be a number in [0, 1]");
    EXPECT_EQ(why(2, {}), "");
    EXPECT_EQ(why(2, -1.0), "wind.limit is -1, must be a number in [0, 200] m/s or null");
    EXPECT_EQ(why(3, 2.5), "wind.layers is 2.5, must be an integer in [1, 10]");
    EXPECT_EQ(why(4, 1.0), "wind.on is 1, must be true or false");
    EXPECT_EQ(why(0, DVec3(0, 101, 0)), "wind.velocity is [0, 101, 0], must be three numbers in [-100, 100] m/s");
}

/// A number of a file, its float, and what a slider is told: one decimal.
TEST(Tuning, FloatsAreToldAsTheShortestDecimal) {
    for (const double decimal : {0.1, 0.35, 1e-4, 23700.0, 0.1366, 3.1416, 1e12}) {
        EXPECT_EQ(shortestDecimal(static_cast<float>(decimal)), decimal);
    }
}

TEST(SceneTuning, PathsNameWhatTheyBelongTo) {
    const auto paths = pathsOf(loadScene(findScene("crash")));
    for (const char* path :
         {"settings.gravity", "settings.substeps", "materials.brick.friction", "vehicles.car.chassis.mass",
          "vehicles.car.wheels.front left.suspension.stiffness", "vehicles.car.wheels.rear right.tire.lateralFriction",
          "vehicles.car.engine.torqueCurve.2.torque", "vehicles.car.gearbox.ratios.0",
          "vehicles.car.differential.type"}) {
        EXPECT_THAT(paths, Contains(path));
    }
    // Structure, and looks.
    EXPECT_THAT(paths, Not(Contains("vehicles.car.wheels.front left.axle")));
    EXPECT_THAT(paths, Not(Contains("vehicles.car.visual.scale")));
    EXPECT_EQ(std::set<std::string>(paths.begin(), paths.end()).size(), paths.size());
    const auto ofRain = pathsOf(loadScene(findScene("rain")));
    EXPECT_THAT(ofRain, Contains("ragdolls.person.joints.left forearm.limit.upper"));
    EXPECT_THAT(ofRain, Contains("ragdolls.person.parts.head.mass"));
}

TEST(SceneTuning, RagdollsOfOneEntryAreTunedTogether) {
    Scene scene = loadScene(findScene("rain"));
    const TunedParts parts = tune(scene, std::vector<TunedValue>{{"ragdolls.person.parts.head.mass", 7.0}});
    EXPECT_EQ(parts.ragdolls.size(), 100u);
    for (const SceneRagdoll& ragdoll : scene.ragdolls) {
        EXPECT_EQ(ragdoll.def, scene.ragdolls[0].def);
        EXPECT_EQ(ragdoll.def->parts[3].mass, 7);
    }
}

TEST(SceneTuning, AllOrNothing) {
    Scene scene = loadScene(findScene("crash"));
    const std::vector<TunedValue> values{{"vehicles.car.chassis.mass", 1000.0}, {"settings.substeps", 1000.0}};
    EXPECT_THROW(tune(scene, values), TuneError);
    EXPECT_EQ(valueOf(scene, "vehicles.car.chassis.mass"), TuneValue(1200.0));
    // Together they are fine, though each alone is not.
    const std::vector<TunedValue> both{{"vehicles.car.gearbox.shiftDownRpm", 6100.0},
                                       {"vehicles.car.gearbox.shiftUpRpm", 6200.0}};
    EXPECT_THROW(tune(scene, std::span(both).first(1)), TuneError);
    tune(scene, both);
    EXPECT_EQ(valueOf(scene, "vehicles.car.gearbox.shiftDownRpm"), TuneValue(6100.0));
}

TEST(SceneTuning, AMaterialReachesItsBodiesAlone) {
    Scene scene = loadScene(findScene("crash"));
    tune(scene, std::vector<TunedValue>{{"materials.brick.friction", 0.125}});
    for (const SceneBody& body : scene.bodies) {
        EXPECT_EQ(body.def.shapes[0].material.friction == 0.125f, body.material == "brick");
    }
}

TEST(SceneTuning, FilesTuneWhatTheyExtend) {
    const auto file = temporaryPath("tuned.json");
    const std::vector<TunedValue> values{{"settings.substeps", 6.0},
                                         {"vehicles.car.wheels.front left.suspension.stiffness", 30000.0},
                                         {"vehicles.car.gearbox.clutchTorque", 250.0},
                                         {"vehicles.car.differential.type", std::string("locked")},
                                         {"settings.gravity", DVec3(0, -3.5, 0)},
                                         {"settings.sleeping", false}};
    saveTuning(file, findScene("crash"), values);
    const Scene scene = loadScene(file), original = loadScene(findScene("crash"));
    for (const auto& [path, value] : values) EXPECT_EQ(valueOf(scene, path), value) << path;
    EXPECT_TRUE(sameStructure(scene, original));
    EXPECT_EQ(scene.description, original.description);
    EXPECT_EQ(tunablesOf(scene).size(), tunablesOf(original).size());
}

TEST(SceneTuning, ATuningMayBeTunedAgain) {
    const auto first = temporaryPath("first.json"), second = temporaryPath("second.json");
    saveTuning(first, findScene("track"), std::vector<TunedValue>{{"vehicles.car.chassis.mass", 900.0}});
    saveTuning(second, first, std::vector<TunedValue>{{"settings.substeps", 8.0}});
    const Scene scene = loadScene(second);
    EXPECT_EQ(valueOf(scene, "vehicles.car.chassis.mass"), TuneValue(900.0));
    EXPECT_EQ(valueOf(scene, "settings.substeps"), TuneValue(8.0));
}

/// A folder of scenes with a car that names its model, in which the test then is; left and removed at the end.
class SceneFolder {
public:
    SceneFolder() : before_(fs::current_path()), folder_(temporaryPath("scenes")) {
        fs::create_directories(folder_ / "scenes" / "parts");
        const fs::path cars = fs::path(RAGTOP_SOURCE_DIR) / "assets/data/vehicles";
        fs::copy(cars, folder_ / "vehicles");
        std::ofstream(folder_ / "scenes/own.json")
            << R"({"vehicles": [{"name": "car", "file": "parts/../../vehicles/hatchback.car.json"}]})";
        fs::create_directory_symlink(folder_ / "scenes/parts", folder_ / "link");
        fs::current_path(folder_);
    }
    ~SceneFolder() {
        fs::current_path(before_);
        fs::remove_all(folder_);
    }
    SceneFolder(const SceneFolder&) = delete;
    SceneFolder& operator=(const SceneFolder&) = delete;

private:
    fs::path before_, folder_;
};

/// However the scene and the tuning are spelled: relative, absolute, with "..", through a symbolic link.
TEST(SceneTuning, IsTheSameSceneHoweverItsPathIsSpelled) {
    const SceneFolder folder;
    const std::vector<TunedValue> values{{"vehicles.car.chassis.mass", 900.0}};
    const fs::path here = fs::current_path();
    for (const fs::path& scene :
         {fs::path("scenes/own.json"), fs::path("scenes/../scenes/own.json"), fs::path("./scenes/own.json"),
          fs::path("link/../own.json"), here / "scenes/own.json", here / "vehicles/../scenes/own.json"})
        for (const fs::path& file :
             {fs::path("mine.json"), fs::path("new/mine.json"), fs::path("new/../scenes/mine.json"),
              fs::path("link/mine.json"), here / "mine.json", here / "new/../mine.json", here / "a/b/c/d/mine.json"}) {
            SCOPED_TRACE(scene.string() + " saved as " + file.string());
            saveTuning(file, scene, values);
            const Scene original = loadScene(scene), tuned = loadScene(file);
            EXPECT_EQ(valueOf(tuned, values[0].first), values[0].second);
            EXPECT_TRUE(sameStructure(original, tuned));
            fs::remove(file);
        }
}

/// File systems take any bytes for a name, JSON does not: what was saved before stays.
TEST(SceneTuning, IsNotSavedByHalfWhereANameIsNoText) {
    const SceneFolder folder;
    const std::vector<TunedValue> values{{"vehicles.car.chassis.mass", 900.0}};
    saveTuning("mine.json", "scenes/own.json", values);
    fs::copy("scenes/own.json", "scenes/b\xe9.json");
    try {
        saveTuning("mine.json", "scenes/b\xe9.json", values);
        ADD_FAILURE() << "it is saved";
    } catch (const AssetError& error) {
        EXPECT_STREQ(error.what(), "mine.json: cannot be written, since a name in it is not UTF-8, as JSON is");
    }
    EXPECT_EQ(valueOf(loadScene("mine.json"), values[0].first), values[0].second);
}

TEST(SceneTuning, WrongValuesHaveAPlace) {
    const auto why = [](const std::string& entry) -> std::string {
        try {
            loadScene(fileWith("wrong.json", "{\n\"extends\": \"" + findScene("crash").string() +
                                                 "\",\n\"tuning\": {\n" + entry + "}}"));
        } catch (const AssetError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(why(R"("settings.substeps": 6)"), "");
    EXPECT_THAT(why(R"("settings.substeps": 600)"),
                HasSubstr(":4:22: /tuning/settings.substeps is not usable: "
                          "settings.substeps is 600, must be an integer in [1, 64]"));
    EXPECT_THAT(why(R"("settings.substep": 6)"), HasSubstr("did you mean \"settings.substeps\"?"));
    EXPECT_THAT(why(R"("settings.substeps": {})"), HasSubstr("must be a number, true or false"));
    EXPECT_THAT(why(R"("settings.gravity": [1, 2])"), HasSubstr("/tuning/settings.gravity"));
    EXPECT_THAT(why(R"("vehicles.car.engine.limiterRpm": 100)"), HasSubstr("must be above idleRpm"));
}

TEST(SceneTuning, StructureIsMoreThanValues) {
    const Scene crash = loadScene(findScene("crash"));
    Scene other = loadScene(findScene("crash"));
    EXPECT_TRUE(sameStructure(crash, other));
    other.settings.substeps = 9;
    other.vehicles[0].def.chassis.mass = 1000;
    EXPECT_TRUE(sameStructure(crash, other));
    const auto differs = [&](auto&& change) {
        Scene changed = crash;
        change(changed);
        return !sameStructure(crash, changed);
    };
    EXPECT_TRUE(differs([](Scene& s) { s.bodies.pop_back(); }));
    EXPECT_TRUE(differs([](Scene& s) { s.bodies[5].def.pose.position.x += 1; }));
    EXPECT_TRUE(differs([](Scene& s) { s.bodies[5].def.shapes[0].geometry = Sphere{}; }));
    EXPECT_TRUE(differs([](Scene& s) { s.vehicles[0].script[0].input.throttle = 0.5f; }));
    EXPECT_TRUE(differs([](Scene& s) { s.vehicles[0].placement.speed = 1; }));
    EXPECT_TRUE(differs([](Scene& s) { s.vehicles[0].def.wheels[0].axle = 1; }));
    EXPECT_TRUE(differs([](Scene& s) { s.vehicles[0].def.wheels.pop_back(); }));
    EXPECT_TRUE(differs([](Scene& s) { s.ragdolls[0].placement.position.y += 1; }));
    EXPECT_TRUE(differs([](Scene& s) { s.step = 0.01; }));
    EXPECT_FALSE(differs([](Scene& s) { s.description = "another text"; }));
}

TEST(SceneTuning, MaterialsOfIncludedScenesKeepApart) {
    fileWith("inner.json", R"({"materials": {"stone": {"friction": 0.3}},
        "bodies": [{"name": "inner", "type": "fixed", "material": "stone", "shape": {"sphere": {}}}]})");
    const auto inner = temporaryPath("inner.json");
    const auto outer = fileWith("outer.json", R"({"include": [")" + inner.filename().string() + R"("],
        "materials": {"stone": {"friction": 0.7}},
        "bodies": [{"name": "outer", "type": "fixed", "material": "stone", "shape": {"sphere": {}}}]})");
    Scene scene = loadScene(outer);
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.bodies[0].material, inner.stem().string() + "/stone");
    tune(scene, std::vector<TunedValue>{{"materials.stone.friction", 0.9}});
    EXPECT_EQ(scene.bodies[0].def.shapes[0].material.friction, 0.3f);
    EXPECT_EQ(scene.bodies[1].def.shapes[0].material.friction, 0.9f);
}

}  // namespace
}  // namespace ragtop
