#include "mjcf_links.h"

#include <array>
#include <utility>

#include "robot_moments.h"
#include "single.h"

namespace ragtop {
namespace {

/// kg m² as links have it, of a body's matrix.
void setMass(ImportedRobotLink& link, const MassProperties& mass) {
    const Mat3& i = mass.inertia;
    const auto whole = [](float value) { return static_cast<double>(value); };
    link.heavy = true;
    link.mass = whole(mass.mass);
    link.inertia = {whole(i.cx.x), whole(i.cy.y), whole(i.cz.z), whole(i.cx.y), whole(i.cx.z), whole(i.cy.z)};
    link.centerOfMass = {mass.center, {}};
}

class LinkReader {
public:
    LinkReader(MjcfText& text, const MjcfCompiler& compiler, MjcfTree& tree, ImportedRobot& robot)
        : text_(text), compiler_(compiler), tree_(tree), robot_(robot) {}

    void run() {
        ImportedRobotLink world;
        world.name = "world";
        robot_.links.push_back(world);
        robot_.grounded = true;
        tree_.bodies["world"] = 0;
        for (const TiXmlElement* element : text_.children(text_.root())) {
            if (element->ValueStr() != "worldbody") continue;
            text_.use(*element);
            readGeoms(*element, 0, {});
            push(*element, 0, {});
            while (!waiting_.empty()) {
                const Waiting next = waiting_.back();
                waiting_.pop_back();
                readBody(next);
            }
        }
    }

private:
    struct Waiting {
        const TiXmlElement* element;
        int parent;
        std::string childClass;
    };

    /// The first child is to come next.
    void push(const TiXmlElement& parent, int link, const std::string& childClass) {
        const auto& children = text_.children(parent);
        for (auto child = children.rbegin(); child != children.rend(); ++child)
            if ((*child)->ValueStr() == "body") waiting_.push_back({*child, link, childClass});
    }

    void readBody(const Waiting& at) {
        const MjcfElement body = text_.use(*at.element);
        const std::string childClass = body.text("childclass", at.childClass);
        const std::string name = body.text("name", "body " + std::to_string(robot_.links.size()));
        std::vector<MjcfElement> joints;
        for (const TiXmlElement* child : text_.children(*at.element))
            if (child->ValueStr() == "joint" || child->ValueStr() == "freejoint")
                joints.push_back(text_.use(*child, childClass));
        // Each joint but the last leads to a link between, which weighs next to nothing.
        int parent = at.parent;
        Frame origin = placeOf(body, compiler_);
        const std::size_t count = std::max<std::size_t>(joints.size(), 1);
        for (std::size_t i = 0; i < count; ++i) {
            ImportedRobotLink link;
            link.between = i + 1 < count;
            link.name = link.between ? name + " before " + joints[i].name() : name;
            link.parent = parent;
            link.joint.name = name;
            link.joint.origin = origin;
            if (!joints.empty()) readJoint(joints[i], joints.size(), link);
            parent = static_cast<int>(robot_.links.size());
            robot_.links.push_back(std::move(link));
            origin = {};
        }
        if (!tree_.bodies.emplace(name, parent).second) body.fail("is there twice");
        readGeoms(*at.element, parent, childClass);
        push(*at.element, parent, childClass);
    }

    void readJoint(const MjcfElement& element, std::size_t siblings, ImportedRobotLink& link) {
        ImportedRobotJoint& joint = link.joint;
        const std::string type = element.tag() == "freejoint" ? "free" : element.text("type", "hinge");
        static const std::map<std::string, RobotJointKind> kinds{{"free", RobotJointKind::free},
                                                                 {"ball", RobotJointKind::ball},
                                                                 {"hinge", RobotJointKind::hinge},
                                                                 {"slide", RobotJointKind::slider}};
        const auto kind = kinds.find(type);
        if (kind == kinds.end()) element.failAt("type", "free, ball, hinge or slide");
        joint.kind = kind->second;
        const bool isFree = joint.kind == RobotJointKind::free, isBall = joint.kind == RobotJointKind::ball;
        if (isFree && (siblings > 1 || link.parent != 0))
            element.fail("is free, must be the only joint of a body of the world");
        MjcfJoint entry{static_cast<int>(robot_.links.size()), 0,
                        isFree   ? 7
                        : isBall ? 4
                                 : 1,
                        joint.kind != RobotJointKind::slider};
        joint.name = element.xml().Attribute("name") ? element.text("name") : link.name;
        if (!isFree) readMotion(element, joint, entry);
        const std::string* named = element.xml().Attribute(std::string("name"));
        if (named && !tree_.byName.emplace(*named, tree_.joints.size()).second) element.fail("is there twice");
        tree_.joints.push_back(entry);
    }

    void readMotion(const MjcfElement& element, ImportedRobotJoint& joint, MjcfJoint& entry) {
        const auto inUnit = [&](double value) { return entry.isTurn ? compiler_.radians(value) : value; };
        joint.anchor = pointOf(element, "pos");
        joint.axis = directionOf(element, "axis", {0, 0, 1});
        entry.reference = inUnit(element.number("ref", 0));
        joint.damping = notNegative(element, "damping");
        joint.friction = notNegative(element, "frictionloss");
        joint.stiffness = notNegative(element, "stiffness");
        joint.springTarget = single(inUnit(element.number("springref", 0)) - entry.reference);
        if (notNegative(element, "armature") > 0) ++tree_.armatures;
        std::array<double, 2> range{};
        const bool ranged = element.numbers("range", range, 2) > 0;
        if (!element.truth("limited").value_or(ranged)) return;
        if (!ranged) element.fail("is limited, must have a range");
        if (range[0] > range[1]) element.failAt("range", "two numbers that rise");
        joint.limited = true;
        joint.lower = single(inUnit(range[0]) - entry.reference);
        joint.upper = single(inUnit(range[1]) - entry.reference);
    }

    static float notNegative(const MjcfElement& element, const char* attribute) {
        const double value = element.number(attribute, 0);
        if (value < 0) element.failAt(attribute, "at least 0");
        return single(value);
    }

    void readGeoms(const TiXmlElement& body, int link, const std::string& childClass) {
        std::vector<MassProperties> masses;
        std::optional<MassProperties> given;
        for (const TiXmlElement* child : text_.children(body)) {
            if (child->ValueStr() == "inertial") given = readInertial(text_.use(*child));
            if (child->ValueStr() != "geom") continue;
            const MjcfElement element = text_.use(*child, childClass);
            MjcfGeom geom = readGeom(element, compiler_);
            if (geom.mass) masses.push_back(*geom.mass);
            if (geom.isMesh) ++meshes_[link];
            if (geom.shape && geom.isMesh) {
                const auto file = tree_.meshFiles.find(geom.shape->mesh);
                if (file == tree_.meshFiles.end()) element.failAt("mesh", "the name of a mesh of <asset>");
                geom.shape->mesh = file->second;
            }
            if (geom.shape) robot_.links[static_cast<std::size_t>(link)].shapes.push_back(std::move(*geom.shape));
        }
        if (link == 0) return;
        const bool fromShapes = !given || compiler_.massFromShapes;
        if (fromShapes && meshes_[link] > 0) tree_.meshesWithoutMass += meshes_[link];
        if (!fromShapes)
            setMass(robot_.links[static_cast<std::size_t>(link)], *given);
        else if (!masses.empty())
            setMass(robot_.links[static_cast<std::size_t>(link)], combined(masses));
    }

    MassProperties readInertial(const MjcfElement& element) const {
        const double mass = element.number("mass", -1);
        if (!(mass >= 0)) element.failAt("mass", "at least 0 kg");
        std::array<double, 6> m{};
        if (element.numbers("fullinertia", m, 6) == 0) element.numbers("diaginertia", {m.data(), 3}, 3);
        for (int i = 0; i < 3; ++i)
            if (m[static_cast<std::size_t>(i)] < 0) element.fail("moments are below 0, must be at least 0 kg m²");
        if (const std::string why = whyNoInertia(m); !why.empty()) element.fail(why);
        const MassProperties own{single(mass),
                                 {},
                                 {{single(m[0]), single(m[3]), single(m[4])},
                                  {single(m[3]), single(m[1]), single(m[5])},
                                  {single(m[4]), single(m[5]), single(m[2])}}};
        return transformed(own, placeOf(element, compiler_));
    }

    MjcfText& text_;
    const MjcfCompiler& compiler_;
    MjcfTree& tree_;
    ImportedRobot& robot_;
    std::vector<Waiting> waiting_;
    std::map<int, int> meshes_;
};

}  // namespace

void readBodies(MjcfText& text, const MjcfCompiler& compiler, MjcfTree& tree, ImportedRobot& robot) {
    LinkReader(text, compiler, tree, robot).run();
}

}  // namespace ragtop
