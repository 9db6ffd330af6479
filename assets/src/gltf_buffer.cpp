#include "gltf_buffer.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

namespace ragtop {
namespace {

/// Bytes from one vertex to the next; 0 where the view has no attributes of vertices.
std::size_t strideOf(GltfView view) {
    switch (view) {
        case GltfView::vertices:
            return sizeof(Vec3);
        case GltfView::texcoords:
            return 2 * sizeof(float);
        case GltfView::joints:
            return 4 * sizeof(std::uint16_t);
        case GltfView::weights:
            return 4 * sizeof(float);
        default:
            return 0;
    }
}

}  // namespace

int GltfBuffer::add(GltfView view, int component, int type, std::size_t count, const void* data, std::size_t bytes) {
    std::vector<unsigned char>& stored = data_[static_cast<std::size_t>(view)];
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(view);
    accessor.byteOffset = stored.size();
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    const auto* begin = static_cast<const unsigned char*>(data);
    stored.insert(stored.end(), begin, begin + bytes);
    model_->accessors.push_back(std::move(accessor));
    return static_cast<int>(model_->accessors.size()) - 1;
}

int GltfBuffer::add(GltfView view, std::span<const Vec3> values) {
    const int index =
        add(view, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, values.size(), values.data(), values.size_bytes());
    if (view == GltfView::vertices) {
        Vec3 lower = values.front(), upper = values.front();
        for (const Vec3& v : values) lower = min(lower, v), upper = max(upper, v);
        tinygltf::Accessor& accessor = model_->accessors.back();
        accessor.minValues = {lower.x, lower.y, lower.z};
        accessor.maxValues = {upper.x, upper.y, upper.z};
    }
    return index;
}

int GltfBuffer::add(std::span<const std::uint32_t> indices) {
    return add(GltfView::indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, indices.size(),
               indices.data(), indices.size_bytes());
}

int GltfBuffer::addImage(std::string mime, std::span<const char> file) {
    tinygltf::Image image;
    image.mimeType = std::move(mime);
    model_->images.push_back(std::move(image));
    images_.emplace_back(file.begin(), file.end());
    return static_cast<int>(model_->images.size()) - 1;
}

void GltfBuffer::finish() {
    tinygltf::Buffer buffer;
    const auto addView = [&](const std::vector<unsigned char>& data, std::size_t stride, int target) {
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = buffer.data.size();
        view.byteLength = data.size();
        view.byteStride = stride;
        view.target = target;
        model_->bufferViews.push_back(std::move(view));
        buffer.data.insert(buffer.data.end(), data.begin(), data.end());
        buffer.data.resize((buffer.data.size() + 3) / 4 * 4);
        return static_cast<int>(model_->bufferViews.size()) - 1;
    };
    std::array<int, kViews> numbers{};
    for (std::size_t i = 0; i < kViews; ++i) {
        if (data_[i].empty()) continue;
        const auto kind = static_cast<GltfView>(i);
        const int target = strideOf(kind) > 0          ? TINYGLTF_TARGET_ARRAY_BUFFER
                           : kind == GltfView::indices ? TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER
                                                       : 0;
        numbers[i] = addView(data_[i], strideOf(kind), target);
    }
    for (tinygltf::Accessor& accessor : model_->accessors) {
        accessor.bufferView = numbers[static_cast<std::size_t>(accessor.bufferView)];
    }
    for (std::size_t i = 0; i < images_.size(); ++i) model_->images[i].bufferView = addView(images_[i], 0, 0);
    if (!buffer.data.empty()) model_->buffers.push_back(std::move(buffer));
}

std::vector<double> linearColor(Color color) {
    const auto channel = [&](int shift) { return linearValue(((color >> shift) & 0xff) / 255.0); };
    return {channel(16), channel(8), channel(0), 1.0};
}

double linearValue(double srgb) { return std::pow(srgb, 2.2); }

tinygltf::Model emptyModel() {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "ragtop";
    model.scenes.resize(1);
    model.defaultScene = 0;
    return model;
}

void setPose(tinygltf::Node& node, const Vec3& p, const Quat& q) {
    if (p != Vec3{}) node.translation = {p.x, p.y, p.z};
    // A unit quaternion may round to a component just above one, which glTF forbids.
    const auto component = [](float c) { return static_cast<double>(std::clamp(c, -1.0f, 1.0f)); };
    if (q != Quat{}) node.rotation = {component(q.x), component(q.y), component(q.z), component(q.w)};
}

void setScale(tinygltf::Node& node, const Vec3& s) {
    if (s != Vec3{1, 1, 1}) node.scale = {s.x, s.y, s.z};
}

bool writeBinary(const tinygltf::Model& model, std::ostream& out) {
    return out && tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true) && out.flush();
}

}  // namespace ragtop
