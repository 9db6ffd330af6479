#include <algorithm>
#include <atomic>

#include "constraints/contact_layout.h"
#include "iteration/iteration.h"
#include "model/joint_bodies.h"
#include "model/spring_leads.h"

namespace ragtop {

namespace {

/// Calls visit(list) for all lists of the graph, those of a region on one worker.
template <class Visit>
void forEachRegionsLists(const Iteration& v, Visit&& visit) {
    v.runner.parallelFor(v.graph.regionCount() + 1, 1, [&](int begin, int end, int) {
        for (int c = ConstraintGraph::firstList(begin); c < ConstraintGraph::firstList(end); ++c) visit(c);
    });
}

/// Calls visit(list, begin, end) for blocks of `size` of all lists of the graph, in any order and at once.
template <class Count, class Visit>
void forBlocksOfAllLists(const Iteration& v, int size, Count&& count, Visit&& visit) {
    if (v.graph.regionCount() > 0) {
        // The worker that solves a region finds in its cache what it has prepared.
        forEachRegionsLists(v, [&](int c) {
            if (const int all = count(c); all > 0) visit(c, 0, all);
        });
        return;
    }
    int lists[ConstraintGraph::kLists], starts[ConstraintGraph::kLists + 1] = {0}, used = 0;
    v.graph.forUsedLists([&](int c) {
        lists[used++] = c;
        starts[used] = starts[used - 1] + (count(c) + size - 1) / size;
    });
    v.runner.parallelFor(starts[used], 1, [&](int begin, int end, int) {
        auto i = static_cast<int>(std::upper_bound(starts, starts + used, begin) - starts) - 1;
        for (int block = begin; block < end; ++block) {
            while (starts[i + 1] <= block) ++i;
            const int first = (block - starts[i]) * size, all = count(lists[i]);
            visit(lists[i], first, first + size < all ? first + size : all);
        }
    });
}

}  // namespace

bool Iteration::prepare(float lastSubstep) const {
    const bool rescale = lastSubstep > 0 && lastSubstep != context.h;
    const float ratio = rescale ? context.h / lastSubstep : 1;
    if (joints.bundlesChanged) joints.bundles.build(graph, joints.sims.data());
    if (joints.bundlesChanged) collectSprings(joints, graph);
    joints.bundlesChanged = false;
    groupContacts();
    std::atomic<std::int32_t> traits{0};
    forBlocksOfAllLists(
        *this, 8, [&](int c) { return c == ConstraintGraph::kFrozen ? 0 : graph.bundleCount(c); },
        [&](int c, int begin, int end) {
            if (const std::int32_t own = placeAndPrepare(c, begin, end); own != 0)
                traits.fetch_or(own, std::memory_order_relaxed);
        });
    if (rescale)
        graph.forUsedLists([&](int c) {
            for (const std::uint32_t joint : graph.color(c).joints) rescaleJoint(joints.sims[joint], ratio);
        });
    prepareJoints();
    prepareCouplings(couplings, joints, ratio);
    collectStruck((traits.load(std::memory_order_relaxed) & contact::kIsStruck) != 0);
    return (traits.load(std::memory_order_relaxed) & contact::kBouncy) != 0;
}

/// Puts contacts with equally many points side by side, so that bundles solve few that are not there; numbers the
/// lanes.
void Iteration::groupContacts() const {
    constexpr std::size_t kNear = std::size_t{1} << 21;  // bytes that passes find in a cache
    const auto group = [&](int c) {
        if (ConstraintGraph::isSerial(c) || !ConstraintGraph::isIterated(c)) return;
        graph.groupByPoints(c,
                            [&](std::uint32_t manifold, std::uint32_t slot) { manifolds[manifold].place.slot = slot; });
    };
    if (graph.regionCount() > 0) {
        forEachRegionsLists(*this, group);
    } else {
        int used[ConstraintGraph::kRegionLists], count = 0;
        forEachBit(graph.iteratedLists(0), [&](int c) { used[count++] = c; });
        runner.parallelFor(count, 1, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) group(used[i]);
        });
    }
    std::size_t lanes = 0;
    graph.forUsedLists([&](int c) {
        lanes += static_cast<std::size_t>(graph.bundleCount(c)) * static_cast<std::size_t>(graph.lanes());
    });
    context.farContacts = lanes * contact::kFields * sizeof(float) > kNear;
}

/// Some bundles at a time, which the cache holds in between. Those of contact::Trait that passes ask for.
std::int32_t Iteration::placeAndPrepare(int c, int begin, int end) const {
    constexpr int kAtOnce = 4;  // bundles, by trial
    ConstraintGraph::Color& color = graph.color(c);
    const LaneManifolds list{color.manifolds.data(), static_cast<int>(color.manifolds.size()),
                             ConstraintGraph::isSerial(c) ? 1 : graph.lanes()};
    const ContactPlaces places{&bodies[0].center,
                               &bodies[0].rotation,
                               sizeof(BodyRecord),
                               manifolds.records().pages(),
                               PagedArray<ManifoldRecord>::kPageBits,
                               sizeof(ManifoldRecord)};
    std::int32_t traits = 0;
    for (int i = begin; i < end; i += kAtOnce) {
        const int last = i + kAtOnce < end ? i + kAtOnce : end;
        kernels.placeContacts(color.bundles.data(), i, last, list, places);
        traits |= kernels.prepareContacts(color.bundles.data(), i, last, bodies.arrays(), context);
    }
    return traits;
}

void Iteration::prepareJointOf(std::uint32_t joint) const {
    if (articulations.areFresh()) articulations.classify(tables, joint, joints.sims[joint]);
    prepareJoint(joints.sims[joint], jointBodies(bodies, joints, joint), bodies.states.data(), bodies.inertias.data(),
                 jointContext);
    keepCounts(joints.sims[joint]);
}

void Iteration::prepareJoints() const {
    const auto jointsOf = [&](int c) -> const AlignedArray<std::uint32_t>& {
        return c == ConstraintGraph::kDirect && directSet.multirate.any ? directSet.multirate.sharedJoints
                                                                        : graph.color(c).joints;
    };
    forBlocksOfAllLists(
        *this, 16, [&](int c) { return static_cast<int>(jointsOf(c).size()); },
        [&](int c, int begin, int end) {
            for (int i = begin; i < end; ++i) prepareJointOf(jointsOf(c)[static_cast<std::size_t>(i)]);
        });
    const JointLanesView view = joints.bundles.view(joints.sims.data());
    const auto bundles = [&](int c) { return joints.bundles.color(c).end - joints.bundles.color(c).begin; };
    forBlocksOfAllLists(*this, 4, bundles, [&](int c, int begin, int end) {
        const int first = joints.bundles.color(c).begin;
        jointKernels.load(view, first + begin, first + end);
    });
}

void Iteration::storeJoints() const {
    const JointLanesView view = joints.bundles.view(joints.sims.data());
    runner.parallelFor(joints.bundles.bundleCount(), 8,
                       [&](int begin, int end, int) { jointKernels.store(view, begin, end); });
    leadSprings(joints, bodies, context.h, Lead::end, runner);
}

}  // namespace ragtop
