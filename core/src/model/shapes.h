#pragma once

#include <cstdint>
#include <memory>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "model/records.h"
#include "ragtop/shape.h"
#include "shapes/geometry.h"

namespace ragtop {

/// A geometry that shapes share; never moved in memory, and no part of a saved state.
struct GeometryEntry {
    Shape shape;
    ConvexView convex;
    const MeshData* mesh = nullptr;
    const HeightFieldData* field = nullptr;
    float size = 0;
    /// The triangles of a box or hull, in worlds where meshes move.
    std::unique_ptr<const MeshData> skin{};
    const MeshData* triangles() const { return mesh ? mesh : skin.get(); }
    bool isMesh() const { return mesh || field; }
};

/// The shapes of a world, each of one body, and the geometries that they share.
class Shapes {
public:
    explicit Shapes(std::pmr::memory_resource* memory)
        : slots(memory), geometries(memory), densities(memory), records_(memory) {}
    void reserve(std::size_t count) { records_.reserve(count), densities.reserve(count); }

    /// A shape with all values as they are declared; those that were released are used first.
    std::uint32_t acquire();
    void release(std::uint32_t shape) { slots.release(shape); }

    std::size_t size() const { return records_.size(); }
    std::size_t bytes() const { return records_.bytes() + densities.bytes(); }
    ShapeRecord& operator[](std::size_t shape) { return records_[shape]; }
    const ShapeRecord& operator[](std::size_t shape) const { return records_[shape]; }
    const ShapeRecord* begin() const { return records_.begin(); }
    const ShapeRecord* end() const { return records_.end(); }
    ShapeId id(std::uint32_t shape) const { return {shape, slots.generation(shape)}; }

    const GeometryEntry& geometryOf(const ShapeRecord& shape) const { return geometries[shape.geometry]; }
    /// The entry of a geometry, which is made unless one of the last has the same data.
    std::uint32_t geometryIndex(const Shape& shape);
    /// From now on some mesh moves, and meets boxes and hulls by their triangles.
    void letMeshesMove();
    bool meshesMove() const { return meshesMove_; }
    /// From now on the surface of some shape may move on its own.
    void setMaterial(std::uint32_t shape, const Material& material) {
        records_[shape].material = material;
        noteMaterial(material);
    }
    void noteMaterial(const Material& material) { surfacesMove_ |= material.surfaceVelocity != Vec3{}; }
    bool surfacesMove() const { return surfacesMove_; }
    /// Of a shape, or of one of its triangles where these have materials of their own.
    const Material& materialAt(const ShapeRecord& shape, std::uint32_t triangle) const;

    template <class Archive>
    void archive(Archive& archive) {
        slots.archive(archive);
        archive(records_);
        archive(densities);
    }

    Slots slots;
    std::pmr::vector<GeometryEntry> geometries;
    AlignedArray<float> densities;  ///< kg/m³, of each shape

private:
    AlignedArray<ShapeRecord> records_;
    bool meshesMove_ = false, surfacesMove_ = false;
};

/// Widens the balls about a body's centre so that they hold a shape, and its core: what is round about that does not
/// change its place as the body turns.
void reach(BodyRecord& body, const ShapeRecord& shape, const GeometryEntry& geometry);

}  // namespace ragtop
