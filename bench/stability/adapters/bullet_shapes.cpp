#include "bullet_shapes.h"

#include <variant>

#include "peer.h"

namespace ragtop::stability {

btCollisionShape* BulletShapes::make(const BodyDef& def, const Frame& frame) {
    if (def.shapes.size() == 1) {
        const Frame local = inverse(frame) * def.shapes[0].frame;
        if (local == Frame{}) return make(def.shapes[0].geometry);
    }
    auto* compound = keep(std::make_unique<btCompoundShape>());
    for (const ShapeDef& shape : def.shapes)
        compound->addChildShape(toBullet(inverse(frame) * shape.frame), make(shape.geometry));
    return compound;
}

btCollisionShape* BulletShapes::make(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) return keep(std::make_unique<btBoxShape>(toBullet(box->halfExtents)));
    if (const auto* ball = std::get_if<Sphere>(&shape)) return keep(std::make_unique<btSphereShape>(ball->radius));
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return keep(std::make_unique<btCapsuleShape>(capsule->radius, 2 * capsule->halfHeight));
    if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
        auto* result = keep(std::make_unique<btConvexHullShape>());
        for (const Vec3& vertex : hull->vertices()) result->addPoint(toBullet(vertex), false);
        result->recalcLocalAabb();
        // Its margin of 4 cm is outside of the points: blocks that touch would overlap by 8 cm.
        result->setMargin(0);
        return result;
    }
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return makeMesh(*mesh);
    refuse("Bullet: this shape");
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

}  // namespace ragtop::stability
