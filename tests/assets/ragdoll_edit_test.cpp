#include <sstream>

#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/ragdoll_file.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

const RagdollPart& part(const RagdollDef& def, BodyRole role) {
    for (const RagdollPart& each : def.parts)
        if (each.role == role) return each;
    throw std::out_of_range("role");
}

RagdollDef fitted(double mass) {
    const fs::path rig = fs::path(RAGTOP_SOURCE_DIR) / "tests" / "data" / "rigs" / "human.gltf";
    return makeRagdoll(loadCharacter(rig), {.bodyMass = static_cast<float>(mass)});
}

class EditedRagdoll : public testing::Test {
protected:
    void SetUp() override {
        folder = temporaryPath("edited");
        fs::create_directories(folder);
        path = folder / "hero.ragdoll.json";
    }
    void TearDown() override { fs::remove_all(folder); }
    void edit(const std::string& text) const { std::ofstream(path) << text; }

    fs::path folder, path;
};

TEST_F(EditedRagdoll, BeginsAsItWasFitted) {
    const RagdollDef first = fitted(70), read = saveEditableRagdoll(first, path);
    ASSERT_EQ(read.parts.size(), first.parts.size());
    for (std::size_t i = 0; i < first.parts.size(); ++i) EXPECT_EQ(read.parts[i].mass, first.parts[i].mass);
}

TEST_F(EditedRagdoll, ChangesSurviveANewImport) {
    const RagdollDef first = saveEditableRagdoll(fitted(70), path);
    const std::string head = part(first, BodyRole::head).name;
    edit("{\"extends\": \"hero.fitted.ragdoll.json\", \"parts\": {\"" + head + "\": {\"mass\": 6.5}}}");
    const RagdollDef second = saveEditableRagdoll(fitted(90), path);
    EXPECT_FLOAT_EQ(part(second, BodyRole::head).mass, 6.5f);
    EXPECT_NEAR(part(second, BodyRole::chest).mass, part(first, BodyRole::chest).mass * 90 / 70, 0.2f);
    EXPECT_EQ(second.joints.size(), first.joints.size());
}

TEST_F(EditedRagdoll, ChangesOfWhatIsNoMoreAreTold) {
    saveEditableRagdoll(fitted(70), path);
    edit("{\"extends\": \"hero.fitted.ragdoll.json\",\n \"parts\": {\"third arm\": {\"mass\": 6.5}}}");
    const std::string text = importError(path, [&] { saveEditableRagdoll(fitted(70), path); });
    EXPECT_NE(text.find(":2:25: /parts/third arm is no element of the list, must be one of"), std::string::npos)
        << text;
}

TEST_F(EditedRagdoll, NeedsItsEnding) {
    const fs::path wrong = folder / "hero.json";
    EXPECT_NE(importError(wrong, [&] { saveEditableRagdoll(fitted(70), wrong); }).find("must end with .ragdoll.json"),
              std::string::npos);
}

}  // namespace
}  // namespace ragtop
