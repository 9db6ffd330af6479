#include "model/bodies.h"

#include <vector>

#include "base/symmetric_eigen.h"

#include <cassert>

namespace ragtop {

namespace {

template <class T>
void grow(AlignedArray<T>& array, std::uint32_t index, const T& value) {
    if (index >= array.size()) array.resize(index + 1, value);
    array[index] = value;
}

}  // namespace

Bodies::Bodies(std::pmr::memory_resource* memory)
    : slots(memory),
      states(memory),
      inertias(memory),
      dynamics(memory),
      histories(memory),
      userData(memory),
      awake(memory),
      records_(memory) {
    records_[acquire()].type = BodyType::fixed;
}

void Bodies::reserve(std::size_t count) {
    records_.reserve(count);
    states.reserve(count);
    inertias.reserve(count);
    dynamics.reserve(count);
    histories.reserve(count);
    userData.reserve(count);
    awake.reserve(count);
}

std::uint32_t Bodies::acquire() {
    const std::uint32_t body = slots.acquire();
    grow(records_, body, BodyRecord{});
    grow(states, body, BodyState{});
    grow(inertias, body, BodyInertia{});
    grow(dynamics, body, BodyDynamics{});
    grow(histories, body, BodyHistory{});
    grow(userData, body, std::uint64_t{0});
    return body;
}

void Bodies::release(std::uint32_t body) {
    assert(body != 0 && !isAwake(body) && records_[body].firstShape == kNone);
    assert(records_[body].firstContact == kNone && records_[body].firstJoint == kNone);
    slots.release(body);
}

std::size_t Bodies::bytes() const {
    return records_.bytes() + states.bytes() + inertias.bytes() + dynamics.bytes() + histories.bytes();
}

void Bodies::addAwake(std::uint32_t body) {
    assert(isUsed(body) && !isAwake(body) && records_[body].type != BodyType::fixed);
    records_[body].awakeIndex = static_cast<std::uint32_t>(awake.size());
    awake.push(body);
}

void Bodies::removeAwake(std::uint32_t body) {
    assert(isAwake(body) && awake[records_[body].awakeIndex] == body);
    const std::uint32_t last = awake.back();
    awake[records_[body].awakeIndex] = last;
    records_[last].awakeIndex = records_[body].awakeIndex;
    awake.pop();
    records_[body].awakeIndex = kNone;
}

void Bodies::obeyLocks(std::uint32_t body) {
    const AxisLocks& locks = records_[body].locks;
    Vec3 &v = states[body].v, &w = states[body].w;
    v = {locks.translationX ? 0 : v.x, locks.translationY ? 0 : v.y, locks.translationZ ? 0 : v.z};
    w = {locks.rotationX ? 0 : w.x, locks.rotationY ? 0 : w.y, locks.rotationZ ? 0 : w.z};
}

void Bodies::refreshInertia(std::uint32_t body) {
    if (dynamics[body].spins == 0)
        restrictInertia(body);
    else
        inertias[body] = inverseInertiaAt(body, records_[body].rotation);
    storeMomentum(body);
}

void Bodies::restrictInertia(std::uint32_t index) {
    const BodyRecord& body = records_[index];
    BodyInertia& inverse = inertias[index];
    inverse = BodyInertia{.taut = inverse.taut};
    if (body.type != BodyType::dynamic) return;
    const Mat3 r = toMat3(body.rotation);
    const Mat3 m =
        r * Mat3{body.inertia.x * Vec3{1, 0, 0}, body.inertia.y * Vec3{0, 1, 0}, body.inertia.z * Vec3{0, 0, 1}} *
        transpose(r);
    const bool x = !body.locks.rotationX, y = !body.locks.rotationY, z = !body.locks.rotationZ;
    // A locked axis becomes an infinite moment: its row and column leave the matrix before it is inverted.
    const float xx = x ? m.cx.x : 1, yy = y ? m.cy.y : 1, zz = z ? m.cz.z : 1;
    const float xy = x && y ? m.cy.x : 0, xz = x && z ? m.cz.x : 0, yz = y && z ? m.cz.y : 0;
    const float cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - xz * yy;
    const float det = xx * cxx + xy * cxy + xz * cxz;
    if (!(det > 0)) return;
    const float s = 1 / det;
    inverse.xx = x ? s * cxx : 0;
    inverse.xy = x && y ? s * cxy : 0;
    inverse.xz = x && z ? s * cxz : 0;
    inverse.yy = y ? s * (xx * zz - xz * xz) : 0;
    inverse.yz = y && z ? s * (xy * xz - xx * yz) : 0;
    inverse.zz = z ? s * (xx * yy - xy * xy) : 0;
}

BodyInertia Bodies::inverseInertiaAt(std::uint32_t body, const Quat& rotation) const {
    if (dynamics[body].spins == 0) return inertias[body];
    const Mat3 r = toMat3(rotation);
    const Vec3 i = dynamics[body].inverseInertia;
    const Mat3 m = r * Mat3{i.x * Vec3{1, 0, 0}, i.y * Vec3{0, 1, 0}, i.z * Vec3{0, 0, 1}} * transpose(r);
    BodyInertia inertia = inertias[body];
    inertia.xx = m.cx.x, inertia.xy = m.cx.y, inertia.xz = m.cx.z;
    inertia.yy = m.cy.y, inertia.yz = m.cy.z, inertia.zz = m.cz.z;
    return inertia;
}

void Bodies::storeMomentum(std::uint32_t body, const Quat& q) {
    const Vec3 w = states[body].w;
    BodyHistory& history = histories[body];
    history.turningX = w.x, history.turningY = w.y, history.turningZ = w.z;
    const Vec3 momentum = scale(dynamics[body].inertia, inverseRotate(q, w));
    history.momentum = rotate(q, momentum);
    inertias[body].excess = excessOfSpin(momentum, dynamics[body].inverseInertia);
}

void Bodies::turnVelocity(std::uint32_t body, const Quat& from, const Quat& to) {
    if (dynamics[body].spins != 0) states[body].w = rotate(to, inverseRotate(from, states[body].w));
}

void Bodies::stop(std::uint32_t body) {
    states[body].v = states[body].w = {};
    histories[body].velocityBefore = histories[body].lastChange = {};
    storeMomentum(body);
}

MassProperties massOf(const BodyRecord& body) {
    const Mat3 r = toMat3(body.local.rotation);
    const Mat3 principal{body.inertia.x * Vec3{1, 0, 0}, body.inertia.y * Vec3{0, 1, 0},
                         body.inertia.z * Vec3{0, 0, 1}};
    return {body.mass, body.local.position, r * principal * transpose(r)};
}

void takeMass(BodyRecord& body, const MassProperties& mass) {
    const PrincipalAxes axes = principalAxes(mass.inertia);
    body.mass = mass.mass;
    body.inertia = axes.values;
    body.local = {mass.center, axes.rotation};
}

MassProperties massOfShapes(const BodyDef& def) {
    std::vector<MassProperties> parts;
    for (const ShapeDef& shape : def.shapes)
        if (!shape.sensor) parts.push_back(transformed(massOf(shape.geometry, shape.density), shape.frame));
    return combined(parts);
}

}  // namespace ragtop
