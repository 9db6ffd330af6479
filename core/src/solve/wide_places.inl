// Where the points of contacts are at the beginning of a step, and which of them touched at its end. Included by
// wide_kernels.inl.

namespace ragtop {
namespace {

/// Four rows of eight floats per manifold, in the order of ManifoldAnchors.
template <int N>
struct WideAnchors {
    Lanes<N> f[32];

    RAGTOP_INLINE explicit WideAnchors(const float* const rows[N]) {
        for (int part = 0; part < 4; ++part) {
            const float* at[N];
            for (int i = 0; i < N; ++i) at[i] = rows[i] + 8 * part;
            gather8<N>(at, f + 8 * part);
        }
    }
    RAGTOP_INLINE WideVec3<N> vector(int i) const { return {f[i], f[i + 1], f[i + 2]}; }
    RAGTOP_INLINE WideVec3<N> normal() const { return vector(0); }
    RAGTOP_INLINE WideVec3<N> anchorA(int point) const { return vector(4 + 3 * point); }
    RAGTOP_INLINE WideVec3<N> anchorB(int point) const { return vector(16 + 3 * point); }
    RAGTOP_INLINE Lanes<N> separation(int point) const { return f[28 + point]; }
};

RAGTOP_INLINE const char* rowOf(const void* first, std::size_t stride, std::uint32_t index) {
    return static_cast<const char*>(first) + stride * index;
}

RAGTOP_INLINE const char* manifoldAt(const ContactPlaces& places, std::uint32_t index) {
    return rowOf(places.manifoldPages[index >> places.pageBits], places.manifoldStride,
                 index & ((1u << places.pageBits) - 1));
}

/// Finds the anchors in the lanes of a bundle; lanes without a contact have none.
template <int N>
RAGTOP_INLINE void findAnchors(int bundle, const LaneManifolds& list, const ContactPlaces& places,
                               const float* anchors[N]) {
    alignas(64) static constexpr float kNothing[32] = {};
    const int slot = bundle * list.perBundle, left = list.count - slot;
    const int used = left < list.perBundle ? left : list.perBundle;
    for (int lane = 0; lane < N; ++lane)
        anchors[lane] =
            lane < used ? reinterpret_cast<const float*>(manifoldAt(places, list.manifolds[slot + lane])) : kNothing;
}

/// Asks for what placing a bundle will read, whose fields are there already.
template <int N>
RAGTOP_INLINE void prefetchPlaces(const float* bundles, int i, const LaneManifolds& list, const ContactPlaces& places) {
    if (i * list.perBundle >= list.count) return;
    const float* anchors[N];
    findAnchors<N>(i, list, places, anchors);
    const float* bundle = bundles + static_cast<long>(i) * contact::kFields * N;
    const auto* recordA = reinterpret_cast<const std::uint32_t*>(bundle + contact::kRecordA * N);
    const auto* recordB = reinterpret_cast<const std::uint32_t*>(bundle + contact::kRecordB * N);
    for (int lane = 0; lane < N; ++lane) {
        __builtin_prefetch(anchors[lane]);
        __builtin_prefetch(anchors[lane] + 16);
        __builtin_prefetch(rowOf(places.centers, places.bodyStride, recordA[lane]));
        __builtin_prefetch(rowOf(places.centers, places.bodyStride, recordB[lane]));
    }
}

/// n = RA n_A,  pA = xA + RA a,  pB = xB + RB b,  C = C₀ + n · (pB − pA); the point is half way between pA and pB.
template <int N>
void placeContacts(float* bundles, int begin, int end, const LaneManifolds& list, const ContactPlaces& places) {
    constexpr int kPlaces = 2;  // bundles ahead, by trial
    const float* anchors[N];
    int points = contact::kMaxPoints;  // of the last bundle
    for (int i = begin; i < end; ++i) {
        float* bundle = bundles + static_cast<long>(i) * contact::kFields * N;
        prefetchFields<N>(bundle, 0, contact::kPoints + points * contact::kPointFields);
        prefetchFields<N>(bundle, contact::kRecordA, contact::kFields);
        prefetchPlaces<N>(bundles, i + kPlaces, list, places);
        findAnchors<N>(i, list, places, anchors);
        const auto* recordA = reinterpret_cast<const std::uint32_t*>(bundle + contact::kRecordA * N);
        const auto* recordB = reinterpret_cast<const std::uint32_t*>(bundle + contact::kRecordB * N);
        const float *turnsA[N], *turnsB[N];
        alignas(64) float apart[3][N];
        for (int lane = 0; lane < N; ++lane) {
            turnsA[lane] = reinterpret_cast<const float*>(rowOf(places.rotations, places.bodyStride, recordA[lane]));
            turnsB[lane] = reinterpret_cast<const float*>(rowOf(places.rotations, places.bodyStride, recordB[lane]));
            const auto* a = reinterpret_cast<const double*>(rowOf(places.centers, places.bodyStride, recordA[lane]));
            const auto* b = reinterpret_cast<const double*>(rowOf(places.centers, places.bodyStride, recordB[lane]));
            for (int k = 0; k < 3; ++k) apart[k][lane] = static_cast<float>(b[k] - a[k]);
        }
        const WideAnchors<N> found(anchors);
        Lanes<N> rowA[8], rowB[8];
        gather8<N>(turnsA, rowA);
        gather8<N>(turnsB, rowB);
        const WideQuat<N> qA{rowA[0], rowA[1], rowA[2], rowA[3]}, qB{rowB[0], rowB[1], rowB[2], rowB[3]};

        const Lanes<N> zero(0.0f);
        const Mask<N> isStatic{bits(Lanes<N>::load(bundle + contact::kBodyA * N)) == 0};
        const WideVec3<N> between{Lanes<N>::load(apart[0]), Lanes<N>::load(apart[1]), Lanes<N>::load(apart[2])};
        const WideVec3<N> none{zero, zero, zero};
        // A static A has no reference point of its own: anchors are then from the centre of B.
        const WideVec3<N> reference = select(isStatic, between, none), offset = select(isStatic, none, between);
        const WideVec3<N> normal = rotate(qA, found.normal());
        const auto set = [&](int field, const WideVec3<N>& v) {
            v.x.store(bundle + field * N), v.y.store(bundle + (field + 1) * N), v.z.store(bundle + (field + 2) * N);
        };
        set(contact::kNormal, normal);
        set(contact::kOffset, offset);
        const typename Mask<N>::V count = bits(found.f[3]);
        for (points = 0; points < contact::kMaxPoints && anySet(count > points); ++points) {
            const int j = points;
            const WideVec3<N> onA = rotate(qA, found.anchorA(j)) - reference;
            const WideVec3<N> onB = rotate(qB, found.anchorB(j)) + offset;
            set(pointField(j, contact::kAnchor), Lanes<N>(0.5f) * (onA + onB));
            const Lanes<N> separation = found.separation(j) + dot(normal, onB - onA);
            separation.store(bundle + pointField(j, contact::kSeparation) * N);
        }
    }
}

/// A ManifoldTouch per lane; it is unknown where a lane has no points.
template <int N>
void readTouches(const float* bundles, int begin, int end, std::uint8_t* touches) {
    typedef typename Mask<N>::V Int;
    for (int i = begin; i < end; ++i) {
        const float* bundle = bundles + static_cast<long>(i) * contact::kFields * N;
        const auto field = [&](int f) { return Lanes<N>::load(bundle + f * N); };
        const Int count = bits(field(contact::kPointCount));
        Int found = (count == 0) & static_cast<int>(kUnknownTouch);
        prefetchFields<N>(bundle, contact::kPointCount, contact::kPointCount + 1);
        for (int j = 0; j < contact::kMaxPoints && anySet(count > j); ++j) {
            prefetchFields<N>(bundle, pointField(j, contact::kSeparation), pointField(j, contact::kPeak) + 1);
            const Int present = count > j;
            const Mask<N> meets = (field(pointField(j, contact::kSeparation)) <= Lanes<N>(0.0f)) |
                                  (field(pointField(j, contact::kPeak)) > 0.0f);
            const Mask<N> bears = field(pointField(j, contact::kImpulse)) > 0.0f;
            found |= present & ((meets.v & static_cast<int>(kTouches)) | (bears.v & static_cast<int>(kBearsLoad)));
        }
        storeBytes<N>(found, touches + static_cast<long>(i) * N);
    }
}

}  // namespace
}  // namespace ragtop
