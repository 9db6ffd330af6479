// The order of a step, and the data that one stage hands to the next:
//
//   pairs      enlarged bounds B ⊕ 0.1 s ⊕ |v| dt that have come to overlap          → pairs of shapes
//   collide    manifolds: normal n, up to four points with separation C₀              → contacts with points
//   contacts   colours in which no moving body occurs twice                           → the constraint graph
//   islands    who solves which island: iterations over colours, or a direct solver   → lists of each solver
//   prepare    points at the poses of now, m_eff = 1/(J M⁻¹ Jᵀ), carried loads λ̂      → rows in lanes
//   solve      per substep h = dt/n:
//                v ← v + h a;  warm start;  Δλ = −m_eff s_m (u + β C) − s_i (λ − λ̂)   the soft pass
//                x ← x + h v                                                          displacements dp, dq
//                Δλ = −m_eff u                                                        the relaxing pass
//   finish     poses from displacements; continuous collision; open joints; bounds    → the state of the next step
//   events, sleep
//
// The method is the soft step [Catto, Solver2D, 2024]. docs/step.md follows one contact through all of it.

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

#include "constraints/contact_layout.h"
#include "world/multirate.h"
#include "world/single_bundle.h"
#include "world/world_modules.h"
#include "world/world_regions.h"

namespace ragtop {

/// Runs the stages that workers may help with, and reports the time to the choice of workers.
template <class Body>
static void shareStep(WorldImpl& world, Body&& body) {
    // Bodies and contacts take some 0.3 to 1 µs each; few are over before a second thread has woken, 2 µs and more.
    constexpr std::size_t kFew = 64;
    // Modules that acted in the last step count as many of them.
    constexpr std::size_t kModule = 16;
    const std::size_t size = world.bodies.awake.size() + world.contacts.awake.size() + world.broadphase.moved.size() +
                             kModule * world.moduleWork.members.size();
    if (size < kFew) return world.runner.region(1, [&] { body(false); });
    const Sharing sharing = world.workerChoice.next();
    const auto begin = std::chrono::steady_clock::now();
    world.runner.region(sharing.workers, [&] { body(sharing.shareSolve); });
    const std::chrono::duration<float> taken = std::chrono::steady_clock::now() - begin;
    world.workerChoice.note(taken.count(), static_cast<float>(size));
}

/// Stores what the substeps have changed, then checks the energy of jointed groups.
static void endSolve(WorldImpl& world) {
    stepIndependentTrees(world);
    world.storeJoints();
    world.endDirect();
    guardEnergy(world);
}

/// What the substeps of a step of dt seconds have in common.
static void fillContexts(const WorldSettings& settings, float dt, SolverContext& contacts, JointContext& joints) {
    const float h = dt / static_cast<float>(settings.substeps), substepRate = 1 / h;
    const float gravity = length(settings.gravity);
    contacts.h = h;
    contacts.inverseH = substepRate;
    contacts.dt = dt;
    contacts.soft = makeSoftness(settings.contactFrequency * substepRate, settings.contactDamping, h);
    contacts.softStatic = makeSoftness(2 * settings.contactFrequency * substepRate, settings.staticContactDamping, h);
    contacts.pushOut = settings.pushOut / dt;
    contacts.gravityStep = gravity * h;
    contacts.heavyDepth = contact::kHeavy * contacts.gravityStep * contacts.soft.impulseScale /
                          (contacts.soft.massScale * contacts.soft.biasRate);
    contacts.restitutionSpeed = settings.restitutionSpeed * gravity * dt;
    contacts.loadShare = settings.loadGain;
    contacts.staticLoadShare = settings.staticLoadGain;
    joints = {h, substepRate, makeSoftness(settings.jointFrequency * substepRate, settings.jointDamping, h)};
}

/// Advances the world by dt seconds: collide once, then substeps.
void WorldImpl::step(World& world, double stepSeconds) {
    const bool valid = std::isfinite(stepSeconds) && stepSeconds > 0;
    assert(valid);
    if (!valid) return;
    const bool longer = static_cast<float>(stepSeconds) > dt;
    dt = static_cast<float>(stepSeconds);
    const float before = context.h;
    fillContexts(settings, dt, context, jointContext);
    islands.graphChanged |= before != context.h;  // springs are as stiff as substeps are long

    events.beginStep(bodies.room());
    stepping = inStep = true;
    profile.begin();
    beginModules(*this, world, stepSeconds);

    shareStep(*this, [&](bool shareSolve) {
        askModules(*this, world, stepSeconds);
        profile.beginStage("pairs", callbacks);
        updatePairs(longer);  // may grow arrays, as may the changes of contacts; nothing else below does
        profile.beginStage("collide", callbacks);
        updateContacts();
        profile.beginStage("contacts", callbacks);
        applyContactChanges();
        leaveOutGhosts(ghostView(), {contactFinds.closing.begin(), contactFinds.closing.end()}, contacts, graph,
                       runner);
        profile.beginStage("islands", callbacks);
        chooseSolvers();
        collectSolved();
        chooseStepFactors(*this);
        divideIntoRegions(*this);
        profile.beginStage("prepare", callbacks);
        prepareBodies();
        articulations.find(tables(), directSet);
        settleNewJoints();
        beginGuard(*this);
        prepareConstraints();
        beginDirect();
        profile.beginStage("solve", callbacks);
        runner.part(!shareSolve, [&] { solveSubsteps(world); });
        makeRoomToFinish();
        endSolve(*this);
        profile.beginStage("finish", callbacks);
        finishBodies();
        stopOutOfRange();
        correctInitialViolations();
        sweepFast();
        closeOpenJoints(*this);
        shapeBounds().refit(sweptBodies.startPoses(), runner);
        profile.beginStage("events", callbacks);
        narrowPhase().updateSensors(runner);
        contactEvents().publish(runner);
        profile.beginStage("sleep", callbacks);
        freezeStillBodies();
        sleepQuietIslands();
    });

    stepping = false;
    events.endStep();
    breakJoints();
    lastSubstep = context.h;
    ++stepCount;
    time += stepSeconds;
    profile.beginStage("modules after", callbacks);
    for (StepModule* module : modules)
        if (module->afterStep) module->afterStep(module->user, world, stepSeconds);
    inStep = false;
    profile.end(callbacks);
}

void WorldImpl::prepareBody(std::uint32_t index) {
    BodyRecord& body = bodies[index];
    BodyDynamics& d = bodies.dynamics[index];
    const float h = context.h * static_cast<float>(body.stepFactor);
    d.linearDecay = 1 / (1 + h * body.linearDamping);
    d.angularDecay = 1 / (1 + h * body.angularDamping);
    const float inverseMass = bodies.states[index].invMass;
    d.acceleration = inverseMass > 0 ? body.gravityScale * settings.gravity + inverseMass * body.force : Vec3{};
    d.torque = body.torque;
    // The forces of joints turn with the bodies: taking them for smooth would feed energy into every swing.
    // What joined bodies have in common is smooth, and is theirs by Articulations::move.
    d.translates = inverseMass > 0 && body.firstJoint == kNone ? 1.0f : 0.0f;
    body.force = {};
    body.torque = {};
    bodies.histories[index].rotation = body.rotation;
}

void WorldImpl::prepareBodies() {
    forSharedBodies(*this, [&](int, std::span<const std::uint32_t> list) {
        runner.parallelFor(static_cast<int>(list.size()), 64, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) prepareBody(list[static_cast<std::size_t>(i)]);
        });
    });
}

/// Calls visit(list) for all lists of the graph, those of a region on one worker.
template <class Visit>
static void forEachRegionsLists(WorldImpl& world, Visit&& visit) {
    world.runner.parallelFor(world.graph.regionCount() + 1, 1, [&](int begin, int end, int) {
        for (int c = ConstraintGraph::firstList(begin); c < ConstraintGraph::firstList(end); ++c) visit(c);
    });
}

/// Calls visit(list, begin, end) for blocks of `size` of all lists of the graph, in any order and at once.
template <class Count, class Visit>
void WorldImpl::forBlocksOfAllLists(int size, Count&& count, Visit&& visit) {
    if (graph.regionCount() > 0) {
        // The worker that solves a region finds in its cache what it has prepared.
        forEachRegionsLists(*this, [&](int c) {
            if (const int all = count(c); all > 0) visit(c, 0, all);
        });
        return;
    }
    const int lists = graph.listCount();
    regions.listStarts.resizeForOverwrite(static_cast<std::size_t>(lists) + 1);
    int* const starts = regions.listStarts.data();
    starts[0] = 0;
    for (int c = 0; c < lists; ++c) starts[c + 1] = starts[c] + (count(c) + size - 1) / size;
    runner.parallelFor(starts[lists], 1, [&](int begin, int end, int) {
        auto c = static_cast<int>(std::upper_bound(starts, starts + lists, begin) - starts) - 1;
        for (int block = begin; block < end; ++block) {
            while (starts[c + 1] <= block) ++c;
            const int first = (block - starts[c]) * size, all = count(c);
            visit(c, first, first + size < all ? first + size : all);
        }
    });
}

void WorldImpl::prepareConstraints() {
    const bool rescale = lastSubstep > 0 && lastSubstep != context.h;
    const float ratio = rescale ? context.h / lastSubstep : 1;
    if (joints.bundlesChanged) joints.bundles.build(graph, joints.sims.data());
    if (joints.bundlesChanged) collectSprings(*this);
    joints.bundlesChanged = false;
    groupContacts();
    std::atomic<bool> mayBounce{false};
    forBlocksOfAllLists(
        8, [&](int c) { return c == ConstraintGraph::kFrozen ? 0 : graph.bundleCount(c); },
        [&](int c, int begin, int end) {
            if (placeAndPrepare(c, begin, end)) mayBounce.store(true, std::memory_order_relaxed);
        });
    if (rescale)
        for (int c = 0; c < graph.listCount(); ++c)
            for (const std::uint32_t joint : graph.color(c).joints) rescaleJoint(joints.sims[joint], ratio);
    prepareJoints();
    bouncy = mayBounce.load(std::memory_order_relaxed);
    prepareCouplings(ratio);
    collectRegions(*this);
}

/// Puts contacts with equally many points side by side, so that bundles solve few that are not there; numbers the
/// lanes.
void WorldImpl::groupContacts() {
    constexpr std::size_t kNear = std::size_t{1} << 21;  // bytes that passes find in a cache
    const auto group = [&](int c) {
        if (ConstraintGraph::isSerial(c) || !ConstraintGraph::isIterated(c)) return;
        graph.groupByPoints(c,
                            [&](std::uint32_t manifold, std::uint32_t slot) { manifolds[manifold].place.slot = slot; });
    };
    if (graph.regionCount() > 0)
        forEachRegionsLists(*this, group);
    else
        runner.parallelFor(ConstraintGraph::kColors, 1, [&](int begin, int end, int) {
            for (int c = begin; c < end; ++c) group(c);
        });
    std::size_t lanes = 0;
    for (int c = 0; c < graph.listCount(); ++c)
        lanes += static_cast<std::size_t>(graph.bundleCount(c)) * static_cast<std::size_t>(graph.lanes());
    context.farContacts = lanes * contact::kFields * sizeof(float) > kNear;
}

ContactPlaces WorldImpl::contactPlaces() const {
    return {&bodies[0].center,
            &bodies[0].rotation,
            sizeof(BodyRecord),
            manifolds.records().pages(),
            PagedArray<ManifoldRecord>::kPageBits,
            sizeof(ManifoldRecord)};
}

/// Some bundles at a time, which the cache holds in between. True if any may bounce.
bool WorldImpl::placeAndPrepare(int c, int begin, int end) {
    constexpr int kAtOnce = 4;  // bundles, by trial
    ConstraintGraph::Color& color = graph.color(c);
    const LaneManifolds list{color.manifolds.data(), static_cast<int>(color.manifolds.size()),
                             ConstraintGraph::isSerial(c) ? 1 : graph.lanes()};
    const ContactPlaces places = contactPlaces();
    bool mayBounce = false;
    for (int i = begin; i < end; i += kAtOnce) {
        const int last = i + kAtOnce < end ? i + kAtOnce : end;
        kernels->placeContacts(color.bundles.data(), i, last, list, places);
        mayBounce |= kernels->prepareContacts(color.bundles.data(), i, last, bodies.arrays(), context);
    }
    return mayBounce;
}

void WorldImpl::prepareJointOf(std::uint32_t joint) {
    if (articulations.areFresh()) articulations.classify(tables(), joint, joints.sims[joint]);
    prepareJoint(joints.sims[joint], jointBodies(joint), bodies.states.data(), bodies.inertias.data(), jointContext);
    keepCounts(joints.sims[joint]);
}

void WorldImpl::prepareJoints() {
    const auto jointsOf = [&](int c) -> const AlignedArray<std::uint32_t>& {
        return c == ConstraintGraph::kDirect && directSet.multirate.any ? directSet.multirate.sharedJoints
                                                                        : graph.color(c).joints;
    };
    forBlocksOfAllLists(
        16, [&](int c) { return static_cast<int>(jointsOf(c).size()); },
        [&](int c, int begin, int end) {
            for (int i = begin; i < end; ++i) prepareJointOf(jointsOf(c)[static_cast<std::size_t>(i)]);
        });
    const JointLanesView view = joints.bundles.view(joints.sims.data());
    const auto bundles = [&](int c) { return joints.bundles.color(c).end - joints.bundles.color(c).begin; };
    forBlocksOfAllLists(4, bundles, [&](int c, int begin, int end) {
        const int first = joints.bundles.color(c).begin;
        jointKernels->load(view, first + begin, first + end);
    });
}

void WorldImpl::storeJoints() {
    const JointLanesView view = joints.bundles.view(joints.sims.data());
    runner.parallelFor(joints.bundles.bundleCount(), 8,
                       [&](int begin, int end, int) { jointKernels->store(view, begin, end); });
    leadSprings(*this, Lead::end);
}

}  // namespace ragtop
