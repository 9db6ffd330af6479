// What kernels of bodies and of joints share. Included by wide_kernels.inl and wide_joints.inl.

namespace ragtop {
namespace {

template <int N>
using SymmetricMatrix = SymmetricOf<Lanes<N>>;

/// Zeroes what a body's translation locks forbid.
template <int N>
RAGTOP_INLINE void applyLocks(WideVec3<N>& v, Lanes<N> locks) {
    typedef typename Mask<N>::V Int;
    const Int locked = bits(locks);
    if (!any(Mask<N>{locked != 0})) return;
    v.x = select(Mask<N>{(locked & 1) != 0}, Lanes<N>(0.0f), v.x);
    v.y = select(Mask<N>{(locked & 2) != 0}, Lanes<N>(0.0f), v.y);
    v.z = select(Mask<N>{(locked & 4) != 0}, Lanes<N>(0.0f), v.z);
}

template <int N>
RAGTOP_INLINE WideQuat<N> normalized(const WideQuat<N>& q) {
    const Lanes<N> norm = 1.0f / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x * norm, q.y * norm, q.z * norm, q.w * norm};
}

template <int N>
RAGTOP_INLINE Mask<N> isZero(const WideVec3<N>& a) {
    return !((a.x != 0.0f) | (a.y != 0.0f) | (a.z != 0.0f));
}

}  // namespace
}  // namespace ragtop
