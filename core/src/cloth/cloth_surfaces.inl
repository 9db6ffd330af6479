// Points side by side in lanes against the surface of one shape.

#include "cloth/cloth_points.inl"

namespace ragtop::cloth {
namespace {

template <int N>
struct WideGap {
    Lanes<N> gap;
    WideVec3<N> normal;  ///< in the frame of the shape
};

/// Spheres are capsules without length.
template <int N>
RAGTOP_INLINE WideGap<N> gapToCapsule(const Surface& s, const WideVec3<N>& p) {
    const Lanes<N> half(s.halfExtents.y);
    const WideVec3<N> d{p.x, p.y - max(min(p.y, half), -half), p.z};
    const Lanes<N> distance = sqrt(dot(d, d));
    WideVec3<N> n = divideOrZero(Lanes<N>(1.0f), distance) * d;
    n = select(distance > 0.0f, n, WideVec3<N>{Lanes<N>(1.0f), Lanes<N>(0.0f), Lanes<N>(0.0f)});
    return {distance - Lanes<N>(s.radius), n};
}

template <int N>
RAGTOP_INLINE WideGap<N> gapToBox(const Surface& s, const WideVec3<N>& p) {
    const Lanes<N> zero(0.0f), one(1.0f);
    const WideVec3<N> sign{select(p.x < 0.0f, -one, one), select(p.y < 0.0f, -one, one), select(p.z < 0.0f, -one, one)};
    const WideVec3<N> over = scale(sign, p) - WideVec3<N>{Lanes<N>(s.halfExtents.x), Lanes<N>(s.halfExtents.y),
                                                          Lanes<N>(s.halfExtents.z)};
    const WideVec3<N> d{max(over.x, zero), max(over.y, zero), max(over.z, zero)};
    const Lanes<N> distance = sqrt(dot(d, d));
    const WideVec3<N> outwards = divideOrZero(one, distance) * d;
    // Inside, the nearest face.
    const Lanes<N> nearest = max(over.x, max(over.y, over.z));
    const Mask<N> isX = over.x >= nearest, isY = (!isX) & (over.y >= nearest), isZ = !(isX | isY);
    const WideVec3<N> face{select(isX, one, zero), select(isY, one, zero), select(isZ, one, zero)};
    const Mask<N> outside = distance > 0.0f;
    return {select(outside, distance, nearest), scale(sign, select(outside, outwards, face))};
}

/// The plane that is farthest below the point: its distance is that of the hull beside faces, and less beside edges.
template <int N>
RAGTOP_INLINE WideGap<N> gapToHull(const Surface& s, const WideVec3<N>& p) {
    WideGap<N> result{Lanes<N>(-1e30f), WideVec3<N>{Lanes<N>(0.0f), Lanes<N>(1.0f), Lanes<N>(0.0f)}};
    for (int i = 0; i < s.planeCount; ++i) {
        const float* plane = s.planes + 4 * i;
        const WideVec3<N> n{Lanes<N>(plane[0]), Lanes<N>(plane[1]), Lanes<N>(plane[2])};
        const Lanes<N> gap = dot(n, p) - Lanes<N>(plane[3]);
        const Mask<N> farther = gap > result.gap;
        result.gap = select(farther, gap, result.gap);
        result.normal = select(farther, n, result.normal);
    }
    return result;
}

template <int N>
RAGTOP_INLINE WideGap<N> gapToPlanes(const float* planes, const WideVec3<N>& p) {
    const WideVec3<N> n{Lanes<N>::load(planes), Lanes<N>::load(planes + kPairs), Lanes<N>::load(planes + 2 * kPairs)};
    return {dot(n, p) - Lanes<N>::load(planes + 3 * kPairs), n};
}

template <int N>
RAGTOP_INLINE WideGap<N> gapTo(const Surface& s, const WideVec3<N>& p, const float* planes) {
    switch (s.kind) {
    case SurfaceKind::capsule: return gapToCapsule(s, p);
    case SurfaceKind::box: return gapToBox(s, p);
    case SurfaceKind::hull: return gapToHull(s, p);
    default: return gapToPlanes(planes, p);
    }
}

/// Gaps where the substep begins, and where its end would be by what both sides move along the normal.
template <int N>
int meetSurface(const ClothArrays& a, const Surface& s, const Meeting& meeting) {
    const WideQuat<N> q{Lanes<N>(s.rotation.x), Lanes<N>(s.rotation.y), Lanes<N>(s.rotation.z), Lanes<N>(s.rotation.w)};
    const WideVec3<N> position = wide<N>(s.position), center = wide<N>(s.center);
    const WideVec3<N> linear = wide<N>(s.linear), angular = wide<N>(s.angular);
    int hits = 0;
    for (int i = 0; i < meeting.count; i += N) {
        const int inBlock = i % kPairs;
        const float* planes = s.pairPlanes ? s.pairPlanes + (i / kPairs) * 4 * kPairs + inBlock : nullptr;
        Lanes<N> point[4], start[4];
        gather4<N>(rowsAt(a.points, meeting.rows + i), point);
        gather4<N>(rowsAt(a.before, meeting.rows + i), start);
        const WideVec3<N> before = vectorOf<N>(start);
        const WideGap<N> near = gapTo<N>(s, inverseRotate(q, before - position), planes);
        const WideVec3<N> n = rotate(q, near.normal);
        const WideVec3<N> moved = vectorOf<N>(point) - before - linear - cross(angular, before - center);
        const Lanes<N> end = near.gap + dot(n, moved);
        if (!any(end < meeting.limit)) continue;
        float* out = meeting.results + (i / kPairs) * kPairFloats + inBlock;
        near.gap.store(out);
        end.store(out + kPairs);
        n.x.store(out + 2 * kPairs);
        n.y.store(out + 3 * kPairs);
        n.z.store(out + 4 * kPairs);
        meeting.hits[hits++] = static_cast<std::uint32_t>(i);
    }
    return hits;
}

}  // namespace
}  // namespace ragtop::cloth
