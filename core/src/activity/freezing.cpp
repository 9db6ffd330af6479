// Bodies that rest on what does not move are frozen. The iteration would find the same impulses for them in every step;
// they are left out of the solver, with the impulses that hold them, until anything changes.

#include "activity/activity.h"
#include "base/economy.h"
#include "constraints/lane_view.h"
#include "contacts/surfaces.h"

namespace ragtop {

namespace {

/// Speed over what gravity gives in a substep, below which a body may rest.
constexpr float kStill = 1e-3f;
/// For so many steps. What begins to slide or to fall is faster by then unless its acceleration is below
/// kStill/(substeps · steps) of gravity, 2e-5.
constexpr int kStillSteps = 16;

/// Does anything but its contacts move the body?
bool isDisturbed(const Activity& a, std::uint32_t index) {
    const BodyRecord& body = a.bodies[index];
    const BodyState& state = a.bodies.states[index];
    return body.force != Vec3{} || body.torque != Vec3{} || (body.frozen && (state.v != Vec3{} || state.w != Vec3{}));
}

/// Is the body held by contacts with what never moves alone, none of which slides, rolls or carries it on?
bool restsOnFixed(const Activity& a, const ModuleWork& moduleWork, std::uint32_t index) {
    const BodyRecord& body = a.bodies[index];
    if (!a.bodies.moves(index) || a.bodies.isDirect(index) || body.firstJoint != kNone) return false;
    if (isDisturbed(a, index) || moduleWork.actsOn(index)) return false;
    bool loaded = false;
    for (std::uint32_t key = body.firstContact; key != kNone; key = a.contacts.next(key)) {
        const ContactRecord& record = a.contacts[key >> 1];
        if (!record.hasPoints || record.sensor) continue;
        const std::uint32_t other = (key & 1) != 0 ? record.bodyA : record.bodyB;
        if (a.bodies[other].type != BodyType::fixed || turnsUnderContact(a.shapes, record)) return false;
        for (const ManifoldRecord& manifold : a.manifolds.of(record)) {
            if (manifold.pointCount == 0) continue;
            if (!ConstraintGraph::isIterated(static_cast<int>(manifold.place.color))) return false;
            const LaneReader lane(a.graph.lane(manifold.place), a.graph.lanes());
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
void moveContactsOf(const Activity& a, std::uint32_t index, ConstraintGraph::By by) {
    const bool frozen = by == ConstraintGraph::By::none;
    for (std::uint32_t key = a.bodies[index].firstContact; key != kNone; key = a.contacts.next(key)) {
        const ContactRecord& record = a.contacts[key >> 1];
        Manifolds::forEach(record, [&](std::uint32_t k) {
            ManifoldRecord& manifold = a.manifolds[k];
            const GraphPlace from = manifold.place;
            if (from.color == kNone || (from.color == ConstraintGraph::kFrozen) == frozen) return;
            std::uint32_t tookOver = kNone;
            manifold.place = a.graph.moveContact(from, a.bodies[record.bodyA].state, a.bodies.moves(record.bodyA),
                                                     a.bodies[record.bodyB].state, a.bodies.moves(record.bodyB), by, tookOver);
            if (tookOver != kNone) a.manifolds[tookOver].place.slot = from.slot;
            a.manifolds.touches[k] = frozen ? kFrozenTouch : kUnknownTouch;
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

void Activity::freezeStillBodies(Freezing& freezing, const ModuleWork& moduleWork, bool mayFreeze) const {
    if (!freezing.anyStill.exchange(false, std::memory_order_relaxed) || !mayFreeze || !economy.freezing) return;
    for (const std::uint32_t index : bodies.awake) {
        BodyRecord& body = bodies[index];
        if (body.stillSteps < kStillSteps || body.frozen) continue;
        body.stillSteps = 0;
        if (!restsOnFixed(*this, moduleWork, index)) continue;
        bodies.stop(index);
        moveContactsOf(*this, index, ConstraintGraph::By::none);
        body.frozen = true;
    }
}

void Activity::unfreeze(std::uint32_t index) const {
    if (!bodies[index].frozen) return;
    bodies[index].frozen = false;
    bodies[index].stillSteps = 0;
    moveContactsOf(*this, index, ConstraintGraph::By::iteration);
}

void Activity::collectSolved(Freezing& freezing, const ModuleWork& moduleWork, bool mayFreeze) const {
    freezing.solved = {bodies.awake.data(), bodies.awake.size()};
    if (graph.color(ConstraintGraph::kFrozen).manifolds.empty()) return;
    const bool may = mayFreeze && economy.freezing;
    freezing.unfrozen.clear();
    for (const std::uint32_t index : bodies.awake) {
        if (!may || bodies.isDirect(index) || isDisturbed(*this, index) || moduleWork.actsOn(index)) unfreeze(index);
        if (!bodies[index].frozen) freezing.unfrozen.push(index);
    }
    freezing.solved = {freezing.unfrozen.data(), freezing.unfrozen.size()};
}

}  // namespace ragtop
