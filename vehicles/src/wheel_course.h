#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "wheel_ground.h"

namespace ragtop {

constexpr int kMostPieces = 64;

/// The ground along the way of a wheel through a step, as planes that follow each other in time.
struct WheelCourse {
    std::array<GroundPlane, kMostPieces> pieces;
    int count = 0;  ///< of pieces, of equal times
    int taken = 0;  ///< on which the wheel is
    DVec3 from;     ///< of the hub
    Vec3 went;      ///< m that it was expected to go
};

/// The piece on which a hub is after a share of the step: that of the time, or an earlier one where it has not come as
/// far as was expected, because something stopped it.
int pieceAt(const WheelCourse& course, float share, const DVec3& hub);

/// What is known of the ground at the end of a way, kept with the wheel.
struct CourseEnd {
    GroundPlane& plane;
    float& below;  ///< m of the hub's course below what was found, which it catches up with
};

/// A wheel and where its hub would be in the middle of its travel, at the beginning and at the end of a step.
struct WheelWay {
    DVec3 from, to;
    Vec3 axis;  ///< unit, along which the hub rises
    Vec3 axle;  ///< unit, to the left
    float radius = 0, halfWidth = 0;
    float above = 0, below = 0;  ///< m along the axis between which the hub is sought
    float seconds = 0;           ///< of the step
    float tireSquash = 0;        ///< m, of the standing car
    bool stands = false;         ///< it did in the last substep
};

/// What all casts for the ground along a way stay in.
Bounds boundsOf(const WheelWay& way);

/// m that a hub has to rise along the axis for the wheel to stand on a plane; empty where it cannot stand there,
/// because it lies on its side or the plane is a wall to it.
std::optional<float> riseOn(const GroundPlane& plane, const WheelWay& way, const DVec3& hub);

/// Of the squash of a standing tire: what a substep may change it by, without being taken in parts.
inline constexpr float kThrown = 0.1f;

/// Into how many parts a substep is taken in which a wheel is thrown.
int finePieces(float seconds, int substeps);

/// Looks for the ground along a way. `last` is of the end of the way before, and becomes that of this one. The hub of a
/// wheel that rolls over steps and bumps goes along a locus, from which samples are taken: where they are not all on
/// one plane, `substeps` of them, and up to 16 times as many the more the hub is thrown up at once, as at a kerb:
/// what that does is over within a substep. Between two samples the ground is the plane along which the hub goes from
/// the one to the other: what the wheel climbs in a time its car pays for with what it is slowed down, whatever the
/// length of a step. Ground that comes up at once, as an edge that the tread meets from its side, is climbed at a
/// slope. Over what moves there is one piece, by the same rules.
void findCourse(const World& world, const QueryFilter& query, const WheelWay& way, int substeps, const CourseEnd& last,
                WheelCourse& course);

/// The same by one ray at the end of the way, and in one piece.
void findPlane(const World& world, const QueryFilter& query, const WheelWay& way, const CourseEnd& last,
               GroundPlane& plane);

}  // namespace ragtop
