// The passes of the iteration over bodies and constraints, in each substep.

#include <algorithm>
#include <atomic>

#include "constraints/contact_layout.h"
#include "world/multirate.h"
#include "world/single_bundle.h"
#include "world/world_modules.h"

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

}  // namespace

static SolverContext contextOf(const WorldImpl& world, int number, bool moved) {
    SolverContext own = world.context;
    own.elapsed = world.context.h * static_cast<float>(moved ? number + 1 : number);
    own.substep = number;
    own.firstSubstep = number == 0;
    own.lastSubstep = number + 1 == world.settings.substeps;
    return own;
}

/// What is in no region: overflow first and serially, then the colours in order, each in parallel: alone(joint) for its
/// single joints, wide(begin, end) and contact(bundles, begin, end) for its bundles.
template <class Joint, class Joints, class Contacts>
static void forUndivided(WorldImpl& world, Joint&& single, Joints&& wide, Contacts&& contact) {
    constexpr int kJointsPerBlock = 8;  // of a task, by trial
    constexpr int kMostBlocks = 64;  // of contacts: what is next in memory is best solved by the same thread
    const int jointBundlesPerBlock = 32 / world.jointKernels->lanes, leastContactBundles = 32 / world.graph.lanes();
    const auto singles = [&](int begin, int end) {
        for (int i = begin; i < end; ++i) single(world.joints.bundles.single(i));
    };
    const JointBundles::Color& serial = world.joints.bundles.color(ConstraintGraph::kOverflow);
    ConstraintGraph::Color& overflow = world.graph.color(ConstraintGraph::kOverflow);
    singles(serial.firstSingle, serial.endSingle);
    for (int i = 0; i < world.graph.bundleCount(ConstraintGraph::kOverflow); ++i)
        contact(overflow.bundles.data(), i, i + 1);

    for (int c = 0; c < ConstraintGraph::kColors; ++c) {
        if ((world.regions.usedLists[0] >> c & 1) == 0) continue;
        float* bundles = world.graph.color(c).bundles.data();
        const JointBundles::Color& bundled = world.joints.bundles.color(c);
        const Blocks singleBlocks{kJointsPerBlock, bundled.firstSingle, bundled.endSingle, 0};
        const Blocks wideBlocks{jointBundlesPerBlock, bundled.begin, bundled.end, singleBlocks.next()};
        const int contactBundles = world.graph.bundleCount(c),
                  size = std::max(leastContactBundles, contactBundles / kMostBlocks);
        const Blocks contactBlocks{size, 0, contactBundles, wideBlocks.next()};
        world.runner.parallelFor(contactBlocks.next(), 1, [&](int begin, int end, int) {
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
static void forRegion(WorldImpl& world, int region, Joint&& single, Joints&& wide, Contacts&& contact) {
    const int first = ConstraintGraph::firstList(region);
    const std::uint32_t used = world.regions.usedLists[static_cast<std::size_t>(region)];
    for (int c = 0; c < ConstraintGraph::kColors; ++c) {
        if ((used >> c & 1) == 0) continue;
        const JointBundles::Color& bundled = world.joints.bundles.color(first + c);
        for (int i = bundled.firstSingle; i < bundled.endSingle; ++i) single(world.joints.bundles.single(i));
        if (bundled.begin < bundled.end) wide(bundled.begin, bundled.end);
        const int count = world.graph.bundleCount(first + c);
        if (count > 0) contact(world.graph.color(first + c).bundles.data(), 0, count);
    }
}

/// Calls visit(alone, wide, contact) with what a pass does to single joints, bundles of joints and bundles of contacts.
template <class Visit>
static void visitPass(WorldImpl& world, SolvePass which, const SolverContext& own, Visit&& visit) {
    const BodyArrays arrays = world.bodies.arrays();
    const JointLanesView lanes = world.joints.bundles.view(world.joints.sims.data());
    const JointPass pass{arrays, world.jointContext};
    const bool warm = which == SolvePass::warmStart, moving = which == SolvePass::solve;
    const auto passJoints = warm     ? world.jointKernels->warmStart
                            : moving ? world.jointKernels->solve
                                     : world.jointKernels->relax;
    const auto passContacts = warm     ? world.kernels->warmStartContacts
                              : moving ? world.kernels->solveContacts
                                       : world.kernels->relaxContacts;
    const bool withJoints = warm || own.normals;
    visit(
        [&](std::uint32_t j) {
            if (warm)
                warmStartJoint(world.joints.sims[j], arrays.states, arrays.inertia, world.jointContext);
            else if (withJoints)
                solveJoint(world.joints.sims[j], arrays.states, arrays.inertia, world.jointContext, moving);
        },
        [&](int begin, int end) {
            if (withJoints) passJoints(lanes, begin, end, pass);
        },
        [&](float* bundles, int begin, int end) { passContacts(bundles, begin, end, arrays, own); });
}

static void passOverRegion(WorldImpl& world, int region, SolvePass which, const SolverContext& own) {
    visitPass(world, which, own,
              [&](auto&& single, auto&& wide, auto&& contact) { forRegion(world, region, single, wide, contact); });
}

static void passOverAll(WorldImpl& world, SolvePass which, const SolverContext& own) {
    if (world.regions.usedLists[0] == 0 && world.graph.regionCount() == 0) return;
    visitPass(world, which, own,
              [&](auto&& single, auto&& wide, auto&& contact) { forUndivided(world, single, wide, contact); });
    world.runner.parallelFor(world.graph.regionCount(), 1, [&](int begin, int end, int) {
        for (int r = begin + 1; r <= end; ++r) passOverRegion(world, r, which, own);
    });
}

static void moveArticulations(WorldImpl& world) {
    world.runner.parallelFor(static_cast<int>(world.articulations.count()), 16, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i)
            world.articulations.move(static_cast<std::uint32_t>(i), world.context.h, world.bodies);
    });
}

/// All substeps of what shares no body with anything else.
static void solveRegion(WorldImpl& world, World& face, int region) {
    const BodyArrays arrays = world.bodies.arrays();
    const std::span<const std::uint32_t> list = world.regions.bodies.of(region);
    const auto count = static_cast<int>(list.size());
    for (int i = 0; i < world.settings.substeps; ++i) {
        const SolverContext before = contextOf(world, i, false), after = contextOf(world, i, true);
        for (const std::uint32_t group : world.regions.modules.of(region)) actAsGroup(world, face, group);
        world.kernels->integrateVelocities(arrays, list.data(), 0, count, before);
        passOverRegion(world, region, SolvePass::warmStart, before);
        passOverRegion(world, region, SolvePass::solve, before);
        for (const std::uint32_t articulation : world.regions.articulations.of(region))
            world.articulations.move(articulation, world.context.h, world.bodies);
        world.kernels->integratePositions(arrays, list.data(), 0, count, before);
        passOverRegion(world, region, SolvePass::relax, after);
    }
}

/// Region 0 are bodies of none, that touch nothing and nothing moves.
static void solveRegions(WorldImpl& world, World& face) {
    world.runner.parallelFor(world.graph.regionCount() + 1, 1, [&](int begin, int end, int) {
        for (int r = begin; r < end; ++r) solveRegion(world, face, r);
    });
    world.context = contextOf(world, world.settings.substeps - 1, true);
}

/// Contacts of direct islands that may bounce.
template <class Visit>
static void forEachDirectBouncing(WorldImpl& world, Visit&& visit) {
    const auto stride = static_cast<std::size_t>(world.graph.lanes());
    SingleBundle bundle(world.graph.lanes());
    for (const std::uint32_t m : world.graph.color(ConstraintGraph::kDirect).manifolds) {
        float* lane = world.graph.lane(world.manifolds[m].place);
        if (lane[contact::kRestitution * stride] > 0) bundle.visit(lane, visit);
    }
}

/// Passes of all bodies, one after the other.
static void solveTogether(WorldImpl& world, World& face) {
    for (int number = 0; number < world.settings.substeps; ++number) {
        world.context = contextOf(world, number, false);
        actBetweenSubsteps(world, face);
        world.readMechanisms();
        world.integrateVelocities();
        if (world.bouncy) world.bounce();
        world.solveDirect(WorldImpl::DirectPass::positions);
        world.warmStart();
        if (number == 0) world.settleNewContacts();
        world.solve(true);
        moveArticulations(world);
        world.integratePositions();
        world.context = contextOf(world, number, true);
        world.solveDirect(WorldImpl::DirectPass::velocities);
        world.solve(false);
    }
}

void WorldImpl::solveSubsteps(World& world) {
    leadSprings(*this, Lead::begin);
    moduleWork.inSubsteps = moduleWork.acts();
    if (regions.independent)
        solveRegions(*this, world);
    else
        solveTogether(*this, world);
    moduleWork.inSubsteps = false;
}

void WorldImpl::integrateVelocities() {
    const BodyArrays arrays = bodies.arrays();
    forBodiesInTurn(*this, [&](const std::uint32_t* list, int begin, int end, const SolverContext& own) {
        kernels->integrateVelocities(arrays, list, begin, end, own);
    });
}

void WorldImpl::integratePositions() {
    const BodyArrays arrays = bodies.arrays();
    forBodiesInTurn(*this, [&](const std::uint32_t* list, int begin, int end, const SolverContext& own) {
        kernels->integratePositions(arrays, list, begin, end, own);
    });
}

void WorldImpl::warmStart() {
    warmStartCouplings();
    passOverAll(*this, SolvePass::warmStart, context);
    beginCouplings();
}

/// Friction beside the normal rows of each contact, or after those of all, as the settings say.
void WorldImpl::solve(bool useBias) {
    const SolvePass which = useBias ? SolvePass::solve : SolvePass::relax;
    const auto pass = [&](bool normals, bool friction) {
        context.normals = normals;
        context.friction = friction;
        passOverAll(*this, which, context);
        if (normals) solveCouplings(useBias);
    };
    if (!settings.sequentialFriction) return pass(true, true);
    pass(true, false);
    pass(false, true);
}

/// Iterates until nothing more will meet, or enough: what is left then is stopped by the rows that do not bounce.
void WorldImpl::bounce() {
    constexpr int kIterations = 32;  // a bound: an impact goes through so many bodies of a row
    const BodyArrays arrays = bodies.arrays();
    for (int i = 0; i < kIterations; ++i) {
        std::atomic<bool> bounced{false};
        const auto visit = [&](float* bundles, int begin, int end) {
            if (kernels->bounceContacts(bundles, begin, end, arrays, context))
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

}  // namespace ragtop
