#pragma once

#include "ragtop/joint_parts.h"

namespace ragtop {

/// What a soft stop does in a substep in which it is met or left, or that begins beyond it: speeds of the margin.
struct SoftMeeting {
    bool meets = false, leaves = false;
    bool crosses = false;  ///< leaves, and meets the stop at the other end
    float mean = 0;        ///< over the substep, so that the margin ends where it should
    float last = 0;        ///< which the substep leaves
};

/// The exact course of a margin x that a spring and a damper hold while it is negative and they push:
///   ẍ = −ω² x − d ẋ,  ω² = k w,  d = c w.
/// For what is underdamped and turns by at most a radian per substep; else it finds no meeting. The other end of its
/// range, `room` away, has the same stop.
class StopTrajectory {
public:
    StopTrajectory() = default;
    StopTrajectory(const Stop& stop, float inverseMass, float h, float room);

    bool follows() const { return follows_; }

    /// `speed` is that of rows, which lags behind the place (springShares) where the stop is `pressed` already.
    SoftMeeting meet(float margin, float speed, bool pressed) const;
    /// The speed at a place beyond the stop of which rows have `speed`, and the reverse.
    double speedAt(double margin, double speed) const;
    double rowSpeedAt(double margin, double speed) const;

private:
    struct Place {
        double x, v;
    };
    Place after(const Place& from, double t) const;
    SoftMeeting arrive(double margin, double speed) const;
    SoftMeeting begin(double margin, double speed) const;
    SoftMeeting goOn(const Place& now, double margin) const;
    SoftMeeting fly(const Place& from, double until, double margin) const;
    SoftMeeting leave(double margin, double speed) const;
    double forceFree(const Place& now) const;

    bool follows_ = false;
    double square_ = 0, damping_ = 0, rate_ = 0;  ///< ω², d, √(ω² − d²/4)
    double h_ = 0, moving_ = 1;                   ///< s, share of springs
    double room_ = 0;                             ///< m or rad
};

}  // namespace ragtop
