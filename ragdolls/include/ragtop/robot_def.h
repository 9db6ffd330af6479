#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/body.h"
#include "ragtop/coupling.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"

/// Robots as links and joints, and in a world. Files are read by ragtop/robot.h and, cooked, by ragtop/cooked.h.
namespace ragtop {

class World;

/// What a robot description leaves to its user.
struct RobotOptions {
    bool selfCollision = false;  ///< links that no joint joins collide with each other
    bool holding = false;        ///< servos hold every joint where it begins, with the effort that the file allows
    Material material{};
    /// Where package://name/… lies: folders with a folder of that name, or that are it. Folders above the description
    /// are searched besides.
    std::vector<std::filesystem::path> packageRoots{};
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RobotOptions*) {
    visit(Tunable{"selfCollision", "", 0, 1, "links that no joint joins collide with each other"}, self.selfCollision);
    visit(Tunable{"holding", "", 0, 1, "servos hold every joint where it begins"}, self.holding);
    visit(Tunable{"material", "", 0, 0, "surface of all links"}, self.material);
}

/// One or more links that fixed joints make one rigid body.
struct RobotBody {
    std::string name{};  ///< of the first of them
    Frame pose{};        ///< in the robot when all joints are at home, Y up
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
    float effort = 0;    ///< N m or N that its motor has; 0: none
    float velocity = 0;  ///< rad/s or m/s that its motor reaches; 0: no bound
    float home = 0;      ///< rad or m that it begins with: zero, or what in its range is nearest to that
};

/// A joint of a sum of coordinates: joints that follow others, and second bounds of one joint.
struct RobotCoupling {
    std::string name{};
    CouplingDef coupling{};     ///< with null joints
    std::vector<int> joints{};  ///< indices of joints, one per part
    bool follows = false;       ///< the first joint follows the others
};

/// A pose that a file has a name for.
struct RobotKeyframe {
    std::string name{};
    std::vector<float> coordinates{};  ///< rad or m, one per joint
};

/// What became of the elements of one name in a description.
struct RobotTag {
    std::string tag{};
    int applied = 0, leftOut = 0;
};

/// A robot from a description file, in metres with Y up.
struct Robot {
    std::string file{}, name{};
    std::vector<RobotBody> bodies{};  ///< parents before children
    std::vector<RobotLink> links{};
    std::vector<RobotJoint> joints{};
    std::vector<RobotCoupling> couplings{};
    std::vector<RobotKeyframe> keyframes{};
    std::vector<RobotTag> tags{};  ///< all elements of the file, in the order of their names
    double mass = 0;               ///< kg
    std::vector<std::string> warnings{};

    /// Index of the joint of that name, −1 when there is none.
    int findJoint(std::string_view name) const;
};

/// Empty when the robot is usable; otherwise names what is wrong and what is allowed.
std::string whyInvalid(const Robot& robot);

/// A robot in a world.
struct RobotIds {
    std::vector<BodyId> bodies;   ///< one per body
    std::vector<JointId> joints;  ///< one per joint
    std::vector<CouplingId> couplings;
};

/// A joint as makeRobot makes it, its bodies left null. One that is held has a spring to its home instead of its own,
/// which gives all of the effort 0.05 rad or 5 mm from there.
JointDef robotJoint(const RobotJoint& joint, const RobotOptions& options);

/// Creates the bodies and joints of a robot whose root is at `placement`. Throws std::invalid_argument.
RobotIds makeRobot(World& world, const Robot& robot, const Pose& placement = {}, const RobotOptions& options = {});

/// Sets the motors of hinges and sliders for a step of dt seconds so that they get to `coordinates` (rad or m, one per
/// joint; NaN leaves a joint alone), no faster than their velocity and no stronger than their effort. Joints that
/// follow others are left to these; the robot is not to be made `holding`. What pushes a joint from outside may move it
/// faster. Throws std::invalid_argument.
void driveRobot(World& world, const Robot& robot, const RobotIds& ids, std::span<const float> coordinates, double dt);

}  // namespace ragtop
