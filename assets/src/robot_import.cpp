#include "ragtop/robot.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <system_error>

#include "axes.h"
#include "import_text.h"
#include "ragtop/mesh_file.h"
#include "robot_document.h"
#include "robot_homes.h"

namespace ragtop {
namespace {

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
        for (const ImportedRobotTag& tag : from_.tags) robot_.tags.push_back({tag.tag, tag.applied, tag.leftOut});
        followed_ = followedLinks(from_, robot_.file, robot_.warnings);
        homes_ = homesOf(from_, followed_, robot_.warnings);
        for (const ImportedRobotLink& link : from_.links) addLink(link);
        addFollowers();
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
        const float home = homes_[robot_.links.size()];
        const RobotLink& parent = robot_.links[static_cast<std::size_t>(child.parent)];
        const Frame origin = parent.inBody * joint.origin;
        if (joint.kind == RobotJointKind::fixed) return {parent.body, {origin.position, normalized(origin.rotation)}};
        const int next = static_cast<int>(robot_.bodies.size());
        RobotBody made;
        made.name = child.name;
        made.pose = robot_.bodies[static_cast<std::size_t>(parent.body)].pose * origin * moved(joint, home);
        made.pose.rotation = normalized(made.pose.rotation);
        robot_.bodies.push_back(std::move(made));
        masses_.emplace_back();
        if (joint.kind == RobotJointKind::free) return {next, {}};
        jointOfLink_[robot_.links.size()] = static_cast<int>(robot_.joints.size());
        robot_.joints.push_back(jointOf(joint, parent.body, next, origin));
        robot_.joints.back().home = home;
        if (hasSoftEnds(joint)) addHardEnds(joint);
        return {next, {}};
    }

    static Frame moved(const ImportedRobotJoint& joint, float coordinate) {
        const Vec3 axis = normalized(joint.axis, {1, 0, 0});
        if (joint.kind == RobotJointKind::slider) return {coordinate * axis, {}};
        if (joint.kind != RobotJointKind::hinge || coordinate == 0) return {};
        return {{}, rotationAbout(axis, coordinate)};
    }

    RobotJoint jointOf(const ImportedRobotJoint& joint, int parent, int child, const Frame& origin) {
        RobotJoint result{joint.name, parent, child, BallDef{}, joint.effort, joint.velocity};
        if (joint.kind == RobotJointKind::hinge) result.joint = moving<HingeDef>(joint);
        if (joint.kind == RobotJointKind::slider) result.joint = moving<SliderDef>(joint);
        if (joint.kind == RobotJointKind::plane) result.joint = PlaneDef{};
        if (auto* ball = std::get_if<BallDef>(&result.joint)) {
            ball->friction = joint.friction;
            if (joint.damping > 0) ball->bearing = Bearing{.viscous = joint.damping};
        }
        const bool spherical = joint.kind == RobotJointKind::ball;
        const Quat alongAxis = spherical ? Quat{} : rotationBetween({1, 0, 0}, normalized(joint.axis, {1, 0, 0}));
        std::visit(
            [&](auto& def) {
                def.bodies.frameA = {origin.position, normalized(origin.rotation * alongAxis)};
                def.bodies.frameB = {{}, alongAxis};
            },
            result.joint);
        return result;
    }

    /// A hinge or slider. Viscous friction is a spring without stiffness.
    template <class Def>
    Def moving(const ImportedRobotJoint& joint) {
        Def def;
        if (joint.limited) {
            def.limit = softRange(joint);
            tellCutRange(joint);
        }
        // The effort of the drive is at most −kVelocity (ẋ + kPosition (x − end)) beyond a soft end.
        if (hasSoftEnds(joint)) def.stop = {0, joint.kPosition * joint.kVelocity, joint.kVelocity};
        def.friction = joint.friction;
        if (joint.damping > 0) def.spring = Spring{0, joint.damping};
        return def;
    }

    void tellCutRange(const ImportedRobotJoint& joint) {
        const Range range = hardRange(joint);
        if (range.lower != joint.lower || range.upper != joint.upper)
            warn("joint '" + joint.name + "': range " + shortNumber(joint.lower) + " to " + shortNumber(joint.upper) +
                 " is cut to " + shortNumber(range.lower) + " to " + shortNumber(range.upper));
    }

    /// A joint has one range; its second one is that of a sum of one coordinate.
    void addHardEnds(const ImportedRobotJoint& joint) {
        RobotCoupling ends{joint.name, {}, {static_cast<int>(robot_.joints.size()) - 1}};
        ends.coupling.count = 1;
        ends.coupling.sum.limit = hardRange(joint);
        robot_.couplings.push_back(std::move(ends));
    }

    /// x − multiplier · x of the other = offset.
    void addFollowers() {
        for (std::size_t i = 0; i < followed_.size(); ++i) {
            if (followed_[i] < 0) continue;
            const ImportedRobotJoint& joint = from_.links[i].joint;
            const int own = jointOfLink_.at(i), other = jointOfLink_.at(static_cast<std::size_t>(followed_[i]));
            RobotCoupling follows{joint.name, {}, {own}};
            follows.coupling.count = 1;
            follows.coupling.sum.limit = Range{joint.offset, joint.offset};
            if (joint.multiplier != 0) {
                follows.coupling.count = 2;
                follows.coupling.parts[1].ratio = -joint.multiplier;
                follows.joints.push_back(other);
            }
            robot_.couplings.push_back(std::move(follows));
        }
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
            leaveOutMesh();
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
            leaveOutMesh();
            warn("link '" + link + "': collision left out: " + error.what());
        }
    }

    void leaveOutMesh() {
        for (RobotTag& tag : robot_.tags)
            if (tag.tag == "mesh") --tag.applied, ++tag.leftOut;
    }

    /// Beside the description; for package://name/path in the roots that are given, or in a folder above it. Empty when
    /// it is nowhere.
    std::filesystem::path meshFile(const std::string& name) const {
        constexpr std::string_view kPackage = "package://", kFile = "file://";
        std::string rest = name;
        if (rest.starts_with(kFile)) rest = rest.substr(kFile.size());
        const bool inPackage = rest.starts_with(kPackage);
        std::vector<std::filesystem::path> places;
        std::error_code ignored;
        std::filesystem::path folder = std::filesystem::absolute(path_, ignored).parent_path();
        if (inPackage) {
            const std::string withName = rest.substr(kPackage.size());
            rest = withName.substr(std::min(withName.find('/') + 1, withName.size()));
            for (const std::filesystem::path& root : options_.packageRoots) {
                places.push_back(root / withName);
                places.push_back(root / rest);
            }
        }
        for (int level = 0; level < (inPackage ? 4 : 1); ++level, folder = folder.parent_path())
            places.push_back(folder / rest);
        for (const std::filesystem::path& place : places)
            if (std::filesystem::is_regular_file(place, ignored)) return place;
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
    }

    std::filesystem::path path_;
    RobotOptions options_;
    ImportedRobot from_;
    Robot robot_;
    std::vector<std::vector<MassProperties>> masses_;
    std::vector<int> followed_;  ///< by link, the link whose joint its joint follows
    std::vector<float> homes_;   ///< by link
    std::map<std::size_t, int> jointOfLink_;
    int missingMeshes_ = 0;
    std::string firstMissing_;
};

}  // namespace

int Robot::findJoint(std::string_view wanted) const {
    for (std::size_t i = 0; i < joints.size(); ++i)
        if (joints[i].name == wanted) return static_cast<int>(i);
    return -1;
}

Robot loadRobot(const std::filesystem::path& path, const RobotOptions& options) {
    return RobotBuilder(path, options).run();
}

}  // namespace ragtop
