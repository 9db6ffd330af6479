#pragma once

#include <array>
#include <optional>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// What joints are made of: ranges with stops, springs, motors, friction. Units are those of the coordinate that they
/// act along: m and N, or rad and N m.
namespace ragtop {

/// No bound on a force or torque.
inline constexpr float kNoForceLimit = 3.4e38f;

/// A closed range, in the unit of what it limits.
struct Range {
    float lower = 0, upper = 0;
};

/// Pulls a coordinate to its target with the force k (target − x) + d (speed − ẋ) + feed-forward. Alone on its
/// coordinate it follows the exact damped oscillator while ω h ≤ 1, with h the substep, and is implicit and stable
/// beyond (docs/adr/0038).
struct Spring {
    float stiffness = 0;  ///< N/m or N m/rad
    float damping = 0;    ///< N s/m or N m s/rad
    /// Hz. Above zero, it and `dampingRatio` replace stiffness and damping, for the inertia that the joint moves.
    float frequency = 0;
    float dampingRatio = 1;
    float speed = 0;                 ///< m/s or rad/s, of the target: damping acts on the difference from it
    float feedForward = 0;           ///< N or N m, added to the spring's force
    float maxForce = kNoForceLimit;  ///< N or N m, bound of the sum
};

/// Drives a speed with a bounded force or torque.
struct Motor {
    float targetSpeed = 0;              ///< m/s or rad/s
    float maxForce = 0;                 ///< N or N m, in both directions unless `maxReverse` is given
    std::optional<float> maxReverse{};  ///< N or N m, bound towards lower coordinates
};

/// How the ends of a range stop what runs into them: hard, with restitution, or as a damped spring.
struct Stop {
    float restitution = 0;  ///< of a hard stop: rebound speed over impact speed
    float stiffness = 0;    ///< N/m or N m/rad beyond the end of the range; 0: a hard stop
    float damping = 0;      ///< N s/m or N m s/rad, of a soft stop
};

/// Friction of a joint beside its dry friction.
struct Bearing {
    float breakaway = 0;    ///< N or N m, by which friction at rest exceeds friction in motion
    float viscous = 0;      ///< N s/m or N m s/rad, friction per speed
    float coefficient = 0;  ///< friction over the joint's reaction across the axis
    float pinRadius = 0;    ///< m, lever of that friction about the axis; unused where the joint slides
};

/// All that may act along one free coordinate of a joint.
struct AxisDef {
    std::optional<Range> limit{};
    Stop stop{};  ///< at the ends of the limit
    std::optional<Motor> motor{};
    std::optional<Spring> spring{};    ///< pulls to `target`
    float target = 0;                  ///< m or rad
    float friction = 0;                ///< N or N m, dry
    std::optional<Bearing> bearing{};  ///< its other friction
};

/// An elliptic cone about A's x axis. The swing of B's x axis, as a vector (s_y, s_z) of its angle along its direction,
/// keeps (s_y/y)² + (s_z/z)² ≤ 1.
struct SwingEllipse {
    float y = 1, z = 1;  ///< rad, half angles
};

/// Ranges of the swing about y and about z, each within a quarter turn; a reach polygon may go further.
struct SwingPyramid {
    Range y{-1, 1}, z{-1, 1};  ///< rad
};

/// A corner of a reach polygon: a direction of B's x axis in A's frame, and the range of twist there.
struct ReachCorner {
    Vec3 direction{1, 0, 0};  ///< need not have unit length
    Range twist{-3.1415f, 3.1415f};
};

/// A polygon of great arcs on the sphere that B's x axis must stay in [Wilhelms, Van Gelder, Fast and easy reach-cone
/// joint limits, 2001]. Corners run counter-clockwise as seen from outside, so that the inside is on the left of each
/// edge; it may be concave and larger than a hemisphere. Edges must not cross and must be shorter than half a turn.
struct ReachPolygon {
    static constexpr int kMostCorners = 12;
    int count = 0;  ///< 3 to 12
    std::array<ReachCorner, kMostCorners> corners{};
};

/// A cubic spline through points, with continuous curvature [de Boor, A Practical Guide to Splines, 1978], parametrised
/// by the chords between them; an open one has no curvature at its ends.
struct Curve {
    static constexpr int kMostPoints = 16;
    int count = 0;                           ///< 2 to 16, of a closed curve at least 3
    std::array<Vec3, kMostPoints> points{};  ///< m; neighbours apart
    bool closed = false;                     ///< from the last point back to the first
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
    visit(Tunable{"frequency", "Hz", 0, 1e5, "above zero, replaces stiffness and damping"}, self.frequency);
    visit(Tunable{"dampingRatio", "1", 0, 1e3, "damping ratio beside a frequency"}, self.dampingRatio);
    visit(Tunable{"speed", "m/s or rad/s", -1e5, 1e5, "speed of the target"}, self.speed);
    visit(Tunable{"feedForward", "N or N m", -1e12, 1e12, "force or torque that is added"}, self.feedForward);
    visit(Tunable{"maxForce", "N or N m", 0, 3.5e38, "largest force or torque of the spring"}, self.maxForce);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Motor*) {
    visit(Tunable{"targetSpeed", "m/s or rad/s", -1e5, 1e5, "speed to reach"}, self.targetSpeed);
    visit(Tunable{"maxForce", "N or N m", 0, 1e12, "largest force or torque"}, self.maxForce);
    visit(Tunable{"maxReverse", "N or N m", 0, 1e12, "the same towards lower coordinates"}, self.maxReverse);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Stop*) {
    visit(Tunable{"restitution", "1", 0, 1, "rebound speed over impact speed"}, self.restitution);
    visit(Tunable{"stiffness", "N/m or N m/rad", 0, 1e12, "of a soft stop; 0: hard"}, self.stiffness);
    visit(Tunable{"damping", "N s/m or N m s/rad", 0, 1e12, "of a soft stop"}, self.damping);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Bearing*) {
    visit(Tunable{"breakaway", "N or N m", 0, 1e9, "friction at rest beyond that of motion"}, self.breakaway);
    visit(Tunable{"viscous", "N s/m or N m s/rad", 0, 1e9, "friction per speed"}, self.viscous);
    visit(Tunable{"coefficient", "1", 0, 10, "friction over the joint's reaction"}, self.coefficient);
    visit(Tunable{"pinRadius", "m", 0, 1e3, "lever of that friction about the axis"}, self.pinRadius);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const AxisDef*) {
    visit(Tunable{"limit", "m or rad", -1e5, 1e5, "range; angles are unwrapped"}, self.limit);
    visit(Tunable{.name = "stop", .meaning = "how the limit stops what meets it"}, self.stop);
    visit(Tunable{.name = "motor", .meaning = "drives the speed"}, self.motor);
    visit(Tunable{.name = "spring", .meaning = "pulls to the target"}, self.spring);
    visit(Tunable{"target", "m or rad", -1e5, 1e5, "rest of the spring"}, self.target);
    visit(Tunable{"friction", "N or N m", 0, 1e9, "dry friction"}, self.friction);
    visit(Tunable{.name = "bearing", .meaning = "other friction"}, self.bearing);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SwingEllipse*) {
    visit(Tunable{"y", "rad", 1e-3, 3.1, "half angle about y"}, self.y);
    visit(Tunable{"z", "rad", 1e-3, 3.1, "half angle about z"}, self.z);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SwingPyramid*) {
    visit(Tunable{"y", "rad", -1.5, 1.5, "range of the swing about y"}, self.y);
    visit(Tunable{"z", "rad", -1.5, 1.5, "range of the swing about z"}, self.z);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ReachCorner*) {
    visit(Tunable{"direction", "1", -1e5, 1e5, "of B's x axis in A's frame"}, self.direction);
    visit(Tunable{"twist", "rad", -3.1416, 3.1416, "range of the twist there"}, self.twist);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ReachPolygon*) {
    visit(Tunable{"count", "1", 3, ReachPolygon::kMostCorners, "corners in use"}, self.count);
    visit(Tunable{.name = "corners", .meaning = "counter-clockwise as seen from outside"}, self.corners);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Curve*) {
    visit(Tunable{"count", "1", 2, Curve::kMostPoints, "points in use"}, self.count);
    visit(Tunable{"points", "m", -1e5, 1e5, "what the curve goes through"}, self.points);
    visit(Tunable{"closed", "", 0, 1, "from the last point back to the first"}, self.closed);
}

}  // namespace ragtop
