#pragma once

#include <cstddef>
#include <cstdint>

#include "narrowphase/manifold.h"
#include "ragtop/math.h"

namespace ragtop {

/// Points of a manifold as anchors in both bodies, and its normal: what moves with the bodies. Two cache lines.
struct alignas(64) ManifoldAnchors {
    Vec3 normal;                  ///< in A's internal frame, from A to B
    std::int32_t pointCount = 0;  ///< absent points have anchors of zero
    Vec3 anchorA[kMaxManifoldPoints], anchorB[kMaxManifoldPoints];  ///< m, in the bodies' internal frames
    float separation[kMaxManifoldPoints] = {};                      ///< m, when found
};
static_assert(sizeof(ManifoldAnchors) == 128);

/// Where bodies are, and manifolds on them: what the first records hold, and how many bytes the next ones are away. Records
/// of manifolds are in pages of 2^pageBits.
/// A rotation is followed by four more floats of its record.
struct ContactPlaces {
    const DVec3* centers;
    const Quat* rotations;
    std::size_t bodyStride;
    const void* const* manifoldPages;
    unsigned pageBits;
    std::size_t manifoldStride;
};

/// The manifolds in the lanes of a colour.
struct LaneManifolds {
    const std::uint32_t* manifolds;
    int count, perBundle;
};

/// Of a manifold after a step: some point carried load or overlaps; some point carried load to the end. That of a body
/// that rests is what it was.
enum ManifoldTouch : std::uint8_t { kTouches = 1, kBearsLoad = 2, kUnknownTouch = 4, kFrozenTouch = 8 };

}  // namespace ragtop
