// Chains of points side by side in lanes: their bends and their lengths.

#include "cloth/cloth_points.inl"

namespace ragtop::cloth {
namespace {

/// A point of a chain and the link to the next, d = x₁ − x₀, from one way along it to the other.
template <int N, bool kTied>
struct WideLink {
    WidePoint<N, kTied> point;
    WideVec3<N> d;    ///< m
    Lanes<N> lambda;  ///< tension over length, N s²/m; on the way down what is eliminated of it
    Lanes<N> upper;   ///< coupling to the link before, over its pivot
    Lanes<N> taut;    ///< times λ: w over how far tension may turn with the link
};
static_assert(sizeof(WideLink<4, true>) == sizeof(float) * kLinkFloats * 4);

/// f of points along a chain, to them and to what holds them.
template <int N, bool kTied, bool kEven>
struct WideChain {
    static constexpr int kLanes = N;
    using Point = WidePoint<N, kTied>;
    using Link = WideLink<N, kTied>;

    const ClothArrays& a;
    const ChainBundle& bundle;
    const BundleRows<N, kEven> rows;
    Link* links;
    bool reacts;

    RAGTOP_INLINE WideChain(const ClothArrays& inA, const ChainBundle& inBundle)
        : a(inA), bundle(inBundle), rows{inA.rows + inBundle.firstPoint, inBundle.rows},
          links(reinterpret_cast<Link*>(inA.scratch)), reacts(inBundle.reacts && inA.yields) {}

    RAGTOP_INLINE void push(WidePoint<N, kTied>& point, int k, const WideVec3<N>& f) const {
        point.push(f);
        if (reacts) addReaction<N>(a.reactions + 3 * (bundle.firstPoint + static_cast<std::uint32_t>(k * N)), f);
    }
    RAGTOP_INLINE void write(int k) const { links[k].point.write(a, rows.at(k)); }
};

/// Reads the points. C = |x₀ − 2 x₁ + x₂| − rest of every three of them [Kelager et al. 2010]: curvature times l²,
/// whose energy over the width that the chain stands for is that of a thin plate.
template <int N, bool kTied, bool kEven>
RAGTOP_INLINE void bendPoints(const WideChain<N, kTied, kEven>& chain, float stiffening) {
    const ClothArrays& a = chain.a;
    const int links = chain.bundle.links;
    WidePoint<N, kTied> p0, p1, p2;
    p0.read(a, chain.rows.at(0));
    p1.read(a, chain.rows.at(1));
    for (int k = 1; k < links; ++k) {
        p2.read(a, chain.rows.at(k + 1));
        const auto slot = chain.bundle.firstLink + static_cast<std::uint32_t>(k * N);
        const Lanes<N> s = Lanes<N>::load(a.links.bendStiffness + slot);
        const WideVec3<N> bend = p0.place() - Lanes<N>(2.0f) * p1.place() + p2.place();
        // Points that are tied are taken for as light as free ones, which is on the safe side.
        Lanes<N> factor =
            s / (s * (p0.inverseMass() + 4.0f * p1.inverseMass() + p2.inverseMass()) + Lanes<N>(stiffening));
        if (a.links.bendLengths) {
            const Lanes<N> length = sqrt(dot(bend, bend));
            factor = factor * (1.0f - divideOrZero(Lanes<N>::load(a.links.bendLengths + slot), length));
        }
        const WideVec3<N> f = -factor * bend, back = Lanes<N>(-2.0f) * f;
        chain.push(p0, k - 1, f);
        chain.push(p1, k, back);
        chain.push(p2, k + 1, f);
        chain.links[k - 1].point = p0;
        p0 = p1;
        p1 = p2;
    }
    chain.links[links - 1].point = p0;
    chain.links[links].point = p1;
}

/// Down the chain: errors, and the elimination of each length from the next. `kReads`: points have yet to be read.
template <bool kReads, int N, bool kTied, bool kEven>
RAGTOP_INLINE void eliminate(const WideChain<N, kTied, kEven>& chain, float stiffening) {
    constexpr float kLeast = 2e-5f;   // of the diagonal
    constexpr float kTiny = 1e-30f;  // m²/kg, of links that are none
    const ClothArrays& a = chain.a;
    const float *lengths = a.links.lengths + chain.bundle.firstLink, *inverse = a.links.inverseLengths + chain.bundle.firstLink;
    const float* compliances = a.links.compliances + chain.bundle.firstLink;
    WideVec3<N> before = wide<N>({});
    Lanes<N> tiedBefore(0.0f), inversePivot(0.0f), y(0.0f);
    const Lanes<N> tiny(kTiny);
    if constexpr (kReads) chain.links[0].point.read(a, chain.rows.at(0));
    for (int k = 0; k < chain.bundle.links; ++k) {
        WideLink<N, kTied>& link = chain.links[k];
        const WidePoint<N, kTied>& from = link.point;
        WidePoint<N, kTied>& to = chain.links[k + 1].point;
        if constexpr (kReads) to.read(a, chain.rows.at(k + 1));
        const Lanes<N> rest = Lanes<N>::load(lengths + k * N), w0 = from.inverseMass(), w1 = to.inverseMass();
        const WideVec3<N> d = select(rest > 0.0f, to.place() - from.place(), wide<N>({}));
        const Lanes<N> squared = dot(d, d), length = sqrt(squared);
        Lanes<N> diagonal = squared * ((1 + kLeast) * (w0 + w1) + stiffening * Lanes<N>::load(compliances + k * N));
        Lanes<N> beside = -w0 * dot(before, d);
        if constexpr (kTied) {
            const Lanes<N> along0 = from.alongTie(d), along1 = to.alongTie(d);
            diagonal = diagonal - along0 * along0 - along1 * along1;
            beside = beside + tiedBefore * along0;
            tiedBefore = along1;
        }
        link.upper = beside * inversePivot;
        inversePivot = 1.0f / max(diagonal - beside * link.upper, tiny);
        y = -((length - rest) * length + beside * y) * inversePivot;
        link.d = d;
        link.lambda = y;
        link.taut = max(w0, w1) * (length * Lanes<N>::load(inverse + k * N));
        before = d;
    }
}

/// Back: tensions, and the most of w λ/L, the square of h times the rate at which a link swings across.
template <int N, bool kTied, bool kEven>
RAGTOP_INLINE Lanes<N> substitute(const WideChain<N, kTied, kEven>& chain) {
    Lanes<N> lambda(0.0f), upper(0.0f), most(0.0f);
    for (int k = chain.bundle.links - 1; k >= 0; --k) {
        WideLink<N, kTied>& link = chain.links[k];
        lambda = link.lambda - upper * lambda;
        upper = link.upper;
        link.lambda = lambda;
        most = max(most, max(lambda, -lambda) * link.taut);
    }
    return most;
}

/// Δx = W Jᵀ λ; `kWrites` when that is all.
template <bool kWrites, int N, bool kTied, bool kEven>
RAGTOP_INLINE void moveByTensions(const WideChain<N, kTied, kEven>& chain) {
    WideVec3<N> pull = wide<N>({});
    for (int k = 0; k < chain.bundle.links; ++k) {
        WideLink<N, kTied>& link = chain.links[k];
        const WideVec3<N> next = link.lambda * link.d;
        chain.push(link.point, k, pull - next);
        if constexpr (kWrites) chain.write(k);
        pull = next;
    }
    chain.push(chain.links[chain.bundle.links].point, chain.bundle.links, pull);
    if constexpr (kWrites) chain.write(chain.bundle.links);
}

/// For chains that are tauter than `kTautest`: what they can bear of their tensions, and then one length after the other, down the chain and back: less exact,
/// and hardly farther off than before.
template <int N, bool kTied, bool kEven>
void projectLinks(const WideChain<N, kTied, kEven>& chain, float stiffening, Lanes<N> most) {
    const int links = chain.bundle.links;
    const float *lengths = chain.a.links.lengths + chain.bundle.firstLink,
                *compliances = chain.a.links.compliances + chain.bundle.firstLink;
    const Mask<N> doubtful = !(most <= Lanes<N>(kTautest));
    const Lanes<N> share = select(doubtful, divideOrZero(Lanes<N>(kTautest), most), Lanes<N>(1.0f));
    for (int k = 0; k < links; ++k) chain.links[k].lambda = share * chain.links[k].lambda;
    moveByTensions<false>(chain);
    for (int visit = 0; visit < 2 * links; ++visit) {
        const int k = visit < links ? visit : 2 * links - 1 - visit;
        WidePoint<N, kTied>&from = chain.links[k].point, &to = chain.links[k + 1].point;
        const Lanes<N> rest = Lanes<N>::load(lengths + k * N);
        const WideVec3<N> d = select(doubtful & (rest > 0.0f), to.place() - from.place(), wide<N>({}));
        const Lanes<N> squared = dot(d, d), length = sqrt(squared);
        Lanes<N> diagonal =
            squared * (from.inverseMass() + to.inverseMass() + stiffening * Lanes<N>::load(compliances + k * N));
        if constexpr (kTied) {
            const Lanes<N> along0 = from.alongTie(d), along1 = to.alongTie(d);
            diagonal = diagonal - along0 * along0 - along1 * along1;
        }
        const WideVec3<N> f = divideOrZero((rest - length) * length, diagonal) * d;
        chain.push(from, k, -f);
        chain.push(to, k + 1, f);
    }
    for (int k = 0; k <= links; ++k) chain.write(k);
}

/// All lengths of a chain at once, as compliant constraints [Macklin et al. 2019] without the error that visiting one
/// after the other leaves: with C = |d| − L, W the inverse masses of points and tensions in units of the length,
/// J = dC/dx |d|,
///
///     (J W Jᵀ + d² α/h²) λ = −C |d|,      Δx = W Jᵀ λ,
///
/// is tridiagonal, as a link shares a point with the next alone: d_kᵀ (W_k + W_k+1 + α/h²) d_k on the diagonal and
/// −d_k−1ᵀ W_k d_k beside it. A chain whose ends are held has one length more than it can meet; `kLeast` keeps what it
/// divides by above rounding.
template <int N, bool kTied, bool kEven>
void solveChain(const ClothArrays& a, const ChainBundle& bundle, const ClothContext& context) {
    const WideChain<N, kTied, kEven> chain(a, bundle);
    const float stiffening = context.inverseH * context.inverseH;
    if (context.bendSteps > 0) {
        bendPoints(chain, stiffening / static_cast<float>(context.bendSteps));
        eliminate<false>(chain, stiffening);
    } else {
        eliminate<true>(chain, stiffening);
    }
    const Lanes<N> most = substitute(chain);
    if (any(!(most <= Lanes<N>(kTautest)))) {
        projectLinks(chain, stiffening, most);
    } else {
        moveByTensions<true>(chain);
    }
}

template <int N>
void solveChains(const ClothArrays& a, int begin, int end, const ClothContext& context) {
    for (int i = begin; i < end; ++i) {
        if (a.chainTied[i]) {
            solveChain<N, true, false>(a, a.chains[i], context);
        } else if (a.chains[i].rows.even) {
            solveChain<N, false, true>(a, a.chains[i], context);
        } else {
            solveChain<N, false, false>(a, a.chains[i], context);
        }
    }
}

}  // namespace
}  // namespace ragtop::cloth
