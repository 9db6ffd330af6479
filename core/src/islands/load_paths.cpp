#include "islands/load_paths.h"

#include <cstring>

namespace ragtop {

namespace {

constexpr float kSupportGap = 0.01f;  ///< gap over which bodies still bear on each other, in sizes
constexpr float kInLine = 1e-4f;      ///< ratio of squares of widths, below which points lie in a line, or at a place

std::uint32_t otherOf(const SupportEdge& edge, std::uint32_t body) { return edge.a == body ? edge.b : edge.a; }

/// Calls f(point, x, y) for the points of a contact within reach, seen from the centre of a body of it.
template <class Axes, class F>
void forEachNearPoint(const ConstTables& t, const SupportEdge& edge, std::uint32_t body, const Axes& axes, const F& f) {
    const ManifoldRecord& manifold = t.manifolds[edge.constraint];
    const float reach = kSupportGap * t.contacts[manifold.contact].size;
    for (int j = 0; j < manifold.pointCount; ++j) {
        if (!(manifold.separation[j] <= reach)) continue;
        const Vec3& anchor = edge.a == body ? manifold.anchorA[j] : manifold.anchorB[j];
        f(j, dot(anchor, axes.x), dot(anchor, axes.y));
    }
}

/// Points in a plane, in line or not.
struct Spread {
    float n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  ///< sums
    void add(float px, float py) { ++n, x += px, y += py, xx += px * px, xy += px * py, yy += py * py; }
    /// S⁺ e of the matrix about the mean; if it is of rank one that is S e over the square of its trace.
    std::array<float, 2> solve(float ex, float ey) const {
        const float sxx = xx - x * x / n, sxy = xy - x * y / n, syy = yy - y * y / n;
        const float det = sxx * syy - sxy * sxy, trace = sxx + syy, square = trace * trace;
        if (!(trace > kInLine * (xx + yy))) return {0, 0};
        if (!(det > kInLine * square)) return {(sxx * ex + sxy * ey) / square, (sxy * ex + syy * ey) / square};
        return {(syy * ex - sxy * ey) / det, (sxx * ey - sxy * ex) / det};
    }
};

}  // namespace

/// Room for all contacts, whether they are near or not: what comes near later asks for no memory.
void LoadPaths::begin(const ConstTables& t, StageMemory& memory, std::size_t more) {
    std::size_t room = 0;
    for (int c = 0; c < t.graph.listCount(); ++c)
        room += t.graph.color(c).manifolds.capacity() + t.graph.color(c).joints.capacity();
    using M = StageMemory;
    const std::size_t all = t.bodies.size();
    memory.begin(M::bytesOf<SupportEdge>(room) + M::bytesOf<float>(room) + M::bytesOf<std::uint32_t>(2 * room) +
                 M::bytesOf<std::uint32_t>(all + 1) + 2 * M::bytesOf<std::uint32_t>(all) + 3 * M::bytesOf<float>(all) +
                 M::bytesOf<LoadDivision>(all) + M::bytesOf<std::uint8_t>(all) + more);
    edges = memory.take<SupportEdge>(room);
    share = memory.take<float>(room);
    edgesOf_ = memory.take<std::uint32_t>(2 * room);
    edgesEnd_ = memory.take<std::uint32_t>(all + 1);
    visited_ = memory.take<std::uint32_t>(all);
    depth = memory.take<std::uint32_t>(all);
    load_ = memory.take<float>(all);
    momentX_ = memory.take<float>(all);
    momentY_ = memory.take<float>(all);
    division_ = memory.take<LoadDivision>(all);
    heldLevel = memory.take<std::uint8_t>(all);
}

/// Contacts within reach, and joints.
void LoadPaths::collect(const ConstTables& t, const IslandLists* some) {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t constraint, bool joint) {
        edges.push({a, b, constraint, joint, t.bodies.moves(a), t.bodies.moves(b)});
    };
    // Not by the lists of the graph: sums follow this order, and who is where in them depends on the number of workers.
    forEachInGraph(
        t, some,
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

std::span<const std::uint32_t> LoadPaths::edgesOf(std::uint32_t body) const {
    const std::uint32_t begin = body == 0 ? 0 : edgesEnd_[body - 1];
    return {&edgesOf_[0] + begin, edgesEnd_[body] - begin};
}

/// Distances from what does not move, by breadth first over the support edges; `visited_` keeps the order of the
/// visit.
void LoadPaths::findDepths(const Bodies& bodies, std::span<const std::uint32_t> members) {
    depth.resizeForOverwrite(bodies.size());
    edgesEnd_.resizeForOverwrite(bodies.size() + 1);
    std::memset(edgesEnd_.data(), 0, edgesEnd_.size() * sizeof(std::uint32_t));
    for (const std::uint32_t body : members) depth[body] = kNone;
    for (const SupportEdge& edge : edges) {
        edgesEnd_[edge.a + 1] += edge.movesA;
        edgesEnd_[edge.b + 1] += edge.movesB;
    }
    for (std::size_t i = 1; i < edgesEnd_.size(); ++i) edgesEnd_[i] += edgesEnd_[i - 1];
    edgesOf_.resizeForOverwrite(edgesEnd_[bodies.size()]);
    visited_.clear();
    // Each begin moves to its end, which is where the next one began.
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
        const SupportEdge& edge = edges[i];
        if (edge.movesA) edgesOf_[edgesEnd_[edge.a]++] = i;
        if (edge.movesB) edgesOf_[edgesEnd_[edge.b]++] = i;
        if (edge.movesA && edge.movesB) continue;
        if (const std::uint32_t body = edge.movesA ? edge.a : edge.b; depth[body] == kNone) {
            depth[body] = 1;
            visited_.push(body);
        }
    }
    for (std::size_t i = 0; i < visited_.size(); ++i)
        for (const std::uint32_t k : edgesOf(visited_[i])) {
            const SupportEdge& edge = edges[k];
            if (!edge.movesA || !edge.movesB) continue;
            if (const std::uint32_t other = otherOf(edge, visited_[i]); depth[other] == kNone) {
                depth[other] = depth[visited_[i]] + 1;
                visited_.push(other);
            }
        }
}

void LoadPaths::estimate(const ConstTables& t, const Vec3& gravity, bool pushes,
                         std::span<const std::uint32_t> members) {
    const Bodies& bodies = t.bodies;
    const float g = length(gravity), perForce = g > 0 ? 1 / g : 0.0f;
    axisX_ = perpendicular(normalized(gravity)), axisY_ = cross(normalized(gravity), axisX_);
    for (StageArray<float>* perBody : {&load_, &momentX_, &momentY_}) perBody->resizeForOverwrite(bodies.size());
    division_.resizeForOverwrite(bodies.size());
    share.resizeForOverwrite(edges.size());
    for (const std::uint32_t body : members) {
        load_[body] = pushes ? perForce * length(bodies[body].force) : 0.0f;
        momentX_[body] = momentY_[body] = 0;
    }
    for (std::size_t i = visited_.size(); i-- > 0;) handDown(t, visited_[i]);
}

LoadPaths::BodyAxes LoadPaths::axesOf(const Bodies& bodies, std::uint32_t body) const {
    const Quat& q = bodies[body].rotation;
    const Quat toBody{-q.x, -q.y, -q.z, q.w};
    return {rotate(toBody, axisX_), rotate(toBody, axisY_)};
}

/// Finds how a body's load, whose line goes through (x, y) from its centre, divides among what bears it.
void LoadPaths::divide(const ConstTables& t, std::uint32_t body, const BodyAxes& axes, float x, float y) {
    const auto forEachPoint = [&](const auto& f) {
        for (const std::uint32_t k : edgesOf(body))
            if (isBorne(edges[k], body)) forEachNearPoint(t, edges[k], body, axes, f);
    };
    Spread spread;
    forEachPoint([&](int, float px, float py) { spread.add(px, py); });
    LoadDivision& division = division_[body];
    division = {.each = 1 / spread.n, .meanX = spread.x / spread.n, .meanY = spread.y / spread.n};
    const auto [slopeX, slopeY] = spread.solve(x - division.meanX, y - division.meanY);
    division.slopeX = slopeX, division.slopeY = slopeY;
    float sum = 0;
    forEachPoint([&](int, float px, float py) { sum += division.at(px, py); });
    division.scale = 1 / sum;
}

/// Hands on what a body weighs and bears, once all above it have.
void LoadPaths::handDown(const ConstTables& t, std::uint32_t body) {
    const Bodies& bodies = t.bodies;
    const float all = load_[body] + bodies[body].mass;
    const float x = momentX_[body] / all, y = momentY_[body] / all;
    float bearers = 0;
    bool joined = false;
    for (const std::uint32_t k : edgesOf(body))
        joined |= edges[k].joint, bearers += isBorne(edges[k], body) ? 1.0f : 0.0f;
    const BodyAxes axes = axesOf(bodies, body);
    LoadDivision& division = division_[body];
    division = {.each = 1};
    if (!joined) divide(t, body, axes, x, y);
    for (const std::uint32_t k : edgesOf(body)) {
        const SupportEdge& edge = edges[k];
        if (!isBorne(edge, body)) continue;
        const std::uint32_t bearer = otherOf(edge, body);
        float part = 0, partX = 0, partY = 0;
        if (joined)
            part = 1 / bearers;
        else
            forEachNearPoint(t, edge, body, axes, [&](int, float px, float py) {
                const float point = division.at(px, py);
                part += point, partX += point * px, partY += point * py;
            });
        share[k] = all * part;
        if (!bodies.moves(bearer)) continue;
        load_[bearer] += share[k];
        if (joined) continue;
        const Vec3 between = toVec3(bodies[body].center - bodies[bearer].center);
        momentX_[bearer] += all * partX + share[k] * dot(between, axisX_);
        momentY_[bearer] += all * partY + share[k] * dot(between, axisY_);
    }
}

std::array<float, kMaxManifoldPoints> LoadPaths::sharesOfPoints(const ConstTables& t, const SupportEdge& edge) const {
    std::array<float, kMaxManifoldPoints> shares{};
    const std::uint32_t body = aBears(edge) ? edge.b : edge.a;
    float sum = 0;
    forEachNearPoint(t, edge, body, axesOf(t.bodies, body), [&](int j, float px, float py) {
        sum += shares[static_cast<std::size_t>(j)] = division_[body].at(px, py);
    });
    for (float& of : shares) of = sum > 0 ? of / sum : 0.0f;
    return shares;
}

}  // namespace ragtop
