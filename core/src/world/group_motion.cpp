#include "world/group_motion.h"

#include <algorithm>
#include <cmath>

namespace ragtop {

double kineticEnergy(const Bodies& bodies, std::uint32_t index, const Quat& rotation) {
    const BodyRecord& body = bodies[index];
    const BodyState& state = bodies.states[index];
    const Vec3 w = inverseRotate(rotation, state.w);
    const double mass = static_cast<double>(body.mass);
    return 0.5 *
           (mass * static_cast<double>(lengthSquared(state.v)) + static_cast<double>(dot(w, scale(body.inertia, w))));
}

Quat rotationNow(const Bodies& bodies, std::uint32_t index) {
    return normalized(bodies.states[index].dq * bodies[index].rotation);
}

CommonMotion commonMotion(const Bodies& bodies, std::span<const std::uint32_t> group) {
    CommonMotion motion;
    double mass = 0;
    DVec3 center{}, momentum{};
    const auto place = [&](std::uint32_t b) { return bodies[b].center + bodies.states[b].dp; };
    for (const std::uint32_t b : group) {
        const double m = static_cast<double>(bodies[b].mass);
        mass += m;
        center = center + m * place(b);
        momentum = momentum + m * DVec3{bodies.states[b].v};
    }
    motion.center = (1 / mass) * center;
    motion.v = toVec3((1 / mass) * momentum);
    Vec3 angular;
    Sym3 inertia{};
    double whole = 0;
    for (const std::uint32_t b : group) {
        const float m = bodies[b].mass;
        const Quat q = rotationNow(bodies, b);
        const Vec3 r = toVec3(place(b) - motion.center), w = inverseRotate(q, bodies.states[b].w);
        const Vec3 i = bodies[b].inertia;
        angular += m * cross(r, bodies.states[b].v - motion.v) + rotate(q, scale(i, w));
        const Mat3 t = toMat3(q);
        const auto add = [&](float& to, auto at) {
            to += i.x * at(t.cx) + i.y * at(t.cy) + i.z * at(t.cz) - m * at(r);
        };
        add(inertia.xx, [](const Vec3& a) { return a.x * a.x; });
        add(inertia.yy, [](const Vec3& a) { return a.y * a.y; });
        add(inertia.zz, [](const Vec3& a) { return a.z * a.z; });
        add(inertia.xy, [](const Vec3& a) { return a.x * a.y; });
        add(inertia.xz, [](const Vec3& a) { return a.x * a.z; });
        add(inertia.yz, [](const Vec3& a) { return a.y * a.z; });
        const float arm = m * lengthSquared(r);
        inertia.xx += arm, inertia.yy += arm, inertia.zz += arm;
        whole += kineticEnergy(bodies, b, q);
    }
    motion.inertia = factorize(inertia, diagonal(inertia));
    motion.momentum = angular;
    motion.w = solve(motion.inertia, angular);
    // Rounding of the inertia of a group may make its common motion more than all of its motion.
    motion.rigid = std::min(whole, 0.5 * (mass * static_cast<double>(lengthSquared(motion.v)) +
                                          static_cast<double>(dot(motion.w, angular))));
    motion.spinning = std::min(motion.rigid, 0.5 * static_cast<double>(dot(motion.w, angular)));
    motion.inner = whole - motion.rigid;
    return motion;
}

void setVelocity(Bodies& bodies, std::uint32_t body, const Vec3& v, const Vec3& w) {
    BodyState& state = bodies.states[body];
    state.v = v;
    state.w = w;
    if (state.locks != 0 || bodies.dynamics[body].spins == 0) bodies.obeyLocks(body);
    bodies.storeMomentum(body, rotationNow(bodies, body));
}

void scaleLeads(const Bodies& bodies, Joints& joints, std::uint32_t body, float share) {
    if (joints.springs.joints.empty()) return;  // nothing leads
    for (std::uint32_t key = bodies[body].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
        if (!joints.isHolding(key >> 1)) continue;
        if ((key & 1) != 0 && bodies.moves(joints[key >> 1].bodyA)) continue;
        PairVector& lead = joints.sims[key >> 1].lead;
        lead = {share * lead.linear, share * lead.angular};
    }
}

void turnToMomentum(Bodies& bodies, std::span<const std::uint32_t> group, const Vec3& momentum) {
    const CommonMotion motion = commonMotion(bodies, group);
    const Vec3 turn = solve(motion.inertia, momentum - motion.momentum);
    for (const std::uint32_t b : group) {
        const BodyState& state = bodies.states[b];
        const Vec3 arm = toVec3(bodies[b].center + state.dp - motion.center);
        setVelocity(bodies, b, state.v + cross(turn, arm), state.w + turn);
    }
}

double takeEnergy(Bodies& bodies, Joints& joints, std::span<const std::uint32_t> group, double energy, Keeps keeps) {
    if (!(energy > 0)) return 0;
    CommonMotion motion = commonMotion(bodies, group);
    if (keeps == Keeps::linearMomentum) motion.inner += motion.spinning, motion.w = {};
    if (keeps == Keeps::nothing) motion.inner += motion.rigid, motion.v = motion.w = {};
    if (!(motion.inner > 0)) return 0;
    const auto share = static_cast<float>(std::sqrt(std::max(0.0, 1 - energy / motion.inner)));
    for (const std::uint32_t b : group) {
        const BodyState& state = bodies.states[b];
        const Vec3 arm = toVec3(bodies[b].center + state.dp - motion.center);
        const Vec3 v = motion.v + cross(motion.w, arm);
        setVelocity(bodies, b, v + share * (state.v - v), motion.w + share * (state.w - motion.w));
        scaleLeads(bodies, joints, b, share);
    }
    return std::min(energy, motion.inner);
}

}  // namespace ragtop
