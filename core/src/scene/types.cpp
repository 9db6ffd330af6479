// What a body is to the world: fixed, kinematic or dynamic, and whether it takes part. Both change in place: ids,
// shapes, joints and whatever impulses still mean something stay.

#include <algorithm>
#include <stdexcept>

#include "contacts/may_collide.h"
#include "scene/scene.h"

namespace ragtop {

namespace {

/// What the body is now, as the definition of a dynamic one.
BodyDef asDynamic(const Scene& scene, std::uint32_t index) {
    const BodyRecord& body = scene.bodies[index];
    BodyDef def;
    def.locks = body.locks;
    for (std::uint32_t s = body.firstShape; s != kNone; s = scene.shapes[s].next) {
        const ShapeRecord& shape = scene.shapes[s];
        def.shapes.push_back({.geometry = scene.shapes.geometryOf(shape).shape,
                              .frame = body.local * shape.frame,
                              .density = scene.shapes.densities[s],
                              .sensor = shape.sensor});
    }
    if (body.mass > 0) def.mass = massOf(body);
    return def;
}

}  // namespace

/// Joints that begin to hold are as those that are made now; those that hold no longer leave nothing for the day on
/// which they hold again.
void Scene::settleJoint(std::uint32_t joint, bool held) const {
    const bool holds = mayHold(bodies, joints[joint]);
    if (held == holds) return;
    rescaleJoint(joints.sims[joint], 0);
    joints.sims[joint].leads = 0;
    compile(joint);
    if (holds)
        joints.created.push(joint);
    else
        joints.unlist(joint);
}

/// A mesh that forces move is as large as it is thick, and meets others by its triangles.
void Scene::becomeSolid(std::uint32_t index) const {
    BodyRecord& body = bodies[index];
    for (std::uint32_t s = body.firstShape; s != kNone; s = shapes[s].next) {
        ShapeRecord& shape = shapes[s];
        const GeometryEntry& geometry = shapes.geometryOf(shape);
        if (geometry.mesh) {
            shape.size = geometry.mesh->thickness;
            if (!shapes.meshesMove()) shapes.letMeshesMove();
        }
        if (!shape.givesWay) body.size = std::min(body.size, shape.size);
    }
}

void Scene::setType(std::uint32_t index, BodyType type) const {
    if (bodies.typeOf(index) == type) return;
    if (type == BodyType::dynamic) {
        const BodyDef def = asDynamic(*this, index);
        if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
        if (!def.mass) changeMass(index, massOfShapes(def));
        becomeSolid(index);
    }
    takePart(index, type, bodies.isEnabled(index));
}

void Scene::setEnabled(std::uint32_t index, bool enabled) const {
    if (bodies.isEnabled(index) != enabled) takePart(index, bodies.typeOf(index), enabled);
}

/// Out of all lists with its constraints, as what falls asleep; nobody is told.
void Scene::withdraw(std::uint32_t index) const {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key))
        Manifolds::forEach(contacts[key >> 1], [&](std::uint32_t manifold) { activity.removeFromGraph(manifold); });
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints.next(key))
        activity.removeJointFromGraph(key >> 1);
    if (bodies.isAwake(index)) activity.leaveAwake(index);
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next)
        if (shapes[s].proxy != kNone) bounds.removeProxy(s);
}

void Scene::takePart(std::uint32_t index, BodyType type, bool enabled) const {
    activity.wakeTouching(index);
    BodyRecord& body = bodies[index];
    versions.fixed += body.type == BodyType::fixed || type == BodyType::fixed ? 1 : 0;
    std::vector<std::uint8_t> held;
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key))
        held.push_back(mayHold(bodies, joints[key >> 1]));
    withdraw(index);
    body.options.heldBack = (enabled ? 0u : 1u + static_cast<unsigned>(type)) & 3u;
    body.type = enabled ? type : BodyType::fixed;
    body.state = body.type == BodyType::fixed ? 0 : index;
    body.force = body.torque = {};
    body.sleepTimer = 0;
    body.direct.steps = 0;
    body.direct.pace = {};
    body.stillSteps = 0;
    if (type == BodyType::fixed) bodies.states[index].v = bodies.states[index].w = {};
    auto was = held.begin();
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key)) {
        JointSim& sim = joints.sims[key >> 1];
        sim.stateA = bodies[joints[key >> 1].bodyA].state;
        sim.stateB = bodies[joints[key >> 1].bodyB].state;
        settleJoint(key >> 1, *was++ != 0);
    }
    settleRole(index);
}

/// Puts a body whose role has changed into the lists that it belongs to.
void Scene::settleRole(std::uint32_t index) const {
    BodyRecord& body = bodies[index];
    resetSolverState(index);
    refreshBounds(index);
    // What a surface that moves has found is not what one that stands has.
    for (std::uint32_t key = body.firstContact; key != kNone;) {
        const std::uint32_t next = contacts.next(key);
        const ContactRecord& contact = contacts[key >> 1];
        const bool stays = bodies.isEnabled(index) && !contact.isMesh &&
                           shouldCollide(bodies, shapes, joints, shapes[contact.shapeA], shapes[contact.shapeB]);
        if (!stays) activity.destroyContact(key >> 1);
        key = next;
    }
    islands.stack.clear();
    if (body.type != BodyType::fixed) {
        activity.enterAwake(index);
        activity.wakeStack();
    } else {
        for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key))
            activity.addJointToGraph(key >> 1);
        activity.restoreContacts(index);
    }
    islands.structureChanged = true;
    articulations.forget();
    wakeOverlapped(index);
}

}  // namespace ragtop
