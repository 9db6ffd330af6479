// Bodies far inside each other go apart by places. Included by wide_kernels.inl.

#include "constraints/contact_layout.h"
#include "solve/kernel_table.h"
#include "solve/lanes.h"

namespace ragtop {
namespace {

/// Of what is beyond kInside; per step.
constexpr float kInsideLeft = 0.4f;

/// Moves the bodies of contacts that are deeper than kInside, and were when the step began, apart along the normal, by
/// their masses, without turning them and without any speed, so that nothing flies:
///
///     d = min(share (−C − inside), most),   xA ← xA − mB/(mA + mB) d n,   xB ← xB + mA/(mA + mB) d n.
template <int N, int L, bool kGround>
RAGTOP_INLINE void moveApart(const ContactBundle<N, L, kGround>& c, Lanes<N> deepest, const SolverContext& context) {
    const Lanes<N> zero(0.0f), size = c.field(contact::kSize);
    const Lanes<N> beyond = -deepest - Lanes<N>(contact::kInside) * size;
    const Mask<N> inside = beyond > zero;
    if (!any(inside)) return;
    const float ofStep = context.h / context.dt;
    const Lanes<N> way = min(Lanes<N>(kInsideLeft * ofStep) * beyond, Lanes<N>(contact::kInsideMost * ofStep) * size);
    const WideVec3<N> apart = select(inside, divideOrZero(way, c.inverseMass()), zero) * c.normal;
    if constexpr (!kGround) {
        WideVec3<N> dpA = (-c.massA) * apart;
        applyLocks(dpA, c.a[7]);
        c.displace(contact::kBodyA, dpA, c.massA);
    }
    WideVec3<N> dpB = c.massB * apart;
    applyLocks(dpB, c.b[7]);
    c.displace(contact::kBodyB, dpB, c.massB);
}

}  // namespace
}  // namespace ragtop
