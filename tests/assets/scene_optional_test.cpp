#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "ragtop/find_asset.h"
#include "ragtop/world.h"
#include "scene_play.h"

namespace ragtop {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string dog(const std::string& name, const std::string& file, const std::string& members = "") {
    return R"({"name": ")" + name + R"(", "file": ")" + file + R"(", "position": [0, 3, 0])" + members + "}";
}

const std::string kDog = RAGTOP_SOURCE_DIR "/assets/data/robots/dog.xml";

/// The folder of samples while this lives.
class NamedSamples {
public:
    NamedSamples() {
        std::filesystem::create_directories(path);
        setenv("RAGTOP_SAMPLES", path.c_str(), 1);
    }
    ~NamedSamples() {
        unsetenv("RAGTOP_SAMPLES");
        std::filesystem::remove_all(path);
    }
    const std::filesystem::path path = temporaryPath("samples");
};

TEST(OptionalEntries, AreLeftOutWithAWarningWhereTheirFileIsNotThere) {
    const NamedSamples samples;
    const Scene scene = sceneOfMembers(
        R"("robots": [)" + dog("here", kDog) + ", " + dog("gone", "samples:gone.xml", R"(, "optional": true)") +
        R"(], "ragdolls": [{"name": "nobody", "character": "no_such.fbx", "puppet": true, "optional": true},
                           {"file": "no_such.ragdoll.json", "optional": true}])");
    ASSERT_EQ(scene.robots.size(), 1u);
    EXPECT_EQ(scene.robots[0].name, "here");
    EXPECT_THAT(scene.ragdolls, IsEmpty());
    EXPECT_THAT(
        scene.warnings,
        ElementsAre(AllOf(HasSubstr("left out, since it is optional: "), HasSubstr("no_such.fbx: no such file")),
                    HasSubstr("no_such.ragdoll.json: no such file"),
                    AllOf(HasSubstr("samples:gone.xml: no such file in " + samples.path.string()),
                          HasSubstr("RAGTOP_SAMPLES"))));
    for (const std::string& warning : scene.warnings) EXPECT_EQ(warning.find('\n'), std::string::npos);
}

TEST(OptionalEntries, ThatAreThereAreAsOthers) {
    const NamedSamples samples;
    std::filesystem::copy(kDog, samples.path / "dog.xml");
    const Scene scene =
        sceneOfMembers(R"("robots": [)" + dog("here", "samples:dog.xml", R"(, "optional": true)") + "]");
    ASSERT_EQ(scene.robots.size(), 1u);
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_EQ(findAsset("samples:dog.xml"), samples.path / "dog.xml");
}

/// What holds on to them is left out too, in silence: joints, couplings, points of cloths, and tuning.
TEST(OptionalEntries, TakeAlongWhatRefersToThem) {
    const std::string others =
        R"(, "joints": [{"name": "leash", "a": "gone/trunk", "anchor": [0, 3, 0], "ball": {}},
                        {"name": "other", "a": "here/trunk", "anchor": [0, 3, 0], "ball": {}},
                        {"name": "of a grid", "a": "many 2/trunk", "anchor": [0, 3, 0], "ball": {}}],
           "cloths": [{"name": "flag", "sheet": {"columns": 3, "rows": 3, "across": [1, 0, 0], "down": [0, -1, 0]},
                       "holds": [{"to": "gone/trunk", "row": 0}]}],
           "tuning": {"robots.gone.place.position": [0, 9, 0], "settings.substeps": 6})";
    const auto members = [&](const char* optional) {
        return R"("robots": [)" + dog("here", kDog) + ", " + dog("gone", "gone.xml", optional) + ", " +
               dog("many", "gone.xml", std::string(optional) + R"(, "count": [2, 1, 1], "spacing": [2, 1, 1])") + "]" +
               others;
    };
    const Scene scene = sceneOfMembers(members(R"(, "optional": true)"));
    ASSERT_EQ(scene.joints.size(), 1u);
    EXPECT_EQ(scene.joints[0].name, "other");
    EXPECT_THAT(scene.cloths, IsEmpty());
    EXPECT_EQ(scene.settings.substeps, 6);
    ScenePlay play(scene);
    play.until(0.1);
    EXPECT_THAT(faultOfMembers(members("")), HasSubstr("gone.xml"));
}

TEST(OptionalEntries, WithAFileThatIsBrokenAreErrors) {
    const TemporaryFile broken("broken_dog.xml", "<mujoco><worldbody><body></worldbody></mujoco>");
    EXPECT_THAT(faultOfMembers(R"("robots": [)" + dog("dog", broken.path().string(), R"(, "optional": true)") + "]"),
                HasSubstr("must name a usable file"));
    EXPECT_THAT(faultOfMembers(R"("robots": [{"name": "dog", "file": 7, "optional": true}])"),
                HasSubstr("is 7, must be"));
    EXPECT_THAT(faultOfMembers(R"("ragdolls": [{"name": "dog", "optional": true}])"),
                HasSubstr("must have either a \"file\" or a \"character\""));
}

}  // namespace
}  // namespace ragtop
