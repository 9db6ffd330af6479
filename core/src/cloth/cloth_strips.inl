// Strips of quads side by side in lanes: their shear.

#include "cloth/cloth_points.inl"

namespace ragtop::cloth {
namespace {

/// A strip on its way along its quads.
template <int N, bool kTied, bool kEven>
struct WideStrip {
    using Point = WidePoint<N, kTied>;
    const ClothArrays& a;
    const StripBundle& bundle;
    const BundleRows<N, kEven> rows;
    const bool reacts;
    Point a0, b0;  ///< the last rung

    RAGTOP_INLINE WideStrip(const ClothArrays& inA, const StripBundle& inBundle)
        : a(inA), bundle(inBundle), rows{inA.rows + inBundle.firstPoint, inBundle.rows},
          reacts(inBundle.reacts && inA.yields) {
        a0.read(a, rows.at(0, 0));
        b0.read(a, rows.at(0, 1));
    }

    RAGTOP_INLINE void push(Point& point, int position, const WideVec3<N>& f) const {
        point.push(f);
        if (reacts) addReaction<N>(a.reactions + 3 * (bundle.firstPoint + static_cast<std::uint32_t>(position * N)), f);
    }

    /// C = |u|² − |v|² − rest of the diagonals u and v of a quad: four times its area times the sine of the shear γ, so
    /// that ½ k C² with k = G/(16 A) is ½ G γ² A. What stretches both sides alike does nothing to it.
    RAGTOP_INLINE void shear(int k, float stiffening) {
        Point a1, b1;
        a1.read(a, rows.at(k + 1, 0));
        b1.read(a, rows.at(k + 1, 1));
        const auto slot = bundle.firstQuad + static_cast<std::uint32_t>(k * N);
        const Lanes<N> s = Lanes<N>::load(a.quads.stiffness + slot);
        const WideVec3<N> u = b1.place() - a0.place(), v = a1.place() - b0.place();
        const Lanes<N> uu = dot(u, u), vv = dot(v, v);
        const Lanes<N> error = uu - vv - Lanes<N>::load(a.quads.rests + slot);
        // Points that are tied are taken for as light as free ones, which is on the safe side.
        const Lanes<N> yielding =
            (a0.inverseMass() + b1.inverseMass()) * uu + (a1.inverseMass() + b0.inverseMass()) * vv;
        const Lanes<N> lambda = (-2.0f * s) * error / ((4.0f * s) * yielding + Lanes<N>(stiffening));
        const WideVec3<N> alongU = lambda * u, alongV = lambda * v;
        push(a0, 2 * k, -alongU);
        push(b1, 2 * k + 3, alongU);
        push(a1, 2 * k + 2, -alongV);
        push(b0, 2 * k + 1, alongV);
        write(k);
        a0 = a1;
        b0 = b1;
    }
    RAGTOP_INLINE void write(int k) const {
        a0.write(a, rows.at(k, 0));
        b0.write(a, rows.at(k, 1));
    }
};

template <int N, bool kTied, bool kEven>
void shearStrip(const ClothArrays& a, const StripBundle& bundle, float stiffening) {
    WideStrip<N, kTied, kEven> strip(a, bundle);
    for (int k = 0; k < bundle.quads; ++k) strip.shear(k, stiffening);
    strip.write(bundle.quads);
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
