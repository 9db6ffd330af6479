#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/body.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"

namespace ragtop {

class World;

/// What a robot description leaves to its user.
struct RobotOptions {
    bool selfCollision = false;  ///< links that no joint joins collide with each other
    bool holding = false;        ///< motors hold every joint at rest with the effort that the file allows
    Material material{};
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RobotOptions*) {
    visit(Tunable{"selfCollision", "", 0, 1, "links that no joint joins collide with each other"}, self.selfCollision);
    visit(Tunable{"holding", "", 0, 1, "motors hold every joint at rest"}, self.holding);
    visit(Tunable{"material", "", 0, 0, "surface of all links"}, self.material);
}

/// One or more links that fixed joints make one rigid body.
struct RobotBody {
    std::string name{};  ///< of the first of them
    Frame pose{};        ///< in the robot when all joints are at zero, Y up
    MassProperties mass{};
    std::vector<ShapeDef> shapes{};
    bool anchored = false;  ///< the link "world" of the file, which does not move
};

/// A link of the file and the body that it became part of.
struct RobotLink {
    std::string name{};
    int body = -1;
    Frame inBody{};
};

/// A joint that moves. The bodies of `joint` are left null; its frames are in theirs.
struct RobotJoint {
    std::string name{};
    int parent = -1, child = -1;  ///< indices of bodies
    JointDef joint{};
    float effort = 0;    ///< N m or N that the file allows its motor
    float velocity = 0;  ///< rad/s or m/s that the file allows; not enforced
};

/// A robot from a description file, in metres with Y up.
struct Robot {
    std::string file{}, name{};
    std::vector<RobotBody> bodies{};  ///< parents before children
    std::vector<RobotLink> links{};
    std::vector<RobotJoint> joints{};
    double mass = 0;  ///< kg
    std::vector<std::string> warnings{};
};

/// Reads URDF, besides capsules (URDF 1.1) and spherical joints (Bullet's dialect). What cannot be honoured (meshes
/// that are absent, mimic, safety limits) is left out with a warning. Throws AssetError with the line: not XML, a
/// value that is no number or out of range, a link that is missing.
Robot loadRobot(const std::filesystem::path& path, const RobotOptions& options = {});

/// A robot in a world.
struct RobotIds {
    std::vector<BodyId> bodies;   ///< one per body
    std::vector<JointId> joints;  ///< one per joint
};

/// Creates the bodies and joints of a robot whose root is at `placement`. Throws std::invalid_argument.
RobotIds makeRobot(World& world, const Robot& robot, const Pose& placement = {}, const RobotOptions& options = {});

/// Mass, bodies with shapes, joints and warnings, some lines of text.
std::string describeAsset(const Robot& robot);

}  // namespace ragtop
