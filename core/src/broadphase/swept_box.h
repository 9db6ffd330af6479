#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// A box that moves along a segment, made ready for many tests against fixed bounds: the slab method [Ericson,
/// Real-Time Collision Detection, 2005, 5.3.3] on bounds grown by the box. Rounded so that it never misses [Ize,
/// Robust BVH Ray Traversal, 2013].
struct SweptBox {
    static constexpr float kMiss = 3.4e38f;  ///< farther than any fraction
    static constexpr float kEpsilon = 5.9604645e-8f;  ///< half an ulp of 1

    Vec3 origin;       ///< centre of the box at the start
    Vec3 translation;  ///< of the centre
    Vec3 extents;      ///< half the size of the box, zero for a ray
    Vec3 inverse;      ///< 1 / translation per axis, almost infinite where it does not move

    SweptBox(const Vec3& from, const Vec3& along, const Vec3& halfSize) : origin(from), translation(along) {
        for (int i = 0; i < 3; ++i) {
            const float move = along[i] < 0 ? -along[i] : along[i];
            // A plane that the sweep can reach is at most move + extents away; rounding that distance twice is covered.
            extents[i] = halfSize[i] + 4 * kEpsilon * (move + halfSize[i]);
            // Where nothing moves, planes on one side are reached at once or never; finite, for 0 · ∞ is no number.
            inverse[i] = move > 1e-37f ? 1 / along[i] : kMiss;
        }
    }

    /// Narrows the fractions [from, to] to those at which the box meets the bounds; false when there are none.
    bool clip(const Bounds& bounds, float& from, float& to) const {
        const Vec3 below = (bounds.lower - origin) - extents;
        const Vec3 above = (bounds.upper - origin) + extents;
        const Vec3 one = scale(below, inverse);
        const Vec3 other = scale(above, inverse);
        const Vec3 first = min(one, other);
        const Vec3 last = max(one, other);
        from = larger(larger(first.x, first.y), larger(first.z, from));
        to = smaller(smaller(last.x, last.y), smaller(last.z, to));
        // Each of the two fractions is off by at most three roundings.
        return from <= to * (1 + 8 * kEpsilon) && to >= 0;
    }

    /// The fraction of the way at which the bounds are entered, 0 when they are met at the start, kMiss when they are
    /// not met up to fraction `closer`.
    float enter(const Bounds& bounds, float closer) const {
        float from = 0;
        return clip(bounds, from, closer) ? from : kMiss;
    }

private:
    static constexpr float larger(float a, float b) { return a > b ? a : b; }
    static constexpr float smaller(float a, float b) { return a < b ? a : b; }
};

}  // namespace ragtop
