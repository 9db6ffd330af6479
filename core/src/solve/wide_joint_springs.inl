// Shares of springs and dampers, in lanes: the operations of constraints/spring_shares.cpp, in double as there.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

template <int N>
struct DoubleTypes;
template <>
struct DoubleTypes<4> {
    typedef double Double __attribute__((vector_size(32)));
    typedef long long Int __attribute__((vector_size(32)));
};
template <>
struct DoubleTypes<8> {
    typedef double Double __attribute__((vector_size(64)));
    typedef long long Int __attribute__((vector_size(64)));
};
template <>
struct DoubleTypes<16> {
    typedef double Double __attribute__((vector_size(128)));
    typedef long long Int __attribute__((vector_size(128)));
};

/// N doubles, which only what needs them uses.
template <int N>
struct WideDouble {
    using V = typename DoubleTypes<N>::Double;
    using Int = typename DoubleTypes<N>::Int;
    V v;

    WideDouble() = default;
    RAGTOP_INLINE WideDouble(V a) : v(a) {}
    RAGTOP_INLINE WideDouble(double a) : v(a - V{}) {}
    RAGTOP_INLINE explicit WideDouble(Lanes<N> a) : v(__builtin_convertvector(a.v, V)) {}
    RAGTOP_INLINE Lanes<N> rounded() const { return __builtin_convertvector(v, typename Lanes<N>::V); }
};
template <int N>
RAGTOP_INLINE WideDouble<N> operator+(WideDouble<N> a, WideDouble<N> b) {
    return a.v + b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> operator-(WideDouble<N> a, WideDouble<N> b) {
    return a.v - b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> operator*(WideDouble<N> a, WideDouble<N> b) {
    return a.v * b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> operator/(WideDouble<N> a, WideDouble<N> b) {
    return a.v / b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> operator*(double a, WideDouble<N> b) {
    return a * b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> operator+(double a, WideDouble<N> b) {
    return a + b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> operator-(double a, WideDouble<N> b) {
    return a - b.v;
}
template <int N>
RAGTOP_INLINE WideDouble<N> select(typename WideDouble<N>::Int m, WideDouble<N> a, WideDouble<N> b) {
    return inPieces<typename WideDouble<N>::V>(Chosen{}, m, a.v, b.v);
}
template <int N>
RAGTOP_INLINE typename WideDouble<N>::Int operator>(WideDouble<N> a, WideDouble<N> b) {
    return inPieces<typename WideDouble<N>::Int>(Above{}, a.v, b.v);
}
template <int N>
RAGTOP_INLINE typename WideDouble<N>::Int operator>(WideDouble<N> a, double b) {
    return a > WideDouble<N>(b);
}
template <int N>
RAGTOP_INLINE WideDouble<N> sqrt(WideDouble<N> a) {
    for (int i = 0; i < N; ++i) a.v[i] = __builtin_sqrt(a.v[i]);
    return a;
}
/// Of a mask of doubles.
template <int N, class Int>
RAGTOP_INLINE bool anyOf(Int m) {
    long long set = 0;
    for (int i = 0; i < N; ++i) set |= m[i];
    return set != 0;
}

/// As fading: 1 − e^{−x}.
template <int N>
RAGTOP_INLINE WideDouble<N> fading(WideDouble<N> x) {
    typedef typename WideDouble<N>::Int Int;
    const Int whole = x > 60.0;
    x = select(whole, WideDouble<N>(0.0), x);
    Int halvings = whole ^ whole;
    for (Int large = x > 0.125; anyOf<N>(large); large = x > 0.125) {
        x = select(large, 0.5 * x, x);
        halvings -= large;
    }
    WideDouble<N> term = x, sum = x;
    for (int k = 2; k <= 8; ++k) {
        term = term * (WideDouble<N>(-x.v) / WideDouble<N>(static_cast<double>(k)));
        sum = sum + term;
    }
    for (Int left = halvings; anyOf<N>(left); halvings -= 1) {
        left = inPieces<Int>(Above{}, halvings, Int{});
        sum = select(left, sum * (2.0 - sum), sum);
    }
    return select(whole, WideDouble<N>(1.0), sum);
}

/// As exactShares, with the resting share above the least.
template <int N>
RAGTOP_INLINE void exactShares(WideDouble<N> z, WideDouble<N> x, WideDouble<N>& moving, WideDouble<N>& resting) {
    typedef typename WideDouble<N>::Int Int;
    const WideDouble<N> least(kLeastShare), one(1.0), zero(0.0);
    const WideDouble<N> wholeLoss = fading(x);
    const WideDouble<N> damping = select(x > 1e-6, wholeLoss / x, 1.0 - 0.5 * x);
    const WideDouble<N> a = 0.5 * x, under = z - a * a;
    const Int isSpring = z > 1e-12, swings = under > 0.0;

    const WideDouble<N> root = sqrt(select(swings, under, zero - under));
    const WideDouble<N> lost = fading(select(swings, a, z / (a + root))), left = 1.0 - lost;
    const WideDouble<N> half = 0.5 * root, s = half * half;
    const WideDouble<N> sine =
        half - half * s * (1.0 / 6 - s * (1.0 / 120 - s * (1.0 / 5040 - s * WideDouble<N>(1.0 / 362880))));
    const WideDouble<N> swinging = (lost * lost + 4.0 * left * sine * sine) / z;
    const WideDouble<N> most = 1.0 - wholeLoss, slow = select(most > least, most, least);
    const WideDouble<N> creeping = lost * (1.0 - slow / (1.0 - lost)) / z;
    moving = select(isSpring, select(swings, swinging, creeping), damping);
    resting = select(isSpring, select(swings, left * left, slow), 1.0 - wholeLoss);
    resting = select(resting > least, resting, least);
}

/// As springShares. Long, and the same for all rows: not to be inlined.
template <int N>
__attribute__((noinline)) SpringSharesOf<Lanes<N>> springShares(const Lanes<N>& stiffness, const Lanes<N>& damping,
                                                     const Lanes<N>& inverseMass, float h) {
    typedef typename WideDouble<N>::Int Int;
    const WideDouble<N> w(inverseMass), step(static_cast<double>(h)), one(1.0);
    const WideDouble<N> z = step * step * WideDouble<N>(stiffness) * w, x = step * WideDouble<N>(damping) * w;
    const Int slow = inPieces<Int>(AtLeast{}, one.v, z.v);
    const WideDouble<N> clipped = select(slow, x, x / sqrt(z));
    WideDouble<N> moving, resting;
    exactShares(select(slow, z, one), clipped, moving, resting);
    const WideDouble<N> excess = (z - one) + (x - clipped);
    return {select(slow, moving, one / (one / moving + excess)).rounded(),
            select(slow, resting, one / (one / resting + excess)).rounded()};
}
}  // namespace
}  // namespace ragtop
