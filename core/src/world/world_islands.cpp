// Which islands are solved directly: what bears on what, and the choice.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "constraints/stiffness.h"
#include "world/world_regions.h"

namespace ragtop {

namespace {

constexpr float kSupportGap = 0.01f;  ///< gap over which bodies still bear on each other, in sizes
constexpr float kLevel = 0.94f;       ///< cosine of the steepest support that counts as level, 20°
constexpr float kPressed = 4;         ///< force on a body that counts as a load, in weights
constexpr float kSlow = 0.05f;        ///< speed of a body at rest, in √(gravity · size)

}  // namespace

/// Forces beyond a few weights change what bears on what, as new support edges do.
void WorldImpl::recordForce(std::uint32_t index) {
    const BodyRecord& body = bodies[index];
    if (length(body.force) > kPressed * body.mass * length(settings.gravity)) graphChanged = structureChanged = true;
}

/// Takes memory for what measuring islands finds, and numbers these.
void WorldImpl::beginMeasuring() {
    // Room for all contacts, whether they are near or not: what comes near later asks for no memory.
    std::size_t room = 0, islands = 0;
    for (int c = 0; c < graph.listCount(); ++c)
        room += graph.color(c).manifolds.capacity() + graph.color(c).joints.capacity();
    for (const std::uint32_t body : awakeBodies) islands += islandParent[body] == body ? 1 : 0;
    using M = StageMemory;
    const std::size_t all = bodies.size();
    stageMemory.begin(M::bytesOf<SupportEdge>(room) + M::bytesOf<std::uint32_t>(2 * room) +
                      M::bytesOf<std::uint32_t>(all + 1) + 3 * M::bytesOf<std::uint32_t>(all) + M::bytesOf<float>(all) +
                      M::bytesOf<std::uint8_t>(all) + M::bytesOf<direct::IslandFeatures>(islands));
    supportEdges = stageMemory.take<SupportEdge>(room);
    neighbours = stageMemory.take<std::uint32_t>(2 * room);
    neighbourBegin = stageMemory.take<std::uint32_t>(all + 1);
    islandNumber = stageMemory.take<std::uint32_t>(all);
    paths.levels = stageMemory.take<std::uint32_t>(all);
    paths.supports = stageMemory.take<std::uint32_t>(all);
    paths.load = stageMemory.take<float>(all);
    paths.heldLevel = stageMemory.take<std::uint8_t>(all);
    islandFeatures = stageMemory.take<direct::IslandFeatures>(islands);
    for (const std::uint32_t body : awakeBodies) {
        if (islandParent[body] != body) continue;
        islandNumber[body] = static_cast<std::uint32_t>(islandFeatures.size());
        islandFeatures.push({});
    }
}

/// Everything that bears or holds: contacts within reach, and joints.
void WorldImpl::collectSupportEdges() {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t constraint, bool joint) {
        supportEdges.push({a, b, constraint, joint, moves(a), moves(b)});
    };
    // Not by the lists of the graph: sums follow this order, and who is where in them depends on the number of workers.
    forEachInGraph(
        *this,
        [&](std::uint32_t m) {
            const ManifoldRecord& manifold = manifolds[m];
            const ContactRecord& contact = contacts[manifold.contact];
            const float reach = kSupportGap * contact.size;
            bool near = false;
            for (int j = 0; j < manifold.pointCount; ++j) near |= manifold.separation[j] <= reach;
            if (near) add(contact.bodyA, contact.bodyB, m, false);
        },
        [&](std::uint32_t j) { add(joints[j].bodyA, joints[j].bodyB, j, true); });
}

/// Distances from what does not move, by breadth first over the support edges; `bodyStack` keeps the order of the
/// visit.
void WorldImpl::findLevels() {
    paths.levels.resizeForOverwrite(bodies.size());
    neighbourBegin.resizeForOverwrite(bodies.size() + 1);
    std::memset(neighbourBegin.data(), 0, neighbourBegin.size() * sizeof(std::uint32_t));
    for (const std::uint32_t body : awakeBodies) paths.levels[body] = kNone;
    for (const SupportEdge& edge : supportEdges) {
        if (!edge.movesA || !edge.movesB) continue;
        ++neighbourBegin[edge.a + 1];
        ++neighbourBegin[edge.b + 1];
    }
    for (std::size_t i = 1; i < neighbourBegin.size(); ++i) neighbourBegin[i] += neighbourBegin[i - 1];
    neighbours.resizeForOverwrite(neighbourBegin[bodies.size()]);
    bodyStack.clear();
    for (const SupportEdge& edge : supportEdges) {
        const bool movesA = edge.movesA, movesB = edge.movesB;
        if (movesA && movesB) {
            neighbours[neighbourBegin[edge.a]++] = edge.b;
            neighbours[neighbourBegin[edge.b]++] = edge.a;
        } else if (const std::uint32_t body = movesA ? edge.a : edge.b; paths.levels[body] == kNone) {
            paths.levels[body] = 1;
            bodyStack.push(body);
        }
    }
    // Each begin has moved to its end, which is where the next one began.
    for (std::size_t i = 0; i < bodyStack.size(); ++i) {
        const std::uint32_t body = bodyStack[i];
        const std::uint32_t begin = body == 0 ? 0 : neighbourBegin[body - 1];
        for (std::uint32_t k = begin; k < neighbourBegin[body]; ++k)
            if (std::uint32_t& level = paths.levels[neighbours[k]]; level == kNone) {
                level = paths.levels[body] + 1;
                bodyStack.push(neighbours[k]);
            }
    }
}

/// The mass that each body hands to each neighbour below it: its own, that of what pushes it if that counts, and what
/// it carries, in equal shares.
void WorldImpl::estimateLoads(bool pushes) {
    paths.load.resizeForOverwrite(bodies.size());
    paths.supports.resizeForOverwrite(bodies.size());
    const float gravity = length(settings.gravity), perForce = gravity > 0 ? 1 / gravity : 0.0f;
    for (const std::uint32_t body : awakeBodies)
        paths.load[body] = pushes ? perForce * length(bodies[body].force) : 0.0f, paths.supports[body] = 0;
    for (const SupportEdge& edge : supportEdges) {
        const bool movesA = edge.movesA, movesB = edge.movesB;
        if (movesA && (!movesB || paths.levels[edge.b] < paths.levels[edge.a])) ++paths.supports[edge.a];
        if (movesB && (!movesA || paths.levels[edge.a] < paths.levels[edge.b])) ++paths.supports[edge.b];
    }
    for (std::size_t i = bodyStack.size(); i-- > 0;) {
        const std::uint32_t body = bodyStack[i];
        const float share = (paths.load[body] + bodies[body].mass) / static_cast<float>(paths.supports[body]);
        const std::uint32_t begin = body == 0 ? 0 : neighbourBegin[body - 1];
        for (std::uint32_t k = begin; k < neighbourBegin[body]; ++k)
            if (paths.levels[neighbours[k]] < paths.levels[body]) paths.load[neighbours[k]] += share;
    }
}

/// Load over the load under which soft contacts of this pair tilt away: a column of n boxes of height l stands while
/// n³ m g l < 7.84 k_θ, with k_θ the stiffness of its points about their middle.
float WorldImpl::bucklingShare(const SupportEdge& edge, float load, float number) const {
    const ManifoldRecord& manifold = manifolds[edge.constraint];
    if (manifold.pointCount < 3) return 0;
    Vec3 middle;
    const float count = static_cast<float>(manifold.pointCount);
    for (int j = 0; j < manifold.pointCount; ++j) middle += (1 / count) * manifold.anchorA[j];
    const Vec3 t1 = perpendicular(manifold.normal), t2 = cross(manifold.normal, t1);
    float s11 = 0, s12 = 0, s22 = 0;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const Vec3 arm = manifold.anchorA[j] - middle;
        const float x = dot(arm, t1), y = dot(arm, t2);
        s11 += x * x, s12 += x * y, s22 += y * y;
    }
    const float difference = s11 - s22;
    const float spread = 0.5f * (s11 + s22 - std::sqrt(difference * difference + 4 * s12 * s12));
    const float inverseMass = states[bodies[edge.a].state].invMass + states[bodies[edge.b].state].invMass;
    const float omega = 2 * kPi * settings.contactFrequency * static_cast<float>(settings.substeps) / dt;
    const bool fixed = !moves(edge.a) || !moves(edge.b);
    const float stiffness = (fixed ? 4 : 1) * omega * omega * spread / inverseMass;
    const BodyRecord& upper = bodies[moves(edge.b) ? edge.b : edge.a];
    const Vec3 arm = rotate(upper.rotation, moves(edge.b) ? manifold.anchorB[0] : manifold.anchorA[0]);
    const float gravity = length(settings.gravity);
    if (!(gravity > 0)) return 0;
    const float height = 2 * std::fabs(dot(arm, settings.gravity)) / gravity;
    const float bending = load * gravity * number * number * height;
    return stiffness > 0 ? bending / (7.84f * stiffness) : 0.0f;
}

/// A face, or something round: what stands on an edge or a corner needs others to hold it.
bool WorldImpl::standsOn(std::uint32_t index) const {
    const ManifoldRecord& manifold = manifolds[index];
    const ContactRecord& contact = contacts[manifold.contact];
    const float roundness = geometries[shapes[contact.shapeA].geometry].convex.radius +
                            geometries[shapes[contact.shapeB].geometry].convex.radius;
    return manifold.pointCount > 2 || roundness > 0;
}

/// Some contact of the body is in the graph.
bool WorldImpl::isInContact(std::uint32_t body) const {
    for (std::uint32_t key = bodies[body].firstContact; key != kNone; key = nextContact(key)) {
        for (const ManifoldRecord& manifold : manifoldsOf(contacts[key >> 1]))
            if (manifold.place.color != kNone) return true;
    }
    return false;
}

/// Asks for what measuring islands reads of support edges some places ahead: they lie in no order.
static void prefetchSupportEdge(const WorldImpl& world, std::size_t place) {
    constexpr std::size_t kRecords = 16, kLane = 8;
    const StageArray<SupportEdge>& supportEdges = world.supportEdges;
    if (place + kRecords < supportEdges.size() && !supportEdges[place + kRecords].joint) {
        const SupportEdge& edge = supportEdges[place + kRecords];
        const ManifoldRecord& manifold = world.manifolds[edge.constraint];
        prefetch(&manifold.normal);
        prefetch(&manifold.place);
        prefetch(&world.bodies[edge.a].rotation);
        prefetch(&world.bodies[edge.a].mass);
        prefetch(&world.bodies[edge.b].mass);
    }
    if (place + kLane < supportEdges.size() && !supportEdges[place + kLane].joint) {
        const float* lane = world.graph.lane(world.manifolds[supportEdges[place + kLane].constraint].place);
        prefetch(lane + contact::kCross * world.graph.lanes());
        prefetch(lane + contact::kRolling * world.graph.lanes());
    }
}

void WorldImpl::measureIslands() {
    beginMeasuring();
    collectSupportEdges();
    findLevels();
    estimateLoads(true);
    paths.heldLevel.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : awakeBodies) paths.heldLevel[body] = 0;

    const float gravity = length(settings.gravity);
    const Vec3 up = gravity > 0 ? (-1 / gravity) * settings.gravity : Vec3{};
    for (std::size_t i = 0; i < supportEdges.size(); ++i) {
        prefetchSupportEdge(*this, i);
        const SupportEdge& edge = supportEdges[i];
        const bool movesA = edge.movesA, movesB = edge.movesB;
        direct::IslandFeatures& island = islandOf(movesA ? edge.a : edge.b);
        island.pairs += movesA && movesB;
        const bool aBears = movesB && (!movesA || paths.levels[edge.a] < paths.levels[edge.b]);
        const bool bBears = movesA && (!movesB || paths.levels[edge.b] < paths.levels[edge.a]);
        if (!edge.joint) {
            const GraphPlace place = manifolds[edge.constraint].place;
            const float* lane = graph.lane(place);
            for (const int field : {contact::kRolling, contact::kSpinning, contact::kCross})
                island.rolls |= lane[field * graph.lanes()] != 0;
            const Vec3 normal = rotate(bodies[edge.a].rotation, manifolds[edge.constraint].normal);
            const float cosine = dot(normal, up);
            const bool upright = cosine > kLevel || cosine < -kLevel;
            if (upright && standsOn(edge.constraint)) paths.heldLevel[cosine > 0 ? edge.b : edge.a] = 1;
        } else {
            ++island.joints;
            island.bare &= isTreeJoint(jointSims[edge.constraint]);
            const JointSim& joint = jointSims[edge.constraint];
            island.stiffness =
                std::max(island.stiffness, stiffnessOf(joint, states.data(), inertias.data(), context.h));
            paths.heldLevel[edge.a] = paths.heldLevel[edge.b] = 1;
            island.hangs |= !movesA || !movesB;
        }
        if (!aBears && !bBears) continue;
        const std::uint32_t upper = aBears ? edge.b : edge.a;
        const float load = (paths.load[upper] + bodies[upper].mass) / static_cast<float>(paths.supports[upper]);
        const float massA = movesA ? bodies[edge.a].mass : bodies[edge.b].mass;
        const float massB = movesB ? bodies[edge.b].mass : massA;
        const float lighter = std::min(massA, massB), number = load / lighter;
        float& largest = edge.joint ? island.jointLoad : island.contactLoad;
        largest = std::max(largest, number);
        island.massRatio = std::max(island.massRatio, std::max(massA, massB) / lighter);
        if (!edge.joint) island.buckling = std::max(island.buckling, bucklingShare(edge, load, number));
    }
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        direct::IslandFeatures& island = islandOf(body);
        island.mass += bodies[body].mass;
        island.momentum += bodies[body].mass * states[body].v;
    }
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        direct::IslandFeatures& island = islandOf(body);
        ++island.bodies;
        island.bare &= turnsFreely(body);
        island.spin = std::max(island.spin, context.h * length(states[body].w));
        const Vec3 common = (1 / island.mass) * island.momentum;
        const float speed = length(states[body].v - common) + length(states[body].w) * bodies[body].radius;
        const bool slow = speed <= kSlow * std::sqrt(gravity * bodies[body].size);
        island.moving += !slow;
        const bool rests = isDirect(body) || isUntouched(body) || bodies[body].sleepTimer >= direct::kLongRest;
        island.restless += !slow || !rests;
        island.leaning += paths.levels[body] != kNone && paths.heldLevel[body] == 0 && slow;
    }
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        direct::IslandFeatures& island = islandOf(body);
        if (island.joints > 0 && !island.touches) island.touches = isInContact(body);
    }
    forEachCoupledPair([&](std::uint32_t, std::uint32_t body) { islandOf(body).coupled = true; });
}

/// Of joints alone.
static bool isMechanism(direct::Reason reason) {
    return reason == direct::Reason::tree || reason == direct::Reason::loop;
}
/// Reasons that no choice outlives.
static bool onlyWhile(direct::Reason reason) { return reason == direct::Reason::deep || isMechanism(reason); }

/// Writes the choice for each island into its bodies, so many steps after the last one. True while some island's choice
/// will change by itself.
bool WorldImpl::decideIslands(std::int32_t elapsed) {
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        direct::IslandFeatures& island = islandOf(body);
        const std::int32_t steps = bodies[body].directSteps;
        island.direct |= steps > 0;
        if (steps > 0) island.last = bodies[body].directReason;
        island.staying = std::max(island.staying, steps);
        island.cooldown = std::min(island.cooldown, steps);
    }
    bool waiting = false;
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body) || findRoot(body) != body) continue;
        direct::IslandFeatures& island = islandOf(body);
        island.reason = chooseDirect(island);
        if (settings.solver == SolverChoice::iterative || island.coupled)
            island.reason = direct::Reason::none, island.staying = 0;
        const bool large = island.bodies > direct::kMostBodies;
        const bool fits = !large && !island.rolls && !island.coupled;
        if (settings.solver == SolverChoice::direct && fits) island.reason = direct::Reason::asked;
        if (island.cooldown < 0) {
            island.reason = direct::Reason::none;
            island.staying = std::min(island.cooldown + elapsed, 0);
            waiting = true;  // to be chosen anew
        } else if (island.reason != direct::Reason::none) {
            if (!large || !island.direct) island.staying = direct::kStayingSteps;
            waiting |= isMechanism(island.reason);  // it may begin to spin
            continue;
        } else if (large || onlyWhile(island.last)) {
            // Worth it at rest alone, or as long as nothing is touched.
            island.staying = 0;
        } else if (island.staying > 0) {
            island.staying = std::max(island.staying - elapsed, 0);
            if (island.staying > 0) island.reason = direct::Reason::staying;
        }
        waiting |= island.staying != 0;
    }
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        const direct::IslandFeatures& island = islandOf(body);
        bodies[body].directSteps = island.staying;
        bodies[body].directReason = island.reason;
    }
    return waiting;
}

/// Choices change when support edges do, so they are made anew only then: at once where a direct island has part in it
/// or something was just made or put somewhere, else every few steps.
void WorldImpl::chooseSolvers() {
    constexpr std::uint64_t kPeriod = 16;
    const ConstraintGraph::Color& list = graph.color(ConstraintGraph::kDirect);
    const bool atOnce = structureChanged || directChanged;
    if (graphChanged && (atOnce || stepCount % kPeriod == 0)) {
        uniteConstraints(false);
        measureIslands();
        graphChanged = decideIslands(static_cast<std::int32_t>(std::min(stepCount - choiceStep, kPeriod)));
        choiceStep = stepCount;
        applyChoices();
        if (structureChanged) loadNewContacts();
        structureChanged = directChanged = false;
        directGrouped = false;
    }
    const bool anyDirect = !list.manifolds.empty() || !list.joints.empty();
    // Sleeping may have emptied the list since.
    if (!directGrouped || treesChanged) articulations.known = false;
    if (!directGrouped || !anyDirect || treesChanged) groupDirect();
    directGrouped = true;
    treesChanged = false;
}

}  // namespace ragtop
