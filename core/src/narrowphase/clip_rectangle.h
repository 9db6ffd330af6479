#pragma once

#include <cstdint>

/// Clipping in the plane of the face of a box, along its axes.
namespace ragtop::pairs {

/// Of a polygon; named as those of ClipPoint.
struct Corner {
    float u, v, w;  ///< in the plane of the reference face, and above it
    std::uint8_t in, out;
};

/// Keeps sign · (u or v) ≤ half.
template <bool kAlongU>
inline int clipSide(const Corner* in, int count, Corner* out, float sign, float half, float overhang, std::uint8_t code) {
    int kept = 0;
    const Corner* from = &in[count - 1];
    float fromHeight = sign * (kAlongU ? from->u : from->v) - half;
    for (int i = 0; i < count; ++i) {
        const Corner* to = &in[i];
        const float toHeight = sign * (kAlongU ? to->u : to->v) - half;
        const bool fromInside = fromHeight <= overhang, toInside = toHeight <= overhang;
        if (fromInside != toInside) {
            float t = fromHeight / (fromHeight - toHeight);
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            Corner& cut = out[kept++];
            cut.u = from->u + t * (to->u - from->u);
            cut.v = from->v + t * (to->v - from->v);
            cut.w = from->w + t * (to->w - from->w);
            cut.in = fromInside ? from->out : code;
            cut.out = fromInside ? code : from->out;
        }
        if (toInside) out[kept++] = *to;
        from = to;
        fromHeight = toHeight;
    }
    return kept;
}

/// Clips the polygon in the first of two buffers, which have room for four corners more, to a rectangle of half extents
/// hu and hv. `mostU`, `mostV`: farthest of its corners from the axes.
inline void clipToRectangle(Corner* first, Corner* second, int& count, float mostU, float mostV, float hu, float hv,
                            float overhang) {
    if (mostU > hu + overhang) {
        count = clipSide<true>(first, count, second, 1, hu, overhang, 128);
        if (count > 0) count = clipSide<true>(second, count, first, -1, hu, overhang, 129);
    }
    if (count > 0 && mostV > hv + overhang) {
        count = clipSide<false>(first, count, second, 1, hv, overhang, 130);
        if (count > 0) count = clipSide<false>(second, count, first, -1, hv, overhang, 131);
    }
}

}  // namespace ragtop::pairs
