#include "model/shapes.h"

#include <utility>

#include "shapes/hull.h"
#include "shapes/mesh_build.h"

namespace ragtop {

std::uint32_t Shapes::acquire() {
    const std::uint32_t shape = slots.acquire();
    if (shape >= records_.size()) records_.resize(shape + 1, ShapeRecord{}), densities.resize(shape + 1, 0.0f);
    records_[shape] = ShapeRecord{};
    return shape;
}

/// Only the last ones are compared: what is made by the thousand is made in a row.
std::uint32_t Shapes::geometryIndex(const Shape& shape) {
    constexpr std::size_t kCompared = 64;  // by trial: what is made by the thousand is made in a row
    GeometryEntry entry{shape, {}, nullptr, nullptr, sizeOf(shape), nullptr};
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
        entry.mesh = &mesh->data();
    } else if (const auto* field = std::get_if<HeightField>(&shape)) {
        entry.field = &field->data();
    } else {
        entry.convex = convexView(shape);
    }
    for (std::size_t i = geometries.size(); i-- > 0 && geometries.size() - i <= kCompared;) {
        const GeometryEntry& known = geometries[i];
        if (known.shape.index() == shape.index() && known.mesh == entry.mesh && known.field == entry.field &&
            known.convex.hull == entry.convex.hull && known.convex.radius == entry.convex.radius &&
            known.convex.halfExtents == entry.convex.halfExtents)
            return static_cast<std::uint32_t>(i);
    }
    geometries.push_back(std::move(entry));
    if (meshesMove_) letMeshesMove();
    return static_cast<std::uint32_t>(geometries.size() - 1);
}

void Shapes::letMeshesMove() {
    meshesMove_ = true;
    for (GeometryEntry& entry : geometries) {
        const bool box = entry.convex.kind == ConvexKind::box, hull = entry.convex.kind == ConvexKind::hull;
        if (entry.isMesh() || entry.skin || !(box || hull)) continue;
        entry.skin =
            std::make_unique<const MeshData>(meshOf(box ? boxHull(entry.convex.halfExtents) : *entry.convex.hull));
    }
}

const Material& Shapes::materialAt(const ShapeRecord& shape, std::uint32_t triangle) const {
    const MeshData* mesh = geometries[shape.geometry].mesh;
    if (!mesh || mesh->materialOfTriangle.empty()) return shape.material;
    return mesh->materials[mesh->materialOfTriangle[triangle]];
}

void reach(BodyRecord& body, const ShapeRecord& shape, const GeometryEntry& geometry) {
    const float radius = radiusAbout(geometry.shape, inverseTransformPoint(shape.frame, {}));
    const float core = radius - geometry.convex.radius;
    if (radius > body.radius) body.radius = radius;
    if (core > body.travel.coreRadius) body.travel.coreRadius = core;
}

}  // namespace ragtop
