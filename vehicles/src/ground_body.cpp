#include "ground_body.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr std::size_t kMaxSupports = 16;
constexpr float kGrowth = 2;       ///< of what a support bears, from step to step
constexpr float kUntried = 0.5f;   ///< m/s that a support may stop of the body before it has borne anything
constexpr float kThrough = 0.25f;  ///< of the speed that a support should have stopped: what shows that it is none

float inverseOrZero(float x) { return x > 0 ? 1 / x : 0; }

float frictionBetween(const World& world, const Contact& contact) {
    const Material a = world.material(contact.shapeA), b = world.material(contact.shapeB);
    return combined(a.frictionRule, a.friction, b.frictionRule, b.friction);
}

void pushSupport(PointBody& body, const Support& support, const Vec3& impulse) { push(body, support.arm, impulse); }

Vec3 impulseOf(const Support& support) {
    return support.impulse * support.normal + support.rub[0] * support.tangents[0] +
           support.rub[1] * support.tangents[1];
}

}  // namespace

void findSupports(const World& world, BodyId body, BodyId chassis, GroundBody& ground) {
    ground.supports.clear();
    ground.body = {};
    ground.inverseInertia = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    if (body.isNull() || world.type(body) != BodyType::dynamic) return;
    const MassProperties mass = world.mass(body);
    ground.body.inverseMass = 1 / mass.mass;
    ground.inverseInertia = inverseSymmetric(mass.inertia);
    ground.supports.reserve(kMaxSupports);
    const auto add = [&](const Contact& contact) {
        const bool isA = contact.bodyA == body;
        const BodyId other = isA ? contact.bodyB : contact.bodyA;
        if (other == chassis) return;
        const float friction = frictionBetween(world, contact);
        const Vec3 rub = isA ? -contact.frictionForce : contact.frictionForce;
        for (int i = 0; i < contact.pointCount && ground.supports.size() < kMaxSupports; ++i) {
            const ContactPoint& point = contact.points[i];
            if (!(point.impulse > 0) && !(point.separation <= 0)) continue;
            Support support;
            support.point = point.point;
            support.normal = isA ? -contact.normal : contact.normal;
            support.tangents[0] = perpendicular(support.normal);
            support.tangents[1] = cross(support.normal, support.tangents[0]);
            support.otherVelocity =
                world.type(other) == BodyType::fixed ? Vec3{} : world.velocityAt(other, point.point);
            support.friction = friction;
            support.impulse = point.impulse;
            support.most = kGrowth * point.impulse + kUntried * mass.mass;
            // The forces of a manifold's points are known as their sum; the impulses of the normals share it out.
            const float share = contact.normalForce > 0 ? point.impulse / contact.normalForce : 0;
            for (int t = 0; t < 2; ++t) support.rub[t] = share * dot(rub, support.tangents[t]);
            ground.supports.push_back(support);
        }
    };
    world.forEachContact(body, std::ref(add));  // a function of one pointer takes no memory
}

void beginGround(const World& world, BodyId body, GroundBody& ground) {
    PointBody& now = ground.body;
    ground.center = world.centerOfMass(body);
    now.v = world.linearVelocity(body);
    now.w = world.angularVelocity(body);
    if (!(now.inverseMass > 0)) return;
    now.inverseInertia = rotated(ground.inverseInertia, world.pose(body).rotation);
    for (Support& support : ground.supports) {
        support.arm = relative(support.point, ground.center);
        support.normalMass = inverseOrZero(inverseMassBetween(now, support.arm, support.normal, support.normal));
        for (int t = 0; t < 2; ++t) {
            const Vec3& along = support.tangents[t];
            support.tangentMass[t] = inverseOrZero(inverseMassBetween(now, support.arm, along, along));
        }
        const float into = -dot(velocityAt(now, support.arm) - support.otherVelocity, support.normal);
        if (into > kUntried && into * support.normalMass > kThrough * support.impulse) {
            support.most = support.impulse = support.rub[0] = support.rub[1] = 0;
        }
    }
}

void pressGround(GroundBody& ground, const Vec3& fall) {
    if (ground.body.inverseMass > 0) ground.body.v += fall;
    for (const Support& support : ground.supports) pushSupport(ground.body, support, impulseOf(support));
}

float visitSupports(GroundBody& ground) {
    float largest = 0;
    for (Support& support : ground.supports) {
        const Vec3 before = impulseOf(support);
        const Vec3 speed = velocityAt(ground.body, support.arm) - support.otherVelocity;
        support.impulse = clampTo(support.impulse - support.normalMass * dot(speed, support.normal), 0, support.most);
        for (int t = 0; t < 2; ++t) support.rub[t] -= support.tangentMass[t] * dot(speed, support.tangents[t]);
        const float rub = std::sqrt(support.rub[0] * support.rub[0] + support.rub[1] * support.rub[1]);
        const float most = support.friction * support.impulse;
        if (rub > most) {
            for (float& part : support.rub) part *= most / rub;
        }
        const Vec3 change = impulseOf(support) - before;
        pushSupport(ground.body, support, change);
        largest = std::max(largest, length(change));
    }
    return largest;
}

}  // namespace ragtop
