#include "ragtop/data_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "ragtop/asset_error.h"
#include "ragtop/scene.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

/// RAGTOP_DATA names a folder of the test's own while this lives.
class NamedFolder {
public:
    NamedFolder() { setenv("RAGTOP_DATA", path.c_str(), 1); }
    ~NamedFolder() {
        unsetenv("RAGTOP_DATA");
        fs::remove_all(path);
    }
    const fs::path path = temporaryPath("data");
};

TEST(DataFolder, IsWhatTheEnvironmentNames) {
    const NamedFolder data;
    fs::create_directories(data.path / "scenes");
    std::ofstream(data.path / "scenes/lone.json") << R"({"description": "one of its own"})";
    EXPECT_EQ(dataFolder(), data.path);
    EXPECT_THAT(shippedScenes(), testing::ElementsAre("lone"));
    EXPECT_EQ(sceneDescription(findScene("lone")), "one of its own");
}

TEST(DataFolder, ThatIsNamedAndHasNoScenesIsAnErrorThatSaysSo) {
    const NamedFolder data;
    EXPECT_THAT(shippedScenes(), testing::IsEmpty());
    for (const auto lookup : {+[] { dataFolder(); }, +[] { findScene("tower"); }}) {
        try {
            lookup();
            FAIL() << "found";
        } catch (const AssetError& error) {
            EXPECT_EQ(std::string(error.what()),
                      "RAGTOP_DATA is \"" + data.path.string() + "\", must be a folder with scenes in it");
        }
    }
}

TEST(DataFolder, HoldsTheShippedVehiclesAndRagdolls) {
    EXPECT_TRUE(fs::is_regular_file(dataFolder() / "vehicles/hatchback.car.json"));
    EXPECT_TRUE(fs::is_regular_file(dataFolder() / "ragdolls/mannequin.ragdoll.json"));
    EXPECT_EQ(findScene("tower"), dataFolder() / "scenes/tower.json");
}

}  // namespace
}  // namespace ragtop
