#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// Joints between two bodies, or between a body and the world (a null id). Frames are in body space; the x axis of
/// a joint frame is the hinge, slide or twist axis, and the joint's zero is where both frames agree.
namespace ragtop {

/// A closed range, in the unit of what it limits.
struct Range {
    float lower = 0, upper = 0;
};

/// A damped spring, integrated implicitly: stable at any stiffness and step.
struct Spring {
    float stiffness = 0;  ///< N/m or N m/rad
    float damping = 0;    ///< N s/m or N m s/rad
};

/// Drives a speed with a bounded force or torque.
struct Motor {
    float targetSpeed = 0;  ///< m/s or rad/s
    float maxForce = 0;     ///< N or N m
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Range*) {
    visit(Tunable{"lower", "m or rad", -1e5, 1e5, "lower end"}, self.lower);
    visit(Tunable{"upper", "m or rad", -1e5, 1e5, "upper end"}, self.upper);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Spring*) {
    visit(Tunable{"stiffness", "N/m or N m/rad", 0, 1e12, "restoring force per displacement"}, self.stiffness);
    visit(Tunable{"damping", "N s/m or N m s/rad", 0, 1e12, "resisting force per speed"}, self.damping);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Motor*) {
    visit(Tunable{"targetSpeed", "m/s or rad/s", -1e5, 1e5, "speed to reach"}, self.targetSpeed);
    visit(Tunable{"maxForce", "N or N m", 0, 1e12, "largest force or torque"}, self.maxForce);
}

/// What a joint joins.
struct JointBodies {
    BodyId a{}, b{};           ///< a null id is the world, at its origin; not both
    Frame frameA{}, frameB{};  ///< the joint's frame in each body, relative to the body's pose
    bool collide = false;  ///< do the two bodies collide with each other?
    std::uint64_t userData = 0;
};

/// Holds two points together; swing and twist may be limited, resisted or driven.
struct BallDef {
    JointBodies bodies{};
    std::optional<float> swingLimit{};  ///< rad, half angle of the cone of B's x axis about A's, in (0, π)
    std::optional<Range> twistLimit{};  ///< rad, within [−π, π]
    float friction = 0;               ///< N m, dry friction torque
    std::optional<Spring> spring{};     ///< pulls B's rotation in A to `target`
    Quat target{};                      ///< of B's joint frame in A's
    float maxSpringTorque = 3.4e38f;  ///< N m
};

/// Joins at a point and an axis.
struct HingeDef {
    JointBodies bodies{};
    std::optional<Range> limit{};    ///< rad, within [−π, π]
    std::optional<Motor> motor{};    ///< rad/s, N m
    std::optional<Spring> spring{};  ///< pulls the angle to `target`
    float target = 0;              ///< rad
    float friction = 0;            ///< N m, dry friction torque
};

/// Slides along the x axis without turning.
struct SliderDef {
    JointBodies bodies{};
    std::optional<Range> limit{};    ///< m
    std::optional<Motor> motor{};    ///< m/s, N
    std::optional<Spring> spring{};  ///< pulls the travel to `target`
    float target = 0;              ///< m
    float friction = 0;            ///< N, dry friction force
};

/// Welds two bodies.
struct FixedDef {
    JointBodies bodies{};
};

/// Keeps the distance of the two frame origins within a range (a rod when both ends are equal, a rope when the lower
/// one is zero), or springs it.
struct DistanceDef {
    JointBodies bodies{};
    std::optional<Range> limit{};    ///< m, not negative
    std::optional<Spring> spring{};  ///< pulls the distance to `rest`
    float rest = 0;                ///< m
};

using JointDef = std::variant<BallDef, HingeDef, SliderDef, FixedDef, DistanceDef>;

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BallDef*) {
    visit(Tunable{"swingLimit", "rad", 1e-3, 3.1, "half angle of the swing cone"}, self.swingLimit);
    visit(Tunable{"twistLimit", "rad", -3.1416, 3.1416, "range of the twist about x"}, self.twistLimit);
    visit(Tunable{"friction", "N m", 0, 1e9, "dry friction torque"}, self.friction);
    visit(Tunable{"spring", "", 0, 0, "pulls the rotation to its target"}, self.spring);
    visit(Tunable{"maxSpringTorque", "N m", 0, 3.5e38, "largest torque of the spring"}, self.maxSpringTorque);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const HingeDef*) {
    visit(Tunable{"limit", "rad", -3.1416, 3.1416, "range of the angle"}, self.limit);
    visit(Tunable{"motor", "", 0, 0, "drives the angular speed"}, self.motor);
    visit(Tunable{"spring", "", 0, 0, "pulls the angle to its target"}, self.spring);
    visit(Tunable{"target", "rad", -3.1416, 3.1416, "rest angle of the spring"}, self.target);
    visit(Tunable{"friction", "N m", 0, 1e9, "dry friction torque"}, self.friction);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SliderDef*) {
    visit(Tunable{"limit", "m", -1e5, 1e5, "range of the travel"}, self.limit);
    visit(Tunable{"motor", "", 0, 0, "drives the speed"}, self.motor);
    visit(Tunable{"spring", "", 0, 0, "pulls the travel to its target"}, self.spring);
    visit(Tunable{"target", "m", -1e5, 1e5, "rest travel of the spring"}, self.target);
    visit(Tunable{"friction", "N", 0, 1e9, "dry friction force"}, self.friction);
}
template <class Visitor, class Self>
void describe(Visitor&, Self&, const FixedDef*) {}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DistanceDef*) {
    visit(Tunable{"limit", "m", 0, 1e5, "range of the distance"}, self.limit);
    visit(Tunable{"spring", "", 0, 0, "pulls the distance to its rest length"}, self.spring);
    visit(Tunable{"rest", "m", 0, 1e5, "rest length of the spring"}, self.rest);
}

/// Empty when the definition is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const JointDef& def);

/// What a joint does, in the world's axes, at the end of the last step.
struct JointState {
    Vec3 force;             ///< N, that A exerts on B
    Vec3 torque;            ///< N m, about B's frame origin
    float coordinate = 0;   ///< rad of a hinge, m of a slider or distance, rad of twist of a ball
    float speed = 0;        ///< its rate
    float swing = 0;        ///< rad, balls only
    float gap = 0;          ///< m, between the points that should be one
    float limitMargin = 0;  ///< rad or m to the nearest limit, negative beyond it; infinite without limits
};

}  // namespace ragtop
