#include "gltf/bind_matrices.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "assimp_bones.h"
#include "gltf/base64.h"
#include "json_document.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

constexpr std::size_t kMostJoints = 1u << 20;

const Json* listOf(const Json& gltf, const char* name) {
    const auto found = gltf.is_object() ? gltf.find(name) : gltf.end();
    return found != gltf.end() && found->is_array() ? &*found : nullptr;
}

/// Joints of a skin without matrices; 0 where it has some.
std::size_t unboundJoints(const Json& gltf, std::size_t index, const std::string& file) {
    const Json& skin = gltf.at("skins").at(index);
    const Json* joints = listOf(skin, "joints");
    if (!joints) return 0;
    const auto bound = skin.find("inverseBindMatrices");
    if (bound == skin.end() || bound->is_null()) return joints->size();
    const Json* accessors = listOf(gltf, "accessors");
    if (!accessors || !bound->is_number_unsigned() || bound->get<std::size_t>() >= accessors->size()) return 0;
    const Json& accessor = accessors->at(bound->get<std::size_t>());
    const auto count = accessor.is_object() ? accessor.find("count") : accessor.end();
    if (count != accessor.end() && count->is_number_unsigned() && count->get<std::size_t>() < joints->size())
        throw AssetError(file, "",
                         "/skins/" + std::to_string(index) + " has " + std::to_string(count->get<std::size_t>()) +
                             " inverseBindMatrices, must have one for each of its " + std::to_string(joints->size()) +
                             " joints");
    return 0;
}

/// One list of identities serves all skins, in a buffer of its own.
void addIdentities(Json& gltf, const std::vector<std::size_t>& counts) {
    const auto add = [&](const char* name, Json value) {
        Json& list = gltf[name];
        if (!list.is_array()) list = Json::array();
        list.push_back(std::move(value));
        return list.size() - 1;
    };
    std::vector<std::array<float, 16>> identities(*std::max_element(counts.begin(), counts.end()),
                                                  {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    const auto bytes = std::as_bytes(std::span(identities));
    const std::size_t buffer = add("buffers", {{"byteLength", bytes.size()}, {"uri", dataUri(bytes)}});
    const std::size_t view = add("bufferViews", {{"buffer", buffer}, {"byteLength", bytes.size()}});
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (counts[i] > 0)
            gltf["skins"][i]["inverseBindMatrices"] = add(
                "accessors", {{"bufferView", view}, {"componentType", 5126}, {"count", counts[i]}, {"type", "MAT4"}});
}

/// Another JSON in place of that of a text or binary file [Khronos, glTF 2.0, 4.4].
std::string withJson(const std::string& content, std::string text) {
    constexpr std::size_t kHeaders = 20;
    if (!content.starts_with("glTF")) return text;
    std::uint32_t before = 0;
    std::memcpy(&before, content.data() + 12, sizeof before);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string result = content.substr(0, kHeaders) + text;
    if (content.size() - kHeaders > before) result += content.substr(kHeaders + before);
    const auto put = [&](std::size_t at, std::size_t value) {
        const auto word = static_cast<std::uint32_t>(value);
        std::memcpy(result.data() + at, &word, sizeof word);
    };
    put(8, result.size());
    put(12, text.size());
    return result;
}

}  // namespace

bool isGltf(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".gltf" || extension == ".glb";
}

std::string withBindMatrices(const std::string& file) {
    const std::string text = gltfText(file);
    if (text.find("\"skins\"") == std::string::npos) return {};
    Json gltf = Json::parse(text, nullptr, false);
    const Json* skins = listOf(gltf, "skins");
    if (!skins) return {};
    std::vector<std::size_t> counts;
    for (std::size_t i = 0; i < skins->size(); ++i) counts.push_back(unboundJoints(gltf, i, file));
    if (std::none_of(counts.begin(), counts.end(), [](std::size_t count) { return count > 0; })) return {};
    if (*std::max_element(counts.begin(), counts.end()) > kMostJoints)
        throw AssetError(file, "", "/skins has one of more than " + std::to_string(kMostJoints) + " joints");
    addIdentities(gltf, counts);
    std::ifstream stream(file, std::ios::binary);
    const std::string content(std::istreambuf_iterator<char>(stream), {});
    return withJson(content, gltf.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace ragtop
