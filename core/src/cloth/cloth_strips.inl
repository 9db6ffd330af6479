// Strips of quads side by side in lanes: their shear.

#include "cloth/cloth_points.inl"

namespace ragtop::cloth {
namespace {

/// A rung and the quad from it to the next, from one way along the strip to the other.
template <int N, bool kTied>
struct WideQuad {
    WidePoint<N, kTied> a, b;
    WideVec3<N> u, v;  ///< diagonals from a to the next b, and from b to the next a
    Lanes<N> lambda;   ///< N s²/m²; on the way along what is eliminated of it
    Lanes<N> upper;    ///< coupling to the next quad over the pivot
};
static_assert(sizeof(WideQuad<4, true>) == sizeof(float) * kQuadFloats * 4);

template <int N, bool kTied, bool kEven>
struct WideStrip {
    const ClothArrays& a;
    const StripBundle& bundle;
    const BundleRows<N, kEven> rows;
    WideQuad<N, kTied>* quads;
    const bool reacts;

    RAGTOP_INLINE WideStrip(const ClothArrays& inA, const StripBundle& inBundle)
        : a(inA), bundle(inBundle), rows{inA.rows + inBundle.firstPoint, inBundle.rows},
          quads(reinterpret_cast<WideQuad<N, kTied>*>(inA.scratch)), reacts(inBundle.reacts && inA.yields) {}

    RAGTOP_INLINE void read(int k) const {
        quads[k].a.read(a, rows.at(k, 0));
        quads[k].b.read(a, rows.at(k, 1));
    }
    RAGTOP_INLINE void push(WidePoint<N, kTied>& point, int rung, int end, const WideVec3<N>& f) const {
        point.push(f);
        point.write(a, rows.at(rung, end));
        if (!reacts) return;
        const auto position = static_cast<std::uint32_t>((2 * rung + end) * N);
        addReaction<N>(a.reactions + 3 * (bundle.firstPoint + position), f);
    }
};

/// Along the strip: errors, and the elimination of each shear from the next. Points that are tied are taken for as light
/// as free ones, which is on the safe side.
template <int N, bool kTied, bool kEven>
RAGTOP_INLINE void eliminateShears(const WideStrip<N, kTied, kEven>& strip, float stiffening) {
    const std::uint32_t first = strip.bundle.firstQuad;
    WideVec3<N> uBefore = wide<N>({}), vBefore = uBefore;
    Lanes<N> y(0.0f), scaled(0.0f);  // of the quad before; the latter is its stiffness over its pivot
    strip.read(0);
    for (int k = 0; k < strip.bundle.quads; ++k) {
        strip.read(k + 1);
        WideQuad<N, kTied>& quad = strip.quads[k];
        const WideQuad<N, kTied>& next = strip.quads[k + 1];
        const Lanes<N> s = Lanes<N>::load(strip.a.quads.stiffness + first + k * N);
        const WideVec3<N> u = next.b.place() - quad.a.place(), v = next.a.place() - quad.b.place();
        const Lanes<N> uu = dot(u, u), vv = dot(v, v);
        const Lanes<N> error = uu - vv - Lanes<N>::load(strip.a.quads.rests + first + k * N);
        const Lanes<N> wa = quad.a.inverseMass(), wb = quad.b.inverseMass();
        const Lanes<N> beside = 4.0f * (wa * dot(vBefore, u) + wb * dot(uBefore, v));
        if (k > 0) strip.quads[k - 1].upper = scaled * beside;
        const Lanes<N> yielding =
            4.0f * ((wa + next.b.inverseMass()) * uu + (wb + next.a.inverseMass()) * vv) - scaled * beside * beside;
        scaled = s / (s * yielding + Lanes<N>(stiffening));
        y = -(error + beside * y) * scaled;
        quad.u = uBefore = u;
        quad.v = vBefore = v;
        quad.lambda = y;
    }
}

/// Back: multipliers, and the share of them by which no diagonal turns too far (kTautest).
template <int N, bool kTied, bool kEven>
RAGTOP_INLINE Lanes<N> substituteShears(const WideStrip<N, kTied, kEven>& strip) {
    Lanes<N> lambda = strip.quads[strip.bundle.quads - 1].lambda, most(0.0f);
    for (int k = strip.bundle.quads - 1; k >= 0; --k) {
        WideQuad<N, kTied>& quad = strip.quads[k];
        if (k < strip.bundle.quads - 1) lambda = quad.lambda - quad.upper * lambda;
        quad.lambda = lambda;
        most = max(most, max(lambda, -lambda) * max(quad.a.inverseMass(), quad.b.inverseMass()));
    }
    const Lanes<N> bearable(0.5f * kTautest);
    return select(most > bearable, divideOrZero(bearable, most), Lanes<N>(1.0f));
}

/// C = |u|² − |v|² − rest of the diagonals u and v of a quad: four times its area times the sine of the shear γ, so that
/// ½ k C² with k = G/(16 A) is ½ G γ² A. What stretches both sides alike does nothing to it. All of a strip at once,
///
///     (k J W Jᵀ + 1/h²) λ = −k C,      Δx = W Jᵀ λ,
///
/// as lengths of chains: each quad shares two points with the next.
template <int N, bool kTied, bool kEven>
void shearStrip(const ClothArrays& a, const StripBundle& bundle, float stiffening) {
    const WideStrip<N, kTied, kEven> strip(a, bundle);
    eliminateShears(strip, stiffening);
    const Lanes<N> twice = 2.0f * substituteShears(strip);
    WideVec3<N> toA = wide<N>({}), toB = toA;
    for (int k = 0; k < bundle.quads; ++k) {
        WideQuad<N, kTied>& quad = strip.quads[k];
        const Lanes<N> lambda = twice * quad.lambda;
        const WideVec3<N> alongU = lambda * quad.u, alongV = lambda * quad.v;
        strip.push(quad.a, k, 0, toA - alongU);
        strip.push(quad.b, k, 1, toB + alongV);
        toA = -alongV;
        toB = alongU;
    }
    strip.push(strip.quads[bundle.quads].a, bundle.quads, 0, toA);
    strip.push(strip.quads[bundle.quads].b, bundle.quads, 1, toB);
}

template <int N>
void shearStrips(const ClothArrays& a, int begin, int end, const ClothContext& context) {
    const float stiffening = context.inverseH * context.inverseH;
    for (int i = begin; i < end; ++i) {
        if (a.stripTied[i]) {
            shearStrip<N, true, false>(a, a.strips[i], stiffening);
        } else if (a.strips[i].rows.even) {
            shearStrip<N, false, true>(a, a.strips[i], stiffening);
        } else {
            shearStrip<N, false, false>(a, a.strips[i], stiffening);
        }
    }
}

}  // namespace
}  // namespace ragtop::cloth
