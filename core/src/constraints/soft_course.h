#pragma once

namespace ragtop {

/// What a soft stop does in a substep in which it is met or left, or that begins beyond it: speeds of the margin.
struct SoftMeeting {
    bool meets = false, leaves = false;
    float mean = 0;  ///< over the substep, so that the margin ends where it should
    float last = 0;  ///< which the substep leaves
};

/// The exact course of a margin x that a spring and a damper hold while it is negative and they push:
///   ẍ = −ω² x − d ẋ,  ω² = k w,  d = c w.
/// For what is underdamped and turns by at most a radian per substep; else it finds no meeting.
class SoftCourse {
public:
    SoftCourse(float stiffness, float damping, float inverseMass, float h);

    /// `speed` is that of rows, which lags behind the place (springShares) where the stop is `pressed` already.
    SoftMeeting meet(float margin, float speed, bool pressed) const;

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
};

}  // namespace ragtop
