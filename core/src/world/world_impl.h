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
#include "constraints/initial_violation.h"
#include "contacts/narrow_phase.h"
#include "contacts/shape_bounds.h"
#include "continuous/meetings.h"
#include "events/contact_events.h"
#include "islands/articulations.h"
#include "islands/direct_set.h"
#include "islands/islands.h"
#include "model/bodies.h"
#include "model/joints.h"
#include "model/shapes.h"
#include "ragtop/world.h"
#include "solve/joint_kernels.h"
#include "solve/kernel_table.h"
#include "world/energy_guard.h"
#include "world/id_lists.h"
#include "world/joint_closing.h"
#include "world/step_finds.h"
#include "world/step_profile.h"
#include "world/world_springs.h"

namespace ragtop {

/// A world: its tables, what stages find in the course of a step, and the step itself. It alone knows all systems;
/// these know what the step hands them. Between two calls every fact of World::validate holds.
struct WorldImpl {
    WorldImpl(const WorldSettings& worldSettings, const WorldConfig& config);

    // world_step.cpp: the stages of a step, in order.
    void step(World& world, double dt);
    void prepareBody(std::uint32_t body);
    void prepareBodies();
    void prepareConstraints();
    void groupContacts();
    bool placeAndPrepare(int color, int begin, int end);
    template <class Count, class Visit>
    void forBlocksOfAllLists(int size, Count&& count, Visit&& visit);
    void prepareJointOf(std::uint32_t joint);
    void prepareJoints();
    void storeJoints();
    void solveSubsteps(World& world);
    void integrateVelocities();
    void warmStart();
    void solve(bool useBias);
    void integratePositions();
    void bounce();
    void finishBody(std::size_t awakePlace);
    void finishBodies();
    void makeRoomToFinish();
    bool leftRange(std::uint32_t body) const;
    void stayPut(std::uint32_t body);
    void forgetImpulses(std::uint32_t body, bool anew = true);
    void stopOutOfRange();
    bool takes(bool finite, const char* what);

    // world_pairs.cpp: pairs of shapes whose bounds have met.
    void createPairs(bool obstaclesToo);
    void updatePairs(bool longer);
    void createContact(std::uint32_t shapeA, std::uint32_t shapeB);
    void destroyContact(std::uint32_t contact);

    // world_collide.cpp: narrow phase.
    void sortAwakeContacts();
    void updateContacts();
    void applyContactChanges();
    void applyContactChange(std::uint32_t contact);
    void recordShiftedLoads();

    // world_contacts.cpp: manifolds and their lanes.
    void forgetGaps(std::uint32_t body);
    void recordGraphChange(GraphPlace place);
    void addToGraph(std::uint32_t manifold);
    void removeFromGraph(std::uint32_t manifold);
    void addJointToGraph(std::uint32_t joint);
    void removeJointFromGraph(std::uint32_t joint);

    // world_continuous.cpp
    void sweepFast();

    // world_islands.cpp: what bears on what, and the choice of solvers.
    void recordForce(std::uint32_t body);
    void beginMeasuring();
    float bucklingShare(const SupportEdge& edge, float load, float number) const;
    bool standsOn(std::uint32_t manifold) const;
    bool isInContact(std::uint32_t body) const;
    void measureIslands();
    bool decideIslands(std::int32_t elapsed);
    void chooseSolvers();

    // world_settling.cpp
    bool isUntouched(std::uint32_t body) const;
    void loadNewContacts();
    void settleNewContacts();
    void settleNewJoints();
    // world_initial_violations.cpp
    void recordInitialViolation(std::uint32_t joint);
    void correctInitialViolations();
    void shiftBody(std::uint32_t index, const Shift& shift);
    void addPushes(float share);

    // world_direct.cpp: islands that are solved directly.
    enum class DirectPass { positions, velocities };
    void applyChoices();
    void groupDirect();
    void numberDirectBodies();
    void beginDirect();
    void assignSystems();
    void recordDirectBundles();
    void addDirectPeaks();
    bool isRenewed(const DirectIsland& island) const;
    void beginIsland(DirectIsland& island, int index);
    void solveDirect(DirectPass pass);
    void solveSystem(DirectIsland& island, DirectPass pass);
    void endDirect();
    void startCooldown(const DirectIsland& island, bool rests);

    // world_trees.cpp: trees of joints, in lanes.
    static bool isTreeJoint(const JointSim& joint);
    bool turnsFreely(std::uint32_t body) const;
    bool buildTree(std::uint32_t start, BuiltTree& built);
    void layLinks(std::uint32_t root, BuiltTree& built);
    void planChains();
    void beginGroup(direct::TreePlan::Group& group);
    void beginChains();
    void solveGroup(direct::TreePlan::Group& group, DirectPass pass, int substep);
    void solveChains(DirectPass pass);
    void storeImpulses(const direct::TreePlan::Group& group, int lane);

    // world_mechanisms.cpp: those with loops, in their own time.
    void planMechanisms();
    bool keepsOwnTime(const DirectIsland& island) const;
    void loadMechanismBody(std::uint32_t index, direct::MechanismBody& body, direct::MechanismPose& pose) const;
    void beginMechanism(const DirectIsland& island, direct::Mechanism& mechanism);
    void readMechanism(const DirectIsland& island, direct::Mechanism& mechanism);
    void readMechanisms();
    void keepPace(const DirectIsland& island, const direct::Mechanism& mechanism);
    void writeMechanism(const DirectIsland& island, direct::Mechanism& mechanism);
    void storeLoads(const DirectIsland& island, direct::Mechanism& mechanism);
    void solveMechanism(DirectIsland& island, direct::Mechanism& mechanism, DirectPass pass);

    // world_sleep.cpp; of bodies that rest on what does not move: world_freezing.cpp
    void sleepQuietIslands();
    void wakeBody(std::uint32_t body);
    void wakeStack();
    void enterAwake(std::uint32_t body);
    void leaveAwake(std::uint32_t body);
    void restoreContacts(std::uint32_t body);
    void wakeTouching(std::uint32_t body);
    void sleepBody(std::uint32_t body);
    void recordSleep(std::uint32_t body, bool asleep);
    void freezeStillBodies();
    void unfreeze(std::uint32_t body);
    void collectSolved();

    // world_bodies.cpp, world_joints.cpp
    std::uint32_t createBody(const BodyDef& def);
    void addShape(std::uint32_t body, const ShapeDef& def, const Frame& frame, const Shape& geometry,
                  const Frame& toInternal);
    void destroyBody(std::uint32_t body);
    std::uint32_t createJoint(const JointDef& def);
    void breakJoints();
    void destroyJoint(std::uint32_t joint);

    // world_couplings.cpp
    std::uint32_t createCoupling(const CouplingDef& def);
    void destroyCoupling(std::uint32_t coupling);
    void checkCoupled(const CouplingDef& def) const;
    void pushCoupledBodies(std::uint32_t joint);
    bool isIterated(const CouplingDef& coupling) const;
    void prepareCouplings(float ratio);
    void warmStartCouplings();
    void beginCouplings();
    void solveCouplings(bool moving);

    // world_types.cpp
    void setType(std::uint32_t body, BodyType type);
    void setEnabled(std::uint32_t body, bool enabled);
    void takePart(std::uint32_t body, BodyType type, bool enabled);
    void withdraw(std::uint32_t body);
    void settleRole(std::uint32_t body);
    void becomeSolid(std::uint32_t body);
    bool mayHold(const JointRecord& joint) const;

    void setMass(std::uint32_t body, const BodyDef& def);
    MassProperties massOf(std::uint32_t body) const;
    void takeMass(std::uint32_t body, const MassProperties& mass);
    void changeMass(std::uint32_t body, const MassProperties& mass);
    void moveAnchors(std::uint32_t body, const Frame& move);
    void compile(std::uint32_t joint);
    void resetSolverState(std::uint32_t body);
    void setVelocity(std::uint32_t body, const Vec3& linear, const Vec3& angular);
    void refreshBounds(std::uint32_t body);
    void setPose(std::uint32_t body, const Pose& pose);
    void wakeOverlapped(std::uint32_t body);
    void rebuildLists(IdLists& to) const;
    const IdLists& lists() const;
    void visitContact(std::uint32_t contact, const std::function<void(const Contact&)>& visit) const;
    DVec3 jointCenter(const JointRecord& joint, std::uint32_t body) const;
    JointBodiesAtStep jointBodies(const JointRecord& joint) const;
    JointBodiesAtStep jointBodies(std::uint32_t joint) const;
    std::uint32_t index(BodyId id) const;
    std::uint32_t index(ShapeId id) const;
    std::uint32_t index(JointId id) const;
    std::uint32_t index(CouplingId id) const;
    void addAwakeContact(std::uint32_t contact);

    // world_state.cpp
    template <class Archive>
    void archive(Archive& archive);
    void forgetDerived();
    std::uint64_t hash() const;

    ConstTables tables() const { return {bodies, shapes, contacts, manifolds, joints, couplings, graph}; }
    /// Of the stages before poses move; those after them give the poses of the beginning.
    GhostView ghostView(std::span<const StartPose> starts = {}) const { return {tables(), starts, dt, context.h}; }
    ContactPlaces contactPlaces() const;
    // What systems are handed that read and write several tables.
    ShapeBounds shapeBounds() { return {bodies, shapes, broadphase, dt}; }
    ContactWriter contactWriter() {
        return {bodies,    shapes,     contacts, manifolds, graph, callbacks, contactFinds.surfacesForgotten,
                context.h, lastSubstep};
    }
    NarrowPhase narrowPhase() {
        return {bodies, shapes, contacts, manifolds, broadphase, contactFinds, contactWriter(), ghostView(), dt};
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
    std::uint64_t structureVersion = 0, fixedVersion = 0;
    std::vector<StepModule*> modules;

    // Of the current step, or kept from one to the next while nothing changes.
    DirectSet directSet;
    ModuleWork moduleWork;
    Regions regions;
    Springs springs;
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
