#pragma once

#include <cstdint>

#include "constraints/axis_rows.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"

namespace ragtop {

/// Springs of a ball whose twist has a spring of its own, whose target turns or that add a torque.
struct BallDrives {
    SpringTuning swing, twist;  ///< the first is the whole rotation's where they do not differ
    std::uint32_t apart = 0;
    Vec3 targetSpeed, feedForward;  ///< in A's joint frame

    // Of the current substep.
    Mat3 basis;        ///< of the rows: the world's axes, or the twist axis and two across it
    Vec3 push, speed;  ///< N m s and rad/s along them: h (feed-forward − k e), and that of the target
    Vec3 drag[2];      ///< N m s per rad/s, in the pass that moves and in the other
};
/// Does a plain spring not do?
bool needsDrives(const BallDef& def);
BallDrives compileDrives(const BallDef& def);
/// Of the row k of the basis.
TunedSpring tunedDrive(const BallDrives& drives, int k, float inverseInertia);

}  // namespace ragtop
