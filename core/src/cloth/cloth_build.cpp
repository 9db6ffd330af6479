// From a definition to the layout that kernels run on.

#include <algorithm>
#include <cmath>

#include "base/hash.h"
#include "cloth/cloth_sim.h"

namespace ragtop::cloth {
namespace {

constexpr std::size_t kBlock = 16;  ///< the widest lanes: what all arrays are filled up to

std::size_t roundedUp(std::size_t n) { return (n + kBlock - 1) / kBlock * kBlock; }

/// Rows of points that nothing holds; those beyond the points never move.
void placePoints(ClothSim& sim, const Plan& plan, const Pose& pose) {
    State& state = sim.state;
    Fabric& fabric = sim.fabric;
    state.origin = {std::round(pose.position.x), std::round(pose.position.y), std::round(pose.position.z)};
    const std::size_t rows = roundedUp(index(sim.count) + 1);
    state.points.resize(rows, {});
    state.velocities.resize(rows, {});
    state.ties.resize(rows, {});
    state.leaves.assign(index(sim.count), 0);
    fabric.inverseMasses.resize(rows, 0);
    fabric.masses.assign(index(sim.count), 0);
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        state.points[i].place = placeFrom(transformPoint(pose, sim.def.points[i]), state.origin);
        if (fabric.heldOfPoint[i] != kNoPoint) continue;
        fabric.masses[i] = plan.masses[i];
        state.points[i].inverseMass = fabric.inverseMasses[i] = 1 / plan.masses[i];
    }
    state.before.resize(rows, {});
    std::copy(state.points.begin(), state.points.end(), state.before.begin());
    fabric.faces.pointAir.resize(rows, {});
    fabric.keeps.resize(rows, {});
    fabric.kicks.resize(rows, {});
}

void holdPoints(ClothSim& sim, const Pose& pose) {
    sim.fabric.heldOfPoint = attachmentOfPoints(sim.def);
    for (const ClothAttachment& attachment : sim.def.attachments) {
        HeldPoint held;
        held.point = attachment.point;
        held.id = attachment.body;
        held.fixed = transformPoint(pose, sim.def.points[index(attachment.point)]);
        if (!held.id.isNull())
            held.place = attachment.place ? *attachment.place
                                          : inverseTransformPoint(sim.world->pose(held.id), held.fixed);
        sim.state.held.push_back(held);
    }
}

/// B A/l⁴ of the point between two links, A the area of faces about it: then ½ k C² is ½ B κ² A.
float bendStiffness(const ClothDef& def, const Plan& plan, int point, float before, float after) {
    const float l = 0.5f * (before + after);
    return def.bending * plan.areas[index(point)] / (l * l * l * l);
}

void addLink(ClothSim& sim, const Plan& plan, const Chain& chain, int k, std::size_t slot) {
    constexpr float kStraight = 1e-4f;  // of a link: what sheets are off a line by rounding
    Fabric& fabric = sim.fabric;
    const Link& link = plan.links[index(chain.links[index(k)])];
    fabric.links.lengths[slot] = link.rest;
    fabric.links.inverseLengths[slot] = 1 / link.rest;
    fabric.links.compliances[slot] = 1 / link.stiffness;
    if (k == 0) return;
    const auto at = [&](int i) { return sim.def.points[index(chain.points[index(i)])]; };
    const float bend = length(at(k - 1) - 2.0f * at(k) + at(k + 1));
    fabric.links.bendLengths[slot] = bend > kStraight * link.rest ? bend : 0;
    const float before = plan.links[index(chain.links[index(k - 1)])].rest;
    fabric.links.bendStiffness[slot] = bendStiffness(sim.def, plan, chain.points[index(k)], before, link.rest);
    const auto w = [&](int i) { return fabric.inverseMasses[index(chain.points[index(i)])]; };
    fabric.links.bendRate =
        std::max(fabric.links.bendRate, fabric.links.bendStiffness[slot] * (w(k - 1) + 4 * w(k) + w(k + 1)));
}

/// `positions` of N points each in a new bundle, all of them the dummy.
std::uint32_t addRows(ClothSim& sim, std::size_t positions) {
    AlignedArray<std::uint32_t>& rows = sim.fabric.rows;
    const auto first = static_cast<std::uint32_t>(rows.size());
    rows.resize(first + positions * index(sim.fabric.kernels->lanes), rowOf(index(sim.count)));
    return first;
}

/// Whether a bundle of `rungs` with `ends` points each (1: positions of chains) is a piece of a grid.
EvenRows evenRows(const Fabric& fabric, std::uint32_t first, std::size_t rungs, std::size_t ends) {
    const auto lanes = index(fabric.kernels->lanes);
    const auto at = [&](std::size_t rung, std::size_t end, std::size_t lane) {
        return static_cast<std::int32_t>(fabric.rows[first + (ends * rung + end) * lanes + lane]);
    };
    EvenRows result;
    result.first = at(0, 0, 0);
    result.across = at(0, 0, 1) - result.first;
    result.along = at(1, 0, 0) - result.first;
    result.beside = at(0, ends - 1, 0) - result.first;
    result.even = true;
    for (std::size_t rung = 0; rung < rungs; ++rung)
        for (std::size_t end = 0; end < ends; ++end)
            for (std::size_t lane = 0; lane < lanes; ++lane)
                result.even &= at(rung, end, lane) == result.first + static_cast<std::int32_t>(rung) * result.along +
                                                          static_cast<std::int32_t>(end) * result.beside +
                                                          static_cast<std::int32_t>(lane) * result.across;
    return result;
}

/// True where something holds the point.
bool addPosition(ClothSim& sim, std::uint32_t first, std::size_t position, std::size_t lane, int point) {
    Fabric& fabric = sim.fabric;
    const std::size_t start = first + position * index(fabric.kernels->lanes);
    fabric.rows[start + lane] = rowOf(index(point));
    const int held = fabric.heldOfPoint[index(point)];
    if (held == kNoPoint) return false;
    fabric.heldPositions.push_back({static_cast<std::uint32_t>(3 * start + lane), held});
    return true;
}

/// Chains of a bundle are the lanes; the dummy point and links without length fill it up.
void addChains(ClothSim& sim, const Plan& plan, std::span<const Chain> chains) {
    Fabric& fabric = sim.fabric;
    const auto lanes = index(fabric.kernels->lanes);
    ChainBundle bundle;
    bundle.firstLink = static_cast<std::uint32_t>(fabric.links.lengths.size());
    bundle.links = static_cast<std::int32_t>(chains.front().links.size());
    bundle.firstPoint = addRows(sim, index(bundle.links) + 1);
    const std::size_t links = bundle.firstLink + index(bundle.links) * lanes;
    for (AlignedArray<float>* list : {&fabric.links.lengths, &fabric.links.inverseLengths, &fabric.links.compliances,
                                      &fabric.links.bendLengths, &fabric.links.bendStiffness})
        list->resize(links, 0);
    for (std::size_t lane = 0; lane < chains.size(); ++lane) {
        const Chain& chain = chains[lane];
        for (std::size_t k = 0; k < chain.points.size(); ++k)
            bundle.reacts |= addPosition(sim, bundle.firstPoint, k, lane, chain.points[k]);
        for (int k = 0; k < static_cast<int>(chain.links.size()); ++k)
            addLink(sim, plan, chain, k, bundle.firstLink + index(k) * lanes + lane);
    }
    bundle.rows = evenRows(fabric, bundle.firstPoint, index(bundle.links) + 1, 1);
    fabric.chains.push_back(bundle);
}

/// Likewise; quads without stiffness fill it up.
void addStrips(ClothSim& sim, std::span<const Strip> strips) {
    Fabric& fabric = sim.fabric;
    const auto lanes = index(fabric.kernels->lanes);
    StripBundle bundle;
    bundle.firstQuad = static_cast<std::uint32_t>(fabric.quads.stiffness.size());
    bundle.quads = static_cast<std::int32_t>(strips.front().rungs.size()) - 1;
    bundle.firstPoint = addRows(sim, 2 * strips.front().rungs.size());
    for (AlignedArray<float>* list : {&fabric.quads.stiffness, &fabric.quads.rests})
        list->resize(bundle.firstQuad + index(bundle.quads) * lanes, 0);
    const auto at = [&](int point) { return sim.def.points[index(point)]; };
    for (std::size_t lane = 0; lane < strips.size(); ++lane) {
        const Strip& strip = strips[lane];
        for (std::size_t k = 0; k < strip.rungs.size(); ++k) {
            const auto [a, b] = strip.rungs[k];
            bundle.reacts |= addPosition(sim, bundle.firstPoint, 2 * k, lane, a);
            bundle.reacts |= addPosition(sim, bundle.firstPoint, 2 * k + 1, lane, b);
            if (k + 1 == strip.rungs.size()) break;
            const auto [nextA, nextB] = strip.rungs[k + 1];
            const Vec3 u = at(nextB) - at(a), v = at(nextA) - at(b);
            const std::size_t slot = bundle.firstQuad + k * lanes + lane;
            fabric.quads.rests[slot] = lengthSquared(u) - lengthSquared(v);
            fabric.quads.stiffness[slot] = sim.def.shear / (8 * length(cross(u, v)));  // G/(16 A)
        }
    }
    bundle.rows = evenRows(fabric, bundle.firstPoint, strips.front().rungs.size(), 2);
    fabric.strips.push_back(bundle);
}

/// f of bundles of at most N each.
template <class Item, class F>
void forBundles(std::size_t lanes, const std::vector<Item>& items, F&& add) {
    for (std::size_t i = 0; i < items.size(); i += lanes)
        add(std::span(items).subspan(i, std::min(lanes, items.size() - i)));
}

/// Which chains and strips have each point.
void findBundlesOfPoints(ClothSim& sim) {
    Fabric& fabric = sim.fabric;
    std::vector<std::vector<std::uint32_t>> ofPoint(index(sim.count));
    const auto note = [&](std::uint32_t bundle, std::uint32_t first, int positions) {
        for (std::size_t i = 0; i < index(positions * fabric.kernels->lanes); ++i)
            if (const std::uint32_t point = fabric.rows[first + i] / kRowBytes; point < ofPoint.size())
                ofPoint[point].push_back(bundle);
    };
    std::uint32_t number = 0;
    for (const ChainBundle& bundle : fabric.chains) note(number++, bundle.firstPoint, bundle.links + 1);
    for (const StripBundle& bundle : fabric.strips) note(number++, bundle.firstPoint, 2 * (bundle.quads + 1));
    fabric.bundleStarts.push_back(0);
    for (const auto& list : ofPoint) {
        fabric.bundlesOfPoint.insert(fabric.bundlesOfPoint.end(), list.begin(), list.end());
        fabric.bundleStarts.push_back(static_cast<std::uint32_t>(fabric.bundlesOfPoint.size()));
    }
    sim.around.tied.assign(number, 0);
}

void addLayers(ClothSim& sim, const Plan& plan) {
    Fabric& fabric = sim.fabric;
    const auto lanes = index(fabric.kernels->lanes);
    std::size_t longest = 0;
    for (const Layer& layer : plan.layers) {
        const auto begin = static_cast<int>(fabric.chains.size());
        forBundles(lanes, layer.chains, [&](std::span<const Chain> chains) { addChains(sim, plan, chains); });
        fabric.chainLayers.push_back({begin, static_cast<int>(fabric.chains.size())});
        longest = std::max(longest, layer.chains.front().points.size() * kLinkFloats);
    }
    for (const StripLayer& layer : plan.strips) {
        const auto begin = static_cast<int>(fabric.strips.size());
        forBundles(lanes, layer.strips, [&](std::span<const Strip> strips) { addStrips(sim, strips); });
        fabric.stripLayers.push_back({begin, static_cast<int>(fabric.strips.size())});
        longest = std::max(longest, layer.strips.front().rungs.size() * kQuadFloats);
    }
    fabric.scratch.resize(longest * lanes, 0);
    fabric.reactions.resize(3 * fabric.rows.size(), 0);
    findBundlesOfPoints(sim);
}

void addTethers(ClothSim& sim, const Plan& plan) {
    Fabric& fabric = sim.fabric;
    if (!sim.def.tethers || sim.def.attachments.empty()) return;
    constexpr float kSpare = 1.0005f;  // of their length, which paths along links round off
    constexpr float kNoTether = 1e9f;  // m, square of which is a float
    const std::size_t rows = sim.state.points.size();
    fabric.tethers.anchoredAt.assign(index(sim.count), kNoPoint);
    fabric.tethers.anchors.resize(rows, rowOf(index(sim.count)));
    fabric.tethers.lengths.resize(rows, kNoTether);
    fabric.tethers.pulls.resize(3 * rows, 0);
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        if (plan.anchors[i] == kNoPoint || fabric.heldOfPoint[i] != kNoPoint) continue;
        fabric.tethers.anchoredAt[i] = fabric.heldOfPoint[index(plan.anchors[i])];
        fabric.tethers.anchors[i] = rowOf(index(plan.anchors[i]));
        fabric.tethers.lengths[i] = kSpare * sim.def.tetherSlack * plan.tethers[i];
    }
}

void addFaces(ClothSim& sim) {
    Fabric& fabric = sim.fabric;
    const std::size_t used = sim.def.faces.size(), count = roundedUp(used);
    std::vector<std::vector<std::uint32_t>> ofPoint(index(sim.count));
    fabric.faces.corners.resize(4 * count, rowOf(index(sim.count)));
    fabric.faces.shares.resize(count, 0);
    for (std::size_t f = 0; f < used; ++f) {
        const ClothFace& face = sim.def.faces[f];
        const int corners[] = {face.a, face.b, face.c, face.d < 0 ? face.a : face.d};
        for (std::size_t c = 0; c < 4; ++c) fabric.faces.corners[c * count + f] = rowOf(index(corners[c]));
        const std::size_t own = face.d < 0 ? 3 : 4;
        for (std::size_t c = 0; c < own; ++c) ofPoint[index(corners[c])].push_back(static_cast<std::uint32_t>(f));
        fabric.faces.shares[f] = 1 / static_cast<float>(own);
    }
    fabric.faces.starts.push_back(0);
    for (const auto& list : ofPoint) {
        fabric.faces.ofPoint.insert(fabric.faces.ofPoint.end(), list.begin(), list.end());
        fabric.faces.starts.push_back(static_cast<std::uint32_t>(fabric.faces.ofPoint.size()));
    }
    fabric.faces.air.resize(count, {});
    sim.faces.count = static_cast<int>(count);
}

void pointToAll(ClothSim& sim) {
    Fabric& fabric = sim.fabric;
    ClothArrays& a = sim.arrays;
    const std::size_t rows = sim.state.points.size(), faces = index(sim.faces.count);
    a.points = sim.state.points.data();
    a.before = sim.state.before.data();
    a.velocities = sim.state.velocities.data();
    a.ties = sim.state.ties.data();
    a.pointCount = static_cast<int>(rows);
    a.chains = fabric.chains.data();
    a.strips = fabric.strips.data();
    a.chainTied = sim.around.tied.data();
    a.stripTied = sim.around.tied.data() + fabric.chains.size();
    a.rows = fabric.rows.data();
    a.links.lengths = fabric.links.lengths.data();
    a.links.inverseLengths = fabric.links.inverseLengths.data();
    a.links.compliances = fabric.links.compliances.data();
    const auto isNone = [](float x) { return x == 0; };
    if (!std::all_of(fabric.links.bendStiffness.begin(), fabric.links.bendStiffness.end(), isNone))
        a.links.bendStiffness = fabric.links.bendStiffness.data();
    if (!std::all_of(fabric.links.bendLengths.begin(), fabric.links.bendLengths.end(), isNone))
        a.links.bendLengths = fabric.links.bendLengths.data();
    a.quads.stiffness = fabric.quads.stiffness.data();
    a.quads.rests = fabric.quads.rests.data();
    a.reactions = fabric.reactions.data();
    a.scratch = fabric.scratch.data();
    a.keeps = fabric.keeps.data();
    a.kicks = fabric.kicks.data();
    a.air = fabric.faces.pointAir.data();
    a.inverseMasses = fabric.inverseMasses.data();
    a.tethers.anchors = fabric.tethers.anchors.data();
    a.tethers.lengths = fabric.tethers.lengths.data();
    for (std::size_t axis = 0; axis < 3; ++axis) a.tethers.pulls[axis] = fabric.tethers.pulls.data() + axis * rows;
    sim.faces.air = fabric.faces.air.data();
    sim.faces.shares = fabric.faces.shares.data();
    for (std::size_t c = 0; c < 4; ++c) sim.faces.corners[c] = fabric.faces.corners.data() + c * faces;
    sim.faces.airDensity = sim.def.airDensity;
    sim.faces.drag = sim.def.drag;
    sim.faces.lift = sim.def.lift;
}

}  // namespace

Fabric::Fabric(std::pmr::memory_resource* memory)
    : inverseMasses(memory),
      rows(memory),
      links(memory),
      quads(memory),
      tethers(memory),
      faces(memory),
      reactions(memory),
      scratch(memory),
      keeps(memory),
      kicks(memory) {}

void build(ClothSim& sim, const Pose& pose) {
    sim.count = static_cast<int>(sim.def.points.size());
    sim.fabric.kernels = &selectClothKernels(sim.world->lanes());
    const Plan plan = makePlan(sim.def);
    holdPoints(sim, pose);
    placePoints(sim, plan, pose);
    addLayers(sim, plan);
    addTethers(sim, plan);
    addFaces(sim);
    pointToAll(sim);
    sim.around.contactOfPoint.assign(index(sim.count), kNoPoint);
    sim.around.contacts.reserve(index(sim.count));
    sim.around.blocks.resize(sim.state.points.size() / kBlock);
    if (!sim.def.skin.empty()) {
        sim.state.skinFrom.resize(index(sim.count));
        sim.state.skinTo.resize(index(sim.count));
        sim.state.skinNormals.resize(index(sim.count));
    }
    sim.around.named.reserve(64);
    sim.around.bodies.reserve(64);
    sim.around.shapes.reserve(64);
    StateHash hash;
    for (const float mass : plan.masses) hash.add(mass);
    for (const Link& link : plan.links) {
        hash.add(link.a);
        hash.add(link.b);
        hash.add(link.rest);
        hash.add(link.stiffness);
    }
    for (const int held : sim.fabric.heldOfPoint) hash.add(held);
    hash.add(sim.def.skin.empty());
    sim.digest = hash.value();
}

}  // namespace ragtop::cloth
