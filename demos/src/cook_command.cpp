#include "cook_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "borrowed_clips.h"
#include "ragtop/character.h"
#include "ragtop/cooked.h"
#include "ragtop/find_asset.h"
#include "ragtop/mesh_file.h"
#include "ragtop/ragdoll_file.h"
#include "ragtop/robot.h"
#include "ragtop/simplification.h"

namespace ragtop::demos {
namespace {

namespace fs = std::filesystem;

std::uint64_t hashOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
    if (!file) throw AssetError(path.string() + ": cannot be read");
    return cookedHash(std::as_bytes(std::span(text)));
}

void addMesh(const CookCommand& command, const fs::path& path, Cooked& asset) {
    const Shape shape = loadMesh(path);
    asset.mesh = std::get<TriangleMesh>(shape);
    if (command.simplify > 0) {
        const SimplerSurface less = simplify(asset.mesh->vertices(), asset.mesh->triangles(), command.simplify);
        asset.mesh = TriangleMesh(less.vertices, less.triangles);
    }
    if (command.pieces) asset.pieces = decompose(*asset.mesh, command.limits).pieces;
}

/// False where the file has no character in it.
bool addCharacter(const fs::path& path, Cooked& asset) {
    try {
        Character character = loadCharacter(path);
        asset.ragdoll = makeRagdoll(character);
        asset.skeleton = std::move(character.skeleton);
        asset.skeleton->skin.clear();
        asset.clips = std::move(character.clips);
        return true;
    } catch (const AssetError& error) {
        // What could not be imported once is not tried again, which would take as long.
        if (std::string(error.what()).find("has no bones") == std::string::npos) throw;
    } catch (const std::invalid_argument&) {  // bones that make no ragdoll
    }
    return false;
}

/// What is left out of it, which the file does not tell, is told here.
void addRobot(const CookCommand& command, const fs::path& path, Cooked& asset) {
    if (command.pieces || command.simplify > 0)
        throw AssetError(path.string() + ": is a robot, must be a mesh to be made simpler or cut into pieces");
    asset.robot = loadRobot(path);
    for (const std::string& warning : asset.robot->warnings) fmt::print(stderr, "warning: {}\n", warning);
}

void addClips(const CookCommand& command, Cooked& asset) {
    if (command.clips.empty()) return;
    if (!asset.skeleton || !asset.ragdoll)
        throw AssetError(command.asset + ": has no bones, must be a character to borrow clips");
    for (const std::string& other : command.clips)
        for (Clip& clip : borrowClips(other, *asset.ragdoll)) asset.clips.push_back(std::move(clip));
}

Cooked cooked(const CookCommand& command) {
    const fs::path path = findAsset(command.asset);
    Cooked asset;
    asset.sourceHash = hashOf(path);
    try {
        if (command.asset.ends_with(".ragdoll.json"))
            asset.ragdoll = loadRagdoll(path);
        else if (path.extension() == ".urdf" || path.extension() == ".xml")
            addRobot(command, path, asset);
        else if (command.pieces || command.simplify > 0 || !addCharacter(path, asset))
            addMesh(command, path, asset);
    } catch (const std::invalid_argument& error) {
        throw AssetError(path.string(), "", error.what());
    }
    addClips(command, asset);
    return asset;
}

}  // namespace

void cookAsset(const CookCommand& command) {
    const Cooked asset = cooked(command);
    try {
        saveCooked(asset, command.out);
    } catch (const CookedError& error) {
        throw AssetError(error.what());
    }
    fmt::print("{}: {} bytes\n", command.out, fs::file_size(command.out));
    if (asset.mesh) fmt::print("  mesh of {} triangles\n", asset.mesh->triangles().size());
    if (!asset.pieces.empty()) fmt::print("  {} convex pieces\n", asset.pieces.size());
    if (asset.skeleton)
        fmt::print("  skeleton of {} bones, {} clips\n", asset.skeleton->bones.size(), asset.clips.size());
    if (asset.robot)
        fmt::print("  robot of {} bodies, {} joints\n", asset.robot->bodies.size(), asset.robot->joints.size());
    if (asset.ragdoll) fmt::print("  ragdoll of {} parts\n", asset.ragdoll->parts.size());
}

}  // namespace ragtop::demos
