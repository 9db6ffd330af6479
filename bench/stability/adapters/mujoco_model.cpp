#include "mujoco_model.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "trees.h"

namespace ragtop::stability {
namespace {

std::string text(const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x, v.y, v.z); }
std::string text(const DVec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x, v.y, v.z); }
std::string text(const Quat& q) { return fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}", q.w, q.x, q.y, q.z); }

/// Bodies beyond this take minutes: the solver is dense.
constexpr int kMostBodies = 120;
constexpr int kIterations = 100;  ///< MuJoCo's default

const char* nameOf(MujocoIntegrator integrator) {
    switch (integrator) {
        case MujocoIntegrator::rk4:
            return "RK4";
        case MujocoIntegrator::implicit:
            return "implicit";
        default:
            return "Euler";
    }
}

class Writer {
public:
    Writer(const Scene& scene, const PeerBodies& bodies, const MujocoOptions& options)
        : scene_(scene),
          bodies_(bodies),
          options_(options),
          trees_(options.joints == MujocoJoints::trees ? Trees(scene, bodies) : Trees(bodies)) {}

    std::string write() {
        int moving = 0;
        for (int i = 0; i < bodies_.count(); ++i) moving += bodies_.def(i).type == BodyType::dynamic ? 1 : 0;
        if (moving > kMostBodies) refuse("MuJoCo: too many bodies");
        for (int i = 0; i < bodies_.count(); ++i)
            if (trees_.node(i).parent == kWorld) addBody(i);
        for (std::size_t i = 0; i < scene_.joints.size(); ++i) addJoint(i);
        const int contacts = 100 + 20 * moving;
        return fmt::format(
            "<mujoco><compiler angle='radian' balanceinertia='true'/>"
            "<option cone='{}' integrator='{}' iterations='{}' solver='Newton' gravity='{}'/><size nconmax='{}' "
            "njmax='{}'/>"
            "<asset>{}</asset><worldbody>{}</worldbody><contact>{}</contact><equality>{}</equality></mujoco>",
            options_.pyramids ? "pyramidal" : "elliptic", nameOf(options_.integrator),
            options_.iterations > 0 ? options_.iterations : kIterations, text(scene_.settings.gravity), contacts,
            4 * contacts + 6 * static_cast<int>(scene_.joints.size()), assets_, world_, excludes_, equalities_);
    }

private:
    void addBody(int i) {
        const BodyDef& def = bodies_.def(i);
        if (def.type == BodyType::kinematic) refuse("MuJoCo: body moved by its speed");
        const Pose pose = bodies_.startPose(i);
        if (const int parent = trees_.node(i).parent; parent == kWorld) {
            world_ += fmt::format("<body name='b{}' pos='{}' quat='{}'>", i, text(pose.position), text(pose.rotation));
        } else {
            const Frame place = relative(bodies_.startPose(parent), pose);
            world_ +=
                fmt::format("<body name='b{}' pos='{}' quat='{}'>", i, text(place.position), text(place.rotation));
        }
        if (def.type == BodyType::dynamic) {
            const Inertial& inertial = bodies_.inertial(i);
            const int joint = trees_.node(i).joint;
            world_ +=
                joint == TreeNode::kFree ? "<freejoint/>" : ownJoint(i, scene_.joints[static_cast<std::size_t>(joint)]);
            world_ += fmt::format("<inertial pos='0 0 0' mass='{:.9g}' diaginertia='{}'/>", inertial.mass,
                                  text(inertial.moments));
        }
        for (const ShapeDef& shape : def.shapes) addGeom(i, shape);
        for (const int child : trees_.node(i).children) addBody(child);
        world_ += "</body>";
    }
    /// The joint by which a body hangs on its parent. Its coordinate is the scene's: of the second body against the
    /// first, from where both frames agree.
    std::string ownJoint(int body, const SceneJoint& joint) const {
        const JointBodies& frames = bodiesOf(joint.def);
        if (joint.bodyA != kWorld && frames.collide) refuse("MuJoCo: joined bodies that collide");
        const bool second = body == joint.bodyB;
        const Frame at = bodies_.local(body, second ? frames.frameB : frames.frameA);
        const Vec3 axis = (second ? 1.0f : -1.0f) * rotate(at.rotation, {1, 0, 0});
        if (const auto* ball = std::get_if<BallDef>(&joint.def)) {
            if (!isFree(*ball)) refuse("MuJoCo: free balls only");
            return fmt::format("<joint type='ball' pos='{}'/>", text(at.position));
        }
        const auto* hinge = std::get_if<HingeDef>(&joint.def);
        if (!hinge) refuse("MuJoCo: this joint");
        if (hinge->motor || !isPlain(*hinge)) refuse("MuJoCo: hinge with motor or bearing");
        const Quat turn = conjugate(rotationOf(joint.bodyA, frames.frameA)) * rotationOf(joint.bodyB, frames.frameB);
        const double angle = 2 * std::atan2(static_cast<double>(turn.x), static_cast<double>(turn.w));
        std::string extras;
        if (hinge->limit)
            extras += fmt::format(" limited='true' range='{:.9g} {:.9g}'", hinge->limit->lower, hinge->limit->upper);
        if (hinge->spring)
            extras += fmt::format(" stiffness='{:.9g}' damping='{:.9g}' springref='{:.9g}'", hinge->spring->stiffness,
                                  hinge->spring->damping, hinge->target);
        if (hinge->friction != 0) extras += fmt::format(" frictionloss='{:.9g}'", hinge->friction);
        return fmt::format("<joint type='hinge' pos='{}' axis='{}' ref='{:.17g}'{}/>", text(at.position), text(axis),
                           std::remainder(angle, 2 * std::numbers::pi), extras);
    }
    Quat rotationOf(int body, const Frame& frame) const {
        return body == kWorld ? frame.rotation : bodies_.def(body).pose.rotation * frame.rotation;
    }
    void addGeom(int i, const ShapeDef& shape) {
        const Material& material = shape.material;
        if (material.restitution != 0) refuse("MuJoCo: restitution");
        if (material.surfaceVelocity != Vec3{} || material.rollingResistance != 0) refuse("MuJoCo: this material");
        // It takes the larger friction of two; that is the geometric mean when they are equal.
        if (friction_ >= 0 && material.friction != friction_) refuse("MuJoCo: different frictions");
        friction_ = material.friction;
        Frame frame = bodies_.local(i, shape.frame);
        if (std::holds_alternative<Capsule>(shape.geometry))
            frame = frame * Frame{{}, rotationBetween({0, 0, 1}, {0, 1, 0})};
        world_ += fmt::format(
            "<geom pos='{}' quat='{}' friction='{:.9g} 0.005 0.0001' contype='{:d}' conaffinity='{:d}' {}/>",
            text(frame.position), text(frame.rotation), material.friction, shape.filter.mask != 0,
            shape.filter.mask != 0, sizeOf(shape.geometry));
    }
    std::string sizeOf(const Shape& shape) {
        if (const auto* box = std::get_if<Box>(&shape))
            return fmt::format("type='box' size='{}'", text(box->halfExtents));
        if (const auto* ball = std::get_if<Sphere>(&shape))
            return fmt::format("type='sphere' size='{:.9g}'", ball->radius);
        if (const auto* capsule = std::get_if<Capsule>(&shape))
            return fmt::format("type='capsule' size='{:.9g} {:.9g}'", capsule->radius, capsule->halfHeight);
        const auto* hull = std::get_if<ConvexHull>(&shape);
        if (!hull) refuse("MuJoCo: this shape");
        std::string vertices;
        for (const Vec3& vertex : hull->vertices()) vertices += text(vertex) + " ";
        const std::string name = fmt::format("m{}", meshes_++);
        assets_ += fmt::format("<mesh name='{}' vertex='{}'/>", name, vertices);
        return fmt::format("type='mesh' mesh='{}'", name);
    }

    /// An equality constraint, where the joint is not one of a tree.
    void addJoint(std::size_t i) {
        const SceneJoint& joint = scene_.joints[i];
        const JointBodies& frames = bodiesOf(joint.def);
        // A constraint is one of a body, with another or the world.
        const bool isOfA = joint.bodyB == kWorld;
        const int a = isOfA ? kWorld : joint.bodyA, b = isOfA ? joint.bodyA : joint.bodyB;
        if (a != kWorld && !frames.collide) excludes_ += fmt::format("<exclude body1='b{}' body2='b{}'/>", a, b);
        if (trees_.has(static_cast<int>(i))) return;
        const Frame at = bodies_.local(b, isOfA ? frames.frameA : frames.frameB);
        if (const auto* ball = std::get_if<BallDef>(&joint.def)) {
            if (!isFree(*ball)) refuse("MuJoCo: free balls only");
            addPoint(b, a, at.position);
        } else if (const auto* hinge = std::get_if<HingeDef>(&joint.def)) {
            if (!isFree(*hinge)) refuse("MuJoCo: free hinges only");
            // Two points of the axis, a decimetre to each side.
            const Vec3 axis = 0.1f * rotate(at.rotation, {1, 0, 0});
            addPoint(b, a, at.position - axis);
            addPoint(b, a, at.position + axis);
        } else {
            refuse("MuJoCo: this joint");
        }
    }
    void addPoint(int body, int other, const Vec3& at) {
        equalities_ += fmt::format("<connect body1='b{}' anchor='{}'{}/>", body, text(at),
                                   other == kWorld ? "" : fmt::format(" body2='b{}'", other));
    }

    const Scene& scene_;
    const PeerBodies& bodies_;
    MujocoOptions options_;
    Trees trees_;
    std::string assets_, world_, excludes_, equalities_;
    float friction_ = -1;
    int meshes_ = 0;
};

}  // namespace

std::string mujocoModel(const Scene& scene, const PeerBodies& bodies, const MujocoOptions& options) {
    return Writer(scene, bodies, options).write();
}

}  // namespace ragtop::stability
