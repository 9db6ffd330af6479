#include <cmath>
#include <memory>
#include <vector>

#include "trees.h"

namespace SimTK {

/// Simbody 3.7 is older than C++20, in which its comparisons of indices are ambiguous; this one is nearer than they.
template <class Index>
requires requires(const Index& index) { index.isValidExtended(); }
bool operator==(const Index& a, const Index& b) { return static_cast<int>(a) == static_cast<int>(b); }

}  // namespace SimTK

#include <Simbody.h>

namespace ragtop::stability {
namespace {

SimTK::Vec3 toSimbody(const Vec3& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
Vec3 fromSimbody(const SimTK::Vec3& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
SimTK::Transform toSimbody(const Pose& p) {
    const Quat& q = p.rotation;
    return {SimTK::Rotation(SimTK::Quaternion(q.w, q.x, q.y, q.z)), {p.position.x, p.position.y, p.position.z}};
}
SimTK::Transform toSimbody(const Frame& f) { return toSimbody(Pose{DVec3{f.position}, f.rotation}); }

// Contact is as stiff as hard rubber; slip below the speed of transition counts as sticking.
constexpr double kStiffness = 1e7, kDissipation = 1;  // Pa, s/m
constexpr double kTransition = 1e-3;                  // m/s
constexpr float kFloor = 5;                           // m, half the width from which on a fixed box is one

/// Simbody 3.7: reduced coordinates, compliant contact, Runge-Kutta-Merson with the error control that it has, asked
/// for so many digits.
class SimbodyEngine : public Engine {
public:
    SimbodyEngine(const Scene& scene, const SimbodyOptions& options) : peers_(scene), trees_(scene, peers_) {
        SimTK::Force::UniformGravity(forces_, matter_, toSimbody(scene.settings.gravity));
        contact_.setTransitionVelocity(kTransition);
        bodies_.resize(scene.bodies.size());
        for (const int i : trees_.parentsFirst()) addBody(i, scene);
        for (std::size_t i = 0; i < scene.joints.size(); ++i)
            if (!trees_.has(static_cast<int>(i))) closeLoop(scene.joints[i]);
        SimTK::State state = system_.realizeTopology();
        system_.realizeModel(state);
        for (const int i : trees_.parentsFirst()) start(state, i);
        integrator_.setAccuracy(std::pow(10.0, -options.digits));
        integrator_.initialize(state);
    }

    void step(double dt) override {
        integrator_.setMaximumStepSize(dt);
        const double end = integrator_.getTime() + dt;
        const int before = integrator_.getNumStepsTaken();
        while (integrator_.getTime() < end)
            if (integrator_.stepTo(end, end) == SimTK::Integrator::EndOfSimulation) break;
        passes_ = integrator_.getNumStepsTaken() - before;
        if (!pushed_) return;
        pushed_ = false;
        pushes_.clearAllBodyForces(integrator_.updAdvancedState());
        integrator_.reinitialize(SimTK::Stage::Instance, false);
    }
    BodyMotion motion(int i) const override {
        if (bodies_[static_cast<std::size_t>(i)].isEmptyHandle()) return {peers_.def(i).pose, {}, {}};
        const SimTK::State& state = realized();
        const SimTK::Transform& t = body(i).getBodyTransform(state);
        const SimTK::Quaternion q = t.R().convertRotationToQuaternion();
        const auto part = [&](int k) { return static_cast<float>(q[k]); };
        const Pose pose{{t.p()[0], t.p()[1], t.p()[2]}, {part(1), part(2), part(3), part(0)}};
        return {peers_.ownPose(i, pose), fromSimbody(body(i).getBodyOriginVelocity(state)),
                fromSimbody(body(i).getBodyAngularVelocity(state))};
    }
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        giveVelocity(integrator_.updAdvancedState(), i, linear, angular);
        integrator_.reinitialize(SimTK::Stage::Position, false);
    }
    void push(int i, const Vec3& force, const DVec3& point) override {
        SimTK::State& state = integrator_.updAdvancedState();
        system_.realize(state, SimTK::Stage::Position);
        pushes_.addForceToBodyPoint(
            state, body(i), body(i).findStationAtGroundPoint(state, {point.x, point.y, point.z}), toSimbody(force));
        integrator_.reinitialize(SimTK::Stage::Instance, false);
        pushed_ = true;
    }
    void remove(int) override { refuse("Simbody: taking bodies away"); }
    double normalForce(int, int) const override { refuse("Simbody: normal forces"); }
    StepWork work() const override {
        const SimTK::State& state = realized();
        return {contact_.getNumContactForces(state), passes_};
    }

private:
    const SimTK::MobilizedBody& body(int i) const { return bodies_[static_cast<std::size_t>(i)]; }
    const SimTK::State& realized() const {
        const SimTK::State& state = integrator_.getState();
        system_.realize(state, SimTK::Stage::Dynamics);
        return state;
    }
    /// Of a body that hangs on another one only what its joint lets it have.
    void giveVelocity(SimTK::State& state, int i, const Vec3& linear, const Vec3& angular) const {
        system_.realize(state, SimTK::Stage::Velocity);
        const SimTK::MobilizedBody& moved = body(i);
        const SimTK::MobilizedBody& parent = moved.getParentMobilizedBody();
        const SimTK::Vec3 turning = toSimbody(angular) - parent.getBodyAngularVelocity(state);
        const SimTK::Rotation outboard = parent.getBodyRotation(state) * moved.getInboardFrame(state).R();
        moved.setUToFitAngularVelocity(state, ~outboard * turning);
        if (trees_.node(i).joint != TreeNode::kFree) return;
        moved.setUToFitLinearVelocity(state, ~outboard * toSimbody(linear));
    }
    void start(SimTK::State& state, int i) const {
        const BodyDef& def = peers_.def(i);
        if (def.type != BodyType::dynamic) return;
        if (trees_.node(i).joint == TreeNode::kFree) body(i).setQToFitTransform(state, toSimbody(peers_.startPose(i)));
        giveVelocity(state, i, def.linearVelocity, def.angularVelocity);
    }

    void addBody(int i, const Scene& scene) {
        const BodyDef& def = peers_.def(i);
        if (def.type == BodyType::kinematic) refuse("Simbody: body moved by its speed");
        if (def.type == BodyType::fixed) return addFloor(def);
        const Inertial& inertial = peers_.inertial(i);
        const Vec3& m = inertial.moments;
        SimTK::Body::Rigid rigid(SimTK::MassProperties(inertial.mass, SimTK::Vec3(0), SimTK::Inertia(m.x, m.y, m.z)));
        for (const ShapeDef& shape : def.shapes) addShape(rigid, i, shape);
        const int joint = trees_.node(i).joint;
        bodies_[static_cast<std::size_t>(i)] = joint == TreeNode::kFree
                                                   ? SimTK::MobilizedBody::Free(matter_.Ground(), rigid)
                                                   : hung(i, rigid, scene.joints[static_cast<std::size_t>(joint)]);
    }
    /// The joint's coordinates are 0 where the scene begins.
    SimTK::MobilizedBody hung(int i, const SimTK::Body& rigid, const SceneJoint& by) {
        const int above = trees_.node(i).parent;
        const bool onGround = above == kWorld || peers_.def(above).type == BodyType::fixed;
        SimTK::MobilizedBody& parent = onGround ? matter_.updGround() : bodies_[static_cast<std::size_t>(above)];
        const JointBodies& frames = bodiesOf(by.def);
        // Simbody's pins turn about z.
        const Frame own = peers_.local(i, i == by.bodyB ? frames.frameB : frames.frameA) *
                          Frame{{}, rotationBetween({0, 0, 1}, {1, 0, 0})};
        const SimTK::Transform inOwn = toSimbody(own);
        const SimTK::Transform from = onGround ? SimTK::Transform() : toSimbody(peers_.startPose(above));
        const SimTK::Transform inParent = ~from * toSimbody(peers_.startPose(i)) * inOwn;
        if (const auto* ball = std::get_if<BallDef>(&by.def); ball && isFree(*ball))
            return SimTK::MobilizedBody::Ball(parent, inParent, rigid, inOwn);
        if (const auto* hinge = std::get_if<HingeDef>(&by.def); hinge && isFree(*hinge))
            return SimTK::MobilizedBody::Pin(parent, inParent, rigid, inOwn);
        refuse("Simbody: this joint");
    }
    /// By a point, or two of the axis, a decimetre to each side.
    void closeLoop(const SceneJoint& scene) {
        const JointBodies& frames = bodiesOf(scene.def);
        const auto end = [&](int i) -> SimTK::MobilizedBody& {
            return i == kWorld ? matter_.updGround() : bodies_[static_cast<std::size_t>(i)];
        };
        const auto close = [&](const Vec3& offset) {
            const Vec3 a = transformPoint(peers_.local(scene.bodyA, frames.frameA), offset);
            const Vec3 b = transformPoint(peers_.local(scene.bodyB, frames.frameB), offset);
            SimTK::Constraint::Ball(end(scene.bodyA), toSimbody(a), end(scene.bodyB), toSimbody(b));
        };
        if (const auto* ball = std::get_if<BallDef>(&scene.def); ball && isFree(*ball)) return close({});
        const auto* hinge = std::get_if<HingeDef>(&scene.def);
        if (!hinge || !isFree(*hinge)) refuse("Simbody: this joint");
        close({-0.1f, 0, 0});
        close({0.1f, 0, 0});
    }

    /// Bricks touch half-spaces alone.
    void addFloor(const BodyDef& def) {
        for (const ShapeDef& shape : def.shapes) {
            const auto* box = std::get_if<Box>(&shape.geometry);
            if (!box || box->halfExtents.x < kFloor || box->halfExtents.z < kFloor) refuse("Simbody: this fixed shape");
            const Frame top{{0, box->halfExtents.y, 0}, rotationBetween({-1, 0, 0}, {0, 1, 0})};
            matter_.Ground().updBody().addContactSurface(
                toSimbody(def.pose * shape.frame * top),
                SimTK::ContactSurface(SimTK::ContactGeometry::HalfSpace(), materialOf(shape.material)));
        }
    }
    void addShape(SimTK::Body& rigid, int i, const ShapeDef& shape) {
        if (shape.filter.mask == 0) return;
        const SimTK::Transform at = toSimbody(peers_.local(i, shape.frame));
        const SimTK::ContactMaterial material = materialOf(shape.material);
        if (const auto* box = std::get_if<Box>(&shape.geometry)) {
            if (brick_ >= 0 && brick_ != i) refuse("Simbody: boxes on each other");
            brick_ = i;
            const SimTK::ContactGeometry::Brick brick(toSimbody(box->halfExtents));
            rigid.addContactSurface(at, SimTK::ContactSurface(brick, material));
        } else if (const auto* ball = std::get_if<Sphere>(&shape.geometry)) {
            const SimTK::ContactGeometry::Sphere sphere(static_cast<double>(ball->radius));
            rigid.addContactSurface(at, SimTK::ContactSurface(sphere, material));
        } else {
            refuse("Simbody: this shape");
        }
    }
    SimTK::ContactMaterial materialOf(const Material& material) {
        if (material.surfaceVelocity != Vec3{} || material.rollingResistance != 0) refuse("Simbody: this material");
        if (material.restitution != 0 && material.restitution != 1) refuse("Simbody: restitution at every speed");
        // It takes the harmonic mean; that is the geometric one when they are equal.
        if (friction_ >= 0 && material.friction != friction_) refuse("Simbody: different frictions");
        friction_ = material.friction;
        const auto friction = static_cast<double>(material.friction);
        return {kStiffness, material.restitution == 1 ? 0 : kDissipation, friction, friction};
    }

    PeerBodies peers_;
    Trees trees_;
    SimTK::MultibodySystem system_;
    SimTK::SimbodyMatterSubsystem matter_{system_};
    SimTK::GeneralForceSubsystem forces_{system_};
    SimTK::ContactTrackerSubsystem tracker_{system_};
    SimTK::CompliantContactSubsystem contact_{system_, tracker_};
    SimTK::Force::DiscreteForces pushes_{forces_, matter_};
    std::vector<SimTK::MobilizedBody> bodies_;
    SimTK::RungeKuttaMersonIntegrator integrator_{system_};
    float friction_ = -1;
    int brick_ = -1, passes_ = 0;
    bool pushed_ = false;
};

}  // namespace

std::unique_ptr<Engine> makeSimbody(const Scene& scene, const SimbodyOptions& options) {
    return std::make_unique<SimbodyEngine>(scene, options);
}
std::string simbodyVersion() { return "3.7"; }

}  // namespace ragtop::stability
