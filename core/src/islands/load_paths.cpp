#include "islands/load_paths.h"

#include <cstring>

namespace ragtop {

namespace {

constexpr float kSupportGap = 0.01f;  ///< gap over which bodies still bear on each other, in sizes

}  // namespace

/// Room for all contacts, whether they are near or not: what comes near later asks for no memory.
void LoadPaths::begin(const ConstTables& t, StageMemory& memory, std::size_t more) {
    std::size_t room = 0;
    for (int c = 0; c < t.graph.listCount(); ++c)
        room += t.graph.color(c).manifolds.capacity() + t.graph.color(c).joints.capacity();
    using M = StageMemory;
    const std::size_t all = t.bodies.size();
    memory.begin(M::bytesOf<SupportEdge>(room) + M::bytesOf<std::uint32_t>(2 * room) +
                 M::bytesOf<std::uint32_t>(all + 1) + 3 * M::bytesOf<std::uint32_t>(all) + M::bytesOf<float>(all) +
                 M::bytesOf<std::uint8_t>(all) + more);
    edges = memory.take<SupportEdge>(room);
    neighbours_ = memory.take<std::uint32_t>(2 * room);
    neighbourBegin_ = memory.take<std::uint32_t>(all + 1);
    visited_ = memory.take<std::uint32_t>(all);
    depth = memory.take<std::uint32_t>(all);
    supports = memory.take<std::uint32_t>(all);
    load = memory.take<float>(all);
    heldLevel = memory.take<std::uint8_t>(all);
}

/// Contacts within reach, and joints.
void LoadPaths::collect(const ConstTables& t) {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t constraint, bool joint) {
        edges.push({a, b, constraint, joint, t.bodies.moves(a), t.bodies.moves(b)});
    };
    // Not by the lists of the graph: sums follow this order, and who is where in them depends on the number of workers.
    forEachInGraph(
        t,
        [&](std::uint32_t m) {
            const ManifoldRecord& manifold = t.manifolds[m];
            const ContactRecord& contact = t.contacts[manifold.contact];
            const float reach = kSupportGap * contact.size;
            bool near = false;
            for (int j = 0; j < manifold.pointCount; ++j) near |= manifold.separation[j] <= reach;
            if (near) add(contact.bodyA, contact.bodyB, m, false);
        },
        [&](std::uint32_t j) { add(t.joints[j].bodyA, t.joints[j].bodyB, j, true); });
}

/// Distances from what does not move, by breadth first over the support edges; `visited_` keeps the order of the
/// visit.
void LoadPaths::findDepths(const Bodies& bodies) {
    depth.resizeForOverwrite(bodies.size());
    neighbourBegin_.resizeForOverwrite(bodies.size() + 1);
    std::memset(neighbourBegin_.data(), 0, neighbourBegin_.size() * sizeof(std::uint32_t));
    for (const std::uint32_t body : bodies.awake) depth[body] = kNone;
    for (const SupportEdge& edge : edges) {
        if (!edge.movesA || !edge.movesB) continue;
        ++neighbourBegin_[edge.a + 1];
        ++neighbourBegin_[edge.b + 1];
    }
    for (std::size_t i = 1; i < neighbourBegin_.size(); ++i) neighbourBegin_[i] += neighbourBegin_[i - 1];
    neighbours_.resizeForOverwrite(neighbourBegin_[bodies.size()]);
    visited_.clear();
    for (const SupportEdge& edge : edges) {
        const bool movesA = edge.movesA, movesB = edge.movesB;
        if (movesA && movesB) {
            neighbours_[neighbourBegin_[edge.a]++] = edge.b;
            neighbours_[neighbourBegin_[edge.b]++] = edge.a;
        } else if (const std::uint32_t body = movesA ? edge.a : edge.b; depth[body] == kNone) {
            depth[body] = 1;
            visited_.push(body);
        }
    }
    // Each begin has moved to its end, which is where the next one began.
    for (std::size_t i = 0; i < visited_.size(); ++i) {
        const std::uint32_t body = visited_[i];
        const std::uint32_t begin = body == 0 ? 0 : neighbourBegin_[body - 1];
        for (std::uint32_t k = begin; k < neighbourBegin_[body]; ++k)
            if (std::uint32_t& other = depth[neighbours_[k]]; other == kNone) {
                other = depth[body] + 1;
                visited_.push(neighbours_[k]);
            }
    }
}

/// The mass that each body hands to each neighbour below it: its own, that of what pushes it if that counts, and what
/// it carries, in equal shares.
void LoadPaths::estimate(const Bodies& bodies, float gravity, bool pushes) {
    load.resizeForOverwrite(bodies.size());
    supports.resizeForOverwrite(bodies.size());
    const float perForce = gravity > 0 ? 1 / gravity : 0.0f;
    for (const std::uint32_t body : bodies.awake)
        load[body] = pushes ? perForce * length(bodies[body].force) : 0.0f, supports[body] = 0;
    for (const SupportEdge& edge : edges) {
        const bool movesA = edge.movesA, movesB = edge.movesB;
        if (movesA && (!movesB || depth[edge.b] < depth[edge.a])) ++supports[edge.a];
        if (movesB && (!movesA || depth[edge.a] < depth[edge.b])) ++supports[edge.b];
    }
    for (std::size_t i = visited_.size(); i-- > 0;) {
        const std::uint32_t body = visited_[i];
        const float share = (load[body] + bodies[body].mass) / static_cast<float>(supports[body]);
        const std::uint32_t begin = body == 0 ? 0 : neighbourBegin_[body - 1];
        for (std::uint32_t k = begin; k < neighbourBegin_[body]; ++k)
            if (depth[neighbours_[k]] < depth[body]) load[neighbours_[k]] += share;
    }
}

}  // namespace ragtop
