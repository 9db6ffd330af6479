// What a body is to the world: fixed, kinematic or dynamic, and whether it takes part. Both change in place: ids,
// shapes, joints and whatever impulses still mean something stay.

#include <algorithm>
#include <stdexcept>

#include "contacts/may_collide.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// What the body is now, as the definition of a dynamic one.
BodyDef asDynamic(const WorldImpl& world, std::uint32_t index) {
    const BodyRecord& body = world.bodies[index];
    BodyDef def;
    def.locks = body.locks;
    for (std::uint32_t s = body.firstShape; s != kNone; s = world.shapes[s].next) {
        const ShapeRecord& shape = world.shapes[s];
        def.shapes.push_back({.geometry = world.shapes.geometryOf(shape).shape,
                              .frame = body.local * shape.frame,
                              .density = world.shapes.densities[s],
                              .sensor = shape.sensor});
    }
    if (body.mass > 0) def.mass = world.massOf(index);
    return def;
}

MassProperties massOfShapes(const BodyDef& def) {
    std::vector<MassProperties> parts;
    for (const ShapeDef& shape : def.shapes)
        if (!shape.sensor) parts.push_back(transformed(massOf(shape.geometry, shape.density), shape.frame));
    return combined(parts);
}

/// Joints that begin to hold are as those that are made now; those that hold no longer leave nothing for the day on
/// which they hold again.
void settleJoint(WorldImpl& world, std::uint32_t joint, bool held) {
    const bool holds = world.mayHold(world.joints[joint]);
    if (held == holds) return;
    rescaleJoint(world.joints.sims[joint], 0);
    world.joints.sims[joint].leads = 0;
    world.compile(joint);
    if (holds)
        world.joints.created.push(joint);
    else
        world.joints.unlist(joint);
}

}  // namespace

bool WorldImpl::mayHold(const JointRecord& joint) const {
    return bodies.isEnabled(joint.bodyA) && bodies.isEnabled(joint.bodyB) &&
           (bodies.moves(joint.bodyA) || bodies.moves(joint.bodyB));
}

/// A mesh that forces move is as large as it is thick, and meets others by its triangles.
void WorldImpl::becomeSolid(std::uint32_t index) {
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

void WorldImpl::setType(std::uint32_t index, BodyType type) {
    if (bodies.typeOf(index) == type) return;
    if (type == BodyType::dynamic) {
        const BodyDef def = asDynamic(*this, index);
        if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
        if (!def.mass) changeMass(index, massOfShapes(def));
        becomeSolid(index);
    }
    takePart(index, type, bodies.isEnabled(index));
}

void WorldImpl::setEnabled(std::uint32_t index, bool enabled) {
    if (bodies.isEnabled(index) != enabled) takePart(index, bodies.typeOf(index), enabled);
}

/// Out of all lists with its constraints, as what falls asleep; nobody is told.
void WorldImpl::withdraw(std::uint32_t index) {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key))
        Manifolds::forEach(contacts[key >> 1], [&](std::uint32_t manifold) { removeFromGraph(manifold); });
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints.next(key))
        removeJointFromGraph(key >> 1);
    if (bodies.isAwake(index)) leaveAwake(index);
    for (std::uint32_t s = bodies[index].firstShape; s != kNone; s = shapes[s].next)
        if (shapes[s].proxy != kNone) shapeBounds().removeProxy(s);
}

void WorldImpl::takePart(std::uint32_t index, BodyType type, bool enabled) {
    wakeTouching(index);
    BodyRecord& body = bodies[index];
    fixedVersion += body.type == BodyType::fixed || type == BodyType::fixed ? 1 : 0;
    std::vector<std::uint8_t> held;
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key))
        held.push_back(mayHold(joints[key >> 1]));
    withdraw(index);
    body.heldBack = (enabled ? 0u : 1u + static_cast<unsigned>(type)) & 3u;
    body.type = enabled ? type : BodyType::fixed;
    body.state = body.type == BodyType::fixed ? 0 : index;
    body.force = body.torque = {};
    body.sleepTimer = 0;
    body.directSteps = 0;
    body.stepFactor = body.allowedFactor = 1;
    body.pace = {};
    body.stillSteps = 0;
    if (type == BodyType::fixed) bodies.states[index].v = bodies.states[index].w = {};
    auto was = held.begin();
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key)) {
        JointSim& sim = joints.sims[key >> 1];
        sim.stateA = bodies[joints[key >> 1].bodyA].state;
        sim.stateB = bodies[joints[key >> 1].bodyB].state;
        settleJoint(*this, key >> 1, *was++ != 0);
    }
    settleRole(index);
}

/// Puts a body whose role has changed into the lists that it belongs to.
void WorldImpl::settleRole(std::uint32_t index) {
    BodyRecord& body = bodies[index];
    resetSolverState(index);
    refreshBounds(index);
    // What a surface that moves has found is not what one that stands has.
    for (std::uint32_t key = body.firstContact; key != kNone;) {
        const std::uint32_t next = contacts.next(key);
        const ContactRecord& contact = contacts[key >> 1];
        const bool stays = bodies.isEnabled(index) && !contact.isMesh &&
                           shouldCollide(bodies, shapes, joints, shapes[contact.shapeA], shapes[contact.shapeB]);
        if (!stays) destroyContact(key >> 1);
        key = next;
    }
    islands.stack.clear();
    if (body.type != BodyType::fixed) {
        enterAwake(index);
        wakeStack();
    } else {
        for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key)) addJointToGraph(key >> 1);
        restoreContacts(index);
    }
    islands.structureChanged = true;
    articulations.forget();
    wakeOverlapped(index);
}

namespace {

void requireBetweenSteps(const WorldImpl& world, const char* what) {
    if (world.inStep || world.stepping)
        throw std::logic_error(std::string(what) + " was called within a step, must be called between two");
}

}  // namespace

void World::setType(BodyId body, BodyType type) {
    const std::uint32_t index = impl_->index(body);
    if (type != BodyType::fixed && type != BodyType::kinematic && type != BodyType::dynamic)
        throw std::invalid_argument("type is " + std::to_string(static_cast<int>(type)) +
                                    ", must be fixed, kinematic or dynamic");
    requireBetweenSteps(*impl_, "setType");
    impl_->setType(index, type);
}

void World::setEnabled(BodyId body, bool enabled) {
    const std::uint32_t index = impl_->index(body);
    requireBetweenSteps(*impl_, "setEnabled");
    impl_->setEnabled(index, enabled);
}

}  // namespace ragtop
