#include "bullet_shapes.h"

#include <LinearMath/btConvexHullComputer.h>

#include <variant>

#include "peer.h"

namespace ragtop::stability {

btCollisionShape* BulletShapes::make(const BodyDef& def, const Frame& frame) {
    if (def.shapes.size() == 1) {
        const Frame local = inverse(frame) * def.shapes[0].frame;
        const auto* hull = std::get_if<ConvexHull>(&def.shapes[0].geometry);
        if (hull && hulls_ == Hulls::enlarged) return makeEnlarged(*hull, local);
        if (local == Frame{}) return make(def.shapes[0].geometry);
    }
    auto* compound = keep(std::make_unique<btCompoundShape>());
    for (const ShapeDef& shape : def.shapes)
        compound->addChildShape(toBullet(inverse(frame) * shape.frame), make(shape.geometry));
    return compound;
}

btCollisionShape* BulletShapes::make(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape))
        return keep(std::make_unique<btBoxShape>(toBullet(box->halfExtents)));
    if (const auto* ball = std::get_if<Sphere>(&shape)) return keep(std::make_unique<btSphereShape>(ball->radius));
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return keep(std::make_unique<btCapsuleShape>(capsule->radius, 2 * capsule->halfHeight));
    if (const auto* hull = std::get_if<ConvexHull>(&shape)) return makeHull(*hull);
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return makeMesh(*mesh);
    refuse("Bullet: this shape");
}

btCollisionShape* BulletShapes::makeHull(const ConvexHull& hull) {
    // Bullet adds a margin of 4 cm to hulls, for which it has them shrunk; of thin ones it takes a tenth.
    const auto vertices = hull.vertices();
    btConvexHullComputer shrunk;
    const btScalar margin =
        shrunk.compute(&vertices.data()->x, sizeof(Vec3), static_cast<int>(vertices.size()), 0.04f, 0.1f);
    auto* result = keep(std::make_unique<btConvexHullShape>());
    for (int i = 0; i < shrunk.vertices.size(); ++i) result->addPoint(shrunk.vertices[i], false);
    result->recalcLocalAabb();
    result->setMargin(margin);
    return result;
}

btCollisionShape* BulletShapes::makeEnlarged(const ConvexHull& hull, const Frame& frame) {
    auto* result = keep(std::make_unique<btConvexHullShape>());
    for (const Vec3& vertex : hull.vertices()) result->addPoint(toBullet(transformPoint(frame, vertex)), false);
    result->recalcLocalAabb();
    return result;
}

btCollisionShape* BulletShapes::makeMesh(const TriangleMesh& mesh) {
    auto triangles = std::make_unique<btTriangleMesh>();
    const auto vertices = mesh.vertices();
    for (const Triangle& t : mesh.triangles())
        triangles->addTriangle(toBullet(vertices[t.a]), toBullet(vertices[t.b]), toBullet(vertices[t.c]));
    auto* result = keep(std::make_unique<btBvhTriangleMeshShape>(triangles.get(), true));
    meshes_.push_back(std::move(triangles));
    return result;
}

double normalImpulse(const btCollisionDispatcher& dispatcher, int a, int b) {
    double sum = 0;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
        const btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(i);
        const int first = manifold->getBody0()->getUserIndex(), second = manifold->getBody1()->getUserIndex();
        if (!((first == a && second == b) || (first == b && second == a))) continue;
        for (int k = 0; k < manifold->getNumContacts(); ++k)
            sum += static_cast<double>(manifold->getContactPoint(k).getAppliedImpulse());
    }
    return sum;
}

int contactCount(const btCollisionDispatcher& dispatcher) {
    int count = 0;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i)
        count += dispatcher.getManifoldByIndexInternal(i)->getNumContacts();
    return count;
}

}  // namespace ragtop::stability
