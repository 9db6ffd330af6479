// Joints into lanes and back, by transposes. Included by wide_joints.inl.

namespace ragtop {
namespace {

/// Floats of JointSim from a member at `from` up to one at `until`, bytes, and the field of the first.
struct JointRange {
    std::size_t from, until;
    int field;
};

/// The last eight overlap those before them where the range is no multiple of eight.
template <int N, class Copy>
RAGTOP_INLINE void eachEight(const JointRange& range, Copy&& copy) {
    const int count = static_cast<int>((range.until - range.from) / sizeof(float));
    for (int k = 0; k < count; k += 8) {
        const int first = k + 8 <= count ? k : count - 8;
        copy(static_cast<int>(range.from / sizeof(float)) + first, range.field + first);
    }
}
template <int N>
RAGTOP_INLINE void loadRange(const float* const rows[N], float* fields, const JointRange& range) {
    eachEight<N>(range, [&](int from, int field) {
        const float* p[N];
        Lanes<N> columns[8];
        for (int i = 0; i < N; ++i) p[i] = rows[i] + from;
        gather8<N>(p, columns);
        for (int k = 0; k < 8; ++k) columns[k].store(fields + (field + k) * N);
    });
}
template <int N>
RAGTOP_INLINE void storeRange(float* const rows[N], const float* fields, const JointRange& range) {
    eachEight<N>(range, [&](int to, int field) {
        float* p[N];
        Lanes<N> columns[8];
        for (int i = 0; i < N; ++i) p[i] = rows[i] ? rows[i] + to : nullptr;
        for (int k = 0; k < 8; ++k) columns[k] = Lanes<N>::load(fields + (field + k) * N);
        scatter8<N>(p, columns);
    });
}

#define RAGTOP_JOINT_RANGE(first, end) \
    JointRange { offsetof(JointSim, first), offsetof(JointSim, end), RAGTOP_JOINT_FIELD(first) }

template <int N>
void loadJoints(const JointLanesView& view, int begin, int end) {
    for (int b = begin; b < end; ++b) {
        const JointBundle& bundle = view.bundles[b];
        const std::uint32_t* joints = view.joints + b * N;
        float* fields = view.fields + bundle.fields;
        const float* rows[N];
        for (int i = 0; i < N; ++i)
            rows[i] = reinterpret_cast<const float*>(joints[i] == kNoJoint ? view.blank : view.sims[joints[i]]);
        loadRange<N>(rows, fields, RAGTOP_JOINT_RANGE(centerOffset, block.mass));
        if (bundle.kind == JointKind::hinge || bundle.kind == JointKind::distance)
            loadRange<N>(rows, fields, RAGTOP_JOINT_RANGE(axis, axis.inverseMass));
        if (bundle.kind == JointKind::distance)
            loadRange<N>(rows, fields, RAGTOP_JOINT_RANGE(block.basis, block.errorFirst));
        if (bundle.kind != JointKind::ball || bundle.features == 0) continue;
        loadRange<N>(rows, fields, RAGTOP_JOINT_RANGE(ball, ball.springError));
        loadRange<N>(rows, fields, RAGTOP_JOINT_RANGE(ball.swingAxis, ball.swingLimit.corners));
    }
}

template <int N>
void storeJoints(const JointLanesView& view, int begin, int end) {
    for (int b = begin; b < end; ++b) {
        const JointBundle& bundle = view.bundles[b];
        const std::uint32_t* joints = view.joints + b * N;
        const float* fields = view.fields + bundle.fields;
        float* rows[N];
        for (int i = 0; i < N; ++i)
            rows[i] = joints[i] == kNoJoint ? nullptr : reinterpret_cast<float*>(view.sims[joints[i]]);
        storeRange<N>(rows, fields, RAGTOP_JOINT_RANGE(ofFreeTree, block.mass));
        if (bundle.kind == JointKind::hinge || bundle.kind == JointKind::distance) {
            storeRange<N>(rows, fields, RAGTOP_JOINT_RANGE(axis.springImpulse, axis.inverseMass));
            storeRange<N>(rows, fields, RAGTOP_JOINT_RANGE(block.basis, block.errorFirst));
        }
        if (bundle.kind != JointKind::ball || bundle.features == 0) continue;
        storeRange<N>(rows, fields, RAGTOP_JOINT_RANGE(ball.springImpulse, ball.springError));
        storeRange<N>(rows, fields, RAGTOP_JOINT_RANGE(ball.swingAxis, ball.swingLimit));
    }
}

}  // namespace
}  // namespace ragtop
