#include "ragtop/robot.h"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <system_error>

#include "axes.h"
#include "import_text.h"
#include "ragtop/mesh_file.h"
#include "robot_xml.h"

namespace ragtop {
namespace {

/// Collects what the library says instead of printing it.
class LogCapture : public console_bridge::OutputHandler {
public:
    // The library has one handler for the process.
    LogCapture() : lock_(mutex()), level_(console_bridge::getLogLevel()) {
        console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
        console_bridge::useOutputHandler(this);
    }
    ~LogCapture() override {
        console_bridge::restorePreviousOutputHandler();
        console_bridge::setLogLevel(level_);
    }
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

private:
    static std::mutex& mutex() {
        static std::mutex only;
        return only;
    }
    std::lock_guard<std::mutex> lock_;
    console_bridge::LogLevel level_;
};

Vec3 toVec3(const urdf::Vector3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Frame toFrame(const urdf::Pose& pose) {
    const urdf::Rotation& q = pose.rotation;
    return {toVec3(pose.position), normalized(Quat{static_cast<float>(q.x), static_cast<float>(q.y),
                                                   static_cast<float>(q.z), static_cast<float>(q.w)})};
}

/// A prism of 16 sides of a cylinder's volume: A = n/2 R² sin(2π/n) = π r².
ConvexHull cylinder(float radius, float length) {
    constexpr int kSides = 16;
    const float step = 2.0f * kPi / kSides;
    const float outer = radius * std::sqrt(2.0f * kPi / (kSides * sinCos(step).sin));
    std::vector<Vec3> points;
    for (int i = 0; i < kSides; ++i) {
        const SinCos angle = sinCos(step * static_cast<float>(i));
        for (const float z : {-0.5f * length, 0.5f * length})
            points.push_back({outer * angle.cos, outer * angle.sin, z});
    }
    return ConvexHull(points);
}

const Quat kYToZ{0.70710678118654752f, 0, 0, 0.70710678118654752f};

class RobotBuilder {
public:
    RobotBuilder(const std::filesystem::path& path, const RobotOptions& options)
        : path_(path), options_(options), text_(checkRobotText(path)) {
        robot_.file = path.string();
    }

    Robot run() {
        model_ = parse();
        robot_.name = model_->getName();
        const urdf::LinkConstSharedPtr root = model_->getRoot();
        RobotBody first;
        first.name = root->name;
        first.anchored = root->name == "world" && !root->inertial && root->collision_array.empty();
        first.pose.rotation = uprightRotation(UpAxis::z);
        robot_.bodies.push_back(std::move(first));
        masses_.emplace_back();
        addLink(*root, 0, {});
        if (robot_.links.size() != model_->links_.size())
            fail(std::to_string(model_->links_.size() - robot_.links.size()) + " links do not hang on the root '" +
                 root->name + "': their joints form a loop");
        finishMasses();
        summarise();
        return std::move(robot_);
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw AssetError(robot_.file, "", message); }
    void warn(std::string message) { robot_.warnings.push_back(std::move(message)); }

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
        robot_.warnings = text_.warnings;
        for (std::string& warning : log.warnings) warn(std::move(warning));
        return model;
    }

    /// Links on fixed joints go into the body of their parent; all others begin a body.
    void addLink(const urdf::Link& link, int body, const Frame& inBody) {
        robot_.links.push_back({link.name, body, inBody});
        const auto at = static_cast<std::size_t>(body);
        if (link.inertial) addMass(link, at, inBody);
        for (const urdf::CollisionSharedPtr& collision : link.collision_array)
            if (collision && collision->geometry) addShape(link.name, *collision, at, inBody);
        for (const ExtraCapsule& extra : text_.capsules)
            if (extra.link == link.name) addCapsule(extra, at, inBody);
        for (const urdf::JointSharedPtr& joint : link.child_joints) addJoint(*joint, body, inBody);
    }

    void addMass(const urdf::Link& link, std::size_t body, const Frame& inBody) {
        const urdf::Inertial& inertial = *link.inertial;
        const auto f = [](double value) { return static_cast<float>(value); };
        MassProperties mass{f(inertial.mass), {}, {}};
        mass.inertia = {{f(inertial.ixx), f(inertial.ixy), f(inertial.ixz)},
                        {f(inertial.ixy), f(inertial.iyy), f(inertial.iyz)},
                        {f(inertial.ixz), f(inertial.iyz), f(inertial.izz)}};
        const double trace = inertial.ixx + inertial.iyy + inertial.izz;
        const double greatest = std::max({inertial.ixx, inertial.iyy, inertial.izz});
        // Each principal moment of a body is at most the sum of the others; the files' digits allow a per cent.
        if (greatest > 0.505 * trace)
            warn("link '" + link.name + "': its inertia is that of no body: one moment exceeds the sum of the others");
        masses_[body].push_back(transformed(mass, inBody * toFrame(inertial.origin)));
    }

    void addCapsule(const ExtraCapsule& extra, std::size_t body, const Frame& inBody) {
        urdf::Pose pose;
        pose.position = {extra.xyz[0], extra.xyz[1], extra.xyz[2]};
        pose.rotation.setFromRPY(extra.rpy[0], extra.rpy[1], extra.rpy[2]);
        const Capsule capsule{static_cast<float>(extra.radius), static_cast<float>(0.5 * extra.length)};
        push(body, capsule, inBody * toFrame(pose) * Frame{{}, kYToZ});
    }

    void push(std::size_t body, Shape shape, const Frame& frame) {
        ShapeDef def{.geometry = std::move(shape), .frame = frame, .material = options_.material};
        def.frame.rotation = normalized(frame.rotation);
        robot_.bodies[body].shapes.push_back(std::move(def));
    }

    void addShape(const std::string& link, const urdf::Collision& collision, std::size_t body, const Frame& inBody) {
        const Frame frame = inBody * toFrame(collision.origin);
        const urdf::Geometry& geometry = *collision.geometry;
        if (geometry.type == urdf::Geometry::SPHERE) {
            push(body, Sphere{static_cast<float>(static_cast<const urdf::Sphere&>(geometry).radius)}, frame);
        } else if (geometry.type == urdf::Geometry::BOX) {
            push(body, Box{0.5f * toVec3(static_cast<const urdf::Box&>(geometry).dim)}, frame);
        } else if (geometry.type == urdf::Geometry::CYLINDER) {
            const auto& round = static_cast<const urdf::Cylinder&>(geometry);
            push(body, cylinder(static_cast<float>(round.radius), static_cast<float>(round.length)), frame);
        } else {
            addMesh(link, static_cast<const urdf::Mesh&>(geometry), body, frame);
        }
    }

    void addMesh(const std::string& link, const urdf::Mesh& mesh, std::size_t body, const Frame& frame) {
        const std::filesystem::path file = meshFile(mesh.filename);
        if (file.empty()) {
            ++missingMeshes_;
            if (firstMissing_.empty()) firstMissing_ = mesh.filename + "' of link '" + link;
            return;
        }
        try {
            const Shape hull = loadMesh(file, {.convex = true});
            std::vector<Vec3> points;
            for (const Vec3& point : std::get<ConvexHull>(hull).vertices())
                points.push_back(scale(toVec3(mesh.scale), point));
            push(body, ConvexHull(points), frame);
        } catch (const std::exception& error) {
            warn("link '" + link + "': collision left out: " + error.what());
        }
    }

    /// Beside the description, or for package://name/path in a folder above it; empty when it is nowhere.
    std::filesystem::path meshFile(const std::string& name) const {
        constexpr std::string_view kPackage = "package://", kFile = "file://";
        std::string rest = name;
        if (rest.starts_with(kFile)) rest = rest.substr(kFile.size());
        const bool inPackage = rest.starts_with(kPackage);
        if (inPackage) {
            rest = rest.substr(kPackage.size());
            rest = rest.substr(std::min(rest.find('/') + 1, rest.size()));
        }
        std::error_code ignored;
        std::filesystem::path folder = std::filesystem::absolute(path_, ignored).parent_path();
        for (int level = 0; level < (inPackage ? 4 : 1); ++level, folder = folder.parent_path())
            if (std::filesystem::is_regular_file(folder / rest, ignored)) return folder / rest;
        return {};
    }

    void addJoint(const urdf::Joint& joint, int body, const Frame& inBody) {
        const Frame origin = inBody * toFrame(joint.parent_to_joint_origin_transform);
        const urdf::LinkConstSharedPtr found = model_->getLink(joint.child_link_name);
        if (!found) fail("joint '" + joint.name + "': child link '" + joint.child_link_name + "' does not exist");
        const urdf::Link& child = *found;
        if (joint.type == urdf::Joint::FIXED)
            return addLink(child, body, {origin.position, normalized(origin.rotation)});
        const int next = static_cast<int>(robot_.bodies.size());
        RobotBody made;
        made.name = child.name;
        made.pose = robot_.bodies[static_cast<std::size_t>(body)].pose * origin;
        made.pose.rotation = normalized(made.pose.rotation);
        robot_.bodies.push_back(std::move(made));
        masses_.emplace_back();

        RobotJoint result;
        result.name = joint.name;
        result.parent = body;
        result.child = next;
        const auto& balls = text_.spherical;
        const bool spherical = std::find(balls.begin(), balls.end(), joint.name) != balls.end();
        if (spherical) {
            result.joint = BallDef{};
        } else if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS) {
            result.joint = hinge(joint);
        } else if (joint.type == urdf::Joint::PRISMATIC) {
            result.joint = slider(joint);
        } else {
            if (joint.type == urdf::Joint::PLANAR) warn("joint '" + joint.name + "': planar joints are left free");
            addLink(child, next, {});
            return;
        }
        const Vec3 axis = normalized(toVec3(joint.axis));
        const Quat alongAxis = spherical ? Quat{} : rotationBetween({1, 0, 0}, axis);
        std::visit(
            [&](auto& def) {
                def.bodies.frameA = {origin.position, normalized(origin.rotation * alongAxis)};
                def.bodies.frameB = {{}, alongAxis};
            },
            result.joint);
        if (joint.limits) {
            result.effort = static_cast<float>(joint.limits->effort);
            result.velocity = static_cast<float>(joint.limits->velocity);
            speedLimited_ += result.velocity > 0;
        }
        robot_.joints.push_back(std::move(result));
        addLink(child, next, {});
    }

    /// Viscous friction is a spring without stiffness.
    template <class Def>
    void resist(Def& def, const urdf::Joint& joint) const {
        if (!joint.dynamics) return;
        def.friction = static_cast<float>(joint.dynamics->friction);
        if (joint.dynamics->damping > 0) def.spring = Spring{0, static_cast<float>(joint.dynamics->damping)};
    }

    std::optional<Range> rangeOf(const urdf::Joint& joint, float bound) {
        if (!joint.limits) return {};
        Range range{static_cast<float>(joint.limits->lower), static_cast<float>(joint.limits->upper)};
        if (range.lower > 0 || range.upper < 0)
            warn("joint '" + joint.name + "': zero is outside of its range; it begins beyond its limit");
        if (range.lower < -bound || range.upper > bound) {
            warn("joint '" + joint.name + "': range " + shortNumber(range.lower) + " to " + shortNumber(range.upper) +
                 " rad exceeds half a turn either way; cut there");
            range = {std::clamp(range.lower, -bound, bound), std::clamp(range.upper, -bound, bound)};
        }
        return range;
    }

    HingeDef hinge(const urdf::Joint& joint) {
        HingeDef def;
        if (joint.type == urdf::Joint::REVOLUTE) def.limit = rangeOf(joint, kPi);
        resist(def, joint);
        return def;
    }

    SliderDef slider(const urdf::Joint& joint) {
        SliderDef def;
        def.limit = rangeOf(joint, 1e5f);
        resist(def, joint);
        return def;
    }

    void finishMasses() {
        for (std::size_t i = 0; i < robot_.bodies.size(); ++i) {
            RobotBody& body = robot_.bodies[i];
            if (!masses_[i].empty()) body.mass = combined(masses_[i]);
            robot_.mass += static_cast<double>(body.mass.mass);
            if (!body.anchored && !(body.mass.mass > 0))
                fail("link '" + body.name + "' moves but has no mass, must have an <inertial> with mass above 0 kg");
        }
    }

    void summarise() {
        if (missingMeshes_ > 0)
            warn(std::to_string(missingMeshes_) + " collision meshes are absent and left out, such as '" +
                 firstMissing_ + "'");
        if (speedLimited_ > 0)
            warn("velocity limits of " + std::to_string(speedLimited_) + " joints are kept but not enforced");
    }

    std::filesystem::path path_;
    RobotOptions options_;
    CheckedRobotText text_;
    Robot robot_;
    std::vector<std::vector<MassProperties>> masses_;
    urdf::ModelInterfaceSharedPtr model_;
    int missingMeshes_ = 0, speedLimited_ = 0;
    std::string firstMissing_;
};

}  // namespace

Robot loadRobot(const std::filesystem::path& path, const RobotOptions& options) {
    return RobotBuilder(path, options).run();
}

}  // namespace ragtop
