#include "robot_tags.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

#include "ragtop/asset_error.h"
#include "robot_rules.h"

namespace ragtop {
namespace {

/// Where each element belongs that becomes part of the robot; those anywhere else, and what is in them, do not.
struct Place {
    std::string_view parent, element;
    bool many = false;  ///< otherwise the first one counts
};
constexpr std::array kPlaces{
    Place{"robot", "link", true},     Place{"robot", "joint", true},
    Place{"link", "inertial"},        Place{"inertial", "origin"},
    Place{"inertial", "mass"},        Place{"inertial", "inertia"},
    Place{"link", "collision", true}, Place{"collision", "origin"},
    Place{"collision", "geometry"},   Place{"geometry", "box"},
    Place{"geometry", "sphere"},      Place{"geometry", "cylinder"},
    Place{"geometry", "capsule"},     Place{"geometry", "mesh"},
    Place{"joint", "parent"},         Place{"joint", "child"},
    Place{"joint", "origin"},         Place{"joint", "axis"},
    Place{"joint", "limit"},          Place{"joint", "dynamics"},
    Place{"joint", "mimic"},          Place{"joint", "safety_controller"},
};

/// Attributes that are read, beside those of numbers.
struct TextRule {
    std::string_view element, attribute;
};
constexpr std::array kTexts{
    TextRule{"robot", "name"},  TextRule{"robot", "version"},  TextRule{"link", "name"},   TextRule{"joint", "name"},
    TextRule{"joint", "type"},  TextRule{"collision", "name"}, TextRule{"parent", "link"}, TextRule{"child", "link"},
    TextRule{"mimic", "joint"}, TextRule{"mesh", "filename"},
};

/// What each kind of joint makes use of.
bool usedBy(std::string_view type, std::string_view element) {
    const bool slides = type == "revolute" || type == "prismatic";
    const bool turns = type == "continuous";
    if (element == "axis") return slides || turns || type == "planar";
    if (element == "dynamics") return slides || turns || type == "spherical";
    if (element == "limit" || element == "mimic") return slides || turns;
    if (element == "safety_controller") return slides;
    return true;
}

std::string attributeOf(const TiXmlElement& element, const char* name) {
    const char* value = element.Attribute(name);
    return value ? value : "";
}

bool isFirst(const TiXmlElement& element) {
    const TiXmlElement& parent = *element.Parent()->ToElement();
    return &element ==
           (parent.ValueStr() == "geometry" ? parent.FirstChildElement() : parent.FirstChildElement(element.Value()));
}

class TagCounter {
public:
    TagCounter(const std::string& file, const TiXmlElement& robot) : file_(file), robot_(robot), applied_{&robot} {}

    std::vector<std::string> run(std::vector<ImportedRobotTag>& tags) {
        countAttributes(robot_);
        for (const TiXmlElement* e = nextElement(&robot_, robot_); e; e = nextElement(e, robot_)) count(*e);
        for (const auto& [tag, count] : tags_) tags.push_back(count);
        std::vector<std::string> warnings;
        for (const auto& [what, count] : strange_) warnings.push_back(std::to_string(count) + " " + what);
        return warnings;
    }

private:
    void count(const TiXmlElement& element) {
        const std::string& tag = element.ValueStr();
        if (tag.starts_with("xacro:"))
            throw AssetError(
                file_, std::to_string(element.Row()),
                "has <" + tag + ">, which is for xacro: expand it first, as with 'xacro in.xacro > out.urdf'");
        const TiXmlElement& parent = *element.Parent()->ToElement();
        const auto place = std::find_if(kPlaces.begin(), kPlaces.end(), [&](const Place& each) {
            return parent.ValueStr() == each.parent && tag == each.element;
        });
        const std::string type = attributeOf(parent, "type");
        const bool inApplied = applied_.contains(&parent), belongs = place != kPlaces.end();
        const bool isUsed = belongs && (parent.ValueStr() != "joint" || usedBy(type, tag));
        const bool isMore = isUsed && !place->many && !isFirst(element);
        const bool applied = inApplied && isUsed && !isMore;
        ImportedRobotTag& counted = tags_[tag];
        counted.tag = tag;
        ++(applied ? counted.applied : counted.leftOut);
        if (applied) {
            applied_.insert(&element);
            countAttributes(element);
        } else if (inApplied && tag != "visual" && tag != "material") {
            ++strange_[isMore    ? "<" + tag + "> in <" + parent.ValueStr() + "> left out: another one comes before it"
                       : belongs ? "<" + tag + "> of " + type + " joints left out: it has no meaning there"
                                 : "<" + tag + "> in <" + parent.ValueStr() + "> left out: not supported"];
        }
    }

    void countAttributes(const TiXmlElement& element) {
        const std::string& tag = element.ValueStr();
        for (const TiXmlAttribute* a = element.FirstAttribute(); a; a = a->Next()) {
            const std::string_view name = a->NameTStr();
            const auto reads = [&](const auto& rule) { return rule.element == tag && rule.attribute == name; };
            if (std::any_of(kNumberRules.begin(), kNumberRules.end(), reads)) {
                if (isEndOfEndless(element, *a)) ++strange_["ends of continuous joints left out: these have none"];
            } else if (std::none_of(kTexts.begin(), kTexts.end(), reads) && !name.starts_with("xmlns")) {
                ++strange_["attribute '" + std::string(name) + "' of <" + tag + "> left out: not supported"];
            }
        }
    }

    static bool isEndOfEndless(const TiXmlElement& element, const TiXmlAttribute& attribute) {
        const std::string& name = attribute.NameTStr();
        double value = 0;
        return element.ValueStr() == "limit" && (name == "lower" || name == "upper") &&
               attributeOf(*element.Parent()->ToElement(), "type") == "continuous" &&
               readNumbers(attribute.ValueStr(), {&value, 1}) == 1 && value != 0;
    }

    const std::string& file_;
    const TiXmlElement& robot_;
    std::set<const TiXmlElement*> applied_;
    std::map<std::string, ImportedRobotTag> tags_;
    std::map<std::string, int> strange_;
};

}  // namespace

std::vector<std::string> countTags(const std::string& file, const TiXmlElement& robot,
                                   std::vector<ImportedRobotTag>& tags) {
    return TagCounter(file, robot).run(tags);
}

}  // namespace ragtop
