#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>

#include "base/aligned_array.h"
#include "ragtop/math.h"
#include "scene/scene.h"
#include "world/energy_drivers.h"

/// The last guard of the energy law. Whatever way an island is solved, bodies that joints hold together may not gain
/// more energy, kinetic and of springs and soft stops, in a step than forces and gravity have given them along the way
/// they went:
///   ΔK + ΔU ≤ Σ m a · dp + τ · dθ + room,
/// and what moves on its own (energy_drivers.h),
/// with a room of 0.5 %, a tenth where springs store, for what an integrator trades between places and speeds; refilled
/// by what is dissipated only, so that no slow growth passes. What is beyond is taken from the motion of the bodies
/// against each other, never below what they began the step with: momenta stay as they are.
/// The same law holds for each body that touches such groups, and for islands of both as a whole. Within an island
/// bodies hand energy to each other; rooms are those of its parts, and what it gains as a whole is charged to them all.
namespace ragtop {

/// Which of the gains of a group are looked at: none, those that are beyond all measure, or all.
enum class Watching : std::uint8_t { none, garbage, all };

/// What a group had and has, J.
struct EnergyAccount {
    double before = 0, now = 0;  ///< kinetic, when the step began and now
    double work = 0;             ///< that forces gave
    double held = 0;             ///< by springs when the step began, and of a fall over the size of its bodies
    double excess = 0;           ///< gained beyond what forces gave
    double driven = 0;           ///< the most of it that motors with a bound gave
    double lawful = 0;           ///< kinetic at most, with what forces gave and it held
    double room = 0;             ///< the most that it may be above its account
    float share = 1;             ///< of that which was left when the step began
};

/// The island that groups with more energy than they have room for belong to, of this step.
struct GuardedIsland {
    std::uint32_t begin = 0, end = 0;  ///< of its bodies
    double excess = 0;                 ///< J, what its bodies gained
    double liftable = 0;               ///< J, that it takes to lift its bodies out of what they are deep in
    double pushed = 0;                 ///< J, that what pushes them apart may give
    double lawful = 0;                 ///< J, kinetic at most
    double atOnce = 0;                 ///< J, that forces give in a step to bodies at rest which nothing holds
    double lifted = 0;                 ///< J, of bodies that overlap, as far as overlaps lift them
    float apart = 0;                   ///< m, the farthest that overlaps move a body of it; 0: nothing overlaps
    bool stores = false;               ///< some joint has springs or soft stops
    std::uint32_t firstDriver = 0, lastDriver = 0;  ///< what drives it by joints
    double driven = 0;                              ///< J, that all which moves on its own gave at most
    bool hangs = false;                             ///< on what does not move
    bool isJoined = false;                          ///< some joint holds a body of it
    bool isComplete = false;                        ///< `driven` and `atOnce` are known
    bool isDone = false;                            ///< its step was undone
    bool fellBack = false;                          ///< a direct solve of it did not converge
    Watching watched = Watching::all;               ///< the least of its groups
};

/// Of a body, whose steps the guard undoes.
struct UndoneSteps {
    std::uint32_t last = 0, inRow = 0;  ///< number of the last one, and how many were undone one after the other
    std::uint32_t handed = 0;           ///< times that it was solved directly after such a row, and failed again soon
};

/// Bodies in groups: those that joints hold together, through bodies that move. Found anew when articulations are.
struct EnergyGuard {
    explicit EnergyGuard(std::pmr::memory_resource* memory)
        : parent(memory),
          starts(memory),
          bodies(memory),
          jointStarts(memory),
          joints(memory),
          groupOf(memory),
          watched(memory),
          traits(memory),
          accounts(memory),
          suspects(memory),
          looseSuspects(memory),
          looseAsked(memory),
          looseShare(memory),
          kinetic(memory),
          speeds(memory),
          room(memory),
          owed(memory),
          undone(memory),
          visited(memory),
          islandOf(memory),
          islands(memory),
          drivers(memory) {}

    AlignedArray<std::uint32_t> parent;  ///< union-find over bodies; of those in groups, the root
    AlignedArray<std::uint32_t> starts, bodies;
    AlignedArray<std::uint32_t> jointStarts, joints;  ///< of the groups, each joint once
    AlignedArray<std::uint32_t> groupOf;   ///< per body that is such a root
    AlignedArray<Watching> watched;        ///< per group
    struct GroupTraits {
        bool drives = false;  ///< some joint may give energy of its own (mayDrive)
        bool isMotored = false;  ///< some joint has a motor with a bound (hasBoundedMotor)
        bool stores = false;  ///< some joint has springs or soft stops
        bool hangs = false;   ///< some joint holds it to what does not move
    };
    AlignedArray<GroupTraits> traits;      ///< per group
    AlignedArray<EnergyAccount> accounts;  ///< per group, of this step
    AlignedArray<std::uint8_t> suspects;   ///< per group: has it gained more than it has room for?
    AlignedArray<std::uint32_t> looseSuspects;  ///< bodies without joints that have
    AlignedArray<std::uint32_t> looseAsked;     ///< per body, in which step it was asked for that
    AlignedArray<float> looseShare;             ///< then, of its room when the step began
    AlignedArray<float> kinetic;  ///< per body, J, when the step began; of those awake, where there are joints
    struct Speeds {
        Vec3 v, w;  ///< m/s, rad/s
    };
    AlignedArray<Speeds> speeds;  ///< the same, of their velocities
    /// Per body, share of the room that is left; of a group that of its lowest body counts.
    AlignedArray<float> room;
    AlignedArray<float> owed;  ///< J, the same of what overlaps gave as they were pushed apart and was not paid since
    AlignedArray<UndoneSteps> undone;      ///< per body
    AlignedArray<std::uint32_t> visited;   ///< bodies of the islands that were looked at, one island after the other
    AlignedArray<std::uint32_t> islandOf;  ///< per body, which of these it is in
    AlignedArray<GuardedIsland> islands;
    AlignedArray<EnergyDriver> drivers;  ///< of these
    bool stores = false;                 ///< some joint of some group does
    std::uint64_t caught = 0;            ///< times that energy was taken, since the world was made
    double taken = 0;                    ///< J

    std::size_t groupCount() const { return watched.size(); }
    std::span<const std::uint32_t> membersOf(std::size_t group) const {
        return {bodies.data() + starts[group], starts[group + 1] - starts[group]};
    }
    std::span<const std::uint32_t> jointsOf(std::size_t group) const {
        return {joints.data() + jointStarts[group], jointStarts[group + 1] - jointStarts[group]};
    }
    /// Of a body that is in one.
    std::uint32_t groupOfBody(std::uint32_t body) const { return groupOf[parent[body]]; }
};

/// What watching the energy of groups reads and writes.
struct GuardView {
    Bodies& bodies;
    const Shapes& shapes;
    const Contacts& contacts;
    const Manifolds& manifolds;
    Joints& joints;  ///< what springs lead by, and turns that a step which is undone has counted
    const ConstraintGraph& graph;
    Islands& islands;  ///< that solvers are to be chosen anew
    const Articulations& articulations;
    const DirectSet& directSet;
    EnergyGuard& guard;
    const SolverContext& context;
    const Vec3& gravity;
    float dt;
    std::uint32_t step;  ///< its number
    Scene scene;  ///< impulses that are forgotten
    StageRunner& runner;
};

/// When a step begins: groups the bodies, where they changed, and notes what they have.
void beginGuard(const GuardView& view);
/// The same of one body that was given another speed since.
void recordKinetic(EnergyGuard& guard, const Bodies& bodies, std::uint32_t body);
/// A module gives a body so much within a step, J: it is not gained by what holds the body.
void recordDriven(EnergyGuard& guard, std::uint32_t body, double given);
/// May bodies that joints alone hold together have gained more than their groups have room for? If not, what they have
/// is noted. On any thread, once in a step for a group.
bool hasGainedEnergy(const GuardView& view, std::span<const std::uint32_t> bodies);
/// When all substeps are done, before poses move.
void guardEnergy(const GuardView& view);

}  // namespace ragtop
