#include "assimp_bones.h"

#include <assimp/scene.h>

#include <algorithm>
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

/// What tells nodes from each other. Clips and accessors, most of a file's text by far, are passed over.
Json readNodes(const std::string& gltfText) {
    const auto isNeeded = [](int depth, Json::parse_event_t event, const Json& key) {
        return depth != 1 || event != Json::parse_event_t::key || key == "nodes" || key == "scenes" || key == "scene" ||
               key == "skins";
    };
    return Json::parse(gltfText, isNeeded, false);
}

/// The joints of the skin with which each node carries its meshes.
std::map<const aiNode*, Nodes> gltfJoints(const std::string& file, const aiNode& root) {
    std::map<const aiNode*, Nodes> joints;
    try {
        const Json gltf = readNodes(gltfText(file));
        const Nodes nodes = nodesOf(gltf, root);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const Json& node = gltf.at("nodes").at(i);
            if (!nodes[i] || !node.contains("skin")) continue;
            Nodes& ofSkin = joints[nodes[i]];
            for (const Json& joint : gltf.at("skins").at(node.at("skin").get<std::size_t>()).at("joints"))
                ofSkin.push_back(nodes.at(joint.get<std::size_t>()));
        }
    } catch (const std::exception&) {
        // glTF 1.0, whose nodes have names for numbers.
        return {};
    }
    return joints;
}

/// Nodes by their names, equal ones in their order.
using NamedNodes = std::map<std::string, Nodes>;

NamedNodes byName(const Nodes& nodes) {
    NamedNodes named;
    for (const aiNode* node : nodes)
        if (node) named[node->mName.C_Str()].push_back(node);
    return named;
}

/// The first of that name, from `skipped` equal ones on.
const aiNode* find(const NamedNodes& nodes, const std::string& name, std::size_t skipped) {
    const auto found = nodes.find(name);
    return found != nodes.end() && skipped < found->second.size() ? found->second[skipped] : nullptr;
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
void checkGltfSkins(const std::string& file) {
    const std::string text = gltfText(file);
    const auto times = [&](std::string_view key) {
        int count = 0;
        for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + key.size())) ++count;
        return count;
    };
    if (times("joints\"") <= times("BindMatrices\"")) return;  // begins with letters that are rare in numbers
    const Json gltf = readNodes(text);
    if (!gltf.is_object() || !gltf.contains("skins") || !gltf.at("skins").is_array()) return;
    const Json& skins = gltf.at("skins");
    for (std::size_t i = 0; i < skins.size(); ++i)
        if (skins[i].contains("joints") && !skins[i].contains("inverseBindMatrices"))
            throw AssetError(file, "", "/skins/" + std::to_string(i) + " has no inverseBindMatrices, must have them");
}

void findBoneNodes(const aiScene& from, const std::string& file, const NodePlaces& places, ImportedScene& to) {
    const NamedNodes all = byName(barestFirst(places));
    const bool areNamesUnique =
        std::all_of(all.begin(), all.end(), [](const auto& named) { return named.second.size() == 1; });
    std::map<const aiNode*, Nodes> skins;
    if (!areNamesUnique && to.format.find("glTF") != std::string::npos) skins = gltfJoints(file, *from.mRootNode);
    std::map<const Nodes*, NamedNodes> jointsByName;
    std::map<std::size_t, const NamedNodes*> skinOf;
    for (const auto& [carrier, joints] : skins) {
        const NamedNodes& named = jointsByName[&joints] = byName(joints);
        for (unsigned i = 0; i < carrier->mNumMeshes; ++i) skinOf.emplace(carrier->mMeshes[i], &named);
    }
    for (std::size_t mesh = 0; mesh < to.meshes.size(); ++mesh) {
        const auto skin = skinOf.find(mesh);
        std::map<std::string, std::size_t> used;
        for (ImportedBone& bone : to.meshes[mesh].bones) {
            const aiNode* node = nullptr;
            if (skin != skinOf.end()) node = find(*skin->second, bone.name, used[bone.name]++);
            if (!node) node = find(all, bone.name, 0);
            if (node) bone.node = places.at(node);
        }
    }
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
