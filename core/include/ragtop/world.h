#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <memory_resource>
#include <span>
#include <string>
#include <vector>

#include "ragtop/body.h"
#include "ragtop/coupling.h"
#include "ragtop/debug_draw.h"
#include "ragtop/events.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/module.h"
#include "ragtop/query.h"
#include "ragtop/settings.h"
#include "ragtop/tasks.h"

namespace ragtop {

class CommandBuffer;
struct WorldImpl;

/// What a world is made with; it cannot be changed later.
struct WorldConfig {
    TaskRunner tasks{};                              ///< threads of a step; default: the calling one
    /// SIMD width of the solver: 4, 8 or 16; 0: the machine's best. Less where the machine has less: 8 without AVX-512,
    /// 4 without AVX2. Changes no result.
    int lanes = 0;
    /// Null: std::pmr::get_default_resource(). Must outlive the world, and be thread safe where it has several workers.
    std::pmr::memory_resource* memory = nullptr;
    int expectedBodies = 0;                        ///< bodies for which memory is set aside at creation
};

/// The pair of shapes that a filter or modify callback is asked about.
struct PairInfo {
    ShapeId shapeA, shapeB;
    BodyId bodyA, bodyB;
    std::uint64_t userDataA = 0, userDataB = 0;  ///< of the shapes
};
/// What a modify callback may change about a contact before it is solved; units as in Material.
struct ContactSurface {
    float friction = 0, slidingShare = 1, restitution = 0, rollingResistance = 0, spinningResistance = 0;
    Vec3 grain;               ///< direction in world axes, of any length; zero: none
    float crossFriction = 1;  ///< the coefficient across the grain over that along it, above zero
    Vec3 surfaceVelocity;  ///< m/s, of B's surface relative to A's beyond the bodies' motion, world axes
    bool enabled = true;   ///< false: the contact does nothing in this step
};

/// Profiling zones and callbacks. Those marked (threads) run on several threads at once, must be thread safe, must
/// not call the world, and must decide by their arguments alone so that results stay reproducible. None may throw.
struct WorldCallbacks {
    std::function<bool(const PairInfo&)> filter;                   ///< (threads) false: the pair does not collide
    std::function<void(const PairInfo&, ContactSurface&)> modify;  ///< (threads) for each touching pair in each step
    std::function<void(const char* zone)> beginZone;               ///< a stage of the step begins; calling thread
    std::function<void(const char* zone)> endZone;                 ///< it ends
};

/// What the last step took and did, and counters since the world was made.
struct StepStats {
    struct Stage {
        const char* name;  ///< as in docs/step.md
        double ms;
    };
    /// An island that was solved directly; all others were solved by iteration.
    struct Island {
        const char* reason;      ///< why, as in docs/adr/0016, "asked" by the settings, or "staying" for a while
        int bodies, contacts, joints;
        int iterations, factorizations;  ///< Newton's, of all substeps
        double residual;         ///< of the last solve, over its impulses
        double ms;
        bool solved;             ///< false: given up, and left to iteration for some steps
    };
    std::span<const Stage> stages;    ///< in order, until the next step; of few bodies those of one step in 17
    std::span<const Island> islands;  ///< likewise
    std::uint64_t directFailures = 0;  ///< direct solves that did not converge, since the world was made
    /// Since the world was made: bodies stopped where a step began, because forces took them beyond the range of
    /// numbers (1e15 m away, or so far in a step), and forces of modules that were left out because they were no
    /// numbers.
    std::uint64_t outOfRange = 0;
    /// Since the world was made: times that a group of jointed bodies had gained energy that nothing gave it and that
    /// was taken back, and how much, J.
    std::uint64_t energyGuarded = 0;
    double energyTaken = 0;
    /// Since the world was made: times that a group of jointed bodies was moved because a step had left a joint open,
    /// or beyond a limit, by more than a fiftieth of its smaller body's size, or rad.
    std::uint64_t jointsClosed = 0;
    /// Those of them whose step was cut short, because its end could not be closed.
    std::uint64_t stepsCut = 0;
    /// Since the world was made: impulses of modules on bodies that they had not named, which were left out.
    std::uint64_t strayImpulses = 0;
    double totalMs = 0;  ///< of the last step
    /// The part of the stage "solve" that was spent in modules between substeps, where all bodies go through these
    /// together.
    double modulesMs = 0;
    /// `contacts` are pairs whose bounds overlap, `touching` the awake ones that touch, `colors` those of the graph.
    int bodies = 0, awakeBodies = 0, contacts = 0, touching = 0, joints = 0, colors = 0;
    /// Awake bodies that went through the substeps together, and that did so by themselves, such as chains that touch
    /// nothing. The rest are frozen and left out.
    int solvedBodies = 0, independentBodies = 0;
    int regions = 0;        ///< island batches, each of which one worker took through all substeps
    std::size_t bytes = 0;  ///< memory that the world holds
};

/// A world of rigid bodies. Members are called from one thread at a time; const members (queries, reads) from any
/// number of threads at once between steps. Other threads change a world through command buffers (docs/threading.md).
/// Creating throws std::invalid_argument that names the field, its value and what is allowed; an argument that is an id
/// of nothing throws std::out_of_range. Stepping never throws.
class World {
public:
    /// Throws std::invalid_argument when a setting is not allowed.
    explicit World(const WorldSettings& settings = {}, const WorldConfig& config = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    const WorldSettings& settings() const;
    /// Throws std::invalid_argument and changes nothing when a value is not allowed.
    void setSettings(const WorldSettings& settings);
    void setCallbacks(WorldCallbacks callbacks);
    int lanes() const;  ///< SIMD width in use

    /// Advances by dt seconds, above zero and finite; anything else asserts in debug builds and does nothing.
    void step(double dt);
    std::uint64_t stepCount() const;  ///< steps made so far
    double time() const;              ///< s, sum of their dt
    StepStats stats() const;          ///< of the last step

    BodyId create(const BodyDef& def);
    BodyId create(const StaticBody& def);
    BodyId create(const DynamicBody& def);
    JointId create(const JointDef& def);
    /// Couples joints that exist already; destroyed with the first of them that is destroyed.
    CouplingId create(const CouplingDef& def);
    /// Destroys a body with its shapes, contacts and joints; bodies that it touched wake.
    void destroy(BodyId body);
    void destroy(JointId joint);
    void destroy(CouplingId coupling);
    bool isValid(BodyId body) const;  ///< does the id name something that exists?
    bool isValid(ShapeId shape) const;
    bool isValid(JointId joint) const;
    bool isValid(CouplingId coupling) const;
    /// All bodies, joints and couplings, in the order of their index.
    std::span<const BodyId> bodies() const;
    std::span<const JointId> joints() const;
    std::span<const CouplingId> couplings() const;

    // Bodies. The pose is that of the definition's frame; velocities are those of the centre of mass.
    Pose pose(BodyId body) const;
    DVec3 centerOfMass(BodyId body) const;
    Vec3 linearVelocity(BodyId body) const;
    Vec3 angularVelocity(BodyId body) const;
    Vec3 velocityAt(BodyId body, const DVec3& point) const;  ///< m/s, of a point of the body in the world
    BodyType type(BodyId body) const;
    /// Changes what moves a body, which keeps its id, shapes, joints and place. From dynamic to kinematic and back it keeps
    /// its velocity; fixed, it has none. What becomes dynamic has the mass that it had as such, else that of its shapes
    /// and their densities. What touches it or is joined to it wakes; joints of two bodies that no force moves rest.
    /// Throws std::invalid_argument and changes nothing where a dynamic body cannot have such shapes, and
    /// std::logic_error within a step.
    void setType(BodyId body, BodyType type);
    /// Takes a body out of the world: it stays where it is, meets nothing, is found by no query, and its joints hold
    /// nothing; and puts it back with the velocity that it had, its joints as if they were made then. What touches it or
    /// is joined to it wakes. Throws std::logic_error within a step.
    void setEnabled(BodyId body, bool enabled);
    bool isEnabled(BodyId body) const;
    MassProperties mass(BodyId body) const;  ///< in the body's frame
    bool isAwake(BodyId body) const;
    /// The number of groups of awake dynamic bodies that touch or are joined. The call searches for them.
    int countIslands() const;
    /// For each of bodies() the first body of its group; null if it sleeps or is not dynamic.
    std::vector<BodyId> islands() const;
    std::uint64_t userData(BodyId body) const;
    std::span<const ShapeId> shapes(BodyId body) const;
    std::span<const JointId> jointsOf(BodyId body) const;
    void setPose(BodyId body, const Pose& pose);  ///< puts it there at once, without regard to what is in the way
    /// m/s, rad/s. A kinematic body goes by them on the mean of a step; where they change alike from step to step, it
    /// speeds up evenly within each.
    void setVelocity(BodyId body, const Vec3& linear, const Vec3& angular);
    void setGravityScale(BodyId body, float scale);
    float gravityScale(BodyId body) const;
    /// Changes mass, centre and inertia of a body (fuel, freight). Its pose and the motion of its points stay. A kinematic
    /// one has them once it is dynamic. Throws std::invalid_argument and changes nothing when a value is not allowed.
    void setMass(BodyId body, const MassProperties& mass);
    /// Gives a kinematic body the velocity that takes it to `target` in the next step of dt seconds.
    void moveTo(BodyId body, const Pose& target, double dt);
    void applyImpulse(BodyId body, const Vec3& impulse, const DVec3& point);  ///< N s, at a point in the world
    void applyAngularImpulse(BodyId body, const Vec3& impulse);               ///< N m s
    /// N and N m; they act during the next step only.
    void applyForce(BodyId body, const Vec3& force, const DVec3& point);
    void applyTorque(BodyId body, const Vec3& torque);
    void wake(BodyId body);
    /// Puts a body with its island to sleep now.
    void sleep(BodyId body);

    // Shapes.
    BodyId bodyOf(ShapeId shape) const;
    /// The shape as it was defined; Compound parts are shapes of their own.
    const Shape& geometry(ShapeId shape) const;
    Frame frame(ShapeId shape) const;  ///< in its body
    /// Moves a shape in its body, which wakes where that is a change; the body's mass stays as it is. Between steps, or
    /// in StepModule::beforeStep. Contacts learn of the place, and not of a speed with which it was reached. Throws
    /// std::invalid_argument on a frame that is not finite.
    void setFrame(ShapeId shape, const Frame& frame);
    bool givesWay(ShapeId shape) const;  ///< ShapeDef::givesWay
    Material material(ShapeId shape) const;
    void setMaterial(ShapeId shape, const Material& material);
    void setFilter(ShapeId shape, const Filter& filter);
    std::uint64_t userData(ShapeId shape) const;
    Bounds bounds(ShapeId shape) const;  ///< at the pose of now, rounded outwards

    // Joints. setDef changes limits, motors, springs, friction and targets, keeping the impulses; it may not change
    // the type or the bodies.
    const JointDef& def(JointId joint) const;
    void setDef(JointId joint, const JointDef& def);
    /// Sets targets, gains and bounds of the springs of balls and hinges, with the result of setDef in a fraction of
    /// its time and without memory: nothing else of the joints is checked. Sleepers stay asleep while their drives stay
    /// the same. Throws std::invalid_argument that names the drive and its field, and changes nothing then.
    void setDrives(std::span<const JointDrive> drives);
    JointState state(JointId joint) const;
    std::uint64_t userData(JointId joint) const;

    // Couplings. setDef changes ratios and what acts along the sum, keeping the impulse; it may not change the joints.
    const CouplingDef& def(CouplingId coupling) const;
    void setDef(CouplingId coupling, const CouplingDef& def);
    CouplingState state(CouplingId coupling) const;
    std::uint64_t userData(CouplingId coupling) const;

    // Events and contacts of the last step.
    std::span<const ContactEvent> contactBegins() const;
    std::span<const ContactEvent> contactEnds() const;
    std::span<const ContactEvent> sensorBegins() const;
    std::span<const ContactEvent> sensorEnds() const;
    std::span<const SurfaceEvent> surfaceEvents() const;
    std::span<const SleepEvent> sleepEvents() const;
    std::span<const JointBreak> jointBreaks() const;
    /// Calls `visit` for each pair that touches: that has a point with load or overlap.
    void forEachContact(const std::function<void(const Contact&)>& visit) const;
    void forEachContact(BodyId body, const std::function<void(const Contact&)>& visit) const;

    // Queries.
    Hit castRay(const Ray& ray, const QueryFilter& filter = {}) const;  ///< the nearest shape that the ray meets
    /// The first shape that a sphere, capsule, box or hull meets on its way along `path`, with the given rotation.
    Hit castShape(const Shape& shape, const Quat& rotation, const Ray& path, const QueryFilter& filter = {}) const;
    /// Many rays on the world's threads; results[i] belongs to rays[i]. Throws std::invalid_argument if it is shorter.
    void castRays(std::span<const Ray> rays, std::span<Hit> results, const QueryFilter& filter = {}) const;
    /// Calls `visit` for each shape that overlaps the given one at `pose`, until it returns false.
    void overlap(const Shape& shape, const Pose& pose, const std::function<bool(ShapeId)>& visit,
                 const QueryFilter& filter = {}) const;
    void overlap(const Bounds& bounds, const std::function<bool(ShapeId)>& visit, const QueryFilter& filter = {}) const;

    // Changes from jobs.
    /// Applies the buffers in the order of their keys. A command that throws is left out; the first exception is thrown
    /// when all others are done.
    void apply(std::span<CommandBuffer* const> buffers);

    // State. Saving copies everything that a step reads or writes, ids included, into memory of the caller; restoring
    // brings it back bit for bit into this world, or into one that was built by the same calls.
    std::size_t saveSize() const;
    /// Bytes written; `into` must hold saveSize(). Throws std::length_error otherwise.
    std::size_t save(std::span<std::byte> into) const;
    /// Throws std::invalid_argument and changes nothing when the bytes are no state of such a world.
    void restore(std::span<const std::byte> from);
    /// A 64-bit digest of the state that decides the future: poses, velocities, impulses, modules.
    std::uint64_t hash() const;
    /// The first fact that does not hold of the world's own tables, lists and constraint graph, in words; empty when
    /// all do, as between any two calls. For tests and bug reports: about as slow as a save, and takes memory.
    std::string validate() const;
    /// Vehicles, ragdolls and games take part in steps and saves as modules; see module.h.
    void add(StepModule* module);
    /// Changes whenever a fixed body is moved, destroyed, made or unmade by setType, or taken out or put back by setEnabled,
    /// and when a state is restored. While it stays the same, a
    /// module that sleeps on fixed ground need not look at it again.
    std::uint64_t fixedVersion() const;
    void remove(StepModule* module);

    /// Kinetic and potential energy of the dynamic bodies, J; potential is zero at the world's origin.
    double energy() const;
    void draw(DebugDraw& draw) const;  ///< as draw.options say

private:
    friend struct WorldImpl;
    std::unique_ptr<WorldImpl> impl_;
};

}  // namespace ragtop
