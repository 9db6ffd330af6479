// Points, chains and faces of cloth side by side in lanes. Included by one source per instruction set.

#include "cloth/cloth_chains.inl"
#include "cloth/cloth_strips.inl"
#include "cloth/cloth_surfaces.inl"

namespace ragtop::cloth {
namespace {

/// v ← (v + h (g + (G − k v)/m))/((1 + h k/m)(1 + h d)), so that what resists is implicit: a share of v and a kick.
template <int N>
void prepareForces(const ClothArrays& a, const ClothContext& context) {
    const WideVec3<N> fall = Lanes<N>(context.h) * wide<N>(context.gravity);
    const float kept = 1.0f / (1.0f + context.h * context.damping);
    for (int i = 0; i < a.pointCount; i += N) {
        Lanes<N> air[4];
        gather4<N>(inOrder<N>(a.air + i), air);
        const Lanes<N> w = Lanes<N>::load(a.inverseMasses + i), hw = context.h * w, none(0.0f);
        const Lanes<N> keeps = kept / (1.0f + hw * air[3]);
        const WideVec3<N> kick = select(w > 0.0f, keeps * (fall + hw * vectorOf<N>(air)), wide<N>({}));
        const Lanes<N> keepRow[4] = {keeps, keeps, keeps, none}, kickRow[4] = {kick.x, kick.y, kick.z, none};
        scatter4<N>(inOrder<N>(a.keeps + i), keepRow);
        scatter4<N>(inOrder<N>(a.kicks + i), kickRow);
    }
}

/// On rows as they lie: what is behind the three components stays as it is.
template <int N>
void predictPoints(const ClothArrays& a, const ClothContext& context) {
    constexpr int kRows = N / 4;
    const Lanes<N> h(context.h);
    for (int i = 0; i < a.pointCount; i += kRows) {
        const Lanes<N> place = loadFlat<N>(a.points + i);
        const Lanes<N> next =
            loadFlat<N>(a.keeps + i) * loadFlat<N>(a.velocities + i) + loadFlat<N>(a.kicks + i);
        storeFlat(place, a.before + i);
        storeFlat(place + h * next, a.points + i);
    }
}

template <int N>
void finishPoints(const ClothArrays& a, const ClothContext& context) {
    constexpr int kRows = N / 4;
    const Lanes<N> inverseH(context.inverseH);
    for (int i = 0; i < a.pointCount; i += kRows)
        storeFlat(inverseH * (loadFlat<N>(a.points + i) - loadFlat<N>(a.before + i)), a.velocities + i);
}

/// One-sided lengths to points that are held [Kim et al. 2012]: λ = −max(0, |x − a| − L)/(eᵀ W e), Δx = W e λ.
template <int N>
RAGTOP_INLINE WideVec3<N> tetherTied(const ClothArrays& a, int i, const WideVec3<N>& d, Lanes<N> squared,
                                     Lanes<N> most) {
    WidePoint<N, true> point;
    gather4<N>(inOrder<N>(a.points + i), point.row);
    gather4<N>(inOrder<N>(a.ties + i), point.tie);
    const Lanes<N> distance = sqrt(squared), none(0.0f);
    const Lanes<N> over = select(squared > most * most, max(distance - most, none), none);
    const WideVec3<N> e = divideOrZero(Lanes<N>(1.0f), distance) * d;
    const Lanes<N> along = point.alongTie(e);
    const WideVec3<N> f = -divideOrZero(over, point.inverseMass() - along * along) * e;
    point.push(f);
    scatter4<N>(inOrder<N>(a.points + i), point.row);
    scatter4<N>(inOrder<N>(a.ties + i), point.tie);
    return -f;
}

template <int N>
void tetherPoints(const ClothArrays& a, const ClothContext&) {
    for (int i = 0; i < a.pointCount; i += N) {
        Lanes<N> point[4], anchor[4];
        gather4<N>(inOrder<N>(a.points + i), point);
        gather4<N>(rowsAt(a.points, a.tethers.anchors + i), anchor);
        const WideVec3<N> d = vectorOf<N>(point) - vectorOf<N>(anchor);
        const Lanes<N> squared = dot(d, d), most = Lanes<N>::load(a.tethers.lengths + i);
        WideVec3<N> pull = wide<N>({});
        if (any(squared > most * most)) pull = tetherTied<N>(a, i, d, squared, most);
        pull.x.store(a.tethers.pulls[0] + i);
        pull.y.store(a.tethers.pulls[1] + i);
        pull.z.store(a.tethers.pulls[2] + i);
    }
}

/// Drag and lift of a face with normal n towards the wind u that it feels [Bridson et al. 2003]:
///     F = ½ ρ A (u·n) (C_D u + C_L (|u| n − (u·n) u/|u|)),
/// the same for each of its corners, as its mass is.
template <int N>
void blowFaces(const ClothArrays& a, const FaceArrays& faces) {
    const WideVec3<N> wind = wide<N>(faces.wind);
    for (int i = 0; i < faces.count; i += N) {
        WideVec3<N> x[4], v[4];
        for (int c = 0; c < 4; ++c) {
            Lanes<N> point[4], velocity[4];
            gather4<N>(rowsAt(a.points, faces.corners[c] + i), point);
            gather4<N>(rowsAt(a.velocities, faces.corners[c] + i), velocity);
            x[c] = vectorOf<N>(point);
            v[c] = vectorOf<N>(velocity);
        }
        const Lanes<N> share = Lanes<N>::load(faces.shares + i);
        v[3] = select(share < 0.3f, v[3], wide<N>({}));
        const WideVec3<N> u = wind - share * (v[0] + v[1] + v[2] + v[3]);
        const WideVec3<N> normal = cross(x[2] - x[0], x[3] - x[1]);
        const Lanes<N> twiceArea = sqrt(dot(normal, normal)), speed = sqrt(dot(u, u));
        WideVec3<N> n = divideOrZero(Lanes<N>(1.0f), twiceArea) * normal;
        n = select(dot(u, n) < 0.0f, -n, n);
        const Lanes<N> across = dot(u, n), quarter = (0.25f * faces.airDensity) * share * twiceArea * across;
        const WideVec3<N> lift = speed * n - divideOrZero(across, speed) * u;
        const WideVec3<N> force = quarter * (Lanes<N>(faces.drag) * u + Lanes<N>(faces.lift) * lift);
        const Lanes<N> row[4] = {force.x, force.y, force.z, (2 * (faces.drag + faces.lift)) * quarter};
        scatter4<N>(inOrder<N>(faces.air + i), row);
    }
}

template <int N>
constexpr ClothKernels makeClothKernels() {
    return {N,
            prepareForces<N>,
            predictPoints<N>,
            finishPoints<N>,
            shearStrips<N>,
            solveChains<N>,
            tetherPoints<N>,
            meetSurface<N>,
            blowFaces<N>};
}

}  // namespace
}  // namespace ragtop::cloth
