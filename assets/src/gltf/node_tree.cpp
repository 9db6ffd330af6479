#include "gltf/node_tree.h"

#include <cmath>
#include <string>

namespace ragtop {
namespace {

/// A matrix as turn, scale and place; a mirror image is turned back into a rotation, a shear is lost.
void takeApart(const std::array<float, 16>& m, Frame& frame, Vec3& scale) {
    const Vec3 x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]};
    scale = {length(x), length(y), length(z)};
    const Vec3 ex = normalized(x), ey = normalized(y - dot(y, ex) * ex, perpendicular(ex));
    if (dot(cross(ex, ey), z) < 0) scale.z = -scale.z;
    frame = {{m[12], m[13], m[14]}, normalized(rotationFromAxes(ex, ey, cross(ex, ey)))};
}

}  // namespace

GltfTree::GltfTree(const std::vector<GltfNode>& nodes, const JsonValue& file) : parents_(nodes.size(), -1) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (std::size_t k = 0; k < nodes[i].children.size(); ++k) {
            const auto child = static_cast<std::size_t>(nodes[i].children[k]);
            const JsonValue at = file.at("nodes").at(i).at("children").at(k);
            if (child >= nodes.size())
                at.fail("is " + std::to_string(child) + ", must be one of " + std::to_string(nodes.size()) + " nodes");
            if (parents_[child] >= 0)
                at.fail("is " + std::to_string(child) + ", must be a child of one node, is one of node " +
                        std::to_string(parents_[child]) + " too");
            parents_[child] = static_cast<int>(i);
        }
        Frame local{nodes[i].translation, nodes[i].rotation};
        Vec3 scale = nodes[i].scale;
        if (nodes[i].matrix) takeApart(*nodes[i].matrix, local, scale);
        locals_.push_back(local);
        scales_.push_back(scale);
    }
    // Each node has one parent at most, so a loop is where a walk upwards meets itself; 1: on this walk, 2: known to
    // end.
    std::vector<char> met(nodes.size(), 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        int node = static_cast<int>(i);
        for (; node >= 0 && met[static_cast<std::size_t>(node)] == 0; node = parent(node))
            met[static_cast<std::size_t>(node)] = 1;
        if (node >= 0 && met[static_cast<std::size_t>(node)] == 1)
            file.at("nodes")
                .at(static_cast<std::size_t>(node))
                .at("children")
                .fail("lead back to node " + std::to_string(node) + ", must be below it");
        for (node = static_cast<int>(i); node >= 0 && met[static_cast<std::size_t>(node)] == 1; node = parent(node))
            met[static_cast<std::size_t>(node)] = 2;
    }
}

Vec3 GltfTree::scaleWithin(int node) const {
    Vec3 all{1, 1, 1};
    for (; node >= 0; node = parent(node)) all = ragtop::scale(all, scale(node));
    return all;
}

Frame GltfTree::within(int node, int above) const {
    if (node == above) return {};
    Frame frame = local(node);
    for (int at = parent(node); at != above; at = parent(at))
        frame = {transformPoint(local(at), ragtop::scale(scale(at), frame.position)),
                 local(at).rotation * frame.rotation};
    return frame;
}

Frame GltfTree::inScene(int node) const { return within(node, -1); }

Vec3 GltfTree::pointWithin(Vec3 point, int node, int above) const {
    for (; node != above; node = parent(node)) point = transformPoint(local(node), ragtop::scale(scale(node), point));
    return point;
}

std::vector<int> nodeOrder(const GltfTree& tree, std::size_t count) {
    std::vector<std::vector<int>> children(count);
    std::vector<int> waiting, order;
    for (int node = static_cast<int>(count) - 1; node >= 0; --node)
        (tree.parent(node) < 0 ? waiting : children[static_cast<std::size_t>(tree.parent(node))]).push_back(node);
    while (!waiting.empty()) {
        const int node = waiting.back();
        waiting.pop_back();
        order.push_back(node);
        const std::vector<int>& below = children[static_cast<std::size_t>(node)];
        waiting.insert(waiting.end(), below.begin(), below.end());
    }
    return order;
}

}  // namespace ragtop
