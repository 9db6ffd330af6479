// Chains of points side by side in lanes: their lengths and their bends.

#include "cloth/cloth_kernels.h"
#include "solve/lane_rows.h"

namespace ragtop::cloth {
namespace {

template <int N>
using PointRows = NumberedRows<PointRow, N>;

/// Rows one after the other.
template <int N, class Row>
struct RowsInOrder {
    using Float = std::conditional_t<std::is_const_v<Row>, const float, float>;
    Row* rows;
    RAGTOP_INLINE Float* operator[](int i) const { return reinterpret_cast<Float*>(rows + i); }
};

template <int N>
RAGTOP_INLINE WideVec3<N> wide(const Vec3& a) {
    return {Lanes<N>(a.x), Lanes<N>(a.y), Lanes<N>(a.z)};
}
template <int N>
RAGTOP_INLINE WideVec3<N> placeOf(const Lanes<N> (&point)[8]) {
    return {point[0], point[1], point[2]};
}
template <int N>
RAGTOP_INLINE WideVec3<N> heldOf(const Lanes<N> (&point)[8]) {
    return {point[4], point[5], point[6]};
}
template <int N>
RAGTOP_INLINE void store(const WideVec3<N>& place, Lanes<N> (&point)[8]) {
    point[0] = place.x;
    point[1] = place.y;
    point[2] = place.z;
}
/// x ← x + W f.
template <int N>
RAGTOP_INLINE void addForce(Lanes<N> (&point)[8], const WideVec3<N>& f) {
    const WideVec3<N> s = heldOf(point);
    const Lanes<N> pull = dot(s, f);
    store(placeOf(point) + point[3] * f - pull * s, point);
    point[7] = point[7] + pull;
}

/// Adds to what a position of a bundle was given.
template <int N>
RAGTOP_INLINE void addReaction(const ClothArrays& a, const ChainBundle& bundle, int position, const WideVec3<N>& f) {
    float* to = a.reactions + 3 * (bundle.firstPoint + static_cast<std::uint32_t>(position * N));
    (Lanes<N>::load(to) + f.x).store(to);
    (Lanes<N>::load(to + N) + f.y).store(to + N);
    (Lanes<N>::load(to + 2 * N) + f.z).store(to + 2 * N);
}

/// A point of a chain, and the link to the next, from one way along it to the other.
template <int N>
struct WideLink {
    Lanes<N> point[8];
    WideVec3<N> e;         ///< unit, along the link
    Lanes<N> rest;         ///< m
    Lanes<N> y;            ///< −C eliminated
    Lanes<N> upper;        ///< coupling to the link before, over its pivot
    WideVec3<N> force, move;  ///< of the point, N s² and m
};

/// Down the chain: errors, and the elimination of each length from the next.
template <int N>
RAGTOP_INLINE void eliminate(const ClothArrays& a, const ChainBundle& bundle, float stiffening, WideLink<N>* links) {
    constexpr float kLeast = 2e-5f;  // of the diagonal
    const std::uint32_t* numbers = a.numbers + bundle.firstPoint;
    const float *lengths = a.lengths + bundle.firstLink, *compliances = a.compliances + bundle.firstLink;
    gather8<N>(PointRows<N>{a.points, numbers}, links[0].point);
    WideVec3<N> before = wide<N>({});
    Lanes<N> fromHeldBefore(0.0f), inversePivot(0.0f), y(0.0f);
    const Lanes<N> none(0.0f), one(1.0f);
    for (int k = 0; k < bundle.links; ++k) {
        WideLink<N>& link = links[k];
        const Lanes<N>(&from)[8] = link.point;
        Lanes<N>(&to)[8] = links[k + 1].point;
        gather8<N>(PointRows<N>{a.points, numbers + (k + 1) * N}, to);
        const WideVec3<N> d = placeOf(to) - placeOf(from);
        const Lanes<N> length = sqrt(dot(d, d)), rest = Lanes<N>::load(lengths + k * N);
        const Mask<N> isLink = rest > 0.0f;
        const WideVec3<N> e = select(isLink, divideOrZero(one, length), none) * d;
        const Lanes<N> error = select(isLink, length - rest, none);
        const Lanes<N> fromHeld = dot(heldOf(from), e), toHeld = dot(heldOf(to), e);
        const Lanes<N> both = from[3] + to[3];
        const Lanes<N> diagonal = both - fromHeld * fromHeld - toHeld * toHeld +
                                  stiffening * Lanes<N>::load(compliances + k * N) + kLeast * both;
        const Lanes<N> beside = fromHeldBefore * fromHeld - from[3] * dot(before, e);
        link.upper = beside * inversePivot;
        inversePivot = one / (diagonal - beside * link.upper);
        y = (-error - beside * y) * inversePivot;
        link.e = e;
        link.rest = rest;
        link.y = y;
        before = e;
        fromHeldBefore = toHeld;
    }
}

/// Back: how points would move, and for which chains that can be trusted. The tension of a link does not turn with it in
/// these equations, as that of an explicit step: where w λ/L, the square of h times the rate at which the link swings
/// across, passes `kTaut`, a taut line would swing ever farther.
template <int N>
RAGTOP_INLINE Mask<N> substitute(int count, WideLink<N>* links) {
    constexpr float kTaut = 0.5f;  // of what an explicit step would bear
    Lanes<N> lambda(0.0f), upper(0.0f), most(0.0f);
    WideVec3<N> pull = wide<N>({});
    for (int k = count; k >= 0; --k) {
        WideLink<N>& link = links[k];
        link.force = -pull;
        if (k > 0) {
            const WideLink<N>& before = links[k - 1];
            lambda = before.y - upper * lambda;
            const Lanes<N> lighter = max(link.point[3], before.point[3]);
            most = max(most, divideOrZero(lighter * max(lambda, -lambda), before.rest));
            pull = lambda * before.e;
            upper = before.upper;
            link.force = link.force + pull;
        }
        const WideVec3<N> s = heldOf(link.point);
        link.move = link.point[3] * link.force - dot(s, link.force) * s;
    }
    return most <= Lanes<N>(kTaut);
}

/// One length after the other, down the chain and back, for those that cannot be trusted otherwise: less exact, and
/// never farther off than before.
template <int N>
void projectLinks(const ClothArrays& a, const ChainBundle& bundle, float stiffening, Mask<N> doubtful,
                  WideLink<N>* links) {
    const float* compliances = a.compliances + bundle.firstLink;
    const Lanes<N> none(0.0f);
    for (int k = 0; k <= bundle.links; ++k) {
        links[k].move = select(doubtful, wide<N>({}), links[k].move);
        links[k].force = select(doubtful, wide<N>({}), links[k].force);
    }
    for (int visit = 0; visit < 2 * bundle.links; ++visit) {
        const int k = visit < bundle.links ? visit : 2 * bundle.links - 1 - visit;
        WideLink<N>&from = links[k], &to = links[k + 1];
        const WideVec3<N> d = placeOf(to.point) + to.move - placeOf(from.point) - from.move;
        const Lanes<N> length = sqrt(dot(d, d));
        const WideVec3<N> e = divideOrZero(Lanes<N>(1.0f), length) * d;
        const Lanes<N> fromHeld = dot(heldOf(from.point), e), toHeld = dot(heldOf(to.point), e);
        const Lanes<N> diagonal = from.point[3] + to.point[3] - fromHeld * fromHeld - toHeld * toHeld +
                                  stiffening * Lanes<N>::load(compliances + k * N);
        const Lanes<N> lambda =
            select(doubtful & (from.rest > 0.0f), divideOrZero(from.rest - length, diagonal), none);
        const WideVec3<N> f = lambda * e;
        from.force = from.force - f;
        to.force = to.force + f;
        from.move = from.move - (from.point[3] * f - lambda * fromHeld * heldOf(from.point));
        to.move = to.move + (to.point[3] * f - lambda * toHeld * heldOf(to.point));
    }
}

/// All lengths of a chain at once, as compliant constraints [Macklin et al. 2019] without the error that visiting one
/// after the other leaves: with C = |d| − L, e = d/|d|, W the inverse masses of points,
///
///     (J W Jᵀ + α/h²) λ = −C,      Δx = W Jᵀ λ,
///
/// is tridiagonal, as a link shares a point with the next alone: e_kᵀ (W_k + W_k+1) e_k + α/h² on the diagonal and
/// −e_k−1ᵀ W_k e_k beside it. A chain whose ends are held has one length more than it can meet; `kLeast` keeps what it
/// divides by above rounding.
template <int N>
void solveChain(const ClothArrays& a, const ChainBundle& bundle, const ClothContext& context) {
    auto* links = reinterpret_cast<WideLink<N>*>(a.scratch);
    const float stiffening = context.inverseH * context.inverseH;
    eliminate<N>(a, bundle, stiffening, links);
    const Mask<N> doubtful = !substitute<N>(bundle.links, links);
    if (any(doubtful)) projectLinks<N>(a, bundle, stiffening, doubtful, links);
    const std::uint32_t* numbers = a.numbers + bundle.firstPoint;
    for (int k = 0; k <= bundle.links; ++k) {
        WideLink<N>& link = links[k];
        store(placeOf(link.point) + link.move, link.point);
        link.point[7] = link.point[7] + dot(heldOf(link.point), link.force);
        scatterAll8<N>(PointRows<N>{a.points, numbers + k * N}, link.point);
        if (bundle.reacts) addReaction(a, bundle, k, link.force);
    }
}

/// C = |x₀ − 2 x₁ + x₂| − rest of every three points along a chain [Kelager et al. 2010]: curvature times l², whose
/// energy over the width that the chain stands for is that of a thin plate.
template <int N>
void bendChain(const ClothArrays& a, const ChainBundle& bundle, const ClothContext& context) {
    const std::uint32_t* numbers = a.numbers + bundle.firstPoint;
    const float stiffening = context.inverseH * context.inverseH;
    Lanes<N> p[3][8];
    gather8<N>(PointRows<N>{a.points, numbers}, p[0]);
    gather8<N>(PointRows<N>{a.points, numbers + N}, p[1]);
    for (int k = 1; k < bundle.links; ++k) {
        gather8<N>(PointRows<N>{a.points, numbers + (k + 1) * N}, p[2]);
        const float* compliance = a.bendCompliances + bundle.firstLink + k * N;
        const WideVec3<N> bend = placeOf(p[0]) - Lanes<N>(2.0f) * placeOf(p[1]) + placeOf(p[2]);
        const Lanes<N> length = sqrt(dot(bend, bend));
        const Lanes<N> error = length - Lanes<N>::load(a.bendLengths + bundle.firstLink + k * N);
        const Lanes<N> lambda =
            error / (p[0][3] + 4.0f * p[1][3] + p[2][3] + stiffening * Lanes<N>::load(compliance));
        const WideVec3<N> f = -divideOrZero(lambda, length) * bend, twice = Lanes<N>(-2.0f) * f;
        const WideVec3<N> given[3] = {f, twice, f};
        for (int i = 0; i < 3; ++i) {
            addForce(p[i], given[i]);
            if (bundle.reacts) addReaction(a, bundle, k - 1 + i, given[i]);
        }
        scatterAll8<N>(PointRows<N>{a.points, numbers + (k - 1) * N}, p[0]);
        for (int f2 = 0; f2 < 8; ++f2) {
            p[0][f2] = p[1][f2];
            p[1][f2] = p[2][f2];
        }
    }
    scatterAll8<N>(PointRows<N>{a.points, numbers + (bundle.links - 1) * N}, p[0]);
    scatterAll8<N>(PointRows<N>{a.points, numbers + bundle.links * N}, p[1]);
}

template <int N>
void solveChains(const ClothArrays& a, int begin, int end, const ClothContext& context) {
    for (int i = begin; i < end; ++i) solveChain<N>(a, a.bundles[i], context);
}
template <int N>
void bendChains(const ClothArrays& a, int begin, int end, const ClothContext& context) {
    for (int i = begin; i < end; ++i)
        if (a.bundles[i].bends) bendChain<N>(a, a.bundles[i], context);
}

}  // namespace
}  // namespace ragtop::cloth
