#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ragtop/math.h"

namespace ragtop {

enum class RobotJointKind : std::uint8_t { fixed, hinge, slider, ball, plane, free };

struct ImportedRobotJoint {
    std::string name;
    RobotJointKind kind = RobotJointKind::fixed;
    Frame origin;   ///< of the child in the parent link where the coordinate is zero
    Vec3 anchor{};  ///< in the child link, where it turns
    Vec3 axis{1, 0, 0};
    bool limited = false, rated = false;    ///< has a range; has an effort and a velocity
    float lower = 0, upper = 0;             ///< rad or m
    float effort = 0, velocity = 0;         ///< N m or N, rad/s or m/s
    float damping = 0, friction = 0;        ///< N m s/rad or N s/m, N m or N
    float stiffness = 0, springTarget = 0;  ///< N m/rad or N/m; rad or m
    /// The joint that it follows, of which it is `multiplier` times the coordinate and `offset`; empty: none.
    std::string follows;
    float multiplier = 1, offset = 0;
    /// Within its range: beyond these, effort is held below −kVelocity (ẋ + kPosition (x − end)).
    float softLower = 0, softUpper = 0;
    float kPosition = 0, kVelocity = 0;  ///< 1/s, N m s/rad or N s/m; one of them 0: no such ends
};

enum class RobotShapeKind : std::uint8_t { box, sphere, cylinder, capsule, mesh, ellipsoid, plane };

struct ImportedRobotShape {
    RobotShapeKind kind = RobotShapeKind::box;
    Vec3 size{};                   ///< m, of a box; half of it, of an ellipsoid or plane; scale of a mesh
    float radius = 0, length = 0;  ///< m; the length of a capsule is of its straight part, along z
    Frame origin;                  ///< in the link
    std::string mesh;              ///< as the file names it
    float friction = -1;           ///< below 0: the file does not say
};

struct ImportedRobotLink {
    std::string name;
    std::int32_t parent = -1;
    ImportedRobotJoint joint;         ///< to the parent
    bool between = false;             ///< between two joints of one body, whose mass it takes a little of
    bool heavy = false;               ///< has a mass
    double mass = 0;                  ///< kg
    std::array<double, 6> inertia{};  ///< kg m²: xx, yy, zz, xy, xz, yz
    Frame centerOfMass;               ///< in the link; its axes are those of the inertia
    std::vector<ImportedRobotShape> shapes;
};

/// Elements of one name.
struct ImportedRobotTag {
    std::string tag;
    std::int32_t applied = 0, leftOut = 0;
};

/// Two links that are held together besides the tree.
struct ImportedRobotLoop {
    std::string name;
    bool welded = false;  ///< otherwise at one point
    std::int32_t a = 0, b = 0;
    Vec3 anchor{};  ///< in link a
};

struct ImportedRobotPart {
    std::int32_t link = 0;  ///< whose joint it is
    float ratio = 1;
};

/// What acts along a sum of coordinates.
struct ImportedRobotSum {
    std::string name;
    std::vector<ImportedRobotPart> parts;
    bool limited = false;
    float lower = 0, upper = 0;
    float stiffness = 0, damping = 0, friction = 0, rest = 0;
};

/// A pose by name.
struct ImportedRobotKey {
    std::string name;
    std::vector<float> coordinates;  ///< by link, of its joint
};

/// What a description says, in its own axes.
struct ImportedRobot {
    std::string name;
    bool grounded = false;  ///< the first link is the world
    std::vector<ImportedRobotLoop> loops;
    std::vector<ImportedRobotSum> sums;
    std::vector<ImportedRobotKey> keys;
    std::vector<ImportedRobotTag> tags;
    std::vector<ImportedRobotLink> links;  ///< depth first from the root
    std::vector<std::string> warnings;
};

/// Reads URDF or MJCF in a process of its own, since files may nest, or chain links, beyond what the libraries' stacks
/// hold. Throws AssetError: missing, not XML, a wrong value with its line, crashed, out of time.
ImportedRobot importRobot(const std::filesystem::path& path);
/// The same in this process.
ImportedRobot readRobot(const std::filesystem::path& path);

}  // namespace ragtop
