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
static int wantedRegions(const RegionView& view) {
    const std::size_t most = view.bodies.awake.size() / kLeastBodies;
    const auto wanted = static_cast<int>(std::min(most, static_cast<std::size_t>(view.workers)));
    return wanted < 2 ? 0 : wanted;
}

static bool anyBetweenRegions(const RegionView& view) {
    if (view.graph.iteratedLists(0) != 0) return true;
    for (std::size_t group = 0; group < view.moduleWork.groupCount(); ++group)
        if (regionOfGroup(view.moduleWork, view.bodies, view.graph, group) == kNone) return true;
    return false;
}

/// Per root of an island: its bodies, joints and contacts.
static void weighIslands(const RegionView& view) {
    view.islands.uniteConstraints(view.tables, false);
    uniteNamed(view.moduleWork, view.bodies, view.islands);
    view.regions.weights.resizeForOverwrite(view.bodies.size());
    for (const std::uint32_t body : view.bodies.awake) view.regions.weights[body] = 0;
    const auto weigh = [&](std::uint32_t a, std::uint32_t b, std::uint32_t weight) {
        if (view.bodies.moves(a) || view.bodies.moves(b))
            view.regions.weights[view.islands.root(view.bodies.moves(a) ? a : b)] += weight;
    };
    for (const std::uint32_t body : view.bodies.awake) weigh(body, body, 1);
    for (const std::uint32_t body : view.moduleWork.named) weigh(body, body, kNamed);
    for (int c = 0; c < view.graph.listCount(); ++c) {
        if (!ConstraintGraph::isIterated(c)) continue;
        for (const std::uint32_t m : view.graph.color(c).manifolds)
            weigh(view.contacts[view.manifolds[m].contact].bodyA, view.contacts[view.manifolds[m].contact].bodyB, 1);
        for (const std::uint32_t j : view.graph.color(c).joints) weigh(view.joints[j].bodyA, view.joints[j].bodyB, 1);
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
static bool mendRegions(const RegionView& view, int wanted) {
    if (view.graph.regionCount() != wanted || !view.graph.color(ConstraintGraph::kOverflow).empty()) return false;
    view.regions.ofIsland.resizeForOverwrite(view.bodies.size());
    for (const std::uint32_t body : view.bodies.awake) view.regions.ofIsland[body] = kNone;
    for (const std::uint32_t body : view.bodies.awake) {
        if (!view.bodies.moves(body)) continue;
        std::uint32_t& of = view.regions.ofIsland[view.islands.root(body)];
        const std::uint32_t region = view.graph.regionOf(view.bodies[body].state);
        of = of == kNone || of == region ? region : 0;
    }
    view.regions.loads.clear();
    view.regions.loads.resize(static_cast<std::size_t>(wanted) + 1, 0);
    for (const std::uint32_t body : view.bodies.awake)
        if (view.bodies.moves(body) && view.islands.root(body) == body)
            view.regions.loads[view.regions.ofIsland[body]] += view.regions.weights[body];
    for (const std::uint32_t body : view.bodies.awake)
        if (view.bodies.moves(body) && view.islands.root(body) == body && view.regions.ofIsland[body] == 0) {
            const auto lightest = std::min_element(view.regions.loads.begin() + 1, view.regions.loads.end());
            *lightest += view.regions.weights[body];
            view.regions.ofIsland[body] = static_cast<std::uint32_t>(lightest - view.regions.loads.begin());
        }
    return areEven(view.regions.loads);
}

/// In the order of bodies, so that those of a region are neighbours in memory. False where an island is too heavy, or
/// something has found no colour.
static bool dealOutIslands(const RegionView& view, int wanted) {
    if (!view.graph.color(ConstraintGraph::kOverflow).empty()) return false;
    std::uint64_t sum = 0, before = 0;
    for (const std::uint32_t body : view.bodies.awake)
        if (view.bodies.moves(body) && view.islands.root(body) == body) sum += view.regions.weights[body];
    view.regions.loads.clear();
    view.regions.loads.resize(static_cast<std::size_t>(wanted) + 1, 0);
    view.regions.ofIsland.resizeForOverwrite(view.bodies.size());
    for (std::uint32_t body = 1; body < view.bodies.size(); ++body) {
        if (!view.bodies.slots.isUsed(body) || !view.bodies.moves(body) || !view.bodies.isAwake(body) ||
            view.islands.root(body) != body)
            continue;
        const std::uint64_t middle = before + view.regions.weights[body] / 2;
        const auto region = static_cast<std::uint32_t>(1 + middle * static_cast<std::uint64_t>(wanted) / sum);
        view.regions.ofIsland[body] = region;
        view.regions.loads[region] += view.regions.weights[body];
        before += view.regions.weights[body];
    }
    return areEven(view.regions.loads);
}

/// Bodies and their constraints into so many regions; 0 dissolves them.
static void moveToRegions(const RegionView& view, int wanted) {
    for (ConstraintGraph::BodyPlace& place : view.graph.bodies())
        if (wanted == 0 || place.region > static_cast<std::uint32_t>(wanted)) place.region = 0;
    if (wanted > view.graph.regionCount()) view.graph.resizeRegions(wanted);
    if (wanted > 0)
        for (const std::uint32_t body : view.bodies.awake)
            if (view.bodies.moves(body))
                view.graph.setRegion(view.bodies[body].state, view.regions.ofIsland[view.islands.root(body)]);
    const auto regionOf = [&](std::uint32_t a, std::uint32_t b) {
        return view.graph.regionOf(view.bodies[view.bodies.moves(a) ? a : b].state);
    };
    for (int c = 0; c < view.graph.listCount(); ++c) {
        if (!ConstraintGraph::isIterated(c)) continue;
        ConstraintGraph::Color& list = view.graph.color(c);
        for (std::uint32_t slot = 0; slot < list.manifolds.size();) {
            ManifoldRecord& manifold = view.manifolds[list.manifolds[slot]];
            const ContactRecord& record = view.contacts[manifold.contact];
            std::uint32_t tookOver = kNone;
            manifold.place = view.graph.changeRegion(manifold.place, regionOf(record.bodyA, record.bodyB), tookOver);
            if (tookOver != kNone) view.manifolds[tookOver].place.slot = slot;
            if (manifold.place.color == static_cast<std::uint32_t>(c)) ++slot;
        }
        for (std::uint32_t slot = 0; slot < list.joints.size();) {
            JointRecord& joint = view.joints[list.joints[slot]];
            std::uint32_t tookOver = kNone;
            joint.place = view.graph.changeJointRegion(joint.place, regionOf(joint.bodyA, joint.bodyB), tookOver);
            if (tookOver != kNone) view.joints[tookOver].place.slot = slot;
            if (joint.place.color == static_cast<std::uint32_t>(c)) ++slot;
        }
    }
    view.graph.resizeRegions(wanted);
    view.joints.bundlesChanged = true;
    if (wanted > 0) view.regions.nextWait = 0;
}

/// Does nothing between the passes of a substep concern several regions, or anybody else?
static bool areIndependent(const RegionView& view) {
    if (view.moduleWork.onAll) return false;
    for (std::size_t group = 0; group < view.moduleWork.groupCount(); ++group)
        if (regionOfGroup(view.moduleWork, view.bodies, view.graph, group) == kNone) return false;
    if (view.bouncy || view.settings.sequentialFriction || !view.couplings.iterated.empty() ||
        !view.contactFinds.fresh.empty())
        return false;
    if (!view.directSet.islands.empty() || view.directSet.multirate.any || view.graph.iteratedLists(0) != 0)
        return false;
    for (const std::uint32_t body : view.freezing.solved)
        if (!view.bodies.moves(body) && (view.bodies.states[body].v != Vec3{} || view.bodies.states[body].w != Vec3{}))
            return false;
    return true;
}

/// Where a constraint has come up that lies in no region, or the number of bodies has changed, islands are dealt out
/// anew.
void divideIntoRegions(const RegionView& view) {
    const int now = view.graph.regionCount();
    int wanted = wantedRegions(view);
    if (now == 0 && (wanted == 0 || view.regions.wait > 0)) {
        if (view.regions.wait > 0) --view.regions.wait;
        return;
    }
    if (now > 0 && now <= wanted && wanted < 2 * now) wanted = now;
    if (wanted == now && !anyBetweenRegions(view)) return;
    if (wanted > 0) {
        weighIslands(view);
        if (!mendRegions(view, wanted) && !dealOutIslands(view, wanted)) {
            view.regions.wait = view.regions.nextWait = std::clamp(2 * view.regions.nextWait, kFirstWait, kLongestWait);
            wanted = 0;
        }
    }
    moveToRegions(view, wanted);
}

/// What belongs to each region in this step.
void collectRegions(const RegionView& view) {
    const int count = view.graph.regionCount();
    view.regions.independent = count > 0 && areIndependent(view);
    if (!view.regions.independent) return;
    const auto regionOf = [&](std::uint32_t body) { return view.graph.regionOf(view.bodies[body].state); };
    view.regions.bodies.fill(
        count, view.freezing.solved.size(), [&](std::size_t i) { return view.freezing.solved[i]; },
        [&](std::size_t i) { return regionOf(view.freezing.solved[i]); });
    view.regions.modules.fill(
        count, view.moduleWork.groupCount(), [&](std::size_t g) { return static_cast<std::uint32_t>(g); },
        [&](std::size_t g) { return regionOfGroup(view.moduleWork, view.bodies, view.graph, g); });
    const std::size_t groups = view.articulations.count();
    view.regions.articulations.fill(
        count, groups, [&](std::size_t i) { return static_cast<std::uint32_t>(i); },
        [&](std::size_t i) { return regionOf(view.articulations.firstBody(i)); });
}

}  // namespace ragtop
