#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <memory_resource>
#include <span>
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

/// What a world is made with and keeps.
struct WorldConfig {
    TaskRunner tasks{};                              ///< default: the calling thread
    /// Width of the solver, 4, 8 or 16; 0: the machine's best. Without AVX2 it is 4 whatever is asked for.
    int lanes = 0;
    /// Default: std::pmr::get_default_resource(). Outlives the world; with several workers it must be thread safe.
    std::pmr::memory_resource* memory = nullptr;
    int expectedBodies = 0;                        ///< memory set aside at creation
};

/// A call of the filter or modify callback tells of one pair of shapes.
struct PairInfo {
    ShapeId shapeA, shapeB;
    BodyId bodyA, bodyB;
    std::uint64_t userDataA = 0, userDataB = 0;  ///< of the shapes
};
/// What a modify callback may change in a contact before it is solved.
struct ContactSurface {
    float friction = 0, slidingShare = 1, restitution = 0, rollingResistance = 0, spinningResistance = 0;
    Vec3 grain;               ///< world axes, of any length; zero: none
    float crossFriction = 1;  ///< the coefficient across the grain over that along it, above zero
    Vec3 surfaceVelocity;  ///< m/s, of B's surface relative to A's beyond the bodies' motion, world axes
    bool enabled = true;
};

/// Profiling zones and callbacks. Those marked (threads) run on several threads at once, must be thread safe, must
/// not call the world, and must decide by their arguments alone so that results stay reproducible. None may throw.
struct WorldCallbacks {
    std::function<bool(const PairInfo&)> filter;                   ///< (threads) false: the pair does not collide
    std::function<void(const PairInfo&, ContactSurface&)> modify;  ///< (threads) once per touching pair and step
    std::function<void(const char* zone)> beginZone;               ///< a stage of the step begins, calling thread
    std::function<void(const char* zone)> endZone;
};

/// Time and counts of the last step.
struct StepStats {
    struct Stage {
        const char* name;
        double ms;
    };
    /// An island that was solved directly; all others were solved by iteration.
    struct Island {
        const char* reason;      ///< why: asked, heavy, tall, slender, deep, taut, leaning, tree, loop, stiff, or staying for a while
        int bodies, contacts, joints;
        int iterations, factorizations;  ///< Newton's, of all substeps
        double residual;         ///< of the impulses in the last solve, relative
        double ms;
        bool solved;  ///< false: it did not converge, and is left to iteration for some steps
    };
    std::span<const Stage> stages;    ///< in order; valid until the next step
    std::span<const Island> islands;  ///< likewise
    std::uint64_t directFailures = 0;  ///< direct solves that did not converge, since the world was made
    /// Times since the world was made that a body was stopped where a step began, as forces beyond all measure took it out
    /// of numbers (1e15 m, or that in a step), or that a module asked for a force that is none, and which is left out.
    std::uint64_t outOfRange = 0;
    /// Times that bodies held together by joints had gained energy that nothing gave them, which was taken back, since the
    /// world was made; and how much, J.
    std::uint64_t energyGuarded = 0;
    double energyTaken = 0;
    /// Times that a group of bodies held together by joints was moved to close joints that a step had left open, since the
    /// world was made.
    std::uint64_t jointsClosed = 0;
    /// Times since the world was made that a module pushed a body between substeps that it had not named, which is left out.
    std::uint64_t strayImpulses = 0;
    double totalMs = 0;
    /// What of the stage "solve" the last step spent in modules between its substeps, where all bodies went through these
    /// together.
    double modulesMs = 0;
    int bodies = 0, awakeBodies = 0, contacts = 0, touching = 0, joints = 0, colors = 0;
    /// What the last step did of its awake bodies: went through its substeps together; by themselves, as chains that nothing
    /// touches do. The rest were at rest and left out.
    int solvedBodies = 0, independentBodies = 0;
    int regions = 0;        ///< into which it divided them, each of which went through the substeps by itself
    std::size_t bytes = 0;  ///< memory held
};

/// A rigid body world. All members may be called from one thread at a time; the const ones (queries, reads) from any
/// number of threads at once between steps. Other threads change a world through command buffers (docs/threading.md).
/// Creating throws std::invalid_argument that says which field is wrong; an id that names nothing throws
/// std::out_of_range where it is an argument. Stepping never throws.
class World {
public:
    explicit World(const WorldSettings& settings = {}, const WorldConfig& config = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    const WorldSettings& settings() const;
    /// Throws std::invalid_argument and changes nothing when a value is not allowed.
    void setSettings(const WorldSettings& settings);
    void setCallbacks(WorldCallbacks callbacks);
    int lanes() const;

    /// Advances by dt seconds, above zero and finite; anything else asserts in debug builds and does nothing.
    void step(double dt);
    std::uint64_t stepCount() const;
    double time() const;
    StepStats stats() const;

    BodyId create(const BodyDef& def);
    BodyId create(const StaticBody& def);
    BodyId create(const DynamicBody& def);
    JointId create(const JointDef& def);
    /// Between joints of this world that are there already. It is destroyed with the first of them.
    CouplingId create(const CouplingDef& def);
    /// Destroys a body with its shapes, contacts and joints; what it touched wakes.
    void destroy(BodyId body);
    void destroy(JointId joint);
    void destroy(CouplingId coupling);
    bool isValid(BodyId body) const;
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
    Vec3 velocityAt(BodyId body, const DVec3& point) const;
    BodyType type(BodyId body) const;
    MassProperties mass(BodyId body) const;
    bool isAwake(BodyId body) const;
    /// Groups of awake dynamic bodies that touch or are joined; found by the call.
    int countIslands() const;
    /// For each of bodies() the first body of its group; null where it sleeps or is not dynamic.
    std::vector<BodyId> islands() const;
    std::uint64_t userData(BodyId body) const;
    std::span<const ShapeId> shapes(BodyId body) const;
    std::span<const JointId> jointsOf(BodyId body) const;
    void setPose(BodyId body, const Pose& pose);
    void setVelocity(BodyId body, const Vec3& linear, const Vec3& angular);
    void setGravityScale(BodyId body, float scale);
    float gravityScale(BodyId body) const;
    /// Changes mass, centre and inertia of a dynamic body (fuel, freight); its pose and the motion of its points stay.
    /// Throws std::invalid_argument and changes nothing when a value is not allowed.
    void setMass(BodyId body, const MassProperties& mass);
    /// Moves a kinematic body so that it is at `target` after the next step of dt seconds.
    void moveTo(BodyId body, const Pose& target, double dt);
    void applyImpulse(BodyId body, const Vec3& impulse, const DVec3& point);
    void applyAngularImpulse(BodyId body, const Vec3& impulse);
    /// Forces act during the next step only.
    void applyForce(BodyId body, const Vec3& force, const DVec3& point);
    void applyTorque(BodyId body, const Vec3& torque);
    void wake(BodyId body);
    /// Puts a body with its island to sleep now.
    void sleep(BodyId body);

    // Shapes.
    BodyId bodyOf(ShapeId shape) const;
    /// The shape as it was defined; Compound parts are shapes of their own.
    const Shape& geometry(ShapeId shape) const;
    Frame frame(ShapeId shape) const;
    Material material(ShapeId shape) const;
    void setMaterial(ShapeId shape, const Material& material);
    void setFilter(ShapeId shape, const Filter& filter);
    std::uint64_t userData(ShapeId shape) const;
    Bounds bounds(ShapeId shape) const;

    // Joints. setDef changes limits, motors, springs, friction and targets, keeping the impulses; it may not change
    // the type or the bodies.
    const JointDef& def(JointId joint) const;
    void setDef(JointId joint, const JointDef& def);
    /// Sets what pulls balls and hinges, as setDef with their springs would, in a fraction of its time: nothing else of
    /// them is looked at, and no memory is allocated. What sleeps stays asleep while its drives stay the same. Throws
    /// std::invalid_argument that names the drive and its field, and changes nothing then.
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
    /// Calls `visit` for each touching pair with at least one loaded or overlapping point.
    void forEachContact(const std::function<void(const Contact&)>& visit) const;
    void forEachContact(BodyId body, const std::function<void(const Contact&)>& visit) const;

    // Queries.
    Hit castRay(const Ray& ray, const QueryFilter& filter = {}) const;
    /// Sweeps a sphere, capsule, box or hull along path.translation from {path.origin, rotation}.
    Hit castShape(const Shape& shape, const Quat& rotation, const Ray& path, const QueryFilter& filter = {}) const;
    /// Many rays at once, wide and on the world's threads; results[i] belongs to rays[i].
    void castRays(std::span<const Ray> rays, std::span<Hit> results, const QueryFilter& filter = {}) const;
    /// Calls `visit` for each shape whose surface or inside meets the shape at `pose`, until it returns false.
    void overlap(const Shape& shape, const Pose& pose, const std::function<bool(ShapeId)>& visit,
                 const QueryFilter& filter = {}) const;
    void overlap(const Bounds& bounds, const std::function<bool(ShapeId)>& visit, const QueryFilter& filter = {}) const;

    // Changes from jobs.
    /// Applies the buffers ordered by their keys; throws as the calls themselves would, after the others are done.
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
    /// Vehicles, ragdolls and games take part in steps and saves as modules; see module.h.
    void add(StepModule* module);
    /// Changes whenever a fixed body is put elsewhere or destroyed, and when a state is restored: what sleeps on fixed ground
    /// need not look at it while this stays.
    std::uint64_t fixedVersion() const;
    void remove(StepModule* module);

    /// Kinetic and potential energy of the dynamic bodies, J; potential is zero at the world's origin.
    double energy() const;
    void draw(DebugDraw& draw) const;

private:
    friend struct WorldImpl;
    std::unique_ptr<WorldImpl> impl_;
};

}  // namespace ragtop
