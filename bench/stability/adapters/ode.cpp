#include <ode/ode.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../scenery.h"
#include "peer.h"

namespace ragtop::stability {
namespace {

/// The first of what the library has told since it was last emptied; the pivoting solver tells of its failures.
std::string& firstMessage() {
    static std::string message;
    return message;
}
void keepMessage(int, const char* format, va_list arguments) {
    if (!firstMessage().empty()) return;
    char text[200];
    std::vsnprintf(text, sizeof text, format, arguments);
    firstMessage() = text;
}

/// The library is set up once per process.
void initialise() {
    static const bool done = [] {
        dInitODE2(0);
        dSetMessageHandler(keepMessage);
        return true;
    }();
    (void)done;
}

/// ODE 0.16 with default settings: error reduction 0.2, a box for friction; its quick step (20 sweeps) or its exact
/// one.
class OdeEngine : public Engine {
public:
    OdeEngine(const Scene& scene, const OdeOptions& options) : peers_(scene), options_(options) {
        initialise();
        world_ = dWorldCreate();
        space_ = dHashSpaceCreate(nullptr);
        contacts_ = dJointGroupCreate(0);
        const Vec3& g = scene.settings.gravity;
        dWorldSetQuickStepNumIterations(world_, options.iterations);
        dWorldSetGravity(world_, toReal(g.x), toReal(g.y), toReal(g.z));
        for (int i = 0; i < peers_.count(); ++i) addBody(i);
        for (const SceneJoint& joint : scene.joints) addJoint(joint);
    }
    ~OdeEngine() override {
        dJointGroupDestroy(contacts_);
        dSpaceDestroy(space_);
        dWorldDestroy(world_);
        for (const dTriMeshDataID mesh : meshes_) dGeomTriMeshDataDestroy(mesh);
    }

    void step(double dt) override {
        firstMessage().clear();
        // Forces are cleared after each step of ODE's.
        const auto pushes = std::exchange(pushes_, {});
        for (int i = 0; i < options_.substeps; ++i) {
            for (const Push& push : pushes)
                dBodyAddForceAtPos(body(push.body), toReal(push.force.x), toReal(push.force.y), toReal(push.force.z),
                                   push.point.x, push.point.y, push.point.z);
            substep(dt / options_.substeps);
        }
        if (complaint_.empty()) complaint_ = firstMessage();
    }
    BodyMotion motion(int i) const override {
        if (!body(i)) return {peers_.def(i).pose, {}, {}};
        const dReal *x = dBodyGetPosition(body(i)), *q = dBodyGetQuaternion(body(i));
        const Pose pose{{x[0], x[1], x[2]}, {toFloat(q[1]), toFloat(q[2]), toFloat(q[3]), toFloat(q[0])}};
        return {peers_.ownPose(i, pose), toVector(dBodyGetLinearVel(body(i))), toVector(dBodyGetAngularVel(body(i)))};
    }
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        dBodySetLinearVel(body(i), toReal(linear.x), toReal(linear.y), toReal(linear.z));
        dBodySetAngularVel(body(i), toReal(angular.x), toReal(angular.y), toReal(angular.z));
    }
    void push(int i, const Vec3& force, const DVec3& point) override { pushes_.push_back({i, force, point}); }
    void remove(int i) override {
        for (dGeomID geom = dBodyGetFirstGeom(body(i)); geom; geom = dBodyGetNextGeom(geom)) dGeomDisable(geom);
        dBodyDisable(body(i));
    }
    double normalForce(int a, int b) const override {
        double sum = 0;
        for (const Force& force : forces_) {
            if (!((force.a == a && force.b == b) || (force.a == b && force.b == a))) continue;
            const dReal *f = force.feedback.f1, *n = force.normal;
            sum += std::abs(f[0] * n[0] + f[1] * n[1] + f[2] * n[2]);
        }
        return sum;
    }

    StepWork work() const override {
        return {static_cast<int>(forces_.size()), options_.exact ? 0 : options_.substeps * options_.iterations};
    }
    std::string complaint() const override { return complaint_; }

private:
    struct Force {
        int a, b;
        dReal normal[3];
        dJointFeedback feedback;
    };
    struct Push {
        int body;
        Vec3 force;
        DVec3 point;
    };
    struct SpringHinge {
        dJointID joint;
        Spring spring;
        float target;
    };
    static constexpr int kMaxContacts = 8;

    static dReal toReal(float a) { return static_cast<dReal>(a); }
    static float toFloat(dReal a) { return static_cast<float>(a); }
    static Vec3 toVector(const dReal* v) { return {toFloat(v[0]), toFloat(v[1]), toFloat(v[2])}; }
    static void toQuaternion(const Quat& q, dQuaternion out) {
        out[0] = toReal(q.w);
        out[1] = toReal(q.x);
        out[2] = toReal(q.y);
        out[3] = toReal(q.z);
    }
    void substep(double dt) {
        setSprings(dt);
        dJointGroupEmpty(contacts_);
        forces_.clear();
        dSpaceCollide(space_, this,
                      [](void* self, dGeomID a, dGeomID b) { static_cast<OdeEngine*>(self)->collide(a, b); });
        if (options_.exact)
            dWorldStep(world_, dt);
        else
            dWorldQuickStep(world_, dt);
    }
    dBodyID body(int i) const { return bodies_[static_cast<std::size_t>(i)]; }

    void addBody(int i) {
        const BodyDef& def = peers_.def(i);
        bodies_.push_back(nullptr);
        if (def.type != BodyType::fixed) {
            bodies_.back() = dBodyCreate(world_);
            place(i);
        }
        for (const ShapeDef& shape : def.shapes) addGeom(i, shape);
    }
    void place(int i) {
        const BodyDef& def = peers_.def(i);
        const Pose pose = peers_.startPose(i);
        dQuaternion q;
        toQuaternion(pose.rotation, q);
        dBodySetPosition(body(i), pose.position.x, pose.position.y, pose.position.z);
        dBodySetQuaternion(body(i), q);
        setVelocity(i, def.linearVelocity, def.angularVelocity);
        if (def.type == BodyType::kinematic) {
            dBodySetKinematic(body(i));
            return;
        }
        const Inertial& inertial = peers_.inertial(i);
        const Vec3& m = inertial.moments;
        dMass mass;
        dMassSetParameters(&mass, inertial.mass, 0, 0, 0, toReal(m.x), toReal(m.y), toReal(m.z), 0, 0, 0);
        dBodySetMass(body(i), &mass);
    }
    void addGeom(int i, const ShapeDef& shape) {
        if (shape.material.surfaceVelocity != Vec3{}) refuse("ODE: surface velocity");
        if (shape.material.rollingResistance != 0) refuse("ODE: rolling resistance over load");
        dGeomID geom = makeGeom(shape.geometry);
        Frame frame = peers_.local(i, shape.frame);
        // ODE's capsules stand along z.
        if (std::holds_alternative<Capsule>(shape.geometry))
            frame = frame * Frame{{}, rotationBetween({0, 0, 1}, {0, 1, 0})};
        dQuaternion q;
        if (body(i)) {
            dGeomSetBody(geom, body(i));
            toQuaternion(frame.rotation, q);
            dGeomSetOffsetPosition(geom, toReal(frame.position.x), toReal(frame.position.y), toReal(frame.position.z));
            dGeomSetOffsetQuaternion(geom, q);
        } else {
            const Pose pose = peers_.startPose(i) * frame;
            toQuaternion(pose.rotation, q);
            dGeomSetPosition(geom, pose.position.x, pose.position.y, pose.position.z);
            dGeomSetQuaternion(geom, q);
        }
        dGeomSetCategoryBits(geom, shape.filter.category);
        dGeomSetCollideBits(geom, shape.filter.mask);
        if (shape.filter.mask == 0) dGeomSetCategoryBits(geom, 0);
        tags_.push_back({i, shape.material});
        dGeomSetData(geom, &tags_.back());
    }
    dGeomID makeGeom(const Shape& shape) {
        if (const auto* box = std::get_if<Box>(&shape))
            return dCreateBox(space_, 2 * toReal(box->halfExtents.x), 2 * toReal(box->halfExtents.y),
                              2 * toReal(box->halfExtents.z));
        if (const auto* ball = std::get_if<Sphere>(&shape)) return dCreateSphere(space_, toReal(ball->radius));
        if (const auto* capsule = std::get_if<Capsule>(&shape))
            return dCreateCapsule(space_, toReal(capsule->radius), 2 * toReal(capsule->halfHeight));
        if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return makeMesh(*mesh);
        refuse("ODE: this shape");
    }
    dGeomID makeMesh(const TriangleMesh& mesh) {
        auto& [vertices, indices] = meshMemory_.emplace_back();
        for (const Vec3& v : mesh.vertices()) vertices.insert(vertices.end(), {v.x, v.y, v.z});
        for (const Triangle& t : mesh.triangles()) indices.insert(indices.end(), {t.a, t.b, t.c});
        const dTriMeshDataID data = dGeomTriMeshDataCreate();
        meshes_.push_back(data);
        dGeomTriMeshDataBuildSingle(data, vertices.data(), 3 * sizeof(float), static_cast<int>(vertices.size() / 3),
                                    indices.data(), static_cast<int>(indices.size()), 3 * sizeof(dTriIndex));
        return dCreateTriMesh(space_, data, nullptr, nullptr, nullptr);
    }

    void collide(dGeomID a, dGeomID b) {
        const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
        if (first && second && dAreConnectedExcluding(first, second, dJointTypeContact)) return;
        const auto* tagA = static_cast<const Tag*>(dGeomGetData(a));
        const auto* tagB = static_cast<const Tag*>(dGeomGetData(b));
        dContact points[kMaxContacts];
        const int count = dCollide(a, b, kMaxContacts, &points[0].geom, sizeof(dContact));
        for (int i = 0; i < count; ++i) {
            dSurfaceParameters& surface = points[i].surface;
            surface = {};
            surface.mode = dContactApprox1 | dContactBounce;
            surface.mu = std::sqrt(toReal(tagA->material.friction) * toReal(tagB->material.friction));
            surface.bounce = std::max(toReal(tagA->material.restitution), toReal(tagB->material.restitution));
            surface.bounce_vel = 0.1;
            const dJointID joint = dJointCreateContact(world_, contacts_, &points[i]);
            dJointAttach(joint, first, second);
            const dReal* n = points[i].geom.normal;
            forces_.push_back({tagA->body, tagB->body, {n[0], n[1], n[2]}, {}});
            dJointSetFeedback(joint, &forces_.back().feedback);
        }
    }

    void addJoint(const SceneJoint& scene) {
        const JointBodies& frames = bodiesOf(scene.def);
        const Pose own = scene.bodyB == kWorld ? Pose{} : peers_.def(scene.bodyB).pose, at = own * frames.frameB;
        const Vec3 axis = rotate(at.rotation, {1, 0, 0});
        const auto attach = [&](dJointID joint) {
            const auto end = [&](int i) { return i == kWorld ? nullptr : body(i); };
            dJointAttach(joint, end(scene.bodyA), end(scene.bodyB));
            return joint;
        };
        if (const auto* ball = std::get_if<BallDef>(&scene.def)) {
            if (ball->swingLimit || ball->swingEllipse || ball->swingPyramid || ball->reach || ball->twistLimit ||
                ball->spring || ball->friction != 0)
                refuse("ODE: limited ball");
            dJointSetBallAnchor(attach(dJointCreateBall(world_, nullptr)), at.position.x, at.position.y, at.position.z);
        } else if (const auto* hinge = std::get_if<HingeDef>(&scene.def)) {
            const dJointID joint = attach(dJointCreateHinge(world_, nullptr));
            dJointSetHingeAnchor(joint, at.position.x, at.position.y, at.position.z);
            // ODE's angle is that of its first body against the second.
            dJointSetHingeAxis(joint, -toReal(axis.x), -toReal(axis.y), -toReal(axis.z));
            setExtras(joint, *hinge);
        } else if (const auto* slider = std::get_if<SliderDef>(&scene.def)) {
            if (slider->limit || slider->spring || slider->motor) refuse("ODE: slider with extras");
            const dJointID joint = attach(dJointCreateSlider(world_, nullptr));
            dJointSetSliderAxis(joint, toReal(axis.x), toReal(axis.y), toReal(axis.z));
        } else {
            refuse("ODE: this joint");
        }
    }
    void setExtras(dJointID joint, const HingeDef& hinge) {
        if (hinge.motor || hinge.friction != 0 || !isPlain(hinge)) refuse("ODE: hinge with motor or friction");
        if (hinge.limit) {
            dJointSetHingeParam(joint, dParamLoStop, toReal(hinge.limit->lower));
            dJointSetHingeParam(joint, dParamHiStop, toReal(hinge.limit->upper));
        }
        if (hinge.spring) springs_.push_back({joint, *hinge.spring, hinge.target});
    }
    /// A spring is a stop on both sides, as soft as the step makes it.
    void setSprings(double dt) {
        for (const SpringHinge& hinge : springs_) {
            const double k = static_cast<double>(hinge.spring.stiffness), d = static_cast<double>(hinge.spring.damping);
            dJointSetHingeParam(hinge.joint, dParamLoStop, toReal(hinge.target));
            dJointSetHingeParam(hinge.joint, dParamHiStop, toReal(hinge.target));
            dJointSetHingeParam(hinge.joint, dParamStopERP, dt * k / (dt * k + d));
            dJointSetHingeParam(hinge.joint, dParamStopCFM, 1 / (dt * k + d));
        }
    }

    struct Tag {
        int body;
        Material material;
    };
    PeerBodies peers_;
    OdeOptions options_;
    dWorldID world_;
    dSpaceID space_;
    dJointGroupID contacts_;
    std::vector<dBodyID> bodies_;
    std::deque<Tag> tags_;
    std::deque<Force> forces_;
    std::vector<SpringHinge> springs_;
    std::vector<Push> pushes_;
    std::string complaint_;
    std::deque<std::pair<std::vector<float>, std::vector<dTriIndex>>> meshMemory_;
    std::vector<dTriMeshDataID> meshes_;
};

}  // namespace

std::unique_ptr<Engine> makeOde(const Scene& scene, const OdeOptions& options) {
    return std::make_unique<OdeEngine>(scene, options);
}
std::string odeVersion() { return dODE_VERSION; }

}  // namespace ragtop::stability
