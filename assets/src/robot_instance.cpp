#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "ragtop/robot.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Bodies of one robot share a group, named after the first of them and far below what callers would use.
constexpr std::int32_t kFirstGroup = -0x20000000;

BodyDef bodyOf(const RobotBody& body, const Pose& placement) {
    BodyDef def;
    def.type = body.anchored ? BodyType::fixed : BodyType::dynamic;
    def.shapes = body.shapes;
    def.pose = placement * body.pose;
    if (!body.anchored) def.mass = body.mass;
    return def;
}

// What holds a joint gives all of its effort so far from home, and damps so long as stiffness pushes.
constexpr float kServoAngle = 0.05f;    ///< rad; what bears a tenth of its effort sags by 0.3 degrees
constexpr float kServoTravel = 0.005f;  ///< m, as far at 0.1 m from the axis
constexpr float kServoTime = 0.05f;     ///< s, damping over stiffness: critical where a load swings at 6 Hz

/// A spring to where the joint begins. A motor without speed would give way for ever, by what iteration leaves undone.
void hold(JointDef& joint, float home, float effort) {
    const auto servo = [&](auto& along, float reach) {
        const float stiffness = effort / reach;
        along.spring = Spring{.stiffness = stiffness, .damping = kServoTime * stiffness, .maxForce = effort};
        along.target = home;
    };
    if (effort <= 0) return;
    if (auto* hinge = std::get_if<HingeDef>(&joint)) servo(*hinge, kServoAngle);
    if (auto* slider = std::get_if<SliderDef>(&joint)) servo(*slider, kServoTravel);
}

/// Joints with one coordinate have motors.
void setMotor(JointDef& joint, const Motor& motor) {
    if (auto* hinge = std::get_if<HingeDef>(&joint)) hinge->motor = motor;
    if (auto* slider = std::get_if<SliderDef>(&joint)) slider->motor = motor;
}

}  // namespace

JointDef robotJoint(const RobotJoint& joint, const RobotOptions& options) {
    JointDef def = joint.joint;
    if (options.holding) hold(def, joint.home, joint.effort);
    return def;
}

RobotIds makeRobot(World& world, const Robot& robot, const Pose& placement, const RobotOptions& options) {
    RobotIds ids;
    try {
        for (const RobotBody& body : robot.bodies) ids.bodies.push_back(world.create(bodyOf(body, placement)));
        if (!options.selfCollision && !ids.bodies.empty()) {
            Filter filter;
            filter.group = kFirstGroup + static_cast<std::int32_t>(ids.bodies.front().index);
            for (const BodyId body : ids.bodies)
                for (const ShapeId shape : world.shapes(body)) world.setFilter(shape, filter);
        }
        for (const RobotJoint& joint : robot.joints) {
            JointDef def = robotJoint(joint, options);
            std::visit(
                [&](auto& each) {
                    each.bodies.a = ids.bodies.at(static_cast<std::size_t>(joint.parent));
                    each.bodies.b = ids.bodies.at(static_cast<std::size_t>(joint.child));
                },
                def);
            ids.joints.push_back(world.create(def));
        }
        for (const RobotCoupling& each : robot.couplings) {
            CouplingDef def = each.coupling;
            for (std::size_t i = 0; i < each.joints.size(); ++i)
                def.parts.at(i).joint = ids.joints.at(static_cast<std::size_t>(each.joints[i]));
            ids.couplings.push_back(world.create(def));
        }
    } catch (...) {
        for (const BodyId body : ids.bodies) world.destroy(body);
        throw;
    }
    return ids;
}

void driveRobot(World& world, const Robot& robot, const RobotIds& ids, std::span<const float> coordinates, double dt) {
    if (coordinates.size() != robot.joints.size())
        throw std::invalid_argument(fmt::format("coordinates: there are {}, must be {}, one per joint",
                                                coordinates.size(), robot.joints.size()));
    if (!(dt > 0 && std::isfinite(dt))) throw std::invalid_argument(fmt::format("dt is {}, must be above 0 s", dt));
    std::vector<bool> follows(robot.joints.size(), false);
    for (const RobotCoupling& each : robot.couplings)
        if (each.follows) follows[static_cast<std::size_t>(each.joints.front())] = true;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const RobotJoint& joint = robot.joints[i];
        if (follows[i] || std::isnan(coordinates[i])) continue;
        const float missing = coordinates[i] - world.state(ids.joints[i]).coordinate;
        float speed = missing / static_cast<float>(dt);
        if (joint.velocity > 0) speed = std::clamp(speed, -joint.velocity, joint.velocity);
        JointDef def = world.def(ids.joints[i]);
        setMotor(def, {speed, joint.effort});
        world.setDef(ids.joints[i], def);
    }
}

std::string describeAsset(const Robot& robot) {
    std::string text =
        fmt::format("{}\n  robot     {}\n  mass      {:.3f} kg\n  links     {} in {} bodies\n  joints    {}\n",
                    robot.file, robot.name, robot.mass, robot.links.size(), robot.bodies.size(), robot.joints.size());
    for (const RobotBody& body : robot.bodies)
        text += fmt::format("    {:<32} {:8.4f} kg  {} shapes{}\n", body.name, body.mass.mass, body.shapes.size(),
                            body.anchored ? ", fixed to the world" : "");
    for (const RobotCoupling& each : robot.couplings)
        if (each.follows && each.joints.size() > 1)
            text +=
                fmt::format("    {:<32} follows {}, {:g} times\n", each.name,
                            robot.joints[static_cast<std::size_t>(each.joints[1])].name, -each.coupling.parts[1].ratio);
    std::string leftOut;
    for (const RobotTag& tag : robot.tags)
        if (tag.leftOut > 0) leftOut += fmt::format("{}{} {}", leftOut.empty() ? "" : ", ", tag.leftOut, tag.tag);
    if (!leftOut.empty()) text += "  left out  " + leftOut + "\n";
    for (const std::string& warning : robot.warnings) text += "  warning   " + warning + "\n";
    return text;
}

}  // namespace ragtop
