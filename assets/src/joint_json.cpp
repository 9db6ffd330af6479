#include "joint_json.h"

#include <cmath>
#include <utility>

namespace ragtop {
namespace {

/// Calls `visit(name, default)` for each kind.
template <class Visit>
void forEachKind(Visit visit) {
    visit("ball", BallDef{});
    visit("hinge", HingeDef{});
    visit("slider", SliderDef{});
    visit("fixed", FixedDef{});
    visit("distance", DistanceDef{});
    visit("cylindrical", CylindricalDef{});
    visit("universal", UniversalDef{});
    visit("plane", PlaneDef{});
    visit("screw", ScrewDef{});
    visit("path", PathDef{});
    visit("sixDof", SixDofDef{});
}

}  // namespace

void addJointKinds(Json& schema) {
    forEachKind([&](const char* name, const auto& kind) { schema["properties"][name] = objectSchema(kind); });
}

JointDef readJointKind(const JsonValue& object) {
    JointDef joint;
    int kinds = 0;
    forEachKind([&](const char* name, auto kind) {
        if (!object.has(name)) return;
        ++kinds;
        readValue(object.at(name), kind);
        joint = std::move(kind);
    });
    if (kinds == 0 && object.holdsUnknown()) throw Faults::Consequence();
    if (kinds != 1) {
        object.fail("has " + std::to_string(kinds) +
                    " kinds of joint, must have exactly one of ball, hinge, slider, fixed, distance, "
                    "cylindrical, universal, plane, screw, path, sixDof");
    }
    return joint;
}

void writeJointKind(const JointDef& joint, Json& object) {
    forEachKind([&](const char* name, const auto& kind) {
        if (const auto* held = std::get_if<std::remove_cvref_t<decltype(kind)>>(&joint))
            object[name] = writeValue(*held);
    });
}

std::string whyInvalidKind(JointDef joint) {
    std::visit(
        [](auto& kind) {
            kind.bodies.a = {0, 1};
            kind.bodies.b = {1, 1};
        },
        joint);
    return whyInvalid(joint);
}

bool turnsOften(const JointDef& joint) {
    const auto isFar = [](float angle) { return std::abs(static_cast<double>(angle)) > kWholeTurn; };
    const auto reachesFar = [&](const auto& axis) {
        return isFar(axis.target) || (axis.limit && (isFar(axis.limit->lower) || isFar(axis.limit->upper)));
    };
    if (const auto* hinge = std::get_if<HingeDef>(&joint)) return reachesFar(*hinge);
    const auto* universal = std::get_if<UniversalDef>(&joint);
    return universal && (reachesFar(universal->first) || reachesFar(universal->second));
}

}  // namespace ragtop
