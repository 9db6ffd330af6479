#include "urdf_document.h"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <utility>

#include "ragtop/asset_error.h"
#include "robot_xml.h"
#include "single.h"

namespace ragtop {
namespace {

/// Collects what the library says instead of printing it.
class LogCapture : public console_bridge::OutputHandler {
public:
    LogCapture() {
        console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
        console_bridge::useOutputHandler(this);
    }
    ~LogCapture() override { console_bridge::restorePreviousOutputHandler(); }
    LogCapture(const LogCapture&) = delete;
    LogCapture& operator=(const LogCapture&) = delete;

    void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
        if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
            if (error.empty()) error = text;
        } else {
            warnings.push_back(text);
        }
    }

    std::string error;
    std::vector<std::string> warnings;
};

Vec3 toVec3(const urdf::Vector3& v) { return {single(v.x), single(v.y), single(v.z)}; }

Frame toFrame(const urdf::Pose& pose) {
    const urdf::Rotation& q = pose.rotation;
    return {toVec3(pose.position), normalized(Quat{single(q.x), single(q.y), single(q.z), single(q.w)})};
}

/// Turns the library's model into plain structs.
class RobotReader {
public:
    RobotReader(const std::filesystem::path& path, XmlText& text)
        : file_(path.string()), text_(checkRobotText(file_, text)) {}

    ImportedRobot run() {
        const urdf::ModelInterfaceSharedPtr model = parse();
        robot_.name = model->getName();
        std::vector<std::pair<const urdf::Link*, std::int32_t>> waiting{{model->getRoot().get(), -1}};
        while (!waiting.empty()) {
            const auto [link, parent] = waiting.back();
            waiting.pop_back();
            const auto index = static_cast<std::int32_t>(robot_.links.size());
            robot_.links.push_back(toLink(*link, parent));
            for (auto joint = link->child_joints.rbegin(); joint != link->child_joints.rend(); ++joint)
                waiting.emplace_back(model->links_.at((*joint)->child_link_name).get(), index);
        }
        if (robot_.links.size() != model->links_.size())
            fail(std::to_string(model->links_.size() - robot_.links.size()) + " links do not hang on the root '" +
                 model->getRoot()->name + "': their joints form a loop");
        return std::move(robot_);
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw AssetError(file_, "", message); }

    urdf::ModelInterfaceSharedPtr parse() {
        LogCapture log;
        urdf::ModelInterfaceSharedPtr model;
        try {
            model = urdf::parseURDF(text_.text);
        } catch (const std::exception& error) {
            fail(error.what());
        }
        if (!log.error.empty()) fail(log.error);
        if (!model || !model->getRoot()) fail("is no robot");
        robot_.tags = std::move(text_.tags);
        robot_.warnings = std::move(text_.warnings);
        robot_.warnings.insert(robot_.warnings.end(), log.warnings.begin(), log.warnings.end());
        return model;
    }

    ImportedRobotLink toLink(const urdf::Link& from, std::int32_t parent) const {
        ImportedRobotLink link;
        link.name = from.name;
        link.parent = parent;
        if (from.parent_joint) link.joint = toJoint(*from.parent_joint);
        if (from.inertial) {
            const urdf::Inertial& inertial = *from.inertial;
            link.heavy = true;
            link.mass = inertial.mass;
            link.inertia = {inertial.ixx, inertial.iyy, inertial.izz, inertial.ixy, inertial.ixz, inertial.iyz};
            link.centerOfMass = toFrame(inertial.origin);
        }
        for (const urdf::CollisionSharedPtr& collision : from.collision_array)
            if (collision && collision->geometry) link.shapes.push_back(toShape(*collision));
        for (const ExtraCapsule& extra : text_.capsules)
            if (extra.link == from.name) link.shapes.push_back(toShape(extra));
        return link;
    }

    static ImportedRobotShape toShape(const ExtraCapsule& extra) {
        urdf::Pose pose;
        pose.position = {extra.xyz[0], extra.xyz[1], extra.xyz[2]};
        pose.rotation.setFromRPY(extra.rpy[0], extra.rpy[1], extra.rpy[2]);
        return {RobotShapeKind::capsule, {}, single(extra.radius), single(extra.length), toFrame(pose), {}};
    }

    static ImportedRobotShape toShape(const urdf::Collision& collision) {
        ImportedRobotShape shape;
        shape.origin = toFrame(collision.origin);
        const urdf::Geometry& geometry = *collision.geometry;
        if (geometry.type == urdf::Geometry::SPHERE) {
            shape.kind = RobotShapeKind::sphere;
            shape.radius = single(static_cast<const urdf::Sphere&>(geometry).radius);
        } else if (geometry.type == urdf::Geometry::BOX) {
            shape.kind = RobotShapeKind::box;
            shape.size = toVec3(static_cast<const urdf::Box&>(geometry).dim);
        } else if (geometry.type == urdf::Geometry::CYLINDER) {
            const auto& round = static_cast<const urdf::Cylinder&>(geometry);
            shape.kind = RobotShapeKind::cylinder;
            shape.radius = single(round.radius);
            shape.length = single(round.length);
        } else {
            const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
            shape.kind = RobotShapeKind::mesh;
            shape.size = toVec3(mesh.scale);
            shape.mesh = mesh.filename;
        }
        return shape;
    }

    RobotJointKind kindOf(const urdf::Joint& joint) const {
        const auto& balls = text_.spherical;
        if (std::find(balls.begin(), balls.end(), joint.name) != balls.end()) return RobotJointKind::ball;
        switch (joint.type) {
            case urdf::Joint::FIXED:
                return RobotJointKind::fixed;
            case urdf::Joint::REVOLUTE:
            case urdf::Joint::CONTINUOUS:
                return RobotJointKind::hinge;
            case urdf::Joint::PRISMATIC:
                return RobotJointKind::slider;
            case urdf::Joint::PLANAR:
                return RobotJointKind::plane;
            default:
                return RobotJointKind::free;
        }
    }

    ImportedRobotJoint toJoint(const urdf::Joint& from) const {
        ImportedRobotJoint joint;
        joint.name = from.name;
        joint.kind = kindOf(from);
        joint.origin = toFrame(from.parent_to_joint_origin_transform);
        joint.axis = toVec3(from.axis);
        if (from.limits) {
            joint.limited = from.type == urdf::Joint::REVOLUTE || from.type == urdf::Joint::PRISMATIC;
            joint.rated = true;
            joint.lower = single(from.limits->lower);
            joint.upper = single(from.limits->upper);
            joint.effort = single(from.limits->effort);
            joint.velocity = single(from.limits->velocity);
        }
        if (from.dynamics) {
            joint.damping = single(from.dynamics->damping);
            joint.friction = single(from.dynamics->friction);
        }
        if (from.mimic) {
            joint.follows = from.mimic->joint_name;
            joint.multiplier = single(from.mimic->multiplier);
            joint.offset = single(from.mimic->offset);
        }
        if (from.safety) {
            joint.softLower = single(from.safety->soft_lower_limit);
            joint.softUpper = single(from.safety->soft_upper_limit);
            joint.kPosition = single(from.safety->k_position);
            joint.kVelocity = single(from.safety->k_velocity);
        }
        return joint;
    }

    std::string file_;
    CheckedRobotText text_;
    ImportedRobot robot_;
};

}  // namespace

ImportedRobot readUrdf(const std::filesystem::path& path, XmlText& text) { return RobotReader(path, text).run(); }

}  // namespace ragtop
