#include "fleet.h"

#if RAGTOP_WITH_BULLET

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace ragtop::fleet {

namespace {

btVector3 toBullet(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Owns what it is made of; Bullet's world refers to it.
class BulletFleet {
public:
    BulletFleet(const Course& course, const Terrain& terrain, const VehicleDef& def)
        : dispatcher_(&configuration_),
          world_(&dispatcher_, &broadphase_, &solver_, &configuration_),
          raycaster_(&world_),
          angle_(Course::wheelAngle(def)) {
        world_.setGravity({0, -9.81f, 0});
        addGround(terrain);
        for (int i = 0; i < course.cars; ++i) {
            DVec3 place = course.placeOf(i);
            place.y = static_cast<double>(terrain.heightAt(place.x, place.z)) + 0.1;
            addCar(def, toVec3(place));
        }
    }
    ~BulletFleet() {
        for (const auto& car : cars_) world_.removeAction(car.get());
        for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    }
    BulletFleet(const BulletFleet&) = delete;
    BulletFleet& operator=(const BulletFleet&) = delete;

    void step() {
        for (const auto& car : cars_) drive(*car);
        world_.stepSimulation(static_cast<btScalar>(Course::kStep), 0);
    }
    double meanSpeed() const {
        double sum = 0;
        for (const auto& car : cars_) sum += static_cast<double>(car->getRigidBody()->getLinearVelocity().length());
        return sum / static_cast<double>(cars_.size());
    }
    int driving() const {
        return static_cast<int>(std::ranges::count_if(cars_, [](const auto& car) {
            const btRigidBody& body = *car->getRigidBody();
            return body.getLinearVelocity().length() > 1 && body.getWorldTransform().getBasis()[1][1] > 0.7f;
        }));
    }

private:
    void addFixed(btCollisionShape* shape, const btVector3& place) {
        bodies_.push_back(std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shape)));
        bodies_.back()->setWorldTransform(btTransform(btQuaternion::getIdentity(), place));
        world_.addRigidBody(bodies_.back().get());
    }

    template <class ShapeType, class... Arguments>
    ShapeType* keep(Arguments&&... arguments) {
        auto shape = std::make_unique<ShapeType>(std::forward<Arguments>(arguments)...);
        ShapeType* const raw = shape.get();
        shapes_.push_back(std::move(shape));
        return raw;
    }

    void addGround(const Terrain& terrain) {
        if (terrain.heights.empty()) {
            addFixed(keep<btStaticPlaneShape>(btVector3(0, 1, 0), 0.0f), {0, 0, 0});
        } else if (terrain.triangles) {
            vertices_ = terrain.vertices();
            indices_ = terrain.indices();
            triangles_ = std::make_unique<btTriangleIndexVertexArray>(
                static_cast<int>(indices_.size() / 3), indices_.data(), static_cast<int>(3 * sizeof(int)),
                static_cast<int>(vertices_.size()), &vertices_[0].x, static_cast<int>(sizeof(Vec3)));
            addFixed(keep<btBvhTriangleMeshShape>(triangles_.get(), true), {0, 0, 0});
        } else {
            heights_ = terrain.heights;
            const auto [low, high] = std::ranges::minmax(heights_);
            auto* field = keep<btHeightfieldTerrainShape>(terrain.columns, terrain.columns, heights_.data(), 1.0f, low,
                                                          high, 1, PHY_FLOAT, false);
            field->setLocalScaling({Terrain::kSpacing, 1, Terrain::kSpacing});
            field->buildAccelerator();
            addFixed(field, {0, 0.5f * (low + high), 0});
        }
        for (const Terrain::Block& block : terrain.blocks)
            addFixed(keep<btBoxShape>(toBullet(block.halfExtents)), toBullet(toVec3(block.center)));
    }

    /// Struts of 1.5 Hz and about a third of critical damping, as those of the definition.
    void addCar(const VehicleDef& def, const Vec3& place) {
        const Vec3 center = def.chassis.centerOfMass.value_or(Vec3{0, 0.5f, 0});
        auto* compound = keep<btCompoundShape>();
        for (const auto& part : def.chassis.shapes)
            if (const auto* box = std::get_if<Box>(&part.shape))
                compound->addChildShape(
                    btTransform(btQuaternion::getIdentity(), toBullet(part.frame.position - center)),
                    keep<btBoxShape>(toBullet(box->halfExtents)));
        if (compound->getNumChildShapes() == 0)
            compound->addChildShape(btTransform(btQuaternion::getIdentity(), {0, 0.2f, 0}),
                                    keep<btBoxShape>(btVector3(0.8f, 0.4f, 1.9f)));
        btVector3 inertia;
        compound->calculateLocalInertia(def.chassis.mass, inertia);
        bodies_.push_back(std::make_unique<btRigidBody>(
            btRigidBody::btRigidBodyConstructionInfo(def.chassis.mass, nullptr, compound, inertia)));
        btRigidBody& body = *bodies_.back();
        body.setWorldTransform(btTransform(btQuaternion::getIdentity(), toBullet(place + center)));
        body.setLinearVelocity({0, 0, Course::kSpeed});
        body.setActivationState(DISABLE_DEACTIVATION);
        world_.addRigidBody(&body);
        cars_.push_back(std::make_unique<btRaycastVehicle>(tuning_, &body, &raycaster_));
        cars_.back()->setCoordinateSystem(0, 1, 2);
        world_.addAction(cars_.back().get());
        for (const WheelDef& wheel : def.wheels) addWheel(*cars_.back(), wheel, center);
    }

    static void addWheel(btRaycastVehicle& car, const WheelDef& wheel, const Vec3& center) {
        constexpr float kRest = 0.3f;
        btRaycastVehicle::btVehicleTuning tuning;
        tuning.m_suspensionStiffness = 90;
        tuning.m_suspensionDamping = 6;
        tuning.m_suspensionCompression = 4;
        tuning.m_frictionSlip = 1;
        tuning.m_maxSuspensionForce = 20000;
        const Vec3 hub = wheel.position - center + Vec3{0, kRest - 0.03f, 0};
        btWheelInfo& info =
            car.addWheel(toBullet(hub), {0, -1, 0}, {-1, 0, 0}, kRest, wheel.radius, tuning, wheel.steerFactor != 0);
        info.m_rollInfluence = 0.1f;
    }

    /// A pull like that of the definition's engine.
    void drive(btRaycastVehicle& car) const {
        const float speed = car.getRigidBody()->getLinearVelocity().length();
        for (int i = 0; i < car.getNumWheels(); ++i) {
            if (!car.getWheelInfo(i).m_bIsFrontWheel) continue;
            car.setSteeringValue(angle_, i);
            car.applyEngineForce(2000 * Course::throttleAt(speed), i);
        }
    }

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_;
    btDefaultVehicleRaycaster raycaster_;
    btRaycastVehicle::btVehicleTuning tuning_;
    float angle_;  ///< rad
    std::vector<float> heights_;
    std::vector<Vec3> vertices_;
    std::vector<int> indices_;
    std::unique_ptr<btTriangleIndexVertexArray> triangles_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<std::unique_ptr<btRaycastVehicle>> cars_;
};

}  // namespace

std::optional<Result> driveBullet(const Course& course, const Terrain& terrain, const VehicleDef& def) {
    BulletFleet fleet(course, terrain, def);
    for (int i = 0; i < Course::kWarmSteps; ++i) fleet.step();
    const double start = now(course);
    for (int i = 0; i < Course::kSteps; ++i) fleet.step();
    Result result;
    result.microseconds = 1e6 * (now(course) - start) / (course.cars * Course::kSteps);
    result.speed = fleet.meanSpeed();
    result.driving = fleet.driving();
    return result;
}

}  // namespace ragtop::fleet

#else

namespace ragtop::fleet {

std::optional<Result> driveBullet(const Course&, const Terrain&, const VehicleDef&) { return {}; }

}  // namespace ragtop::fleet

#endif
