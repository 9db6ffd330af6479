#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>
#include <vector>

#include "../scenery.h"
#include "bullet_shapes.h"
#include "peer.h"

namespace ragtop::stability {
namespace {

/// Moves a body that is moved by its speed, where Bullet asks for it.
class KinematicMotion : public btMotionState {
public:
    explicit KinematicMotion(const btTransform& start) : transform_(start) {}
    void getWorldTransform(btTransform& transform) const override { transform = transform_; }
    void setWorldTransform(const btTransform&) override {}
    void advance(const btVector3& v, const btVector3& w, btScalar dt) {
        btTransform next;
        btTransformUtil::integrateTransform(transform_, v, w, dt, next);
        transform_ = next;
    }

private:
    btTransform transform_;
};

/// Also lets bodies of one negative group pass through each other; the group is the proxy's body's second index.
struct GroupFilter : btOverlapFilterCallback {
    bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
        if ((a->m_collisionFilterGroup & b->m_collisionFilterMask) == 0) return false;
        if ((b->m_collisionFilterGroup & a->m_collisionFilterMask) == 0) return false;
        const int group = groupOf(*a);
        return group >= 0 || group != groupOf(*b);
    }
    static int groupOf(const btBroadphaseProxy& proxy) {
        return static_cast<const btCollisionObject*>(proxy.m_clientObject)->getUserIndex2();
    }
};

std::unique_ptr<btSequentialImpulseConstraintSolver> makeSolver(BulletSolver solver) {
    if (solver == BulletSolver::nncg) return std::make_unique<btNNCGConstraintSolver>();
    return std::make_unique<btSequentialImpulseConstraintSolver>();
}

/// Bullet 3.24 with default settings.
class BulletEngine : public Engine {
public:
    BulletEngine(const Scene& scene, const BulletOptions& options)
        : peers_(scene),
          options_(options),
          shapes_(options.yardstick ? BulletShapes::Hulls::enlarged : BulletShapes::Hulls::shrunk),
          sleeping_(options.yardstick && scene.settings.sleeping),
          dispatcher_(&configuration_),
          solver_(makeSolver(options.solver)),
          world_(&dispatcher_, &broadphase_, solver_.get(), &configuration_) {
        world_.setGravity(toBullet(scene.settings.gravity));
        world_.getSolverInfo().m_numIterations = options.iterations;
        broadphase_.getOverlappingPairCache()->setOverlapFilterCallback(&filter_);
        for (int i = 0; i < peers_.count(); ++i) addBody(i);
        for (const SceneJoint& joint : scene.joints) addJoint(joint);
    }
    ~BulletEngine() override {
        for (const auto& joint : joints_) world_.removeConstraint(joint.get());
        for (const auto& body : bodies_)
            if (body->isInWorld()) world_.removeRigidBody(body.get());
    }

    void step(double dt) override {
        dt_ = dt / options_.substeps;
        for (int i = 0; i < options_.substeps; ++i) {
            // Forces are cleared after each step of Bullet's.
            for (const Push& push : pushes_)
                body(push.body).applyForce(push.force, push.point - body(push.body).getCenterOfMassPosition());
            for (std::size_t k = 0; k < kinematic_.size(); ++k) {
                const BodyDef& def = peers_.def(kinematicBodies_[k]);
                kinematic_[k]->advance(toBullet(def.linearVelocity), toBullet(def.angularVelocity),
                                       static_cast<btScalar>(dt_));
            }
            world_.stepSimulation(static_cast<btScalar>(dt_), 0);
        }
        pushes_.clear();
    }
    BodyMotion motion(int i) const override {
        const btTransform& t = body(i).getWorldTransform();
        const Pose pose{DVec3{fromBullet(t.getOrigin())}, fromBullet(t.getRotation())};
        return {peers_.ownPose(i, pose), fromBullet(body(i).getLinearVelocity()),
                fromBullet(body(i).getAngularVelocity())};
    }
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        body(i).setLinearVelocity(toBullet(linear));
        body(i).setAngularVelocity(toBullet(angular));
    }
    void push(int i, const Vec3& force, const DVec3& point) override {
        pushes_.push_back({i, toBullet(force), toBullet(toVec3(point))});
    }
    int add(const BodyDef& def) override {
        peers_.add(def);
        addBody(peers_.count() - 1);
        return peers_.count() - 1;
    }
    void remove(int i) override { world_.removeRigidBody(&body(i)); }
    double normalForce(int a, int b) const override { return normalImpulse(dispatcher_, a, b) / dt_; }
    StepWork work() const override { return {contactCount(dispatcher_), options_.substeps * options_.iterations}; }

private:
    struct Push {
        int body;
        btVector3 force, point;
    };
    btRigidBody& body(int i) const { return *bodies_[static_cast<std::size_t>(i)]; }

    void addBody(int i) {
        const BodyDef& def = peers_.def(i);
        const Inertial& inertial = peers_.inertial(i);
        const Material& material = def.shapes.at(0).material;
        if (material.surfaceVelocity != Vec3{}) refuse("Bullet: surface velocity");
        if (material.rollingResistance != 0) refuse("Bullet: rolling resistance over load");
        const bool moves = def.type == BodyType::dynamic;
        btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(inertial.mass), nullptr,
                                                      shapes_.make(def, inertial.frame),
                                                      moves ? toBullet(inertial.moments) : btVector3(0, 0, 0));
        info.m_startWorldTransform = toBullet(peers_.startPose(i));
        // Bullet multiplies what two bodies have; together the roots give the geometric mean.
        info.m_friction = std::sqrt(material.friction);
        info.m_restitution = std::sqrt(material.restitution);
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        body(i).setUserIndex(i);
        body(i).setUserIndex2(def.shapes[0].filter.group);
        if (!sleeping_ || !def.allowSleep) body(i).setActivationState(DISABLE_DEACTIVATION);
        body(i).setLinearVelocity(toBullet(def.linearVelocity));
        body(i).setAngularVelocity(toBullet(def.angularVelocity));
        if (def.type == BodyType::kinematic) {
            kinematic_.push_back(std::make_unique<KinematicMotion>(info.m_startWorldTransform));
            kinematicBodies_.push_back(i);
            body(i).setMotionState(kinematic_.back().get());
            body(i).setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
        }
        const Filter& filter = def.shapes[0].filter;
        world_.addRigidBody(&body(i), static_cast<int>(filter.category), static_cast<int>(filter.mask));
    }

    void addJoint(const SceneJoint& joint) {
        const JointBodies& frames = bodiesOf(joint.def);
        const auto end = [&](int i) -> btRigidBody& { return i == kWorld ? btTypedConstraint::getFixedBody() : body(i); };
        btRigidBody &a = end(joint.bodyA), &b = end(joint.bodyB);
        // Bullet's hinges turn about z, its sliders go along x.
        const Frame z{{}, rotationBetween({0, 0, 1}, {1, 0, 0})};
        const auto frame = [&](int side, const Frame& f, const Frame& turn) {
            return toBullet(peers_.local(side, f) * turn);
        };
        if (const auto* ball = std::get_if<BallDef>(&joint.def)) {
            keep(ballConstraint(*ball, a, b, frame(joint.bodyA, frames.frameA, {}),
                                frame(joint.bodyB, frames.frameB, {})));
        } else if (const auto* hinge = std::get_if<HingeDef>(&joint.def)) {
            if (hinge->spring || hinge->motor || (hinge->friction != 0 && !options_.yardstick) || !isPlain(*hinge))
                refuse("Bullet: hinge with spring or motor");
            auto constraint = std::make_unique<btHingeConstraint>(a, b, frame(joint.bodyA, frames.frameA, z),
                                                                  frame(joint.bodyB, frames.frameB, z), true);
            if (hinge->limit) constraint->setLimit(hinge->limit->lower, hinge->limit->upper);
            if (hinge->friction != 0) constraint->enableAngularMotor(true, 0, hinge->friction * kYardstickStep);
            keep(std::move(constraint));
        } else if (const auto* slider = std::get_if<SliderDef>(&joint.def)) {
            if (slider->limit || slider->spring || slider->motor) refuse("Bullet: slider with extras");
            auto constraint = std::make_unique<btSliderConstraint>(a, b, frame(joint.bodyA, frames.frameA, {}),
                                                                   frame(joint.bodyB, frames.frameB, {}), true);
            constraint->setLowerLinLimit(1);
            constraint->setUpperLinLimit(-1);
            constraint->setLowerAngLimit(0);
            constraint->setUpperAngLimit(0);
            keep(std::move(constraint));
        } else {
            refuse("Bullet: this joint");
        }
        world_.addConstraint(joints_.back().get(), !frames.collide);
    }
    /// With limits as a pyramid, and dry friction as motors that want no speed.
    std::unique_ptr<btTypedConstraint> ballConstraint(const BallDef& ball, btRigidBody& a, btRigidBody& b,
                                                      const btTransform& frameA, const btTransform& frameB) const {
        if (ball.swingEllipse || ball.swingPyramid || ball.reach) refuse("Bullet: limited ball");
        if (!ball.swingLimit && !ball.twistLimit && !ball.spring && ball.friction == 0)
            return std::make_unique<btPoint2PointConstraint>(a, b, frameA.getOrigin(), frameB.getOrigin());
        if (!options_.yardstick || !ball.swingLimit || !ball.twistLimit || ball.spring) refuse("Bullet: limited ball");
        auto constraint = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, frameA, frameB);
        const btScalar swing = *ball.swingLimit;
        constraint->setLinearLowerLimit({0, 0, 0});
        constraint->setLinearUpperLimit({0, 0, 0});
        constraint->setAngularLowerLimit({ball.twistLimit->lower, -swing, -swing});
        constraint->setAngularUpperLimit({ball.twistLimit->upper, swing, swing});
        for (int axis = 3; axis < 6; ++axis) {
            constraint->enableMotor(axis, true);
            constraint->setTargetVelocity(axis, 0);
            constraint->setMaxMotorForce(axis, ball.friction);
        }
        return constraint;
    }
    void keep(std::unique_ptr<btTypedConstraint> joint) { joints_.push_back(std::move(joint)); }

    static constexpr float kYardstickStep = 1.0f / 60;  // s, for which Bullet wants an impulse

    PeerBodies peers_;
    BulletOptions options_;
    double dt_ = 1;
    BulletShapes shapes_;
    bool sleeping_;
    GroupFilter filter_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    std::unique_ptr<btSequentialImpulseConstraintSolver> solver_;
    std::vector<std::unique_ptr<KinematicMotion>> kinematic_;
    std::vector<int> kinematicBodies_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
    std::vector<Push> pushes_;
    btDiscreteDynamicsWorld world_;
};

}  // namespace

std::unique_ptr<Engine> makeBullet(const Scene& scene, const BulletOptions& options) {
    return std::make_unique<BulletEngine>(scene, options);
}
std::string bulletVersion() { return std::to_string(BT_BULLET_VERSION); }

}  // namespace ragtop::stability
