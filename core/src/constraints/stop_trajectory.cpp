#include "constraints/stop_trajectory.h"

#include <cmath>

#include "constraints/axis_rows.h"
#include "constraints/joint_geometry.h"
#include "constraints/oscillator.h"

namespace ragtop {

StopTrajectory::StopTrajectory(const Stop& stop, float inverseMass, float h, float room)
    : square_(static_cast<double>(stop.stiffness) * inverseMass),
      damping_(static_cast<double>(stop.damping) * inverseMass),
      h_(h),
      room_(room) {
    const double under = square_ - 0.25 * damping_ * damping_;
    // Nearly critical damping leaves no speed that a meeting could get wrong.
    follows_ = under > 0.01 * square_ && square_ * h_ * h_ <= 1 && square_ * h_ * h_ > 1e-6;
    if (!follows_) return;
    rate_ = std::sqrt(under);
    moving_ = springShares(stop.stiffness, stop.damping, inverseMass, h).moving;
}

/// x(t) = e^{−dt/2} (x cos + (v + d x/2) sin/Ω),  v(t) = e^{−dt/2} (v cos − (ω² x + d v/2) sin/Ω)
StopTrajectory::Place StopTrajectory::after(const Place& from, double t) const {
    const double half = oscillator::shortSine(0.5 * rate_ * t);
    const double sine = 2 * half * std::sqrt(1 - half * half) / rate_, cosine = 1 - 2 * half * half;
    const double left = 1 - oscillator::fading(0.5 * damping_ * t);
    return {left * (cosine * from.x + sine * (from.v + 0.5 * damping_ * from.x)),
            left * (cosine * from.v - sine * (square_ * from.x + 0.5 * damping_ * from.v))};
}

/// Rows go on from x₁ by  x₂ − x₁ = q₁ (h v − (ωh)² x₁).
double StopTrajectory::rowSpeedAt(double margin, double speed) const {
    return (after({margin, speed}, h_).x - margin) / (h_ * moving_) + h_ * square_ * margin;
}
double StopTrajectory::speedAt(double margin, double speed) const {
    const double step = h_ * moving_ * (speed - h_ * square_ * margin);
    const Place still = after({margin, 0}, h_), unit = after({0, 1}, h_);
    return (margin + step - still.x) / unit.x;
}

/// The substep ends beyond the stop, with the speed from which rows go on exactly.
SoftMeeting StopTrajectory::goOn(const Place& now, double margin) const {
    const double last = rowSpeedAt(now.x, now.v);
    return {true, false, false, static_cast<float>((now.x - margin) / h_), static_cast<float>(last)};
}

/// Is let go after `until` and flies on from there, to the other stop if that is near.
SoftMeeting StopTrajectory::fly(const Place& from, double until, double margin) const {
    const Place end = after(from, until);
    const double left = h_ - until, flight = (room_ - end.x) / end.v;
    if (flight < left) {
        const Place other = after({0, -end.v}, left - flight);
        const double mean = (room_ - other.x - margin) / h_;
        return {true, true, true, static_cast<float>(mean), static_cast<float>(-rowSpeedAt(other.x, other.v))};
    }
    const double mean = (end.x + end.v * left - margin) / h_;
    return {true, true, false, static_cast<float>(mean), static_cast<float>(end.v)};
}

/// Meets the stop on the way and follows it for the rest of the substep.
SoftMeeting StopTrajectory::arrive(double margin, double speed) const {
    return goOn(after({0, speed}, h_ + margin / speed), margin);
}

/// Is beyond the stop when nothing has pushed yet: its speed is that of this very place.
SoftMeeting StopTrajectory::begin(double margin, double speed) const {
    const Place now{margin, speed};
    const double until = forceFree(now);
    if (!(until > 0)) return {};
    return until < h_ && speed > 0 ? fly(now, until, margin) : goOn(after(now, h_), margin);
}

/// When the stop ceases to push: ω² x + d v obeys the same equation as x.
double StopTrajectory::forceFree(const Place& now) const {
    const double force = square_ * now.x + damping_ * now.v;
    if (force >= 0) return 0;
    const double change = square_ * now.v - damping_ * force;
    const double along = (change + 0.5 * damping_ * force) / rate_;
    const auto angle = static_cast<double>(jointAngle(static_cast<float>(-force), static_cast<float>(along)));
    return angle / rate_;
}

/// Is let go on the way.
SoftMeeting StopTrajectory::leave(double margin, double speed) const {
    const Place now{margin, speedAt(margin, speed)};
    const double until = forceFree(now);
    return until < h_ && now.v > 0 ? fly(now, until, margin) : SoftMeeting{};
}

SoftMeeting StopTrajectory::meet(float margin, float speed, bool pressed) const {
    if (!follows_) return {};
    if (margin < 0) return pressed ? leave(margin, speed) : begin(margin, speed);
    if (margin + static_cast<float>(h_) * speed < 0) return arrive(margin, speed);
    return {};
}

}  // namespace ragtop
