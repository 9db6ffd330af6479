#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "constraints/joint_sim.h"
#include "direct/island_system.h"
#include "direct/mechanism.h"
#include "direct/newton.h"
#include "direct/tree_plan.h"
#include "model/records.h"
#include "ragtop/world.h"

namespace ragtop {

/// A tree of joints (direct_trees.cpp).
struct BuiltTree {
    std::uint32_t anchor = kNone;  ///< body that does not move
    std::uint32_t bodies = 0, joints = 0;
    bool watched = false;          ///< impulses are wanted after every substep
    bool doublePrecision = false;  ///< masses ask for double precision
};

/// An island that is solved directly, in the lists of its step (direct_islands.cpp).
struct DirectIsland {
    std::uint32_t firstBody = 0, bodyCount = 0, firstContact = 0, contactCount = 0, firstJoint = 0, jointCount = 0;
    std::uint32_t system = kNone;  ///< of Newton's method, where it has one
    bool factored = false;
    bool fellBack = false;                 ///< to iteration in this step: the direct solve did not converge
    bool unchanged = false;                ///< since a step through which it rested
    bool renewed = false;                  ///< some lane of it is other than in the last step; told by several threads
    int restedAgain = 0;                   ///< substeps through which it has rested as in the step before
    int stepFactor = 1;                    ///< of a system: substeps of the world that it takes at once
    bool tree = false;                     ///< eliminated in lanes, without a system
    bool mechanism = false;                ///< moves by itself, without a system
    bool watched = false;                  ///< of a tree or mechanism: impulses are wanted after every substep
    bool leapfrog = false;                 ///< of a tree: speeds are those of the middle of a substep
    bool multirate = false;                ///< of a tree: may take several substeps at once
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
    static constexpr std::uint8_t kIndependent = 128, kStanding = 64, kFactor = 7;  ///< in marks
    /// Of 1, 2 and 4 substeps at once, without those of independent trees; where `any`.
    std::array<AlignedArray<std::uint32_t>, direct::TreePlan::kStepFactors> lists;
    /// Per body, 0 where it is of no tree and takes no substeps at once; else its step factor.
    AlignedArray<std::uint8_t> marks;
    AlignedArray<std::uint32_t> sharedJoints;  ///< of direct islands, without those of independent trees
    std::size_t independentCount = 0;          ///< bodies of such trees
    bool any = true;                           ///< some body goes otherwise than by single substeps, or may have
    bool regrouped = true;                     ///< islands are others than those of the marks
};

/// Islands that are solved directly, grouped from the graph's list of theirs: by Newton's method, in lanes as trees, or
/// in their own time as mechanisms.
struct DirectSet {
    explicit DirectSet(std::pmr::memory_resource* memory)
        : islands(memory),
          bodies(memory),
          manifolds(memory),
          joints(memory),
          lanes(memory),
          sims(memory),
          index(memory),
          systemOwner(memory),
          systemOfBody(memory),
          trees(memory),
          treeMark(memory),
          treeBodies(memory),
          seen(memory),
          owner(memory),
          movedConstraints(memory),
          ledger(memory),
          multirate(memory) {}

    AlignedArray<DirectIsland> islands;
    AlignedArray<std::uint32_t> bodies, manifolds, joints;  ///< grouped by island
    AlignedArray<float*> lanes;                             ///< of an island's contacts, likewise
    AlignedArray<JointSim*> sims;
    AlignedArray<std::uint32_t> index;                           ///< per body: of its island, or in it
    std::vector<std::unique_ptr<direct::IslandSystem>> systems;  ///< of islands, or free
    AlignedArray<std::uint32_t> systemOwner,
        systemOfBody;  ///< first body of its island; of those, kNone for all others
    std::vector<std::unique_ptr<direct::Mechanism>> mechanisms;  ///< per island, where it is one
    direct::TreePlan trees;                                      ///< islands that are trees
    AlignedArray<std::uint32_t> treeMark, treeBodies;            ///< per body; in the order of a visit
    AlignedArray<float> seen;                                    ///< bundles of direct islands in the last step
    AlignedArray<std::uint32_t> owner;                           ///< per slot of the list: the island
    AlignedArray<std::uint32_t> movedConstraints;                ///< scratch: between the lists of the solvers
    std::pmr::vector<StepStats::Island> ledger;                  ///< of the last step
    Multirate multirate;
    std::uint64_t failures = 0;  ///< since the world was made: solves that did not converge
    bool grouped = false;        ///< are the islands those of the list?
    bool treesChanged = true;    ///< joints, their bodies or their rows, since trees were built
};

}  // namespace ragtop
