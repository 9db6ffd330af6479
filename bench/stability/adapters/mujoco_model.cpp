#include "mujoco_model.h"

#include <fmt/format.h>

#include "../scenery.h"

namespace ragtop::stability {
namespace {

std::string text(const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x, v.y, v.z); }
std::string text(const DVec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x, v.y, v.z); }
std::string text(const Quat& q) { return fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}", q.w, q.x, q.y, q.z); }

/// Bodies beyond this take minutes: the solver is dense.
constexpr int kMostBodies = 120;

class Writer {
public:
    Writer(const Scene& scene, const PeerBodies& bodies) : scene_(scene), bodies_(bodies) {}

    std::string write() {
        int moving = 0;
        for (int i = 0; i < bodies_.count(); ++i) {
            addBody(i);
            moving += bodies_.def(i).type == BodyType::dynamic ? 1 : 0;
        }
        if (moving > kMostBodies) refuse("MuJoCo: too many bodies");
        for (const SceneJoint& joint : scene_.joints) addJoint(joint);
        const int contacts = 100 + 20 * moving;
        return fmt::format(
            "<mujoco><compiler angle='radian' balanceinertia='true'/>"
            "<option cone='elliptic' solver='Newton' gravity='{}'/><size nconmax='{}' njmax='{}'/>"
            "<asset>{}</asset><worldbody>{}</worldbody><contact>{}</contact><equality>{}</equality></mujoco>",
            text(scene_.settings.gravity), contacts, 4 * contacts + 6 * static_cast<int>(scene_.joints.size()), assets_,
            world_, excludes_, equalities_);
    }

private:
    void addBody(int i) {
        const BodyDef& def = bodies_.def(i);
        if (def.type == BodyType::kinematic) refuse("MuJoCo: body moved by its speed");
        const Pose pose = bodies_.startPose(i);
        world_ += fmt::format("<body name='b{}' pos='{}' quat='{}'>", i, text(pose.position), text(pose.rotation));
        if (def.type == BodyType::dynamic) {
            const Inertial& inertial = bodies_.inertial(i);
            world_ += fmt::format("<freejoint/><inertial pos='0 0 0' mass='{:.9g}' diaginertia='{}'/>", inertial.mass,
                                  text(inertial.moments));
        }
        for (const ShapeDef& shape : def.shapes) addGeom(i, shape);
        world_ += "</body>";
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

    void addJoint(const SceneJoint& joint) {
        const JointBodies& frames = bodiesOf(joint.def);
        const int a = joint.bodyA, b = joint.bodyB;
        const Frame at = bodies_.local(b, frames.frameB);
        if (std::holds_alternative<BallDef>(joint.def)) {
            addPoint(b, a, at.position);
        } else if (const auto* hinge = std::get_if<HingeDef>(&joint.def)) {
            if (hinge->limit || hinge->spring || hinge->motor || hinge->friction != 0 || !isPlain(*hinge))
                refuse("MuJoCo: free hinges only");
            // Two points of the axis, a decimetre to each side.
            const Vec3 axis = 0.1f * rotate(at.rotation, {1, 0, 0});
            addPoint(b, a, at.position - axis);
            addPoint(b, a, at.position + axis);
        } else {
            refuse("MuJoCo: this joint");
        }
        if (a != kWorld && !frames.collide) excludes_ += fmt::format("<exclude body1='b{}' body2='b{}'/>", a, b);
    }
    void addPoint(int body, int other, const Vec3& at) {
        equalities_ += fmt::format("<connect body1='b{}' anchor='{}'{}/>", body, text(at),
                                   other == kWorld ? "" : fmt::format(" body2='b{}'", other));
    }

    const Scene& scene_;
    const PeerBodies& bodies_;
    std::string assets_, world_, excludes_, equalities_;
    float friction_ = -1;
    int meshes_ = 0;
};

}  // namespace

std::string mujocoModel(const Scene& scene, const PeerBodies& bodies) { return Writer(scene, bodies).write(); }

}  // namespace ragtop::stability
