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
    world.iteration().storeJoints();
    endDirect(world.directView());
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
        activity().applyContactChanges(ghostView(), settings.sleeping);
        leaveOutGhosts(ghostView(), {contactFinds.closing.begin(), contactFinds.closing.end()}, contacts, graph,
                       runner);
        profile.beginStage("islands", callbacks);
        chooseSolvers();
        activity().collectSolved(freezing, moduleWork, !callbacks.modify);  // what is told of contacts expects all
        chooseStepFactors(*this);
        divideIntoRegions(*this);
        profile.beginStage("prepare", callbacks);
        prepareBodies();
        articulations.find(tables(), directSet);
        scene().settleNewJoints();
        beginGuard(*this);
        bouncy = iteration().prepare(lastSubstep);
        collectRegions(*this);
        beginDirect(directView());
        profile.beginStage("solve", callbacks);
        runner.part(!shareSolve, [&] { solveSubsteps(world); });
        makeRoomToFinish();
        endSolve(*this);
        profile.beginStage("finish", callbacks);
        finishBodies();
        stopOutOfRange();
        scene().correctInitialViolations();
        sweepFast();
        closeOpenJoints(*this);
        shapeBounds().refit(sweptBodies.startPoses(), runner);
        profile.beginStage("events", callbacks);
        narrowPhase().updateSensors(runner);
        contactEvents().publish(runner);
        profile.beginStage("sleep", callbacks);
        activity().freezeStillBodies(freezing, moduleWork, !callbacks.modify);
        if (settings.sleeping) activity().sleepQuietIslands(tables(), settings.sleepTime);
    });

    stepping = false;
    events.endStep();
    scene().breakJoints(dt);
    lastSubstep = context.h;
    ++stepCount;
    time += stepSeconds;
    profile.beginStage("modules after", callbacks);
    for (StepModule* module : moduleWork.modules)
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

}  // namespace ragtop
