#include "ragtop/driver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ragtop {
namespace {

constexpr float kAheadTime = 0.6f, kAheadLeast = 4;  ///< s, m: how far ahead of the car the driver aims
constexpr float kCornering = 4, kBraking = 3;        ///< m/s² that the driver dares
constexpr float kSight = 60;                         ///< m of line that are looked at

float flatDistance(const DVec3& a, const DVec3& b) {
    const Vec3 d = relative(a, b);
    return std::sqrt(d.x * d.x + d.z * d.z);
}

/// Walks along a line; ends at its end, or never where it is closed.
class Walk {
public:
    Walk(const DriverLine& line, std::size_t from) : line_(line), at_(from) {}
    bool next() {
        if (!line_.closed && at_ + 1 >= line_.points.size()) return false;
        const DVec3 before = point();
        at_ = (at_ + 1) % line_.points.size();
        walked_ += flatDistance(point(), before);
        return true;
    }
    const DVec3& point() const { return line_.points[at_]; }
    float walked() const { return walked_; }
    /// 1/m, of the circle through this point and those before and after it.
    float curvature() const {
        const std::size_t n = line_.points.size();
        if (!line_.closed && (at_ == 0 || at_ + 1 >= n)) return 0;
        const DVec3 &a = line_.points[(at_ + n - 1) % n], &b = point(), &c = line_.points[(at_ + 1) % n];
        const Vec3 ab = relative(b, a), bc = relative(c, b);
        const float product = flatDistance(a, b) * flatDistance(b, c) * flatDistance(a, c);
        return product > 0 ? 2 * std::abs(ab.x * bc.z - ab.z * bc.x) / product : 0;
    }

private:
    const DriverLine& line_;
    std::size_t at_;
    float walked_ = 0;
};

/// The speed from which the bends ahead can be met with the brakes.
float speedFor(const DriverLine& line, std::size_t here, float wanted) {
    float most = wanted;
    Walk ahead(line, here);
    bool goesOn = true;
    while (goesOn && ahead.walked() < kSight) {
        const float inBend = kCornering / std::max(ahead.curvature(), 1e-6f);  // v² there
        most = std::min(most, std::sqrt(inBend + 2 * kBraking * ahead.walked()));
        goesOn = ahead.next();
    }
    return goesOn ? most : std::min(most, std::sqrt(2 * kBraking * ahead.walked()));
}

constexpr double kSpacing = 2;  ///< m, at most, between points of a smooth line

/// Between b and c.
DVec3 between(const DVec3& a, const DVec3& b, const DVec3& c, const DVec3& d, double t) {
    const DVec3 linear = c - a, square = 2 * a - 5 * b + 4 * c - d, cube = 3 * (b - c) + (d - a);
    return b + 0.5 * (t * linear + (t * t) * square + (t * t * t) * cube);
}

/// Where on the way from a to b, seen from above, a place is nearest: 0 to 1.
float shareBetween(const DVec3& a, const DVec3& b, const DVec3& place) {
    const Vec3 way = relative(b, a), to = relative(place, a);
    const float square = way.x * way.x + way.z * way.z;
    return square > 0 ? std::clamp((to.x * way.x + to.z * way.z) / square, 0.0f, 1.0f) : 0;
}

}  // namespace

std::vector<DVec3> smoothLine(std::span<const DVec3> through, bool closed) {
    const auto count = static_cast<int>(through.size());
    const auto point = [&](int i) {
        const int inside = closed ? (i + count) % count : std::min(std::max(i, 0), count - 1);
        return through[static_cast<std::size_t>(inside)];
    };
    std::vector<DVec3> line;
    const int spans = closed ? count : count - 1;
    for (int i = 0; i < spans; ++i) {
        const DVec3 chord = point(i + 1) - point(i);
        const double length = std::sqrt(chord.x * chord.x + chord.y * chord.y + chord.z * chord.z);
        const int steps = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
        for (int k = 0; k < steps; ++k)
            line.push_back(between(point(i - 1), point(i), point(i + 1), point(i + 2), static_cast<double>(k) / steps));
    }
    if (!closed) line.push_back(point(count - 1));
    return line;
}

LinePlace placeAt(const DriverLine& line, const DVec3& place) {
    LinePlace found;
    float nearest = std::numeric_limits<float>::infinity();
    const std::size_t count = line.points.size();
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < count; ++i) {
        const DVec3 &a = line.points[i], &b = line.points[(i + 1) % count];
        const float share = shareBetween(a, b, place), span = flatDistance(a, b);
        const DVec3 foot = a + static_cast<double>(share) * (b - a);
        if (const float away = flatDistance(place, foot); away < nearest) {
            const Vec3 way = relative(b, a), to = relative(place, a);
            nearest = away;
            found.along = found.length + share * span;
            found.aside = way.z * to.x - way.x * to.z > 0 ? away : -away;
        }
        found.length += span;
    }
    return found;
}

float wheelbase(const VehicleDef& def) {
    float front = def.wheels[0].position.z, rear = front;
    for (const WheelDef& wheel : def.wheels) {
        front = std::max(front, wheel.position.z);
        rear = std::min(rear, wheel.position.z);
    }
    return front - rear;
}

float steerFor(const SteeringDef& steering, float angle, float speed) {
    float most = steering.maxAngle;
    if (steering.halfAngleSpeed) {
        const float share = speed / *steering.halfAngleSpeed;
        most /= 1 + share * share;
    }
    return most > 0 ? std::clamp(-angle / most, -1.0f, 1.0f) : 0;
}

VehicleInput followLine(const DriverLine& line, const Vehicle& car, const Pose& chassis, float speed) {
    std::size_t here = 0;
    for (std::size_t i = 0; i < line.points.size(); ++i) {
        if (flatDistance(line.points[i], chassis.position) < flatDistance(line.points[here], chassis.position))
            here = i;
    }
    const float now = car.telemetry().speed;
    Walk aim(line, here);
    const float ahead = kAheadLeast + kAheadTime * std::max(now, 0.0f);
    while (flatDistance(aim.point(), chassis.position) < ahead && aim.next()) {
    }
    const Vec3 target = inverseTransformPoint(chassis, aim.point());
    const float squared = target.x * target.x + target.z * target.z;

    VehicleInput input;
    const float curvature = squared > 0 ? 2 * target.x / squared : 0;  // positive to the left
    input.steer = steerFor(car.def().steering, arcTan2(curvature * wheelbase(car.def()), 1), now);
    const float wanted = speedFor(line, here, speed);
    input.throttle = std::clamp(0.15f + 0.4f * (wanted - now), 0.0f, 1.0f);
    input.brake = std::clamp(0.3f * (now - wanted) - 0.1f, 0.0f, 1.0f);
    return input;
}

}  // namespace ragtop
