#include <algorithm>
#include <atomic>
#include <cstring>

#include "constraints/contact_layout.h"
#include "direct/newton.h"
#include "world/fallback.h"
#include "world/multirate.h"
#include "world/world_impl.h"
#include "world/world_regions.h"

namespace ragtop {

/// Moves all constraints of marked islands to the list of their solver.
void WorldImpl::applyChoices() {
    const ConstraintGraph::Color& list = graph.color(ConstraintGraph::kDirect);
    bool any = !list.manifolds.empty() || !list.joints.empty();
    for (std::size_t i = 0; i < bodies.awake.size() && !any; ++i) any = bodies.isDirect(bodies.awake[i]);
    if (!any) return;
    directSet.movedConstraints.clear();
    const auto changes = [&](std::uint32_t a, std::uint32_t b, GraphPlace place) {
        return (bodies.isDirect(a) || bodies.isDirect(b)) != (place.color == ConstraintGraph::kDirect);
    };
    std::size_t contactCount = 0;
    forEachInGraph(
        tables(),
        [&](std::uint32_t m) {
            const ContactRecord& contact = contacts[manifolds[m].contact];
            if (changes(contact.bodyA, contact.bodyB, manifolds[m].place))
                directSet.movedConstraints.push(m), ++contactCount;
        },
        [&](std::uint32_t j) {
            if (changes(joints[j].bodyA, joints[j].bodyB, joints[j].place)) directSet.movedConstraints.push(j);
        });
    for (std::size_t i = 0; i < directSet.movedConstraints.size(); ++i) {
        const std::uint32_t moved = directSet.movedConstraints[i];
        if (i < contactCount)
            removeFromGraph(moved), addToGraph(moved);
        else
            removeJointFromGraph(moved), addJointToGraph(moved);
    }
}

/// Islands of the direct list, their bodies numbered in the order in which its constraints name them, so that the
/// grouping depends on that list alone.
void WorldImpl::groupDirect() {
    directSet.islands.clear();
    directSet.seen.clear();
    directSet.owner.clear();
    directSet.bodies.clear();
    directSet.manifolds.clear();
    directSet.joints.clear();
    directSet.trees.clear();
    const ConstraintGraph::Color& list = graph.color(ConstraintGraph::kDirect);
    if (list.manifolds.empty() && list.joints.empty()) return;
    islands.parent.resizeForOverwrite(bodies.size());
    directSet.index.resizeForOverwrite(bodies.size());
    const auto forEachPair = [&](auto&& visit) {
        for (const std::uint32_t m : list.manifolds)
            visit(contacts[manifolds[m].contact].bodyA, contacts[manifolds[m].contact].bodyB);
        for (const std::uint32_t j : list.joints) visit(joints[j].bodyA, joints[j].bodyB);
    };
    forEachPair([&](std::uint32_t a, std::uint32_t b) {
        for (const std::uint32_t body : {a, b}) islands.parent[body] = body, directSet.index[body] = kNone;
    });
    forEachPair([&](std::uint32_t a, std::uint32_t b) { islands.unite(bodies, a, b); });
    // Counts first, then places: a root's directIndex is its island.
    const auto islandOf = [&](std::uint32_t a, std::uint32_t b) {
        return directSet.index[islands.root(bodies.moves(a) ? a : b)];
    };
    forEachPair([&](std::uint32_t a, std::uint32_t b) {
        std::uint32_t& index = directSet.index[islands.root(bodies.moves(a) ? a : b)];
        if (index != kNone) return;
        index = static_cast<std::uint32_t>(directSet.islands.size());
        directSet.islands.push({});
    });
    for (const std::uint32_t m : list.manifolds)
        ++directSet.islands[islandOf(contacts[manifolds[m].contact].bodyA, contacts[manifolds[m].contact].bodyB)]
              .contactCount;
    for (const std::uint32_t j : list.joints)
        ++directSet.islands[islandOf(joints[j].bodyA, joints[j].bodyB)].jointCount;
    std::uint32_t contactsBefore = 0, jointsBefore = 0;
    for (DirectIsland& island : directSet.islands) {
        island.firstContact = contactsBefore, island.firstJoint = jointsBefore;
        contactsBefore += island.contactCount, jointsBefore += island.jointCount;
        island.contactCount = island.jointCount = 0;
    }
    directSet.owner.resizeForOverwrite(list.manifolds.size());
    directSet.manifolds.resizeForOverwrite(contactsBefore);
    directSet.joints.resizeForOverwrite(jointsBefore);
    for (const std::uint32_t m : list.manifolds) {
        DirectIsland& island =
            directSet.islands[islandOf(contacts[manifolds[m].contact].bodyA, contacts[manifolds[m].contact].bodyB)];
        directSet.manifolds[island.firstContact + island.contactCount++] = m;
        directSet.owner[manifolds[m].place.slot] = static_cast<std::uint32_t>(&island - directSet.islands.data());
    }
    for (const std::uint32_t j : list.joints) {
        DirectIsland& island = directSet.islands[islandOf(joints[j].bodyA, joints[j].bodyB)];
        directSet.joints[island.firstJoint + island.jointCount++] = j;
    }
    numberDirectBodies();
    planChains();
    planMechanisms();
    assignSystems();
}

void WorldImpl::numberDirectBodies() {
    for (DirectIsland& island : directSet.islands) {
        island.firstBody = static_cast<std::uint32_t>(directSet.bodies.size());
        const auto number = [&](std::uint32_t body) {
            if (!bodies.moves(body) || islands.parent[body] == kNone) return;
            islands.parent[body] = kNone;  // counted
            directSet.bodies.push(body);
        };
        for (std::uint32_t i = 0; i < island.contactCount; ++i) {
            const ContactRecord& contact = contacts[manifolds[directSet.manifolds[island.firstContact + i]].contact];
            number(contact.bodyA);
            number(contact.bodyB);
        }
        for (std::uint32_t i = 0; i < island.jointCount; ++i) {
            number(joints[directSet.joints[island.firstJoint + i]].bodyA);
            number(joints[directSet.joints[island.firstJoint + i]].bodyB);
        }
        island.bodyCount = static_cast<std::uint32_t>(directSet.bodies.size()) - island.firstBody;
    }
}

/// Of Newton's method.
static bool hasSystem(const DirectIsland& island) { return !island.tree && !island.mechanism; }

/// An island keeps the system that it had, known by its first body, however the others come and go; what is new gets one
/// that is free.
void WorldImpl::assignSystems() {
    constexpr std::size_t kMore = 4;  // systems are made at a time
    directSet.systemOfBody.resize(bodies.size(), kNone);
    const auto firstOf = [&](const DirectIsland& island) { return directSet.bodies[island.firstBody]; };
    for (DirectIsland& island : directSet.islands)
        if (hasSystem(island)) island.system = directSet.systemOfBody[firstOf(island)];
    for (std::uint32_t& owner : directSet.systemOwner) {
        if (owner != kNone) directSet.systemOfBody[owner] = kNone;
        owner = kNone;
    }
    const auto give = [&](DirectIsland& island, std::size_t system) {
        island.system = static_cast<std::uint32_t>(system);
        directSet.systemOwner[system] = firstOf(island);
        directSet.systemOfBody[firstOf(island)] = island.system;
    };
    for (DirectIsland& island : directSet.islands)
        if (island.system != kNone) give(island, island.system);
    std::size_t next = 0;
    for (DirectIsland& island : directSet.islands) {
        if (!hasSystem(island) || island.system != kNone) continue;
        while (next < directSet.systemOwner.size() && directSet.systemOwner[next] != kNone) ++next;
        if (next == directSet.systemOwner.size())
            for (std::size_t i = 0; i < kMore; ++i) {
                directSet.systems.push_back(std::make_unique<direct::IslandSystem>(memory));
                directSet.systemOwner.push(kNone);
            }
        give(island, next);
    }
}

/// Calls visit(bundle) in parallel for those of direct islands.
template <class Visit>
static void forEachDirectBundle(WorldImpl& world, Visit&& visit) {
    world.runner.parallelFor(world.graph.bundleCount(ConstraintGraph::kDirect), 64, [&](int begin, int end, int) {
        for (int b = begin; b < end; ++b) visit(static_cast<std::size_t>(b));
    });
}

/// Tells the islands of which some lane is not that of the last step, to the bit.
void WorldImpl::recordDirectBundles() {
    const AlignedArray<float>& now = graph.color(ConstraintGraph::kDirect).bundles;
    const auto lanes = static_cast<std::size_t>(graph.lanes());
    const std::size_t floats = contact::kFields * lanes, known = std::min(directSet.seen.size(), now.size()) / floats;
    directSet.seen.resizeForOverwrite(now.size());
    for (DirectIsland& island : directSet.islands) island.renewed = false;
    forEachDirectBundle(*this, [&](std::size_t b) {
        const float* bundle = now.data() + b * floats;
        float* seen = directSet.seen.data() + b * floats;
        if (b < known && std::memcmp(seen, bundle, floats * sizeof(float)) == 0) return;
        for (std::size_t lane = 0; lane < lanes && b * lanes + lane < directSet.owner.size(); ++lane) {
            bool renewed = b >= known;
            for (std::size_t i = lane; !renewed && i < floats; i += lanes)
                renewed = std::memcmp(seen + i, bundle + i, sizeof(float)) != 0;
            if (renewed)
                std::atomic_ref(directSet.islands[directSet.owner[b * lanes + lane]].renewed)
                    .store(true, std::memory_order_relaxed);
        }
        std::memcpy(static_cast<void*>(seen), bundle, floats * sizeof(float));
    });
}

/// Is any of its contacts, or how many they are, other than when its system was made?
bool WorldImpl::isRenewed(const DirectIsland& island) const {
    return island.renewed ||
           !directSet.systems[island.system]->isOf(island.bodyCount, island.contactCount, island.jointCount);
}

/// What contacts of islands that rest again have borne. Their loads are the impulses in their lanes.
void WorldImpl::addDirectPeaks() {
    const auto lanes = static_cast<std::size_t>(graph.lanes());
    AlignedArray<float>& bundles = graph.color(ConstraintGraph::kDirect).bundles;
    forEachDirectBundle(*this, [&](std::size_t b) {
        float* bundle = bundles.data() + b * contact::kFields * lanes;
        for (std::size_t lane = 0; lane < lanes && b * lanes + lane < directSet.owner.size(); ++lane) {
            const int substeps = directSet.islands[directSet.owner[b * lanes + lane]].restedAgain;
            for (int j = 0; j < contact::kMaxPoints && substeps > 0; ++j) {
                float* point = bundle + static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields) * lanes + lane;
                point[contact::kPeak * lanes] +=
                    static_cast<float>(substeps * static_cast<double>(point[contact::kImpulse * lanes]));
            }
        }
    });
}

void WorldImpl::beginIsland(DirectIsland& island, int index) {
    if (island.tree) return;
    island.begin();
    for (std::uint32_t i = 0; i < island.jointCount; ++i)
        directSet.sims[island.firstJoint + i] = &joints.sims[directSet.joints[island.firstJoint + i]];
    if (island.mechanism) return beginMechanism(island, *directSet.mechanisms[static_cast<std::size_t>(index)]);
    direct::IslandSystem& system = *directSet.systems[island.system];
    island.unchanged = island.jointCount == 0 && system.restedThrough(settings.substeps) && !isRenewed(island);
    if (island.unchanged) return system.beginAgain();  // its lanes are where they were
    for (std::uint32_t i = 0; i < island.contactCount; ++i)
        directSet.lanes[island.firstContact + i] =
            graph.lane(manifolds[directSet.manifolds[island.firstContact + i]].place);
    direct::IslandParts parts;
    parts.bodies = directSet.bodies.data() + island.firstBody;
    parts.bodyCount = island.bodyCount;
    parts.lanes = directSet.lanes.data() + island.firstContact;
    parts.contactCount = island.contactCount;
    parts.joints = directSet.sims.data() + island.firstJoint;
    parts.jointCount = island.jointCount;
    parts.laneStride = graph.lanes();
    parts.localOf = directSet.index.data();
    system.begin(parts, bodies.arrays(), context);
}

/// In parallel, but trees, which are many and have their lanes; none is looked at where all are trees.
template <class Visit>
static void forEachDirectIsland(WorldImpl& world, Visit&& visit) {
    AlignedArray<DirectIsland>& islands = world.directSet.islands;
    if (world.directSet.trees.treeCount() == islands.size()) return;
    world.runner.parallelFor(static_cast<int>(islands.size()), 1, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i)
            if (DirectIsland& island = islands[static_cast<std::size_t>(i)]; !island.tree) visit(island, i);
    });
}

void WorldImpl::beginDirect() {
    if (directSet.islands.empty()) return;
    recordDirectBundles();
    directSet.lanes.resizeForOverwrite(directSet.manifolds.size());
    directSet.sims.resizeForOverwrite(directSet.joints.size());
    directSet.index.resizeForOverwrite(bodies.size());
    forEachDirectIsland(*this, [&](DirectIsland& island, int i) { beginIsland(island, i); });
    beginChains();
}

/// Joints alone make a nearly linear system, of which only rounding can be left, and iteration would tear it; but a
/// tree that could not be eliminated has no answer at all.
static bool isUnsolved(const DirectIsland& island) {
    return !island.report.converged && (island.contactCount > 0 || island.tree || island.mechanism);
}

void WorldImpl::solveDirect(DirectPass pass) {
    if (directSet.islands.empty()) return;
    forEachDirectIsland(*this, [&](DirectIsland& island, int i) {
        if (island.fellBack)
            iterateIsland(*this, island, pass);
        else if (island.mechanism)
            solveMechanism(island, *directSet.mechanisms[static_cast<std::size_t>(i)], pass);
        else
            solveSystem(island, pass);
    });
    solveChains(pass);
}

/// By Newton's method.
void WorldImpl::solveSystem(DirectIsland& island, DirectPass pass) {
    const BodyArrays arrays = bodies.arrays();
    direct::IslandSystem& system = *directSet.systems[island.system];
    if (pass == DirectPass::velocities && system.rests()) return system.updateLoads(island.factored);
    const auto start = std::chrono::steady_clock::now();
    switch (pass) {
        case DirectPass::positions:
            system.beginSubstep(arrays, jointContext);
            if (system.rests()) return system.writeVelocities(arrays);
            system.aimAtPositions(arrays, context);
            if (island.jointCount > 0) island.factored = false;
            direct::solve(system, true, island.factored, island.report);
            if (isUnsolved(island)) {
                fallBack(*this, island, pass);
                break;
            }
            system.writeVelocities(arrays);
            if (system.aimAgain(arrays, jointContext)) {
                island.factored = false;
                direct::solve(system, false, island.factored, island.report);
                if (!isUnsolved(island)) system.writeVelocities(arrays);
            }
            break;
        case DirectPass::velocities:
            if (system.aimAtVelocities(arrays, context)) {
                direct::solve(system, false, island.factored, island.report);
                if (isUnsolved(island)) {
                    fallBack(*this, island, pass);
                    break;
                }
                system.writeVelocities(arrays);
            }
            system.updateLoads(island.factored);
            break;
    }
    island.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// What could not be solved falls back to iteration for a while, each time for twice as long until it comes to rest: a
/// heap that never can be is tried ever more seldom.
void WorldImpl::startCooldown(const DirectIsland& island, bool rests) {
    const bool failed = isUnsolved(island);
    const bool costly = island.bodyCount > direct::kMostBodies && island.report.factorizations > 0;
    if (!failed && !costly && !rests) return;
    directSet.failures += failed;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        BodyRecord& body = bodies[directSet.bodies[island.firstBody + i]];
        if (rests) body.directFailures = 0;
        if (costly) body.directSteps -= direct::kFactorSteps;
        if (!failed && body.directSteps > 0) continue;
        if (island.mechanism) {  // Newton's method is next
            body.directFailures = 1;
            islands.graphChanged = islands.directChanged = true;
            continue;
        }
        body.directSteps = -(direct::kCooldownSteps << body.directFailures);
        if (body.directFailures < direct::kMostDoublings) ++body.directFailures;
        islands.graphChanged = islands.directChanged = true;
    }
}

void WorldImpl::endDirect() {
    for (std::size_t i = 0; i < directSet.islands.size(); ++i)
        if (const DirectIsland& island = directSet.islands[i]; !island.unchanged)
            startCooldown(island, hasSystem(island) && !island.fellBack && directSet.systems[island.system]->rests());
    for (std::size_t i = 0; i < directSet.islands.size(); ++i)
        if (const DirectIsland& island = directSet.islands[i]; island.mechanism)
            keepPace(island, *directSet.mechanisms[i]);
    for (const DirectIsland& island : directSet.islands)
        if (island.multirate && !island.independent) recordGaps(*this, island);
    directSet.ledger.clear();
    if (directSet.islands.size() > directSet.ledger.capacity())
        directSet.ledger.reserve(2 * directSet.islands.size() + 8);
    for (const DirectIsland& island : directSet.islands)
        directSet.ledger.push_back({direct::nameOf(bodies[directSet.bodies[island.firstBody]].directReason),
                                    static_cast<int>(island.bodyCount), static_cast<int>(island.contactCount),
                                    static_cast<int>(island.jointCount), island.report.iterations,
                                    island.report.factorizations, island.report.residual, island.ms,
                                    island.report.converged});
    std::atomic<bool> restsAgain{false};
    forEachDirectIsland(*this, [&](DirectIsland& island, int) {
        if (island.fellBack || !hasSystem(island)) return;
        direct::IslandSystem& system = *directSet.systems[island.system];
        if (!system.restsAgain(island.unchanged)) return system.end();
        island.restedAgain = system.restedSubsteps();
        restsAgain.store(true, std::memory_order_relaxed);
    });
    if (restsAgain.load(std::memory_order_relaxed)) addDirectPeaks();
}

}  // namespace ragtop
