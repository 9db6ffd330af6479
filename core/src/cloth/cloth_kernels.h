#pragma once

#include <cstdint>

#include "ragtop/math.h"

/// The kernels that run N points, chains or faces of a cloth side by side, and what they work on.
namespace ragtop::cloth {

/// A point in the pass of a substep. Its inverse mass is W = w E − s sᵀ: what stands against a body moves with it along
/// the normal, so that s = n √(w − w of both).
struct alignas(32) PointRow {
    Vec3 place;           ///< m, from the cloth's origin
    float inverseMass = 0;  ///< w, 1/kg
    Vec3 held;            ///< s, 1/√kg
    float pull = 0;       ///< s · Σ f, f what lengths gave it, N s²
};
static_assert(sizeof(PointRow) == 32);

struct alignas(32) MotionRow {
    Vec3 before;   ///< m, place at the beginning of the substep
    float mass = 0;  ///< kg
    Vec3 velocity;  ///< m/s
    float leaves = 0;  ///< 1: lengths pulled it off what it touched in the last substep
};
static_assert(sizeof(MotionRow) == 32);

/// N chains side by side; shorter ones are filled up with links that do nothing.
struct ChainBundle {
    std::uint32_t firstPoint = 0;  ///< of numbers and reactions, N per point
    std::uint32_t firstLink = 0;   ///< of lengths and compliances, N per link
    std::int32_t links = 0;
    bool bends = false;   ///< has bending
    bool reacts = false;  ///< bodies hold points of it
};

/// All that kernels read and write. Arrays of floats are aligned for 16 lanes.
struct ClothArrays {
    PointRow* points = nullptr;
    MotionRow* motions = nullptr;
    int pointCount = 0;  ///< a multiple of 16
    const ChainBundle* bundles = nullptr;
    const std::uint32_t* numbers = nullptr;  ///< of points, by position in chains
    const float* lengths = nullptr;          ///< m, of links
    const float* compliances = nullptr;      ///< m/N
    const float* bendLengths = nullptr;      ///< m, of x₀ − 2 x₁ + x₂, by link x₁ x₂
    const float* bendCompliances = nullptr;  ///< m/N
    float* reactions = nullptr;  ///< N s², three times N per position, where bundles react
    float* scratch = nullptr;    ///< for the longest chain
    // Forces that are the same in all substeps of a step: G − k v.
    const float* drive[3] = {};         ///< N
    const float* resistance = nullptr;  ///< kg/s
    // Tethers, N at a time.
    const std::uint32_t *tethered = nullptr, *anchors = nullptr;  ///< points
    const float* tetherLengths = nullptr;                         ///< m
    float* tetherPulls[3] = {};                                   ///< N s², what pulled at the anchor
    int tetherCount = 0;                                          ///< a multiple of 16
};

struct ClothContext {
    float h = 0, inverseH = 0;  ///< s
    Vec3 gravity;               ///< m/s²
    float damping = 0;          ///< 1/s
};

enum class SurfaceKind : std::int32_t { capsule, box, hull, planes };

/// A shape as points meet it, moving through a substep.
struct Surface {
    SurfaceKind kind = SurfaceKind::capsule;
    Vec3 position;            ///< m, from the cloth's origin
    Quat rotation;
    float radius = 0;         ///< capsule
    Vec3 halfExtents;         ///< box; capsule: {0, halfHeight, 0}
    const float* planes = nullptr;  ///< hull: normal and offset of each
    int planeCount = 0;
    /// planes: x, y, z of the normal and the offset, 16 pairs at a time.
    const float* pairPlanes = nullptr;
    Vec3 center;              ///< of mass of the body, m from the cloth's origin
    Vec3 linear, angular;     ///< displacement and turn of the body in the substep, m and rad
};

/// Results of pairs of points with one surface, 16 of a kind at a time: gap at the beginning of the substep, gap at the
/// end, normal.
inline constexpr int kPairs = 16, kPairFloats = 5 * kPairs;

/// What air does to faces of three corners.
struct FaceArrays {
    const std::uint32_t* corners[3] = {};  ///< points
    float* force[3] = {};                  ///< N
    float* resistance = nullptr;           ///< kg/s
    int count = 0;                         ///< a multiple of 16
    float airDensity = 0, drag = 0, lift = 0;
    Vec3 wind;                             ///< m/s
};

struct ClothKernels {
    int lanes;
    /// v ← (v + h (g + (G − k v)/m)) / …, x ← x + h v; forgets what held the points.
    void (*predict)(const ClothArrays&, const ClothContext&);
    /// v ← (x − before)/h.
    void (*finish)(const ClothArrays&, const ClothContext&);
    void (*bend)(const ClothArrays&, int begin, int end, const ClothContext&);
    void (*solve)(const ClothArrays&, int begin, int end, const ClothContext&);
    void (*tether)(const ClothArrays&, const ClothContext&);
    void (*meet)(const ClothArrays&, const Surface&, const std::uint32_t* numbers, int count, float* results);
    void (*blow)(const ClothArrays&, const FaceArrays&);
};

/// Those of `lanes` (4, 8, 16) lanes, as the world's.
const ClothKernels& selectClothKernels(int lanes);

}  // namespace ragtop::cloth
