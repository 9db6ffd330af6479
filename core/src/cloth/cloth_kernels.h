#pragma once

#include <cstdint>

#include "ragtop/math.h"

/// The kernels that run N points, chains, strips or faces of a cloth side by side, and what they work on.
namespace ragtop::cloth {

/// Rows of four floats: as many as there are lanes are read and turned into columns at once, and what is the same for
/// all four is computed on rows as they lie. Kernels find them by how many bytes they are from the first.
inline constexpr std::uint32_t kRowBytes = 16;

/// A point as it is in a small step.
struct alignas(16) PointRow {
    Vec3 place;             ///< m, from the cloth's origin
    float inverseMass = 0;  ///< w, 1/kg
};
static_assert(sizeof(PointRow) == kRowBytes);

/// What a point is tied by. Its inverse mass is W = w E − s sᵀ: what stands against a body moves with it along the
/// normal, so that s = n √(w − w of both).
struct alignas(16) TieRow {
    Vec3 held;       ///< s, 1/√kg
    float pull = 0;  ///< s · Σ f, f what lengths gave it, N s²
};
static_assert(sizeof(TieRow) == kRowBytes);

struct alignas(16) VectorRow {
    Vec3 v;
    float none = 0;
};
static_assert(sizeof(VectorRow) == kRowBytes);

/// What air does to a point or a face: G − k v.
struct alignas(16) AirRow {
    Vec3 force;            ///< G, N
    float resistance = 0;  ///< k, kg/s
};
static_assert(sizeof(AirRow) == kRowBytes);

/// Where points of a bundle are when it is a piece of a grid, in bytes.
struct EvenRows {
    std::int32_t first = 0, across = 0;  ///< from one lane to the next
    std::int32_t along = 0;              ///< and from one position or rung to the next
    std::int32_t beside = 0;             ///< and from one end of a rung to the other
    bool even = false;                   ///< it is one
};

/// N chains side by side; shorter ones are filled up with links that do nothing.
struct ChainBundle {
    std::uint32_t firstPoint = 0;  ///< of rows and reactions, N per point
    std::uint32_t firstLink = 0;   ///< of what links have, N per link
    std::int32_t links = 0;
    bool reacts = false;  ///< bodies hold points of it
    EvenRows rows;
};

/// N strips of quads side by side, two points where a quad meets the next; shorter ones are filled up likewise.
struct StripBundle {
    std::uint32_t firstPoint = 0;  ///< of rows and reactions, 2 N per rung
    std::uint32_t firstQuad = 0;   ///< of what quads have, N per quad
    std::int32_t quads = 0;
    bool reacts = false;  ///< bodies hold points of it
    EvenRows rows;
};

/// Of chains, N per link.
struct LinkArrays {
    const float *lengths = nullptr, *inverseLengths = nullptr;  ///< m and 1/m; zero where there is none
    const float* compliances = nullptr;                         ///< m/N
    /// N/m of x₀ − 2 x₁ + x₂, by link x₁ x₂, and its length at rest; null where nothing bends, or all is straight.
    const float *bendStiffness = nullptr, *bendLengths = nullptr;
};

/// Of strips, N per quad: of the difference of squared diagonals.
struct QuadArrays {
    const float *stiffness = nullptr, *rests = nullptr;  ///< N/m³ and m²
};

/// Of all points; null where there are none.
struct TetherArrays {
    const std::uint32_t* anchors = nullptr;  ///< rows of points, bytes
    const float* lengths = nullptr;          ///< m
    float* pulls[3] = {};                    ///< N s², what pulled at the anchor
};

/// Of scratch memory per lane, at most: for a point of a chain and for a rung of a strip.
inline constexpr int kLinkFloats = 14, kQuadFloats = 24;

/// All that kernels read and write. Arrays of floats are aligned for 16 lanes.
struct ClothArrays {
    PointRow *points = nullptr, *before = nullptr;  ///< and where they were when the small step began
    VectorRow* velocities = nullptr;                ///< m/s
    TieRow* ties = nullptr;
    int pointCount = 0;  ///< a multiple of 16
    const ChainBundle* chains = nullptr;
    const StripBundle* strips = nullptr;
    const std::uint8_t *chainTied = nullptr, *stripTied = nullptr;  ///< of each bundle: has points that are tied
    const std::uint32_t* rows = nullptr;  ///< of points, bytes, by position in chains and strips
    LinkArrays links;
    QuadArrays quads;
    float* reactions = nullptr;  ///< N s², three times N per position, where bundles react
    bool yields = false;         ///< something that holds points is moved by what they pull
    float* scratch = nullptr;    ///< for the longest chain or strip
    // What forces that are the same in all substeps of a step do to velocities: v ← keeps v + kicks, by component.
    VectorRow *keeps = nullptr, *kicks = nullptr;
    const AirRow* air = nullptr;
    const float* inverseMasses = nullptr;  ///< 1/kg, of points that nothing holds
    TetherArrays tethers;
};

/// The tension of a link does not turn with it in the equations of chains, as that of an explicit step: where w λ/L
/// passes this, the square of h times the rate at which the link swings across, a taut line would swing ever farther.
inline constexpr float kTautest = 0.5f;  ///< of what an explicit step would bear

struct ClothContext {
    float h = 0, inverseH = 0;  ///< s
    Vec3 gravity;               ///< m/s²
    float damping = 0;          ///< 1/s
    int bendSteps = 0;          ///< small steps that bends act for in this one; zero: none
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

/// Points that are to be met with a surface, and what comes of it where any of N end nearer than `limit`.
struct Meeting {
    const std::uint32_t* rows = nullptr;  ///< of points, bytes
    int count = 0;                        ///< a multiple of 16
    float limit = 0;                      ///< m
    float* results = nullptr;
    std::uint32_t* hits = nullptr;  ///< first pair of each N with results
};

/// What air does to each corner of faces of three or four.
struct FaceArrays {
    const std::uint32_t* corners[4] = {};  ///< rows of points, bytes; the first again where there is no fourth
    const float* shares = nullptr;         ///< of each corner, 1 over their number
    AirRow* air = nullptr;
    int count = 0;  ///< a multiple of 16
    float airDensity = 0, drag = 0, lift = 0;
    Vec3 wind;  ///< m/s
};

struct ClothKernels {
    int lanes;
    /// What forces of this step do to velocities in a small step.
    void (*prepare)(const ClothArrays&, const ClothContext&);
    /// v ← (v + h (g + (G − k v)/m)) / …, x ← x + h v.
    void (*predict)(const ClothArrays&, const ClothContext&);
    /// v ← (x − before)/h.
    void (*finish)(const ClothArrays&, const ClothContext&);
    void (*shear)(const ClothArrays&, int begin, int end, const ClothContext&);
    void (*solve)(const ClothArrays&, int begin, int end, const ClothContext&);
    void (*tether)(const ClothArrays&, const ClothContext&);
    /// The number of hits.
    int (*meet)(const ClothArrays&, const Surface&, const Meeting&);
    void (*blow)(const ClothArrays&, const FaceArrays&);
};

/// Those of `lanes` (4, 8, 16) lanes, as the world's.
const ClothKernels& selectClothKernels(int lanes);

}  // namespace ragtop::cloth
