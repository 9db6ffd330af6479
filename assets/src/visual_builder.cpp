#include "visual_builder.h"

#include <cstring>
#include <sstream>
#include <utility>

#include "json_document.h"

namespace ragtop {
namespace {

/// As UTF-8, which glTF is; bytes that are not become signs for that.
std::string readable(const std::string& text) {
    return parsedOrDiscarded(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

}  // namespace

void VisualSurface::append(const ImportedMesh& mesh, const Affine& place) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const Vec3& vertex : mesh.vertices) vertices.push_back(transformPoint(place, vertex));
    // Normals turn with planes: by the cofactors, which are the inverse transpose but for scale.
    const Mat3& m = place.linear;
    const float side = determinant(m) < 0 ? -1.0f : 1.0f;
    const Mat3 cofactors{side * cross(m.cy, m.cz), side * cross(m.cz, m.cx), side * cross(m.cx, m.cy)};
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        normals.push_back(i < mesh.normals.size() ? normalized(cofactors * mesh.normals[i], {0, 1, 0}) : Vec3{0, 1, 0});
    }
    if (!mesh.texture.empty() || !texture.empty()) {
        texture.resize(first);
        texture.insert(texture.end(), mesh.texture.begin(), mesh.texture.end());
        texture.resize(vertices.size());
    }
    for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
        const std::uint32_t* t = &mesh.triangles[i];
        indices.insert(indices.end(), {first + t[0], first + t[side < 0 ? 2 : 1], first + t[side < 0 ? 1 : 2]});
    }
}

std::vector<VisualSurface> emptySurfaces(const ImportedScene& scene) {
    return std::vector<VisualSurface>(scene.materials.size() + 1);
}

VisualSurface& surfaceFor(const ImportedMesh& mesh, std::vector<VisualSurface>& surfaces) {
    return mesh.material < 0 ? surfaces.back() : surfaces[static_cast<std::size_t>(mesh.material)];
}

int VisualBuilder::addMaterials(const ImportedScene& scene) {
    const int firstMaterial = static_cast<int>(model_.materials.size());
    const int firstImage = static_cast<int>(model_.images.size());
    for (const ImportedImage& image : scene.images) {
        tinygltf::Texture texture;
        texture.source = buffer_.addImage(image.mime, image.file);
        model_.textures.push_back(std::move(texture));
    }
    for (std::size_t i = 0; i <= scene.materials.size(); ++i) {
        const ImportedMaterial& from = i < scene.materials.size() ? scene.materials[i] : ImportedMaterial{};
        tinygltf::Material material;
        material.name = readable(from.name);
        tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
        surface.baseColorFactor.assign(from.color.begin(), from.color.end());
        surface.metallicFactor = static_cast<double>(from.metalness);
        surface.roughnessFactor = static_cast<double>(from.roughness);
        if (from.image >= 0) surface.baseColorTexture.index = firstImage + from.image;
        material.doubleSided = from.twoSided;
        if (from.color[3] < 1) material.alphaMode = "BLEND";
        model_.materials.push_back(std::move(material));
    }
    return firstMaterial;
}

int VisualBuilder::addMesh(const std::vector<VisualSurface>& surfaces, int firstMaterial) {
    tinygltf::Mesh mesh;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (surfaces[i].indices.empty()) continue;
        mesh.primitives.push_back(primitiveOf(surfaces[i], firstMaterial + static_cast<int>(i)));
    }
    if (mesh.primitives.empty()) return -1;
    model_.meshes.push_back(std::move(mesh));
    return static_cast<int>(model_.meshes.size()) - 1;
}

tinygltf::Primitive VisualBuilder::primitiveOf(const VisualSurface& surface, int material) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    const std::size_t count = surface.vertices.size();
    primitive.attributes["POSITION"] = buffer_.add(GltfView::vertices, surface.vertices);
    primitive.attributes["NORMAL"] = buffer_.add(GltfView::vertices, surface.normals);
    if (!surface.texture.empty()) {
        primitive.attributes["TEXCOORD_0"] =
            buffer_.add(GltfView::texcoords, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, count,
                        surface.texture.data(), count * sizeof(TextureCoordinate));
    }
    if (!surface.joints.empty()) {
        std::vector<std::array<std::uint16_t, 4>> joints;
        std::vector<std::array<float, 4>> weights;
        for (const VertexJoints& vertex : surface.joints) {
            joints.push_back(vertex.joints);
            weights.push_back(vertex.weights);
        }
        primitive.attributes["JOINTS_0"] =
            buffer_.add(GltfView::joints, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, count,
                        joints.data(), count * sizeof joints[0]);
        primitive.attributes["WEIGHTS_0"] =
            buffer_.add(GltfView::weights, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, count, weights.data(),
                        count * sizeof weights[0]);
    }
    primitive.indices = buffer_.add(surface.indices);
    return primitive;
}

int VisualBuilder::addNode(tinygltf::Node node, std::string name) {
    name = readable(name);
    node.name = name;
    for (int copy = 2; !names_.insert(node.name).second; ++copy) {
        node.name = name + " (" + std::to_string(copy) + ")";
    }
    model_.nodes.push_back(std::move(node));
    return static_cast<int>(model_.nodes.size()) - 1;
}

int VisualBuilder::addNode(std::string name, const Frame& place, int mesh) {
    tinygltf::Node node;
    setPose(node, place.position, place.rotation);
    node.mesh = mesh;
    const int index = addNode(std::move(node), std::move(name));
    model_.scenes[0].nodes.push_back(index);
    return index;
}

int VisualBuilder::addChild(int parent, std::string name, const Frame& place, int mesh, const Vec3& scale) {
    tinygltf::Node node;
    setPose(node, place.position, place.rotation);
    setScale(node, scale);
    node.mesh = mesh;
    const int index = addNode(std::move(node), std::move(name));
    model_.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
    return index;
}

void VisualBuilder::addSkin(int mesh, const std::vector<int>& joints, const std::vector<Frame>& rest) {
    std::vector<float> inverseRest;
    for (const Frame& frame : rest) {
        const Frame inverted = inverse(frame);
        for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            const Vec3 column = rotate(inverted.rotation, axis);
            inverseRest.insert(inverseRest.end(), {column.x, column.y, column.z, 0});
        }
        const Vec3& shift = inverted.position;
        inverseRest.insert(inverseRest.end(), {shift.x, shift.y, shift.z, 1});
    }
    tinygltf::Skin skin;
    skin.joints = joints;
    skin.inverseBindMatrices = buffer_.add(GltfView::matrices, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4,
                                           rest.size(), inverseRest.data(), inverseRest.size() * sizeof(float));
    model_.skins.push_back(std::move(skin));
    model_.nodes[static_cast<std::size_t>(addNode("(skin)", {}, mesh))].skin =
        static_cast<int>(model_.skins.size()) - 1;
}

std::vector<std::byte> VisualBuilder::finish(const std::string& file) {
    buffer_.finish();
    std::ostringstream out;
    if (!writeBinary(model_, out)) throw AssetError(file, "", "cannot be written as glTF");
    const std::string text = out.str();
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

}  // namespace ragtop
