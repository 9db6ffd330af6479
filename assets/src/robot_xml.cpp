#include "robot_xml.h"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "ragtop/asset_error.h"
#include "robot_moments.h"
#include "robot_rules.h"
#include "robot_tags.h"

namespace ragtop {
namespace {

/// Elements whose numbers are not this reader's to check.
constexpr std::array<std::string_view, 5> kUnused{"calibration", "transmission", "gazebo", "mujoco", "sensor"};

constexpr std::array<std::string_view, 7> kJointTypes{"revolute", "continuous", "prismatic", "fixed",
                                                      "floating", "planar",     "spherical"};

class Checker {
public:
    Checker(std::string file, XmlText& text) : file_(std::move(file)), xml_(text) {}

    CheckedRobotText run() {
        TiXmlElement* robot = xml_.document.RootElement();
        result_.warnings = countTags(file_, *robot, result_.tags);
        collectNames(*robot);
        takeVisuals(*robot, "material", "robot");
        for (TiXmlElement* e = robot->FirstChildElement(); e; e = e->NextSiblingElement()) {
            const std::string name = attribute(*e, "name");
            if (e->ValueStr() == "joint") checkJoint(*e, name);
            if (e->ValueStr() == "link") takeVisuals(*e, "visual", "link '" + name + "'");
            if (e->ValueStr() == "link") takeCapsules(*e, name);
            checkNumbers(*e, e->ValueStr() + " '" + name + "'");
        }
        if (carried_.size() == links_.size())
            fail(*robot, "each of its " + std::to_string(links_.size()) +
                             " links is the child of a joint, must have one that is not: their joints form a loop");
        if (faultyVisuals_ > 0)
            result_.warnings.push_back(std::to_string(faultyVisuals_) +
                                       " visuals or materials are faulty, which changes no physics, such as in line " +
                                       firstFaulty_);
        std::ostringstream text;
        text << xml_.document;
        result_.text = text.str();
        return std::move(result_);
    }

private:
    [[noreturn]] void fail(const TiXmlElement& at, const std::string& message) const {
        throw AssetError(file_, std::to_string(at.Row()), message);
    }

    static std::string attribute(const TiXmlElement& element, const char* name) {
        const char* value = element.Attribute(name);
        return value ? value : "";
    }

    void collectNames(const TiXmlElement& robot) {
        for (const TiXmlElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
            const bool link = e->ValueStr() == "link";
            if (!link && e->ValueStr() != "joint") continue;
            const std::string name = attribute(*e, "name");
            if (name.empty()) fail(*e, e->ValueStr() + " has no name");
            if (!(link ? links_ : joints_).insert(name).second)
                fail(*e, e->ValueStr() + " '" + name + "' is there twice");
        }
        if (links_.empty()) fail(robot, "robot has no link, must have at least one");
        if (attribute(robot, "name").empty()) fail(robot, "robot has no name, must have one");
    }

    void checkJoint(TiXmlElement& joint, const std::string& name) {
        const std::string what = "joint '" + name + "': ";
        const std::string type = attribute(joint, "type");
        bool known = false;
        for (const std::string_view each : kJointTypes) known = known || type == each;
        if (!known)
            fail(joint, what + "type is '" + type +
                            "', must be revolute, continuous, prismatic, fixed, floating, planar or spherical");
        for (const char* end : {"parent", "child"}) {
            const TiXmlElement* element = joint.FirstChildElement(end);
            if (!element) fail(joint, what + "has no <" + end + ">, must have one");
            const std::string link = attribute(*element, "link");
            if (!links_.contains(link))
                fail(*element, what + end + " link '" + link + "' does not exist, must be one of the robot's links");
        }
        const std::string child = attribute(*joint.FirstChildElement("child"), "link");
        if (!carried_.insert(child).second)
            fail(joint, what + "child link '" + child + "' hangs on another joint already; loops are not supported");
        const bool limited = type == "revolute" || type == "prismatic";
        if (limited && !joint.FirstChildElement("limit")) fail(joint, what + "has no <limit>, must have one");
        // Files give joints without an axis one of zero length; those that have one use it.
        const TiXmlElement* axis = joint.FirstChildElement("axis");
        if ((limited || type == "continuous") && axis) {
            std::array<double, 3> xyz{};
            numbers(*axis, "xyz", xyz.data(), 3, "joint '" + name + "'");
            if (xyz == std::array<double, 3>{}) fail(*axis, what + "axis xyz is zero, must have a direction");
        }
        checkFollowing(joint, type, what);
        if (type != "spherical") return;
        joint.SetAttribute("type", "floating");
        result_.spherical.push_back(name);
    }

    void checkFollowing(const TiXmlElement& joint, const std::string& type, const std::string& what) const {
        const TiXmlElement* mimic = joint.FirstChildElement("mimic");
        if (!mimic || !usedBy(type, "mimic")) return;
        const std::string other = attribute(*mimic, "joint");
        if (!joints_.contains(other))
            fail(*mimic, what + "mimic joint is '" + other + "', must be one of the robot's joints");
        if (other == attribute(joint, "name")) fail(*mimic, what + "mimics itself, must mimic another joint");
    }

    /// What is wrong with looks is told, and keeps nobody from the rest.
    void takeVisuals(TiXmlElement& parent, const char* tag, const std::string& owner) {
        while (TiXmlElement* visual = parent.FirstChildElement(tag)) {
            try {
                checkVisual(*visual, owner);
            } catch (const AssetError& error) {
                if (faultyVisuals_++ == 0) firstFaulty_ = std::string(error.what()).substr(file_.size() + 1);
            }
            parent.RemoveChild(visual);
        }
    }

    void checkVisual(const TiXmlElement& visual, const std::string& owner) {
        checkNumbers(visual, owner);
        const bool isMaterial = visual.ValueStr() == "material";
        const TiXmlElement* material = isMaterial ? &visual : visual.FirstChildElement("material");
        if (material && attribute(*material, "name").empty()) fail(*material, owner + ": material has no name");
    }

    void takeCapsules(TiXmlElement& link, const std::string& name) {
        TiXmlElement* next = nullptr;
        for (TiXmlElement* e = link.FirstChildElement(); e; e = next) {
            next = e->NextSiblingElement();
            const TiXmlElement* geometry = e->FirstChildElement("geometry");
            const TiXmlElement* capsule = geometry ? geometry->FirstChildElement() : nullptr;
            if (!capsule || capsule->ValueStr() != "capsule") continue;
            const std::string owner = "link '" + name + "'";
            checkNumbers(*e, owner);
            if (e->ValueStr() == "collision") {
                ExtraCapsule extra{name};
                numbers(*capsule, "radius", &extra.radius, 1, owner);
                numbers(*capsule, "length", &extra.length, 1, owner);
                if (const TiXmlElement* origin = e->FirstChildElement("origin")) {
                    numbers(*origin, "xyz", extra.xyz, 3, owner);
                    numbers(*origin, "rpy", extra.rpy, 3, owner);
                }
                result_.capsules.push_back(extra);
            }
            link.RemoveChild(e);
        }
    }

    /// Those of an element and of all in it, in the order of the text.
    void checkNumbers(const TiXmlElement& top, const std::string& owner) {
        const TiXmlElement* element = &top;
        while (element) element = nextElement(element, top, checkOwnNumbers(*element, owner));
    }

    /// False where other rules hold inside.
    bool checkOwnNumbers(const TiXmlElement& element, const std::string& owner) {
        for (const std::string_view tag : kUnused)
            if (element.ValueStr() == tag) return false;
        for (const NumberRule& rule : kNumberRules)
            if (element.ValueStr() == rule.element) check(element, rule, owner);
        if (element.ValueStr() == "limit") checkRange(element, owner);
        if (element.ValueStr() == "inertia") checkInertia(element, owner);
        return true;
    }

    void check(const TiXmlElement& element, const NumberRule& rule, const std::string& owner) const {
        const std::string name(rule.attribute);
        if (!element.Attribute(name.c_str())) {
            if (!rule.required) return;
            fail(element, owner + ": " + std::string(rule.element) + " has no " + name);
        }
        std::array<double, 3> values{};
        numbers(element, name.c_str(), values.data(), rule.count, owner);
        for (int i = 0; i < rule.count; ++i) {
            const double value = values[static_cast<std::size_t>(i)];
            if (rule.allowed == Allowed::any || value > 0) continue;
            if (rule.allowed == Allowed::notNegative && value == 0) continue;
            fail(element, owner + ": " + std::string(rule.element) + " " + name + " is " +
                              attribute(element, name.c_str()) + ", must be " +
                              (rule.allowed == Allowed::positive ? "above 0" : "at least 0") +
                              (rule.unit.empty() ? "" : " " + std::string(rule.unit)));
        }
    }

    void checkRange(const TiXmlElement& limit, const std::string& owner) const {
        double lower = 0, upper = 0;
        if (limit.Attribute("lower")) numbers(limit, "lower", &lower, 1, owner);
        if (limit.Attribute("upper")) numbers(limit, "upper", &upper, 1, owner);
        if (lower > upper)
            fail(limit, owner + ": limit lower is " + attribute(limit, "lower") + ", must be at most upper, " +
                            (limit.Attribute("upper") ? attribute(limit, "upper") : std::string("0")));
    }

    void checkInertia(const TiXmlElement& inertia, const std::string& owner) const {
        std::array<double, 6> m{};
        for (std::size_t i = 0; const char* name : {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"})
            numbers(inertia, name, &m[i++], 1, owner);
        if (const std::string why = whyNoInertia(m); !why.empty()) fail(inertia, owner + ": inertia " + why);
    }

    /// Exactly `count` finite numbers of single precision's range.
    void numbers(const TiXmlElement& element, const char* name, double* values, int count,
                 const std::string& owner) const {
        const std::string text = attribute(element, name);
        if (text.empty() && !element.Attribute(name)) return;
        if (readNumbers(text, {values, static_cast<std::size_t>(count)}) == count) return;
        fail(element, owner + ": " + element.ValueStr() + " " + name + " is '" + text + "', must be " +
                          (count == 1 ? "a number" : std::to_string(count) + " numbers"));
    }

    std::string file_;
    XmlText& xml_;
    CheckedRobotText result_;
    std::set<std::string> links_, joints_, carried_;
    int faultyVisuals_ = 0;
    std::string firstFaulty_;  ///< line and what is wrong
};

}  // namespace

CheckedRobotText checkRobotText(const std::string& file, XmlText& text) { return Checker(file, text).run(); }

}  // namespace ragtop
