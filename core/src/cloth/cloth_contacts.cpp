// Points against bodies in a substep. A point that a surface stops goes on with the body along the normal while lengths
// are solved: both share what pulls them there by their masses. Each of n points on a body has an n-th of it [Tonge et al.
// 2012], so that what one gives counts for all and the sum of impulses is that of the body.

#include <algorithm>
#include <cmath>

#include "cloth/cloth_sim.h"

namespace ragtop::cloth {
namespace {

/// (M⁻¹ + (r × n)ᵀ I⁻¹ (r × n))
float inverseMassAlong(const NearBody& body, const Vec3& arm, const Vec3& n) {
    const Vec3 turning = cross(arm, n);
    return body.inverseMass + dot(turning, body.inverseInertia * turning);
}

void give(NearBody& body, const Vec3& arm, const Vec3& impulse) {
    body.push += impulse;
    body.spin += cross(arm, impulse);
}

void begin(NearBody& body) {
    body.push = body.spin = body.movedMore = body.turnedMore = {};
    body.contacts = body.held = 0;
}

void turnInertia(NearBody& body) {
    const Mat3 turn = toMat3(body.pose.rotation);
    body.inverseInertia = turn * body.inverseInertiaBody * transpose(turn);
}

/// Notes the deepest contact of each point: where any of N end too near, all of them are looked at.
void noteContacts(ClothSim& sim, std::uint32_t number, std::span<const std::uint32_t> hits) {
    Surroundings& around = sim.around;
    const NearShape& shape = around.shapes[number];
    const auto lanes = static_cast<std::uint32_t>(sim.fabric.kernels->lanes);
    for (const std::uint32_t first : hits)
        for (std::uint32_t i = first; i < first + lanes; ++i) {
            const float* result = around.results.data() + (shape.firstPair + i) / kPairs * kPairFloats + i % kPairs;
            const float end = result[kPairs];
            const std::uint32_t point = around.pairs[shape.firstPair + i] / kRowBytes;
            if (!(end < sim.def.thickness) || !(sim.state.points[point].inverseMass > 0)) continue;
            PointContact contact;
            contact.point = point;
            contact.shape = number;
            contact.normal = {result[2 * kPairs], result[3 * kPairs], result[4 * kPairs]};
            contact.gap = result[0];
            contact.end = end;
            int& known = around.contactOfPoint[point];
            if (known == kNoPoint) {
                known = static_cast<int>(around.contacts.size());
                around.contacts.push_back(contact);
            } else if (end < around.contacts[index(known)].end) {
                around.contacts[index(known)] = contact;
            }
        }
}

/// s = n w/√(w + w_b), the root of w − w of both.
void tie(ClothSim& sim, const PointContact& contact, float w, float both) {
    sim.state.ties[contact.point].held = (w / std::sqrt(both)) * contact.normal;
    const std::vector<std::uint32_t>& starts = sim.fabric.bundleStarts;
    for (std::uint32_t k = starts[contact.point]; k < starts[contact.point + 1]; ++k)
        sim.around.tied[sim.fabric.bundlesOfPoint[k]] = 1;
}

/// Moves a point out of what it is in already, which gives it no speed; then stops it, and ties it to the body.
void press(ClothSim& sim, PointContact& contact) {
    PointRow& point = sim.state.points[contact.point];
    Vec3& before = sim.state.before[contact.point].place;
    const NearBody& body = sim.around.bodies[sim.around.shapes[contact.shape].body];
    const float overlap = std::max(0.0f, sim.def.thickness - contact.gap);
    // No more than the thickness at once, so that what was made inside a body leaves it without tearing at the rest.
    const float out = std::min(overlap, sim.def.thickness);
    point.place += out * contact.normal;
    before += out * contact.normal;
    contact.arm = before - body.center - sim.def.thickness * contact.normal;
    contact.shareOfBody = body.inverseMass > 0
                              ? static_cast<float>(body.contacts) * inverseMassAlong(body, contact.arm, contact.normal)
                              : 0;
    const float room = std::max(0.0f, contact.gap - sim.def.thickness);
    const float over = std::max(0.0f, (contact.gap - contact.end) - room);
    const float both = point.inverseMass + contact.shareOfBody;
    contact.impulse = over / both;
    point.place += (point.inverseMass * contact.impulse) * contact.normal;
    if (sim.state.leaves[contact.point] == 0) tie(sim, contact, point.inverseMass, both);
}

/// What the contact bears in all. A point that lengths pull off is held until the end of the substep, because what they
/// gave it was for the mass of both; in the next it is free to go.
void bear(ClothSim& sim, PointContact& contact, float inverseH) {
    std::uint8_t& leaves = sim.state.leaves[contact.point];
    NearBody& body = sim.around.bodies[sim.around.shapes[contact.shape].body];
    const float both = sim.state.points[contact.point].inverseMass + contact.shareOfBody;
    // Where the point is along the normal, over where the body would be without the cloth.
    contact.lead = -contact.shareOfBody * contact.impulse;
    if (leaves == 0) {
        // pull = s · f with s = n w/√both; of n · f the body takes w/both.
        const float pull = sim.state.ties[contact.point].pull / std::sqrt(both);
        contact.lead += contact.shareOfBody * pull;
        contact.impulse -= pull;
    }
    sim.state.ties[contact.point] = {};
    leaves = contact.impulse > 0 ? 0 : 1;
    give(body, contact.arm, (-inverseH * contact.impulse) * contact.normal);
}

/// The velocity of a point of the body times h, without what the cloth gives it.
Vec3 movedBy(const NearBody& body, const Vec3& arm) { return body.linear + cross(body.angular, arm); }

/// Puts the point where the body as a whole goes, of which it had but a share, and rubs.
void settle(ClothSim& sim, const PointContact& contact, float inverseH) {
    PointRow& point = sim.state.points[contact.point];
    const NearShape& shape = sim.around.shapes[contact.shape];
    NearBody& body = sim.around.bodies[shape.body];
    Vec3 given;  // N s², to the point
    const float shift = dot(contact.normal, cross(body.turnedMore, contact.arm) + body.movedMore) - contact.lead;
    if (shift > 0 || contact.impulse > 0) {
        point.place += shift * contact.normal;
        given = (sim.fabric.masses[contact.point] * shift) * contact.normal;
    }
    const Vec3 slip = point.place - sim.state.before[contact.point].place - movedBy(body, contact.arm) -
                      body.movedMore - cross(body.turnedMore, contact.arm);
    const Vec3 aside = slip - dot(slip, contact.normal) * contact.normal;
    const float distance = length(aside);
    if (distance > 0 && contact.impulse > 0 && shape.friction > 0) {
        const Vec3 t = (1 / distance) * aside;
        const float share = body.inverseMass > 0
                                ? static_cast<float>(body.contacts) * inverseMassAlong(body, contact.arm, t)
                                : 0;
        const float rub = std::min(shape.friction * contact.impulse, distance / (point.inverseMass + share));
        point.place -= (point.inverseMass * rub) * t;
        given -= rub * t;
    }
    give(body, contact.arm, -inverseH * given);
}

/// The body that yields to what pulls at a held point; null where none does.
NearBody* yielding(ClothSim& sim, const HeldPoint& held) {
    if (held.id.isNull() || !(sim.around.bodies[held.body].inverseMass > 0)) return nullptr;
    return &sim.around.bodies[held.body];
}

void pull(ClothSim& sim, const HeldPoint& held, const Vec3& impulse) {
    if (NearBody* body = yielding(sim, held))
        give(*body, sim.state.before[index(held.point)].place - body->center, impulse);
}

/// What lengths and tethers pulled at points that bodies hold.
void pullAtBodies(ClothSim& sim, float inverseH) {
    if (!sim.arrays.yields) return;
    const auto lanes = index(sim.fabric.kernels->lanes);
    for (const HeldPosition& position : sim.fabric.heldPositions) {
        float* f = sim.fabric.reactions.data() + position.reaction;
        pull(sim, sim.state.held[index(position.held)], inverseH * Vec3{f[0], f[lanes], f[2 * lanes]});
        f[0] = f[lanes] = f[2 * lanes] = 0;
    }
    for (std::size_t i = 0; i < sim.fabric.tethers.anchoredAt.size(); ++i) {
        const Vec3 f{sim.arrays.tethers.pulls[0][i], sim.arrays.tethers.pulls[1][i], sim.arrays.tethers.pulls[2][i]};
        if (f == Vec3{}) continue;
        pull(sim, sim.state.held[index(sim.fabric.tethers.anchoredAt[i])], inverseH * f);
    }
}

}  // namespace

void readBodies(ClothSim& sim, float h) {
    const World& world = *sim.world;
    for (NearBody& body : sim.around.bodies) {
        const Pose pose = world.pose(body.id);
        body.pose = {relative(pose.position, sim.state.origin), pose.rotation};
        body.center = relative(world.centerOfMass(body.id), sim.state.origin);
        body.centerBody = inverseRotate(body.pose.rotation, body.center - body.pose.position);
        body.pushed = body.spun = {};
        begin(body);
        body.linear = body.angular = {};
        if (body.type == BodyType::fixed) continue;
        body.linear = h * world.linearVelocity(body.id);
        body.angular = h * world.angularVelocity(body.id);
        if (body.type != BodyType::dynamic) continue;
        body.linear += (h * h * body.gravityScale) * world.settings().gravity;
        turnInertia(body);
    }
}

void findContacts(ClothSim& sim) {
    Surroundings& around = sim.around;
    around.contacts.clear();
    std::fill(around.tied.begin(), around.tied.end(), std::uint8_t{0});
    for (std::uint32_t i = 0; i < around.shapes.size(); ++i) {
        NearShape& shape = around.shapes[i];
        const NearBody& body = around.bodies[shape.body];
        const Frame at = body.pose * shape.frame;
        shape.surface.position = at.position;
        shape.surface.rotation = at.rotation;
        shape.surface.center = body.center;
        shape.surface.linear = body.linear;
        shape.surface.angular = body.angular;
        const Meeting meeting{around.pairs.data() + shape.firstPair, static_cast<int>(shape.pairs), sim.def.thickness,
                              around.results.data() + shape.firstPair / kPairs * kPairFloats, around.hits.data()};
        const int hits = sim.fabric.kernels->meet(sim.arrays, shape.surface, meeting);
        noteContacts(sim, i, {around.hits.data(), index(hits)});
    }
    for (const PointContact& contact : around.contacts) {
        around.contactOfPoint[contact.point] = kNoPoint;
        ++around.bodies[around.shapes[contact.shape].body].contacts;
    }
    for (PointContact& contact : around.contacts) press(sim, contact);
}

void endContacts(ClothSim& sim, float inverseH) {
    for (PointContact& contact : sim.around.contacts) bear(sim, contact, inverseH);
    pullAtBodies(sim, inverseH);
    for (NearBody& body : sim.around.bodies) {
        body.movedMore = (body.inverseMass / inverseH) * body.push;
        body.turnedMore = (1 / inverseH) * (body.inverseInertia * body.spin);
    }
    for (const PointContact& contact : sim.around.contacts) settle(sim, contact, inverseH);
}

void advanceBodies(ClothSim& sim, float h) {
    for (NearBody& body : sim.around.bodies) {
        if (body.type == BodyType::fixed) continue;
        body.pushed += body.push;
        body.spun += body.spin;
        const Vec3 arm = body.pose.position - body.center;
        body.angular += body.turnedMore;
        const float angle = length(body.angular);
        const Quat turn = angle > 0 ? rotationAbout(body.angular, angle) : Quat{};
        body.center += body.linear + body.movedMore;
        body.pose = {body.center + rotate(turn, arm), normalized(turn * body.pose.rotation)};
        body.linear += body.movedMore;
        if (body.type == BodyType::dynamic) {
            body.linear += (h * h * body.gravityScale) * sim.world->settings().gravity;
            turnInertia(body);
        }
        begin(body);
    }
}

void pushBodies(ClothSim& sim) {
    for (const NearBody& body : sim.around.bodies) {
        const Vec3 push = body.pushed + body.push, spin = body.spun + body.spin;
        if (body.type != BodyType::dynamic || (push == Vec3{} && spin == Vec3{})) continue;
        sim.world->applyImpulse(body.id, push, sim.world->centerOfMass(body.id));
        sim.world->applyAngularImpulse(body.id, spin);
    }
}

}  // namespace ragtop::cloth
