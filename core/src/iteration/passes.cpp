// The passes of the iteration over constraints, in each substep.

#include <algorithm>
#include <atomic>

#include "constraints/contact_layout.h"
#include "constraints/single_bundle.h"
#include "iteration/iteration.h"

namespace ragtop {

namespace {

/// A list in blocks of `size`, numbered from `first`.
struct Blocks {
    int size, begin, end, first;

    int count() const { return (end - begin + size - 1) / size; }
    int next() const { return first + count(); }
    template <class Visit>
    void visit(int block, Visit&& visit) const {
        const int from = begin + (block - first) * size;
        visit(from, from + size < end ? from + size : end);
    }
};

constexpr int kSettlingIterations =
    16;  ///< that make estimated loads an equilibrium; what is left of their error is local

/// What is in no region: overflow first and serially, then the colours in order, each in parallel: alone(joint) for its
/// single joints, wide(begin, end) and contact(bundles, begin, end) for its bundles.
template <class Joint, class Joints, class Contacts>
void forUndivided(const Iteration& v, Joint&& single, Joints&& wide, Contacts&& contact) {
    constexpr int kJointsPerBlock = 8;  // of a task, by trial
    constexpr int kMostBlocks = 64;     // of contacts: what is next in memory is best solved by the same thread
    const int jointBundlesPerBlock = 32 / v.jointKernels.lanes, leastContactBundles = 32 / v.graph.lanes();
    const auto singles = [&](int begin, int end) {
        for (int i = begin; i < end; ++i) single(v.joints.bundles.single(i));
    };
    const JointBundles::Color& serial = v.joints.bundles.color(ConstraintGraph::kOverflow);
    ConstraintGraph::Color& overflow = v.graph.color(ConstraintGraph::kOverflow);
    singles(serial.firstSingle, serial.endSingle);
    for (int i = 0; i < v.graph.bundleCount(ConstraintGraph::kOverflow); ++i)
        contact(overflow.bundles.data(), i, i + 1);

    for (int c = 0; c < ConstraintGraph::kColors; ++c) {
        if ((v.regions.usedLists[0] >> c & 1) == 0) continue;
        float* bundles = v.graph.color(c).bundles.data();
        const JointBundles::Color& bundled = v.joints.bundles.color(c);
        const Blocks singleBlocks{kJointsPerBlock, bundled.firstSingle, bundled.endSingle, 0};
        const Blocks wideBlocks{jointBundlesPerBlock, bundled.begin, bundled.end, singleBlocks.next()};
        const int contactBundles = v.graph.bundleCount(c),
                  size = std::max(leastContactBundles, contactBundles / kMostBlocks);
        const Blocks contactBlocks{size, 0, contactBundles, wideBlocks.next()};
        v.runner.parallelFor(contactBlocks.next(), 1, [&](int begin, int end, int) {
            for (int b = begin; b < end; ++b) {
                if (b < wideBlocks.first)
                    singleBlocks.visit(b, singles);
                else if (b < contactBlocks.first)
                    wideBlocks.visit(b, wide);
                else
                    contactBlocks.visit(b, [&](int first, int last) { contact(bundles, first, last); });
            }
        });
    }
}

/// The same for a region, on the calling thread.
template <class Joint, class Joints, class Contacts>
void forRegion(const Iteration& v, int region, Joint&& single, Joints&& wide, Contacts&& contact) {
    const int first = ConstraintGraph::firstList(region);
    const std::uint32_t used = v.regions.usedLists[static_cast<std::size_t>(region)];
    for (int c = 0; c < ConstraintGraph::kColors; ++c) {
        if ((used >> c & 1) == 0) continue;
        const JointBundles::Color& bundled = v.joints.bundles.color(first + c);
        for (int i = bundled.firstSingle; i < bundled.endSingle; ++i) single(v.joints.bundles.single(i));
        if (bundled.begin < bundled.end) wide(bundled.begin, bundled.end);
        const int count = v.graph.bundleCount(first + c);
        if (count > 0) contact(v.graph.color(first + c).bundles.data(), 0, count);
    }
}

/// Calls visit(alone, wide, contact) with what a pass does to single joints, bundles of joints and bundles of contacts.
template <class Visit>
void visitPass(const Iteration& v, SolvePass which, const SolverContext& own, Visit&& visit) {
    const BodyArrays arrays = v.bodies.arrays();
    const JointLanesView lanes = v.joints.bundles.view(v.joints.sims.data());
    JointContext joints = v.jointContext;
    joints.settling = own.settling;
    const JointPass pass{arrays, joints};
    const bool warm = which == SolvePass::warmStart, moving = which == SolvePass::solve;
    const auto passJoints = warm ? v.jointKernels.warmStart : moving ? v.jointKernels.solve : v.jointKernels.relax;
    const auto passContacts = warm     ? v.kernels.warmStartContacts
                              : moving ? v.kernels.solveContacts
                                       : v.kernels.relaxContacts;
    const bool withJoints = warm || own.normals;
    visit(
        [&](std::uint32_t j) {
            if (warm)
                warmStartJoint(v.joints.sims[j], arrays.states, arrays.inertia, v.jointContext);
            else if (withJoints)
                solveJoint(v.joints.sims[j], arrays.states, arrays.inertia, joints, moving);
        },
        [&](int begin, int end) {
            if (withJoints) passJoints(lanes, begin, end, pass);
        },
        [&](float* bundles, int begin, int end) { passContacts(bundles, begin, end, arrays, own); });
}

/// Contacts of direct islands that may bounce.
template <class Visit>
void forEachDirectBouncing(const Iteration& v, Visit&& visit) {
    const auto stride = static_cast<std::size_t>(v.graph.lanes());
    SingleBundle bundle(v.graph.lanes());
    for (const std::uint32_t m : v.graph.color(ConstraintGraph::kDirect).manifolds) {
        float* lane = v.graph.lane(v.manifolds[m].place);
        if (lane[contact::kRestitution * stride] > 0) bundle.visit(lane, visit);
    }
}

/// Adds a share of the velocities that forces and torques, beside gravity, have given in this substep.
void addPushes(Bodies& bodies, const Vec3& gravity, float h, float share) {
    for (const std::uint32_t index : bodies.awake) {
        if (!bodies.moves(index) || bodies.states[index].locks != 0) continue;
        const BodyDynamics& d = bodies.dynamics[index];
        const Vec3 push = d.acceleration - bodies[index].motion.gravityScale * gravity;
        if (push != Vec3{}) bodies.states[index].v += share * h * d.linearDecay * push;
        if (d.torque != Vec3{})
            bodies.states[index].w += share * h * d.angularDecay * (bodies.inertias[index] * d.torque);
    }
}

}  // namespace

void Iteration::passOverRegion(int region, SolvePass which, const SolverContext& own) const {
    visitPass(*this, which, own,
              [&](auto&& single, auto&& wide, auto&& contact) { forRegion(*this, region, single, wide, contact); });
}

void Iteration::passOverAll(SolvePass which, const SolverContext& own) const {
    if (regions.usedLists[0] == 0 && graph.regionCount() == 0) return;
    visitPass(*this, which, own,
              [&](auto&& single, auto&& wide, auto&& contact) { forUndivided(*this, single, wide, contact); });
    runner.parallelFor(graph.regionCount(), 1, [&](int begin, int end, int) {
        for (int r = begin + 1; r <= end; ++r) passOverRegion(r, which, own);
    });
}

void Iteration::warmStart() const {
    warmStartCouplings(couplings, joints);
    passOverAll(SolvePass::warmStart, context);
    beginCouplings(couplings, joints, bodies, jointContext);
}

void Iteration::solve(bool useBias, bool sequential) const {
    const SolvePass which = useBias ? SolvePass::solve : SolvePass::relax;
    const auto pass = [&](bool normals, bool friction) {
        context.normals = normals;
        context.friction = friction;
        passOverAll(which, context);
        if (normals) solveCouplings(couplings, joints, bodies, jointContext, useBias);
    };
    if (!sequential) return pass(true, true);
    pass(true, false);
    pass(false, true);
}

void Iteration::bounce() const {
    constexpr int kIterations = 32;  // a bound: an impact goes through so many bodies of a row
    const BodyArrays arrays = bodies.arrays();
    for (int i = 0; i < kIterations; ++i) {
        std::atomic<bool> bounced{false};
        const auto visit = [&](float* bundles, int begin, int end) {
            if (kernels.bounceContacts(bundles, begin, end, arrays, context))
                bounced.store(true, std::memory_order_relaxed);
        };
        const auto single = [](std::uint32_t) {};
        const auto wide = [](int, int) {};
        forEachDirectBouncing(*this, visit);
        forUndivided(*this, single, wide, visit);
        runner.parallelFor(graph.regionCount(), 1, [&](int begin, int end, int) {
            for (int r = begin + 1; r <= end; ++r) forRegion(*this, r, single, wide, visit);
        });
        if (!bounced.load(std::memory_order_relaxed)) return;
    }
}

void Iteration::settleNewContacts(AlignedArray<std::uint32_t>& fresh, const Vec3& gravity, bool sequential) const {
    if (fresh.empty()) return;
    addPushes(bodies, gravity, context.h, -1);
    context.settling = true;
    for (int i = 0; i < kSettlingIterations; ++i) solve(false, sequential);
    context.settling = false;
    addPushes(bodies, gravity, context.h, 1);
    const auto stride = static_cast<std::size_t>(graph.lanes());
    for (const std::uint32_t m : fresh) {
        float* lane = graph.lane(manifolds[m].place);
        for (int j = 0; j < manifolds[m].pointCount; ++j) {
            float* point = lane + static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields) * stride;
            point[contact::kLoad * stride] = point[contact::kImpulse * stride];
        }
    }
    for (int c = 0; c < graph.listCount(); ++c)
        for (const std::uint32_t m : graph.color(c).manifolds)
            for (int j = 0; j < manifolds[m].pointCount; ++j)
                graph.lane(manifolds[m].place)[static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields +
                                                                        contact::kPeak) *
                                               stride] = 0;
    fresh.clear();
}

}  // namespace ragtop
