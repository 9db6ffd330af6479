#include "asset_reference.h"

#include <stdexcept>

#include "described_file.h"
#include "ragtop/character.h"
#include "ragtop/cooked.h"
#include "ragtop/find_asset.h"
#include "ragtop/mesh_file.h"

namespace ragtop {
namespace {

/// Calls what may complain about the file, and puts the place of the reference before the complaint.
template <class Load>
auto referenced(const JsonValue& value, Load load) {
    try {
        return load();
    } catch (const std::runtime_error& error) {
        value.fail("is " + shown(value.json()) + ", must name a usable file: " + error.what());
    } catch (const std::invalid_argument& error) {
        value.fail("is " + shown(value.json()) + ", must name a usable file: " + error.what());
    }
}

}  // namespace

std::filesystem::path assetFile(const JsonValue& value) {
    const std::string name = value.json().get<std::string>();
    if (name.find(':') == std::string::npos) return referencedFile(value);
    return referenced(value, [&] { return findAsset(name); });
}

std::string whyAbsent(const JsonValue& value) {
    const std::string name = value.json().get<std::string>();
    const bool isPath = name.find(':') == std::string::npos;
    try {
        findAsset(isPath ? (value.folder() / name).string() : name);
    } catch (const AssetError& error) {
        return error.what();
    }
    return {};
}

Shape loadMeshReference(const JsonValue& value, bool convex) {
    const auto file = assetFile(value);
    return referenced(value, [&] { return loadMesh(file, {.convex = convex}); });
}

RagdollDef ragdollFromCharacter(const JsonValue& value, const RagdollOptions& options,
                                std::vector<std::string>& warnings) {
    const auto file = assetFile(value);
    return referenced(value, [&] {
        const Character character = loadCharacter(file);
        RagdollDef def = makeRagdoll(character.skeleton, options);
        for (const std::string& warning : character.warnings)
            warnings.push_back(value.json().get<std::string>() + ": " + warning);
        if (!def.note.empty()) warnings.push_back(value.json().get<std::string>() + ": " + def.note);
        return def;
    });
}

static Robot cookedRobot(const std::filesystem::path& file) {
    Cooked asset = loadCooked(file);
    if (!asset.robot) throw AssetError(file.string() + ": has no robot in it");
    return *std::move(asset.robot);
}

Robot robotFromFile(const JsonValue& value, std::vector<std::string>& warnings) {
    const auto file = assetFile(value);
    return referenced(value, [&] {
        if (file.extension() == ".ragtop") return cookedRobot(file);
        Robot robot = loadRobot(file);
        for (const std::string& warning : robot.warnings)
            warnings.push_back(value.json().get<std::string>() + ": " + warning);
        return robot;
    });
}

}  // namespace ragtop
