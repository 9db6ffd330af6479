#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "contacts/may_collide.h"
#include "scene/scene.h"

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

/// What has no shape still turns: as far out as its mass is.
float radiusOfGyration(const BodyRecord& body) {
    const float moment = std::max({body.inertia.x, body.inertia.y, body.inertia.z});
    return body.mass > 0 ? std::sqrt(moment / body.mass) : 0.0f;
}

/// How much room is left in the bounds of the body's other shapes is not known then.
void refit(const Scene& s, std::uint32_t index) {
    const ShapeRecord& shape = s.shapes[index];
    s.bounds.giveRoom(shape.body);
    if (shape.proxy == kNone) return;
    const Bounds tight = s.bounds.tightBounds(shape, s.bounds.dt);
    if (contains(s.broadphase.tree(shape.isStaticTree).bounds(shape.proxy), tight)) return;
    s.bounds.removeProxy(index);
    s.bounds.insertProxy(index);
}

}  // namespace

void Scene::changeMass(std::uint32_t index, const MassProperties& mass) const {
    BodyRecord& body = bodies[index];
    const Pose pose = poseOf(body);
    const Frame before = body.local;
    takeMass(body, mass);
    const Frame move = inverse(body.local) * before;
    const Pose internal = pose * body.local;
    bodies.states[index].v += cross(bodies.states[index].w, relative(internal.position, body.center));
    body.center = internal.position;
    body.rotation = normalized(internal.rotation);
    body.radius = body.firstShape == kNone ? radiusOfGyration(body) : 0.0f;
    body.travel.coreRadius = 0;
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
    activity.wakeBody(index);
}

void Scene::moveAnchors(std::uint32_t index, const Frame& move) const {
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

void Scene::addShape(std::uint32_t bodyIndex, const ShapeDef& def, const Frame& frame, const Shape& geometry,
                     const Frame& toInternal) const {
    const std::uint32_t index = shapes.acquire();
    ShapeRecord& shape = shapes[index];
    BodyRecord& body = bodies[bodyIndex];
    shape.frame = toInternal * frame;
    shape.frame.rotation = normalized(shape.frame.rotation);
    shapes.densities[index] = def.density;
    shape.filter = def.filter;
    shapes.setMaterial(index, def.material);
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

std::uint32_t Scene::createBody(const BodyDef& def) const {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    const std::uint32_t index = bodies.acquire();
    BodyRecord& body = bodies[index];
    body.type = def.type;
    body.motion.linearDamping = def.linearDamping;
    body.motion.angularDamping = def.angularDamping;
    body.motion.gravityScale = def.gravityScale;
    body.options.allowSleep = def.allowSleep;
    body.options.continuous = def.continuous;
    body.options.bullet = def.bullet;
    body.locks = def.locks;
    bodies.userData[index] = def.userData;
    body.state = def.type == BodyType::fixed ? 0 : index;
    if (def.type == BodyType::dynamic) takeMass(body, def.mass ? *def.mass : massOfShapes(def));
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
        body.size = body.travel.coreRadius = 0;
        body.radius = radiusOfGyration(body);
    }
    resetSolverState(index);
    refreshBounds(index);
    ++versions.structure;
    if (def.type != BodyType::fixed) {
        activity.wakeBody(index);
        events.takeBackSleep();  // it was never asleep
    }
    return index;
}

void Scene::resetSolverState(std::uint32_t index) const {
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
    d.spins = turns ? BodyDynamics::kSpins : 0.0f;
    if (isDynamic) bodies.obeyLocks(index);
    // Free flight is the best guess for a body without a past; only the direction counts, any step fits.
    bodies.histories[index].velocityBefore = isDynamic ? state.v - 1e12f * gravity : state.v;
    bodies.refreshInertia(index);
}

void Scene::forgetGaps(std::uint32_t index) const {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key))
        contacts[key >> 1].until = 0;
}

void Scene::refreshBounds(std::uint32_t index) const {
    forgetGaps(index);
    bounds.giveRoom(index);
    if (!bodies.isEnabled(index)) return;
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next) {
        if (shapes[s].proxy != kNone) bounds.removeProxy(s);
        bounds.insertProxy(s);
    }
}

void Scene::destroyBody(std::uint32_t index) const {
    activity.wakeTouching(index);
    BodyRecord& body = bodies[index];
    while (body.firstJoint != kNone) destroyJoint(body.firstJoint >> 1);
    while (body.firstContact != kNone) activity.destroyContact(body.firstContact >> 1);
    for (std::uint32_t s = body.firstShape; s != kNone;) {
        const std::uint32_t next = shapes[s].next;
        if (shapes[s].proxy != kNone) bounds.removeProxy(s);
        shapes.release(s);
        s = next;
    }
    body.firstShape = kNone;
    if (body.awakeIndex != kNone) {
        activity.sleepBody(index);
        events.takeBackSleep();
    }
    versions.fixed += body.type == BodyType::fixed ? 1 : 0;
    bodies.release(index);
    ++versions.structure;
}

void Scene::setPose(std::uint32_t index, const Pose& pose) const {
    BodyRecord& body = bodies[index];
    activity.wakeTouching(index);
    versions.fixed += body.type == BodyType::fixed ? 1 : 0;
    const Pose internal = Pose{pose.position, normalized(pose.rotation)} * body.local;
    body.center = internal.position;
    body.rotation = normalized(internal.rotation);
    resetSolverState(index);
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
        joints.sims[key >> 1].leads = 0;
        noteOpening(key >> 1);
    }
    refreshBounds(index);
    wakeOverlapped(index);
}

/// Sleepers look for no partners themselves: what is put into one wakes it.
void Scene::wakeOverlapped(std::uint32_t index) const {
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
    for (const std::uint32_t body : met) activity.wakeBody(body);
}

void Scene::forgetImpulses(std::uint32_t index, bool anew) const {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        ContactRecord& record = contacts[key >> 1];
        record.bearsLoad = false;
        for (const ManifoldRecord& manifold : manifolds.of(record)) activity.writer.writeImpulses(record, manifold, {});
    }
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
        JointSim& joint = joints.sims[key >> 1];
        if (!anew) {
            rescaleJoint(joint, 0);
            continue;
        }
        joint.kind = JointKind::none;  // nothing of it is kept but its bodies
        compile(key >> 1);
    }
}

/// What a shape goes in its body counts as travel of the body.
void Scene::moveShape(std::uint32_t index, const Frame& frame) const {
    ShapeRecord& shape = shapes[index];
    BodyRecord& body = bodies[shape.body];
    if (frame == shape.frame) return;
    if (body.type == BodyType::fixed) {
        activity.wakeTouching(shape.body);
        ++versions.fixed;
    } else {
        activity.wakeBody(shape.body);
    }
    const GeometryEntry& geometry = shapes.geometryOf(shape);
    const Quat turn = conjugate(shape.frame.rotation) * frame.rotation;
    const float travel = length(frame.position - shape.frame.position) +
                         2 * length(Vec3{turn.x, turn.y, turn.z}) * radiusAbout(geometry.shape, {});
    shape.frame = frame;
    reach(body, shape, geometry);
    body.travel.done += static_cast<double>(travel);
    forgetGaps(shape.body);
    refit(*this, index);
}

}  // namespace ragtop
