#include "islands/measure_islands.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/prefetch.h"
#include "constraints/contact_layout.h"
#include "constraints/stiffness.h"
#include "islands/direct_view.h"

namespace ragtop {

namespace {

constexpr float kSlow = 0.05f;     ///< speed of a body at rest, in √(gravity · size)
constexpr float kOpening = 0.01f;  ///< of an even share, that a point has left: less counts as none

/// Takes memory for what measuring islands finds, and numbers these.
void beginMeasuring(const MeasureView& v) {
    std::size_t count = 0;
    for (const std::uint32_t body : v.members()) count += v.islands.parent[body] == body ? 1 : 0;
    using M = StageMemory;
    const std::size_t own = M::bytesOf<std::uint32_t>(v.bodies.size()) + M::bytesOf<direct::IslandFeatures>(count) +
                            M::bytesOf<float>(v.bodies.size());
    v.islands.paths.begin(v.tables, v.stageMemory, own);
    v.islands.number = v.stageMemory.take<std::uint32_t>(v.bodies.size());
    v.islands.features = v.stageMemory.take<direct::IslandFeatures>(count);
    v.islands.stiffness = v.stageMemory.take<float>(v.bodies.size());
    v.islands.stiffness.resizeForOverwrite(v.bodies.size());
    for (const std::uint32_t body : v.members()) {
        v.islands.stiffness[body] = 0;
        if (v.islands.parent[body] != body) continue;
        v.islands.number[body] = static_cast<std::uint32_t>(v.islands.features.size());
        v.islands.features.push({});
    }
}

/// The edges of one contact, which follow each other: one of each of its manifolds. Meshes have one per triangle, none
/// of which tilts alone.
std::span<const SupportEdge> edgesOfContact(const MeasureView& v, std::size_t first) {
    const StageArray<SupportEdge>& edges = v.islands.paths.edges;
    const auto contactOf = [&](std::size_t i) { return v.tables.manifolds[edges[i].constraint].contact; };
    std::size_t end = first + 1;
    while (end < edges.size() && !edges[end].joint && contactOf(end) == contactOf(first)) ++end;
    return {&edges[first], end - first};
}
bool isFirstOfContact(const MeasureView& v, std::size_t index) {
    const StageArray<SupportEdge>& edges = v.islands.paths.edges;
    if (index == 0 || edges[index - 1].joint) return true;
    return v.tables.manifolds[edges[index - 1].constraint].contact !=
           v.tables.manifolds[edges[index].constraint].contact;
}

/// A contact that bears a load.
struct BearingContact {
    const MeasureView& v;
    std::span<const SupportEdge> edges;
    const float* share;  ///< kg, what each hands down
    float load = 0;      ///< kg, of all
    int points = 0;

    BearingContact(const MeasureView& view, std::size_t first)
        : v(view), edges(edgesOfContact(view, first)), share(&view.islands.paths.share[first]) {
        for (std::size_t i = 0; i < edges.size(); ++i) load += share[i], points += manifoldOf(edges[i]).pointCount;
    }
    const ManifoldRecord& manifoldOf(const SupportEdge& edge) const { return v.tables.manifolds[edge.constraint]; }
    float impulse(const SupportEdge& edge, int j) const {
        return v.tables.graph.lane(
            manifoldOf(edge)
                .place)[(contact::kPoints + j * contact::kPointFields + contact::kImpulse) * v.tables.graph.lanes()];
    }
    /// Calls visit(arm in A's frame, m; its part of the load) for each point: as in the last substep, or as the
    /// estimate has it.
    template <class Visit>
    void forEachShare(Visit&& visit) const {
        float borne = 0;
        for (const SupportEdge& edge : edges)
            for (int j = 0; j < manifoldOf(edge).pointCount; ++j) borne += impulse(edge, j);
        for (std::size_t i = 0; i < edges.size(); ++i) {
            std::array<float, kMaxManifoldPoints> shares{};
            if (!(borne > 0)) shares = v.islands.paths.sharesOfPoints(v.tables, edges[i]);
            const ManifoldRecord& manifold = manifoldOf(edges[i]);
            for (int j = 0; j < manifold.pointCount; ++j)
                visit(manifold.anchorA[j], borne > 0 ? impulse(edges[i], j) / borne
                                                     : shares[static_cast<std::size_t>(j)] * (share[i] / load));
        }
    }
};

/// The points of a contact about their middle, in its plane.
struct ContactPlane {
    const BearingContact& contact;
    float n = 0, s11 = 0, s12 = 0, s22 = 0;
    Vec3 middle, t1, t2;

    explicit ContactPlane(const BearingContact& of) : contact(of), n(static_cast<float>(of.points)) {
        Vec3 normal;
        for (const SupportEdge& edge : of.edges) normal += of.manifoldOf(edge).normal;
        if (of.edges.size() > 1) normal = normalized(normal);
        t1 = perpendicular(normal), t2 = cross(normal, t1);
        forEachPoint([&](const Vec3& anchor) { middle += (1 / n) * anchor; });
        forEachPoint([&](const Vec3& anchor) {
            const Vec3 arm = anchor - middle;
            const float x = dot(arm, t1), y = dot(arm, t2);
            s11 += x * x, s12 += x * y, s22 += y * y;
        });
    }
    template <class Visit>
    void forEachPoint(Visit&& visit) const {
        for (const SupportEdge& edge : contact.edges)
            for (int j = 0; j < contact.manifoldOf(edge).pointCount; ++j) visit(contact.manifoldOf(edge).anchorA[j]);
    }
    /// m², about the axis on which they are narrowest.
    float leastSpread() const {
        const float difference = s11 - s22;
        return 0.5f * (s11 + s22 - std::sqrt(difference * difference + 4 * s12 * s12));
    }
    /// What equal springs have left, of an even share, in the point that bears least, where loads meet as these do.
    float leastShare() const {
        float e1 = 0, e2 = 0, least = 1;
        contact.forEachShare([&](const Vec3& anchor, float share) {
            e1 += share * dot(anchor - middle, t1), e2 += share * dot(anchor - middle, t2);
        });
        const float det = s11 * s22 - s12 * s12, g1 = (s22 * e1 - s12 * e2) / det, g2 = (s11 * e2 - s12 * e1) / det;
        forEachPoint([&](const Vec3& anchor) {
            least = std::min(least, 1 + n * (g1 * dot(anchor - middle, t1) + g2 * dot(anchor - middle, t2)));
        });
        return least;
    }
};

/// Load over the load under which soft contacts of this pair tilt away: a column of n boxes of height l stands while
/// n³ m g l < 7.84 k_θ, with k_θ the stiffness of its points about their middle. At p of it a load leans 1/(1 − p) as
/// far; a point that has s of its even share opens when p comes to s.
float bucklingShare(const MeasureView& v, std::size_t first, float lighter) {
    const BearingContact contact(v, first);
    const SupportEdge& edge = contact.edges.front();
    const float gravity = length(v.settings.gravity), number = contact.load / lighter;
    if (contact.points < 3 || !(gravity > 0)) return 0;
    const ContactPlane plane(contact);
    const float inverseMass =
        v.bodies.states[v.bodies[edge.a].state].invMass + v.bodies.states[v.bodies[edge.b].state].invMass;
    const float omega = 2 * kPi * v.settings.contactFrequency * static_cast<float>(v.settings.substeps) / v.dt;
    const bool fixed = !v.bodies.moves(edge.a) || !v.bodies.moves(edge.b);
    const float stiffness = (fixed ? 4 : 1) * omega * omega * plane.leastSpread() / inverseMass;
    const BodyRecord& upper = v.bodies[v.bodies.moves(edge.b) ? edge.b : edge.a];
    const ManifoldRecord& manifold = contact.manifoldOf(edge);
    const Vec3 arm = rotate(upper.rotation, v.bodies.moves(edge.b) ? manifold.anchorB[0] : manifold.anchorA[0]);
    const float height = 2 * std::fabs(dot(arm, v.settings.gravity)) / gravity;
    const float bending = contact.load * gravity * number * number * height;
    if (!(stiffness > 0)) return 0;
    const float share = bending / (7.84f * stiffness);
    if (share < kOpening * direct::kBuckling) return share;
    return share / std::max(plane.leastShare(), kOpening);
}

/// A face, or something round: what stands on an edge or a corner needs others to hold it.
bool standsOn(const MeasureView& v, std::uint32_t index) {
    const ManifoldRecord& manifold = v.tables.manifolds[index];
    const ContactRecord& contact = v.tables.contacts[manifold.contact];
    const float roundness = v.tables.shapes.geometries[v.tables.shapes[contact.shapeA].geometry].convex.radius +
                            v.tables.shapes.geometries[v.tables.shapes[contact.shapeB].geometry].convex.radius;
    return manifold.pointCount > 2 || roundness > 0;
}

/// Some contact of the body is in the graph.
bool isInContact(const MeasureView& v, std::uint32_t body) {
    for (std::uint32_t key = v.bodies[body].firstContact; key != kNone; key = v.tables.contacts.next(key)) {
        for (const ManifoldRecord& manifold : v.tables.manifolds.of(v.tables.contacts[key >> 1]))
            if (manifold.place.color != kNone) return true;
    }
    return false;
}

/// Asks for what measuring islands reads of support edges some places ahead: they lie in no order.
void prefetchSupportEdge(const MeasureView& v, std::size_t place) {
    constexpr std::size_t kRecords = 16, kLane = 8;  // edges ahead, by trial
    const StageArray<SupportEdge>& edges = v.islands.paths.edges;
    if (place + kRecords < edges.size() && !edges[place + kRecords].joint) {
        const SupportEdge& edge = edges[place + kRecords];
        const ManifoldRecord& manifold = v.tables.manifolds[edge.constraint];
        prefetch(&manifold.normal);
        prefetch(&manifold.place);
        prefetch(&v.bodies[edge.a].rotation);
        prefetch(&v.bodies[edge.a].mass);
        prefetch(&v.bodies[edge.b].mass);
    }
    if (place + kLane < edges.size() && !edges[place + kLane].joint) {
        const float* lane = v.tables.graph.lane(v.tables.manifolds[edges[place + kLane].constraint].place);
        prefetch(lane + contact::kCross * v.tables.graph.lanes());
        prefetch(lane + contact::kRolling * v.tables.graph.lanes());
    }
}

/// Does a body hang from another that is joined to it, and bears it?
bool hangsFrom(const MeasureView& v, std::uint32_t body, std::uint32_t bearer, const Vec3& up) {
    return v.bodies.moves(bearer) && dot(toVec3(v.bodies[bearer].center - v.bodies[body].center), up) > 0;
}

/// Of joints alone.
bool isMechanism(direct::Reason reason) { return reason == direct::Reason::tree || reason == direct::Reason::loop; }

/// Reasons that no choice outlives.
bool onlyWhile(direct::Reason reason) {
    return reason == direct::Reason::deep || reason == direct::Reason::damped || isMechanism(reason);
}

bool isInside(const ManifoldRecord& manifold, float size) {
    bool any = false;
    for (int j = 0; j < manifold.pointCount; ++j) any |= manifold.separation[j] < -contact::kInside * size;
    return any;
}

/// What a support edge says of its island.
void measureEdge(const MeasureView& v, std::size_t index, const Vec3& up) {
    LoadPaths& paths = v.islands.paths;
    const SupportEdge& edge = paths.edges[index];
    const bool movesA = edge.movesA, movesB = edge.movesB;
    direct::IslandFeatures& island = v.islands.featuresOf(movesA ? edge.a : edge.b);
    const bool aBears = paths.aBears(edge), bBears = paths.bBears(edge);
    if (!edge.joint) {
        const ManifoldRecord& manifold = v.tables.manifolds[edge.constraint];
        const float* lane = v.tables.graph.lane(manifold.place);
        for (const int field : {contact::kRolling, contact::kSpinning, contact::kCross})
            island.rolls |= lane[field * v.tables.graph.lanes()] != 0;
        island.inside |= isInside(manifold, v.tables.contacts[manifold.contact].size);
        const Vec3 normal = rotate(v.bodies[edge.a].rotation, manifold.normal);
        const float cosine = dot(normal, up);
        const bool upright = cosine > kLevel || cosine < -kLevel;
        if (upright && standsOn(v, edge.constraint)) paths.heldLevel[cosine > 0 ? edge.b : edge.a] = 1;
    } else {
        ++island.joints;
        island.bare &= isTreeJoint(v.tables.joints.sims[edge.constraint]);
        const JointSim& joint = v.tables.joints.sims[edge.constraint];
        const Hardness hardness = hardnessOf(joint, v.bodies.states.data(), v.bodies.inertias.data(), v.h);
        Hardness& hardest = island.hardness;
        hardest.stiffness = std::max(hardest.stiffness, hardness.stiffness);
        hardest.braking = std::max(hardest.braking, hardness.braking);
        for (const std::uint32_t body : {edge.a, edge.b}) {
            if (!(hardness.travel > 0) || !v.bodies.moves(body)) continue;
            float& stiffness = v.islands.stiffness[body];
            stiffness += v.h * v.h * hardness.travel * v.bodies.states[body].invMass;
            island.stiffness = std::max(island.stiffness, stiffness);
        }
        paths.heldLevel[edge.a] = paths.heldLevel[edge.b] = 1;
        island.hangs |= !movesA || !movesB;
    }
    if (!aBears && !bBears) return;
    const std::uint32_t upper = aBears ? edge.b : edge.a;
    const float load = paths.share[index];
    const float massA = movesA ? v.bodies[edge.a].mass : v.bodies[edge.b].mass;
    const float massB = movesB ? v.bodies[edge.b].mass : massA;
    const float lighter = std::min(massA, massB), number = load / lighter;
    float& largest = edge.joint ? island.jointLoad : island.contactLoad;
    largest = std::max(largest, number);
    island.hung += edge.joint && number > direct::kHung && hangsFrom(v, upper, aBears ? edge.a : edge.b, up);
    island.massRatio = std::max(island.massRatio, std::max(massA, massB) / lighter);
    if (!edge.joint && isFirstOfContact(v, index))
        island.buckling = std::max(island.buckling, bucklingShare(v, index, lighter));
}

}  // namespace

bool isUntouched(const Bodies& bodies, std::uint32_t body) {
    const BodyState& state = bodies.states[bodies[body].state];
    return state.v == Vec3{} && state.w == Vec3{};
}

/// What the bodies that move say of their islands.
static void measureBodies(const MeasureView& v, float gravity) {
    LoadPaths& paths = v.islands.paths;
    for (const std::uint32_t body : v.members()) {
        if (!v.bodies.moves(body)) continue;
        v.islands.featuresOf(body).common.add(v.bodies[body].mass, v.bodies.states[body].v);
    }
    for (const std::uint32_t body : v.members()) {
        if (!v.bodies.moves(body)) continue;
        direct::IslandFeatures& island = v.islands.featuresOf(body);
        ++island.bodies;
        island.bare &= turnsFreely(v.bodies, body);
        island.spin = std::max(island.spin, v.h * length(v.bodies.states[body].w));
        const Vec3 common = island.common.velocity();
        const float speed =
            length(v.bodies.states[body].v - common) + length(v.bodies.states[body].w) * v.bodies[body].radius;
        const bool slow = speed <= kSlow * std::sqrt(gravity * v.bodies[body].size);
        island.moving += !slow;
        const bool rests =
            v.bodies.isDirect(body) || isUntouched(v.bodies, body) || v.bodies[body].sleepTimer >= direct::kLongRest;
        island.restless += !slow || !rests;
        island.leaning += paths.depth[body] != kNone && paths.heldLevel[body] == 0 && slow;
    }
    for (const std::uint32_t body : v.members()) {
        if (!v.bodies.moves(body)) continue;
        direct::IslandFeatures& island = v.islands.featuresOf(body);
        if (island.joints > 0 && !island.touches) island.touches = isInContact(v, body);
    }
}

void measureIslands(const MeasureView& v) {
    beginMeasuring(v);
    LoadPaths& paths = v.islands.paths;
    paths.collect(v.tables, v.some);
    paths.findDepths(v.bodies, v.members());
    const float gravity = length(v.settings.gravity);
    paths.estimate(v.tables, v.settings.gravity, true, v.members());
    paths.heldLevel.resizeForOverwrite(v.bodies.size());
    for (const std::uint32_t body : v.members()) paths.heldLevel[body] = 0;
    const Vec3 up = gravity > 0 ? (-1 / gravity) * v.settings.gravity : Vec3{};
    for (std::size_t i = 0; i < paths.edges.size(); ++i) {
        prefetchSupportEdge(v, i);
        measureEdge(v, i, up);
    }
    measureBodies(v, gravity);
    if (!v.some)
        forEachCoupledPair(v.tables,
                           [&](std::uint32_t, std::uint32_t body) { v.islands.featuresOf(body).coupled = true; });
}

bool decideIslands(const MeasureView& v, std::int32_t elapsed) {
    for (const std::uint32_t body : v.members()) {
        if (!v.bodies.moves(body)) continue;
        direct::IslandFeatures& island = v.islands.featuresOf(body);
        const std::int32_t steps = v.bodies[body].direct.steps;
        island.direct |= steps > 0;
        if (steps > 0) island.last = v.bodies[body].direct.reason;
        island.staying = std::max(island.staying, steps);
        island.cooldown = std::min(island.cooldown, steps);
    }
    bool waiting = false;
    for (const std::uint32_t body : v.members()) {
        if (!v.bodies.moves(body) || v.islands.root(body) != body) continue;
        direct::IslandFeatures& island = v.islands.featuresOf(body);
        island.reason = chooseDirect(island);
        if (v.settings.solver == SolverChoice::iterative || island.coupled)
            island.reason = direct::Reason::none, island.staying = 0;
        const bool large = island.bodies > direct::kMostBodies;
        const bool fits = !large && !island.rolls && !island.coupled;
        if (v.settings.solver == SolverChoice::direct && fits) island.reason = direct::Reason::asked;
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
    for (const std::uint32_t body : v.members()) {
        if (!v.bodies.moves(body)) continue;
        const direct::IslandFeatures& island = v.islands.featuresOf(body);
        v.bodies[body].direct.steps = island.staying;
        v.bodies[body].direct.reason = island.reason;
    }
    return waiting;
}

/// Do bodies stand on each other, or go along each other, so that no point of a contact comes nearer or goes away?
static bool staysInTouch(const MeasureView& v, const SupportEdge& edge, const ManifoldRecord& manifold) {
    constexpr float kRounded = 1e-6f;  // of the speeds that cancel
    const auto velocityAt = [&](std::uint32_t index, const Vec3& anchor) {
        const BodyState& state = v.bodies.states[v.bodies[index].state];
        return state.v + cross(state.w, rotate(v.bodies[index].rotation, anchor));
    };
    const Vec3 normal = rotate(v.bodies[edge.a].rotation, manifold.normal);
    bool stays = true;
    for (int j = 0; j < manifold.pointCount; ++j) {
        const Vec3 a = velocityAt(edge.a, manifold.anchorA[j]), b = velocityAt(edge.b, manifold.anchorB[j]);
        stays &= std::fabs(dot(normal, b - a)) <= kRounded * (length(a) + length(b));
    }
    return stays;
}

void loadNewContacts(const MeasureView& v, float gravityStep, ConstraintGraph& graph,
                     AlignedArray<std::uint32_t>& fresh) {
    fresh.clear();
    const float gravity = length(v.settings.gravity);
    v.islands.paths.estimate(v.tables, v.settings.gravity, false, v.members());
    if (!(gravity > 0)) return;
    const Vec3 down = (1 / gravity) * v.settings.gravity;
    const auto stride = static_cast<std::size_t>(graph.lanes());
    const LoadPaths& paths = v.islands.paths;
    for (std::size_t i = 0; i < paths.edges.size(); ++i) {
        const SupportEdge& edge = paths.edges[i];
        if (edge.joint || (!paths.aBears(edge) && !paths.bBears(edge))) continue;
        const ManifoldRecord& manifold = v.tables.manifolds[edge.constraint];
        if (!staysInTouch(v, edge, manifold)) continue;
        const float along = std::fabs(dot(rotate(v.bodies[edge.a].rotation, manifold.normal), down));
        if (along < kLevel || manifold.pointCount == 0 || manifold.place.color == ConstraintGraph::kDirect) continue;
        float* lane = graph.lane(manifold.place);
        const auto at = [&](int point, int field) -> float& {
            return lane[static_cast<std::size_t>(contact::kPoints + point * contact::kPointFields + field) * stride];
        };
        bool loaded = false;
        for (int j = 0; j < manifold.pointCount; ++j) loaded |= at(j, contact::kImpulse) != 0;
        if (loaded) continue;
        const std::array<float, kMaxManifoldPoints> shares = paths.sharesOfPoints(v.tables, edge);
        const float load = paths.share[i] * gravityStep * along;
        for (int j = 0; j < manifold.pointCount; ++j)
            at(j, contact::kImpulse) = at(j, contact::kLoad) = load * shares[static_cast<std::size_t>(j)];
        fresh.push(edge.constraint);
    }
}

}  // namespace ragtop
