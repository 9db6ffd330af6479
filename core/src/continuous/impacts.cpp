#include <cmath>

#include "contacts/tuning.h"
#include "continuous/continuous.h"

/// Impacts that a sweep finds, solved on their own: two bodies, the points at which they touch, Coulomb friction.
namespace ragtop {

namespace {

constexpr int kImpactIterations = 16;  ///< over at most four points, by trial

struct Velocity {
    Vec3 v, w;
};

Vec3 inverseMassOf(const BodyState& state) {
    const float m = state.invMass;
    return {(state.locks & 1u) != 0 ? 0 : m, (state.locks & 2u) != 0 ? 0 : m, (state.locks & 4u) != 0 ? 0 : m};
}

/// One side of an impact; without mass it goes on as it does.
struct Side {
    Vec3 inverseMass;  ///< per world axis: locks hold
    BodyInertia inertia;
    Vec3 arm[kMaxManifoldPoints];  ///< m, from its centre to the points

    void apply(Velocity& velocity, int point, const Vec3& impulse) const {
        velocity.v += scale(inverseMass, impulse);
        velocity.w += inertia * cross(arm[point], impulse);
    }
    Vec3 response(int point, const Vec3& direction) const {
        return scale(inverseMass, direction) + cross(inertia * cross(arm[point], direction), arm[point]);
    }
    Vec3 speed(const Velocity& velocity, int point) const { return velocity.v + cross(velocity.w, arm[point]); }
};

struct Impact {
    Side a, b;
    Vec3 normal;  ///< from A to B
    int points = 0;
    ContactSurface surface;
    float threshold = 0;                  ///< m/s, slowest that bounces
    float room[kMaxManifoldPoints] = {};  ///< m/s, at which a point may approach: it is apart as yet

    Vec3 slip(const Velocity& ofA, const Velocity& ofB, int point) const {
        return b.speed(ofB, point) - a.speed(ofA, point);
    }
    /// Impulses that take the approach away, or turn it back, and what friction that allows. Returns Σ λn.
    float solve(Velocity& ofA, Velocity& ofB) const;
};

float Impact::solve(Velocity& ofA, Velocity& ofB) const {
    float wanted[kMaxManifoldPoints] = {}, normals[kMaxManifoldPoints] = {}, total = 0;
    float stiffness[kMaxManifoldPoints] = {};
    Vec3 frictions[kMaxManifoldPoints];
    for (int j = 0; j < points; ++j) {
        const float approach = dot(normal, slip(ofA, ofB, j));
        const bool bounces = surface.restitution > 0 && room[j] == 0 && approach < -threshold;
        wanted[j] = bounces ? -surface.restitution * approach : -room[j];
        const Vec3 t = perpendicular(normal), u = cross(normal, t);
        stiffness[j] = dot(t, a.response(j, t) + b.response(j, t)) + dot(u, a.response(j, u) + b.response(j, u));
    }
    const auto add = [&](int j, const Vec3& impulse) {
        a.apply(ofA, j, -impulse);
        b.apply(ofB, j, impulse);
    };
    for (int iteration = 0; iteration < kImpactIterations; ++iteration)
        for (int j = 0; j < points; ++j) {
            const float k = dot(normal, a.response(j, normal) + b.response(j, normal));
            if (!(k > 0)) continue;
            const float change = (wanted[j] - dot(normal, slip(ofA, ofB, j))) / k;
            const float impulse = normals[j] + change > 0 ? normals[j] + change : 0.0f;
            add(j, (impulse - normals[j]) * normal);
            normals[j] = impulse;

            // Projected descent: no step is longer than the stiffest direction of the plane allows, or it could gain
            // energy.
            Vec3 tangential = slip(ofA, ofB, j) + surface.surfaceVelocity;
            tangential -= dot(tangential, normal) * normal;
            if (!(stiffness[j] > 0)) continue;
            Vec3 friction = frictions[j] - (1 / stiffness[j]) * tangential;
            const float limit = surface.friction * impulse, size = length(friction);
            if (size > limit) friction *= limit / size;
            add(j, friction - frictions[j]);
            frictions[j] = friction;
        }
    for (int j = 0; j < points; ++j) total += normals[j];
    return total;
}

/// A velocity that an impact gives at the end of a step; locks hold, and the position map does not take it for smooth.
void changeVelocity(Bodies& bodies, std::uint32_t index, const Vec3& linear, const Vec3& angular) {
    BodyState& state = bodies.states[index];
    const Vec3 before = state.v;
    state.v = linear;
    state.w = angular;
    bodies.obeyLocks(index);
    bodies.histories[index].velocityBefore += state.v - before;
}

/// Kept for the events of this step: the contact itself may be over by its end.
void recordImpact(const PairSet& pairs, SweepTarget target, const Meeting& meeting, const Vec3& normal,
                  const Pose& place, float speed, float impulse) {
    const std::uint32_t* contact = pairs.find(pairKey(meeting.obstacle, meeting.shape));
    if (!contact || impulse <= 0) return;
    ContactRecord& record = target.contacts[*contact];
    record.struck = true;
    const bool inOrder = record.shapeA == meeting.obstacle;
    target.swept.impacts.push({*contact, meeting.touch.triangle,
                               transformPoint(place, meeting.touch.points[0].position), inOrder ? normal : -normal,
                               speed, impulse});
}

/// Of a shape, `left` seconds before the end of the step, on an obstacle that is at a place with its body.
Impact impactOf(const SweepTarget& target, const ShapeRecord& shape, const Meeting& meeting, const Pose& now,
                const ShapeRecord& obstacle, const Pose& otherNow, float left) {
    const Bodies& bodies = target.bodies;
    const Pose place = otherNow * obstacle.frame;
    Impact impact;
    impact.normal = rotate(place.rotation, meeting.touch.normal);
    impact.points = meeting.touch.pointCount;
    impact.b.inverseMass = inverseMassOf(bodies.states[shape.body]);
    impact.b.inertia = bodies.inverseInertiaAt(shape.body, now.rotation);
    if (bodies.moves(obstacle.body)) {
        impact.a.inverseMass = inverseMassOf(bodies.states[obstacle.body]);
        impact.a.inertia = bodies.inverseInertiaAt(obstacle.body, otherNow.rotation);
    }
    const float rate = left > 0 ? 1 / left : 0.0f;
    const float apart = 0.5f * tuning::kSpeculative * shape.size;  // more than the distance that a sweep keeps
    for (int j = 0; j < impact.points; ++j) {
        const ManifoldPoint& point = meeting.touch.points[j];
        const DVec3 at = transformPoint(place, point.position);
        impact.a.arm[j] = relative(at, otherNow.position);
        impact.b.arm[j] = relative(at, now.position);
        impact.room[j] = point.separation > apart ? rate * point.separation : 0.0f;
    }
    return impact;
}

}  // namespace

bool solveMeeting(const SweepView& view, const ImpactRules& rules, SweepTarget target, std::uint32_t index,
                  const Meeting& meeting, float done, Quat& velocityAt, SweptPath& path) {
    const Shapes& shapes = view.tables.shapes;
    Bodies& bodies = target.bodies;
    const ShapeRecord &shape = shapes[meeting.shape], &obstacle = shapes[meeting.obstacle];
    const std::uint32_t other = obstacle.body;
    const bool pushes = bodies.moves(other);
    // A sleeper is woken by its contact in the next step, which then has the whole impact.
    if (pushes && !bodies.isAwake(other)) return false;
    bodies.turnVelocity(index, velocityAt, path.from.rotation);
    velocityAt = path.from.rotation;

    const SweptPath others = pathOfStep(view, other);
    const Pose otherNow = others.at(done), place = otherNow * obstacle.frame;
    const float left = (1 - done) * view.dt, rate = left > 0 ? 1 / left : 0.0f;
    Impact impact = impactOf(target, shape, meeting, path.from, obstacle, otherNow, left);
    impact.surface = rules.surfaceOf(meeting);
    impact.threshold = rules.restitutionSpeed;

    const float whole = 1 / view.dt;
    Velocity meanA{whole * others.way, whole * others.turn}, meanB{rate * path.way, rate * path.turn};
    const Velocity beforeA = meanA;
    float approach = 0;
    for (int j = 0; j < impact.points; ++j) {
        const float speed = -dot(impact.normal, impact.slip(meanA, meanB, j));
        if (impact.room[j] == 0 && speed > approach) approach = speed;
    }
    impact.solve(meanA, meanB);
    path.way = left * meanB.v;
    path.turn = left * meanB.w;
    Velocity lastA =
        bodies[other].type == BodyType::fixed ? Velocity{} : Velocity{bodies.states[other].v, bodies.states[other].w};
    Velocity lastB{bodies.states[index].v, bodies.states[index].w};
    const float impulse = impact.solve(lastA, lastB);
    changeVelocity(bodies, index, lastB.v, lastB.w);
    recordImpact(view.broadphase.pairs, target, meeting, impact.normal, place, approach, impulse);
    if (pushes) {
        changeVelocity(bodies, other, lastA.v, lastA.w);
        const SweptPath gained{
            {bodies[other].center, bodies[other].rotation}, left * (meanA.v - beforeA.v), left * (meanA.w - beforeA.w)};
        const Pose end = gained.at(1);
        bodies[other].center = end.position;
        bodies[other].rotation = end.rotation;
        bodies.refreshInertia(other);
        BodyFlag& flag = target.swept.flags[bodies[other].awakeIndex];
        if (flag == kFastClear) flag = kToSweep;  // it goes another way now
    }
    return true;
}

}  // namespace ragtop
