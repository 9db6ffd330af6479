#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/symmetric_eigen.h"
#include "contacts/may_collide.h"
#include "shapes/hull.h"
#include "shapes/mesh_build.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// A shape without compounds, with its frame in the definition.
struct FlatShape {
    const ShapeDef* def;
    const Shape* geometry;
    Frame frame;
};

void flatten(const ShapeDef& def, const Shape& geometry, const Frame& frame, std::vector<FlatShape>& into) {
    if (const auto* compound = std::get_if<Compound>(&geometry)) {
        for (const CompoundPart& part : compound->parts) flatten(def, part.shape, frame * part.frame, into);
        return;
    }
    into.push_back({&def, &geometry, frame});
}

}  // namespace

/// Mass, centre and principal axes, from the definition or from shapes and densities.
void WorldImpl::setMass(std::uint32_t index, const BodyDef& def) {
    BodyRecord& body = bodies[index];
    if (body.type != BodyType::dynamic) return;
    if (def.mass) return takeMass(index, *def.mass);
    std::vector<MassProperties> parts;
    for (const ShapeDef& shape : def.shapes)
        if (!shape.sensor) parts.push_back(transformed(ragtop::massOf(shape.geometry, shape.density), shape.frame));
    takeMass(index, combined(parts));
}

/// In the frame of the definition.
MassProperties WorldImpl::massOf(std::uint32_t index) const {
    const BodyRecord& body = bodies[index];
    const Mat3 r = toMat3(body.local.rotation);
    const Mat3 principal{body.inertia.x * Vec3{1, 0, 0}, body.inertia.y * Vec3{0, 1, 0},
                         body.inertia.z * Vec3{0, 0, 1}};
    return {body.mass, body.local.position, r * principal * transpose(r)};
}

void WorldImpl::takeMass(std::uint32_t index, const MassProperties& mass) {
    BodyRecord& body = bodies[index];
    const PrincipalAxes axes = principalAxes(mass.inertia);
    body.mass = mass.mass;
    body.inertia = axes.values;
    body.local = {mass.center, axes.rotation};
}

/// What has no shape still turns: as far out as its mass is.
static float radiusOfGyration(const BodyRecord& body) {
    const float moment = std::max({body.inertia.x, body.inertia.y, body.inertia.z});
    return body.mass > 0 ? std::sqrt(moment / body.mass) : 0.0f;
}

/// The internal frame moves in the body; all that is kept in it moves the other way.
void WorldImpl::changeMass(std::uint32_t index, const MassProperties& mass) {
    BodyRecord& body = bodies[index];
    const Pose pose = poseOf(body);
    const Frame before = body.local;
    takeMass(index, mass);
    const Frame move = inverse(body.local) * before;
    const Pose internal = pose * body.local;
    bodies.states[index].v += cross(bodies.states[index].w, relative(internal.position, body.center));
    body.center = internal.position;
    body.rotation = normalized(internal.rotation);
    body.radius = body.firstShape == kNone ? radiusOfGyration(body) : 0.0f;
    body.coreRadius = 0;
    for (std::uint32_t s = body.firstShape; s != kNone; s = shapes[s].next) {
        ShapeRecord& shape = shapes[s];
        shape.frame = move * shape.frame;
        shape.frame.rotation = normalized(shape.frame.rotation);
        reach(body, shape, shapes.geometries[shape.geometry]);
    }
    moveAnchors(index, move);
    resetSolverState(index);
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next)
        compile(key >> 1);
    wakeBody(index);
}

void WorldImpl::moveAnchors(std::uint32_t index, const Frame& move) {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        ContactRecord& contact = contacts[key >> 1];
        contact.surfaceOpen = true;  // a ball about the centre may be none now
        const bool isA = contact.bodyA == index;
        for (ManifoldRecord& manifold : manifolds.of(contact)) {
            if (isA) manifold.normal = rotate(move.rotation, manifold.normal);
            for (int j = 0; j < manifold.pointCount; ++j) {
                Vec3& anchor = (isA ? manifold.anchorA : manifold.anchorB)[j];
                anchor = transformPoint(move, anchor);
            }
        }
    }
}

std::uint32_t WorldImpl::createBody(const BodyDef& def) {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    const std::uint32_t index = bodies.acquire();
    BodyRecord& body = bodies[index];
    body.type = def.type;
    body.linearDamping = def.linearDamping;
    body.angularDamping = def.angularDamping;
    body.gravityScale = def.gravityScale;
    body.allowSleep = def.allowSleep;
    body.continuous = def.continuous;
    body.bullet = def.bullet;
    body.locks = def.locks;
    bodies.userData[index] = def.userData;
    body.state = def.type == BodyType::fixed ? 0 : index;
    setMass(index, def);
    const Pose start{def.pose.position, normalized(def.pose.rotation)};
    const Pose internal = start * body.local;
    body.center = internal.position;
    body.rotation = normalized(internal.rotation);
    bodies.states[index].v = def.linearVelocity;
    bodies.states[index].w = def.angularVelocity;

    std::vector<FlatShape> flat;
    for (const ShapeDef& shape : def.shapes) flatten(shape, shape.geometry, shape.frame, flat);
    body.size = std::numeric_limits<float>::max();
    const Frame toInternal = inverse(body.local);
    // In reverse, because the list is built from its end.
    for (std::size_t i = flat.size(); i-- > 0;)
        addShape(index, *flat[i].def, flat[i].frame, *flat[i].geometry, toInternal);
    if (def.type == BodyType::dynamic) becomeSolid(index);
    if (flat.empty()) {
        body.size = body.coreRadius = 0;
        body.radius = radiusOfGyration(body);
    }
    resetSolverState(index);
    refreshBounds(index);
    ++structureVersion;
    if (def.type != BodyType::fixed) {
        wakeBody(index);
        events.takeBackSleep();  // it was never asleep
    }
    return index;
}

void WorldImpl::addShape(std::uint32_t bodyIndex, const ShapeDef& def, const Frame& frame, const Shape& geometry,
                         const Frame& toInternal) {
    const std::uint32_t index = shapes.acquire();
    ShapeRecord& shape = shapes[index];
    BodyRecord& body = bodies[bodyIndex];
    shape.frame = toInternal * frame;
    shape.frame.rotation = normalized(shape.frame.rotation);
    shapes.densities[index] = def.density;
    shape.filter = def.filter;
    shape.material = def.material;
    shape.body = bodyIndex;
    shape.geometry = shapes.geometryIndex(geometry);
    shape.size = shapes.geometries[shape.geometry].size;
    shape.sensor = def.sensor;
    shape.reportsMotion = def.reportsMotion;
    contactFinds.motionReported |= def.reportsMotion;
    shape.userData = def.userData;
    shape.next = body.firstShape;
    body.firstShape = index;
    shape.givesWay = def.givesWay;
    // What gives way is not swept.
    if (shape.size < body.size && !shape.givesWay) body.size = shape.size;
    reach(body, shape, shapes.geometries[shape.geometry]);
}

/// What the solver streams through, from the record.
void WorldImpl::resetSolverState(std::uint32_t index) {
    const BodyRecord& body = bodies[index];
    BodyState& state = bodies.states[index];
    BodyDynamics& d = bodies.dynamics[index];
    directSet.treesChanged = true;
    const bool isDynamic = body.type == BodyType::dynamic;
    const AxisLocks& locks = body.locks;
    const bool turns = isDynamic && !(locks.rotationX || locks.rotationY || locks.rotationZ) && body.inertia.x > 0 &&
                       body.inertia.y > 0 && body.inertia.z > 0;
    state.invMass = isDynamic ? 1 / body.mass : 0;
    state.locks = isDynamic
                      ? (locks.translationX ? 1u : 0u) | (locks.translationY ? 2u : 0u) | (locks.translationZ ? 4u : 0u)
                      : 0u;
    state.dp = {};
    state.dq = {};
    d.inertia = turns ? body.inertia : Vec3{1, 1, 1};
    d.inverseInertia = turns ? Vec3{1 / body.inertia.x, 1 / body.inertia.y, 1 / body.inertia.z} : Vec3{1, 1, 1};
    d.spins = turns ? 1.0f : 0.0f;
    if (isDynamic) bodies.obeyLocks(index);
    // Free flight is the best guess for a body without a past; only the direction counts, any step fits.
    bodies.histories[index].velocityBefore = isDynamic ? state.v - 1e12f * settings.gravity : state.v;
    bodies.refreshInertia(index);
}

/// A velocity given between steps is no acceleration that the position map could take for a smooth one.
void WorldImpl::setVelocity(std::uint32_t index, const Vec3& linear, const Vec3& angular) {
    BodyState& state = bodies.states[index];
    const Vec3 before = state.v;
    state.v = linear;
    state.w = angular;
    if (bodies[index].type == BodyType::dynamic) bodies.obeyLocks(index);
    if (!stepping) bodies.histories[index].velocityBefore += state.v - before;
    if (stepping) recordDriven(*this, index);
    // Bounds that are made when the step ends count what modules did within it.
    if (!moduleWork.inSubsteps) shapeBounds().recordNewVelocity(index);
}

/// What was put somewhere did not travel there.
void WorldImpl::forgetGaps(std::uint32_t index) {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key))
        contacts[key >> 1].until = 0;
}

void WorldImpl::refreshBounds(std::uint32_t index) {
    forgetGaps(index);
    shapeBounds().giveRoom(index);
    if (!bodies.isEnabled(index)) return;
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next) {
        if (shapes[s].proxy != kNone) shapeBounds().removeProxy(s);
        shapeBounds().insertProxy(s);
    }
}

void WorldImpl::destroyBody(std::uint32_t index) {
    wakeTouching(index);
    BodyRecord& body = bodies[index];
    while (body.firstJoint != kNone) destroyJoint(body.firstJoint >> 1);
    while (body.firstContact != kNone) destroyContact(body.firstContact >> 1);
    for (std::uint32_t s = body.firstShape; s != kNone;) {
        const std::uint32_t next = shapes[s].next;
        if (shapes[s].proxy != kNone) shapeBounds().removeProxy(s);
        shapes.release(s);
        s = next;
    }
    body.firstShape = kNone;
    if (body.awakeIndex != kNone) {
        sleepBody(index);
        events.takeBackSleep();
    }
    fixedVersion += body.type == BodyType::fixed ? 1 : 0;
    bodies.release(index);
    ++structureVersion;
}

void WorldImpl::setPose(std::uint32_t index, const Pose& pose) {
    BodyRecord& body = bodies[index];
    wakeTouching(index);
    fixedVersion += body.type == BodyType::fixed ? 1 : 0;
    const Pose internal = Pose{pose.position, normalized(pose.rotation)} * body.local;
    body.center = internal.position;
    body.rotation = normalized(internal.rotation);
    resetSolverState(index);
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next)
        joints.sims[key >> 1].leads = 0;
    refreshBounds(index);
    wakeOverlapped(index);
}

/// Sleepers look for no partners themselves: what is put into one wakes it.
void WorldImpl::wakeOverlapped(std::uint32_t index) {
    if (!bodies.isEnabled(index)) return;
    std::vector<std::uint32_t> met;
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next) {
        if (shapes[s].proxy == kNone) continue;
        broadphase.movingTree.query(broadphase.tree(shapes[s].isStaticTree).bounds(shapes[s].proxy),
                                    [&](std::uint32_t other) {
                                        if (!bodies.isAwake(shapes[other].body) &&
                                            shouldCollide(bodies, shapes, joints, shapes[s], shapes[other]))
                                            met.push_back(shapes[other].body);
                                        return true;
                                    });
    }
    for (const std::uint32_t body : met) wakeBody(body);
}

std::uint32_t WorldImpl::index(BodyId id) const {
    if (id.index == 0 || !bodies.slots.isValid(id.index, id.generation))
        throw std::out_of_range("no such body: id names nothing");
    return id.index;
}
std::uint32_t WorldImpl::index(ShapeId id) const {
    if (!shapes.slots.isValid(id.index, id.generation)) throw std::out_of_range("no such shape: id names nothing");
    return id.index;
}
std::uint32_t WorldImpl::index(JointId id) const {
    if (!joints.slots.isValid(id.index, id.generation)) throw std::out_of_range("no such joint: id names nothing");
    return id.index;
}

std::uint32_t WorldImpl::index(CouplingId id) const {
    if (!couplings.slots.isValid(id.index, id.generation))
        throw std::out_of_range("no such coupling: id names nothing");
    return id.index;
}

}  // namespace ragtop
