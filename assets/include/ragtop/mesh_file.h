#pragma once

#include <cstdint>
#include <filesystem>

#include "ragtop/asset_error.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"

namespace ragtop {

/// The axis of a file that points up; what is read from it is turned so that y does.
enum class UpAxis : std::uint8_t { x, y, z };

struct MeshOptions {
    float scale = 1.0f;         ///< times the unit of the file (m, where it names none)
    UpAxis upAxis = UpAxis::y;  ///< of the file
    bool convex = false;        ///< its convex hull, which may move, instead of the mesh
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const MeshOptions*) {
    visit(Tunable{"scale", "1", 1e-6, 1e6, "size over the size in the file"}, self.scale);
    visit(Tunable{"convex", "", 0, 1, "the convex hull instead of the mesh"}, self.convex);
}

/// All meshes of a file (OBJ, STL, PLY, glTF, FBX and others) at their places, as one TriangleMesh or ConvexHull.
/// Throws AssetError: missing, not readable, no triangles, not finite.
Shape loadMesh(const std::filesystem::path& path, const MeshOptions& options = {});

}  // namespace ragtop
