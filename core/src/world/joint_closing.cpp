#include "world/joint_closing.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "constraints/initial_violation.h"
#include "constraints/joint_types.h"
#include "constraints/stored_energy.h"
#include "continuous/meetings.h"
#include "direct/choice.h"
#include "direct/newton.h"
#include "model/joint_bodies.h"
#include "world/group_motion.h"

namespace ragtop {

namespace {

/// Gap between anchors, in sizes of the smaller body and beyond what turning leaves, or angle beyond a hard stop, rad,
/// that is closed.
constexpr float kOpen = 0.02f;
constexpr float kTorn = 0.1f;       ///< the same, which no step may leave of joints that were closed
constexpr float kTornStop = 0.05f;  ///< rad beyond a hard stop, likewise
constexpr float kClosed = 0.01f;    ///< the same, at which it is closed enough
constexpr int kRounds = 60;         ///< of closing: errors are not linear in ways
constexpr int kDamped = 6;          ///< damped systems that are tried where bodies would turn by more than kLargestTurn
constexpr double kDamping = 10;     ///< of each over that of the one before
constexpr double kTurnsAlone = 1000;   ///< damping up to which turns become dearer alone; rows give way beyond
constexpr double kFirmer = 0.01;       ///< times what rows give way, where they give way to most of what is open
constexpr double kFirmest = 1e-6;      ///< the least of it
constexpr double kHeld = 30;           ///< times as heavy is what a sweep of continuous collision holds up
constexpr float kLeastShare = 0.125f;  ///< of a step that is cut short, below which none of it is left
constexpr float kLargestTurn = 0.25f;  ///< rad, of a round
constexpr float kStraight = 0.25f;     ///< least share of the ways of a round: they are damped more instead
constexpr double kGained =
    0.005;                        ///< of the kinetic energy, which closing may leave beyond it: the energy guard's room
constexpr float kBetter = 0.95f;  ///< of an opening, that counts as closed further
constexpr int kPatience = 10;     ///< rounds that close nothing further

/// m, between what a joint holds together.
float gapOf(const ClosingView& world, const JointSim& sim, const JointBodiesAtStep& at) {
    if (sim.kind == JointKind::ball || sim.kind == JointKind::hinge || sim.kind == JointKind::fixed)
        return length(at.centerOffset + rotate(at.rotationB, sim.localB.position) -
                      rotate(at.rotationA, sim.localA.position));
    if (sim.kind == JointKind::distance) return 0;  // beyond a stop, or beyond what it was made with
    return jointState(sim, at, world.bodies.states.data(), 0).gap;
}

/// rad, by which axes or frames that a joint holds together are turned.
float turnedApart(const JointSim& sim, const JointBodiesAtStep& at) {
    const Quat a = at.rotationA * sim.localA.rotation, b = at.rotationB * sim.localB.rotation;
    switch (sim.kind) {
        case JointKind::hinge:
            return length(axisX(b) - axisX(a));
        case JointKind::fixed:
        case JointKind::slider:
            return length(turnVector(b * conjugate(a)));
        default:
            return 0;
    }
}

/// The gap of a joint over the size of the smaller of the bodies that it moves, or what it is turned apart by, where
/// that is torn; 0 where these have none.
float opening(const ClosingView& world, std::uint32_t index) {
    const JointRecord& joint = world.joints[index];
    const JointSim& sim = world.joints.sims[index];
    const JointBodiesAtStep at = jointBodies(world.bodies, joint);
    const float sizeA = world.bodies[joint.bodyA].size, sizeB = world.bodies[joint.bodyB].size;
    const float size = !world.bodies.moves(joint.bodyA)   ? sizeB
                       : !world.bodies.moves(joint.bodyB) ? sizeA
                                                          : std::min(sizeA, sizeB);
    const float angle = kTorn / kTornStop * turnedApart(sim, at);
    return std::max(size > 0 ? gapOf(world, sim, at) / size : 0.0f, angle > kTorn ? angle : 0.0f);
}

/// How far the joint is beyond its hard stops, rad or in its lengths; it is placed anew only where it may be.
float overrunNow(const ClosingView& world, std::uint32_t index) {
    const JointRecord& joint = world.joints[index];
    JointSim& sim = world.joints.sims[index];
    const Vec3 turning = world.bodies.states[sim.stateB].w - world.bodies.states[sim.stateA].w;
    // Margins are those of the last substep or the one before it.
    if (limitOverrun(sim) + 2 * world.context.h * length(turning) < kOpen) return 0;
    placeJoint(sim, jointBodies(world.bodies, joint), world.bodies.states.data(), world.bodies.inertias.data());
    return limitOverrun(sim);
}

/// What turning leaves of that: an arm r that turns by θ ends it ½ θ² r from where its speed led. `turnSquared` tells
/// θ² of a body.
template <class TurnSquared>
float openingOfTurns(const ClosingView& world, std::uint32_t index, TurnSquared&& turnSquared) {
    const JointRecord& joint = world.joints[index];
    const JointSim& sim = world.joints.sims[index];
    float left = 0, size = std::numeric_limits<float>::max();
    const auto add = [&](std::uint32_t body, const Vec3& arm) {
        if (!world.bodies.moves(body)) return;
        left += 0.5f * turnSquared(body) * length(arm);
        size = std::min(size, world.bodies[body].size);
    };
    add(joint.bodyA, sim.localA.position);
    add(joint.bodyB, sim.localB.position);
    return size > 0 ? left / size : 0;
}

/// Calls visit(joint) once for each joint of a group.
template <class Visit>
void forEachJoint(const ClosingView& world, std::span<const std::uint32_t> group, Visit&& visit) {
    for (const std::uint32_t body : group)
        for (std::uint32_t key = world.bodies[body].firstJoint; key != kNone;
             key = world.joints[key >> 1].edges[key & 1].next) {
            const JointRecord& joint = world.joints[key >> 1];
            const bool first = (key & 1) == 0 || !world.bodies.moves(joint.bodyA);
            if (first && world.joints.isHolding(key >> 1)) visit(key >> 1);
        }
}

/// Of joints that were just placed, in sizes; what is beyond stops counts as the gap that is as torn.
float widestOpening(const ClosingView& world, std::span<const std::uint32_t> joints) {
    float widest = 0;
    for (const std::uint32_t joint : joints) {
        widest = std::max({widest, opening(world, joint), kTorn / kTornStop * limitOverrun(world.joints.sims[joint])});
    }
    return widest;
}

/// Ways that close joints know nothing of what couplings hold.
bool isCoupled(const JointSim& sim) {
    bool coupled = (sim.axis.features & AxisRows::kCoupled) != 0;
    for (std::uint32_t i = 0; hasAxes(sim.kind) && i < sim.axes.freeRows; ++i)
        coupled = coupled || (sim.axes.axis[i].features & AxisRows::kCoupled) != 0;
    return coupled;
}

bool isOpen(const ClosingView& world, std::span<const std::uint32_t> group) {
    if (group.size() > direct::kMostBodies) return false;
    for (const std::uint32_t body : group)
        if (!world.bodies.moves(body) || !world.bodies.isAwake(body)) return false;
    bool open = false, coupled = false;
    const auto ofSubstep = [&](std::uint32_t body) {
        return world.context.h * world.context.h * lengthSquared(world.bodies.states[body].w);
    };
    forEachJoint(world, group, [&](std::uint32_t joint) {
        open = open || opening(world, joint) > std::min(kOpen + openingOfTurns(world, joint, ofSubstep), kTorn) ||
               overrunNow(world, joint) > kOpen;
        coupled = coupled || isCoupled(world.joints.sims[joint]);
    });
    return open && !coupled;
}

void placeJoints(const ClosingView& world, std::span<const std::uint32_t> joints) {
    for (const std::uint32_t joint : joints)
        placeJoint(world.joints.sims[joint], jointBodies(world.bodies, world.joints[joint]), world.bodies.states.data(),
                   world.bodies.inertias.data());
}

/// Takes the speed at which rigid rows open.
void restJoints(const ClosingView& world, direct::IslandSystem& system) {
    direct::SolveReport report;
    bool factored = false;
    system.aimAtRest(world.bodies.arrays(), world.jointContext);
    direct::pivot(system, factored, report);
    system.writeVelocities(world.bodies.arrays());
}

direct::IslandParts partsOf(const ClosingView& world, std::span<const std::uint32_t> group,
                            JointClosing::Bench& bench) {
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

bool hangs(const ClosingView& world, std::span<const std::uint32_t> joints) {
    return std::any_of(joints.begin(), joints.end(), [&](std::uint32_t joint) {
        return !world.bodies.moves(world.joints[joint].bodyA) || !world.bodies.moves(world.joints[joint].bodyB);
    });
}

/// Speeds stay as they are seen from the body.
void moveTo(const ClosingView& world, std::uint32_t index, const Pose& pose) {
    BodyRecord& body = world.bodies[index];
    world.bodies.turnVelocity(index, body.rotation, pose.rotation);
    body.center = pose.position;
    body.rotation = pose.rotation;
    world.bodies.refreshInertia(index);
}

void keepPlaces(const ClosingView& world, std::span<const std::uint32_t> group, AlignedArray<Pose>& places) {
    places.clear();
    for (const std::uint32_t body : group) places.push({world.bodies[body].center, world.bodies[body].rotation});
}

/// How much of the ways that were found closes joints: their turns open them again by their square, so that half of
/// what is open is the most that pays.
float shareOfWays(const ClosingView& world, std::span<const std::uint32_t> joints, JointClosing::Bench& bench,
                  float open) {
    const double h = static_cast<double>(world.context.h);
    bench.system.visitWays(h, [&](std::uint32_t body, const DVec3&, const DVec3& turning) {
        bench.turns[world.jointClosing.localOf[body]] = lengthSquared(toVec3(turning));
    });
    const auto ofWay = [&](std::uint32_t body) { return bench.turns[world.jointClosing.localOf[body]]; };
    float bend = 0;
    for (const std::uint32_t joint : joints) bend = std::max(bend, openingOfTurns(world, joint, ofWay));
    const auto turn = static_cast<float>(bench.system.largestTurn(h));
    return std::min({1.0f, 0.5f * open / std::max(bend, 0.5f * open), kLargestTurn / std::max(turn, kLargestTurn)});
}

/// The ways over a substep that close the joints, by Newton's method on errors of places. `damping` is that of the
/// round before. Where links lie nearly along the line by which they were torn apart, the metric of the masses turns
/// them by many radians to first order, sooner than it lifts what is heavy; and near a dead point of a loop any way is
/// long. So turns become dearer first, whereupon bodies go straight; then rows give way, after Levenberg. Below 1 the
/// damping makes rows firmer: a loop between heavy bodies with a light link takes loads that rows otherwise give way
/// to. Returns the share of the ways to go.
float findWays(const ClosingView& world, std::span<const std::uint32_t> joints, JointClosing::Bench& bench, float open,
               float least, double leastDamping, double& damping) {
    direct::SolveReport report;
    const auto ofTurns = [](double x) { return std::max(1.0, x); };
    const auto ofRows = [](double x) { return std::max(std::min(1.0, x), x / kTurnsAlone); };
    damping = std::max(leastDamping, damping / (kDamping * kDamping));
    bench.system.dampClosing(ofTurns(damping), ofRows(damping));
    for (int i = 0;; ++i) {
        bool factored = false;
        direct::pivot(bench.system, factored, report);
        const float share = shareOfWays(world, joints, bench, open);
        if (share >= least || i == kDamped) return share;
        const double more = kDamping * damping;
        bench.system.dampClosing(ofTurns(more) / ofTurns(damping), ofRows(more) / ofRows(damping));
        damping = more;
    }
}

/// To where they were closed best.
void moveBack(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const std::uint32_t> joints,
              const JointClosing::Bench& bench) {
    for (std::size_t i = 0; i < group.size(); ++i) moveTo(world, group[i], bench.best[i]);
    placeJoints(world, joints);
}

/// Ways in rounds until the joints are closed, or cannot be; where they were closed best. Returns the widest opening
/// left.
float closeByPlaces(const ClosingView& world, std::span<const std::uint32_t> group,
                    std::span<const std::uint32_t> joints, JointClosing::Bench& bench) {
    const auto weightOf = [&](std::uint32_t body) {
        return world.sweptBodies.flags[world.bodies[body].awakeIndex] == kSwept ? kHeld : 1.0;
    };
    double damping = 1, leastDamping = 1;
    placeJoints(world, joints);
    float open = widestOpening(world, joints), least = open;
    bench.turns.resizeForOverwrite(group.size());
    keepPlaces(world, group, bench.best);
    int tried = 0;  // rounds since it was closed best
    for (int round = 0; round < kRounds && tried < kPatience && open > kClosed; ++round) {
        // Where damped ways lead nowhere, some of the straight ones always closes.
        const bool damped = tried < kPatience / 2;
        if (!damped && open > least) {
            moveBack(world, group, joints, bench);
            open = least;
        }
        bench.system.aimAtClosing(world.bodies.arrays(), world.jointContext, weightOf);
        const float share = findWays(world, joints, bench, open, damped ? kStraight : 0.0f, leastDamping, damping);
        bench.system.visitWays(static_cast<double>(share * world.context.h),
                               [&](std::uint32_t body, const DVec3& way, const DVec3& turning) {
                                   shiftBody(world.bodies, body, {toVec3(way), toVec3(turning)});
                               });
        placeJoints(world, joints);
        const float had = std::exchange(open, widestOpening(world, joints));
        if (share == 1 && open > 0.5f * had) leastDamping = std::max(kFirmest, kFirmer * leastDamping);
        ++tried;
        if (!(open < least)) continue;
        if (open < kBetter * least) tried = 0;
        least = open;
        keepPlaces(world, group, bench.best);
    }
    if (open > least) moveBack(world, group, joints, bench);
    return least;
}

/// m, of the centre of mass of a group in its step.
Vec3 commonWay(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const SweptPath> paths) {
    float mass = 0;
    Vec3 moment;
    for (std::size_t i = 0; i < group.size(); ++i) {
        const float m = world.bodies[group[i]].mass;
        mass += m;
        moment += m * paths[i].way;
    }
    return (1 / mass) * moment;
}

/// Puts a group where it was after a share of its step, but for a way that all of it goes to the end.
void moveAlong(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const SweptPath> paths,
               const Vec3& common, float share) {
    for (std::size_t i = 0; i < group.size(); ++i) {
        Pose at = paths[i].at(share);
        at.position = at.position + (1 - share) * common;
        moveTo(world, group[i], at);
    }
}

/// The widest opening of joints between bodies of the group and what never moves.
float widestOfOwn(const ClosingView& world, std::span<const std::uint32_t> joints) {
    float widest = 0;
    for (const std::uint32_t joint : joints) {
        const auto isDriven = [&](std::uint32_t body) { return world.bodies[body].type == BodyType::kinematic; };
        if (!isDriven(world.joints[joint].bodyA) && !isDriven(world.joints[joint].bodyB))
            widest = std::max(widest, widestOpening(world, {&joint, 1}));
    }
    return widest;
}

/// A step that ends where joints cannot be closed is cut short: the joints were closed where it began, so that they are
/// nearly so a little further on. A group that nothing holds goes on as a whole. One that began open has no such place.
/// Returns the share of the step that it goes, at most the one given.
float closeEarlier(const ClosingView& world, std::span<const std::uint32_t> group,
                   std::span<const std::uint32_t> joints, JointClosing::Bench& bench, float share) {
    const std::span<const SweptPath> paths(bench.paths.data(), bench.paths.size());
    const Vec3 common = hangs(world, joints) ? Vec3{} : commonWay(world, group, paths);
    moveAlong(world, group, paths, common, 0);
    for (const std::uint32_t joint : joints) restoreCounts(world.joints.sims[joint]);
    placeJoints(world, joints);
    const bool beganOpen = widestOfOwn(world, joints) > kTorn;
    if (!beganOpen) share = std::min(share, 0.5f);
    for (;; share *= 0.5f) {
        if (share < kLeastShare) share = 0;
        moveAlong(world, group, paths, common, share);
        if (closeByPlaces(world, group, joints, bench) <= kTorn || beganOpen || share == 0) break;
    }
    return share;
}

/// J, that forces give a group on the way from where its step led it.
double workOfClosing(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const SweptPath> paths) {
    double work = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
        const BodyRecord& body = world.bodies[group[i]];
        const Vec3 way = toVec3(body.center - paths[i].from.position) - paths[i].way;
        work += static_cast<double>(body.mass * dot(world.bodies.dynamics[group[i]].acceleration, way));
    }
    return work;
}

/// J, of springs and soft stops.
double storedBy(const ClosingView& world, std::span<const std::uint32_t> joints) {
    double stored = 0;
    for (const std::uint32_t joint : joints)
        if (const JointSim& sim = world.joints.sims[joint]; storesEnergy(sim))
            stored += storedEnergy(sim, jointBodies(world.bodies, world.joints[joint]));
    return stored;
}

double kineticOf(const ClosingView& world, std::span<const std::uint32_t> group) {
    double kinetic = 0;
    for (const std::uint32_t body : group) kinetic += kineticEnergy(world.bodies, body, world.bodies[body].rotation);
    return kinetic;
}

/// Of a group when its step is done.
struct BeforeClosing {
    Vec3 momentum;                   ///< kg m²/s, angular, that it is to have
    double kinetic = 0, stored = 0;  ///< J
};

/// Speeds that open no joint, with the group's angular momentum and no more than its energy. Returns what is left of
/// what there is too much, J: less than bodies so close to each other have at that momentum cannot be had.
double fitSpeeds(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const std::uint32_t> joints,
                 JointClosing::Bench& bench, const BeforeClosing& before, float share) {
    restJoints(world, bench.system);
    // Places that move beside velocities change what these make about the centre of mass.
    const bool isFree = !hangs(world, joints);
    if (isFree) turnToMomentum(world.bodies, group, before.momentum);
    const double work =
        workOfClosing(world, group, {bench.paths.data(), bench.paths.size()}) + before.stored - storedBy(world, joints);
    const double most = share > 0 ? std::max(0.0, before.kinetic + std::min(0.0, work)) : 0.0;
    const double excess = kineticOf(world, group) - most;
    return excess - takeEnergy(world.bodies, world.joints, group, excess, isFree);
}

/// To where the step has led, as fast as there.
void moveToEnd(const ClosingView& world, std::span<const std::uint32_t> group, const JointClosing::Bench& bench) {
    for (std::size_t i = 0; i < group.size(); ++i) {
        moveTo(world, group[i], bench.paths[i].at(1));
        world.bodies.states[group[i]].v = bench.speeds[i].linear;
        world.bodies.states[group[i]].w = bench.speeds[i].angular;
    }
}

/// Does nothing outside of a group turn it? A uniform acceleration does not.
bool isAlone(const ClosingView& world, std::span<const std::uint32_t> group, std::span<const std::uint32_t> joints) {
    if (hangs(world, joints)) return false;
    const auto isMember = [&](std::uint32_t body) {
        const std::uint32_t local = world.jointClosing.localOf[body];
        return local < group.size() && group[local] == body;
    };
    const Vec3 common = world.bodies.dynamics[group.front()].acceleration;
    for (const std::uint32_t body : group) {
        const auto& forces = world.bodies.dynamics[body];
        if (forces.acceleration != common || forces.torque != Vec3{}) return false;
        for (std::uint32_t key = world.bodies[body].firstContact; key != kNone; key = world.contacts.next(key)) {
            const ContactRecord& contact = world.contacts[key >> 1];
            if (!contact.sensor && contact.hasPoints && !(isMember(contact.bodyA) && isMember(contact.bodyB)))
                return false;
        }
    }
    return true;
}

/// What a group that is alone began with is what it is to have: long substeps keep less of it than they should.
Vec3 momentumToHave(const ClosingView& world, std::size_t g, std::span<const std::uint32_t> joints) {
    const EnergyGuard& guard = world.energyGuard;
    const std::span<const std::uint32_t> group = guard.membersOf(g);
    const bool isKnown = guard.watched[g] != Watching::none && isAlone(world, group, joints);
    return isKnown ? guard.momentum[g] : angularMomentumAtStart(world.bodies, group);
}

void closeGroup(const ClosingView& world, std::size_t g, JointClosing::Bench& bench) {
    const std::span<const std::uint32_t> group = world.energyGuard.membersOf(g);
    const direct::IslandParts parts = partsOf(world, group, bench);
    const std::span<const std::uint32_t> joints(bench.joints.data(), bench.joints.size());
    bench.paths.clear();
    bench.speeds.clear();
    for (const std::uint32_t body : group) {
        bench.paths.push(pathOfStep(world.bodies, world.sweptBodies.startPoses(), world.dt, body));
        bench.speeds.push({world.bodies.states[body].v, world.bodies.states[body].w});
    }
    bench.system.begin(parts, world.bodies.arrays(), world.context);
    const BeforeClosing before{momentumToHave(world, g, joints), kineticOf(world, group), storedBy(world, joints)};
    float share = 1;
    if (closeByPlaces(world, group, joints, bench) > kTorn) share = closeEarlier(world, group, joints, bench, 1);
    double excess = fitSpeeds(world, group, joints, bench, before, share);
    while (share > 0 && excess > kGained * before.kinetic) {
        moveToEnd(world, group, bench);
        share = closeEarlier(world, group, joints, bench, 0.5f * share);
        excess = fitSpeeds(world, group, joints, bench, before, share);
    }
    bench.cut += share < 1;
    for (const std::uint32_t body : group) world.bodies.storeMomentum(body);
}

}  // namespace

/// Which worker takes a group is chance: each has room for any that was closed so far.
static void makeRoomToClose(const ClosingView& world, std::span<const std::uint32_t> group) {
    JointClosing& closing = world.jointClosing;
    std::size_t joints = 0;
    forEachJoint(world, group, [&](std::uint32_t) { ++joints; });
    if (group.size() <= closing.mostBodies && joints <= closing.mostJoints) return;
    closing.mostBodies = std::max(closing.mostBodies, group.size());
    closing.mostJoints = std::max(closing.mostJoints, joints);
    for (const std::unique_ptr<JointClosing::Bench>& bench : closing.benches) {
        bench->system.begin(partsOf(world, group, *bench), world.bodies.arrays(), world.context);
        bench->paths.reserve(group.size());
        bench->speeds.reserve(group.size());
        bench->best.reserve(group.size());
        bench->turns.reserve(group.size());
    }
}

void closeOpenJoints(const ClosingView& world) {
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
    for (const std::uint32_t g : closing.groups) makeRoomToClose(world, guard.membersOf(g));
    closing.closed += closing.groups.size();
    world.runner.parallelFor(static_cast<int>(closing.groups.size()), 1, [&](int begin, int end, int worker) {
        for (int i = begin; i < end; ++i)
            closeGroup(world, closing.groups[static_cast<std::size_t>(i)],
                       *closing.benches[static_cast<std::size_t>(worker)]);
    });
    for (const std::unique_ptr<JointClosing::Bench>& bench : closing.benches)
        closing.cut += std::exchange(bench->cut, 0);
}

}  // namespace ragtop
