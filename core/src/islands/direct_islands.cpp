#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>

#include "constraints/contact_layout.h"
#include "direct/choice.h"
#include "direct/newton.h"
#include "islands/direct_view.h"

namespace ragtop {

/// Of Newton's method.
static bool hasSystem(const DirectIsland& island) { return !island.tree && !island.mechanism; }

static void numberDirectBodies(const DirectView& d) {
    for (DirectIsland& island : d.directSet.islands) {
        island.firstBody = static_cast<std::uint32_t>(d.directSet.bodies.size());
        const auto number = [&](std::uint32_t body) {
            if (!d.bodies.moves(body) || d.islands.parent[body] == kNone) return;
            d.islands.parent[body] = kNone;  // counted
            d.directSet.bodies.push(body);
        };
        for (std::uint32_t i = 0; i < island.contactCount; ++i) {
            const ContactRecord& contact =
                d.contacts[d.manifolds[d.directSet.manifolds[island.firstContact + i]].contact];
            number(contact.bodyA);
            number(contact.bodyB);
        }
        for (std::uint32_t i = 0; i < island.jointCount; ++i) {
            number(d.joints[d.directSet.joints[island.firstJoint + i]].bodyA);
            number(d.joints[d.directSet.joints[island.firstJoint + i]].bodyB);
        }
        island.bodyCount = static_cast<std::uint32_t>(d.directSet.bodies.size()) - island.firstBody;
    }
}

/// An island keeps the system that it had, known by its first body, however the others come and go; what is new gets
/// one that is free.
static void assignSystems(const DirectView& d) {
    constexpr std::size_t kMore = 4;  // systems are made at a time
    d.directSet.systemOfBody.resize(d.bodies.size(), kNone);
    const auto firstOf = [&](const DirectIsland& island) { return d.directSet.bodies[island.firstBody]; };
    for (DirectIsland& island : d.directSet.islands)
        if (hasSystem(island)) island.system = d.directSet.systemOfBody[firstOf(island)];
    for (std::uint32_t& owner : d.directSet.systemOwner) {
        if (owner != kNone) d.directSet.systemOfBody[owner] = kNone;
        owner = kNone;
    }
    const auto give = [&](DirectIsland& island, std::size_t system) {
        island.system = static_cast<std::uint32_t>(system);
        d.directSet.systemOwner[system] = firstOf(island);
        d.directSet.systemOfBody[firstOf(island)] = island.system;
    };
    for (DirectIsland& island : d.directSet.islands)
        if (island.system != kNone) give(island, island.system);
    std::size_t next = 0;
    for (DirectIsland& island : d.directSet.islands) {
        if (!hasSystem(island) || island.system != kNone) continue;
        while (next < d.directSet.systemOwner.size() && d.directSet.systemOwner[next] != kNone) ++next;
        if (next == d.directSet.systemOwner.size())
            for (std::size_t i = 0; i < kMore; ++i) {
                d.directSet.systems.push_back(std::make_unique<direct::IslandSystem>(d.memory));
                d.directSet.systemOwner.push(kNone);
            }
        give(island, next);
    }
}

/// Calls visit(bodyA, bodyB) for all constraints of the direct list.
template <class Visit>
static void forEachDirectPair(const DirectView& d, Visit&& visit) {
    const ConstraintGraph::Color& list = d.graph.color(ConstraintGraph::kDirect);
    for (const std::uint32_t m : list.manifolds)
        visit(d.contacts[d.manifolds[m].contact].bodyA, d.contacts[d.manifolds[m].contact].bodyB);
    for (const std::uint32_t j : list.joints) visit(d.joints[j].bodyA, d.joints[j].bodyB);
}

/// The number of the island that a constraint of two bodies is in: that of the root of one that moves.
static std::uint32_t& islandNumber(const DirectView& d, std::uint32_t a, std::uint32_t b) {
    return d.directSet.index[d.islands.root(d.bodies.moves(a) ? a : b)];
}

static void numberDirectIslands(const DirectView& d) {
    DirectSet& set = d.directSet;
    d.islands.parent.resizeForOverwrite(d.bodies.size());
    set.index.resizeForOverwrite(d.bodies.size());
    forEachDirectPair(d, [&](std::uint32_t a, std::uint32_t b) {
        for (const std::uint32_t body : {a, b}) d.islands.parent[body] = body, set.index[body] = kNone;
    });
    forEachDirectPair(d, [&](std::uint32_t a, std::uint32_t b) { d.islands.unite(d.bodies, a, b); });
    forEachDirectPair(d, [&](std::uint32_t a, std::uint32_t b) {
        std::uint32_t& number = islandNumber(d, a, b);
        if (number != kNone) return;
        number = static_cast<std::uint32_t>(set.islands.size());
        set.islands.push({});
    });
}

/// Counts first, then places.
static void listDirectConstraints(const DirectView& d) {
    DirectSet& set = d.directSet;
    const ConstraintGraph::Color& list = d.graph.color(ConstraintGraph::kDirect);
    const auto islandOfContact = [&](std::uint32_t m) -> DirectIsland& {
        const ContactRecord& contact = d.contacts[d.manifolds[m].contact];
        return set.islands[islandNumber(d, contact.bodyA, contact.bodyB)];
    };
    const auto islandOfJoint = [&](std::uint32_t j) -> DirectIsland& {
        return set.islands[islandNumber(d, d.joints[j].bodyA, d.joints[j].bodyB)];
    };
    for (const std::uint32_t m : list.manifolds) ++islandOfContact(m).contactCount;
    for (const std::uint32_t j : list.joints) ++islandOfJoint(j).jointCount;
    std::uint32_t contactsBefore = 0, jointsBefore = 0;
    for (DirectIsland& island : set.islands) {
        island.firstContact = contactsBefore, island.firstJoint = jointsBefore;
        contactsBefore += island.contactCount, jointsBefore += island.jointCount;
        island.contactCount = island.jointCount = 0;
    }
    set.owner.resizeForOverwrite(list.manifolds.size());
    set.manifolds.resizeForOverwrite(contactsBefore);
    set.joints.resizeForOverwrite(jointsBefore);
    for (const std::uint32_t m : list.manifolds) {
        DirectIsland& island = islandOfContact(m);
        set.manifolds[island.firstContact + island.contactCount++] = m;
        set.owner[d.manifolds[m].place.slot] = static_cast<std::uint32_t>(&island - set.islands.data());
    }
    for (const std::uint32_t j : list.joints) {
        DirectIsland& island = islandOfJoint(j);
        set.joints[island.firstJoint + island.jointCount++] = j;
    }
}

void groupDirect(const DirectView& d) {
    DirectSet& set = d.directSet;
    set.islands.clear();
    set.multirate.regrouped = true;
    set.seen.clear();
    for (AlignedArray<std::uint32_t>* list : {&set.owner, &set.bodies, &set.manifolds, &set.joints}) list->clear();
    set.trees.clear();
    const ConstraintGraph::Color& list = d.graph.color(ConstraintGraph::kDirect);
    if (list.manifolds.empty() && list.joints.empty()) return;
    numberDirectIslands(d);
    listDirectConstraints(d);
    numberDirectBodies(d);
    planChains(d);
    planMechanisms(d);
    assignSystems(d);
}

/// Calls visit(bundle) in parallel for those of direct islands.
template <class Visit>
static void forEachDirectBundle(const DirectView& d, Visit&& visit) {
    d.runner.parallelFor(d.graph.bundleCount(ConstraintGraph::kDirect), 64, [&](int begin, int end, int) {
        for (int b = begin; b < end; ++b) visit(static_cast<std::size_t>(b));
    });
}

/// Tells the islands of which some lane is not that of the last step, to the bit.
static void recordDirectBundles(const DirectView& d) {
    const AlignedArray<float>& now = d.graph.color(ConstraintGraph::kDirect).bundles;
    const auto lanes = static_cast<std::size_t>(d.graph.lanes());
    const std::size_t floats = contact::kFields * lanes, known = std::min(d.directSet.seen.size(), now.size()) / floats;
    d.directSet.seen.resizeForOverwrite(now.size());
    for (DirectIsland& island : d.directSet.islands) island.renewed = false;
    forEachDirectBundle(d, [&](std::size_t b) {
        const float* bundle = now.data() + b * floats;
        float* seen = d.directSet.seen.data() + b * floats;
        if (b < known && std::memcmp(seen, bundle, floats * sizeof(float)) == 0) return;
        for (std::size_t lane = 0; lane < lanes && b * lanes + lane < d.directSet.owner.size(); ++lane) {
            bool renewed = b >= known;
            for (std::size_t i = lane; !renewed && i < floats; i += lanes)
                renewed = std::memcmp(seen + i, bundle + i, sizeof(float)) != 0;
            if (renewed)
                std::atomic_ref(d.directSet.islands[d.directSet.owner[b * lanes + lane]].renewed)
                    .store(true, std::memory_order_relaxed);
        }
        std::memcpy(static_cast<void*>(seen), bundle, floats * sizeof(float));
    });
}

/// Is any of its contacts, or how many they are, other than when its system was made?
static bool isRenewed(const DirectView& d, const DirectIsland& island) {
    return island.renewed ||
           !d.directSet.systems[island.system]->isOf(island.bodyCount, island.contactCount, island.jointCount);
}

/// What contacts of islands that rest again have borne. Their loads are the impulses in their lanes.
static void addDirectPeaks(const DirectView& d) {
    const auto lanes = static_cast<std::size_t>(d.graph.lanes());
    AlignedArray<float>& bundles = d.graph.color(ConstraintGraph::kDirect).bundles;
    forEachDirectBundle(d, [&](std::size_t b) {
        float* bundle = bundles.data() + b * contact::kFields * lanes;
        for (std::size_t lane = 0; lane < lanes && b * lanes + lane < d.directSet.owner.size(); ++lane) {
            const int substeps = d.directSet.islands[d.directSet.owner[b * lanes + lane]].restedAgain;
            for (int j = 0; j < contact::kMaxPoints && substeps > 0; ++j) {
                float* point =
                    bundle + static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields) * lanes + lane;
                point[contact::kPeak * lanes] +=
                    static_cast<float>(substeps * static_cast<double>(point[contact::kImpulse * lanes]));
            }
        }
    });
}

static void beginIsland(const DirectView& d, DirectIsland& island, int index) {
    if (island.tree) return;
    island.begin();
    for (std::uint32_t i = 0; i < island.jointCount; ++i)
        d.directSet.sims[island.firstJoint + i] = &d.joints.sims[d.directSet.joints[island.firstJoint + i]];
    if (island.mechanism) return beginMechanism(d, island, *d.directSet.mechanisms[static_cast<std::size_t>(index)]);
    direct::IslandSystem& system = *d.directSet.systems[island.system];
    island.unchanged = island.jointCount == 0 && system.restedThrough(d.substeps) && !isRenewed(d, island);
    if (island.unchanged) return system.beginAgain();  // its lanes are where they were
    for (std::uint32_t i = 0; i < island.contactCount; ++i)
        d.directSet.lanes[island.firstContact + i] =
            d.graph.lane(d.manifolds[d.directSet.manifolds[island.firstContact + i]].place);
    if (island.stepFactor > 1) rescaleLoads(d, island, static_cast<float>(island.stepFactor));
    direct::IslandParts parts;
    parts.bodies = d.directSet.bodies.data() + island.firstBody;
    parts.bodyCount = island.bodyCount;
    parts.lanes = d.directSet.lanes.data() + island.firstContact;
    parts.contactCount = island.contactCount;
    parts.joints = d.directSet.sims.data() + island.firstJoint;
    parts.jointCount = island.jointCount;
    parts.laneStride = d.graph.lanes();
    parts.localOf = d.directSet.index.data();
    system.begin(parts, d.bodies.arrays(), ofSubsteps(d.context, island.stepFactor));
}

/// In parallel, but trees, which are many and have their lanes; none is looked at where all are trees.
template <class Visit>
static void forEachDirectIsland(const DirectView& d, Visit&& visit) {
    AlignedArray<DirectIsland>& islands = d.directSet.islands;
    if (d.directSet.trees.treeCount() == islands.size()) return;
    d.runner.parallelFor(static_cast<int>(islands.size()), 1, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i)
            if (DirectIsland& island = islands[static_cast<std::size_t>(i)]; !island.tree) visit(island, i);
    });
}

void beginDirect(const DirectView& d) {
    if (d.directSet.islands.empty()) return;
    recordDirectBundles(d);
    d.directSet.lanes.resizeForOverwrite(d.directSet.manifolds.size());
    d.directSet.sims.resizeForOverwrite(d.directSet.joints.size());
    d.directSet.index.resizeForOverwrite(d.bodies.size());
    forEachDirectIsland(d, [&](DirectIsland& island, int i) { beginIsland(d, island, i); });
    beginChains(d);
}

/// Joints alone make a nearly linear system, of which only rounding can be left, and iteration would tear it; but a
/// tree that could not be eliminated has no answer at all.
static bool isUnsolved(const DirectIsland& island) {
    return !island.report.converged && (island.contactCount > 0 || island.tree || island.mechanism);
}

/// By Newton's method.
static void solveSystem(const DirectView& d, DirectIsland& island, DirectPass pass) {
    const BodyArrays arrays = d.bodies.arrays();
    direct::IslandSystem& system = *d.directSet.systems[island.system];
    if (pass == DirectPass::velocities && system.rests()) return system.updateLoads(island.factored);
    const SolverContext context = ofSubsteps(d.context, island.stepFactor);
    const JointContext jointContext = ofSubsteps(d.jointContext, island.stepFactor);
    const auto start = std::chrono::steady_clock::now();
    switch (pass) {
        case DirectPass::positions:
            system.beginSubstep(arrays, jointContext);
            if (system.rests()) return system.writeVelocities(arrays);
            system.aimAtPositions(arrays, context);
            if (island.jointCount > 0) island.factored = false;
            direct::solve(system.equations(), true, island.factored, island.report);
            if (isUnsolved(island)) {
                fallBack(d, island, pass);
                break;
            }
            system.writeVelocities(arrays);
            if (system.aimAgain(arrays, jointContext)) {
                island.factored = false;
                direct::solve(system.equations(), false, island.factored, island.report);
                if (!isUnsolved(island)) system.writeVelocities(arrays);
            }
            break;
        case DirectPass::velocities:
            if (system.aimAtVelocities(arrays, context, jointContext)) {
                direct::solve(system.equations(), false, island.factored, island.report);
                if (isUnsolved(island)) {
                    fallBack(d, island, pass);
                    break;
                }
                system.writeVelocities(arrays);
            }
            system.updateLoads(island.factored);
            break;
    }
    island.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void solveDirect(const DirectView& d, DirectPass pass) {
    if (d.directSet.islands.empty()) return;
    forEachDirectIsland(d, [&](DirectIsland& island, int i) {
        if (d.context.substep % island.stepFactor != 0) return;
        if (island.fellBack)
            iterateIsland(d, island, pass);
        else if (island.mechanism)
            solveMechanism(d, island, *d.directSet.mechanisms[static_cast<std::size_t>(i)], pass);
        else
            solveSystem(d, island, pass);
    });
    solveChains(d, pass);
}

/// The largest load of a point over the weight of the lighter body that it moves, in a substep; 0 without weight.
static double loadNumber(const direct::Equations& island) {
    if (!(island.gravityStep > 0)) return 0;
    double largest = 0;
    for (const direct::SystemContact& c : island.contacts) {
        const auto massOf = [&](std::int32_t body) {
            return body == direct::kFixed ? 1e300 : island.bodies[static_cast<std::size_t>(body)].mass[0];
        };
        const double lighter = massOf(c.a) < massOf(c.b) ? massOf(c.a) : massOf(c.b);
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const double load = island.points[c.first + j].load[0];
            if (load > largest * lighter * island.gravityStep) largest = load / (lighter * island.gravityStep);
        }
    }
    return largest;
}

/// Block products of the factors that an island took in a step.
static double workOf(const DirectView& d, const DirectIsland& island) {
    if (!hasSystem(island)) return 0;
    const direct::Equations& equations = d.directSet.systems[island.system]->equations();
    return island.report.factorizations * static_cast<double>(equations.factorProducts());
}

/// What could not be solved falls back to iteration for a while, each time for twice as long until it comes to rest: a
/// heap that never can be is tried ever more seldom.
static void startCooldown(const DirectView& d, const DirectIsland& island, bool rests) {
    const bool failed = isUnsolved(island);
    const bool piles = !failed && hasSystem(island) && island.jointCount == 0;
    const double load = piles ? loadNumber(d.directSet.systems[island.system]->equations()) : 0;
    const bool stays = d.bodies[d.directSet.bodies[island.firstBody]].direct.reason == direct::Reason::staying;
    const bool dear = piles && stays && load < direct::kBearable && workOf(d, island) > direct::kDear;
    const bool costly = dear || (island.bodyCount > direct::kMostBodies && island.report.factorizations > 0);
    // Loads that iteration could not take over, whatever the choice takes them for.
    const bool crushed = !costly && load > direct::kCrushing;
    if (!failed && !costly && !rests && !crushed) return;
    d.directSet.failures += failed;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        BodyRecord& body = d.bodies[d.directSet.bodies[island.firstBody + i]];
        if (rests) body.direct.failures = 0;
        if (crushed) body.direct.steps = direct::kStayingSteps;
        if (costly) body.direct.steps -= direct::kFactorSteps;
        if (!failed && body.direct.steps > 0) continue;
        if (island.mechanism) {  // Newton's method is next
            body.direct.failures = 1;
            d.islands.graphChanged = d.islands.directChanged = true;
            continue;
        }
        body.direct.steps = -(direct::kCooldownSteps << body.direct.failures);
        if (body.direct.failures < direct::kMostDoublings) ++body.direct.failures;
        d.islands.graphChanged = d.islands.directChanged = true;
    }
}

void endDirect(const DirectView& d) {
    for (std::size_t i = 0; i < d.directSet.islands.size(); ++i)
        if (const DirectIsland& island = d.directSet.islands[i]; !island.unchanged)
            startCooldown(d, island,
                          hasSystem(island) && !island.fellBack && d.directSet.systems[island.system]->rests());
    for (std::size_t i = 0; i < d.directSet.islands.size(); ++i)
        if (const DirectIsland& island = d.directSet.islands[i]; island.mechanism)
            keepPace(d, island, *d.directSet.mechanisms[i]);
    for (const DirectIsland& island : d.directSet.islands)
        if (island.multirate && !island.independent) recordGaps(d, island);
    d.directSet.ledger.clear();
    if (d.directSet.islands.size() > d.directSet.ledger.capacity())
        d.directSet.ledger.reserve(2 * d.directSet.islands.size() + 8);
    for (const DirectIsland& island : d.directSet.islands)
        d.directSet.ledger.push_back({direct::nameOf(d.bodies[d.directSet.bodies[island.firstBody]].direct.reason),
                                      static_cast<int>(island.bodyCount), static_cast<int>(island.contactCount),
                                      static_cast<int>(island.jointCount), island.report.iterations,
                                      island.report.factorizations, island.report.residual, island.ms,
                                      island.report.converged});
    std::atomic<bool> anyRestsAgain{false};
    forEachDirectIsland(d, [&](DirectIsland& island, int) {
        if (!hasSystem(island)) return;
        direct::IslandSystem& system = *d.directSet.systems[island.system];
        const bool restsAgain = !island.fellBack && system.restsAgain(island.unchanged);
        if (!island.fellBack && !restsAgain) system.end();
        if (island.stepFactor > 1) rescaleLoads(d, island, 1 / static_cast<float>(island.stepFactor));
        if (!restsAgain) return;
        island.restedAgain = system.restedSubsteps();
        anyRestsAgain.store(true, std::memory_order_relaxed);
    });
    if (anyRestsAgain.load(std::memory_order_relaxed)) addDirectPeaks(d);
}

}  // namespace ragtop
