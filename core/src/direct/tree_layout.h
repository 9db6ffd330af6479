#pragma once

#include <cstddef>
#include <cstdint>

#include "solve/kernel_table.h"

/// Trees of joints as the kernels see them. A group holds up to W trees of equal topology side by side; its links are
/// bodies, each after the one that it hangs from, each with the joint that holds it there.
namespace ragtop::direct {

/// What a link may do about its joint. A free link is a root that nothing holds.
enum class TreeJoint : std::uint8_t { free, ball, hinge, fixed };

inline constexpr std::int32_t kNoBallChain = -2;  ///< neither −1 nor a link

struct TreeLink {
    std::int32_t parent = -1;  ///< a link, or what does not move
    TreeJoint joint = TreeJoint::free;
    std::uint8_t childIsB = 0;  ///< the link is body B of its joint
    std::uint8_t pad[2] = {0, 0};
    /// Of a ball chain, a link on a ball from which nothing hangs (−1) or one other, on a ball: that link.
    std::int32_t below = kNoBallChain;
};

/// Says which links are of ball chains; the others are eliminated in a way that knows all joints.
void markBallChains(TreeLink* links, std::size_t count);

/// Of a joint when the step begins, seen from its link (C) and that link's parent (P); rows of eight floats.
struct alignas(32) TreeJointRow {
    float offset[3] = {0, 0, 0};                           ///< m, centre of C minus that of P
    float anchorC[3] = {0, 0, 0}, anchorP[3] = {0, 0, 0};  ///< m
    float frameC[4] = {0, 0, 0, 1}, frameP[4] = {0, 0, 0, 1};
    float force[3] = {0, 0, 0}, torque[3] = {0, 0, 0};  ///< N s and N m s that C receives
    float pad = 0;
};
static_assert(sizeof(TreeJointRow) == 96);

/// What C receives, N s and N m s.
struct alignas(32) TreeImpulse {
    float force[3] = {0, 0, 0};
    float pad = 0;
    float torque[3] = {0, 0, 0};
    float pad2 = 0;
};

/// Lane i of link l is at [l · lanes + i]; lanes beyond `used` repeat the first.
struct TreeGroup {
    const TreeLink* links = nullptr;
    int linkCount = 0, used = 0;
    const std::uint32_t* anchors = nullptr;  ///< state of what the root hangs from, per lane
    const std::uint32_t* states = nullptr;
    const TreeJointRow* joints = nullptr;
    TreeImpulse* impulses = nullptr;  ///< of the whole substep
    std::byte* memory = nullptr;      ///< linkBytes per link
    std::uint32_t failed = 0;         ///< one bit per lane: it had no answer in this step, and is left alone
    std::uint32_t taut = 0;           ///< the same: it was solved twice
    std::uint32_t open = 0;           ///< the same: a joint was found open by more than kOpen
    std::uint32_t notClosed = 0;      ///< the same: by more than kClosed
};

struct TreeSubstep {
    float h = 0;                       ///< s
    float biasRate = 0;                ///< 1/s, at which errors of positions are closed
    bool first = false, last = false;  ///< of its step
};

/// Of one instruction set, number of lanes and precision.
///   begin: once per step, loads from the rows and the forces on bodies.
///   solve: from free velocities to those at which no joint errs when the substep ends; impulses are those of a whole
///          substep. Taut links are implicit.
///   relax: after positions have moved.
/// Leapfrog: speeds are those of the middle of a substep while a step lasts, and those of its moment when it begins and
/// ends, where half a substep's forces act before the motion and half after it, and joints are relaxed about where they
/// are. Otherwise all forces act before the motion, and each relaxing takes back the speed that brought errors in.
struct TreeKernels {
    const char* name;
    int lanes;
    std::size_t linkBytes;
    bool leapfrog;
    void (*begin)(TreeGroup& group, const BodyArrays& arrays);
    void (*solve)(TreeGroup& group, const BodyArrays& arrays, const TreeSubstep& substep);
    void (*relax)(TreeGroup& group, const BodyArrays& arrays, const TreeSubstep& substep);
    /// What of a solve needs no bodies: the factor and one solution of the masses, arms and targets that the last one has
    /// left in the lanes. For measurements and tests.
    void (*factor)(TreeGroup& group);
};

/// Kernels beside those of `lanes` single lanes: as many for trees of moderate masses, and half as many of doubles.
/// Where the machine has wider vectors, `wider` are those of twice as many lanes, for trees that fill them.
struct TreeTables {
    TreeKernels single, doublePrecision;
    const TreeTables* wider = nullptr;
};
const TreeTables& selectTreeKernels(int lanes);

}  // namespace ragtop::direct
