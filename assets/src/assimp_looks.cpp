#include "assimp_looks.h"

#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>

#include "gltf_buffer.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestImage = 16u << 20;  ///< bytes of a file
constexpr std::uintmax_t kAllImages = 64u << 20;     ///< bytes of all of a model

/// The kind of an image by its first bytes; empty for those that glTF does not have.
std::string mimeOf(std::string_view file) {
    if (file.starts_with("\x89PNG\r\n")) return "image/png";
    if (file.starts_with("\xff\xd8\xff")) return "image/jpeg";
    return {};
}

/// The path of a texture as files of other systems and machines name it, inside the folder of the model; empty when
/// it leads nowhere or out of there.
fs::path findTexture(const fs::path& folder, std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    std::error_code ignored;
    const fs::path root = fs::weakly_canonical(folder, ignored);
    for (const fs::path& tried : {fs::path(name), fs::path(name).filename()}) {
        const fs::path path = fs::weakly_canonical(root / tried, ignored);
        const auto inside = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
        if (inside.first == root.end() && fs::is_regular_file(path, ignored)) return path;
    }
    return {};
}

class TextureReader {
public:
    TextureReader(const aiScene& from, const fs::path& file, ImportedScene& to)
        : from_(from), folder_(file.parent_path().empty() ? "." : file.parent_path()), to_(to) {}

    /// The place of the image among the scene's, read once; −1 with a warning when it cannot be used.
    std::int32_t read(const std::string& name) {
        const auto [known, isNew] = places_.try_emplace(name, -1);
        if (!isNew) return known->second;
        ImportedImage image;
        std::string problem = load(name, image.file);
        if (problem.empty()) image.mime = mimeOf({image.file.data(), image.file.size()});
        if (problem.empty() && image.mime.empty()) problem = "is neither PNG nor JPEG";
        if (problem.empty() && (total_ += image.file.size()) > kAllImages) problem = "is too much";
        if (!problem.empty()) {
            to_.warnings.push_back("texture '" + name + "' " + problem + "; it is left out");
            return -1;
        }
        to_.images.push_back(std::move(image));
        return known->second = static_cast<std::int32_t>(to_.images.size()) - 1;
    }

private:
    std::string load(const std::string& name, std::vector<char>& into) const {
        if (const aiTexture* texture = from_.GetEmbeddedTexture(name.c_str())) {
            if (texture->mHeight != 0) return "is not compressed";
            const auto* bytes = reinterpret_cast<const char*>(texture->pcData);
            into.assign(bytes, bytes + texture->mWidth);
            return {};
        }
        const fs::path path = findTexture(folder_, name);
        if (path.empty()) return "is not in the folder of the model";
        std::error_code error;
        if (fs::file_size(path, error) > kLargestImage || error) return "is larger than 16 MiB";
        std::ifstream stream(path, std::ios::binary);
        into.assign(std::istreambuf_iterator<char>(stream), {});
        return {};
    }

    const aiScene& from_;
    fs::path folder_;
    ImportedScene& to_;
    std::map<std::string, std::int32_t> places_;
    std::uintmax_t total_ = 0;
};

bool isColor(const aiColor4D& c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && std::isfinite(c.a);
}

float share(float value) { return std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 0.0f; }

/// glTF says linear colours; what older formats call diffuse is meant for the screen as it is.
void readColor(const aiMaterial& from, ImportedMaterial& to) {
    aiColor4D color;
    if (from.Get(AI_MATKEY_BASE_COLOR, color) == AI_SUCCESS && isColor(color)) {
        to.color = {share(color.r), share(color.g), share(color.b), share(color.a)};
        return;
    }
    if (from.Get(AI_MATKEY_COLOR_DIFFUSE, color) != AI_SUCCESS || !isColor(color)) return;
    const auto linear = [](float value) { return static_cast<float>(linearValue(static_cast<double>(share(value)))); };
    to.color = {linear(color.r), linear(color.g), linear(color.b), 1};
    if (float opacity = 1; from.Get(AI_MATKEY_OPACITY, opacity) == AI_SUCCESS) to.color[3] = share(opacity);
}

ImportedMaterial toMaterial(const aiMaterial& from, TextureReader& textures) {
    ImportedMaterial material;
    material.name = from.GetName().C_Str();
    readColor(from, material);
    if (float value = 0; from.Get(AI_MATKEY_METALLIC_FACTOR, value) == AI_SUCCESS) material.metalness = share(value);
    if (float value = 0; from.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == AI_SUCCESS) material.roughness = share(value);
    if (int value = 0; from.Get(AI_MATKEY_TWOSIDED, value) == AI_SUCCESS) material.twoSided = value != 0;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
        aiString name;
        if (material.image >= 0 || from.GetTexture(type, 0, &name) != AI_SUCCESS) continue;
        material.image = textures.read(name.C_Str());
    }
    return material;
}

/// Degenerate triangles have no normal; they cannot be seen, so any will do.
Vec3 usableNormal(const aiVector3D& n) {
    const Vec3 normal{n.x, n.y, n.z};
    return isFinite(normal) ? normalized(normal, {0, 1, 0}) : Vec3{0, 1, 0};
}

void addSurface(const aiMesh& from, ImportedMesh& to) {
    const auto finite = [](float value) { return std::isfinite(value) ? value : 0.0f; };
    to.material = static_cast<std::int32_t>(from.mMaterialIndex);
    for (unsigned i = 0; from.HasNormals() && i < from.mNumVertices; ++i) {
        to.normals.push_back(usableNormal(from.mNormals[i]));
    }
    for (unsigned i = 0; from.HasTextureCoords(0) && i < from.mNumVertices; ++i) {
        const aiVector3D& at = from.mTextureCoords[0][i];
        to.texture.push_back({finite(at.x), 1 - finite(at.y)});
    }
}

}  // namespace

void addLooks(const aiScene& from, const std::filesystem::path& file, ImportedScene& to) {
    TextureReader textures(from, file, to);
    for (unsigned i = 0; i < from.mNumMaterials; ++i) to.materials.push_back(toMaterial(*from.mMaterials[i], textures));
    for (unsigned i = 0; i < from.mNumMeshes; ++i) addSurface(*from.mMeshes[i], to.meshes[i]);
}

}  // namespace ragtop
