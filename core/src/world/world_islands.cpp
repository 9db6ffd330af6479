// Which islands are solved directly: what bears on what, and the choice.

#include <algorithm>
#include <cmath>

#include "base/economy.h"
#include "base/prefetch.h"
#include "constraints/contact_layout.h"
#include "constraints/stiffness.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

constexpr float kPressed = 4;   ///< force on a body that counts as a load, in weights
constexpr float kSlow = 0.05f;  ///< speed of a body at rest, in √(gravity · size)

}  // namespace

/// Forces beyond a few weights change what bears on what, as new support edges do.
void WorldImpl::recordForce(std::uint32_t index) {
    const BodyRecord& body = bodies[index];
    if (length(body.force) > kPressed * body.mass * length(settings.gravity)) islands.structureChangedAt();
}

/// Takes memory for what measuring islands finds, and numbers these.
void WorldImpl::beginMeasuring() {
    std::size_t count = 0;
    for (const std::uint32_t body : bodies.awake) count += islands.parent[body] == body ? 1 : 0;
    using M = StageMemory;
    const std::size_t own = M::bytesOf<std::uint32_t>(bodies.size()) + M::bytesOf<direct::IslandFeatures>(count);
    islands.paths.begin(tables(), stageMemory, own);
    islands.number = stageMemory.take<std::uint32_t>(bodies.size());
    islands.features = stageMemory.take<direct::IslandFeatures>(count);
    for (const std::uint32_t body : bodies.awake) {
        if (islands.parent[body] != body) continue;
        islands.number[body] = static_cast<std::uint32_t>(islands.features.size());
        islands.features.push({});
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
    const float inverseMass = bodies.states[bodies[edge.a].state].invMass + bodies.states[bodies[edge.b].state].invMass;
    const float omega = 2 * kPi * settings.contactFrequency * static_cast<float>(settings.substeps) / dt;
    const bool fixed = !bodies.moves(edge.a) || !bodies.moves(edge.b);
    const float stiffness = (fixed ? 4 : 1) * omega * omega * spread / inverseMass;
    const BodyRecord& upper = bodies[bodies.moves(edge.b) ? edge.b : edge.a];
    const Vec3 arm = rotate(upper.rotation, bodies.moves(edge.b) ? manifold.anchorB[0] : manifold.anchorA[0]);
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
    const float roundness = shapes.geometries[shapes[contact.shapeA].geometry].convex.radius +
                            shapes.geometries[shapes[contact.shapeB].geometry].convex.radius;
    return manifold.pointCount > 2 || roundness > 0;
}

/// Some contact of the body is in the graph.
bool WorldImpl::isInContact(std::uint32_t body) const {
    for (std::uint32_t key = bodies[body].firstContact; key != kNone; key = contacts.next(key)) {
        for (const ManifoldRecord& manifold : manifolds.of(contacts[key >> 1]))
            if (manifold.place.color != kNone) return true;
    }
    return false;
}

/// Asks for what measuring islands reads of support edges some places ahead: they lie in no order.
static void prefetchSupportEdge(const WorldImpl& world, std::size_t place) {
    constexpr std::size_t kRecords = 16, kLane = 8;  // edges ahead, by trial
    const StageArray<SupportEdge>& edges = world.islands.paths.edges;
    if (place + kRecords < edges.size() && !edges[place + kRecords].joint) {
        const SupportEdge& edge = edges[place + kRecords];
        const ManifoldRecord& manifold = world.manifolds[edge.constraint];
        prefetch(&manifold.normal);
        prefetch(&manifold.place);
        prefetch(&world.bodies[edge.a].rotation);
        prefetch(&world.bodies[edge.a].mass);
        prefetch(&world.bodies[edge.b].mass);
    }
    if (place + kLane < edges.size() && !edges[place + kLane].joint) {
        const float* lane = world.graph.lane(world.manifolds[edges[place + kLane].constraint].place);
        prefetch(lane + contact::kCross * world.graph.lanes());
        prefetch(lane + contact::kRolling * world.graph.lanes());
    }
}

/// Does a body hang from another that is joined to it, and bears it?
static bool hangsFrom(const WorldImpl& world, std::uint32_t body, std::uint32_t bearer, const Vec3& up) {
    return world.bodies.moves(bearer) && dot(toVec3(world.bodies[bearer].center - world.bodies[body].center), up) > 0;
}

void WorldImpl::measureIslands() {
    beginMeasuring();
    LoadPaths& paths = islands.paths;
    paths.collect(tables());
    paths.findDepths(bodies);
    paths.estimate(bodies, length(settings.gravity), true);
    paths.heldLevel.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : bodies.awake) paths.heldLevel[body] = 0;

    const float gravity = length(settings.gravity);
    const Vec3 up = gravity > 0 ? (-1 / gravity) * settings.gravity : Vec3{};
    for (std::size_t i = 0; i < paths.edges.size(); ++i) {
        prefetchSupportEdge(*this, i);
        const SupportEdge& edge = paths.edges[i];
        const bool movesA = edge.movesA, movesB = edge.movesB;
        direct::IslandFeatures& island = islands.featuresOf(movesA ? edge.a : edge.b);
        island.pairs += movesA && movesB;
        const bool aBears = paths.aBears(edge), bBears = paths.bBears(edge);
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
            island.bare &= isTreeJoint(joints.sims[edge.constraint]);
            const JointSim& joint = joints.sims[edge.constraint];
            island.stiffness =
                std::max(island.stiffness, stiffnessOf(joint, bodies.states.data(), bodies.inertias.data(), context.h));
            paths.heldLevel[edge.a] = paths.heldLevel[edge.b] = 1;
            island.hangs |= !movesA || !movesB;
        }
        if (!aBears && !bBears) continue;
        const std::uint32_t upper = aBears ? edge.b : edge.a;
        const float load = paths.shareOf(bodies, upper);
        const float massA = movesA ? bodies[edge.a].mass : bodies[edge.b].mass;
        const float massB = movesB ? bodies[edge.b].mass : massA;
        const float lighter = std::min(massA, massB), number = load / lighter;
        float& largest = edge.joint ? island.jointLoad : island.contactLoad;
        largest = std::max(largest, number);
        island.hung += edge.joint && number > direct::kHung && hangsFrom(*this, upper, aBears ? edge.a : edge.b, up);
        island.massRatio = std::max(island.massRatio, std::max(massA, massB) / lighter);
        if (!edge.joint) island.buckling = std::max(island.buckling, bucklingShare(edge, load, number));
    }
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body)) continue;
        direct::IslandFeatures& island = islands.featuresOf(body);
        island.mass += bodies[body].mass;
        island.momentum += bodies[body].mass * bodies.states[body].v;
    }
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body)) continue;
        direct::IslandFeatures& island = islands.featuresOf(body);
        ++island.bodies;
        island.bare &= turnsFreely(body);
        island.spin = std::max(island.spin, context.h * length(bodies.states[body].w));
        const Vec3 common = (1 / island.mass) * island.momentum;
        const float speed =
            length(bodies.states[body].v - common) + length(bodies.states[body].w) * bodies[body].radius;
        const bool slow = speed <= kSlow * std::sqrt(gravity * bodies[body].size);
        island.moving += !slow;
        const bool rests = bodies.isDirect(body) || isUntouched(body) || bodies[body].sleepTimer >= direct::kLongRest;
        island.restless += !slow || !rests;
        island.leaning += paths.depth[body] != kNone && paths.heldLevel[body] == 0 && slow;
    }
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body)) continue;
        direct::IslandFeatures& island = islands.featuresOf(body);
        if (island.joints > 0 && !island.touches) island.touches = isInContact(body);
    }
    forEachCoupledPair(tables(), [&](std::uint32_t, std::uint32_t body) { islands.featuresOf(body).coupled = true; });
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
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body)) continue;
        direct::IslandFeatures& island = islands.featuresOf(body);
        const std::int32_t steps = bodies[body].directSteps;
        island.direct |= steps > 0;
        if (steps > 0) island.last = bodies[body].directReason;
        island.staying = std::max(island.staying, steps);
        island.cooldown = std::min(island.cooldown, steps);
    }
    bool waiting = false;
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body) || islands.root(body) != body) continue;
        direct::IslandFeatures& island = islands.featuresOf(body);
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
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body)) continue;
        const direct::IslandFeatures& island = islands.featuresOf(body);
        bodies[body].directSteps = island.staying;
        bodies[body].directReason = island.reason;
    }
    return waiting;
}

/// Choices change when support edges do, so they are made anew only then: at once where a direct island has part in it
/// or something was just made or put somewhere, else every few steps.
void WorldImpl::chooseSolvers() {
    constexpr std::uint64_t kPeriod = 16;  // steps between choices that nothing hurries: a quarter of a second at 60 Hz
    const ConstraintGraph::Color& list = graph.color(ConstraintGraph::kDirect);
    const bool atOnce = islands.structureChanged || islands.directChanged;
    if (!economy.seldomChoices || (islands.graphChanged && (atOnce || stepCount % kPeriod == 0))) {
        islands.uniteConstraints(tables(), false);
        measureIslands();
        islands.graphChanged =
            decideIslands(static_cast<std::int32_t>(std::min(stepCount - islands.choiceStep, kPeriod)));
        islands.choiceStep = stepCount;
        applyChoices();
        if (islands.structureChanged) loadNewContacts();
        islands.structureChanged = islands.directChanged = false;
        directSet.grouped = false;
    }
    const bool anyDirect = !list.manifolds.empty() || !list.joints.empty();
    // Sleeping may have emptied the list since.
    if (!directSet.grouped || directSet.treesChanged) articulations.forget();
    if (!directSet.grouped || !anyDirect || directSet.treesChanged) groupDirect();
    directSet.grouped = true;
    directSet.treesChanged = false;
}

}  // namespace ragtop
