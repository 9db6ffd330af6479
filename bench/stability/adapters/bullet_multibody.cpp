#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>
#include <vector>

#include "bullet_shapes.h"
#include "trees.h"

namespace ragtop::stability {
namespace {

/// Bullet 3.24's multibodies, one for each tree of joints and one for each free body; without the damping that they
/// have by default and rigid bodies have not.
class BulletMultibodyEngine : public Engine {
public:
    BulletMultibodyEngine(const Scene& scene, const BulletOptions& options)
        : peers_(scene),
          trees_(scene, peers_),
          options_(options),
          dispatcher_(&configuration_),
          world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
        world_.setGravity(toBullet(scene.settings.gravity));
        world_.getSolverInfo().m_numIterations = options.iterations;
        places_.resize(scene.bodies.size());
        for (int i = 0; i < peers_.count(); ++i)
            if (trees_.node(i).parent == kWorld || isFixed(trees_.node(i).parent)) addTree(i, scene);
        for (std::size_t i = 0; i < scene.joints.size(); ++i)
            if (!trees_.has(static_cast<int>(i))) closeLoop(scene.joints[i]);
        for (const int i : trees_.parentsFirst())
            if (!isFixed(i)) setVelocity(i, peers_.def(i).linearVelocity, peers_.def(i).angularVelocity);
    }
    ~BulletMultibodyEngine() override {
        for (const auto& loop : loops_) world_.removeMultiBodyConstraint(loop.get());
        for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
        for (const auto& tree : multibodies_) world_.removeMultiBody(tree.get());
    }

    void step(double dt) override {
        dt_ = dt / options_.substeps;
        for (int i = 0; i < options_.substeps; ++i) {
            // Forces are cleared after each step of Bullet's.
            for (const Push& push : pushes_) apply(push);
            world_.stepSimulation(static_cast<btScalar>(dt_), 0);
        }
        pushes_.clear();
    }
    BodyMotion motion(int i) const override {
        if (isFixed(i)) return {peers_.def(i).pose, {}, {}};
        const auto [tree, link] = place(i);
        const btTransform t = transformOf(i);
        std::vector<btVector3> w(static_cast<std::size_t>(tree->getNumLinks()) + 1), v(w.size());
        tree->compTreeLinkVelocities(w.data(), v.data());
        const auto k = static_cast<std::size_t>(link + 1);
        const Pose pose{DVec3{fromBullet(t.getOrigin())}, fromBullet(t.getRotation())};
        return {peers_.ownPose(i, pose), fromBullet(t.getBasis() * v[k]), fromBullet(t.getBasis() * w[k])};
    }
    /// Of a body that hangs on another one only what its joint lets it have.
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        const auto [tree, link] = place(i);
        if (link < 0) {
            tree->setBaseVel(toBullet(linear));
            tree->setBaseOmega(toBullet(angular));
            return;
        }
        const int above = trees_.node(i).parent;
        const Vec3 parent = above == kWorld ? Vec3{} : motion(above).w;
        const btVector3 turning = toBullet(angular - parent) * transformOf(i).getBasis();
        if (tree->getLink(link).m_jointType == btMultibodyLink::eRevolute) {
            tree->setJointVel(link, turning.dot(tree->getLink(link).getAxisTop(0)));
        } else {
            const btScalar all[3] = {turning.x(), turning.y(), turning.z()};
            tree->setJointVelMultiDof(link, all);
        }
    }
    void push(int i, const Vec3& force, const DVec3& point) override {
        pushes_.push_back({i, toBullet(force), toBullet(toVec3(point))});
    }
    void remove(int) override { refuse("Bullet's multibodies: taking bodies away"); }
    double normalForce(int a, int b) const override { return normalImpulse(dispatcher_, a, b) / dt_; }
    StepWork work() const override { return {contactCount(dispatcher_), options_.substeps * options_.iterations}; }

private:
    struct Place {
        btMultiBody* tree = nullptr;
        int link = -1;  ///< −1 is the base
    };
    struct Push {
        int body;
        btVector3 force, point;
    };
    const Place& place(int i) const { return places_[static_cast<std::size_t>(i)]; }
    bool isFixed(int i) const { return i == kWorld || peers_.def(i).type == BodyType::fixed; }
    btTransform transformOf(int i) const {
        const auto [tree, link] = place(i);
        const btVector3 zero(0, 0, 0);
        return btTransform(tree->localFrameToWorld(link, btMatrix3x3::getIdentity()),
                           tree->localPosToWorld(link, zero));
    }
    void apply(const Push& push) {
        const auto [tree, link] = place(push.body);
        const btVector3 moment = (push.point - transformOf(push.body).getOrigin()).cross(push.force);
        if (link < 0) {
            tree->addBaseForce(push.force);
            tree->addBaseTorque(moment);
        } else {
            tree->addLinkForce(link, push.force);
            tree->addLinkTorque(link, moment);
        }
    }

    /// A free body with all that hangs on it, or what hangs on the world.
    void addTree(int root, const Scene& scene) {
        const BodyDef& def = peers_.def(root);
        if (def.type == BodyType::kinematic) refuse("Bullet's multibodies: body moved by its speed");
        if (def.type == BodyType::fixed) return addCollider(root, std::make_unique<btCollisionObject>());
        const bool hangs = trees_.node(root).joint != TreeNode::kFree;
        std::vector<int> links = hangs ? std::vector{root} : trees_.node(root).children;
        for (std::size_t k = 0; k < links.size(); ++k) {
            const std::vector<int>& children = trees_.node(links[k]).children;
            links.insert(links.end(), children.begin(), children.end());
        }
        const Inertial& inertial = peers_.inertial(root);
        multibodies_.push_back(std::make_unique<btMultiBody>(
            static_cast<int>(links.size()), hangs ? 0 : static_cast<btScalar>(inertial.mass),
            hangs ? btVector3(0, 0, 0) : toBullet(inertial.moments), hangs, false));
        btMultiBody& tree = *multibodies_.back();
        tree.setLinearDamping(0);
        tree.setAngularDamping(0);
        if (!hangs) {
            const btTransform start = toBullet(peers_.startPose(root));
            tree.setBasePos(start.getOrigin());
            tree.setWorldToBaseRot(start.getRotation().inverse());
            places_[static_cast<std::size_t>(root)] = {&tree, -1};
        }
        for (std::size_t k = 0; k < links.size(); ++k) addLink(tree, static_cast<int>(k), links[k], scene);
        tree.finalizeMultiDof();
        world_.addMultiBody(&tree);
        if (!hangs) addTreeCollider(root);
        for (const int link : links) addTreeCollider(link);
    }
    /// The joint's coordinates are 0 where the scene begins.
    void addLink(btMultiBody& tree, int link, int i, const Scene& scene) {
        const TreeNode& node = trees_.node(i);
        const SceneJoint& by = scene.joints[static_cast<std::size_t>(node.joint)];
        const JointBodies& frames = bodiesOf(by.def);
        const Frame own = peers_.local(i, i == by.bodyB ? frames.frameB : frames.frameA);
        const bool onBase = isFixed(node.parent);
        const int parent = onBase ? -1 : place(node.parent).link;
        const btTransform above = onBase ? btTransform::getIdentity() : toBullet(peers_.startPose(node.parent));
        const btTransform start = toBullet(peers_.startPose(i));
        const btVector3 pivot = toBullet(own.position);
        const btVector3 toPivot = above.inverse() * (start * pivot);
        const btQuaternion turn = start.getRotation().inverse() * above.getRotation();
        const Inertial& inertial = peers_.inertial(i);
        const auto mass = static_cast<btScalar>(inertial.mass);
        const btVector3 moments = toBullet(inertial.moments);
        if (const auto* ball = std::get_if<BallDef>(&by.def); ball && isFree(*ball))
            tree.setupSpherical(link, mass, moments, parent, turn, toPivot, -pivot, true);
        else if (const auto* hinge = std::get_if<HingeDef>(&by.def); hinge && isFree(*hinge))
            tree.setupRevolute(link, mass, moments, parent, turn, toBullet(rotate(own.rotation, {1, 0, 0})), toPivot,
                               -pivot, true);
        else
            refuse("Bullet's multibodies: this joint");
        places_[static_cast<std::size_t>(i)] = {&tree, link};
    }
    void addTreeCollider(int i) {
        const auto [tree, link] = place(i);
        auto collider = std::make_unique<btMultiBodyLinkCollider>(tree, link);
        if (link < 0)
            tree->setBaseCollider(collider.get());
        else
            tree->getLink(link).m_collider = collider.get();
        addCollider(i, std::move(collider));
    }
    void addCollider(int i, std::unique_ptr<btCollisionObject> collider) {
        const BodyDef& def = peers_.def(i);
        const Material& material = def.shapes.at(0).material;
        if (material.surfaceVelocity != Vec3{} || material.rollingResistance != 0)
            refuse("Bullet's multibodies: this material");
        collider->setCollisionShape(shapes_.make(def, peers_.inertial(i).frame));
        collider->setWorldTransform(toBullet(peers_.startPose(i)));
        collider->setUserIndex(i);
        // Bullet multiplies what two bodies have; together the roots give the geometric mean.
        collider->setFriction(std::sqrt(material.friction));
        collider->setRestitution(std::sqrt(material.restitution));
        const Filter& filter = def.shapes[0].filter;
        world_.addCollisionObject(collider.get(), static_cast<int>(filter.category), static_cast<int>(filter.mask));
        colliders_.push_back(std::move(collider));
    }
    /// By a point, or two of the axis, a decimetre to each side.
    void closeLoop(const SceneJoint& scene) {
        // A constraint is one of a body, with another or the world.
        const bool swapped = isFixed(scene.bodyA);
        const int a = swapped ? scene.bodyB : scene.bodyA, b = swapped ? scene.bodyA : scene.bodyB;
        const JointBodies& frames = bodiesOf(scene.def);
        const Frame inA = peers_.local(a, swapped ? frames.frameB : frames.frameA);
        const auto close = [&](const Vec3& offset) {
            const Vec3 pivot = transformPoint(inA, offset);
            const btVector3 inB = (isFixed(b) ? btTransform::getIdentity() : toBullet(peers_.startPose(b))).inverse() *
                                  (toBullet(peers_.startPose(a)) * toBullet(pivot));
            loops_.push_back(isFixed(b)
                                 ? std::make_unique<btMultiBodyPoint2Point>(place(a).tree, place(a).link, nullptr,
                                                                            toBullet(pivot), inB)
                                 : std::make_unique<btMultiBodyPoint2Point>(place(a).tree, place(a).link, place(b).tree,
                                                                            place(b).link, toBullet(pivot), inB));
            world_.addMultiBodyConstraint(loops_.back().get());
        };
        if (const auto* ball = std::get_if<BallDef>(&scene.def); ball && isFree(*ball)) return close({});
        const auto* hinge = std::get_if<HingeDef>(&scene.def);
        if (!hinge || !isFree(*hinge)) refuse("Bullet's multibodies: this joint");
        close({-0.1f, 0, 0});
        close({0.1f, 0, 0});
    }

    PeerBodies peers_;
    Trees trees_;
    BulletOptions options_;
    double dt_ = 1;
    BulletShapes shapes_{BulletShapes::Hulls::shrunk};
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    std::vector<std::unique_ptr<btMultiBody>> multibodies_;
    std::vector<std::unique_ptr<btCollisionObject>> colliders_;
    std::vector<std::unique_ptr<btMultiBodyConstraint>> loops_;
    std::vector<Place> places_;
    std::vector<Push> pushes_;
    btMultiBodyDynamicsWorld world_;
};

}  // namespace

std::unique_ptr<Engine> makeBulletMultibody(const Scene& scene, const BulletOptions& options) {
    return std::make_unique<BulletMultibodyEngine>(scene, options);
}

}  // namespace ragtop::stability
