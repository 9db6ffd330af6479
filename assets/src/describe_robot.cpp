#include <fmt/format.h>

#include "ragtop/robot.h"

namespace ragtop {

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
