#include "joint_json.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "describe_json.h"
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
    ellipse.spring = ellipse.twistSpring = axis.spring;
    ellipse.target = rotationAbout({1, 2, 3}, 0.7f);
    ellipse.targetSpeed = {1, -2, 3};
    ellipse.feedForward = {4, 5, -6};
    ellipse.maxSpringTorque = 70;
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

/// Bytes of a definition, from its first one on.
struct Field {
    std::size_t begin, end, alignment;
};

template <class T>
void expectAllDescribed(const T& def, const std::string& name);

template <class T>
void expectInside(const T& field, const std::string& name) {
    if constexpr (IsOptional<T>::value) {
        expectInside(typename T::value_type{}, name);
    } else if constexpr (IsArray<T>::value) {
        expectInside(typename T::value_type{}, name);
    } else if constexpr (Described<T>) {
        expectAllDescribed(field, name);
    }
}

/// No byte of a definition lies outside of what its `describe` visits, but those that align the next field, and the
/// bodies of a joint, which files name.
template <class T>
void expectAllDescribed(const T& def, const std::string& name) {
    std::vector<Field> fields;
    const auto* first = reinterpret_cast<const std::byte*>(&def);
    const auto add = [&]<class Member>(const Member& member) {
        const auto begin = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&member) - first);
        fields.push_back({begin, begin + sizeof member, alignof(Member)});
    };
    if constexpr (requires { def.bodies; }) add(def.bodies);
    auto visit = [&](const Tunable& tunable, const auto& member) {
        add(member);
        expectInside(member, name + "." + std::string(tunable.name));
    };
    describe(visit, def, static_cast<const T*>(nullptr));
    std::sort(fields.begin(), fields.end(), [](const Field& a, const Field& b) { return a.begin < b.begin; });
    fields.push_back({sizeof def, sizeof def, alignof(T)});
    std::size_t end = 0;
    for (const Field& field : fields) {
        EXPECT_LT(field.begin - end, field.alignment)
            << name << ": bytes " << end << " to " << field.begin << " of " << sizeof def << " are in no describe";
        end = field.end;
    }
}

TEST(JointJson, EveryFieldOfEveryKindIsDescribed) {
    const auto each = [&]<class... Kinds>(const std::variant<Kinds...>*) {
        (expectAllDescribed(Kinds{}, text(Kinds{}).substr(2, 8)), ...);
    };
    each(static_cast<const JointDef*>(nullptr));
}

}  // namespace
}  // namespace ragtop
