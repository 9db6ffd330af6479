#include "robot_document.h"

#include "file_kind.h"
#include "import_child.h"
#include "mjcf_document.h"
#include "ragtop/asset_error.h"
#include "urdf_document.h"
#include "xml_text.h"

namespace ragtop {
namespace {

template <class Stream, class Joint>
void jointFields(Stream& stream, Joint& joint) {
    stream(joint.name);
    stream(joint.kind);
    stream(joint.origin);
    stream(joint.anchor);
    stream(joint.axis);
    stream(joint.limited);
    stream(joint.rated);
    for (auto* value : {&joint.lower, &joint.upper, &joint.effort, &joint.velocity, &joint.damping, &joint.friction})
        stream(*value);
    stream(joint.follows);
    for (auto* value : {&joint.stiffness, &joint.springTarget, &joint.multiplier, &joint.offset, &joint.softLower,
                        &joint.softUpper, &joint.kPosition, &joint.kVelocity})
        stream(*value);
}
template <class Stream, class Tag>
void tagFields(Stream& stream, Tag& tag) {
    stream(tag.tag);
    stream(tag.applied);
    stream(tag.leftOut);
}
template <class Stream, class Shape>
void shapeFields(Stream& stream, Shape& shape) {
    stream(shape.kind);
    stream(shape.size);
    stream(shape.radius);
    stream(shape.length);
    stream(shape.origin);
    stream(shape.mesh);
    stream(shape.friction);
}
template <class Stream, class Link>
void linkFields(Stream& stream, Link& link) {
    stream(link.name);
    stream(link.parent);
    jointFields(stream, link.joint);
    stream(link.between);
    stream(link.heavy);
    stream(link.mass);
    stream(link.inertia);
    stream(link.centerOfMass);
    stream(link.shapes);
}
template <class Stream, class Loop>
void loopFields(Stream& stream, Loop& loop) {
    stream(loop.name);
    stream(loop.welded);
    stream(loop.a);
    stream(loop.b);
    stream(loop.anchor);
}
template <class Stream, class Sum>
void sumFields(Stream& stream, Sum& sum) {
    stream(sum.name);
    stream(sum.parts);
    stream(sum.limited);
    for (auto* value : {&sum.lower, &sum.upper, &sum.stiffness, &sum.damping, &sum.friction, &sum.rest}) stream(*value);
}
template <class Stream, class Key>
void keyFields(Stream& stream, Key& key) {
    stream(key.name);
    stream(key.coordinates);
}
template <class Stream, class Robot>
void robotFields(Stream& stream, Robot& robot) {
    stream(robot.name);
    stream(robot.grounded);
    stream(robot.loops);
    stream(robot.sums);
    stream(robot.keys);
    stream(robot.tags);
    stream(robot.links);
    stream(robot.warnings);
}

}  // namespace

// ByteWriter and ByteReader find these by argument.
static void fields(ByteWriter& stream, const ImportedRobotShape& shape) { shapeFields(stream, shape); }
static void fields(ByteReader& stream, ImportedRobotShape& shape) { shapeFields(stream, shape); }
static void fields(ByteWriter& stream, const ImportedRobotLoop& loop) { loopFields(stream, loop); }
static void fields(ByteReader& stream, ImportedRobotLoop& loop) { loopFields(stream, loop); }
static void fields(ByteWriter& stream, const ImportedRobotSum& sum) { sumFields(stream, sum); }
static void fields(ByteReader& stream, ImportedRobotSum& sum) { sumFields(stream, sum); }
static void fields(ByteWriter& stream, const ImportedRobotKey& key) { keyFields(stream, key); }
static void fields(ByteReader& stream, ImportedRobotKey& key) { keyFields(stream, key); }
static void fields(ByteWriter& stream, const ImportedRobotTag& tag) { tagFields(stream, tag); }
static void fields(ByteReader& stream, ImportedRobotTag& tag) { tagFields(stream, tag); }
static void fields(ByteWriter& stream, const ImportedRobotLink& link) { linkFields(stream, link); }
static void fields(ByteReader& stream, ImportedRobotLink& link) { linkFields(stream, link); }

ImportedRobot readRobot(const std::filesystem::path& path) {
    XmlText text;
    readXml(path, text);
    const TiXmlElement* root = text.document.RootElement();
    if (root && root->ValueStr() == "mujoco") return readMjcf(path, *root);
    if (root && root->ValueStr() == "robot") return readUrdf(path, text);
    throw AssetError(path.string(), root ? std::to_string(root->Row()) : "",
                     (root ? "begins with <" + root->ValueStr() + ">" : "has no element") +
                         ", must begin with <robot> (URDF) or <mujoco> (MJCF)" + looksLike(text.source));
}

ImportedRobot importRobot(const std::filesystem::path& path) {
    ImportedRobot robot;
    const auto write = [&](ByteWriter& to) {
        const ImportedRobot read = readRobot(path);
        robotFields(to, read);
    };
    importInChild(path, write, [&](ByteReader& from) { robotFields(from, robot); });
    return robot;
}

}  // namespace ragtop
