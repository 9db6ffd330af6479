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
#include <limits>

#include "constraints/contact_layout.h"
#include "world/multirate.h"
#include "world/swept_groups.h"
#include "world/world_impl.h"
#include "world/world_modules.h"
#include "world/world_regions.h"

namespace ragtop {

/// Bodies and contacts take some 0.3 to 1 µs each; few are over before a second thread has woken, 2 µs and more.
constexpr std::size_t kFew = 64;

/// What a step is over, in bodies and contacts.
static std::size_t sizeOf(const WorldImpl& world) {
    constexpr std::size_t kModule = 16;  // that acted in the last step
    return world.tables.bodies.awake.size() + world.tables.contacts.awake.size() +
           world.collision.broadphase.moved.size() + kModule * world.moduleWork.members.size();
}

/// Runs the stages that workers may help with, and reports the time to the choice of workers.
template <class Body>
static void shareStep(WorldImpl& world, Body&& body) {
    const std::size_t size = sizeOf(world);
    if (size < kFew) return world.machine.runner.region(1, [&] { body(false); });
    const Sharing sharing = world.machine.workerChoice.next();
    const auto begin = std::chrono::steady_clock::now();
    world.machine.runner.region(sharing.workers, [&] { body(sharing.shareSolve); });
    const std::chrono::duration<float> taken = std::chrono::steady_clock::now() - begin;
    world.machine.workerChoice.note(taken.count(), static_cast<float>(size));
}

void Solving::begin(const WorldSettings& settings, float dt) {
    const float h = dt / static_cast<float>(settings.substeps), substepRate = 1 / h;
    const float gravity = length(settings.gravity);
    context.h = h;
    context.inverseH = substepRate;
    context.dt = dt;
    context.soft = makeSoftness(settings.contactFrequency * substepRate, settings.contactDamping, h);
    context.softStatic = makeSoftness(2 * settings.contactFrequency * substepRate, settings.staticContactDamping, h);
    context.pushOut = settings.pushOut / dt;
    context.pushRoot = gravity > 0 ? contact::kPushFall * std::sqrt(gravity) : std::numeric_limits<float>::max();
    context.gravityStep = gravity * h;
    context.heavyDepth = contact::kHeavy * context.gravityStep * context.soft.impulseScale /
                         (context.soft.massScale * context.soft.biasRate);
    context.restitutionSpeed = settings.restitutionSpeed * gravity * dt;
    context.loadShare = settings.loadGain;
    context.staticLoadShare = settings.staticLoadGain;
    jointContext = {h, substepRate, makeSoftness(settings.jointFrequency * substepRate, settings.jointDamping, h)};
}

/// Stores what the substeps have changed, then checks the energy of jointed groups.
void WorldImpl::endSolve(const DirectView& direct, const Iteration& iterate) {
    if (partition.direct.trees.groupCount(true) > 0) stepIndependentTrees(direct, iterate, bodyStage(), guardView());
    iterate.storeJoints();
    endDirect(direct);
    if (guards.energy.groupCount() > 0) guardEnergy(guardView());
    tables.slopes.end(tables.bodies);
}

/// Continuous collision, and what it cost groups of joints; joints that are still open are closed.
void WorldImpl::mendPoses() {
    if (guards.energy.groupCount() == 0) return sweepFast();
    const ClosingView closing = closingView();
    noteEnergyToSweep(closing);
    sweepFast();
    payForSweeps(closing);
    closeOpenJoints(closing);
}

void WorldImpl::beginStep(World& world, double stepSeconds) {
    clock.dt = static_cast<float>(stepSeconds);
    const float before = solving.context.h;
    solving.begin(settings, clock.dt);
    partition.islands.graphChanged |= before != solving.context.h;  // springs are as stiff as substeps are long
    events.beginStep(tables.bodies.room());
    clock.stepping = clock.inStep = true;
    constexpr std::uint64_t kSeldom = 17;  // steps of a small world; what is done every 16 or 64 shall not count always
    reports.profile.begin(sizeOf(*this) >= kFew || clock.stepCount % kSeldom == 0);
    reports.profile.beginStage("modules", callbacks);
    for (StepModule* module : moduleWork.modules)
        if (module->beforeStep) module->beforeStep(module->user, world, stepSeconds);
}

void WorldImpl::endStep(World& world, double stepSeconds) {
    clock.stepping = false;
    events.endStep();
    scene().breakJoints(clock.dt);
    clock.lastSubstep = solving.context.h;
    ++clock.stepCount;
    clock.time += stepSeconds;
    reports.profile.beginStage("modules after", callbacks);
    for (StepModule* module : moduleWork.modules)
        if (module->afterStep) module->afterStep(module->user, world, stepSeconds);
    clock.inStep = false;
    reports.profile.end(callbacks);
}

/// Advances the world by dt seconds: collide once, then substeps.
void WorldImpl::step(World& world, double stepSeconds) {
    const bool valid = std::isfinite(stepSeconds) && stepSeconds > 0;
    assert(valid);
    if (!valid) return;
    const bool longer = static_cast<float>(stepSeconds) > clock.dt;
    beginStep(world, stepSeconds);
    StepProfile& profile = reports.profile;
    shareStep(*this, [&](bool shareSolve) {
        const Scene scene = this->scene();
        const Activity& active = scene.activity;
        const Iteration iterate = iteration();
        const DirectView direct = directView();
        if (!moduleWork.modules.empty()) profile.beginStage("look", callbacks);
        askModules(moduleWork, active, machine.runner, world, stepSeconds);
        profile.beginStage("pairs", callbacks);
        updatePairs(active, longer);  // may grow arrays, as may the changes of contacts; nothing else below does
        profile.beginStage("collide", callbacks);
        updateContacts();
        profile.beginStage("contacts", callbacks);
        active.applyContactChanges(ghostView(), settings.sleeping);
        leaveOutGhosts(ghostView(), {collision.finds.closing.begin(), collision.finds.closing.end()}, tables.contacts,
                       tables.graph, machine.runner);
        tables.slopes.begin(tables.bodies, clock.dt, settings.substeps);
        profile.beginStage("islands", callbacks);
        chooseSolvers(active, direct);
        active.collectSolved(solving.freezing, moduleWork, !callbacks.modify);  // what is told of contacts expects all
        chooseStepFactors(multirateView());
        divideIntoRegions(regionView());
        profile.beginStage("prepare", callbacks);
        prepareBodies();
        partition.articulations.find(tables, partition.direct);
        scene.settleNewJoints();
        if (partition.articulations.areFresh() || guards.energy.groupCount() > 0) beginGuard(guardView());
        solving.bouncy = iterate.prepare(clock.lastSubstep);
        collectRegions(regionView());
        beginDirect(direct);
        profile.beginStage("solve", callbacks);
        machine.runner.part(!shareSolve, [&] { solveSubsteps(world, direct, iterate); });
        makeRoomToFinish();
        endSolve(direct, iterate);
        profile.beginStage("finish", callbacks);
        finishBodies();
        stopOutOfRange();
        scene.correctInitialViolations();
        mendPoses();
        scene.bounds.refit(collision.swept.startPoses(), machine.runner);
        profile.beginStage("events", callbacks);
        narrowPhase().updateSensors(machine.runner);
        contactEvents().publish(machine.runner);
        profile.beginStage("sleep", callbacks);
        active.freezeStillBodies(solving.freezing, moduleWork, !callbacks.modify);
        if (settings.sleeping) active.sleepQuietIslands(tables, settings.sleepTime);
    });
    endStep(world, stepSeconds);
}

void WorldImpl::prepareBodies() {
    const BodyStage stage = bodyStage();
    forSharedBodies(partition.direct.multirate, solving.freezing.solved, [&](int, std::span<const std::uint32_t> list) {
        machine.runner.parallelFor(static_cast<int>(list.size()), 64, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) stage.prepare(list[static_cast<std::size_t>(i)]);
        });
    });
}

}  // namespace ragtop
