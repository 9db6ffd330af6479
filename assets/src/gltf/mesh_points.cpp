#include "gltf/mesh_points.h"

#include <cstring>
#include <memory>
#include <system_error>

#include "gltf_library.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

bool ignoreImage(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

/// By its name alone, as importers of other formats do.
bool isWithin(const fs::path& folder, const std::string& name) {
    std::error_code ignored;
    const fs::path inside = fs::absolute(name, ignored)
                                .lexically_normal()
                                .lexically_relative(fs::absolute(folder, ignored).lexically_normal());
    return !inside.empty() && *inside.begin() != "..";
}

tinygltf::Model load(const fs::path& file) {
    fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(ignoreImage, nullptr);
    loader.SetFsCallbacks({
        [](const std::string& name, void* of) {
            return isWithin(*static_cast<fs::path*>(of), name) && fs::exists(name);
        },
        [](const std::string& name, void*) { return name; },
        [](std::vector<unsigned char>* out, std::string* error, const std::string& name, void*) {
            return tinygltf::ReadWholeFile(out, error, name, nullptr);
        },
        nullptr,
        &folder,
    });
    tinygltf::Model model;
    std::string error, warning;
    const bool read = file.extension() == ".glb" ? loader.LoadBinaryFromFile(&model, &error, &warning, file.string())
                                                 : loader.LoadASCIIFromFile(&model, &error, &warning, file.string());
    if (read) return model;
    for (char& c : error)
        if (c == '\n') c = ' ';
    throw AssetError(file.string(), "", "has buffers that cannot be read: " + error);
}

/// The places of a primitive, or why they cannot be read.
std::string addPlaces(const tinygltf::Model& model, const tinygltf::Primitive& primitive, std::vector<Vec3>& points) {
    const auto found = primitive.attributes.find("POSITION");
    if (found == primitive.attributes.end()) return "has no POSITION";
    const auto at = [](const auto& all, int index) {
        return index >= 0 && static_cast<std::size_t>(index) < all.size() ? &all[static_cast<std::size_t>(index)]
                                                                          : nullptr;
    };
    const tinygltf::Accessor* accessor = at(model.accessors, found->second);
    const tinygltf::BufferView* view = accessor ? at(model.bufferViews, accessor->bufferView) : nullptr;
    const tinygltf::Buffer* buffer = view ? at(model.buffers, view->buffer) : nullptr;
    if (!buffer) return "has a POSITION without a buffer";
    if (accessor->componentType != TINYGLTF_COMPONENT_TYPE_FLOAT || accessor->type != TINYGLTF_TYPE_VEC3 ||
        accessor->sparse.isSparse)
        return "has a POSITION that is no plain list of three floats";
    const std::size_t stride = view->byteStride ? view->byteStride : sizeof(Vec3);
    const std::size_t first = view->byteOffset + accessor->byteOffset, count = accessor->count;
    if (count > (1u << 28) || stride > 4096 || first > buffer->data.size() || count == 0 ||
        (count - 1) * stride + sizeof(Vec3) > buffer->data.size() - first)
        return "has a POSITION that is longer than its buffer";
    for (std::size_t i = 0; i < count; ++i) {
        Vec3 point;
        std::memcpy(static_cast<void*>(&point), buffer->data.data() + first + i * stride, sizeof point);
        points.push_back(point);
    }
    return {};
}

}  // namespace

MeshPoints meshPointsOf(const fs::path& file) {
    auto model = std::make_shared<std::unique_ptr<tinygltf::Model>>();
    return [file, model](int mesh) {
        if (!*model) *model = std::make_unique<tinygltf::Model>(load(file));
        const std::string name = "/meshes/" + std::to_string(mesh);
        if (mesh < 0 || static_cast<std::size_t>(mesh) >= (*model)->meshes.size())
            throw AssetError(
                file.string(), "",
                name + " is not there, must be one of " + std::to_string((*model)->meshes.size()) + " meshes");
        std::vector<Vec3> points;
        for (const tinygltf::Primitive& primitive : (*model)->meshes[static_cast<std::size_t>(mesh)].primitives)
            if (const std::string wrong = addPlaces(**model, primitive, points); !wrong.empty())
                throw AssetError(file.string(), "", name + " " + wrong);
        return points;
    };
}

}  // namespace ragtop
