#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>
#include <vector>

#include "ragtop/body.h"

namespace ragtop::stability {

inline btVector3 toBullet(const Vec3& v) { return {v.x, v.y, v.z}; }
inline btQuaternion toBullet(const Quat& q) { return {q.x, q.y, q.z, q.w}; }
inline btTransform toBullet(const Frame& f) { return btTransform(toBullet(f.rotation), toBullet(f.position)); }
inline btTransform toBullet(const Pose& p) { return btTransform(toBullet(p.rotation), toBullet(toVec3(p.position))); }
inline float fromBullet(btScalar s) { return static_cast<float>(s); }
inline Vec3 fromBullet(const btVector3& v) { return {fromBullet(v.x()), fromBullet(v.y()), fromBullet(v.z())}; }
inline Quat fromBullet(const btQuaternion& q) {
    return {fromBullet(q.x()), fromBullet(q.y()), fromBullet(q.z()), fromBullet(q.w())};
}

/// N s, along their normals, of the last step's contacts between two bodies of these user indices.
double normalImpulse(const btCollisionDispatcher& dispatcher, int a, int b);
/// Points of all contacts.
int contactCount(const btCollisionDispatcher& dispatcher);

/// Makes Bullet's shapes and keeps them.
class BulletShapes {
public:
    enum class Hulls {
        shrunk,    ///< so that with Bullet's margin they are as large as they should be
        enlarged,  ///< as they are, the margin around them
    };
    explicit BulletShapes(Hulls hulls) : hulls_(hulls) {}
    /// All shapes of a body in one, in the frame given.
    btCollisionShape* make(const BodyDef& def, const Frame& frame);

private:
    btCollisionShape* make(const Shape& shape);
    btCollisionShape* makeHull(const ConvexHull& hull);
    btCollisionShape* makeEnlarged(const ConvexHull& hull, const Frame& frame);
    btCollisionShape* makeMesh(const TriangleMesh& mesh);
    template <class T>
    T* keep(std::unique_ptr<T> shape) {
        T* raw = shape.get();
        shapes_.push_back(std::move(shape));
        return raw;
    }
    Hulls hulls_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
};

}  // namespace ragtop::stability
