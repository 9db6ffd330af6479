#pragma once

#include <cstdint>
#include <memory>

#include "narrowphase/four_capsules.h"
#include "ragtop/shape.h"
#include "shapes/geometry.h"
#include "world/mesh_memory.h"

/// What the world's stages share beside its state.
namespace ragtop {

/// Lengths relative to the size of what touches, and other numbers of the method.
namespace tuning {
inline constexpr float kSpeculative = 0.02f;      ///< contact margin at rest, in sizes of the smaller shape
inline constexpr float kReuse = 0.05f;            ///< motion of a pair within which its manifolds are kept, in sizes
inline constexpr float kFatMargin = 0.1f;         ///< enlargement of bounds, in sizes
inline constexpr float kContinuousMotion = 0.5f;  ///< motion per step beyond which a body is swept, in sizes
inline constexpr float kSlideSpeed = 0.05f;       ///< slowest slide or roll reported, in √(gravity · size)
}  // namespace tuning

/// A geometry shared by shapes, never moved; not part of a saved state.
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

/// Where a pair is that is asked for its contacts.
struct PairPlace {
    Frame bInA;           ///< of shape B in the axes of shape A
    float margin = 0;     ///< m, up to which points are found: all that the step may bring into touch
    float moved = 0;      ///< m, against each other, since manifolds were found
    float perTravel = 1;  ///< of such motion, at most, for what both bodies travel
    CapsuleTouch touch{};  ///< single where both are capsules that touch in a point, if anywhere
};

/// What a step finds of an awake contact; the last three come beside the others: that it may be a seam, that other points
/// hold a body on what does not move, and that it had no manifold before.
enum ContactChange : std::uint8_t { kUnchanged = 0, kApart = 1, kGraph = 2, kCloses = 4, kPoints = 8, kFound = 16 };

}  // namespace ragtop
