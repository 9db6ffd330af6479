#include <cmath>
#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/config.hpp>
#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/DantzigBoxedLcpSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>
#include <memory>
#include <vector>

#include "trees.h"

namespace ragtop::stability {
namespace {

using Vector = Eigen::Vector3d;
using Transform = Eigen::Isometry3d;

Vector toVector(const Vec3& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
Vec3 fromVector(const Vector& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
Transform toTransform(const Pose& p) {
    const Quat& q = p.rotation;
    Transform result = Transform::Identity();
    result.translation() = Vector(p.position.x, p.position.y, p.position.z);
    result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
    return result;
}
Transform toTransform(const Frame& f) { return toTransform(Pose{DVec3{f.position}, f.rotation}); }

std::unique_ptr<dart::constraint::ConstraintSolver> makeSolver(const DartOptions& options) {
    using namespace dart::constraint;
    if (!options.sweeps) return std::make_unique<BoxedLcpConstraintSolver>();
    const auto sweeps = std::make_shared<PgsBoxedLcpSolver>();
    PgsBoxedLcpSolver::Option option;
    option.mMaxIteration = options.iterations;
    sweeps->setOption(option);
    return std::make_unique<BoxedLcpConstraintSolver>(sweeps, nullptr);
}

/// DART 6.12 with default settings: reduced coordinates, its own detector of collisions, pyramids of friction;
/// Dantzig's pivoting, with sweeps where it fails, or sweeps alone.
class DartEngine : public Engine {
public:
    DartEngine(const Scene& scene, const DartOptions& options)
        : peers_(scene), trees_(scene, peers_), options_(options) {
        nodes_.resize(scene.bodies.size());
        world_->setConstraintSolver(makeSolver(options));
        world_->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
        world_->setGravity(toVector(scene.settings.gravity));
        for (const int i : trees_.parentsFirst()) addBody(i, scene);
        for (std::size_t i = 0; i < scene.joints.size(); ++i)
            if (!trees_.has(static_cast<int>(i))) closeLoop(scene.joints[i]);
    }

    void step(double dt) override {
        world_->setTimeStep(dt);
        world_->step();
    }
    BodyMotion motion(int i) const override {
        const Transform& t = node(i).getWorldTransform();
        const Eigen::Quaterniond q(t.linear());
        const Pose pose{{t.translation().x(), t.translation().y(), t.translation().z()},
                        fromEigenQuaternion(q.w(), q.x(), q.y(), q.z())};
        return {peers_.ownPose(i, pose), fromVector(node(i).getCOMLinearVelocity()),
                fromVector(node(i).getAngularVelocity())};
    }
    /// Of a body that hangs on another one only what its joint lets it have.
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        dart::dynamics::Joint* joint = node(i).getParentJoint();
        if (auto* free = dynamic_cast<dart::dynamics::FreeJoint*>(joint)) {
            free->setLinearVelocity(toVector(linear));
            free->setAngularVelocity(toVector(angular));
            return;
        }
        const dart::dynamics::BodyNode* parent = node(i).getParentBodyNode();
        Vector turning = toVector(angular);
        if (parent) turning -= parent->getAngularVelocity();
        const Eigen::MatrixXd turns = joint->getRelativeJacobian().topRows<3>();
        joint->setVelocities(turns.completeOrthogonalDecomposition().solve(
            Eigen::VectorXd(node(i).getWorldTransform().linear().transpose() * turning)));
    }
    void push(int i, const Vec3& force, const DVec3& point) override {
        node(i).addExtForce(toVector(force), Vector(point.x, point.y, point.z), false, false);
    }
    void remove(int) override { refuse("DART: taking bodies away"); }
    double normalForce(int a, int b) const override {
        double sum = 0;
        for (const auto& contact : world_->getLastCollisionResult().getContacts()) {
            const auto *first = nodeOf(contact.collisionObject1), *second = nodeOf(contact.collisionObject2);
            if ((first == &node(a) && second == &node(b)) || (first == &node(b) && second == &node(a)))
                sum += std::abs(contact.force.dot(contact.normal));
        }
        return sum;
    }
    StepWork work() const override {
        return {static_cast<int>(world_->getLastCollisionResult().getNumContacts()),
                options_.sweeps ? options_.iterations : 0};
    }

private:
    using BodyNode = dart::dynamics::BodyNode;
    BodyNode& node(int i) const { return *nodes_[static_cast<std::size_t>(i)]; }
    static const BodyNode* nodeOf(const dart::collision::CollisionObject* object) {
        return object->getShapeFrame()->asShapeNode()->getBodyNodePtr().get();
    }
    static Quat fromEigenQuaternion(double w, double x, double y, double z) {
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), static_cast<float>(w)};
    }

    void addBody(int i, const Scene& scene) {
        const BodyDef& def = peers_.def(i);
        if (def.type == BodyType::kinematic) refuse("DART: body moved by its speed");
        const int joint = trees_.node(i).joint;
        if (joint == TreeNode::kFree)
            addRoot(i);
        else
            hang(i, scene.joints[static_cast<std::size_t>(joint)]);
        if (def.type == BodyType::dynamic) {
            const Inertial& inertial = peers_.inertial(i);
            node(i).setInertia(dart::dynamics::Inertia(inertial.mass, Vector::Zero(),
                                                       Eigen::Matrix3d(toVector(inertial.moments).asDiagonal())));
            setVelocity(i, def.linearVelocity, def.angularVelocity);
        }
        for (const ShapeDef& shape : def.shapes) addShape(i, shape);
    }
    dart::dynamics::SkeletonPtr newSkeleton() {
        const auto skeleton = dart::dynamics::Skeleton::create("s" + std::to_string(world_->getNumSkeletons()));
        skeleton->enableSelfCollisionCheck();
        world_->addSkeleton(skeleton);
        return skeleton;
    }
    void addRoot(int i) {
        const auto skeleton = newSkeleton();
        const Transform start = toTransform(peers_.startPose(i));
        if (peers_.def(i).type == BodyType::fixed) {
            const auto [joint, body] = skeleton->createJointAndBodyNodePair<dart::dynamics::WeldJoint>();
            joint->setTransformFromParentBodyNode(start);
            nodes_[static_cast<std::size_t>(i)] = body;
        } else {
            const auto [joint, body] = skeleton->createJointAndBodyNodePair<dart::dynamics::FreeJoint>();
            joint->setTransform(start);
            nodes_[static_cast<std::size_t>(i)] = body;
        }
    }
    /// The joint's coordinates are 0 where the scene begins.
    void hang(int i, const SceneJoint& by) {
        const int above = trees_.node(i).parent;
        BodyNode* parent = above == kWorld || peers_.def(above).type == BodyType::fixed ? nullptr : &node(above);
        const auto skeleton = parent ? parent->getSkeleton() : newSkeleton();
        const JointBodies& frames = bodiesOf(by.def);
        const bool second = i == by.bodyB;
        const Frame own = peers_.local(i, second ? frames.frameB : frames.frameA);
        const Transform start = toTransform(peers_.startPose(i)), inOwn = toTransform(own);
        const Transform above0 = parent ? toTransform(peers_.startPose(above)) : Transform::Identity();
        dart::dynamics::Joint* joint = nullptr;
        BodyNode*& body = nodes_[static_cast<std::size_t>(i)];
        if (const auto* ball = std::get_if<BallDef>(&by.def); ball && isFree(*ball)) {
            std::tie(joint, body) = skeleton->createJointAndBodyNodePair<dart::dynamics::BallJoint>(parent);
        } else if (const auto* hinge = std::get_if<HingeDef>(&by.def); hinge && isFree(*hinge)) {
            const auto [made, hung] = skeleton->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(parent);
            made->setAxis(Vector::UnitX());
            joint = made;
            body = hung;
        } else {
            refuse("DART: this joint");
        }
        joint->setTransformFromParentBodyNode(above0.inverse() * start * inOwn);
        joint->setTransformFromChildBodyNode(inOwn);
    }
    void addShape(int i, const ShapeDef& shape) {
        if (shape.filter.mask == 0) return;
        const Material& material = shape.material;
        if (material.surfaceVelocity != Vec3{} || material.rollingResistance != 0) refuse("DART: this material");
        // It takes the smaller friction of two; that is the geometric mean when they are equal.
        if (friction_ >= 0 && material.friction != friction_) refuse("DART: different frictions");
        friction_ = material.friction;
        using namespace dart::dynamics;
        ShapePtr made;
        if (const auto* box = std::get_if<Box>(&shape.geometry))
            made = std::make_shared<BoxShape>(2 * toVector(box->halfExtents));
        else if (const auto* ball = std::get_if<Sphere>(&shape.geometry))
            made = std::make_shared<SphereShape>(static_cast<double>(ball->radius));
        else
            refuse("DART: this shape");
        ShapeNode* placed = node(i).createShapeNodeWith<CollisionAspect, DynamicsAspect>(made);
        placed->setRelativeTransform(toTransform(peers_.local(i, shape.frame)));
        placed->getDynamicsAspect()->setFrictionCoeff(static_cast<double>(material.friction));
        // Of two bodies the product counts.
        placed->getDynamicsAspect()->setRestitutionCoeff(std::sqrt(static_cast<double>(material.restitution)));
    }
    /// By a point, or two of the axis, a decimetre to each side.
    void closeLoop(const SceneJoint& scene) {
        const int body = scene.bodyA == kWorld ? scene.bodyB : scene.bodyA;
        const int other = scene.bodyA == kWorld ? kWorld : scene.bodyB;
        const JointBodies& frames = bodiesOf(scene.def);
        const Frame own = body == scene.bodyA ? frames.frameA : frames.frameB;
        const Transform at = toTransform(peers_.def(body).pose * own);
        const auto close = [&](const Vector& offset) {
            const Vector point = at * offset;
            using dart::constraint::BallJointConstraint;
            world_->getConstraintSolver()->addConstraint(
                other == kWorld ? std::make_shared<BallJointConstraint>(&node(body), point)
                                : std::make_shared<BallJointConstraint>(&node(body), &node(other), point));
        };
        if (const auto* ball = std::get_if<BallDef>(&scene.def); ball && isFree(*ball)) return close(Vector::Zero());
        const auto* hinge = std::get_if<HingeDef>(&scene.def);
        if (!hinge || !isFree(*hinge)) refuse("DART: this joint");
        close(-0.1 * Vector::UnitX());
        close(0.1 * Vector::UnitX());
    }

    PeerBodies peers_;
    Trees trees_;
    DartOptions options_;
    dart::simulation::WorldPtr world_ = dart::simulation::World::create();
    std::vector<BodyNode*> nodes_;
    float friction_ = -1;
};

}  // namespace

std::unique_ptr<Engine> makeDart(const Scene& scene, const DartOptions& options) {
    return std::make_unique<DartEngine>(scene, options);
}
std::string dartVersion() { return DART_VERSION; }

}  // namespace ragtop::stability
