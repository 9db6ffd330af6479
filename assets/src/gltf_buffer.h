#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "gltf_library.h"
#include "ragtop/debug_draw.h"
#include "ragtop/math.h"

namespace ragtop {

/// What is stored side by side in the buffer of a glTF file; a view each.
enum class GltfView : std::uint8_t { vertices, texcoords, joints, weights, indices, matrices, times, positions, turns };

/// Collects the numbers and images of a glTF model.
class GltfBuffer {
public:
    explicit GltfBuffer(tinygltf::Model& model) : model_(&model) {}

    // Each returns the accessor of what it has added.
    int add(GltfView view, int component, int type, std::size_t count, const void* data, std::size_t bytes);
    int add(GltfView view, std::span<const Vec3> values);  ///< with their corners, where they are vertices
    int add(std::span<const std::uint32_t> indices);

    /// A PNG or JPEG file; returns its place among the model's images.
    int addImage(std::string mime, std::span<const char> file);

    /// Joins the views into one buffer; views that stayed empty are dropped and the others renumbered.
    void finish();

private:
    static constexpr std::size_t kViews = static_cast<std::size_t>(GltfView::turns) + 1;

    tinygltf::Model* model_;
    std::array<std::vector<unsigned char>, kViews> data_;
    std::vector<std::vector<unsigned char>> images_;
};

/// Linear values of an sRGB colour, as glTF wants them.
std::vector<double> linearColor(Color color);
/// The same of one value in [0, 1].
double linearValue(double srgb);

/// The generator, version and one empty scene.
tinygltf::Model emptyModel();

/// Where a node stands; what is not needed is left out of the file.
void setPose(tinygltf::Node& node, const Vec3& position, const Quat& rotation);
void setScale(tinygltf::Node& node, const Vec3& scale);

/// Binary glTF; false when the stream fails.
bool writeBinary(const tinygltf::Model& model, std::ostream& out);

}  // namespace ragtop
