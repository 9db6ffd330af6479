#pragma once

#include <cstdint>
#include <functional>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/stage_memory.h"
#include "base/stage_runner.h"
#include "base/worker_choice.h"
#include "broadphase/broadphase.h"
#include "constraints/constraint_graph.h"
#include "contacts/narrow_phase.h"
#include "contacts/shape_bounds.h"
#include "continuous/meetings.h"
#include "events/contact_events.h"
#include "islands/direct_view.h"
#include "iteration/iteration.h"
#include "model/bodies.h"
#include "model/indices.h"
#include "model/joint_bodies.h"
#include "model/shapes.h"
#include "ragtop/world.h"
#include "scene/scene.h"
#include "world/energy_guard.h"
#include "world/id_lists.h"
#include "world/joint_closing.h"
#include "world/step_profile.h"

namespace ragtop {

/// A world: its tables, what stages find in the course of a step, and the step itself. It alone knows all systems;
/// these know what the step hands them. Between two calls every fact of World::validate holds.
struct WorldImpl {
    WorldImpl(const WorldSettings& worldSettings, const WorldConfig& config);

    // world_step.cpp: the stages of a step, in order.
    void step(World& world, double dt);
    void prepareBody(std::uint32_t body);
    void prepareBodies();
    void solveSubsteps(World& world);
    void finishBody(std::size_t awakePlace);
    void finishBodies();
    void makeRoomToFinish();
    void stopOutOfRange();
    bool takes(bool finite, const char* what);

    // world_pairs.cpp: pairs of shapes whose bounds have met.
    void createPairs(bool obstaclesToo);
    void updatePairs(bool longer);

    void updateContacts();

    // world_continuous.cpp
    void sweepFast();

    // world_islands.cpp: what bears on what, and the choice of solvers.
    void chooseSolvers();

    void setVelocity(std::uint32_t body, const Vec3& linear, const Vec3& angular);

    // world_state.cpp
    template <class Archive>
    void archive(Archive& archive);
    void forgetDerived();
    std::uint64_t hash() const;

    ConstTables tables() const { return {bodies, shapes, contacts, manifolds, joints, couplings, graph}; }
    /// Of the stages before poses move; those after them give the poses of the beginning.
    GhostView ghostView(std::span<const StartPose> starts = {}) const { return {tables(), starts, dt, context.h}; }
    // What systems are handed that read and write several tables.
    ShapeBounds shapeBounds() { return {bodies, shapes, broadphase, dt}; }
    ContactWriter contactWriter() {
        return {bodies,    shapes,     contacts, manifolds, graph, callbacks, contactFinds.surfacesForgotten,
                context.h, lastSubstep};
    }
    NarrowPhase narrowPhase() {
        return {bodies, shapes, contacts, manifolds, broadphase, contactFinds, contactWriter(), ghostView(), dt};
    }
    Activity activity() {
        return {bodies,     shapes,  contacts,      manifolds, joints,       couplings, graph,
                broadphase, islands, articulations, directSet, contactFinds, events,    contactWriter()};
    }
    Scene scene() {
        return {bodies,     shapes,           contacts,      manifolds, joints,       couplings,
                broadphase, islands,          articulations, directSet, contactFinds, events,
                versions,   settings.gravity, shapeBounds(), activity()};
    }
    DirectView directView() {
        return {bodies,     joints,  contacts,     manifolds, graph,  islands, directSet,
                moduleWork, context, jointContext, *kernels,  runner, memory,  settings.substeps};
    }
    Iteration iteration() {
        return {tables(),      bodies,    manifolds, joints,        couplings, graph,        regions,
                articulations, directSet, *kernels,  *jointKernels, context,   jointContext, runner};
    }
    ContactEvents contactEvents() {
        return {bodies,
                shapes,
                contacts,
                manifolds,
                graph,
                sweptBodies,
                *kernels,
                contactFinds,
                events,
                length(settings.gravity),
                context.restitutionSpeed};
    }

    WorldSettings settings;
    WorldCallbacks callbacks;
    std::pmr::memory_resource* memory;
    StageRunner runner;
    WorkerChoice workerChoice;
    const KernelTable* kernels;
    const JointKernels* jointKernels;

    // The tables, which own what is saved, and what is derived from it.
    Bodies bodies;
    Shapes shapes;
    Contacts contacts;
    Manifolds manifolds;
    Joints joints;
    Couplings couplings;
    ConstraintGraph graph;
    StageMemory stageMemory;  ///< no state, but of the trees
    Broadphase broadphase;
    Islands islands;
    EventLog events;
    std::uint64_t stepCount = 0;
    double time = 0;
    float dt = 0, lastSubstep = 0;  ///< s, of the last step
    Versions versions;

    // Of the current step, or kept from one to the next while nothing changes.
    DirectSet directSet;
    ModuleWork moduleWork;
    Regions regions;
    Freezing freezing;
    Articulations articulations;
    EnergyGuard energyGuard;
    JointClosing jointClosing;
    ContactFinds contactFinds;
    SweptBodies sweptBodies;
    SolverContext context;
    JointContext jointContext;
    bool bouncy = false;                    ///< does any contact of this step have restitution?
    bool stepping = false, inStep = false;  ///< between its poses; from the first module called to the last
    std::uint64_t outOfRange = 0;           ///< since the world was made, as in StepStats
    StepProfile profile;
    mutable IdLists idLists;
};

}  // namespace ragtop
