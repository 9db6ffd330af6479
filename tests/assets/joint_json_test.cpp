#include "joint_json.h"

#include <gtest/gtest.h>

#include <string>

#include "json_document.h"
#include "ragtop/asset_error.h"

// Every kind of joint and all that it may have, written and read again.
namespace ragtop {
namespace {

JointDef readBack(const JointDef& joint) {
    Json object = Json::object();
    writeJointKind(joint, object);
    const JsonDocument document = JsonDocument::parse(object.dump(), "joint.json");
    return readJointKind(JsonValue(document));
}
std::string text(const JointDef& joint) {
    Json object = Json::object();
    writeJointKind(joint, object);
    return object.dump();
}

AxisDef everything(float shift) {
    AxisDef axis;
    axis.limit = Range{-1.5f + shift, 20 + shift};
    axis.stop = {0.25f, 300, 2};
    axis.motor = Motor{3, 4, 5.0f};
    axis.spring = Spring{1, 2, 3, 0.7f, 0.1f, -6, 70};
    axis.target = shift;
    axis.friction = 0.3f;
    axis.bearing = Bearing{0.1f, 0.2f, 0.3f, 0.01f};
    return axis;
}

TEST(JointJson, EveryKindComesBackTheSame) {
    HingeDef hinge;
    const AxisDef axis = everything(0.125f);
    hinge.limit = axis.limit, hinge.stop = axis.stop, hinge.motor = axis.motor, hinge.spring = axis.spring;
    hinge.target = axis.target, hinge.friction = axis.friction, hinge.bearing = axis.bearing;
    BallDef ellipse, pyramid, polygon;
    ellipse.swingEllipse = SwingEllipse{0.3f, 1.1f};
    ellipse.twistLimit = Range{-0.2f, 0.7f};
    ellipse.bearing = axis.bearing;
    pyramid.swingPyramid = SwingPyramid{{-0.1f, 0.2f}, {-0.3f, 0.4f}};
    polygon.reach = ReachPolygon{};
    polygon.reach->count = 3;
    polygon.reach->corners[0] = {{1, 0.5f, 0}, {-1, 0.5f}};
    polygon.reach->corners[1] = {{1, 0, 0.5f}, {-0.5f, 1}};
    polygon.reach->corners[2] = {{1, -0.5f, -0.5f}, {0, 0.1f}};
    CylindricalDef cylindrical;
    cylindrical.turn = everything(1);
    cylindrical.travel = everything(2);
    UniversalDef universal;
    universal.first = everything(3);
    PlaneDef plane;
    plane.z = everything(4);
    ScrewDef screw;
    screw.pitch = -0.004f;
    screw.turn = everything(5);
    PathDef path;
    path.curve.count = 3;
    path.curve.points[1] = {1, 0.5f, 0};
    path.curve.points[2] = {2, 0, 0.25f};
    path.curve.closed = path.align = true;
    path.travel = everything(6);
    SixDofDef sixDof;
    sixDof.x = everything(7);
    sixDof.swingZ = everything(8);
    const JointDef all[] = {path,      sixDof, hinge, ellipse,   pyramid,     polygon,    cylindrical,
                            universal, plane,  screw, BallDef{}, SliderDef{}, FixedDef{}, DistanceDef{}};
    for (const JointDef& joint : all) {
        const JointDef again = readBack(joint);
        EXPECT_EQ(again.index(), joint.index());
        EXPECT_EQ(text(again), text(joint));
    }
}

}  // namespace
}  // namespace ragtop
