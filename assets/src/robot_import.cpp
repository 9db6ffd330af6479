#include "ragtop/robot.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>

#include "axes.h"
#include "import_text.h"
#include "ragtop/mesh_file.h"
#include "robot_document.h"

namespace ragtop {
namespace {

/// Of limits, as of those of the joints that they become; rad or m.
constexpr float kFarthestLimit = 1e5f;

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
        : path_(path), options_(options), from_(importRobot(path)) {
        robot_.file = path.string();
    }

    Robot run() {
        robot_.name = from_.name;
        robot_.warnings = from_.warnings;
        for (const ImportedRobotLink& link : from_.links) addLink(link);
        finishMasses();
        summarise();
        robot_.warnings = counted(robot_.warnings);
        return std::move(robot_);
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw AssetError(robot_.file, "", message); }
    void warn(std::string message) { robot_.warnings.push_back(std::move(message)); }

    /// Links on fixed joints go into the body of their parent; all others begin a body.
    void addLink(const ImportedRobotLink& link) {
        const auto [body, inBody] = link.parent < 0 ? addRoot(link) : addJoint(link);
        robot_.links.push_back({link.name, body, inBody});
        const auto at = static_cast<std::size_t>(body);
        if (link.heavy) addMass(link, at, inBody);
        for (const ImportedRobotShape& shape : link.shapes) addShape(link.name, shape, at, inBody);
    }

    struct Place {
        int body = 0;
        Frame inBody{};
    };

    Place addRoot(const ImportedRobotLink& root) {
        RobotBody first;
        first.name = root.name;
        first.anchored = root.name == "world" && !root.heavy && root.shapes.empty();
        first.pose.rotation = uprightRotation(UpAxis::z);
        robot_.bodies.push_back(std::move(first));
        masses_.emplace_back();
        return {};
    }

    Place addJoint(const ImportedRobotLink& child) {
        const ImportedRobotJoint& joint = child.joint;
        const RobotLink& parent = robot_.links[static_cast<std::size_t>(child.parent)];
        const Frame origin = parent.inBody * joint.origin;
        if (joint.kind == RobotJointKind::fixed) return {parent.body, {origin.position, normalized(origin.rotation)}};
        const int next = static_cast<int>(robot_.bodies.size());
        RobotBody made;
        made.name = child.name;
        made.pose = robot_.bodies[static_cast<std::size_t>(parent.body)].pose * origin;
        made.pose.rotation = normalized(made.pose.rotation);
        robot_.bodies.push_back(std::move(made));
        masses_.emplace_back();
        if (joint.planar) warn("joint '" + joint.name + "': planar joints are left free");
        if (joint.kind != RobotJointKind::free) robot_.joints.push_back(jointOf(joint, parent.body, next, origin));
        return {next, {}};
    }

    RobotJoint jointOf(const ImportedRobotJoint& joint, int parent, int child, const Frame& origin) {
        RobotJoint result{joint.name, parent, child, BallDef{}, joint.effort, joint.velocity};
        const bool spherical = joint.kind == RobotJointKind::ball;
        if (joint.kind == RobotJointKind::hinge) result.joint = moving<HingeDef>(joint);
        if (joint.kind == RobotJointKind::slider) result.joint = moving<SliderDef>(joint);
        const Quat alongAxis = spherical ? Quat{} : rotationBetween({1, 0, 0}, normalized(joint.axis));
        std::visit(
            [&](auto& def) {
                def.bodies.frameA = {origin.position, normalized(origin.rotation * alongAxis)};
                def.bodies.frameB = {{}, alongAxis};
            },
            result.joint);
        speedLimited_ += joint.rated && joint.velocity > 0;
        return result;
    }

    /// A hinge or slider. Viscous friction is a spring without stiffness.
    template <class Def>
    Def moving(const ImportedRobotJoint& joint) {
        Def def;
        if (joint.limited) def.limit = rangeOf(joint);
        def.friction = joint.friction;
        if (joint.damping > 0) def.spring = Spring{0, joint.damping};
        return def;
    }

    Range rangeOf(const ImportedRobotJoint& joint) {
        if (joint.lower > 0 || joint.upper < 0)
            warn("joint '" + joint.name + "': zero is outside of its range; it begins beyond its limit");
        const Range range{std::clamp(joint.lower, -kFarthestLimit, kFarthestLimit),
                          std::clamp(joint.upper, -kFarthestLimit, kFarthestLimit)};
        if (range.lower != joint.lower || range.upper != joint.upper)
            warn("joint '" + joint.name + "': range " + shortNumber(joint.lower) + " to " + shortNumber(joint.upper) +
                 " is cut at " + shortNumber(kFarthestLimit) + " either way");
        return range;
    }

    void addMass(const ImportedRobotLink& link, std::size_t body, const Frame& inBody) {
        const auto [xx, yy, zz, xy, xz, yz] = link.inertia;
        const auto column = [](double x, double y, double z) {
            return Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        };
        MassProperties mass{static_cast<float>(link.mass), {}, {}};
        mass.inertia = {column(xx, xy, xz), column(xy, yy, yz), column(xz, yz, zz)};
        // Each principal moment of a body is at most the sum of the others; the files' digits allow a per cent.
        if (std::max({xx, yy, zz}) > 0.505 * (xx + yy + zz))
            warn("link '" + link.name + "': its inertia is that of no body: one moment exceeds the sum of the others");
        masses_[body].push_back(transformed(mass, inBody * link.centerOfMass));
    }

    void push(std::size_t body, Shape shape, const Frame& frame) {
        ShapeDef def{.geometry = std::move(shape), .frame = frame, .material = options_.material};
        def.frame.rotation = normalized(frame.rotation);
        robot_.bodies[body].shapes.push_back(std::move(def));
    }

    void addShape(const std::string& link, const ImportedRobotShape& shape, std::size_t body, const Frame& inBody) {
        const Frame frame = inBody * shape.origin;
        switch (shape.kind) {
            case RobotShapeKind::sphere:
                return push(body, Sphere{shape.radius}, frame);
            case RobotShapeKind::box:
                return push(body, Box{0.5f * shape.size}, frame);
            case RobotShapeKind::cylinder:
                return push(body, cylinder(shape.radius, shape.length), frame);
            case RobotShapeKind::capsule:
                return push(body, Capsule{shape.radius, 0.5f * shape.length}, frame * Frame{{}, kYToZ});
            case RobotShapeKind::mesh:
                return addMesh(link, shape, body, frame);
        }
    }

    void addMesh(const std::string& link, const ImportedRobotShape& shape, std::size_t body, const Frame& frame) {
        const std::filesystem::path file = meshFile(shape.mesh);
        if (file.empty()) {
            ++missingMeshes_;
            if (firstMissing_.empty()) firstMissing_ = shape.mesh + "' of link '" + link;
            return;
        }
        try {
            const Shape hull = loadMesh(file, {.convex = true});
            std::vector<Vec3> points;
            for (const Vec3& point : std::get<ConvexHull>(hull).vertices()) points.push_back(scale(shape.size, point));
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
    ImportedRobot from_;
    Robot robot_;
    std::vector<std::vector<MassProperties>> masses_;
    int missingMeshes_ = 0, speedLimited_ = 0;
    std::string firstMissing_;
};

}  // namespace

Robot loadRobot(const std::filesystem::path& path, const RobotOptions& options) {
    return RobotBuilder(path, options).run();
}

}  // namespace ragtop
