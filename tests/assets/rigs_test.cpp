#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "import_support.h"
#include "json_document.h"
#include "ragtop/character.h"
#include "role_names.h"

namespace ragtop {
namespace {

std::filesystem::path rigFile(const std::string& name) {
    return std::filesystem::path(RAGTOP_SOURCE_DIR) / "tests" / "data" / "rigs" / name;
}

/// What scripts/make_rigs.py says about the rigs it writes.
const Json& expectations() {
    static const Json all = Json::parse(std::ifstream(rigFile("expected.json")));
    return all;
}

Vec3 placeOf(const Json& bone) {
    const auto& place = bone.at("place");
    return {place[0].get<float>(), place[1].get<float>(), place[2].get<float>()};
}

std::string shown(BodyRole role, BodySide side) {
    return std::string(nameOf(side)) + " " + enumNames(role)[static_cast<std::size_t>(role)];
}

class Rigs : public testing::TestWithParam<std::string> {
protected:
    const Json& expected() const { return expectations().at(GetParam()); }
    /// A motion without a skin has its unit guessed from the height, to what a body is likely to have.
    bool skinned() const { return !expected().contains("guessed"); }
};

std::vector<std::string> rigNames(bool refused) {
    std::vector<std::string> names;
    for (const auto& [name, rig] : expectations().items())
        if (rig.contains("refused") == refused) names.push_back(name);
    return names;
}

std::string testName(const testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

TEST_P(Rigs, HaveTheirBonesWhereTheyAre) {
    const Character character = loadCharacter(rigFile(GetParam()));
    const Json& bones = expected().at("bones");
    const auto& found = character.skeleton.bones;
    if (skinned()) {  // tips of motions are bones too
        EXPECT_EQ(found.size(), bones.size());
    }
    std::vector<bool> taken(found.size(), false);
    for (const Json& bone : bones) {
        // By place, since names are no identity.
        float nearest = 1;
        std::size_t which = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const float away = length(found[i].bind.position - placeOf(bone));
            if (taken[i] || away >= nearest) continue;
            nearest = away;
            which = i;
        }
        EXPECT_LT(nearest, 1e-4f) << bone.at("name");
        taken[which] = true;
    }
}

TEST_P(Rigs, HaveTheRolesTheyWereMadeWith) {
    const Character character = loadCharacter(rigFile(GetParam()));
    const Anatomy anatomy = recognise(character.skeleton);
    EXPECT_EQ(nameOf(anatomy.plan), expected().at("plan").get<std::string>()) << anatomy.note;
    std::vector<std::string> wanted, found;
    const auto entry = [](const std::string& role, const Vec3& place) {
        return role + " at " + std::to_string(std::lround(1000 * place.x)) + " " +
               std::to_string(std::lround(1000 * place.y)) + " " + std::to_string(std::lround(1000 * place.z));
    };
    for (const Json& role : expected().at("roles"))
        wanted.push_back(entry(role.at("side").get<std::string>() + " " + role.at("role").get<std::string>(),
                               placeOf(expected().at("bones").at(role.at("bone").get<std::size_t>()))));
    for (const Segment& segment : anatomy.segments)
        if (segment.role != BodyRole::other)
            found.push_back(entry(shown(segment.role, segment.side),
                                  character.skeleton.bones[static_cast<std::size_t>(segment.bone)].bind.position));
    std::sort(wanted.begin(), wanted.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, wanted);
}

TEST_P(Rigs, WarnOfWhatIsMissingAndOfNothingElse) {
    const Character character = loadCharacter(rigFile(GetParam()));
    std::vector<std::string> warnings;
    for (const std::string& warning : character.warnings)
        if (warning.find("no up axis") == std::string::npos &&
            (skinned() || warning.find("unit") == std::string::npos) && warning.find("no skin") == std::string::npos)
            warnings.push_back(warning);
    const std::string wanted = expected().value("warns", "");
    EXPECT_EQ(warnings.size(), wanted.empty() ? 0u : 1u) << testing::PrintToString(warnings);
    if (!wanted.empty() && !warnings.empty()) {
        EXPECT_NE(warnings[0].find(wanted), std::string::npos) << warnings[0];
    }
}

TEST_P(Rigs, BecomeRagdollsOfLikelyDensity) {
    const RagdollDef def = makeRagdoll(loadCharacter(rigFile(GetParam())));
    EXPECT_EQ(whyInvalid(def), "");
    for (const RagdollPart& part : def.parts) {
        const float density = part.mass / massOf(part.shape, 1.0f).mass;
        EXPECT_GE(density, 0.999f * 300) << part.name;
        EXPECT_LE(density, 1.001f * 2000) << part.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Written, Rigs, testing::ValuesIn(rigNames(false)), testName);

class Props : public testing::TestWithParam<std::string> {};

TEST_P(Props, AreNoCharacters) {
    const auto file = rigFile(GetParam());
    const std::string error = importError(file, [&] { loadCharacter(file); });
    EXPECT_NE(error.find("nothing is skinned or moves as a skeleton"), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(Written, Props, testing::ValuesIn(rigNames(true)), testName);

}  // namespace
}  // namespace ragtop
