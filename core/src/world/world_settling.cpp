// Loads of contacts that were just made between bodies at rest, so that what was built does not sink before it stands;
// and velocities of bodies that were just joined.

#include <cmath>

#include "constraints/contact_layout.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

constexpr int kIterations = 16;    ///< that make estimated loads an equilibrium; what is left of their error is local

constexpr int kJointIterations = 32;  ///< a bound; ends when all fit

}  // namespace

/// Bodies that a joint was just made for lose at once what their velocities have that it does not allow, as in an
/// impact. The soft rows would let some of it open the joint first, and closing it again gives energy to what the joint
/// bears.
void WorldImpl::settleNewJoints() {
    for (const std::uint32_t j : joints.created)
        if (j != kNone)
            placeJoint(joints.sims[j], jointBodies(joints[j]), bodies.states.data(), bodies.inertias.data());
    bool fits = false;
    for (int i = 0; i < kJointIterations && !fits; ++i) {
        fits = true;
        for (const std::uint32_t j : joints.created)
            if (j != kNone && fitVelocities(joints.sims[j], bodies.states.data(), bodies.inertias.data())) fits = false;
    }
    for (const std::uint32_t j : joints.created) {
        if (j == kNone) continue;
        recordInitialViolation(j);
        for (const std::uint32_t body : {joints[j].bodyA, joints[j].bodyB})
            if (bodies.moves(body)) bodies.storeMomentum(body);
    }
    joints.created.clear();
}

/// True of what was just made and stands: it has no speed at all, as nothing keeps once it has been stepped.
bool WorldImpl::isUntouched(std::uint32_t body) const {
    const BodyState& state = bodies.states[bodies[body].state];
    return state.v == Vec3{} && state.w == Vec3{};
}

/// The weight that the estimate hands down, in equal shares to the points, for each contact of bodies that have not
/// moved yet and that bears nothing; what pushes today is no weight. Follows measureIslands.
void WorldImpl::loadNewContacts() {
    contactFinds.fresh.clear();
    const float gravity = length(settings.gravity);
    islands.paths.estimate(bodies, gravity, false);
    if (!(gravity > 0)) return;
    const Vec3 down = (1 / gravity) * settings.gravity;
    const auto stride = static_cast<std::size_t>(graph.lanes());
    for (const SupportEdge& edge : islands.paths.edges) {
        if (edge.joint || !isUntouched(edge.a) || !isUntouched(edge.b)) continue;
        const bool aBears = islands.paths.aBears(edge), bBears = islands.paths.bBears(edge);
        if (!aBears && !bBears) continue;
        const ManifoldRecord& manifold = manifolds[edge.constraint];
        const float along = std::fabs(dot(rotate(bodies[edge.a].rotation, manifold.normal), down));
        if (along < kLevel || manifold.pointCount == 0 || manifold.place.color == ConstraintGraph::kDirect) continue;
        float* lane = graph.lane(manifold.place);
        const auto at = [&](int point, int field) -> float& {
            return lane[static_cast<std::size_t>(contact::kPoints + point * contact::kPointFields + field) * stride];
        };
        bool loaded = false;
        for (int j = 0; j < manifold.pointCount; ++j) loaded |= at(j, contact::kImpulse) != 0;
        if (loaded) continue;
        const std::uint32_t upper = aBears ? edge.b : edge.a;
        const float load = islands.paths.shareOf(bodies, upper);
        const float share = load * context.gravityStep * along / static_cast<float>(manifold.pointCount);
        for (int j = 0; j < manifold.pointCount; ++j) at(j, contact::kImpulse) = at(j, contact::kLoad) = share;
        contactFinds.fresh.push(edge.constraint);
    }
}

/// Adds a share of the velocities that forces and torques, beside gravity, have given in this substep.
void WorldImpl::addPushes(float share) {
    for (const std::uint32_t index : bodies.awake) {
        if (!bodies.moves(index) || bodies.states[index].locks != 0) continue;
        const BodyDynamics& d = bodies.dynamics[index];
        const Vec3 push = d.acceleration - bodies[index].gravityScale * settings.gravity;
        if (push != Vec3{}) bodies.states[index].v += share * context.h * d.linearDecay * push;
        if (d.torque != Vec3{})
            bodies.states[index].w += share * context.h * d.angularDecay * (bodies.inertias[index] * d.torque);
    }
}

/// Iterations that move nothing yet make the estimate an equilibrium of weights, which is what these contacts bear from
/// then on.
void WorldImpl::settleNewContacts() {
    if (contactFinds.fresh.empty()) return;
    addPushes(-1);
    for (int i = 0; i < kIterations; ++i) solve(false);
    addPushes(1);
    const auto stride = static_cast<std::size_t>(graph.lanes());
    for (const std::uint32_t m : contactFinds.fresh) {
        float* lane = graph.lane(manifolds[m].place);
        for (int j = 0; j < manifolds[m].pointCount; ++j) {
            float* point = lane + static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields) * stride;
            point[contact::kLoad * stride] = point[contact::kImpulse * stride];
        }
    }
    for (int c = 0; c < graph.listCount(); ++c)
        for (const std::uint32_t m : graph.color(c).manifolds)
            for (int j = 0; j < manifolds[m].pointCount; ++j)
                graph.lane(manifolds[m].place)[static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields +
                                                                        contact::kPeak) *
                                               stride] = 0;
    contactFinds.fresh.clear();
}

}  // namespace ragtop
