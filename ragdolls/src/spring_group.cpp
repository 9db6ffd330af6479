#include "spring_group.h"

namespace ragtop {
namespace {

/// What carries the bones at the end of a pass.
struct Carriers {
    FourQuat bend, rotation;
    FourVec3 joint;
};

float bowed(float s) { return s * (s - 1); }

Carriers carriersOf(const SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass) {
    Carriers result{};
    if (group.roots) {
        result.bend.w = result.rotation.w = four(1.0f);
        // What is left of the joints' paths up to this frame.
        result.joint = -((1 - pass.end) * group.shift - bowed(pass.end) * group.shiftBow);
        return result;
    }
    for (int lane = 0; lane < SpringGroup::kLanes; ++lane) {
        const int number = group.carrier[static_cast<std::size_t>(lane)];
        const SpringGroup& from = groups[static_cast<std::size_t>(number / SpringGroup::kLanes)];
        const int at = number % SpringGroup::kLanes;
        result.bend.set(lane, from.bend.at(at));
        result.rotation.set(lane, from.rotation.at(at));
        result.joint.set(lane, from.joint.at(at));
    }
    return result;
}

FourQuat restOf(const SpringGroup& group, const SpringPass& pass) {
    return normalized(group.from + pass.end * (group.to - group.from) + bowed(pass.end) * group.bow);
}

/// Keeps d · c ≤ m for unit c, turning d the short way, and takes what of its rate leads beyond.
void keepOutside(SpringGroup& group, const FourVec3& c, Four m) {
    FourVec3& d = group.direction;
    const Four along = dot(d, c);
    const FourFlags inside = along > m;
    if (!any(inside)) return;
    m = greater(m, four(-1.0f));
    const FourVec3 aside = normalized(d - along * c);
    const FourVec3 moved = m * c + squareRoot(greater(1.0f - m * m, four(0.0f))) * aside;
    d = select(inside, normalized(moved), d);
    const FourVec3 towards = normalized(c - dot(c, d) * d);
    const Four approach = greater(dot(group.speed, towards), four(0.0f));
    group.speed = select(inside, group.speed - approach * towards, group.speed);
}

/// A ball of radius R about q, seen from the joint at c = q − p, leaves the weight's ball of radius ρ alone where
/// |L d − c| ≥ R + ρ, which is d · ĉ ≤ (L² + |c|² − (R + ρ)²) / (2 L |c|).
void keepOutOf(SpringGroup& group, const PlacedCollider& collider) {
    if (collider.plane) {
        const FourVec3 normal = four(collider.b);
        const Four above = dot(normal, group.joint - four(collider.a));
        keepOutside(group, -normal, (above - group.radius) / group.length);
        return;
    }
    const FourVec3 core = four(collider.b - collider.a), start = four(collider.a);
    const FourVec3 weight = group.joint + group.length * group.direction;
    const float size = dot(collider.b - collider.a, collider.b - collider.a);
    const Four share = size > 0 ? dot(weight - start, core) / size : four(0.0f);
    const FourVec3 c = start + lesser(greater(share, four(0.0f)), four(1.0f)) * core - group.joint;
    const Four squared = dot(c, c), distance = squareRoot(squared), reach = collider.radius + group.radius;
    const FourFlags apart = distance > 0.0f;
    const Four inverse = apart ? 1.0f / distance : four(0.0f);
    const Four most = (group.length * group.length + squared - reach * reach) * (0.5f * inverse) / group.length;
    keepOutside(group, inverse * c, apart ? most : four(1.0f));
}

/// Limits and colliders, and with them where the bones are.
void place(SpringGroup& group, const Carriers& carriers, const SpringPass& pass) {
    group.carried = carriers.bend;
    group.joint = carriers.joint + rotate(carriers.rotation, group.offset);
    const FourVec3 unbent = rotate(group.rest, group.axis);
    keepOutside(group, -unbent, -group.leastCosine);
    if (!pass.colliders.empty()) {
        group.direction = rotate(carriers.bend, group.direction);
        group.speed = rotate(carriers.bend, group.speed);
        // The nearest point of a capsule moves with the weight: twice finds it.
        for (int round = 0; round < 2; ++round)
            for (const PlacedCollider& collider : pass.colliders) keepOutOf(group, collider);
        group.direction = rotate(conjugate(carriers.bend), group.direction);
        group.speed = rotate(conjugate(carriers.bend), group.speed);
    }
    group.bend = normalized(carriers.bend * rotationBetween(unbent, group.direction));
    group.rotation = group.bend * group.rest;
}

/// How a body moves from rest or by a push, s̈ + c ṡ + k s = 0, in h: by a unit of speed, b, whose rate is
/// `rate`, and by a unit of force that stays, p = ∫ b.
struct Course {
    Four b, rate, p;
};

/// Over a short time x by the series of b, (n + 1)(n + 2) bₙ₊₂ = −(c x (n + 1) bₙ₊₁ + k x² bₙ); and twice the time
/// as often as it takes. With α = ḃ + c b, exp(A x) = α + A b for the system's matrix A, A² = −c A − k:
///
///     α(2x) = α² − k b²,   b(2x) = 2 α b − c b²,   p(2x) = p (1 + α) + b²
Course courseOf(Four c, Four k, float h) {
    Four a = c * h, z = k * (h * h);
    float x = h;
    int doublings = 0;
    while (any((z > 0.25f) | (a > 0.5f))) {
        a *= 0.5f;
        z *= 0.25f;
        x *= 0.5f;
        ++doublings;
    }
    Four before = four(1.0f), term = -0.5f * a;
    Four b = before + term, rate = before + 2.0f * term, p = 0.5f + term * (1.0f / 3);
    for (int n = 1; n <= 6; ++n) {
        const auto at = static_cast<float>(n);
        const Four next = -(a * (at + 1) * term + z * before) * (1.0f / ((at + 1) * (at + 2)));
        before = term;
        term = next;
        b += term;
        rate += (at + 2) * term;
        p += term * (1.0f / (at + 3));
    }
    b *= x;
    p *= x * x;
    Four alpha = rate + c * b;
    for (; doublings > 0; --doublings) {
        const Four squared = b * b;
        p = p * (1.0f + alpha) + squared;
        b = 2.0f * alpha * b - c * squared;
        alpha = alpha * alpha - k * squared;
    }
    return {b, alpha - c * b, p};
}

/// Along the great circle that leaves d in the direction of s, by |s|, which is at most 2; speeds go with it. With
/// t = tan(|s|/2) along s, cos = (1 − t²)/(1 + t²), sin = 2t/(1 + t²).
void turn(SpringGroup& group, FourVec3 s) {
    const Four squared = dot(s, s);
    s = lesser(four(1.0f), 2.0f / squareRoot(greater(squared, four(1e-12f)))) * s;
    const Four x = 0.25f * lesser(squared, four(4.0f));
    // tan(√x)/√x; its next term is below 1e-4 up to |s| = 1.
    const Four tangent = 1.0f + x * (1.0f / 3 + x * (2.0f / 15 + x * (17.0f / 315 + x * (62.0f / 2835))));
    const FourVec3 t = (0.5f * tangent) * s;
    const Four size = dot(t, t), share = 1.0f / (1.0f + size);
    const FourVec3 d = group.direction;
    group.speed = group.speed - (2.0f * share * dot(group.speed, t)) * (t + d);
    group.direction = normalized(((1.0f - size) * share) * d + (2.0f * share) * t);
    group.speed = group.speed - dot(group.speed, group.direction) * group.direction;
}

/// The part of v across d.
FourVec3 across(const FourVec3& v, const FourVec3& d) { return v - dot(v, d) * d; }

}  // namespace

void settle(SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass) {
    const Carriers carriers = carriersOf(group, groups, pass);
    group.rest = restOf(group, pass);
    const FourVec3 down = rotate(conjugate(carriers.bend), four(pass.gravity));
    group.direction = normalized(group.stiffness * rotate(group.rest, group.axis) + group.sag * down);
    group.speed = four(Vec3{});
    place(group, carriers, pass);
}

void carry(SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass) {
    const FourQuat rest = restOf(group, pass), turned = rest * conjugate(group.rest);
    group.rest = rest;
    group.direction = normalized(rotate(turned, group.direction));
    group.speed = rotate(turned, group.speed);
    place(group, carriersOf(group, groups, pass), pass);
}

void advance(SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass) {
    const float h = pass.h;
    const Carriers carriers = carriersOf(group, groups, pass);
    const FourQuat rest = nearer(restOf(group, pass), group.rest);
    // The path that goes through the last three places has half the acceleration (now − before)/(h + h_before).
    const float spread = 1 / (h + pass.before);
    const FourQuat pace = (1 / h) * (rest - group.rest);
    if (pass.fresh) group.pace = pace;
    const FourQuat middle = normalized(0.5f * (rest + group.rest) - (h * h * spread / 6) * (pace - group.pace));
    group.pace = pace;
    group.rest = rest;
    const FourQuat turning = (2.0f * pace) * conjugate(middle);
    const FourVec3 spin{turning.x, turning.y, turning.z};

    const FourVec3 mean =
        ((pass.end - pass.begin) / h) * group.shift + ((bowed(pass.end) - bowed(pass.begin)) / h) * group.shiftBow;
    if (pass.fresh) group.mean = group.last = mean;
    const FourVec3 acceleration = (2 * spread) * (mean - group.mean), start = mean - (0.5f * h) * acceleration;
    const FourQuat unbend = conjugate(normalized(group.carried + nearer(carriers.bend, group.carried)));
    const FourVec3 d = group.direction;
    if (pass.fresh) group.speed = group.speed + cross(spin, d);
    group.speed = group.speed - group.inertia * across(rotate(conjugate(group.carried), start - group.last), d);
    group.mean = mean;
    group.last = start + h * acceleration;

    const FourVec3 force = group.stiffness * rotate(middle, group.axis) +
                           rotate(unbend, group.sag * four(pass.gravity) - group.inertia * acceleration);
    // Without the bound a bone that hangs upside down would leave its carrier as fast as its step is long.
    const FourVec3 halfway = d + (0.5f * h) * group.speed;
    const Four stiffness = greater(dot(force, halfway), 0.25f * group.stiffness);
    const Course course = courseOf(group.damping, stiffness, h);
    const FourVec3 push = across(force, d) + group.damping * cross(spin, halfway);
    const FourVec3 s = course.b * group.speed + course.p * push;
    group.speed = course.rate * group.speed + course.b * push;
    turn(group, s);
    place(group, carriers, pass);
}

}  // namespace ragtop
