// Regions: islands that have nothing to do with each other, dealt out to as many tasks as there are workers. A region goes
// through all substeps of a step without waiting for anybody. Constraints keep their colours, so that the bits are those of
// a world without regions, and how many there are may depend on the number of workers (docs/adr/0036-regions.md).

#include <algorithm>
#include <limits>

#include "world/world_impl.h"

namespace ragtop {

namespace {

constexpr std::size_t kLeastBodies = 64;  ///< per region: fewer leave too many lanes without a contact
constexpr float kMostUneven = 1.4f;       ///< weight of the heaviest region over the mean, for which dividing pays
/// Steps until islands are looked at again after they were too few or too unequal.
constexpr std::uint32_t kFirstWait = 64, kLongestWait = 1024;

}  // namespace

/// As many as there are workers, if the bodies suffice.
int WorldImpl::wantedRegions() const {
    const std::size_t most = awakeBodies.size() / kLeastBodies;
    const auto wanted = static_cast<int>(std::min(most, static_cast<std::size_t>(runner.workers())));
    return wanted < 2 ? 0 : wanted;
}

bool WorldImpl::anyBetweenRegions() const {
    for (int c = 0; c < ConstraintGraph::kRegionLists; ++c)
        if (!graph.color(c).empty()) return true;
    return false;
}

/// Where a constraint has come up that lies in no region, or the number of bodies has changed, islands are dealt out anew.
void WorldImpl::divideIntoRegions() {
    const int now = graph.regionCount();
    int wanted = wantedRegions();
    if (now == 0 && (wanted == 0 || regions.wait > 0)) {
        if (regions.wait > 0) --regions.wait;
        return;
    }
    if (now > 0 && now <= wanted && wanted < 2 * now) wanted = now;
    if (wanted == now && !anyBetweenRegions()) return;
    if (wanted > 0) {
        weighIslands();
        if (!mendRegions(wanted) && !dealOutIslands(wanted)) {
            regions.wait = regions.nextWait = std::clamp(2 * regions.nextWait, kFirstWait, kLongestWait);
            wanted = 0;
        }
    }
    moveToRegions(wanted);
}

/// Per root of an island: twice its bodies, joints and contacts.
void WorldImpl::weighIslands() {
    uniteConstraints(false);
    regions.weights.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : awakeBodies) regions.weights[body] = 0;
    const auto weigh = [&](std::uint32_t a, std::uint32_t b, std::uint32_t weight) {
        if (moves(a) || moves(b)) regions.weights[findRoot(moves(a) ? a : b)] += weight;
    };
    for (const std::uint32_t body : awakeBodies) weigh(body, body, 1);
    for (int c = 0; c < graph.listCount(); ++c) {
        if (!ConstraintGraph::isSwept(c)) continue;
        for (const std::uint32_t m : graph.color(c).manifolds)
            weigh(contacts[manifolds[m].contact].bodyA, contacts[manifolds[m].contact].bodyB, 1);
        for (const std::uint32_t j : graph.color(c).joints) weigh(joints[j].bodyA, joints[j].bodyB, 1);
    }
}

/// Is the heaviest region not much heavier than the mean?
static bool areEven(const AlignedArray<std::uint32_t>& loads) {
    std::uint32_t most = 0, sum = 0;
    for (std::size_t r = 1; r < loads.size(); ++r) most = std::max(most, loads[r]), sum += loads[r];
    return static_cast<float>(most) * static_cast<float>(loads.size() - 1) <= kMostUneven * static_cast<float>(sum);
}

/// Islands that lie in a region stay there; what has grown together, or is new, joins the lightest region. False where that
/// leaves them uneven.
bool WorldImpl::mendRegions(int wanted) {
    if (graph.regionCount() != wanted || !graph.color(ConstraintGraph::kOverflow).empty()) return false;
    regions.ofIsland.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : awakeBodies) regions.ofIsland[body] = kNone;
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        std::uint32_t& of = regions.ofIsland[findRoot(body)];
        const std::uint32_t region = graph.regionOf(bodies[body].state);
        of = of == kNone || of == region ? region : 0;
    }
    regions.loads.clear();
    regions.loads.resize(static_cast<std::size_t>(wanted) + 1, 0);
    for (const std::uint32_t body : awakeBodies)
        if (moves(body) && findRoot(body) == body) regions.loads[regions.ofIsland[body]] += regions.weights[body];
    for (const std::uint32_t body : awakeBodies)
        if (moves(body) && findRoot(body) == body && regions.ofIsland[body] == 0) {
            const auto lightest = std::min_element(regions.loads.begin() + 1, regions.loads.end());
            *lightest += regions.weights[body];
            regions.ofIsland[body] = static_cast<std::uint32_t>(lightest - regions.loads.begin());
        }
    return areEven(regions.loads);
}

/// In the order of bodies, so that those of a region are neighbours in memory. False where an island is too heavy, or
/// something has found no colour.
bool WorldImpl::dealOutIslands(int wanted) {
    if (!graph.color(ConstraintGraph::kOverflow).empty()) return false;
    std::uint64_t sum = 0, before = 0;
    for (const std::uint32_t body : awakeBodies)
        if (moves(body) && findRoot(body) == body) sum += regions.weights[body];
    regions.loads.clear();
    regions.loads.resize(static_cast<std::size_t>(wanted) + 1, 0);
    regions.ofIsland.resizeForOverwrite(bodies.size());
    for (std::uint32_t body = 1; body < bodies.size(); ++body) {
        if (!bodySlots.isUsed(body) || !moves(body) || !isAwake(body) || findRoot(body) != body) continue;
        const std::uint64_t middle = before + regions.weights[body] / 2;
        const auto region = static_cast<std::uint32_t>(1 + middle * static_cast<std::uint64_t>(wanted) / sum);
        regions.ofIsland[body] = region;
        regions.loads[region] += regions.weights[body];
        before += regions.weights[body];
    }
    return areEven(regions.loads);
}

/// Bodies and their constraints into so many regions; 0 dissolves them.
void WorldImpl::moveToRegions(int wanted) {
    for (ConstraintGraph::BodyPlace& place : graph.bodies())
        if (wanted == 0 || place.region > static_cast<std::uint32_t>(wanted)) place.region = 0;
    if (wanted > graph.regionCount()) graph.resizeRegions(wanted);
    if (wanted > 0)
        for (const std::uint32_t body : awakeBodies)
            if (moves(body)) graph.setRegion(bodies[body].state, regions.ofIsland[findRoot(body)]);
    const auto regionOf = [&](std::uint32_t a, std::uint32_t b) {
        return graph.regionOf(bodies[moves(a) ? a : b].state);
    };
    for (int c = 0; c < graph.listCount(); ++c) {
        if (!ConstraintGraph::isSwept(c)) continue;
        ConstraintGraph::Color& list = graph.color(c);
        for (std::uint32_t slot = 0; slot < list.manifolds.size();) {
            ManifoldRecord& manifold = manifolds[list.manifolds[slot]];
            const ContactRecord& record = contacts[manifold.contact];
            std::uint32_t tookOver = kNone;
            manifold.place = graph.changeRegion(manifold.place, regionOf(record.bodyA, record.bodyB), tookOver);
            if (tookOver != kNone) manifolds[tookOver].place.slot = slot;
            if (manifold.place.color == static_cast<std::uint32_t>(c)) ++slot;
        }
        for (std::uint32_t slot = 0; slot < list.joints.size();) {
            JointRecord& joint = joints[list.joints[slot]];
            std::uint32_t tookOver = kNone;
            joint.place = graph.changeJointRegion(joint.place, regionOf(joint.bodyA, joint.bodyB), tookOver);
            if (tookOver != kNone) joints[tookOver].place.slot = slot;
            if (joint.place.color == static_cast<std::uint32_t>(c)) ++slot;
        }
    }
    graph.resizeRegions(wanted);
    bundlesChanged = true;
    if (wanted > 0) regions.nextWait = 0;
}

/// What belongs to each region in this step.
void WorldImpl::collectRegions() {
    const int count = graph.regionCount();
    regions.usedLists.clear();
    regions.usedLists.resize(static_cast<std::size_t>(count) + 1, 0);
    for (int r = 0; r <= count; ++r)
        for (int c = 0; c < ConstraintGraph::kRegionLists; ++c)
            if (!graph.color(ConstraintGraph::firstList(r) + c).empty())
                regions.usedLists[static_cast<std::size_t>(r)] |= 1u << c;
    regions.alone = count > 0 && goAlone();
    if (!regions.alone) return;
    const auto regionOf = [&](std::uint32_t body) { return graph.regionOf(bodies[body].state); };
    regions.bodies.fill(count, rest.solved.size(), [&](std::size_t i) { return rest.solved[i]; },
                        [&](std::size_t i) { return regionOf(rest.solved[i]); });
    const std::size_t groups = assemblies.starts.empty() ? 0 : assemblies.starts.size() - 1;
    regions.assemblies.fill(count, groups, [&](std::size_t i) { return static_cast<std::uint32_t>(i); },
                            [&](std::size_t i) { return regionOf(assemblies.bodies[assemblies.starts[i]]); });
}

/// Does nothing between the passes of a substep concern several regions, or anybody else?
bool WorldImpl::goAlone() const {
    for (const StepModule* module : modules)
        if (module->beforeSubstep) return false;
    if (bouncy || settings.sequentialFriction || !sweptCouplings.empty() || !freshManifolds.empty()) return false;
    if (!directIslands.empty() || strides.any || regions.usedLists[0] != 0) return false;
    for (const std::uint32_t body : rest.solved)
        if (!moves(body) && (states[body].v != Vec3{} || states[body].w != Vec3{})) return false;
    return true;
}

}  // namespace ragtop
