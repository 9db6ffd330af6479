#include <algorithm>

#include "contacts/find_manifolds.h"
#include "contacts/find_pairs.h"
#include "model/edge_list.h"
#include "world/world_impl.h"

namespace ragtop {

/// Of all shapes in the move buffer.
void WorldImpl::createPairs(bool obstaclesToo) {
    const std::size_t lists = findPairs({bodies, shapes, joints, broadphase, callbacks, memory}, runner, obstaclesToo);
    for (std::size_t list = 0; list < lists; ++list)
        for (const PairFound& pair : broadphase.search.found[list]) createContact(pair.a, pair.b);
}

/// Pairs that come to be in this step; `longer`: than the last one.
void WorldImpl::updatePairs(bool longer) {
    createPairs(true);
    for (const std::uint32_t shape : broadphase.moved) shapes[shape].inMoveBuffer = false;
    broadphase.moved.clear();
    shapeBounds().coverNewVelocities(longer);
    if (!broadphase.moved.empty()) createPairs(false);
}

void WorldImpl::createContact(std::uint32_t a, std::uint32_t b) {
    // A mesh comes first, and of meshes one that does not move, as height fields; else a body that moves, because the
    // narrow phase works in A's frame near its centre.
    const bool meshA = shapes.geometries[shapes[a].geometry].isMesh(),
               meshB = shapes.geometries[shapes[b].geometry].isMesh();
    const bool movesA = bodies.moves(shapes[a].body), movesB = bodies.moves(shapes[b].body);
    const bool swap = meshA != meshB ? meshB : meshA && movesA != movesB ? movesA : movesA != movesB ? movesB : b < a;
    if (swap) std::swap(a, b);
    const ShapeRecord &shapeA = shapes[a], &shapeB = shapes[b];
    const std::uint32_t index = contacts.acquire();
    ContactRecord& contact = contacts[index];
    contact.shapeA = a;
    contact.shapeB = b;
    contact.bodyA = shapeA.body;
    contact.bodyB = shapeB.body;
    contact.size = shapeA.size < shapeB.size ? shapeA.size : shapeB.size;
    contact.isMesh = meshA || meshB;
    contact.sensor = shapeA.sensor || shapeB.sensor;
    contact.reportsMotion = shapeA.reportsMotion || shapeB.reportsMotion;
    contact.manifoldCapacity = contact.isMesh ? kMaxManifolds : 1;
    if (contact.isMesh) {
        const bool walks = shapes.geometries[shapeA.geometry].mesh && !meetAsSurfaces(bodies, shapes, contact);
        contact.nearTriangles = walks ? manifolds.meshMemory.acquire() : kNone;
    }
    if (contact.sensor) {  // what it overlaps is told at the end of a step, when nothing may grow
        contact.firstManifold = manifolds.acquire(contact.manifoldCapacity);
        for (ManifoldRecord& manifold : manifolds.of(contact)) manifold = {}, manifold.contact = index;
    }
    link(contacts.links, bodies[contact.bodyA].firstContact, 2 * index);
    link(contacts.links, bodies[contact.bodyB].firstContact, 2 * index + 1);
    broadphase.pairs.insert(pairKey(a, b), index);
    if (bodies.isAwake(contact.bodyA) || bodies.isAwake(contact.bodyB)) addAwakeContact(index);
}

void WorldImpl::destroyContact(std::uint32_t index) {
    ContactRecord& contact = contacts[index];
    Manifolds::forEach(contact, [&](std::uint32_t manifold) {
        manifolds[manifold].pointCount = 0;
        removeFromGraph(manifold);
    });
    manifolds.release(contact);
    if (contact.isMesh && contact.nearTriangles != kNone) manifolds.meshMemory.release(contact.nearTriangles);
    if (contact.awakeIndex != kNone) contacts.removeAwake(index);
    if (contact.touching) {
        events.end(
            {shapes.id(contact.shapeA), shapes.id(contact.shapeB), bodies.id(contact.bodyA), bodies.id(contact.bodyB)},
            contact.sensor);
    }
    unlink(contacts.links, bodies[contact.bodyA].firstContact, 2 * index);
    unlink(contacts.links, bodies[contact.bodyB].firstContact, 2 * index + 1);
    broadphase.pairs.erase(pairKey(contact.shapeA, contact.shapeB));
    contacts.release(index);
}

void WorldImpl::addAwakeContact(std::uint32_t index) {
    contacts.addAwake(index);
    if (contacts[index].sensor) contactFinds.anySensor.store(true, std::memory_order_relaxed);
    contactFinds.closing.push(index);
    contactFinds.dirty.push(index);
}

}  // namespace ragtop
