#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/aligned_array.h"
#include "base/stage_memory.h"
#include "broadphase/bounds_tree.h"
#include "constraints/constraint_graph.h"
#include "direct/newton.h"
#include "narrowphase/manifold.h"
#include "ragtop/id.h"
#include "ragtop/math.h"
#include "world/records.h"

/// What stages of a step find, for a moment.
namespace ragtop {

/// Where a body touches a side of another one (world_seams.cpp).
struct TouchedPlane {
    bool touches = false;
    DVec3 at;
    Vec3 normal;      ///< towards the body that touches it
    float depth = 0;  ///< m, of the overlap
};

/// A tree of joints (world_trees.cpp).
struct BuiltTree {
    std::uint32_t anchor = kNone;  ///< body that does not move
    std::uint32_t bodies = 0, joints = 0;
    bool watched = false;  ///< impulses are wanted after every substep
    bool doublePrecision = false;  ///< masses ask for double precision
};

/// What a fast body meets first on its way (world_continuous.cpp).
struct Meeting {
    bool hit = false;
    float fraction = 1;  ///< of the path that was swept
    std::uint32_t shape = 0, obstacle = 0;
    Manifold touch;  ///< in the frame of the obstacle, the normal towards the shape
};

/// How far a body with a single shape that swings free can still go before that leaves its bounds (world_pairs.cpp).
struct BoundsRoom {
    static constexpr double kUnknown = -1;
    Vec3 below, above;          ///< m, towards the lower and the upper bounds
    double travel = kUnknown;  ///< m, of the body then
};

/// Which shapes have left their bounds at the end of a step (world_pairs.cpp).
struct BoundsLeft {
    explicit BoundsLeft(std::pmr::memory_resource* memory) : bodies(memory), starts(memory), rooms(memory) {}
    AlignedArray<std::uint8_t> bodies;   ///< per awake body: has some shape of it?
    AlignedArray<std::uint32_t> starts;  ///< per block of bodies: where their shapes begin in the move buffer
    AlignedArray<BoundsRoom> rooms;      ///< per body
};

/// A contact or joint through which bodies may bear on each other (world_islands.cpp).
struct SupportEdge {
    std::uint32_t a, b;        ///< bodies
    std::uint32_t constraint;  ///< manifold or joint
    bool joint;
    bool movesA, movesB;  ///< do they move?
};

/// Which way weights go down to what does not move (world_islands.cpp).
struct LoadPaths {
    StageArray<std::uint32_t> levels;    ///< per body: steps to what does not move
    StageArray<std::uint32_t> supports;  ///< per body: how many bear it
    StageArray<float> load;              ///< kg, per body
    StageArray<std::uint8_t> heldLevel;  ///< per body: something level is below it
};

/// An island that is solved directly, in the lists of its step (world_direct.cpp).
struct DirectIsland {
    std::uint32_t firstBody = 0, bodyCount = 0, firstContact = 0, contactCount = 0, firstJoint = 0, jointCount = 0;
    std::uint32_t system = kNone;  ///< of Newton's method, where it has one
    bool factored = false;
    bool fellBack = false;   ///< to iteration in this step: the direct solve did not converge
    bool unchanged = false;  ///< since a step through which it rested
    bool renewed = false;    ///< some lane of it is other than in the last step; told by several threads
    int restedAgain = 0;     ///< substeps through which it has rested as in the step before
    bool tree = false;       ///< eliminated in lanes, without a system
    bool mechanism = false;  ///< moves by itself, without a system
    bool watched = false;    ///< of a tree or mechanism: impulses are wanted after every substep
    bool leapfrog = false;   ///< of a tree: speeds are those of the middle of a substep
    bool multirate = false;  ///< of a tree: may take several substeps at once
    bool independent = false;              ///< of a tree: goes through the step by itself
    bool open = false, notClosed = false;  ///< of a tree: joints were open in this step by more than kOpen, kClosed
    direct::SolveReport report;
    double ms = 0;

    /// Of a step.
    void begin() {
        factored = fellBack = open = notClosed = unchanged = false;
        restedAgain = 0;
        report = {};
        ms = 0;
    }
};

/// How awake bodies go through the substeps of a step (multirate.cpp).
struct Multirate {
    explicit Multirate(std::pmr::memory_resource* memory)
        : lists{AlignedArray<std::uint32_t>(memory), AlignedArray<std::uint32_t>(memory),
                AlignedArray<std::uint32_t>(memory)},
          marks(memory),
          sharedJoints(memory) {}
    static constexpr std::uint8_t kIndependent = 128;  ///< in marks
    /// Of 1, 2 and 4 substeps at once, without those of independent trees; where `any`.
    std::array<AlignedArray<std::uint32_t>, direct::TreePlan::kStepFactors> lists;
    AlignedArray<std::uint8_t> marks;           ///< per body, 0 where it is of no tree, else its step factor
    AlignedArray<std::uint32_t> sharedJoints;   ///< of direct islands, without those of independent trees
    std::size_t independentCount = 0;           ///< bodies of such trees
    bool any = true;                            ///< some body goes otherwise than by single substeps, or may have
};

/// Bodies that joints hold together (world_articulations.cpp). They outlive the step while joints, the bodies that are
/// awake and the direct islands stay the same.
struct Articulations {
    explicit Articulations(std::pmr::memory_resource* memory)
        : parent(memory),
          place(memory),
          joints(memory),
          isFreeTree(memory),
          starts(memory),
          bodies(memory),
          masses(memory) {}
    AlignedArray<std::uint32_t> parent, place;     ///< per body, of those awake; 0: held by the world
    AlignedArray<std::uint32_t> joints, isFreeTree;  ///< per body that is a parent of itself
    AlignedArray<std::uint32_t> starts;              ///< of the members of each articulation, and the end
    AlignedArray<std::uint32_t> bodies;            ///< the members
    AlignedArray<float> masses;                    ///< kg, of the members
    bool known = false;                            ///< nothing has changed since they were found
    bool fresh = false;                            ///< they were found in this step
};

/// What a pass over constraints does.
enum class SolvePass { warmStart, solve, relax };

/// Numbers by region.
struct ByRegion {
    explicit ByRegion(std::pmr::memory_resource* memory) : items(memory), starts(memory) {}
    std::span<const std::uint32_t> of(int region) const {
        const auto r = static_cast<std::size_t>(region);
        return {items.data() + starts[r], starts[r + 1] - starts[r]};
    }
    /// item(i) of `count`, in that order, to regionOf(i) from 0 to `regions`.
    template <class Item, class RegionOf>
    void fill(int regions, std::size_t count, Item&& item, RegionOf&& regionOf) {
        starts.clear();
        starts.resize(static_cast<std::size_t>(regions) + 3, 0);
        for (std::size_t i = 0; i < count; ++i) ++starts[regionOf(i) + 2];
        for (std::size_t r = 2; r < starts.size(); ++r) starts[r] += starts[r - 1];
        items.resizeForOverwrite(count);
        for (std::size_t i = 0; i < count; ++i) items[starts[regionOf(i) + 1]++] = item(i);
    }
    AlignedArray<std::uint32_t> items, starts;
};

/// Islands that are solved side by side (world/world_regions.cpp); region 0 is what belongs to none.
struct Regions {
    explicit Regions(std::pmr::memory_resource* memory)
        : bodies(memory),
          articulations(memory),
          modules(memory),
          usedLists(memory),
          listStarts(memory),
          weights(memory),
          ofIsland(memory),
          loads(memory) {}
    bool independent = false;                  ///< each goes through the substeps of this step by itself
    ByRegion bodies, articulations, modules;   ///< of this step, while they are independent; of modules, their groups
    AlignedArray<std::uint32_t> usedLists;     ///< per region: a bit per list that holds something
    AlignedArray<int> listStarts;              ///< scratch: blocks of each list of the graph
    AlignedArray<std::uint32_t> weights, ofIsland;  ///< scratch: per body that is the root of an island
    AlignedArray<std::uint32_t> loads;              ///< scratch: weight of each region
    std::uint32_t wait = 0, nextWait = 0;           ///< steps until islands are looked at again
};

/// What modules do between the substeps of a step, and to whom (world_modules.cpp). Modules that name a moving body in
/// common are a group, and groups have nothing to do with each other. Found anew in every step.
struct ModuleWork {
    explicit ModuleWork(std::pmr::memory_resource* memory)
        : named(memory), namer(memory), spans(memory), acting(memory), parent(memory), groupOf(memory), starts(memory),
          members(memory) {}
    bool onAll = false;                           ///< some module names no body: it may act on any body
    bool inSubsteps = false;                      ///< modules may act now, on any worker
    AlignedArray<std::uint32_t> named;            ///< bodies, each once, in the order of modules
    AlignedArray<std::uint32_t> namer;            ///< per body: 1 + the first place in `acting` that named it; 0: none
    AlignedArray<std::span<const BodyId>> spans;  ///< per module, what it named
    AlignedArray<std::uint32_t> acting;           ///< modules that named something, in the order of registration
    AlignedArray<std::uint32_t> parent, groupOf;  ///< per place there: union-find; the group
    AlignedArray<std::uint32_t> starts, members;  ///< of each group, and the end; places in `acting`, in their order
    double ms = 0;                                ///< of this step, between its substeps
    std::uint64_t strays = 0;                     ///< impulses left out, since the world was made

    std::size_t groupCount() const { return starts.empty() ? 0 : starts.size() - 1; }
    bool acts() const { return onAll || !acting.empty(); }
    bool actsOn(std::uint32_t body) const { return onAll || (body < namer.size() && namer[body] != 0); }
};

/// How far a body went in a step.
enum BodyFlag : std::uint8_t {
    kNotFast,
    kFastClear,  ///< went far for its size, but past nothing
    kToSweep,    ///< went far for its size
    kSwept,      ///< met something on its way
    kOutOfRange
};

/// Which bodies a step solves (world_freezing.cpp).
struct Freezing {
    explicit Freezing(std::pmr::memory_resource* memory) : unfrozen(memory) {}
    /// Counts the steps for which a body has been still; `slow`: below what counts as that, over the whole step.
    void record(BodyRecord& body, bool slow);
    /// m/s, when gravity gives so much in a substep.
    static float slowest(float gravityStep);
    std::atomic<bool> anyStill{false};       ///< has any body been still for long enough to rest?
    std::span<const std::uint32_t> solved;   ///< awake bodies that do not rest
    AlignedArray<std::uint32_t> unfrozen;    ///< the same while some rest
};

/// A contact for which a step found a change, of ContactChange.
struct ChangedContact {
    std::uint32_t contact;
    std::uint8_t change;
};

/// Two shapes whose bounds have met (world_pairs.cpp).
struct PairFound {
    std::uint32_t a, b;
};

/// What the search for pairs uses.
struct PairSearch {
    explicit PairSearch(std::pmr::memory_resource* memory) : branches(memory) {}
    std::pmr::vector<BoundsTree::NodePair> branches;   ///< between which partners are sought
    std::vector<std::pmr::vector<PairFound>> found;    ///< per pair of branches, or per block of shapes
    std::vector<std::pmr::vector<BoundsTree::NodePair>> waiting;  ///< per worker: scratch of BoundsTree::queryAll
};

/// Where a body was when a step began.
struct StartPose {
    DVec3 center;
    Quat rotation;
};

/// An impact of a swept body, for the step's events.
struct SweptImpact {
    std::uint32_t contact, triangle;
    DVec3 point;
    Vec3 normal;  ///< from A to B
    float speed, impulse;
};

}  // namespace ragtop
