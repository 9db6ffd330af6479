#pragma once

#include <cstdint>
#include <memory_resource>

#include "activity/activity.h"
#include "base/stage_memory.h"
#include "base/stage_runner.h"
#include "base/worker_choice.h"
#include "broadphase/broadphase.h"
#include "contacts/tables.h"
#include "continuous/swept_bodies.h"
#include "iteration/regions.h"
#include "model/kinematic_slopes.h"
#include "ragtop/world.h"
#include "scene/scene.h"
#include "solve/joint_kernels.h"
#include "solve/kernel_table.h"
#include "world/energy_guard.h"
#include "world/id_lists.h"
#include "world/joint_closing.h"
#include "world/step_profile.h"

/// The parts of a world, each what one question is answered from.
namespace ragtop {

/// With what is it computed? Memory, threads and lanes: no result depends on them.
struct Machine {
    explicit Machine(const WorldConfig& config);

    std::pmr::memory_resource* memory;
    StageRunner runner;
    WorkerChoice workerChoice;
    const KernelTable* kernels;
    const JointKernels* jointKernels;
    StageMemory stageMemory;  ///< taken in turns by stages that need it for themselves
};

/// What is there? All of it is saved, or derived from what is.
struct Tables {
    explicit Tables(const Machine& machine)
        : bodies(machine.memory),
          shapes(machine.memory),
          contacts(machine.memory),
          manifolds(machine.runner.workers(), machine.memory),
          joints(machine.jointKernels->lanes, machine.memory),
          couplings(machine.memory),
          graph(machine.kernels->lanes, machine.memory),
          slopes(machine.memory) {}
    operator ConstTables() const { return {bodies, shapes, contacts, manifolds, joints, couplings, graph}; }

    Bodies bodies;
    Shapes shapes;
    Contacts contacts;
    Manifolds manifolds;
    Joints joints;
    Couplings couplings;
    ConstraintGraph graph;
    KinematicSlopes slopes;
    Versions versions;
};

/// What meets what? Bounds and pairs, which are saved; what a step finds of contacts, and of bodies that went far.
struct Collision {
    explicit Collision(Machine& machine)
        : broadphase(machine.memory, machine.stageMemory), finds(machine.memory), swept(machine.memory) {}

    Broadphase broadphase;
    ContactFinds finds;
    SweptBodies swept;
};

/// What hangs together, and who solves it? Kept from step to step while nothing changes.
struct Partition {
    explicit Partition(std::pmr::memory_resource* memory) : islands(memory), articulations(memory), direct(memory) {}

    Islands islands;
    Articulations articulations;
    DirectSet direct;
};

/// When is it? Saved, but for where in a step it is.
struct StepClock {
    std::uint64_t stepCount = 0;
    double time = 0;                ///< s
    float dt = 0, lastSubstep = 0;  ///< s, of the last step
    bool stepping = false;          ///< between the poses of a step
    bool inStep = false;            ///< from the first module called to the last
};

/// What do the substeps of a step have in common? Constants, the bodies that take part, and who shares them out.
struct Solving {
    explicit Solving(std::pmr::memory_resource* memory) : freezing(memory), regions(memory) {}
    /// For a step of dt seconds.
    void begin(const WorldSettings& settings, float dt);

    SolverContext context;
    JointContext jointContext;
    bool bouncy = false;  ///< does any contact of this step have restitution?
    Freezing freezing;
    Regions regions;
};

/// Is what was solved lawful? What mends it where it is not, and counts that.
struct Guards {
    explicit Guards(std::pmr::memory_resource* memory) : energy(memory), closing(memory) {}

    EnergyGuard energy;
    JointClosing closing;
    std::uint64_t outOfRange = 0;  ///< since the world was made, as in StepStats
};

/// What is told to callers beside events? Derived.
struct Reports {
    StepProfile profile;
    mutable IdLists idLists;
};

}  // namespace ragtop
