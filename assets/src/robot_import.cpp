#include "ragtop/robot.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "axes.h"
#include "import_text.h"
#include "ragtop/mesh_file.h"
#include "robot_document.h"
#include "robot_homes.h"
#include "robot_meshes.h"
#include "robot_moments.h"

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

/// Rings of points on an ellipsoid with these half axes.
ConvexHull ellipsoid(const Vec3& half) {
    constexpr int kRings = 7, kSides = 16;
    std::vector<Vec3> points{{0, 0, half.z}, {0, 0, -half.z}};
    for (int ring = 1; ring <= kRings; ++ring) {
        const SinCos down = sinCos(kPi * static_cast<float>(ring) / (kRings + 1));
        for (int side = 0; side < kSides; ++side) {
            const SinCos round = sinCos(2 * kPi * static_cast<float>(side) / kSides);
            points.push_back({half.x * down.sin * round.cos, half.y * down.sin * round.sin, half.z * down.cos});
        }
    }
    return ConvexHull(points);
}

/// Below a plane, which has no end where its half size is 0.
constexpr float kPlaneDepth = 1, kPlaneHalf = 100;  // m
Box slab(const Vec3& half) {
    return {{half.x > 0 ? half.x : kPlaneHalf, half.y > 0 ? half.y : kPlaneHalf, kPlaneDepth}};
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
        for (const ImportedRobotSum& sum : from_.sums) addSum(sum);
        for (const ImportedRobotLoop& loop : from_.loops) addLoop(loop);
        for (const ImportedRobotKey& key : from_.keys) addKey(key);
        finishMasses();
        summarise();
        robot_.warnings = counted(robot_.warnings);
        if (const std::string why = whyInvalid(robot_); !why.empty()) fail(why);
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
        for (const ImportedRobotShape& shape : link.shapes) {
            try {
                addShape(link.name, shape, at, inBody);
            } catch (const std::invalid_argument& error) {
                warn("link '" + link.name + "': collision left out: " + error.what());
            }
        }
    }

    struct Place {
        int body = 0;
        Frame inBody{};
    };

    Place addRoot(const ImportedRobotLink& root) {
        RobotBody first;
        first.name = root.name;
        first.anchored = from_.grounded || (root.name == "world" && !root.heavy && root.shapes.empty());
        first.pose.rotation = uprightRotation(UpAxis::z);
        robot_.bodies.push_back(std::move(first));
        begin(root);
        return {};
    }

    void begin(const ImportedRobotLink& link) {
        masses_.emplace_back();
        between_.push_back(link.between);
        parents_.push_back(robot_.links.empty() ? -1 : robot_.links[static_cast<std::size_t>(link.parent)].body);
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
        begin(child);
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
        const Quat turn = rotationAbout(axis, coordinate);
        return {joint.anchor - rotate(turn, joint.anchor), turn};
    }

    RobotJoint jointOf(const ImportedRobotJoint& joint, int parent, int child, const Frame& origin) {
        RobotJoint result{joint.name, parent, child, BallDef{}, joint.effort, joint.velocity};
        if (joint.kind == RobotJointKind::hinge) result.joint = moving<HingeDef>(joint);
        if (joint.kind == RobotJointKind::slider) result.joint = moving<SliderDef>(joint);
        if (joint.kind == RobotJointKind::plane) result.joint = PlaneDef{};
        if (auto* ball = std::get_if<BallDef>(&result.joint)) {
            ball->friction = joint.friction;
            if (joint.stiffness > 0) ball->spring = Spring{joint.stiffness, 0};
            if (joint.limited) limitBall(*ball, joint);
            if (joint.damping > 0) ball->bearing = Bearing{.viscous = joint.damping};
        }
        const bool spherical = joint.kind == RobotJointKind::ball;
        const Quat alongAxis = spherical ? Quat{} : rotationBetween({1, 0, 0}, normalized(joint.axis, {1, 0, 0}));
        std::visit(
            [&](auto& def) {
                const Frame at{joint.anchor, alongAxis};
                def.bodies.frameA = origin * at;
                def.bodies.frameA.rotation = normalized(def.bodies.frameA.rotation);
                def.bodies.frameB = at;
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
        if (joint.damping > 0 || joint.stiffness > 0) def.spring = Spring{joint.stiffness, joint.damping};
        def.target = joint.springTarget;
        return def;
    }

    /// Files bound the whole angle.
    void limitBall(BallDef& ball, const ImportedRobotJoint& joint) {
        const float most = std::clamp(joint.upper, 1e-3f, 3.1f);
        ball.swingLimit = most;
        ball.twistLimit = Range{-most, most};
        warn("joint '" + joint.name + "': its range bounds swing and twist apart");
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
            RobotCoupling follows{joint.name, {}, {own}, true};
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

    void addSum(const ImportedRobotSum& from) {
        RobotCoupling sum{from.name, {}, {}};
        for (const ImportedRobotPart& part : from.parts) {
            sum.coupling.parts.at(sum.joints.size()).ratio = part.ratio;
            sum.joints.push_back(jointOfLink_.at(static_cast<std::size_t>(part.link)));
        }
        sum.coupling.count = static_cast<int>(sum.joints.size());
        AxisDef& along = sum.coupling.sum;
        if (from.limited) along.limit = Range{from.lower, from.upper};
        if (from.stiffness > 0 || from.damping > 0) along.spring = Spring{from.stiffness, from.damping};
        along.target = from.rest;
        along.friction = from.friction;
        robot_.couplings.push_back(std::move(sum));
    }

    /// Holds two bodies together where they stand at home.
    void addLoop(const ImportedRobotLoop& loop) {
        const RobotLink& a = robot_.links.at(static_cast<std::size_t>(loop.a));
        const RobotLink& b = robot_.links.at(static_cast<std::size_t>(loop.b));
        const Frame inA = a.inBody * Frame{loop.anchor, {}};
        const Frame inB = inverse(robot_.bodies[static_cast<std::size_t>(b.body)].pose) *
                          robot_.bodies[static_cast<std::size_t>(a.body)].pose * inA;
        RobotJoint joint{loop.name, a.body, b.body, BallDef{}};
        if (loop.welded) joint.joint = FixedDef{};
        std::visit(
            [&](auto& def) {
                def.bodies.frameA = {inA.position, normalized(inA.rotation)};
                def.bodies.frameB = {inB.position, normalized(inB.rotation)};
            },
            joint.joint);
        if (a.body == b.body) return warn("'" + loop.name + "' holds one body to itself: left out");
        robot_.joints.push_back(std::move(joint));
    }

    void addKey(const ImportedRobotKey& key) {
        RobotKeyframe pose{key.name, std::vector<float>(robot_.joints.size(), 0.0f)};
        for (const auto& [link, joint] : jointOfLink_)
            pose.coordinates[static_cast<std::size_t>(joint)] = key.coordinates.at(link);
        robot_.keyframes.push_back(std::move(pose));
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

    void push(std::size_t body, Shape shape, const Frame& frame, float friction) {
        if (const std::string why = whyInvalid(shape); !why.empty()) throw std::invalid_argument(why);
        ShapeDef def{.geometry = std::move(shape), .frame = frame, .material = options_.material};
        if (friction >= 0) def.material.friction = std::min(friction, 10.0f);
        def.frame.rotation = normalized(frame.rotation);
        robot_.bodies[body].shapes.push_back(std::move(def));
    }

    void addShape(const std::string& link, const ImportedRobotShape& shape, std::size_t body, const Frame& inBody) {
        const Frame frame = inBody * shape.origin;
        switch (shape.kind) {
            case RobotShapeKind::sphere:
                return push(body, Sphere{shape.radius}, frame, shape.friction);
            case RobotShapeKind::box:
                return push(body, Box{0.5f * shape.size}, frame, shape.friction);
            case RobotShapeKind::cylinder:
                return push(body, cylinder(shape.radius, shape.length), frame, shape.friction);
            case RobotShapeKind::capsule:
                return push(body, Capsule{shape.radius, 0.5f * shape.length}, frame * Frame{{}, kYToZ}, shape.friction);
            case RobotShapeKind::ellipsoid:
                return push(body, ellipsoid(shape.size), frame, shape.friction);
            case RobotShapeKind::plane:
                return push(body, slab(shape.size), frame * Frame{{0, 0, -kPlaneDepth}, {}}, shape.friction);
            case RobotShapeKind::mesh:
                return addMesh(link, shape, body, frame);
        }
    }

    void addMesh(const std::string& link, const ImportedRobotShape& shape, std::size_t body, const Frame& frame) {
        const auto [file, isOutside] = findRobotMesh(shape.mesh, path_, options_.packageRoots);
        if (file.empty()) {
            leaveOutMesh();
            (isOutside ? outside_ : missing_).push_back(shape.mesh + "' of link '" + link);
            return;
        }
        try {
            const Shape hull = loadMesh(file, {.convex = true});
            std::vector<Vec3> points;
            for (const Vec3& point : std::get<ConvexHull>(hull).vertices()) points.push_back(scale(shape.size, point));
            push(body, ConvexHull(points), frame, shape.friction);
        } catch (const std::exception& error) {
            leaveOutMesh();
            warn("link '" + link + "': collision left out: " + error.what());
        }
    }

    void leaveOutMesh() {
        for (RobotTag& tag : robot_.tags)
            if (tag.tag == "mesh") --tag.applied, ++tag.leftOut;
    }

    /// Bodies between two joints of one take a hundred-thousandth of it each, so that all of it weighs what it should:
    /// near where a stack of hinges locks, angles are off by that share over the square of the cosine.
    void shareMasses() {
        constexpr float kShare = 1e-5f;
        const auto scaled = [](MassProperties mass, float share) {
            mass.mass *= share;
            mass.inertia = {share * mass.inertia.cx, share * mass.inertia.cy, share * mass.inertia.cz};
            return mass;
        };
        for (std::size_t last = robot_.bodies.size(); last-- > 0;) {
            if (between_[last] || masses_[last].empty()) continue;
            const MassProperties whole = combined(masses_[last]);
            float left = 1;
            for (int i = parents_[last]; i >= 0 && between_[static_cast<std::size_t>(i)];
                 i = parents_[static_cast<std::size_t>(i)]) {
                const auto at = static_cast<std::size_t>(i);
                if (!masses_[at].empty()) break;  // that of another limb, which it carries too
                const Frame place = inverse(robot_.bodies[at].pose) * robot_.bodies[last].pose;
                masses_[at].push_back(transformed(scaled(whole, kShare), place));
                left -= kShare;
            }
            masses_[last] = {scaled(whole, left)};
        }
    }

    void finishMasses() {
        shareMasses();
        for (std::size_t i = 0; i < robot_.bodies.size(); ++i) {
            RobotBody& body = robot_.bodies[i];
            if (!masses_[i].empty()) body.mass = combined(masses_[i]);
            if (!body.anchored) robot_.mass += static_cast<double>(body.mass.mass);
            if (!body.anchored && !(body.mass.mass > 0))
                fail("link '" + body.name + "' moves but has no mass, must have an <inertial> with mass above 0 kg");
            if (body.anchored || !isThin(body.mass)) continue;
            Thickened thick = thickened(body.mass, body.shapes);
            body.mass = thick.mass;
            thin_[thick.as].push_back(body.name);
        }
    }

    void summarise() {
        for (const auto& [as, links] : thin_)
            warn(std::to_string(links.size()) + (links.size() == 1 ? " link has" : " links have") +
                 " no inertia about some axis, taken as " + as + ", such as '" + links.front() + "'");
        if (!missing_.empty())
            warn(std::to_string(missing_.size()) + " collision meshes are absent and left out, such as '" +
                 missing_.front() + "'");
        if (!outside_.empty())
            warn(std::to_string(outside_.size()) +
                 " collision meshes are left out, as they lie neither in the folder above the description's nor in a "
                 "package, such as '" +
                 outside_.front() + "'");
    }

    std::filesystem::path path_;
    RobotOptions options_;
    ImportedRobot from_;
    Robot robot_;
    std::vector<std::vector<MassProperties>> masses_;
    std::vector<bool> between_;  ///< by body
    std::vector<int> parents_;   ///< by body, of the joint that it hangs on
    std::vector<int> followed_;  ///< by link, the link whose joint its joint follows
    std::vector<float> homes_;   ///< by link
    std::map<std::size_t, int> jointOfLink_;
    std::vector<std::string> missing_, outside_;            ///< meshes
    std::map<std::string, std::vector<std::string>> thin_;  ///< names of links, by what they are taken as
};

}  // namespace

Robot loadRobot(const std::filesystem::path& path, const RobotOptions& options) {
    return RobotBuilder(path, options).run();
}

}  // namespace ragtop
