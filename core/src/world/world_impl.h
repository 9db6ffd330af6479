#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/aligned_array.h"
#include "base/paged_array.h"
#include "base/pair_set.h"
#include "base/stage_memory.h"
#include "base/stage_runner.h"
#include "base/worker_choice.h"
#include "broadphase/bounds_tree.h"
#include "constraints/constraint_graph.h"
#include "constraints/coupling.h"
#include "constraints/initial_violation.h"
#include "constraints/joint_bundles.h"
#include "constraints/joint_sim.h"
#include "direct/mechanism.h"
#include "direct/newton.h"
#include "direct/tree_plan.h"
#include "narrowphase/collide.h"
#include "narrowphase/collide_surfaces.h"
#include "ragtop/world.h"
#include "shapes/geometry.h"
#include "solve/joint_kernels.h"
#include "solve/kernel_table.h"
#include "world/energy_guard.h"
#include "world/id_lists.h"
#include "world/joint_closing.h"
#include "world/records.h"
#include "world/step_finds.h"
#include "world/swept_motion.h"
#include "world/world_parts.h"
#include "world/world_springs.h"

namespace ragtop {

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
    void moveArticulation(std::uint32_t articulation);
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
    void forgetImpulses(std::uint32_t body);
    void stopOutOfRange();
    bool takes(bool finite, const char* what);
    void restrictInertia(std::uint32_t body);

    // world_pairs.cpp: broad phase.
    void findPairs();
    class PairsMet;
    void findPairsOfMoved(bool obstaclesToo);
    void recordNewVelocity(std::uint32_t body);
    void coverMotion(std::uint32_t body);
    void coverNewVelocities(bool all);
    void refitBounds();
    void createContact(std::uint32_t shapeA, std::uint32_t shapeB);
    void destroyContact(std::uint32_t contact);
    bool shouldCollide(const ShapeRecord& a, const ShapeRecord& b) const;
    void insertProxy(std::uint32_t shape);
    void removeProxy(std::uint32_t shape);
    void markMoved(std::uint32_t shape);
    Bounds tightBounds(const ShapeRecord& shape, float dt) const;
    static Bounds enlarged(const Bounds& bounds, float margin);
    BoundsTree& tree(const ShapeRecord& shape) { return shape.isStaticTree ? staticTree : movingTree; }
    const BoundsTree& tree(const ShapeRecord& shape) const { return shape.isStaticTree ? staticTree : movingTree; }

    // world_collide.cpp: narrow phase.
    void sortAwakeContacts();
    void prefetchCollision(const ContactRecord& contact) const;
    void prefetchShapes(const ContactRecord& contact) const;
    void updateContacts();
    void placePairs(const std::uint32_t* asked, int count, PairPlace* out) const;  // world_pair_places.cpp
    void updateContact(std::uint32_t contact, const PairPlace& place, int worker);
    std::uint8_t keepManifolds(ContactRecord& contact);
    std::uint8_t collideAnew(ContactRecord& contact, const PairPlace& place, double travel, int worker);
    void lookAhead();
    void updateSensors();
    void applyContactChanges();
    void applyContactChange(std::uint32_t contact);
    void recordShiftedLoads();

    // world_order.cpp: contacts in the order of space.
    void orderContacts();
    void sortContactsBySpace();
    void moveContacts();
    void moveManifolds();
    void moveLanes();

    // world_manifolds.cpp: where manifolds and their impulses are kept.
    std::span<ManifoldRecord> manifoldsOf(const ContactRecord& contact) {
        if (contact.firstManifold == kNone) return {};
        return {&manifolds[contact.firstManifold], contact.manifoldCapacity};
    }
    std::span<const ManifoldRecord> manifoldsOf(const ContactRecord& contact) const {
        return const_cast<WorldImpl*>(this)->manifoldsOf(contact);
    }
    template <class Visit>
    void forEachManifold(const ContactRecord& contact, Visit&& visit) const {
        for (std::uint32_t k = 0; contact.firstManifold != kNone && k < contact.manifoldCapacity; ++k)
            visit(contact.firstManifold + k);
    }
    std::uint32_t allotManifolds(std::uint32_t count);
    void releaseManifolds(ContactRecord& contact);
    std::span<ManifoldRecord> holdManifolds(ContactRecord& contact, int worker);
    void makeRoomToHold();
    void settleManifolds(std::uint32_t contact);
    ManifoldImpulses impulsesOf(const ManifoldRecord& manifold) const;
    void storeImpulses(ManifoldRecord& manifold);
    void forgetStored(ManifoldRecord& manifold);
    void writeImpulses(const ContactRecord& contact, const ManifoldRecord& manifold, const ManifoldImpulses& impulses);

    // world_contacts.cpp: manifolds and their lanes.
    bool meetAsSurfaces(const ContactRecord& contact) const;
    int findSurfaceManifolds(const ContactRecord& contact, const Frame& bInA, float margin,
                             std::span<Manifold> found) const;
    int findManifolds(ContactRecord& contact, const Frame& bInA, float margin, std::span<Manifold> found);
    std::uint8_t takeSurfaceManifolds(ContactRecord& contact, std::span<const Manifold> found);
    std::uint8_t takeManifolds(ContactRecord& contact, std::span<const Manifold> found);
    ManifoldRecord& takeFirstManifolds(ContactRecord& contact, std::span<const Manifold> found, int worker);
    void placePoints(const ContactRecord& contact, const Manifold& found, ManifoldRecord& manifold) const;
    void forgetGaps(std::uint32_t body);
    void giveRoom(std::uint32_t body);
    Frame shapeBInA(const ContactRecord& contact) const;
    Vec3 motionAtPoint(const ContactRecord& contact, const ManifoldRecord& manifold, int point) const;
    bool willMeet(const ContactRecord& contact, const ManifoldRecord& manifold, int point) const;
    bool reuseManifolds(ContactRecord& contact, const PairPlace& place, double travel) const;
    bool turnsUnderContact(const ContactRecord& contact) const;
    PlacedManifold placed(const ContactRecord& contact, const ManifoldRecord& manifold) const;
    void writeSurface(const ContactRecord& contact, const ManifoldRecord& manifold);
    void refreshSurfaces(ContactRecord& contact);
    void writeLane(const ContactRecord& contact, const ManifoldRecord& manifold, const ManifoldImpulses& impulses);
    void recordGraphChange(GraphPlace place);
    void addToGraph(std::uint32_t manifold);
    void removeFromGraph(std::uint32_t manifold);
    void addJointToGraph(std::uint32_t joint);
    void removeJointFromGraph(std::uint32_t joint);
    ContactSurface surfaceOf(const ContactRecord& contact, std::uint32_t triangle) const;
    ContactSurface surfaceOfPair(std::uint32_t shapeA, std::uint32_t shapeB, std::uint32_t triangle) const;
    const Material& materialAt(const ShapeRecord& shape, std::uint32_t triangle) const;
    PairInfo pairInfo(const ContactRecord& contact) const;

    // world_seams.cpp: side contacts between neighbouring obstacles.
    void hideSeams();
    void hideSeam(ContactRecord& contact);
    bool mayBeSeam(const ContactRecord& contact, const ManifoldRecord& manifold) const;
    bool bearsLoad(const ManifoldRecord& manifold) const;
    bool closes(const ContactRecord& record, const ManifoldRecord& manifold, float least) const;
    bool slidesInto(const ManifoldRecord& manifold, const Vec3& plane, float least) const;
    Pose startOfStep(std::uint32_t body) const;
    TouchedPlane touchedPlane(const ManifoldRecord& manifold, int side, float within) const;
    bool separates(const TouchedPlane& plane, std::uint32_t front, std::uint32_t behind, float slack) const;
    template <class Visit>
    bool anyTouchedPlane(std::uint32_t body, float within, std::uint32_t except, Visit&& visit) const;
    bool isSeam(const ManifoldRecord& manifold, int side) const;
    bool keptApart(std::uint32_t shape, std::uint32_t obstacle, const Pose& start, const Pose& end, float bulge) const;
    float slackOf(std::uint32_t shapeA, std::uint32_t shapeB) const;

    // world_articulations.cpp
    void findArticulations();
    void listArticulations();
    void countJointsOfArticulations();
    bool isOfFreeTree(std::uint32_t joint) const;
    void classifyJoint(std::uint32_t joint);
    void moveArticulations();

    // world_continuous.cpp
    bool mayMeet(std::uint32_t body, const DVec3& start) const;
    void sweepFastBodies();
    void recordSwept(std::uint32_t index);
    void sweepBody(std::uint32_t body);
    void clearPaths();
    bool meetsAnything(std::uint32_t body) const;
    SweptPath pathOfStep(std::uint32_t body) const;
    void rideAlong(std::uint32_t obstacle, float done, Pose& pose) const;
    Meeting firstMeeting(std::uint32_t body, const Pose& start, const Pose& end, float done, float until) const;
    void sweepMesh(std::uint32_t body, std::uint32_t shape, const Pose& start, const Pose& end, float done, float until,
                   Meeting& first) const;
    bool maySweepInto(std::uint32_t shape, std::uint32_t obstacle) const;

    // world_impacts.cpp
    bool solveMeeting(std::uint32_t body, const Meeting& meeting, float done, Quat& velocityAt, SweptPath& path);
    ContactSurface surfaceOfMeeting(const Meeting& meeting) const;
    void changeVelocity(std::uint32_t body, const Vec3& linear, const Vec3& angular);
    void turnVelocity(std::uint32_t body, const Quat& from, const Quat& to);
    void recordImpact(const Meeting& meeting, const Vec3& normal, const Pose& place, float speed, float impulse);

    // world_islands.cpp: what bears on what, and the choice of solvers.
    void recordForce(std::uint32_t body);
    void beginMeasuring();
    direct::IslandFeatures& islandOf(std::uint32_t body) { return islandFeatures[islandNumber[findRoot(body)]]; }
    void collectSupportEdges();
    void findLevels();
    void estimateLoads(bool pushes);
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
    void iterateIsland(const DirectIsland& island, DirectPass pass);
    bool isDirect(std::uint32_t body) const { return bodies[body].directSteps > 0; }

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

    // islands/sleeping.cpp; of bodies that rest on what does not move: world_freezing.cpp
    void sleepQuietIslands();
    void uniteConstraints(bool touchingOnly);
    void buildIslands();
    std::uint32_t findRoot(std::uint32_t body);
    void unite(std::uint32_t a, std::uint32_t b);
    void wakeBody(std::uint32_t body);
    void restoreContacts(std::uint32_t body);
    void wakeTouching(std::uint32_t body);
    void sleepBody(std::uint32_t body);
    void recordSleep(std::uint32_t body, bool asleep);
    void freezeStillBodies();
    void unfreeze(std::uint32_t body);
    void collectSolved();

    // world_events.cpp
    void publishEvents();
    void findTouches();
    void forgetTouches();
    bool isTouching(ContactRecord& contact);
    void publishContact(std::uint32_t contact);
    void publishSurface(const ContactRecord& contact, const ManifoldRecord& manifold, bool wasLoaded);
    void publishSweptImpacts();
    Contact describe(const ContactRecord& contact, const ManifoldRecord& manifold) const;

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
    void forEachCoupledPair(const std::function<void(std::uint32_t, std::uint32_t)>& visit) const;
    void prepareCouplings(float ratio);
    void warmStartCouplings();
    void beginCouplings();
    void solveCouplings(bool moving);

    std::uint32_t geometryIndex(const Shape& shape);
    void makeSkins();
    void setMass(std::uint32_t body, const BodyDef& def);
    void takeMass(std::uint32_t body, const MassProperties& mass);
    void changeMass(std::uint32_t body, const MassProperties& mass);
    void moveAnchors(std::uint32_t body, const Frame& move);
    void compile(std::uint32_t joint);
    void resetSolverState(std::uint32_t body);
    void storeMomentum(std::uint32_t body);
    void storeMomentum(std::uint32_t body, const Quat& rotation);
    void refreshInertia(std::uint32_t body);
    BodyInertia inverseInertiaAt(std::uint32_t body, const Quat& rotation) const;
    void obeyLocks(std::uint32_t body);
    void setVelocity(std::uint32_t body, const Vec3& linear, const Vec3& angular);
    void refreshBounds(std::uint32_t body);
    void clearEvents();
    void setPose(std::uint32_t body, const Pose& pose);
    void wakeOverlapped(std::uint32_t body);
    Pose poseOf(const BodyRecord& body) const;
    Pose shapePose(const ShapeRecord& shape) const;
    void rebuildLists(IdLists& to) const;
    const IdLists& lists() const;
    void visitContact(std::uint32_t contact, const std::function<void(const Contact&)>& visit) const;
    DVec3 jointCenter(const JointRecord& joint, std::uint32_t body) const;
    JointBodiesAtStep jointBodies(const JointRecord& joint) const;
    JointBodiesAtStep jointBodies(std::uint32_t joint) const;
    Quat definitionRotation(const BodyRecord& body) const { return body.rotation * conjugate(body.local.rotation); }
    /// Is one of the two held by the other, which does not move?
    bool holds(const ContactRecord& contact) const { return moves(contact.bodyA) != moves(contact.bodyB); }
    bool moves(std::uint32_t body) const { return bodies[body].type == BodyType::dynamic && bodies[body].mass > 0; }
    bool isAwake(std::uint32_t body) const { return bodies[body].awakeIndex != kNone; }
    std::uint32_t index(BodyId id) const;
    std::uint32_t index(ShapeId id) const;
    std::uint32_t index(JointId id) const;
    std::uint32_t index(CouplingId id) const;
    BodyId id(std::uint32_t body) const { return {body, bodySlots.generation(body)}; }
    ShapeId shapeId(std::uint32_t shape) const { return {shape, shapeSlots.generation(shape)}; }
    JointId jointId(std::uint32_t joint) const { return {joint, jointSlots.generation(joint)}; }
    CouplingId couplingId(std::uint32_t coupling) const { return {coupling, couplingSlots.generation(coupling)}; }
    std::uint32_t nextContact(std::uint32_t key) const { return contactLinks[key >> 1].edges[key & 1].next; }
    void addAwakeContact(std::uint32_t contact);
    void removeAwakeContact(std::uint32_t contact);

    // world_state.cpp
    template <class Archive>
    void archive(Archive& archive);
    void forgetDerived();
    std::uint64_t hash() const;

    ContactPlaces contactPlaces() const;
    BodyArrays bodyArrays() { return {states.data(), inertias.data(), dynamics.data(), histories.data()}; }
    void beginStage(const char* name);
    void endStages();

    WorldSettings settings;
    WorldCallbacks callbacks;
    std::pmr::memory_resource* memory;
    StageRunner runner;
    WorkerChoice workerChoice;
    const KernelTable* kernels;
    const JointKernels* jointKernels;

    // Saved state.
    Slots bodySlots, shapeSlots, contactSlots, jointSlots, couplingSlots;
    AlignedArray<BodyRecord> bodies;
    AlignedArray<BodyState> states;
    AlignedArray<BodyInertia> inertias;
    AlignedArray<BodyDynamics> dynamics;
    AlignedArray<BodyHistory> histories;
    AlignedArray<std::uint64_t> bodyUserData;
    AlignedArray<ShapeRecord> shapes;
    PagedArray<ContactRecord> contacts;
    PagedArray<ContactLinks> contactLinks;  ///< of each contact
    PagedArray<ManifoldRecord> manifolds;
    MeshMemory meshMemory;
    AlignedArray<std::uint32_t> freeManifolds, freeMeshManifolds, freeStored;
    AlignedArray<ManifoldImpulses> storedImpulses;
    AlignedArray<JointRecord> joints;
    AlignedArray<JointSim> jointSims;
    AlignedArray<std::uint32_t> newVelocityBodies;  ///< BodyRecord::hasNewVelocity, and some that are no more
    AlignedArray<std::uint32_t> newJoints;  ///< made since the last step
    AlignedArray<std::uint32_t> violatedJoints;  ///< joints that were made beyond their hard limits, and are so still
    AlignedArray<CouplingRecord> couplings;
    AlignedArray<CouplingSim> couplingSims;
    AlignedArray<std::uint32_t> awakeBodies, awakeContacts, moveBuffer;
    Multirate multirate;
    ConstraintGraph graph;
    StageMemory stageMemory;  ///< no state, but of the trees
    BoundsTree staticTree, movingTree;
    PairSet pairs;
    std::uint64_t stepCount = 0, structureVersion = 0, fixedVersion = 0;
    double time = 0;
    float lastSubstep = 0;
    std::uint32_t contactsMade = 0;  ///< since they were put in order
    bool graphChanged = true;        ///< since solvers were chosen, as far as support edges are concerned
    bool directChanged = true;     ///< the same where a direct island has part in it
    std::uint64_t choiceStep = 0;  ///< in which solvers were chosen
    bool structureChanged = true;  ///< the same for bodies and joints that were made, moved or woken

    // Derived from the state, or of the current step only.
    std::pmr::vector<GeometryEntry> geometries;
    bool meshesMove = false;  ///< has any dynamic body had a mesh?
    std::vector<StepModule*> modules;
    ModuleWork moduleWork;
    Regions regions;
    JointBundles jointBundles;
    bool bundlesChanged = true;              ///< joints came, went or changed since they were bundled
    Springs springs;
    StageArray<std::uint64_t> contactOrder;  ///< of world_order.cpp, as the two after it
    StageArray<std::uint32_t> movedFrom, movedTo;
    AlignedArray<std::uint8_t> manifoldTouches;  ///< per manifold, a ManifoldTouch at the end of the last step
    AlignedArray<std::uint8_t> laneTouches;      ///< the same per lane of a colour
    bool surfacesForgotten = false;              ///< lanes are to be told anew what the surfaces are
    std::atomic<bool> anySensor{false};      ///< is any awake contact one?
    Freezing freezing;
    std::vector<AlignedArray<ManifoldRecord>> heldManifolds;  ///< per worker: found in this step, without a place yet
    AlignedArray<std::uint8_t> contactChanged;     ///< per awake contact, set by updateContacts, and by findDirty
    AlignedArray<std::uint32_t> dirtyContacts;     ///< that came since events were published, or were struck before
    bool allDirty = true, motionReported = false;  ///< are all contacts to be asked; has any shape told of its motion?
    AlignedArray<ChangedContact> changedContacts;
    AlignedArray<std::uint32_t> shiftedBodies;    ///< that other points of the ground hold than before
    AlignedArray<std::uint32_t> closingContacts;  ///< that may be seams, or woke in this step
    AlignedArray<std::uint32_t> islandParent;     ///< union-find over bodies
    AlignedArray<float> islandQuiet;              ///< s, of the least quiet body of a root
    AlignedArray<std::uint32_t> bodyStack, movedConstraints;
    AlignedArray<std::uint32_t> iteratedCouplings;  ///< of this step: those whose joints are iterated
    Articulations articulations;
    EnergyGuard energyGuard;
    JointClosing jointClosing;
    BoundsLeft boundsLeft;
    StageArray<SupportEdge> supportEdges;  ///< of world_islands.cpp, as the three after it
    StageArray<std::uint32_t> neighbourBegin, neighbours, islandNumber;  ///< per body, of moving ones; per root
    LoadPaths paths;
    AlignedArray<std::uint32_t> freshManifolds;    ///< made in this step, of bodies that have not moved yet
    StageArray<direct::IslandFeatures> islandFeatures;
    AlignedArray<DirectIsland> directIslands;
    AlignedArray<std::uint32_t> directBodies, directManifolds, directJoints;  ///< grouped by island
    AlignedArray<float*> directLanes;
    AlignedArray<JointSim*> directSims;
    AlignedArray<std::uint32_t> directIndex;  ///< per body: of its island, or in it
    std::vector<std::unique_ptr<direct::IslandSystem>> directSystems;  ///< of islands, or free
    AlignedArray<std::uint32_t> systemOwner, systemOfBody;  ///< first body of its island; of those, kNone for all others
    std::vector<std::unique_ptr<direct::Mechanism>> mechanisms;  ///< likewise, where one is
    bool directGrouped = false;
    bool treesChanged = true;  ///< joints, their bodies or their rows, since trees were built
    direct::TreePlan chains;   ///< direct islands that are trees
    AlignedArray<std::uint32_t> treeMark, treeBodies;  ///< per body; in the order of a visit
    AlignedArray<float> directSeen;  ///< bundles of direct islands in the last step
    AlignedArray<std::uint32_t> directOwner;  ///< per slot of theirs: the island
    std::pmr::vector<StepStats::Island> ledger;
    std::uint64_t directFailures = 0, outOfRange = 0;  ///< since the world was made, as in StepStats
    AlignedArray<BodyFlag> bodyFlags;  ///< per awake body, set by finishBodies
    PairSearch pairSearch;
    AlignedArray<SweptImpact> sweptImpacts;  ///< of this step, for its events
    StageArray<StartPose> startPoses;        ///< per awake body, while the step is finished
    SolverContext context;
    bool bouncy = false;      ///< does any contact of this step have restitution?
    bool posesMoved = false;  ///< poses are those of the end of the step, startPoses of its beginning
    JointContext jointContext;
    float dt = 0;
    mutable IdLists idLists;

    std::pmr::vector<ContactEvent> begins, ends, sensorBegins, sensorEnds;
    std::pmr::vector<ContactEvent> endsBetweenSteps, sensorEndsBetweenSteps;  ///< by destroying; told by the next step
    bool stepping = false, inStep = false;  ///< between its poses; from the first module called to the last
    std::pmr::vector<SurfaceEvent> surfaceEvents;
    std::pmr::vector<SleepEvent> sleepEvents, sleepEventsBetweenSteps;
    std::pmr::vector<JointBreak> jointBreaks;
    std::pmr::vector<std::uint32_t> brokenJoints;
    std::pmr::vector<StepStats::Stage> stages;
    std::chrono::steady_clock::time_point stageStart, stepStart;
    double totalMs = 0;
};

}  // namespace ragtop
