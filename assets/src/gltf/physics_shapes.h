#pragma once

#include <string>
#include <vector>

#include "gltf/mesh_points.h"
#include "gltf/node_tree.h"
#include "ragtop/ragdoll.h"

namespace ragtop {

/// What the colliders of a body are together: one as it is, of several, and of shapes that Ragtop does not have, the
/// hull. `scale` is that of the body and what it is in.
struct BodyShape {
    Shape shape{};
    Frame frame{};                    ///< in the body
    std::vector<std::string> lost{};  ///< as "has …"
};

/// `nodes` are those of the colliders. Throws AssetError at what makes no shape.
BodyShape shapeOfBody(const GltfFile& file, const GltfTree& tree, const JsonValue& json, const MeshPoints& points,
                      int body, const std::vector<int>& nodes);

}  // namespace ragtop
