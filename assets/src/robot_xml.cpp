#include "robot_xml.h"

#include <tinyxml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "file_kind.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

enum class Allowed { any, notNegative, positive };

/// A number, or several separated by blanks, in an attribute.
struct NumberRule {
    std::string_view element, attribute, unit;
    int count;
    Allowed allowed;
    bool required;
};

constexpr std::array kRules{
    NumberRule{"mass", "value", "kg", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "ixx", "kg m2", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "iyy", "kg m2", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "izz", "kg m2", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "ixy", "kg m2", 1, Allowed::any, true},
    NumberRule{"inertia", "ixz", "kg m2", 1, Allowed::any, true},
    NumberRule{"inertia", "iyz", "kg m2", 1, Allowed::any, true},
    NumberRule{"origin", "xyz", "m", 3, Allowed::any, false},
    NumberRule{"origin", "rpy", "rad", 3, Allowed::any, false},
    NumberRule{"box", "size", "m", 3, Allowed::positive, true},
    NumberRule{"sphere", "radius", "m", 1, Allowed::positive, true},
    NumberRule{"cylinder", "radius", "m", 1, Allowed::positive, true},
    NumberRule{"cylinder", "length", "m", 1, Allowed::positive, true},
    NumberRule{"capsule", "radius", "m", 1, Allowed::positive, true},
    NumberRule{"capsule", "length", "m", 1, Allowed::notNegative, true},
    NumberRule{"mesh", "scale", "", 3, Allowed::any, false},
    NumberRule{"axis", "xyz", "", 3, Allowed::any, true},
    NumberRule{"limit", "lower", "rad or m", 1, Allowed::any, false},
    NumberRule{"limit", "upper", "rad or m", 1, Allowed::any, false},
    NumberRule{"limit", "effort", "N m or N", 1, Allowed::notNegative, true},
    NumberRule{"limit", "velocity", "rad/s or m/s", 1, Allowed::notNegative, true},
    NumberRule{"dynamics", "damping", "N m s/rad or N s/m", 1, Allowed::notNegative, false},
    NumberRule{"dynamics", "friction", "N m or N", 1, Allowed::notNegative, false},
    NumberRule{"mimic", "multiplier", "", 1, Allowed::any, false},
    NumberRule{"mimic", "offset", "rad or m", 1, Allowed::any, false},
};

/// Elements that nothing here uses.
constexpr std::array<std::string_view, 7> kUnused{
    "mimic", "safety_controller", "calibration", "transmission", "gazebo", "mujoco", "sensor"};

constexpr std::array<std::string_view, 7> kJointTypes{"revolute", "continuous", "prismatic", "fixed",
                                                      "floating", "planar",     "spherical"};

constexpr int kMaxDepth = 64;

/// The line on which elements nest too deep for parsers that call themselves for each level; 0: nowhere.
int lineTooDeep(std::string_view text) {
    int depth = 0;
    const auto after = [&](std::string_view end, std::size_t from) {
        const std::size_t found = text.find(end, from);
        return found == std::string_view::npos ? text.size() : found + end.size();
    };
    for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
        const std::string_view rest = text.substr(at);
        if (rest.starts_with("<!--")) {
            at = after("-->", at + 4);
        } else if (rest.starts_with("<![CDATA[")) {
            at = after("]]>", at);
        } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
            at = after(">", at);
        } else if (rest.starts_with("</")) {
            --depth;
            at = after(">", at);
        } else {
            const std::size_t begin = at;
            // Quotes may hold brackets.
            for (++at; at < text.size() && text[at] != '>'; ++at) {
                if (text[at] == '"' || text[at] == '\'') at = after(text.substr(at, 1), at + 1) - 1;
            }
            if (at < text.size() && text[at - 1] != '/' && ++depth > kMaxDepth)
                return 1 + static_cast<int>(
                               std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
        }
    }
    return 0;
}

class Checker {
public:
    explicit Checker(const std::filesystem::path& path) : file_(path.string()) {
        std::ifstream stream(path, std::ios::binary);
        if (!stream || std::filesystem::is_directory(path)) throw AssetError(file_, "", "no such file");
        source_.assign(std::istreambuf_iterator<char>(stream), {});
    }

    CheckedRobotText run() {
        if (const int line = lineTooDeep(source_); line > 0)
            throw AssetError(file_, std::to_string(line),
                             "nests elements deeper than " + std::to_string(kMaxDepth) + " levels, the most allowed");
        document_.Parse(source_.c_str(), nullptr, TIXML_ENCODING_UTF8);
        if (document_.Error()) {
            const std::string place = document_.ErrorRow() > 0 ? std::to_string(document_.ErrorRow()) + ":" +
                                                                     std::to_string(document_.ErrorCol())
                                                               : std::string();
            throw AssetError(file_, place, std::string("is no XML: ") + document_.ErrorDesc());
        }
        TiXmlElement* robot = document_.RootElement();
        if (!robot || robot->ValueStr() != "robot") {
            const std::string begins = robot ? "begins with <" + robot->ValueStr() + ">" : "has no element";
            throw AssetError(file_, robot ? std::to_string(robot->Row()) : "",
                             begins + ", must with <robot>: robots are read from URDF" + looksLike(source_));
        }
        collectNames(*robot);
        takeVisuals(*robot, "material", "robot");
        for (TiXmlElement* e = robot->FirstChildElement(); e; e = e->NextSiblingElement()) {
            const std::string name = attribute(*e, "name");
            if (e->ValueStr() == "joint") checkJoint(*e, name);
            if (e->ValueStr() == "link") takeVisuals(*e, "visual", "link '" + name + "'");
            if (e->ValueStr() == "link") takeCapsules(*e, name);
            checkNumbers(*e, e->ValueStr() + " '" + name + "'");
        }
        for (const auto& [tag, count] : unused_)
            result_.warnings.push_back(std::to_string(count) + " <" + tag + "> left out: not supported");
        if (faultyVisuals_ > 0)
            result_.warnings.push_back(std::to_string(faultyVisuals_) +
                                       " visuals or materials are faulty, which changes no physics, such as in line " +
                                       firstFaulty_);
        std::ostringstream text;
        text << document_;
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
        std::set<std::string> joints;
        for (const TiXmlElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
            const bool link = e->ValueStr() == "link";
            if (!link && e->ValueStr() != "joint") continue;
            const std::string name = attribute(*e, "name");
            if (name.empty()) fail(*e, e->ValueStr() + " has no name");
            if (!(link ? links_ : joints).insert(name).second)
                fail(*e, e->ValueStr() + " '" + name + "' is there twice");
        }
        if (links_.empty()) fail(robot, "robot has no link, must have at least one");
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
            if (!element) fail(joint, what + "has no <" + end + ">");
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
        if (type != "spherical") return;
        joint.SetAttribute("type", "floating");
        result_.spherical.push_back(name);
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
            const TiXmlElement* capsule = geometry ? geometry->FirstChildElement("capsule") : nullptr;
            if (!capsule) continue;
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
        while (element) {
            const TiXmlElement* inner = checkOwnNumbers(*element, owner) ? element->FirstChildElement() : nullptr;
            while (!inner && element != &top) {
                inner = element->NextSiblingElement();
                if (!inner) element = element->Parent()->ToElement();
            }
            element = inner;
        }
    }

    /// False where other rules hold inside.
    bool checkOwnNumbers(const TiXmlElement& element, const std::string& owner) {
        for (const std::string_view tag : kUnused)
            if (element.ValueStr() == tag) {
                ++unused_[std::string(tag)];
                if (tag != "mimic") return false;
            }
        for (const NumberRule& rule : kRules)
            if (element.ValueStr() == rule.element) check(element, rule, owner);
        if (element.ValueStr() == "limit") checkRange(element, owner);
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

    /// Exactly `count` finite numbers of single precision's range.
    void numbers(const TiXmlElement& element, const char* name, double* values, int count,
                 const std::string& owner) const {
        const std::string text = attribute(element, name);
        if (text.empty() && !element.Attribute(name)) return;
        const char* at = text.data();
        const char* end = at + text.size();
        const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
        int found = 0;
        bool sound = true;
        while (sound) {
            while (at != end && blank(*at)) ++at;
            if (at == end) break;
            if (*at == '+') ++at;
            double value = 0;
            const auto [after, error] = std::from_chars(at, end, value);
            sound = error == std::errc() && (after == end || blank(*after)) && std::isfinite(value) &&
                    std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()) && found < count;
            if (sound) values[found++] = value;
            at = after;
        }
        if (sound && found == count) return;
        fail(element, owner + ": " + element.ValueStr() + " " + name + " is '" + text + "', must be " +
                          (count == 1 ? "a number" : std::to_string(count) + " numbers"));
    }

    std::string file_, source_;
    TiXmlDocument document_;
    CheckedRobotText result_;
    std::set<std::string> links_, carried_;
    std::map<std::string, int> unused_;
    int faultyVisuals_ = 0;
    std::string firstFaulty_;  ///< line and what is wrong
};

}  // namespace

CheckedRobotText checkRobotText(const std::filesystem::path& path) { return Checker(path).run(); }

}  // namespace ragtop
