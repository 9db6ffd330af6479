#include "robot_json.h"

#include <fmt/format.h>

#include <array>

#include "json_text.h"

namespace ragtop::demos {
namespace {

/// In the order of JointDef.
constexpr std::array<const char*, 11> kKinds{"ball",      "hinge", "slider", "fixed", "distance", "cylindrical",
                                             "universal", "plane", "screw",  "path",  "sixDof"};

}  // namespace

std::string robotJson(const Robot& robot) {
    const std::string bodies = jsonList("bodies", robot.bodies, [](const RobotBody& body) {
        return fmt::format("{{\"name\": {}, \"mass\": {}, \"shapes\": {}, \"anchored\": {}}}", jsonString(body.name),
                           jsonNumber(static_cast<double>(body.mass.mass)), body.shapes.size(), body.anchored);
    });
    const auto nameOf = [&](int body) { return jsonString(robot.bodies[static_cast<std::size_t>(body)].name); };
    const std::string joints = jsonList("joints", robot.joints, [&](const RobotJoint& joint) {
        return fmt::format(
            "{{\"name\": {}, \"kind\": \"{}\", \"parent\": {}, \"child\": {}, \"home\": {}, \"effort\": {}, "
            "\"velocity\": {}}}",
            jsonString(joint.name), kKinds.at(joint.joint.index()), nameOf(joint.parent), nameOf(joint.child),
            jsonNumber(static_cast<double>(joint.home)), jsonNumber(static_cast<double>(joint.effort)),
            jsonNumber(static_cast<double>(joint.velocity)));
    });
    const std::string couplings = jsonList("couplings", robot.couplings, [&](const RobotCoupling& each) {
        std::string parts;
        for (std::size_t i = 0; i < each.joints.size(); ++i)
            parts += fmt::format("{}{{\"joint\": {}, \"ratio\": {}}}", i > 0 ? ", " : "",
                                 jsonString(robot.joints[static_cast<std::size_t>(each.joints[i])].name),
                                 jsonNumber(static_cast<double>(each.coupling.parts[i].ratio)));
        return fmt::format("{{\"name\": {}, \"sum\": [{}]}}", jsonString(each.name), parts);
    });
    const std::string tags = jsonList("tags", robot.tags, [](const RobotTag& tag) {
        return fmt::format("{{\"tag\": {}, \"applied\": {}, \"leftOut\": {}}}", jsonString(tag.tag), tag.applied,
                           tag.leftOut);
    });
    const std::string warnings =
        jsonList("warnings", robot.warnings, [](const std::string& text) { return jsonString(text); });
    return fmt::format("{{\n    \"name\": {},\n    \"mass\": {},\n    \"links\": {},\n{},\n{},\n{},\n{},\n{}\n  }}",
                       jsonString(robot.name), jsonNumber(robot.mass), robot.links.size(), bodies, joints, couplings,
                       tags, warnings);
}

}  // namespace ragtop::demos
