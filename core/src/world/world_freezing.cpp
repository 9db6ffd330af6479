// Bodies that rest on what does not move are frozen. The iteration would find the same impulses for them in every step;
// they are left out of the solver, with the impulses that hold them, until anything changes.

#include "base/economy.h"
#include "constraints/lane_view.h"
#include "contacts/surfaces.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// Speed over what gravity gives in a substep, below which a body may rest.
constexpr float kStill = 1e-3f;
/// For so many steps. What begins to slide or to fall is faster by then unless its acceleration is below
/// kStill/(substeps · steps) of gravity, 2e-5.
constexpr int kStillSteps = 16;

/// What is told of every contact expects all of them.
bool mayFreeze(const WorldImpl& world) { return economy.freezing && !world.callbacks.modify; }

/// Does anything but its contacts move the body?
bool isDisturbed(const WorldImpl& world, std::uint32_t index) {
    const BodyRecord& body = world.bodies[index];
    const BodyState& state = world.bodies.states[index];
    return body.force != Vec3{} || body.torque != Vec3{} || (body.frozen && (state.v != Vec3{} || state.w != Vec3{}));
}

/// Is the body held by contacts with what never moves alone, none of which slides, rolls or carries it on?
bool restsOnFixed(const WorldImpl& world, std::uint32_t index) {
    const BodyRecord& body = world.bodies[index];
    if (!world.bodies.moves(index) || world.bodies.isDirect(index) || body.firstJoint != kNone) return false;
    if (isDisturbed(world, index) || world.moduleWork.actsOn(index)) return false;
    bool loaded = false;
    for (std::uint32_t key = body.firstContact; key != kNone; key = world.contacts.next(key)) {
        const ContactRecord& record = world.contacts[key >> 1];
        if (!record.hasPoints || record.sensor) continue;
        const std::uint32_t other = (key & 1) != 0 ? record.bodyA : record.bodyB;
        if (world.bodies[other].type != BodyType::fixed || turnsUnderContact(world.shapes, record)) return false;
        for (const ManifoldRecord& manifold : world.manifolds.of(record)) {
            if (manifold.pointCount == 0) continue;
            if (!ConstraintGraph::isIterated(manifold.place)) return false;
            const LaneReader lane(world.graph.lane(manifold.place), world.graph.lanes());
            if (lane.vector(contact::kSurface) != Vec3{} || lane.at(contact::kShifted) > 0) return false;
            bool bears = false;
            for (int j = 0; j < manifold.pointCount; ++j) bears |= lane.at(j, contact::kImpulse) > 0;
            if (bears && lane.at(contact::kSliding) > 0) return false;
            loaded |= bears;
        }
    }
    return loaded;
}

/// Puts all contacts of a body into the list of those that rest, or back.
void moveContactsOf(WorldImpl& world, std::uint32_t index, ConstraintGraph::By by) {
    const bool frozen = by == ConstraintGraph::By::none;
    for (std::uint32_t key = world.bodies[index].firstContact; key != kNone; key = world.contacts.next(key)) {
        const ContactRecord& record = world.contacts[key >> 1];
        Manifolds::forEach(record, [&](std::uint32_t k) {
            ManifoldRecord& manifold = world.manifolds[k];
            const GraphPlace from = manifold.place;
            if (from.color == kNone || (from.color == ConstraintGraph::kFrozen) == frozen) return;
            const std::uint32_t a = record.bodyA, b = record.bodyB;
            std::uint32_t tookOver = kNone;
            manifold.place = world.graph.moveContact(from, world.bodies[a].state, world.bodies.moves(a),
                                                     world.bodies[b].state, world.bodies.moves(b), by, tookOver);
            if (tookOver != kNone) world.manifolds[tookOver].place.slot = from.slot;
            world.manifolds.touches[k] = frozen ? kFrozenTouch : kUnknownTouch;
        });
    }
}

}  // namespace

float Freezing::slowest(float gravityStep) { return kStill * gravityStep; }

void Freezing::record(BodyRecord& body, bool slow) {
    const int steps = slow ? body.stillSteps + 1 : 0;
    body.stillSteps = static_cast<std::uint8_t>(steps < kStillSteps ? steps : kStillSteps) & 31u;
    if (body.stillSteps == kStillSteps && !body.frozen) anyStill.store(true, std::memory_order_relaxed);
}

/// Bodies that have been still for long enough come to rest where they are.
void WorldImpl::freezeStillBodies() {
    if (!freezing.anyStill.exchange(false, std::memory_order_relaxed) || !mayFreeze(*this)) return;
    for (const std::uint32_t index : bodies.awake) {
        BodyRecord& body = bodies[index];
        if (body.stillSteps < kStillSteps || body.frozen) continue;
        body.stillSteps = 0;
        if (!restsOnFixed(*this, index)) continue;
        bodies.stop(index);
        moveContactsOf(*this, index, ConstraintGraph::By::none);
        body.frozen = true;
    }
}

/// Something has changed about a body that rests: it is solved again.
void WorldImpl::unfreeze(std::uint32_t index) {
    if (!bodies[index].frozen) return;
    bodies[index].frozen = false;
    bodies[index].stillSteps = 0;
    moveContactsOf(*this, index, ConstraintGraph::By::iteration);
}

/// The bodies that this step solves.
void WorldImpl::collectSolved() {
    freezing.solved = {bodies.awake.data(), bodies.awake.size()};
    if (graph.color(ConstraintGraph::kFrozen).manifolds.empty()) return;
    const bool may = mayFreeze(*this);
    freezing.unfrozen.clear();
    for (const std::uint32_t index : bodies.awake) {
        if (!may || bodies.isDirect(index) || isDisturbed(*this, index) || moduleWork.actsOn(index)) unfreeze(index);
        if (!bodies[index].frozen) freezing.unfrozen.push(index);
    }
    freezing.solved = {freezing.unfrozen.data(), freezing.unfrozen.size()};
}

}  // namespace ragtop
