#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "ragtop/robot_def.h"
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

/// Empty where `index` is that of one of so many.
std::string whyOutside(const std::string& what, int index, std::size_t count) {
    if (index >= 0 && static_cast<std::size_t>(index) < count) return {};
    return what + " is " + std::to_string(index) + ", must be at least 0 and below " + std::to_string(count);
}

std::string whyInvalid(const RobotJoint& joint, std::size_t bodies) {
    for (const auto& [what, body] : {std::pair{"parent", joint.parent}, {"child", joint.child}})
        if (std::string why = whyOutside(what, body, bodies); !why.empty()) return why;
    if (joint.parent == joint.child) return "parent and child are one body, must be two";
    for (const float value : {joint.effort, joint.velocity})
        if (!(value >= 0)) return "effort or velocity is " + std::to_string(value) + ", must be at least 0";
    JointDef def = joint.joint;
    std::visit([](auto& kind) { kind.bodies.a = {0, 1}, kind.bodies.b = {1, 1}; }, def);
    return whyInvalid(def);
}

std::string whyInvalid(const RobotCoupling& each, std::size_t joints) {
    if (each.joints.size() != static_cast<std::size_t>(std::max(each.coupling.count, 0)) || each.joints.empty())
        return "has " + std::to_string(each.joints.size()) + " joints, must have one for each of its terms";
    CouplingDef def = each.coupling;
    for (std::size_t i = 0; i < each.joints.size() && i < def.parts.size(); ++i) {
        if (std::string why = whyOutside("joint", each.joints[i], joints); !why.empty()) return why;
        def.parts[i].joint = {static_cast<std::uint32_t>(each.joints[i]), 1};
    }
    return whyInvalid(def);
}

}  // namespace

std::string whyInvalid(const Robot& robot) {
    const auto named = [](const char* kind, const std::string& name, const std::string& why) {
        return why.empty() ? std::string() : std::string(kind) + " '" + name + "': " + why;
    };
    if (robot.bodies.empty()) return "has no bodies, must have one or more";
    for (const RobotBody& body : robot.bodies)
        if (std::string why = named("body", body.name, whyInvalid(bodyOf(body, {}))); !why.empty()) return why;
    for (const RobotLink& link : robot.links) {
        const std::string why = whyOutside("body", link.body, robot.bodies.size());
        if (!why.empty()) return named("link", link.name, why);
    }
    for (const RobotJoint& joint : robot.joints) {
        const std::string why = whyInvalid(joint, robot.bodies.size());
        if (!why.empty()) return named("joint", joint.name, why);
    }
    for (const RobotCoupling& each : robot.couplings) {
        const std::string why = whyInvalid(each, robot.joints.size());
        if (!why.empty()) return named("coupling", each.name, why);
    }
    for (const RobotKeyframe& key : robot.keyframes)
        if (key.coordinates.size() != robot.joints.size())
            return named("keyframe", key.name,
                         "has " + std::to_string(key.coordinates.size()) + " coordinates, must have " +
                             std::to_string(robot.joints.size()) + ", one per joint");
    return {};
}

int Robot::findJoint(std::string_view wanted) const {
    for (std::size_t i = 0; i < joints.size(); ++i)
        if (joints[i].name == wanted) return static_cast<int>(i);
    return -1;
}

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
        throw std::invalid_argument("coordinates: there are " + std::to_string(coordinates.size()) + ", must be " +
                                    std::to_string(robot.joints.size()) + ", one per joint");
    if (!(dt > 0 && std::isfinite(dt)))
        throw std::invalid_argument("dt is " + std::to_string(dt) + ", must be above 0 s");
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

}  // namespace ragtop
