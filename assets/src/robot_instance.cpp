#include <fmt/format.h>

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

void hold(JointDef& joint, float effort) {
    const Motor motor{0, effort};
    if (auto* hinge = std::get_if<HingeDef>(&joint)) hinge->motor = motor;
    if (auto* slider = std::get_if<SliderDef>(&joint)) slider->motor = motor;
}

}  // namespace

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
            JointDef def = joint.joint;
            if (options.holding) hold(def, joint.effort);
            std::visit(
                [&](auto& each) {
                    each.bodies.a = ids.bodies.at(static_cast<std::size_t>(joint.parent));
                    each.bodies.b = ids.bodies.at(static_cast<std::size_t>(joint.child));
                },
                def);
            ids.joints.push_back(world.create(def));
        }
    } catch (...) {
        for (const BodyId body : ids.bodies) world.destroy(body);
        throw;
    }
    return ids;
}

std::string describeAsset(const Robot& robot) {
    std::string text =
        fmt::format("{}\n  robot     {}\n  mass      {:.3f} kg\n  links     {} in {} bodies\n  joints    {}\n",
                    robot.file, robot.name, robot.mass, robot.links.size(), robot.bodies.size(), robot.joints.size());
    for (const RobotBody& body : robot.bodies)
        text += fmt::format("    {:<32} {:8.4f} kg  {} shapes{}\n", body.name, body.mass.mass, body.shapes.size(),
                            body.anchored ? ", fixed to the world" : "");
    for (const std::string& warning : robot.warnings) text += "  warning   " + warning + "\n";
    return text;
}

}  // namespace ragtop
