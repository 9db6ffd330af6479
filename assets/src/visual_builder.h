#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "assimp_scene.h"
#include "gltf_buffer.h"
#include "ragtop/visual.h"

namespace ragtop {

/// The joints that move a vertex, and how much.
struct VertexJoints {
    std::array<std::uint16_t, 4> joints{};
    std::array<float, 4> weights{1, 0, 0, 0};
};

/// Triangles of one material.
struct VisualSurface {
    std::vector<Vec3> vertices, normals;
    std::vector<TextureCoordinate> texture;  ///< none, or one per vertex
    std::vector<VertexJoints> joints;        ///< none, or one per vertex
    std::vector<std::uint32_t> indices;

    /// Adds a mesh as `place` puts it; mirrored ones keep their outside outside.
    void append(const ImportedMesh& mesh, const Affine& place);
};

/// Surfaces by the materials of a scene; the last one is for meshes that have none.
std::vector<VisualSurface> emptySurfaces(const ImportedScene& scene);
VisualSurface& surfaceFor(const ImportedMesh& mesh, std::vector<VisualSurface>& surfaces);

/// Puts together what a Visual is made from.
class VisualBuilder {
public:
    /// Copies the materials and images of a scene; returns the number of the first material, for addMesh.
    int addMaterials(const ImportedScene& scene);
    /// A mesh of those surfaces that are not empty; −1 where all are.
    int addMesh(const std::vector<VisualSurface>& surfaces, int firstMaterial);
    /// A node without a parent; returns its number.
    int addNode(std::string name, const Frame& place = {}, int mesh = -1);
    int addChild(int parent, std::string name, const Frame& place = {}, int mesh = -1, const Vec3& scale = {1, 1, 1});
    /// Draws a mesh that follows joints, each a node, by where they stood at rest.
    void addSkin(int mesh, const std::vector<int>& joints, const std::vector<Frame>& rest);

    /// Of a name that occurs again, with a number; importers name nodes without one themselves, so all have one.
    const std::string& nameOf(int node) const { return model_.nodes[static_cast<std::size_t>(node)].name; }
    /// The file; an error names `file`.
    std::vector<std::byte> finish(const std::string& file);

private:
    int addNode(tinygltf::Node node, std::string name);
    tinygltf::Primitive primitiveOf(const VisualSurface& surface, int material);

    tinygltf::Model model_ = emptyModel();
    GltfBuffer buffer_{model_};
    std::set<std::string> names_;
};

}  // namespace ragtop
