// Points, chains and faces of cloth side by side in lanes. Included by one source per instruction set.

#include "cloth/cloth_chains.inl"
#include "cloth/cloth_surfaces.inl"

namespace ragtop::cloth {
namespace {

/// v ← (v + h (g + (G − k v₀)/m))/((1 + h k/m)(1 + h d)) as a change, so that what resists is implicit.
template <int N>
void predictPoints(const ClothArrays& a, const ClothContext& context) {
    const WideVec3<N> fall = Lanes<N>(context.h) * wide<N>(context.gravity);
    const Lanes<N> kept = 1.0f / (1.0f + context.h * context.damping);
    for (int i = 0; i < a.pointCount; i += N) {
        Lanes<N> point[8], motion[8];
        PointRow* rows = a.points + i;
        gather8<N>(RowsInOrder<N, const PointRow>{rows}, point);
        gather8<N>(RowsInOrder<N, const MotionRow>{a.motions + i}, motion);
        const Lanes<N> hw = context.h * point[3];
        const WideVec3<N> v{motion[4], motion[5], motion[6]};
        const Lanes<N> k = Lanes<N>::load(a.resistance + i);
        const WideVec3<N> force =
            WideVec3<N>{Lanes<N>::load(a.drive[0] + i), Lanes<N>::load(a.drive[1] + i), Lanes<N>::load(a.drive[2] + i)} -
            k * v;
        const WideVec3<N> change = (1.0f / (1.0f + hw * k)) * (fall + hw * force);
        const WideVec3<N> next = kept * (v + change);
        motion[0] = point[0];
        motion[1] = point[1];
        motion[2] = point[2];
        const WideVec3<N> place = WideVec3<N>{point[0], point[1], point[2]} + Lanes<N>(context.h) * next;
        store(place, point);
        for (int f = 4; f < 8; ++f) point[f] = Lanes<N>(0.0f);
        motion[4] = next.x;
        motion[5] = next.y;
        motion[6] = next.z;
        scatterAll8<N>(RowsInOrder<N, PointRow>{rows}, point);
        scatterAll8<N>(RowsInOrder<N, MotionRow>{a.motions + i}, motion);
    }
}

template <int N>
void finishPoints(const ClothArrays& a, const ClothContext& context) {
    for (int i = 0; i < a.pointCount; i += N) {
        Lanes<N> point[8], motion[8];
        gather8<N>(RowsInOrder<N, const PointRow>{a.points + i}, point);
        gather8<N>(RowsInOrder<N, const MotionRow>{a.motions + i}, motion);
        for (int f = 0; f < 3; ++f) motion[4 + f] = context.inverseH * (point[f] - motion[f]);
        scatterAll8<N>(RowsInOrder<N, MotionRow>{a.motions + i}, motion);
    }
}

/// One-sided lengths to points that are held [Kim et al. 2012]: λ = −max(0, |x − a| − L)/(eᵀ W e), Δx = W e λ.
template <int N>
void tetherPoints(const ClothArrays& a, const ClothContext&) {
    for (int i = 0; i < a.tetherCount; i += N) {
        const PointRows<N> rows{a.points, a.tethered + i}, anchorRows{a.points, a.anchors + i};
        Lanes<N> point[8], anchor[8];
        gather8<N>(rows, point);
        gather8<N>(anchorRows, anchor);
        const WideVec3<N> d = placeOf(point) - placeOf(anchor), s = heldOf(point);
        const Lanes<N> distance = sqrt(dot(d, d));
        const Lanes<N> over = max(distance - Lanes<N>::load(a.tetherLengths + i), Lanes<N>(0.0f));
        const WideVec3<N> e = divideOrZero(Lanes<N>(1.0f), distance) * d;
        const Lanes<N> along = dot(s, e);
        const Lanes<N> lambda = divideOrZero(over, point[3] - along * along);
        const WideVec3<N> f = -lambda * e;
        addForce(point, f);
        scatterAll8<N>(rows, point);
        (-f.x).store(a.tetherPulls[0] + i);
        (-f.y).store(a.tetherPulls[1] + i);
        (-f.z).store(a.tetherPulls[2] + i);
    }
}

/// Drag and lift of a face with normal n towards the wind u that it feels [Bridson et al. 2003]:
///     F = ½ ρ A (u·n) (C_D u + C_L (|u| n − (u·n) u/|u|)).
template <int N>
void blowFaces(const ClothArrays& a, const FaceArrays& faces) {
    const WideVec3<N> wind = wide<N>(faces.wind);
    for (int i = 0; i < faces.count; i += N) {
        WideVec3<N> x[3], v = wide<N>({});
        for (int c = 0; c < 3; ++c) {
            Lanes<N> point[8], motion[8];
            gather8<N>(PointRows<N>{a.points, faces.corners[c] + i}, point);
            gather8<N>(NumberedRows<const MotionRow, N>{a.motions, faces.corners[c] + i}, motion);
            x[c] = placeOf(point);
            v = v + WideVec3<N>{motion[4], motion[5], motion[6]};
        }
        const WideVec3<N> u = wind - Lanes<N>(1.0f / 3) * v;
        const WideVec3<N> normal = cross(x[1] - x[0], x[2] - x[0]);
        const Lanes<N> twiceArea = sqrt(dot(normal, normal)), speed = sqrt(dot(u, u));
        WideVec3<N> n = divideOrZero(Lanes<N>(1.0f), twiceArea) * normal;
        n = select(dot(u, n) < 0.0f, -n, n);
        const Lanes<N> across = dot(u, n), quarter = (0.25f * faces.airDensity) * twiceArea * across;
        const WideVec3<N> lift = speed * n - divideOrZero(across, speed) * u;
        const WideVec3<N> force = quarter * (Lanes<N>(faces.drag) * u + Lanes<N>(faces.lift) * lift);
        force.x.store(faces.force[0] + i);
        force.y.store(faces.force[1] + i);
        force.z.store(faces.force[2] + i);
        ((2 * (faces.drag + faces.lift)) * quarter).store(faces.resistance + i);
    }
}

template <int N>
constexpr ClothKernels makeClothKernels() {
    return {N,
            predictPoints<N>,
            finishPoints<N>,
            bendChains<N>,
            solveChains<N>,
            tetherPoints<N>,
            meetSurface<N>,
            blowFaces<N>};
}

}  // namespace
}  // namespace ragtop::cloth
