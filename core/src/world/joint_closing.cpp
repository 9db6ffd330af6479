#include "world/joint_closing.h"

#include <algorithm>
#include <utility>

#include "constraints/joint_types.h"
#include "constraints/stored_energy.h"
#include "continuous/meetings.h"
#include "direct/choice.h"
#include "direct/newton.h"
#include "world/group_motion.h"
#include "world/joint_opening.h"
#include "world/jointed_groups.h"

namespace ragtop {

namespace {

constexpr float kClosed = 0.01f;  ///< opening at which a joint is closed enough
constexpr int kRounds = 60;       ///< of closing: errors are not linear in ways
constexpr int kDamped = 6;        ///< damped systems that are tried where bodies would turn by more than kLargestTurn
constexpr double kDamping = 10;   ///< of each over that of the one before
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
constexpr int kLooks = 3;         ///< for parts that have come into each other where no contact was found
// Factors of systems with contacts, beyond which these are left out. By trial:
// unbounded, one of 200 contraptions took 10 s in a step; so, the worst takes 21 ms and no more of them break.
constexpr int kPivotsOfTouches = 32;      ///< of a system
constexpr int kMostPivotsOfTouches = 96;  ///< of all systems of a group in a step

std::span<const ClosingTouch> touchesOf(const JointClosing::Bench& bench) {
    return {bench.touches.data(), bench.touches.size()};
}
std::span<const direct::ClosingPoint> pointsOf(const JointClosing::Bench& bench) {
    return {bench.points.data(), bench.points.size()};
}

/// Of joints that were just placed and of contacts.
float widestOpening(const ClosingView& world, std::span<const std::uint32_t> joints, const JointClosing::Bench& bench) {
    return std::max(widestOpening(world, joints), deepestTouch(world, touchesOf(bench)));
}

void placeJoints(const ClosingView& world, std::span<const std::uint32_t> joints) {
    for (const std::uint32_t joint : joints)
        placeJoint(world.joints.sims[joint], jointBodies(world.bodies, world.joints[joint]), world.bodies.states.data(),
                   world.bodies.inertias.data());
}

/// False where contacts of the system are to be left out, which would take too long.
bool solveSystem(JointClosing::Bench& bench) {
    direct::SolveReport report;
    bool factored = false;
    const bool isBeside = !bench.touches.empty();
    const bool solved =
        direct::pivot(bench.system.equations(), factored, report, isBeside ? kPivotsOfTouches : direct::kPivots);
    if (!isBeside) return true;
    bench.pivots += report.factorizations;
    return solved && bench.pivots < kMostPivotsOfTouches;
}

/// Takes the speed at which rigid rows open, or contact points close that have no room.
void restJoints(const ClosingView& world, JointClosing::Bench& bench) {
    const auto aim = [&] {
        placeTouches(world, touchesOf(bench), bench.points);
        bench.system.aimAtRest(world.bodies.arrays(), world.jointContext, pointsOf(bench));
    };
    aim();
    if (!solveSystem(bench)) {
        bench.touches.clear();
        aim();
        solveSystem(bench);
    }
    bench.system.writeVelocities(world.bodies.arrays());
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
    placeTouches(world, touchesOf(bench), bench.points);
    parts.points = bench.points.data();
    parts.pointCount = bench.points.size();
    parts.pointRoom = world.jointClosing.mostTouches;
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
/// to. Returns the share of the ways to go; negative where contacts are to be left out.
float findWays(const ClosingView& world, std::span<const std::uint32_t> joints, JointClosing::Bench& bench, float open,
               float least, double leastDamping, double& damping) {
    const auto ofTurns = [](double x) { return std::max(1.0, x); };
    const auto ofRows = [](double x) { return std::max(std::min(1.0, x), x / kTurnsAlone); };
    damping = std::max(leastDamping, damping / (kDamping * kDamping));
    bench.system.dampClosing(ofTurns(damping), ofRows(damping));
    for (int i = 0;; ++i) {
        if (!solveSystem(bench)) return -1;
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

/// Ways in rounds until the joints are closed, or cannot be; where they were closed best.
void closeInRounds(const ClosingView& world, std::span<const std::uint32_t> group,
                   std::span<const std::uint32_t> joints, JointClosing::Bench& bench) {
    const auto weightOf = [&](std::uint32_t body) {
        return world.sweptBodies.flags[world.bodies[body].awakeIndex] == kSwept ? kHeld : 1.0;
    };
    double damping = 1, leastDamping = 1;
    placeJoints(world, joints);
    float open = widestOpening(world, joints, bench), least = open;
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
        placeTouches(world, touchesOf(bench), bench.points);
        bench.system.aimAtClosing(world.bodies.arrays(), world.jointContext, pointsOf(bench), weightOf);
        const float share = findWays(world, joints, bench, open, damped ? kStraight : 0.0f, leastDamping, damping);
        if (share < 0) break;
        bench.system.visitWays(static_cast<double>(share * world.context.h),
                               [&](std::uint32_t body, const DVec3& way, const DVec3& turning) {
                                   shiftBody(world.bodies, body, {toVec3(way), toVec3(turning)});
                               });
        placeJoints(world, joints);
        const float had = std::exchange(open, widestOpening(world, joints, bench));
        if (share == 1 && open > 0.5f * had) leastDamping = std::max(kFirmest, kFirmer * leastDamping);
        ++tried;
        if (!(open < least)) continue;
        if (open < kBetter * least) tried = 0;
        least = open;
        keepPlaces(world, group, bench.best);
    }
    if (open > least) moveBack(world, group, joints, bench);
}

/// Closes the joints beside contacts, or without them where both cannot be had. Returns the widest opening left.
float closeByPlaces(const ClosingView& world, std::span<const std::uint32_t> group,
                    std::span<const std::uint32_t> joints, JointClosing::Bench& bench) {
    closeInRounds(world, group, joints, bench);
    for (int i = 0; i < kLooks && bench.pivots < kMostPivotsOfTouches &&
                    addMissedTouches(world, group, kOpen, i > 0, bench.touches);
         ++i) {
        bench.system.begin(partsOf(world, group, bench), world.bodies.arrays(), world.context);
        closeInRounds(world, group, joints, bench);
    }
    if (!bench.touches.empty() && widestOpening(world, joints) > kOpen) {
        bench.touches.clear();
        closeInRounds(world, group, joints, bench);
    }
    return widestOpening(world, joints);
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
    restJoints(world, bench);
    // Places that move beside velocities change what these make about the centre of mass.
    const bool isFree = !hangs(world, joints);
    if (isFree) turnToMomentum(world.bodies, group, before.momentum);
    const double work =
        workOfClosing(world, group, {bench.paths.data(), bench.paths.size()}) + before.stored - storedBy(world, joints);
    const double most = share > 0 ? std::max(0.0, before.kinetic + std::min(0.0, work)) : 0.0;
    const double excess = kineticOf(world, group) - most;
    return excess - takeEnergy(world.bodies, world.joints, group, excess, isFree ? Keeps::momenta : Keeps::nothing);
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
    const Vec3 common = world.bodies.dynamics[group.front()].acceleration;
    for (const std::uint32_t body : group) {
        const auto& forces = world.bodies.dynamics[body];
        if (forces.acceleration != common || forces.torque != Vec3{}) return false;
        for (std::uint32_t key = world.bodies[body].firstContact; key != kNone; key = world.contacts.next(key)) {
            const ContactRecord& contact = world.contacts[key >> 1];
            if (!contact.sensor && contact.hasPoints &&
                !areGrouped(world.bodies, world.energyGuard, contact.bodyA, contact.bodyB))
                return false;
        }
    }
    return true;
}

/// What a group that is alone began with is what it is to have: long substeps keep less of it than they should.
Vec3 momentumToHave(const ClosingView& world, std::size_t g, std::span<const std::uint32_t> joints) {
    const EnergyGuard& guard = world.energyGuard;
    const std::span<const std::uint32_t> group = guard.membersOf(g);
    if (guard.watched[g] != Watching::none && isAlone(world, group, joints))
        return angularMomentum(world.bodies, group, [&](std::uint32_t b) {
            const StartPose& start = world.sweptBodies.startPoses()[world.bodies[b].awakeIndex];
            return MovingPose{start.center, start.rotation, guard.speeds[b].v, guard.speeds[b].w};
        });
    return angularMomentum(world.bodies, group, [&](std::uint32_t b) {
        const BodyState& now = world.bodies.states[b];
        return MovingPose{world.bodies[b].center, world.bodies[b].rotation, now.v, now.w};
    });
}

void closeGroup(const ClosingView& world, std::size_t g, JointClosing::Bench& bench) {
    const std::span<const std::uint32_t> group = world.energyGuard.membersOf(g);
    findTouches(world, group, bench.touches);
    const direct::IslandParts parts = partsOf(world, group, bench);
    const std::span<const std::uint32_t> joints(bench.joints.data(), bench.joints.size());
    bench.paths.clear();
    bench.speeds.clear();
    for (const std::uint32_t body : group) {
        bench.paths.push(pathOfStep(world.bodies, world.sweptBodies.startPoses(), world.dt, body));
        bench.speeds.push({world.bodies.states[body].v, world.bodies.states[body].w});
    }
    bench.system.begin(parts, world.bodies.arrays(), world.context);
    bench.pivots = 0;
    const BeforeClosing before{momentumToHave(world, g, joints), kineticOf(world, group), storedBy(world, joints)};
    float share = 1;
    if (closeByPlaces(world, group, joints, bench) > kTorn) share = closeEarlier(world, group, joints, bench, 1);
    double excess = fitSpeeds(world, group, joints, bench, before, share);
    while (share > 0 && excess > kGained * before.kinetic) {
        moveToEnd(world, group, bench);
        share = closeEarlier(world, group, joints, bench, 0.5f * share);
        excess = fitSpeeds(world, group, joints, bench, before, share);
    }
    // What others turned it to in the step may be more than it can have where the step began.
    if (!hangs(world, joints) && !isAlone(world, group, joints)) {
        const double more = kineticOf(world, group) - before.kinetic;
        takeEnergy(world.bodies, world.joints, group, more, Keeps::linearMomentum);
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
    AlignedArray<ClosingTouch>& touches = closing.benches.front()->touches;
    findTouches(world, group, touches);
    if (group.size() <= closing.mostBodies && joints <= closing.mostJoints && touches.size() <= closing.mostTouches)
        return;
    closing.mostBodies = std::max(closing.mostBodies, group.size());
    closing.mostJoints = std::max(closing.mostJoints, joints);
    constexpr std::size_t kTouchesOfABody = 16;  // few lie in more
    closing.mostTouches = std::max({closing.mostTouches, 2 * touches.size(), kTouchesOfABody * group.size()});
    for (const std::unique_ptr<JointClosing::Bench>& bench : closing.benches) {
        bench->touches.reserve(closing.mostTouches);
        bench->points.reserve(closing.mostTouches);
        findTouches(world, group, bench->touches);
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
            closing.open[g] = isOpen(world, g) ? 1 : 0;
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
