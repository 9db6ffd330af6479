// Regions: islands that have nothing to do with each other, dealt out to as many tasks as there are workers. A region
// goes through all substeps of a step without waiting for anybody. Constraints keep their colours, so that the bits are
// those of a world without regions, and how many there are may depend on the number of workers
// (docs/adr/0006).

#include <algorithm>

#include "world/world_modules.h"
#include "world/world_regions.h"

namespace ragtop {

namespace {

constexpr std::size_t kLeastBodies = 64;  ///< per region: fewer leave too many lanes without a contact
constexpr std::uint32_t kNamed = 16;      ///< weight of a body that a module acts on, in bodies
constexpr float kMostUneven = 1.4f;       ///< weight of the heaviest region over the mean, for which dividing pays
/// Steps until islands are looked at again after they were too few or too unequal.
constexpr std::uint32_t kFirstWait = 64, kLongestWait = 1024;

}  // namespace

/// As many as there are workers, if the bodies suffice.
static int wantedRegions(const WorldImpl& world) {
    const std::size_t most = world.bodies.awake.size() / kLeastBodies;
    const auto wanted = static_cast<int>(std::min(most, static_cast<std::size_t>(world.runner.workers())));
    return wanted < 2 ? 0 : wanted;
}

static bool anyBetweenRegions(const WorldImpl& world) {
    for (int c = 0; c < ConstraintGraph::kRegionLists; ++c)
        if (!world.graph.color(c).empty()) return true;
    for (std::size_t group = 0; group < world.moduleWork.groupCount(); ++group)
        if (regionOfGroup(world, group) == kNone) return true;
    return false;
}

/// Per root of an island: its bodies, joints and contacts.
static void weighIslands(WorldImpl& world) {
    world.islands.uniteConstraints(world.tables(), false);
    uniteNamed(world);
    world.regions.weights.resizeForOverwrite(world.bodies.size());
    for (const std::uint32_t body : world.bodies.awake) world.regions.weights[body] = 0;
    const auto weigh = [&](std::uint32_t a, std::uint32_t b, std::uint32_t weight) {
        if (world.bodies.moves(a) || world.bodies.moves(b))
            world.regions.weights[world.islands.root(world.bodies.moves(a) ? a : b)] += weight;
    };
    for (const std::uint32_t body : world.bodies.awake) weigh(body, body, 1);
    for (const std::uint32_t body : world.moduleWork.named) weigh(body, body, kNamed);
    for (int c = 0; c < world.graph.listCount(); ++c) {
        if (!ConstraintGraph::isIterated(c)) continue;
        for (const std::uint32_t m : world.graph.color(c).manifolds)
            weigh(world.contacts[world.manifolds[m].contact].bodyA, world.contacts[world.manifolds[m].contact].bodyB,
                  1);
        for (const std::uint32_t j : world.graph.color(c).joints)
            weigh(world.joints[j].bodyA, world.joints[j].bodyB, 1);
    }
}

/// Is the heaviest region not much heavier than the mean?
static bool areEven(const AlignedArray<std::uint32_t>& loads) {
    std::uint32_t most = 0, sum = 0;
    for (std::size_t r = 1; r < loads.size(); ++r) most = std::max(most, loads[r]), sum += loads[r];
    return static_cast<float>(most) * static_cast<float>(loads.size() - 1) <= kMostUneven * static_cast<float>(sum);
}

/// Islands that lie in a region stay there; what has grown together, or is new, joins the lightest region. False where
/// that leaves them uneven.
static bool mendRegions(WorldImpl& world, int wanted) {
    if (world.graph.regionCount() != wanted || !world.graph.color(ConstraintGraph::kOverflow).empty()) return false;
    world.regions.ofIsland.resizeForOverwrite(world.bodies.size());
    for (const std::uint32_t body : world.bodies.awake) world.regions.ofIsland[body] = kNone;
    for (const std::uint32_t body : world.bodies.awake) {
        if (!world.bodies.moves(body)) continue;
        std::uint32_t& of = world.regions.ofIsland[world.islands.root(body)];
        const std::uint32_t region = world.graph.regionOf(world.bodies[body].state);
        of = of == kNone || of == region ? region : 0;
    }
    world.regions.loads.clear();
    world.regions.loads.resize(static_cast<std::size_t>(wanted) + 1, 0);
    for (const std::uint32_t body : world.bodies.awake)
        if (world.bodies.moves(body) && world.islands.root(body) == body)
            world.regions.loads[world.regions.ofIsland[body]] += world.regions.weights[body];
    for (const std::uint32_t body : world.bodies.awake)
        if (world.bodies.moves(body) && world.islands.root(body) == body && world.regions.ofIsland[body] == 0) {
            const auto lightest = std::min_element(world.regions.loads.begin() + 1, world.regions.loads.end());
            *lightest += world.regions.weights[body];
            world.regions.ofIsland[body] = static_cast<std::uint32_t>(lightest - world.regions.loads.begin());
        }
    return areEven(world.regions.loads);
}

/// In the order of bodies, so that those of a region are neighbours in memory. False where an island is too heavy, or
/// something has found no colour.
static bool dealOutIslands(WorldImpl& world, int wanted) {
    if (!world.graph.color(ConstraintGraph::kOverflow).empty()) return false;
    std::uint64_t sum = 0, before = 0;
    for (const std::uint32_t body : world.bodies.awake)
        if (world.bodies.moves(body) && world.islands.root(body) == body) sum += world.regions.weights[body];
    world.regions.loads.clear();
    world.regions.loads.resize(static_cast<std::size_t>(wanted) + 1, 0);
    world.regions.ofIsland.resizeForOverwrite(world.bodies.size());
    for (std::uint32_t body = 1; body < world.bodies.size(); ++body) {
        if (!world.bodies.slots.isUsed(body) || !world.bodies.moves(body) || !world.bodies.isAwake(body) ||
            world.islands.root(body) != body)
            continue;
        const std::uint64_t middle = before + world.regions.weights[body] / 2;
        const auto region = static_cast<std::uint32_t>(1 + middle * static_cast<std::uint64_t>(wanted) / sum);
        world.regions.ofIsland[body] = region;
        world.regions.loads[region] += world.regions.weights[body];
        before += world.regions.weights[body];
    }
    return areEven(world.regions.loads);
}

/// Bodies and their constraints into so many regions; 0 dissolves them.
static void moveToRegions(WorldImpl& world, int wanted) {
    for (ConstraintGraph::BodyPlace& place : world.graph.bodies())
        if (wanted == 0 || place.region > static_cast<std::uint32_t>(wanted)) place.region = 0;
    if (wanted > world.graph.regionCount()) world.graph.resizeRegions(wanted);
    if (wanted > 0)
        for (const std::uint32_t body : world.bodies.awake)
            if (world.bodies.moves(body))
                world.graph.setRegion(world.bodies[body].state, world.regions.ofIsland[world.islands.root(body)]);
    const auto regionOf = [&](std::uint32_t a, std::uint32_t b) {
        return world.graph.regionOf(world.bodies[world.bodies.moves(a) ? a : b].state);
    };
    for (int c = 0; c < world.graph.listCount(); ++c) {
        if (!ConstraintGraph::isIterated(c)) continue;
        ConstraintGraph::Color& list = world.graph.color(c);
        for (std::uint32_t slot = 0; slot < list.manifolds.size();) {
            ManifoldRecord& manifold = world.manifolds[list.manifolds[slot]];
            const ContactRecord& record = world.contacts[manifold.contact];
            std::uint32_t tookOver = kNone;
            manifold.place = world.graph.changeRegion(manifold.place, regionOf(record.bodyA, record.bodyB), tookOver);
            if (tookOver != kNone) world.manifolds[tookOver].place.slot = slot;
            if (manifold.place.color == static_cast<std::uint32_t>(c)) ++slot;
        }
        for (std::uint32_t slot = 0; slot < list.joints.size();) {
            JointRecord& joint = world.joints[list.joints[slot]];
            std::uint32_t tookOver = kNone;
            joint.place = world.graph.changeJointRegion(joint.place, regionOf(joint.bodyA, joint.bodyB), tookOver);
            if (tookOver != kNone) world.joints[tookOver].place.slot = slot;
            if (joint.place.color == static_cast<std::uint32_t>(c)) ++slot;
        }
    }
    world.graph.resizeRegions(wanted);
    world.joints.bundlesChanged = true;
    if (wanted > 0) world.regions.nextWait = 0;
}

/// Does nothing between the passes of a substep concern several regions, or anybody else?
static bool areIndependent(const WorldImpl& world) {
    if (world.moduleWork.onAll) return false;
    for (std::size_t group = 0; group < world.moduleWork.groupCount(); ++group)
        if (regionOfGroup(world, group) == kNone) return false;
    if (world.bouncy || world.settings.sequentialFriction || !world.couplings.iterated.empty() ||
        !world.contactFinds.fresh.empty())
        return false;
    if (!world.directSet.islands.empty() || world.directSet.multirate.any || world.regions.usedLists[0] != 0)
        return false;
    for (const std::uint32_t body : world.freezing.solved)
        if (!world.bodies.moves(body) &&
            (world.bodies.states[body].v != Vec3{} || world.bodies.states[body].w != Vec3{}))
            return false;
    return true;
}

/// Where a constraint has come up that lies in no region, or the number of bodies has changed, islands are dealt out
/// anew.
void divideIntoRegions(WorldImpl& world) {
    const int now = world.graph.regionCount();
    int wanted = wantedRegions(world);
    if (now == 0 && (wanted == 0 || world.regions.wait > 0)) {
        if (world.regions.wait > 0) --world.regions.wait;
        return;
    }
    if (now > 0 && now <= wanted && wanted < 2 * now) wanted = now;
    if (wanted == now && !anyBetweenRegions(world)) return;
    if (wanted > 0) {
        weighIslands(world);
        if (!mendRegions(world, wanted) && !dealOutIslands(world, wanted)) {
            world.regions.wait = world.regions.nextWait =
                std::clamp(2 * world.regions.nextWait, kFirstWait, kLongestWait);
            wanted = 0;
        }
    }
    moveToRegions(world, wanted);
}

/// What belongs to each region in this step.
void collectRegions(WorldImpl& world) {
    const int count = world.graph.regionCount();
    world.regions.usedLists.clear();
    world.regions.usedLists.resize(static_cast<std::size_t>(count) + 1, 0);
    for (int r = 0; r <= count; ++r)
        for (int c = 0; c < ConstraintGraph::kRegionLists; ++c)
            if (!world.graph.color(ConstraintGraph::firstList(r) + c).empty())
                world.regions.usedLists[static_cast<std::size_t>(r)] |= 1u << c;
    world.regions.independent = count > 0 && areIndependent(world);
    if (!world.regions.independent) return;
    const auto regionOf = [&](std::uint32_t body) { return world.graph.regionOf(world.bodies[body].state); };
    world.regions.bodies.fill(
        count, world.freezing.solved.size(), [&](std::size_t i) { return world.freezing.solved[i]; },
        [&](std::size_t i) { return regionOf(world.freezing.solved[i]); });
    world.regions.modules.fill(
        count, world.moduleWork.groupCount(), [&](std::size_t g) { return static_cast<std::uint32_t>(g); },
        [&](std::size_t g) { return regionOfGroup(world, g); });
    const std::size_t groups = world.articulations.count();
    world.regions.articulations.fill(
        count, groups, [&](std::size_t i) { return static_cast<std::uint32_t>(i); },
        [&](std::size_t i) { return regionOf(world.articulations.firstBody(i)); });
}

}  // namespace ragtop
