#include "constraints/soft_course.h"

#include <cmath>

#include "constraints/axis_rows.h"
#include "constraints/joint_angle.h"
#include "constraints/oscillator.h"

namespace ragtop {

SoftCourse::SoftCourse(float stiffness, float damping, float inverseMass, float h)
    : square_(static_cast<double>(stiffness) * inverseMass),
      damping_(static_cast<double>(damping) * inverseMass),
      h_(h) {
    const double under = square_ - 0.25 * damping_ * damping_;
    // Nearly critical damping leaves no speed that a meeting could get wrong.
    follows_ = under > 0.01 * square_ && square_ * h_ * h_ <= 1 && square_ * h_ * h_ > 1e-6;
    if (!follows_) return;
    rate_ = std::sqrt(under);
    moving_ = springShares(stiffness, damping, inverseMass, h).moving;
}

/// x(t) = e^{−dt/2} (x cos + (v + d x/2) sin/Ω),  v(t) = e^{−dt/2} (v cos − (ω² x + d v/2) sin/Ω)
SoftCourse::Place SoftCourse::after(const Place& from, double t) const {
    const double half = oscillator::shortSine(0.5 * rate_ * t);
    const double sine = 2 * half * std::sqrt(1 - half * half) / rate_, cosine = 1 - 2 * half * half;
    const double left = 1 - oscillator::fading(0.5 * damping_ * t);
    return {left * (cosine * from.x + sine * (from.v + 0.5 * damping_ * from.x)),
            left * (cosine * from.v - sine * (square_ * from.x + 0.5 * damping_ * from.v))};
}

/// The substep ends beyond the stop. The speed it leaves is that from which rows go on exactly:
///   x₂ − x₁ = q₁ (h v − (ωh)² x₁).
SoftMeeting SoftCourse::goOn(const Place& now, double margin) const {
    const Place next = after(now, h_);
    const double last = (next.x - now.x) / (h_ * moving_) + h_ * square_ * now.x;
    return {true, false, static_cast<float>((now.x - margin) / h_), static_cast<float>(last)};
}

/// Is let go after `until` and flies on from there.
SoftMeeting SoftCourse::fly(const Place& from, double until, double margin) const {
    const Place end = after(from, until);
    const double mean = (end.x + end.v * (h_ - until) - margin) / h_;
    return {true, true, static_cast<float>(mean), static_cast<float>(end.v)};
}

/// Meets the stop on the way and follows it for the rest of the substep.
SoftMeeting SoftCourse::arrive(double margin, double speed) const {
    return goOn(after({0, speed}, h_ + margin / speed), margin);
}

/// Is beyond the stop when nothing has pushed yet: its speed is that of this very place.
SoftMeeting SoftCourse::begin(double margin, double speed) const {
    const Place now{margin, speed};
    const double until = forceFree(now);
    if (!(until > 0)) return {};
    return until < h_ && speed > 0 ? fly(now, until, margin) : goOn(after(now, h_), margin);
}

/// When the stop ceases to push: ω² x + d v obeys the same equation as x.
double SoftCourse::forceFree(const Place& now) const {
    const double force = square_ * now.x + damping_ * now.v;
    if (force >= 0) return 0;
    const double change = square_ * now.v - damping_ * force;
    const double along = (change + 0.5 * damping_ * force) / rate_;
    const auto angle = static_cast<double>(jointAngle(static_cast<float>(-force), static_cast<float>(along)));
    return angle / rate_;
}

/// Is let go on the way.
SoftMeeting SoftCourse::leave(double margin, double speed) const {
    const double step = h_ * moving_ * (speed - h_ * square_ * margin);
    // The speed at this place, of which `speed` lags: that which leads where rows would lead.
    const Place still = after({margin, 0}, h_), unit = after({0, 1}, h_);
    const Place now{margin, (margin + step - still.x) / unit.x};
    const double until = forceFree(now);
    return until < h_ && now.v > 0 ? fly(now, until, margin) : SoftMeeting{};
}

SoftMeeting SoftCourse::meet(float margin, float speed, bool pressed) const {
    if (!follows_) return {};
    if (margin < 0) return pressed ? leave(margin, speed) : begin(margin, speed);
    if (margin + static_cast<float>(h_) * speed < 0) return arrive(margin, speed);
    return {};
}

}  // namespace ragtop
