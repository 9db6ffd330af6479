#pragma once

#include <vector>

#include "gltf/physics_format.h"
#include "json_value.h"
#include "ragtop/math.h"

namespace ragtop {

/// The nodes of a glTF file as a tree.
class GltfTree {
public:
    /// Throws AssetError at the child that is no node, has two parents, or is above itself.
    GltfTree(const std::vector<GltfNode>& nodes, const JsonValue& file);

    int parent(int node) const { return parents_[static_cast<std::size_t>(node)]; }
    /// The nearest at or above a node for which `is` holds; −1: none.
    template <class Is>
    int nearest(int node, Is is) const {
        while (node >= 0 && !is(node)) node = parent(node);
        return node;
    }
    const Frame& local(int node) const { return locals_[static_cast<std::size_t>(node)]; }
    const Vec3& scale(int node) const { return scales_[static_cast<std::size_t>(node)]; }
    /// Of all that is in a node, its own scale included.
    Vec3 scaleWithin(int node) const;
    /// A node in the scene, and in a node above it; what is sheared loses that.
    Frame inScene(int node) const;
    Frame within(int node, int above) const;
    /// A point of a node in the frame of a node above it.
    Vec3 pointWithin(Vec3 point, int node, int above) const;

private:
    std::vector<int> parents_;
    std::vector<Frame> locals_;
    std::vector<Vec3> scales_;
};

/// Parents before children, depth first.
std::vector<int> nodeOrder(const GltfTree& tree, std::size_t count);

}  // namespace ragtop
