#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "ragtop/id.h"
#include "ragtop/joint_parts.h"
#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// Joints between two bodies, or between a body and the world (a null id). Joint frames are given in their bodies. The
/// x axis of a joint frame is the hinge, slide or twist axis; coordinates are zero where both frames agree.
namespace ragtop {

/// What a joint joins.
struct JointBodies {
    BodyId a{}, b{};                    ///< null: the world, whose frame is at its origin; not both
    Frame frameA{}, frameB{};           ///< the joint's frame in each body, relative to the body's pose
    bool collide = false;               ///< do the two bodies collide with each other?
    float breakForce = kNoForceLimit;   ///< N, mean over a step; beyond it the joint breaks (World::jointBreaks)
    float breakTorque = kNoForceLimit;  ///< N m, the same
    std::uint64_t userData = 0;
};

/// Holds two points together; swing and twist may be limited, resisted or driven. At most one of the four swing limits
/// may be given.
struct BallDef {
    JointBodies bodies{};
    std::optional<float> swingLimit{};           ///< rad, half angle of the cone of B's x axis about A's, in (0, π)
    std::optional<SwingEllipse> swingEllipse{};  ///< a cone with two half angles
    std::optional<SwingPyramid> swingPyramid{};  ///< a range about y and one about z
    std::optional<ReachPolygon> reach{};         ///< any spherical polygon, with a twist range of its own
    std::optional<Range> twistLimit{};           ///< rad, within [−π, π]
    Stop stop{};                                 ///< how all of these limits stop what meets them
    float friction = 0;                          ///< N m, dry friction torque
    std::optional<Bearing> bearing{};            ///< other friction; of the reaction in any direction
    std::optional<Spring> spring{};              ///< pulls B's rotation in A to `target`, the shortest way
    std::optional<Spring> twistSpring{};         ///< of the twist alone; `spring` then acts on the swing alone
    Quat target{};                               ///< rotation of B's joint frame in A's that the springs pull to
    Vec3 targetSpeed{};                          ///< rad/s, angular velocity of the target, in A's joint frame
    Vec3 feedForward{};                          ///< N m, added to the spring's torque, in A's joint frame
    float maxSpringTorque = 3.4e38f;             ///< N m, of springs and feed-forward together
};

/// Joins two bodies at a point and an axis: B turns about the x axis.
struct HingeDef {
    JointBodies bodies{};
    std::optional<Range> limit{};      ///< rad; the angle is unwrapped and may be many turns
    Stop stop{};                       ///< at the ends of the limit
    std::optional<Motor> motor{};      ///< rad/s, N m
    std::optional<Spring> spring{};    ///< pulls the angle to `target`
    float target = 0;                  ///< rad
    float friction = 0;                ///< N m, dry friction torque
    std::optional<Bearing> bearing{};  ///< its other friction
};

/// B slides along A's x axis without turning.
struct SliderDef {
    JointBodies bodies{};
    std::optional<Range> limit{};      ///< m
    Stop stop{};                       ///< at the ends of the limit
    std::optional<Motor> motor{};      ///< m/s, N
    std::optional<Spring> spring{};    ///< pulls the travel to `target`
    float target = 0;                  ///< m
    float friction = 0;                ///< N, dry friction force
    std::optional<Bearing> bearing{};  ///< its other friction
};

/// Welds two bodies together.
struct FixedDef {
    JointBodies bodies{};
};

/// Keeps the distance of the two frame origins within a range, or pulls it to a rest length by a spring. A range with
/// equal ends is a rod, one from zero a rope.
struct DistanceDef {
    JointBodies bodies{};
    std::optional<Range> limit{};    ///< m, not negative
    Stop stop{};                     ///< at the ends of the limit
    std::optional<Spring> spring{};  ///< pulls the distance to `rest`
    float rest = 0;                  ///< m
};

/// B turns about A's x axis and slides along it.
struct CylindricalDef {
    JointBodies bodies{};
    AxisDef turn{}, travel{};  ///< rad, m
};

/// A cross between two shafts: B turns about A's x axis and about its own y axis, which stay at a right angle.
struct UniversalDef {
    JointBodies bodies{};
    AxisDef first{}, second{};  ///< rad, about A's x and about B's y
};

/// B slides in A's y-z plane and turns about its normal, x.
struct PlaneDef {
    JointBodies bodies{};
    AxisDef y{}, z{}, turn{};  ///< m, m, rad
};

/// A nut on a thread: B travels along A's x axis by the pitch with each turn.
struct ScrewDef {
    JointBodies bodies{};
    float pitch = 0.01f;  ///< m per turn, negative for a left-handed thread
    AxisDef turn{};       ///< rad; the bearing's coefficient is that of the thread's flanks, `pinRadius` their mean
                          ///< radius
};

/// Keeps B's frame origin on a curve that is fixed in A's frame.
struct PathDef {
    JointBodies bodies{};
    Curve curve{};
    bool align = false;  ///< B's x axis points along the curve; B still rolls about it
    AxisDef travel{};  ///< m along the curve from its first point. Laps of a closed one add up; an open one ends at its
                       ///< last point.
};

/// All six degrees of freedom, each as its AxisDef says; a limit with equal ends locks one. The rotation of B in A is a
/// twist about x, then a swing, a rotation vector across x. Beyond a swing of 2.5 rad the forces along the swing fade,
/// since its direction is undefined at a half turn.
struct SixDofDef {
    JointBodies bodies{};
    AxisDef x{}, y{}, z{};                ///< m, along A's axes
    AxisDef twist{}, swingY{}, swingZ{};  ///< rad
};

using JointDef = std::variant<BallDef, HingeDef, SliderDef, FixedDef, DistanceDef, CylindricalDef, UniversalDef,
                              PlaneDef, ScrewDef, PathDef, SixDofDef>;

/// The spring of a ball or hinge, as World::setDrives sets it from now on: for callers that drive all joints of a
/// ragdoll in every step.
struct JointDrive {
    JointId joint{};
    Quat target{};                     ///< balls: rotation of B's joint frame in A's to pull to
    float angle = 0;                   ///< hinges: rad to pull to, unwrapped
    Vec3 speed{};                      ///< rad/s of the target, in A's joint frame; hinges use x
    Vec3 feedForward{};                ///< N m, added to the spring's torque, in A's joint frame; hinges use x
    float stiffness = 0;               ///< N m/rad
    float damping = 0;                 ///< N m s/rad
    float maxTorque = kNoForceLimit;   ///< N m, of all of it together
    bool operator==(const JointDrive&) const = default;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BallDef*) {
    visit(Tunable{"swingLimit", "rad", 1e-3, 3.1, "half angle of the swing cone"}, self.swingLimit);
    visit(Tunable{.name = "swingEllipse", .meaning = "a cone with two half angles"}, self.swingEllipse);
    visit(Tunable{.name = "swingPyramid", .meaning = "ranges of the swing about y and z"}, self.swingPyramid);
    visit(Tunable{.name = "reach", .meaning = "a spherical polygon that the x axis stays in"}, self.reach);
    visit(Tunable{"twistLimit", "rad", -3.1416, 3.1416, "range of the twist about x"}, self.twistLimit);
    visit(Tunable{.name = "stop", .meaning = "how limits stop what meets them"}, self.stop);
    visit(Tunable{"friction", "N m", 0, 1e9, "dry friction torque"}, self.friction);
    visit(Tunable{.name = "bearing", .meaning = "other friction"}, self.bearing);
    visit(Tunable{"spring", "", 0, 0, "pulls the rotation to its target"}, self.spring);
    visit(Tunable{"twistSpring", "", 0, 0, "the same about the twist axis; the other then swings alone"},
          self.twistSpring);
    visit(Tunable{.name = "target", .meaning = "rotation of B's joint frame in A's that the springs pull to"},
          self.target);
    visit(Tunable{"targetSpeed", "rad/s", -1e5, 1e5, "at which the target turns, in A's joint frame"},
          self.targetSpeed);
    visit(Tunable{"feedForward", "N m", -1e12, 1e12, "torque that is added, in A's joint frame"}, self.feedForward);
    visit(Tunable{"maxSpringTorque", "N m", 0, 3.5e38, "largest torque of the spring"}, self.maxSpringTorque);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const HingeDef*) {
    visit(Tunable{"limit", "rad", -1e5, 1e5, "range of the unwrapped angle"}, self.limit);
    visit(Tunable{.name = "stop", .meaning = "how the limit stops what meets it"}, self.stop);
    visit(Tunable{"motor", "", 0, 0, "drives the angular speed"}, self.motor);
    visit(Tunable{"spring", "", 0, 0, "pulls the angle to its target"}, self.spring);
    visit(Tunable{"target", "rad", -1e5, 1e5, "rest angle of the spring"}, self.target);
    visit(Tunable{"friction", "N m", 0, 1e9, "dry friction torque"}, self.friction);
    visit(Tunable{.name = "bearing", .meaning = "other friction"}, self.bearing);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SliderDef*) {
    visit(Tunable{"limit", "m", -1e5, 1e5, "range of the travel"}, self.limit);
    visit(Tunable{.name = "stop", .meaning = "how the limit stops what meets it"}, self.stop);
    visit(Tunable{"motor", "", 0, 0, "drives the speed"}, self.motor);
    visit(Tunable{"spring", "", 0, 0, "pulls the travel to its target"}, self.spring);
    visit(Tunable{"target", "m", -1e5, 1e5, "rest travel of the spring"}, self.target);
    visit(Tunable{"friction", "N", 0, 1e9, "dry friction force"}, self.friction);
    visit(Tunable{.name = "bearing", .meaning = "other friction"}, self.bearing);
}
template <class Visitor, class Self>
void describe(Visitor&, Self&, const FixedDef*) {}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DistanceDef*) {
    visit(Tunable{"limit", "m", 0, 1e5, "range of the distance"}, self.limit);
    visit(Tunable{.name = "stop", .meaning = "how the limit stops what meets it"}, self.stop);
    visit(Tunable{"spring", "", 0, 0, "pulls the distance to its rest length"}, self.spring);
    visit(Tunable{"rest", "m", 0, 1e5, "rest length of the spring"}, self.rest);
}

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const CylindricalDef*) {
    visit(Tunable{.name = "turn", .meaning = "turning about the axis, rad"}, self.turn);
    visit(Tunable{.name = "travel", .meaning = "sliding along it, m"}, self.travel);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const UniversalDef*) {
    visit(Tunable{.name = "first", .meaning = "turning about A's x axis, rad"}, self.first);
    visit(Tunable{.name = "second", .meaning = "turning about B's y axis, rad"}, self.second);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PlaneDef*) {
    visit(Tunable{.name = "y", .meaning = "sliding along A's y axis, m"}, self.y);
    visit(Tunable{.name = "z", .meaning = "sliding along A's z axis, m"}, self.z);
    visit(Tunable{.name = "turn", .meaning = "turning about the normal, rad"}, self.turn);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ScrewDef*) {
    visit(Tunable{"pitch", "m", -1e3, 1e3, "travel per turn"}, self.pitch);
    visit(Tunable{.name = "turn", .meaning = "turning about the axis, rad"}, self.turn);
}

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PathDef*) {
    visit(Tunable{.name = "curve", .meaning = "in A's frame"}, self.curve);
    visit(Tunable{"align", "", 0, 1, "does B's x axis point along it?"}, self.align);
    visit(Tunable{.name = "travel", .meaning = "sliding along it, m"}, self.travel);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SixDofDef*) {
    visit(Tunable{.name = "x", .meaning = "sliding along A's x axis, m"}, self.x);
    visit(Tunable{.name = "y", .meaning = "sliding along A's y axis, m"}, self.y);
    visit(Tunable{.name = "z", .meaning = "sliding along A's z axis, m"}, self.z);
    visit(Tunable{.name = "twist", .meaning = "turning about B's x axis, rad"}, self.twist);
    visit(Tunable{.name = "swingY", .meaning = "swing about y, rad"}, self.swingY);
    visit(Tunable{.name = "swingZ", .meaning = "swing about z, rad"}, self.swingZ);
}

/// Empty when the definition is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const JointDef& def);

/// What a joint does at the end of the last step, in world axes.
struct JointState {
    Vec3 force;            ///< N, of A on B
    Vec3 torque;           ///< N m, about B's frame origin
    /// Angle of a hinge, screw or cylindrical joint (rad, unwrapped), travel of a slider or path, distance (m), first
    /// angle of a universal joint, turn of a plane, twist of a ball or six-degree-of-freedom joint (rad).
    float coordinate = 0;
    /// Travel of a cylindrical joint, second angle of a universal one, y and z of a plane, swing of a
    /// six-degree-of-freedom joint.
    float second = 0, third = 0;
    Vec3 travel;            ///< m, of a six-degree-of-freedom joint, along A's axes
    float speed = 0;        ///< rate of `coordinate`
    float swing = 0;        ///< rad, balls only
    float gap = 0;          ///< m, between the anchors that should coincide
    float limitMargin = 0;  ///< rad or m to the nearest limit, negative beyond it; infinite without limits
};

}  // namespace ragtop
