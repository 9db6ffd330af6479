#include "assimp_bones.h"

#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "gltf/springs.h"
#include "json_document.h"

namespace ragtop {
namespace {

using Nodes = std::vector<const aiNode*>;

/// assimp's node for each of the file's: it makes one of each, children in the same order, below a root of its own
/// where the scene has several. Empty where that does not hold.
Nodes nodesOf(const Json& gltf, const aiNode& root) {
    const Json& nodes = gltf.at("nodes");
    const Json& tops = gltf.at("scenes").at(gltf.value("scene", std::size_t{0})).at("nodes");
    Nodes found(nodes.size(), nullptr);
    std::vector<std::pair<const aiNode*, std::size_t>> waiting;
    const auto meet = [&](const aiNode& parent, const Json& children) {
        if (children.size() != parent.mNumChildren) return false;
        for (std::size_t i = 0; i < children.size(); ++i)
            waiting.emplace_back(parent.mChildren[i], children.at(i).get<std::size_t>());
        return true;
    };
    if (tops.size() == 1)
        waiting.emplace_back(&root, tops.at(0).get<std::size_t>());
    else if (!meet(root, tops))
        return {};
    while (!waiting.empty()) {
        const auto [node, index] = waiting.back();
        waiting.pop_back();
        found.at(index) = node;
        if (!meet(*node, nodes.at(index).value("children", Json::array()))) return {};
    }
    return found;
}

/// A member of a file, where it is a list; all else, most of a file's text by far, is passed over.
Json listIn(const std::string& gltfText, const std::string& name) {
    const auto isNeeded = [&](int depth, Json::parse_event_t event, const Json& key) {
        return depth != 1 || event != Json::parse_event_t::key || key == name;
    };
    const Json gltf = Json::parse(gltfText, isNeeded, false);
    return gltf.is_object() && gltf.contains(name) && gltf.at(name).is_array() ? gltf.at(name) : Json::array();
}

/// Beginnings of names: what the importer or Ragtop reads, and what tells but looks, lights and licences.
constexpr std::array<std::string_view, 14> kExtensions{"KHR_draco_mesh_compression",
                                                       "KHR_physics_rigid_bodies",
                                                       "KHR_implicit_shapes",
                                                       "VRM",
                                                       "KHR_materials_",
                                                       "KHR_texture_",
                                                       "EXT_texture_",
                                                       "MSFT_texture_",
                                                       "KHR_light",
                                                       "EXT_light",
                                                       "KHR_technique",
                                                       "KHR_binary_glTF",
                                                       "KHR_xmp",
                                                       "ADOBE_materials_"};

/// Who does not know an extension that a file requires must not read it [Khronos, glTF 2.0, 3.12]: vertices may lie
/// there packed.
void checkRequired(const std::string& gltfText, const std::string& file) {
    const std::string list = "extensionsRequired";
    if (gltfText.find(list) == std::string::npos) return;
    const Json required = listIn(gltfText, list);
    for (std::size_t i = 0; i < required.size(); ++i) {
        if (!required[i].is_string()) continue;
        const auto name = required[i].get<std::string>();
        const auto begins = [&](std::string_view known) { return name.starts_with(known); };
        if (std::none_of(kExtensions.begin(), kExtensions.end(), begins))
            throw AssetError(file, "",
                             "/extensionsRequired/" + std::to_string(i) + " is '" + name +
                                 "', which is not read, must be none that packs or moves vertices");
    }
}

/// The nodes that carry no mesh before those that do.
Nodes barestFirst(const NodePlaces& places) {
    std::vector<const aiNode*> inOrder(places.size());
    for (const auto& [node, place] : places) inOrder[static_cast<std::size_t>(place)] = node;
    Nodes nodes;
    for (const bool carries : {false, true})
        for (const aiNode* node : inOrder)
            if ((node->mNumMeshes > 0) == carries) nodes.push_back(node);
    return nodes;
}

}  // namespace

/// In a binary one header and chunk header are 20 bytes [Khronos, glTF 2.0, 4.4].
std::string gltfText(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    const std::streamoff size = std::max<std::streamoff>(stream.tellg(), 0);
    const auto read = [&](std::streamoff from, std::streamoff count) {
        std::string bytes(static_cast<std::size_t>(std::clamp<std::streamoff>(count, 0, size - from)), '\0');
        stream.seekg(from).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return bytes;
    };
    constexpr std::streamoff kHeaders = 20;  // of a binary, and of its first chunk
    if (size < kHeaders) return read(0, size);
    const std::string head = read(0, kHeaders);
    if (!head.starts_with("glTF")) return read(0, size);
    std::uint32_t length = 0;
    std::memcpy(&length, head.data() + 12, sizeof length);
    return read(kHeaders, length);
}

/// Matrices are optional [Khronos, glTF 2.0, 3.7.3.1]. Without them each vertex is in the frame of its joint, which
/// tells no rest pose of a vertex that several joints move.
void checkGltf(const std::string& file) {
    const std::string text = gltfText(file);
    checkRequired(text, file);
    const auto times = [&](std::string_view key) {
        int count = 0;
        for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + key.size())) ++count;
        return count;
    };
    if (times("joints\"") <= times("BindMatrices\"")) return;  // begins with letters that are rare in numbers
    const Json skins = listIn(text, "skins");
    for (std::size_t i = 0; i < skins.size(); ++i)
        if (skins[i].contains("joints") && !skins[i].contains("inverseBindMatrices"))
            throw AssetError(file, "", "/skins/" + std::to_string(i) + " has no inverseBindMatrices, must have them");
}

void findBoneNodes(const NodePlaces& places, ImportedScene& to) {
    std::map<std::string, const aiNode*> named;
    for (const aiNode* node : barestFirst(places)) named.emplace(node->mName.C_Str(), node);
    for (ImportedMesh& mesh : to.meshes)
        for (ImportedBone& bone : mesh.bones)
            if (const auto found = named.find(bone.name); found != named.end()) bone.node = places.at(found->second);
}

void findSprings(const aiScene& from, const std::string& file, const NodePlaces& places, ImportedScene& to) {
    if (to.format.find("glTF") == std::string::npos) return;
    const std::string text = gltfText(file);
    if (text.find("VRMC_springBone") == std::string::npos) return;
    const JsonDocument gltf = JsonDocument::parse(text, file);
    ImportedSprings springs = readGltfSprings(gltf);
    if (springs.bones.empty()) return;
    Nodes nodes;
    try {
        nodes = nodesOf(gltf.root(), *from.mRootNode);
    } catch (const std::exception&) {  // a tree that assimp has understood in another way
    }
    const auto place = [&](std::int32_t node) {
        const auto index = static_cast<std::size_t>(node);
        return index < nodes.size() && nodes[index] ? places.at(nodes[index]) : -1;
    };
    const auto count = springs.bones.size() + springs.colliders.size();
    for (ImportedSpring& spring : springs.bones) spring.node = place(spring.node), spring.end = place(spring.end);
    for (ImportedSpringCollider& collider : springs.colliders) collider.node = place(collider.node);
    std::erase_if(springs.bones, [](const ImportedSpring& spring) { return spring.node < 0 || spring.end < 0; });
    std::erase_if(springs.colliders, [](const ImportedSpringCollider& collider) { return collider.node < 0; });
    if (const auto lost = count - springs.bones.size() - springs.colliders.size(); lost > 0)
        to.warnings.push_back(std::to_string(lost) + " springs of nodes outside of the scene are left out");
    to.springs = std::move(springs);
}

}  // namespace ragtop
