// Rows along one coordinate, in lanes: those of constraints/axis_rows.h. Included by wide_joints.inl.

namespace ragtop {
namespace {

/// As Stop.
template <int N>
struct WideStop {
    Lanes<N> restitution, stiffness, damping;
};

}  // namespace

template <int N>
struct JointTypes<Lanes<N>> {
    using Bits = typename Mask<N>::V;
    using Count = typename Mask<N>::V;
    using Stop = WideStop<N>;
};

namespace {

/// A part of the joints as it is in memory.
template <class Part, int N>
RAGTOP_INLINE Part& partAt(const JointFields<N>& j, int field) {
    return *reinterpret_cast<Part*>(j.fields + field * N);
}
template <int N>
RAGTOP_INLINE AxisRowsOf<Lanes<N>>& axisRows(const JointFields<N>& j) {
    static_assert(sizeof(AxisRowsOf<Lanes<N>>) == N * sizeof(AxisRows));
    return partAt<AxisRowsOf<Lanes<N>>>(j, RAGTOP_JOINT_FIELD(axis));
}
template <int N>
RAGTOP_INLINE Mask<N> ofFreeTrees(const JointFields<N>& j) {
    return j.at(RAGTOP_JOINT_FIELD(ofFreeTree)) > 0.0f;
}

/// As setMargins.
template <int N>
struct WideMargins {
    Lanes<N> lower, upper;
};
template <int N>
RAGTOP_INLINE void storeMargins(const JointFields<N>& j, const WideMargins<N>& margins) {
    axisRows(j).atLower.margin = margins.lower;
    axisRows(j).atUpper.margin = margins.upper;
}

/// As beginAxis.
template <int N>
RAGTOP_INLINE Mask<N> beginAxis(const JointFields<N>& j, const WideMargins<N>& margins, Lanes<N> springError,
                                Lanes<N> inverseMass, Lanes<N> speed, Lanes<N> reaction, float h) {
    AxisRowsOf<Lanes<N>>& rows = axisRows(j);
    const std::uint32_t features = j.bundle.features;
    const bool rebounds = j.bundle.rebounds != 0;
    beginRows<Lanes<N>>(rows, features, springError, speed, reaction, inverseMass, h);
    storeMargins(j, margins);
    if (!(features & AxisRows::kLimit)) return inverseMass < Lanes<N>(0.0f);
    return beginHardStop<Lanes<N>>(rows.atLower, rows.stop.restitution, rebounds, speed, h) |
           beginHardStop<Lanes<N>>(rows.atUpper, rows.stop.restitution, rebounds, -speed, h);
}
/// As solveAxis.
template <int N>
RAGTOP_INLINE AxisPassOf<Lanes<N>> solveAxis(const JointFields<N>& j, Lanes<N> inverseMass, Lanes<N> speed,
                                             const JointContext& context, bool moving, Lanes<N> bend) {
    AxisPassOf<Lanes<N>> pass{axisRows(j), j.bundle.features, context, moving, inverseMass, speed,
                              bend,        inverseMass > 0.0f};
    const Mask<N> freeTrees = ofFreeTrees(j);
    const bool rebounds = j.bundle.rebounds != 0;
    pass.drive();
    pass.keep([&](const StopSideOf<Lanes<N>>& side) __attribute__((always_inline)) {
        return aimAtHardStop<Lanes<N>>(side, rebounds, freeTrees, context, moving);
    });
    return pass;
}

}  // namespace
}  // namespace ragtop
