#include "world/joint_closing.h"

#include <algorithm>
#include <limits>

#include "direct/choice.h"
#include "direct/newton.h"
#include "world/group_motion.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// Gap between anchors, in sizes of the smaller body and beyond what turning leaves, that is closed.
constexpr float kOpen = 0.02f;
constexpr float kClosed = 0.01f;       ///< the same, at which it is closed enough
constexpr int kRounds = 12;            ///< of closing: errors are not linear in ways
constexpr int kSofter = 6;             ///< softer systems that are tried where ways would be longer than kLargestTurn
constexpr double kSoftening = 10;      ///< resistance of each over that of the one before
constexpr double kHeld = 30;           ///< times as heavy is what a sweep of continuous collision holds up
constexpr double kLargestTurn = 0.25;  ///< rad, up to which the way that closes joints is nearly straight

/// The gap between a joint's anchors over the size of the smaller of the bodies that it moves; 0 where these have none.
float opening(const WorldImpl& world, std::uint32_t index) {
    const JointRecord& joint = world.joints[index];
    const JointSim& sim = world.joints.sims[index];
    if (sim.kind != JointKind::ball && sim.kind != JointKind::hinge && sim.kind != JointKind::fixed) return 0;
    const JointBodiesAtStep at = world.jointBodies(joint);
    const Vec3 gap =
        at.centerOffset + rotate(at.rotationB, sim.localB.position) - rotate(at.rotationA, sim.localA.position);
    const float sizeA = world.bodies[joint.bodyA].size, sizeB = world.bodies[joint.bodyB].size;
    const float size = !world.bodies.moves(joint.bodyA)   ? sizeB
                       : !world.bodies.moves(joint.bodyB) ? sizeA
                                                          : std::min(sizeA, sizeB);
    return size > 0 ? length(gap) / size : 0;
}

/// What turning leaves of that: an arm r that turns by θ in a substep ends it ½ θ² r from where its speed led.
float openingOfTurns(const WorldImpl& world, std::uint32_t index) {
    const JointRecord& joint = world.joints[index];
    const JointSim& sim = world.joints.sims[index];
    float left = 0, size = std::numeric_limits<float>::max();
    const auto add = [&](std::uint32_t body, const Vec3& arm) {
        if (!world.bodies.moves(body)) return;
        left += 0.5f * world.context.h * world.context.h * lengthSquared(world.bodies.states[body].w) * length(arm);
        size = std::min(size, world.bodies[body].size);
    };
    add(joint.bodyA, sim.localA.position);
    add(joint.bodyB, sim.localB.position);
    return size > 0 ? left / size : 0;
}

/// Calls visit(joint) once for each joint of a group.
template <class Visit>
void forEachJoint(const WorldImpl& world, std::span<const std::uint32_t> group, Visit&& visit) {
    for (const std::uint32_t body : group)
        for (std::uint32_t key = world.bodies[body].firstJoint; key != kNone;
             key = world.joints[key >> 1].edges[key & 1].next) {
            const JointRecord& joint = world.joints[key >> 1];
            const bool first = (key & 1) == 0 || !world.bodies.moves(joint.bodyA);
            if (first) visit(key >> 1);
        }
}

float widestOpening(const WorldImpl& world, std::span<const std::uint32_t> joints) {
    float widest = 0;
    for (const std::uint32_t joint : joints) widest = std::max(widest, opening(world, joint));
    return widest;
}

/// Ways that close joints know nothing of what couplings hold, nor of what springs and soft stops store.
bool isHeldOtherwise(const JointSim& sim) {
    constexpr std::uint32_t kAxis = AxisRows::kSpring | AxisRows::kCoupled;
    constexpr std::uint32_t kBall = BallRows::kSpring | BallRows::kDrives;
    return (sim.axis.features & kAxis) != 0 || (sim.ball.features & kBall) != 0 || sim.axis.stop.stiffness > 0 ||
           sim.ball.stop.stiffness > 0;
}

bool isOpen(const WorldImpl& world, std::span<const std::uint32_t> group) {
    if (group.size() > direct::kMostBodies) return false;
    for (const std::uint32_t body : group)
        if (!world.bodies.moves(body) || !world.bodies.isAwake(body)) return false;
    bool open = false, otherwise = false;
    forEachJoint(world, group, [&](std::uint32_t joint) {
        open = open || opening(world, joint) > kOpen + openingOfTurns(world, joint);
        otherwise = otherwise || isHeldOtherwise(world.joints.sims[joint]);
    });
    return open && !otherwise;
}

/// The ways over a substep h that close the joints, by Newton's method on errors of places, with Levenberg's damping
/// where these can hardly be closed: `softness` is that of the round before. Returns the largest turn, rad.
double findWays(direct::IslandSystem& system, double h, double& softness) {
    direct::SolveReport report;
    double turn = 0;
    softness = std::max(1.0, softness / (kSoftening * kSoftening));
    system.soften(softness);
    for (int i = 0; i <= kSofter; ++i) {
        bool factored = false;
        direct::pivot(system, factored, report);
        turn = system.largestTurn(h);
        if (!(turn > kLargestTurn) || i == kSofter) break;
        system.soften(kSoftening);
        softness *= kSoftening;
    }
    return turn;
}

void placeJoints(WorldImpl& world, std::span<const std::uint32_t> joints) {
    for (const std::uint32_t joint : joints)
        placeJoint(world.joints.sims[joint], world.jointBodies(world.joints[joint]), world.bodies.states.data(),
                   world.bodies.inertias.data());
}

/// Takes the speed at which rigid rows open.
void restJoints(WorldImpl& world, direct::IslandSystem& system) {
    direct::SolveReport report;
    bool factored = false;
    system.aimAtRest(world.bodies.arrays(), world.jointContext);
    direct::pivot(system, factored, report);
    system.writeVelocities(world.bodies.arrays());
}

direct::IslandParts partsOf(WorldImpl& world, std::span<const std::uint32_t> group, JointClosing::Bench& bench) {
    bench.joints.clear();
    bench.sims.clear();
    forEachJoint(world, group, [&](std::uint32_t joint) {
        bench.joints.push(joint);
        bench.sims.push(&world.joints.sims[joint]);
    });
    direct::IslandParts parts;
    parts.bodies = group.data();
    parts.bodyCount = static_cast<std::uint32_t>(group.size());
    parts.joints = bench.sims.data();
    parts.jointCount = static_cast<std::uint32_t>(bench.sims.size());
    parts.laneStride = world.graph.lanes();
    parts.localOf = world.jointClosing.localOf.data();
    return parts;
}

bool hangs(const WorldImpl& world, std::span<const std::uint32_t> joints) {
    return std::any_of(joints.begin(), joints.end(), [&](std::uint32_t joint) {
        return !world.bodies.moves(world.joints[joint].bodyA) || !world.bodies.moves(world.joints[joint].bodyB);
    });
}

void closeGroup(WorldImpl& world, std::span<const std::uint32_t> group, JointClosing::Bench& bench) {
    direct::IslandSystem& system = bench.system;
    const direct::IslandParts parts = partsOf(world, group, bench);
    const std::span<const std::uint32_t> joints(bench.joints.data(), bench.joints.size());
    const Vec3 momentum = angularMomentumAtStart(world, group);
    placeJoints(world, joints);
    system.begin(parts, world.bodies.arrays(), world.context);
    const auto weightOf = [&](std::uint32_t body) {
        return world.sweptBodies.flags[world.bodies[body].awakeIndex] == kSwept ? kHeld : 1.0;
    };
    const double h = static_cast<double>(world.context.h);
    double softness = 1;
    for (int round = 0; round < kRounds && (round == 0 || widestOpening(world, joints) > kClosed); ++round) {
        system.aimAtClosing(world.bodies.arrays(), world.jointContext, weightOf);
        const double turn = findWays(system, h, softness);
        const double share = turn > kLargestTurn ? kLargestTurn / turn : 1;
        system.visitWays(share * h, [&](std::uint32_t body, const DVec3& way, const DVec3& turning) {
            world.shiftBody(body, {toVec3(way), toVec3(turning)});
        });
        placeJoints(world, joints);
    }
    restJoints(world, system);
    // Places that move beside velocities change what these make about the centre of mass.
    if (!hangs(world, joints)) turnToMomentum(world, group, momentum);
    for (const std::uint32_t body : group) world.bodies.storeMomentum(body);
}

}  // namespace

void closeOpenJoints(WorldImpl& world) {
    const EnergyGuard& guard = world.energyGuard;
    JointClosing& closing = world.jointClosing;
    const std::size_t count = guard.groupCount();
    if (count == 0) return;
    closing.open.resizeForOverwrite(count);
    world.runner.parallelFor(static_cast<int>(count), 16, [&](int begin, int end, int) {
        for (auto g = static_cast<std::size_t>(begin); g < static_cast<std::size_t>(end); ++g)
            closing.open[g] = isOpen(world, guard.membersOf(g)) ? 1 : 0;
    });
    closing.groups.clear();
    for (std::size_t g = 0; g < count; ++g)
        if (closing.open[g] != 0) closing.groups.push(static_cast<std::uint32_t>(g));
    if (closing.groups.empty()) return;
    closing.localOf.resizeForOverwrite(world.bodies.size());
    while (closing.benches.size() < static_cast<std::size_t>(world.runner.workers()))
        closing.benches.push_back(std::make_unique<JointClosing::Bench>(world.memory));
    closing.closed += closing.groups.size();
    world.runner.parallelFor(static_cast<int>(closing.groups.size()), 1, [&](int begin, int end, int worker) {
        for (int i = begin; i < end; ++i)
            closeGroup(world, guard.membersOf(closing.groups[static_cast<std::size_t>(i)]),
                       *closing.benches[static_cast<std::size_t>(worker)]);
    });
}

}  // namespace ragtop
