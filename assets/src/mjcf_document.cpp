#include "mjcf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "import_text.h"
#include "mjcf_links.h"
#include "ragtop/asset_error.h"
#include "single.h"

namespace ragtop {
namespace {

/// N m or N of an actuator without a bound.
constexpr double kUnlimited = 1e9;

/// Elements that change no physics.
const std::set<std::string> kLooks{"camera", "light", "site", "visual", "statistic", "texture", "material", "size"};

const std::set<std::string> kLooksOfGeoms{"rgba", "material", "group"};

class DocumentReader {
public:
    DocumentReader(const std::filesystem::path& path, const TiXmlElement& root) : text_(path, root) {}

    ImportedRobot run() {
        const std::string* model = text_.root().Attribute(std::string("model"));
        robot_.name = model ? *model : "";
        eachIn("compiler", [&](const MjcfElement& element) { readCompiler(element, compiler_); });
        eachBelow("asset", "mesh", [&](const MjcfElement& mesh) { readMesh(mesh); });
        readBodies(text_, compiler_, tree_, robot_);
        eachBelow("contact", "exclude", [&](const MjcfElement& pair) {
            for (const char* end : {"body1", "body2"}) linkOf(pair, end);
        });
        for (const char* kind : {"connect", "weld", "joint"})
            eachBelow("equality", kind, [&](const MjcfElement& equal) { readEquality(equal); });
        eachBelow("tendon", "fixed", [&](const MjcfElement& tendon) { readTendon(tendon); });
        for (const char* kind : {"motor", "position", "velocity", "general"})
            eachBelow("actuator", kind, [&](const MjcfElement& actuator) { readActuator(actuator); });
        eachBelow("keyframe", "key", [&](const MjcfElement& key) { readKey(key); });
        count();
        if (robot_.links.size() == 1 && robot_.links[0].shapes.empty())
            text_.use(text_.root()).fail("has neither a body nor a geom, must have one");
        return std::move(robot_);
    }

private:
    void warn(std::string text) { robot_.warnings.push_back(std::move(text)); }

    template <class Each>
    void eachIn(const char* tag, Each each) {
        for (const TiXmlElement* element : text_.children(text_.root()))
            if (element->ValueStr() == tag) each(text_.use(*element));
    }
    template <class Each>
    void eachBelow(const char* section, const char* tag, Each each) {
        eachIn(section, [&](const MjcfElement& parent) {
            for (const TiXmlElement* element : text_.children(parent.xml()))
                if (element->ValueStr() == tag) each(text_.use(*element));
        });
    }

    void readMesh(const MjcfElement& mesh) {
        const std::string file = mesh.text("file");
        if (file.empty()) mesh.fail("has no file, must have one");
        const std::string stem = std::filesystem::path(file).stem().string();
        tree_.meshFiles[mesh.text("name", stem)] = (std::filesystem::path(compiler_.meshFolder) / file).string();
        std::array<double, 3> scale{1, 1, 1};
        mesh.numbers("scale", scale, 3);
        if (scale != std::array<double, 3>{1, 1, 1}) warn("scale of " + mesh.name() + " is left out: not supported");
    }

    int linkOf(const MjcfElement& element, const char* attribute) const {
        const auto found = tree_.bodies.find(element.text(attribute));
        if (found == tree_.bodies.end()) element.failAt(attribute, "the name of a body");
        return found->second;
    }
    const MjcfJoint& jointOf(const MjcfElement& element, const char* attribute) const {
        const auto found = tree_.byName.find(element.text(attribute));
        if (found == tree_.byName.end()) element.failAt(attribute, "the name of a joint");
        const MjcfJoint& joint = tree_.joints[found->second];
        if (joint.positions != 1) element.failAt(attribute, "a hinge or slide");
        return joint;
    }
    ImportedRobotJoint& importedOf(const MjcfJoint& joint) {
        return robot_.links[static_cast<std::size_t>(joint.link)].joint;
    }

    void readEquality(const MjcfElement& equal) {
        if (!equal.truth("active").value_or(true)) return warn(equal.name() + " is not active: left out");
        if (equal.tag() == "joint") return readFollower(equal);
        const int a = linkOf(equal, "body1"), b = equal.find("body2") ? linkOf(equal, "body2") : 0;
        if (a == b) equal.failAt("body2", "another body than body1");
        if (equal.tag() == "weld" && equal.find("relpose"))
            warn("relpose of " + equal.name() + " is left out: bodies are welded as they stand");
        robot_.loops.push_back(
            {equal.text("name", equal.tag()), equal.tag() == "weld", a, b, pointOf(equal, "anchor")});
    }

    /// y − y₀ = a₀ + a₁ (x − x₀) + …, about the places where the bodies stand as they are written.
    void readFollower(const MjcfElement& equal) {
        std::array<double, 5> a{0, 1, 0, 0, 0};
        equal.numbers("polycoef", a, 1);
        const MjcfJoint& follower = jointOf(equal, "joint1");
        if (!equal.find("joint2")) {
            ImportedRobotSum lock{equal.name(), {}, true, single(a[0]), single(a[0])};
            lock.parts.push_back({follower.link, 1});
            robot_.sums.push_back(lock);
            return;
        }
        if (a[2] != 0 || a[3] != 0 || a[4] != 0)
            warn(equal.name() + " bends: the terms beyond the second of its polycoef are left out");
        ImportedRobotJoint& joint = importedOf(follower);
        const ImportedRobotJoint& leader = importedOf(jointOf(equal, "joint2"));
        if (joint.name == leader.name) equal.failAt("joint2", "another joint than joint1");
        if (!joint.follows.empty()) equal.failAt("joint1", "a joint that follows no other yet");
        joint.follows = leader.name;
        joint.multiplier = single(a[1]);
        joint.offset = single(a[0]);
    }

    /// The length of a fixed tendon is the sum of coordinates, as the file counts them, times their factors.
    void readTendon(const MjcfElement& tendon) {
        ImportedRobotSum sum;
        sum.name = tendon.name();
        double atRest = 0;
        for (const TiXmlElement* child : text_.children(tendon.xml())) {
            if (child->ValueStr() != "joint") continue;
            const MjcfElement part = text_.use(*child);
            const MjcfJoint& joint = jointOf(part, "joint");
            const double factor = part.number("coef", 0);
            if (factor == 0) part.failAt("coef", "a number other than 0");
            atRest += factor * joint.reference;
            sum.parts.push_back({joint.link, single(factor)});
        }
        if (sum.parts.empty() || sum.parts.size() > 4)
            tendon.fail("has " + std::to_string(sum.parts.size()) + " joints, must have 1 to 4");
        std::array<double, 2> range{}, length{-1, -1};
        const bool ranged = tendon.numbers("range", range, 2) > 0;
        sum.limited = tendon.truth("limited").value_or(ranged) && ranged;
        if (range[0] > range[1]) tendon.failAt("range", "two numbers that rise");
        sum.lower = single(range[0] - atRest);
        sum.upper = single(range[1] - atRest);
        sum.stiffness = single(tendon.number("stiffness", 0));
        sum.damping = single(tendon.number("damping", 0));
        sum.friction = single(tendon.number("frictionloss", 0));
        if (std::min({sum.stiffness, sum.damping, sum.friction}) < 0)
            tendon.fail("stiffness, damping and frictionloss must be at least 0");
        // A spring length below 0 is the length where the bodies stand as they are written.
        if (tendon.numbers("springlength", length, 1) > 0 && length[0] >= 0) sum.rest = single(length[0] - atRest);
        robot_.sums.push_back(std::move(sum));
    }

    /// What it can give: its force within forcerange, that of a motor its control, times the gear.
    void readActuator(const MjcfElement& actuator) {
        if (!actuator.find("joint")) return warn(actuator.name() + " acts on no joint: left out");
        const MjcfJoint& entry = jointOf(actuator, "joint");
        std::array<double, 6> gear{1};
        actuator.numbers("gear", gear, 1);
        const auto largest = [&](const char* range, const char* limited) {
            std::array<double, 2> v{};
            if (actuator.numbers(range, v, 2) == 0 || !actuator.truth(limited).value_or(true)) return kUnlimited;
            return std::max(std::abs(v[0]), std::abs(v[1]));
        };
        double force = largest("forcerange", "forcelimited");
        std::array<double, 10> gain{1};
        actuator.numbers("gainprm", gain, 1);
        const bool direct = actuator.tag() == "motor" || actuator.tag() == "general";
        if (direct) force = std::min(force, std::abs(gain[0]) * largest("ctrlrange", "ctrllimited"));
        ImportedRobotJoint& joint = importedOf(entry);
        joint.rated = true;
        joint.effort = single(std::min(kUnlimited, static_cast<double>(joint.effort) + std::abs(gear[0]) * force));
    }

    void readKey(const MjcfElement& key) {
        int wanted = 0;
        for (const MjcfJoint& joint : tree_.joints) wanted += joint.positions;
        std::vector<double> positions(static_cast<std::size_t>(wanted));
        if (!key.find("qpos") || wanted == 0) return;
        if (key.numbers("qpos", positions, wanted) != wanted)
            key.fail("qpos must be " + std::to_string(wanted) + " numbers, as many as the joints have");
        ImportedRobotKey pose{key.text("name", "key " + std::to_string(robot_.keys.size())), {}};
        pose.coordinates.assign(robot_.links.size(), 0.0f);
        std::size_t at = 0;
        for (const MjcfJoint& joint : tree_.joints) {
            if (joint.positions == 1)
                pose.coordinates[static_cast<std::size_t>(joint.link)] = single(positions[at] - joint.reference);
            at += static_cast<std::size_t>(joint.positions);
        }
        robot_.keys.push_back(std::move(pose));
    }

    void count() {
        std::map<std::string, ImportedRobotTag> tags;
        std::map<std::string, int> strange;
        for (const MjcfText::Use& use : text_.uses()) {
            ImportedRobotTag& tag = tags[use.tag];
            tag.tag = use.tag;
            ++(use.used ? tag.applied : tag.leftOut);
            if (!use.used && use.parentUsed && !kLooks.contains(use.tag))
                ++strange["<" + use.tag + "> in <" + use.parent + "> left out: not supported"];
        }
        for (const auto& [name, tag] : tags) robot_.tags.push_back(tag);
        std::string left;
        for (const auto& [what, times] : text_.attributesLeftOut())
            if (!kLooksOfGeoms.contains(what.second))
                left +=
                    (left.empty() ? "" : ", ") + std::to_string(times) + " " + what.second + " of <" + what.first + ">";
        if (!left.empty()) warn("attributes left out: " + left);
        for (const auto& [what, times] : strange) warn(std::to_string(times) + " " + what);
        if (tree_.armatures > 0)
            warn("armature of " + std::to_string(tree_.armatures) + " joints left out: not supported");
        if (tree_.meshesWithoutMass > 0)
            warn(std::to_string(tree_.meshesWithoutMass) +
                 " meshes of bodies without <inertial> add no mass: not supported");
    }

    MjcfText text_;
    MjcfCompiler compiler_;
    MjcfTree tree_;
    ImportedRobot robot_;
};

}  // namespace

ImportedRobot readMjcf(const std::filesystem::path& path, const TiXmlElement& root) {
    return DocumentReader(path, root).run();
}

}  // namespace ragtop
