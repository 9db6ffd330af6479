#include <vector>

#include "assimp_scene.h"
#include "axes.h"
#include "ragtop/mesh_file.h"

namespace ragtop {
namespace {

struct Soup {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
};

void append(Soup& soup, const ImportedMesh& mesh, const Affine& place, UpAxis up, float scale) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const Vec3& vertex : mesh.vertices)
        soup.vertices.push_back(scale * upright(up, transformPoint(place, vertex)));
    // A mirrored placement turns triangles inside out.
    const bool mirrored = determinant(place.linear) < 0;
    for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
        const Triangle t{first + mesh.triangles[i], first + mesh.triangles[i + 1], first + mesh.triangles[i + 2]};
        soup.triangles.push_back(mirrored ? Triangle{t.a, t.c, t.b} : t);
    }
}

}  // namespace

Shape loadMesh(const std::filesystem::path& path, const MeshOptions& options) {
    const std::string file = path.string();
    if (!(options.scale >= 1e-6f && options.scale <= 1e6f))
        throw AssetError(file, "", "scale is " + std::to_string(options.scale) + ", must be in [1e-6, 1e6]");
    const ImportedScene scene = importScene(path, ImportedDetail::surface);
    const std::vector<Affine> globals = globalTransforms(scene);
    const double unit = scene.unitScale > 0 ? scene.unitScale : 1.0;
    const auto scale = static_cast<float>(unit * options.scale);
    Soup soup;
    for (const ImportedMesh& mesh : scene.meshes)
        for (const std::int32_t node : mesh.nodes)
            append(soup, mesh, globals[static_cast<std::size_t>(node)], options.upAxis, scale);
    if (soup.triangles.empty()) throw AssetError(file, "", "has no triangles, must have at least one");
    try {
        if (options.convex) return ConvexHull(soup.vertices);
        return TriangleMesh(soup.vertices, soup.triangles);
    } catch (const std::invalid_argument& error) {
        throw AssetError(file, "", error.what());
    }
}

}  // namespace ragtop
