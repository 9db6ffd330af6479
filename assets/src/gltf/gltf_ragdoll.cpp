#include "ragtop/gltf_ragdoll.h"

#include <cstdint>
#include <fstream>

#include "assimp_bones.h"
#include "described_file.h"
#include "gltf/physics_document.h"
#include "import_child.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

bool isGltf(const fs::path& path) { return path.extension() == ".gltf" || path.extension() == ".glb"; }

/// Header, header of a chunk, and text filled up with spaces [Khronos, glTF 2.0, 4.4].
std::string binary(std::string text) {
    while (text.size() % 4 != 0) text += ' ';
    std::string bytes = "glTF";
    const auto put = [&](std::uint32_t value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(2), put(static_cast<std::uint32_t>(text.size() + 20)), put(static_cast<std::uint32_t>(text.size()));
    return bytes + "JSON" + text;
}

}  // namespace

bool hasGltfRagdoll(const fs::path& path) {
    if (!isGltf(path)) return false;
    char found = 0;
    try {
        importInChild(
            path,
            [&](ByteWriter& to) {
                to(static_cast<char>(hasGltfPhysics(JsonDocument::parse(gltfText(path.string()), path.string()))));
            },
            [&](ByteReader& from) { from(found); });
    } catch (const AssetError&) {
        return false;
    }
    return found != 0;
}

GltfRagdoll loadGltfRagdoll(const fs::path& path) {
    if (!isGltf(path)) throw AssetError(path.string(), "", "must end with .gltf or .glb");
    std::string text;
    GltfRagdoll loaded;
    importInChild(
        path,
        [&](ByteWriter& to) {
            const JsonDocument gltf = JsonDocument::parse(gltfText(path.string()), path.string());
            const RagdollFromGltf read = readGltfRagdoll(gltf, meshPointsOf(path));
            to(writeRagdoll(read.def).dump());
            to(read.warnings);
        },
        [&](ByteReader& from) { from(text), from(loaded.warnings); });
    loaded.ragdoll = readRagdoll(JsonDocument::parse(text, path.string()));
    return loaded;
}

void saveGltfRagdoll(const RagdollDef& def, const fs::path& path) {
    if (!isGltf(path)) throw AssetError(path.string(), "", "must end with .gltf or .glb");
    if (const std::string wrong = whyInvalid(def); !wrong.empty())
        throw AssetError(path.string(), "", "is not written, the ragdoll is not usable: " + wrong);
    const Json gltf = gltfOf(def, path.string());
    std::ofstream out(path, std::ios::binary);
    out << (path.extension() == ".glb" ? binary(gltf.dump()) : gltf.dump(2) + "\n");
    if (!out.flush()) throw AssetError(path.string(), "", "cannot be written");
}

}  // namespace ragtop
