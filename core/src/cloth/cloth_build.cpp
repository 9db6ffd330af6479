// From a definition to the layout that kernels run on.

#include <algorithm>
#include <cmath>

#include "base/hash.h"
#include "cloth/cloth_sim.h"

namespace ragtop::cloth {
namespace {

constexpr float kNoBending = 1e20f;  ///< m/N, of points that bend freely
constexpr std::size_t kBlock = 16;  ///< the widest lanes: what all arrays are filled up to

std::size_t roundedUp(std::size_t n) { return (n + kBlock - 1) / kBlock * kBlock; }

/// Rows of points that nothing holds; those beyond the points never move.
void placePoints(ClothSim& sim, const Plan& plan, const Pose& pose) {
    State& state = sim.state;
    state.origin = {std::round(pose.position.x), std::round(pose.position.y), std::round(pose.position.z)};
    const std::size_t rows = roundedUp(index(sim.count) + 1);
    state.points.resize(rows, {});
    state.motions.resize(rows, {});
    sim.fabric.inverseMasses.assign(rows, 0);
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        state.points[i].place = relative(transformPoint(pose, sim.def.points[i]), state.origin);
        const bool isHeld = sim.fabric.heldOfPoint[i] != kNoPoint;
        state.motions[i].mass = isHeld ? 0 : plan.masses[i];
        sim.fabric.inverseMasses[i] = isHeld ? 0 : 1 / plan.masses[i];
        state.points[i].inverseMass = sim.fabric.inverseMasses[i];
    }
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

/// l⁴/(B A) of the point between two links, A the area of faces about it: then ½ C²/α is ½ B κ² A.
float bendCompliance(const ClothDef& def, const Plan& plan, int point, float before, float after) {
    const float l = 0.5f * (before + after), stiffness = def.bending * plan.areas[index(point)];
    return stiffness > 0 ? std::min(kNoBending, l * l * l * l / stiffness) : kNoBending;
}

void addLink(ClothSim& sim, const Plan& plan, const Chain& chain, int k, std::size_t slot) {
    Fabric& fabric = sim.fabric;
    const Link& link = plan.links[index(chain.links[index(k)])];
    fabric.lengths[slot] = link.rest;
    fabric.compliances[slot] = 1 / link.stiffness;
    if (k == 0) return;
    const auto at = [&](int i) { return sim.def.points[index(chain.points[index(i)])]; };
    fabric.bendLengths[slot] = length(at(k - 1) - 2.0f * at(k) + at(k + 1));
    fabric.bendCompliances[slot] = bendCompliance(sim.def, plan, chain.points[index(k)],
                                                  plan.links[index(chain.links[index(k - 1)])].rest, link.rest);
}

/// Chains of a bundle are the lanes; the dummy point and links without length fill it up.
void addBundle(ClothSim& sim, const Plan& plan, std::span<const Chain> chains) {
    Fabric& fabric = sim.fabric;
    const auto lanes = index(fabric.kernels->lanes);
    ChainBundle bundle;
    bundle.firstPoint = static_cast<std::uint32_t>(fabric.numbers.size());
    bundle.firstLink = static_cast<std::uint32_t>(fabric.lengths.size());
    bundle.links = static_cast<std::int32_t>(chains.front().links.size());
    const std::size_t links = index(bundle.links) * lanes;
    fabric.numbers.resize(fabric.numbers.size() + links + lanes, static_cast<std::uint32_t>(sim.count));
    for (AlignedArray<float>* list : {&fabric.lengths, &fabric.bendLengths}) list->resize(bundle.firstLink + links, 0);
    fabric.compliances.resize(bundle.firstLink + links, 1);
    fabric.bendCompliances.resize(bundle.firstLink + links, kNoBending);
    bundle.bends = sim.def.bending > 0 && !chains.front().shears;
    for (std::size_t lane = 0; lane < chains.size(); ++lane) {
        const Chain& chain = chains[lane];
        for (std::size_t k = 0; k < chain.points.size(); ++k) {
            const std::size_t slot = bundle.firstPoint + k * lanes + lane;
            fabric.numbers[slot] = static_cast<std::uint32_t>(chain.points[k]);
            if (fabric.heldOfPoint[index(chain.points[k])] == kNoPoint) continue;
            bundle.reacts = true;
            fabric.heldPositions.push_back(
                {static_cast<std::uint32_t>(3 * (bundle.firstPoint + k * lanes) + lane),
                 fabric.heldOfPoint[index(chain.points[k])]});
        }
        for (int k = 0; k < static_cast<int>(chain.links.size()); ++k)
            addLink(sim, plan, chain, k, bundle.firstLink + index(k) * lanes + lane);
    }
    fabric.bundles.push_back(bundle);
}

void addLayers(ClothSim& sim, const Plan& plan) {
    Fabric& fabric = sim.fabric;
    const auto lanes = index(fabric.kernels->lanes);
    std::size_t longest = 0;
    for (const Layer& layer : plan.layers) {
        const auto begin = static_cast<int>(fabric.bundles.size());
        for (std::size_t i = 0; i < layer.chains.size(); i += lanes)
            addBundle(sim, plan, std::span(layer.chains).subspan(i, std::min(lanes, layer.chains.size() - i)));
        fabric.layers.push_back({begin, static_cast<int>(fabric.bundles.size())});
        longest = std::max(longest, layer.chains.front().links.size());
    }
    constexpr std::size_t kLinkFloats = 20;  // of WideLink, per lane
    fabric.scratch.resize((longest + 1) * kLinkFloats * lanes, 0);
    fabric.reactions.resize(3 * fabric.numbers.size(), 0);
}

void addTethers(ClothSim& sim, const Plan& plan) {
    Fabric& fabric = sim.fabric;
    if (!sim.def.tethers) return;
    constexpr float kSpare = 1.0005f;  // of their length, which paths along links round off
    for (int i = 0; i < sim.count; ++i) {
        const int anchor = plan.anchors[index(i)];
        if (anchor == kNoPoint || fabric.heldOfPoint[index(i)] != kNoPoint) continue;
        fabric.tethered.push(static_cast<std::uint32_t>(i));
        fabric.anchors.push(static_cast<std::uint32_t>(anchor));
        fabric.tetherLengths.push(kSpare * sim.def.tetherSlack * plan.tethers[index(i)]);
    }
    const std::size_t count = roundedUp(fabric.tethered.size());
    const auto dummy = static_cast<std::uint32_t>(sim.count);
    fabric.tethered.resize(count, dummy);
    fabric.anchors.resize(count, dummy);
    fabric.tetherLengths.resize(count, 0);
    fabric.tetherPulls.resize(3 * count, 0);
}

void addFaces(ClothSim& sim) {
    Fabric& fabric = sim.fabric;
    std::vector<std::uint32_t> lists[3];
    const auto add = [&](int a, int b, int c) {
        lists[0].push_back(static_cast<std::uint32_t>(a));
        lists[1].push_back(static_cast<std::uint32_t>(b));
        lists[2].push_back(static_cast<std::uint32_t>(c));
    };
    for (const ClothFace& face : sim.def.faces) {
        add(face.a, face.b, face.c);
        if (face.d >= 0) add(face.a, face.c, face.d);
    }
    const std::size_t used = lists[0].size(), count = roundedUp(used);
    std::vector<std::vector<std::uint32_t>> ofPoint(index(sim.count));
    for (auto& list : lists) {
        for (std::size_t f = 0; f < used; ++f) ofPoint[list[f]].push_back(static_cast<std::uint32_t>(f));
        list.resize(count, static_cast<std::uint32_t>(sim.count));
        for (const std::uint32_t point : list) fabric.corners.push(point);
    }
    fabric.faceStarts.push_back(0);
    for (const auto& list : ofPoint) {
        fabric.facesOfPoint.insert(fabric.facesOfPoint.end(), list.begin(), list.end());
        fabric.faceStarts.push_back(static_cast<std::uint32_t>(fabric.facesOfPoint.size()));
    }
    fabric.faceForces.resize(4 * count, 0);
    sim.faces.count = static_cast<int>(count);
}

void pointToAll(ClothSim& sim) {
    Fabric& fabric = sim.fabric;
    ClothArrays& a = sim.arrays;
    const std::size_t rows = sim.state.points.size(), tethers = fabric.tethered.size(), faces = index(sim.faces.count);
    fabric.drive.resize(4 * rows, 0);
    a.points = sim.state.points.data();
    a.motions = sim.state.motions.data();
    a.pointCount = static_cast<int>(rows);
    a.bundles = fabric.bundles.data();
    a.numbers = fabric.numbers.data();
    a.lengths = fabric.lengths.data();
    a.compliances = fabric.compliances.data();
    a.bendLengths = fabric.bendLengths.data();
    a.bendCompliances = fabric.bendCompliances.data();
    a.reactions = fabric.reactions.data();
    a.scratch = fabric.scratch.data();
    a.tethered = fabric.tethered.data();
    a.anchors = fabric.anchors.data();
    a.tetherLengths = fabric.tetherLengths.data();
    a.tetherCount = static_cast<int>(tethers);
    a.resistance = fabric.drive.data() + 3 * rows;
    sim.faces.resistance = fabric.faceForces.data() + 3 * faces;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        a.drive[axis] = fabric.drive.data() + axis * rows;
        a.tetherPulls[axis] = fabric.tetherPulls.data() + axis * tethers;
        sim.faces.corners[axis] = fabric.corners.data() + axis * faces;
        sim.faces.force[axis] = fabric.faceForces.data() + axis * faces;
    }
    sim.faces.airDensity = sim.def.airDensity;
    sim.faces.drag = sim.def.drag;
    sim.faces.lift = sim.def.lift;
}

}  // namespace

Fabric::Fabric(std::pmr::memory_resource* memory)
    : numbers(memory), lengths(memory), compliances(memory), bendLengths(memory), bendCompliances(memory),
      reactions(memory), scratch(memory), tethered(memory), anchors(memory), tetherLengths(memory), tetherPulls(memory),
      corners(memory), faceForces(memory), drive(memory) {}

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
