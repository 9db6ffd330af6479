#include <Eigen/Geometry>
#include <map>
#include <sstream>

#include "import_support.h"
#include "ragtop/robot.h"

// Masses, centres and moments of robots beside those of their URDF, added up here link by link.
namespace ragtop {
namespace {

struct Place {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Place operator*(const Place& inner) const { return {turn * inner.turn, turn * inner.at + at}; }
};

struct Weight {
    double mass = 0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre
};

/// A link with the link that carries it and where it is in that.
struct WrittenLink {
    Weight weight;
    std::string carrier;  ///< empty: the root
    Place inCarrier;
    bool fixed = false;
};

/// What stands between two texts, the first of each; empty where either is missing.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    std::size_t from = text.find(begin);
    if (from == std::string::npos) return {};
    from += begin.size();
    const std::size_t to = text.find(end, from);
    return to == std::string::npos ? std::string() : text.substr(from, to - from);
}

std::string attribute(const std::string& element, const std::string& name) {
    return between(element, name + "=\"", "\"");
}

Eigen::Vector3d vectorOf(const std::string& numbers) {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    std::istringstream stream(numbers);
    stream >> v.x() >> v.y() >> v.z();
    return v;
}

/// URDF turns about the fixed axes x, y and z in that order.
Place originOf(const std::string& element) {
    const std::string origin = between(element, "<origin", ">");
    const Eigen::Vector3d angles = vectorOf(attribute(origin, "rpy"));
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
    return {turn, vectorOf(attribute(origin, "xyz"))};
}

Weight weightOf(const std::string& link) {
    const std::string inertial = between(link, "<inertial>", "</inertial>");
    if (inertial.empty()) return {};
    const std::string moments = between(inertial, "<inertia", ">");
    const auto moment = [&](const char* name) { return std::stod(attribute(moments, name)); };
    const double xy = moment("ixy"), xz = moment("ixz"), yz = moment("iyz");
    Eigen::Matrix3d own;
    own << moment("ixx"), xy, xz, xy, moment("iyy"), yz, xz, yz, moment("izz");
    const Place place = originOf(inertial);
    return {std::stod(attribute(between(inertial, "<mass", ">"), "value")), place.at,
            place.turn * own * place.turn.transpose()};
}

std::map<std::string, WrittenLink> linksOf(const std::filesystem::path& file) {
    std::stringstream stream;
    stream << std::ifstream(file).rdbuf();
    std::string text = stream.str();
    for (std::size_t at = text.find("<!--"); at != std::string::npos; at = text.find("<!--"))
        text.erase(at, text.find("-->", at) + 3 - at);
    std::map<std::string, WrittenLink> links;
    const auto each = [&](const std::string& kind, auto&& read) {
        for (std::size_t at = text.find("<" + kind); at != std::string::npos; at = text.find("<" + kind, at + 1)) {
            if (text[at + kind.size() + 1] > ' ') continue;
            const std::size_t head = text.find('>', at);
            const std::size_t end = text[head - 1] == '/' ? head : text.find("</" + kind + ">", at);
            const std::string element = text.substr(at, end - at);
            read(attribute(element.substr(0, head - at), "name"), element);
        }
    };
    each("link", [&](const std::string& name, const std::string& link) { links[name].weight = weightOf(link); });
    each("joint", [&](const std::string&, const std::string& joint) {
        const auto end = [&](const char* which) { return attribute(between(joint, which, ">"), "link"); };
        if (!links.contains(end("<child"))) return;  // of a transmission
        WrittenLink& child = links[end("<child")];
        child.carrier = end("<parent");
        child.inCarrier = originOf(joint);
        child.fixed = attribute(joint.substr(0, joint.find('>')), "type") == "fixed";
    });
    return links;
}

/// Adds what is at a place.
void add(Weight& to, const Weight& weight, const Place& place) {
    if (!(weight.mass > 0)) return;
    const Eigen::Vector3d center = place.turn * weight.center + place.at, before = to.center;
    const double mass = to.mass + weight.mass;
    to.center = (to.mass * before + weight.mass * center) / mass;
    const auto about = [&](double m, const Eigen::Vector3d& at) -> Eigen::Matrix3d {
        const Eigen::Vector3d d = at - to.center;
        return m * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
    };
    to.inertia += about(to.mass, before) + about(weight.mass, center) +
                  place.turn * weight.inertia * place.turn.transpose();
    to.mass = mass;
}

/// Links on fixed joints weigh with the link that carries them all.
std::map<std::string, Weight> bodiesOf(const std::map<std::string, WrittenLink>& links) {
    std::map<std::string, Weight> bodies;
    for (const auto& [name, link] : links) {
        std::string carrier = name;
        Place place;
        while (links.at(carrier).fixed) {
            place = links.at(carrier).inCarrier * place;
            carrier = links.at(carrier).carrier;
        }
        add(bodies[carrier], link.weight, place);
    }
    return bodies;
}

TEST(RobotMass, MomentsAndCentresAreThoseOfTheFile) {
    for (const char* name : {"robots/g1_29dof.urdf", "robots/h1.urdf"}) {
        RAGTOP_SAMPLE(file, name);
        const Robot robot = loadRobot(file);
        const std::map<std::string, Weight> bodies = bodiesOf(linksOf(file));
        double mass = 0;
        for (const RobotLink& link : robot.links) {
            if (!bodies.contains(link.name)) continue;
            const Weight& wanted = bodies.at(link.name);
            // In the axes of the link.
            const MassProperties found =
                transformed(robot.bodies[static_cast<std::size_t>(link.body)].mass, inverse(link.inBody));
            SCOPED_TRACE(std::string(name) + " " + link.name);
            EXPECT_NEAR(found.mass, wanted.mass, 1e-6 * wanted.mass);
            const Eigen::Vector3d center(found.center.x, found.center.y, found.center.z);
            EXPECT_LT((center - wanted.center).norm(), 1e-6);
            Eigen::Matrix3d inertia;
            inertia << found.inertia.cx.x, found.inertia.cy.x, found.inertia.cz.x, found.inertia.cx.y,
                found.inertia.cy.y, found.inertia.cz.y, found.inertia.cx.z, found.inertia.cy.z, found.inertia.cz.z;
            EXPECT_LT((inertia - wanted.inertia).norm(), 1e-6 * wanted.inertia.norm());
            mass += wanted.mass;
        }
        EXPECT_EQ(bodies.size(), robot.bodies.size());
        EXPECT_NEAR(robot.mass, mass, 1e-6 * mass);
    }
}

}  // namespace
}  // namespace ragtop
