#include "gltf/numbered_nodes.h"

#include <assimp/scene.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include "assimp_bones.h"
#include "json_document.h"

namespace ragtop {
namespace {

constexpr char kMark = '\x01';        // between number and name: in no name that anybody writes
constexpr std::size_t kHeaders = 20;  // bytes, of a binary and of its first chunk [Khronos, glTF 2.0, 4.4]

/// A binary file with another text in its first chunk, padded with spaces to four bytes.
std::string withText(std::string binary, const std::string& before, std::string text) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.replace(kHeaders, std::min(before.size(), binary.size() - kHeaders), text);
    const auto put = [&](std::size_t at, std::size_t number) {
        const auto word = static_cast<std::uint32_t>(number);
        std::memcpy(binary.data() + at, &word, sizeof word);
    };
    put(8, binary.size());
    put(12, text.size());
    return binary;
}

}  // namespace

bool haveEqualNames(const aiNode& root) {
    std::set<std::string> names;
    std::vector<const aiNode*> waiting{&root};
    while (!waiting.empty()) {
        const aiNode& node = *waiting.back();
        waiting.pop_back();
        if (!names.insert(node.mName.C_Str()).second) return true;
        waiting.insert(waiting.end(), node.mChildren, node.mChildren + node.mNumChildren);
    }
    return false;
}

std::string withNumberedNodes(const std::string& file) {
    std::ostringstream whole;
    whole << std::ifstream(file, std::ios::binary).rdbuf();
    std::string bytes = std::move(whole).str();
    const std::string text = gltfText(file);
    Json gltf = parsedOrDiscarded(text);
    // Version 1 has names for numbers, and no equal ones.
    if (!gltf.is_object() || !gltf.contains("nodes") || !gltf.at("nodes").is_array()) return bytes;
    std::size_t number = 0;
    for (Json& node : gltf.at("nodes")) {
        const std::string index = std::to_string(number++);
        // Those without a name have one of assimp's, which is theirs alone.
        if (!node.is_object() || !node.contains("name") || !node.at("name").is_string()) continue;
        if (const auto name = node.at("name").get<std::string>(); !name.empty()) node["name"] = index + kMark + name;
    }
    std::string numbered = gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
    return bytes.starts_with("glTF") ? withText(std::move(bytes), text, std::move(numbered)) : numbered;
}

std::string nameInFile(const std::string& name) {
    const std::size_t mark = name.find(kMark);
    return mark == std::string::npos ? name : name.substr(mark + 1);
}

}  // namespace ragtop
