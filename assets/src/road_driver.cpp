#include "road_driver.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr float kAheadTime = 0.6f, kAheadLeast = 4;  ///< s, m: how far ahead of the car the driver aims
constexpr float kCornering = 4, kBraking = 3;        ///< m/s² that the driver dares
constexpr float kSight = 60;                         ///< m of road that are looked at

float flatDistance(const DVec3& a, const DVec3& b) {
    const Vec3 d = relative(a, b);
    return std::sqrt(d.x * d.x + d.z * d.z);
}

/// Walks along the line of a road; ends at its end, or never where it is closed.
class Walk {
public:
    Walk(const SceneRoad& road, std::size_t from) : road_(road), at_(from) {}
    bool next() {
        if (!road_.closed && at_ + 1 >= road_.line.size()) return false;
        const DVec3 before = point();
        at_ = (at_ + 1) % road_.line.size();
        walked_ += flatDistance(point(), before);
        return true;
    }
    const DVec3& point() const { return road_.line[at_]; }
    float walked() const { return walked_; }
    /// 1/m, of the circle through this point and those before and after it.
    float curvature() const {
        const std::size_t n = road_.line.size();
        if (!road_.closed && (at_ == 0 || at_ + 1 >= n)) return 0;
        const DVec3 &a = road_.line[(at_ + n - 1) % n], &b = point(), &c = road_.line[(at_ + 1) % n];
        const Vec3 ab = relative(b, a), bc = relative(c, b);
        const float product = flatDistance(a, b) * flatDistance(b, c) * flatDistance(a, c);
        return product > 0 ? 2 * std::abs(ab.x * bc.z - ab.z * bc.x) / product : 0;
    }

private:
    const SceneRoad& road_;
    std::size_t at_;
    float walked_ = 0;
};

/// The speed from which the bends ahead can be met with the brakes.
float speedFor(const SceneRoad& road, std::size_t here, float wanted) {
    float most = wanted;
    Walk ahead(road, here);
    bool goesOn = true;
    while (goesOn && ahead.walked() < kSight) {
        const float inBend = kCornering / std::max(ahead.curvature(), 1e-6f);  // v² there
        most = std::min(most, std::sqrt(inBend + 2 * kBraking * ahead.walked()));
        goesOn = ahead.next();
    }
    return goesOn ? most : std::min(most, std::sqrt(2 * kBraking * ahead.walked()));
}

}  // namespace

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

VehicleInput followRoad(const SceneRoad& road, const Vehicle& car, const Pose& chassis, float speed) {
    std::size_t here = 0;
    for (std::size_t i = 0; i < road.line.size(); ++i) {
        if (flatDistance(road.line[i], chassis.position) < flatDistance(road.line[here], chassis.position)) here = i;
    }
    const float now = car.telemetry().speed;
    Walk aim(road, here);
    const float ahead = kAheadLeast + kAheadTime * std::max(now, 0.0f);
    while (flatDistance(aim.point(), chassis.position) < ahead && aim.next()) {
    }
    const Vec3 target = inverseTransformPoint(chassis, aim.point());
    const float squared = target.x * target.x + target.z * target.z;

    VehicleInput input;
    const float curvature = squared > 0 ? 2 * target.x / squared : 0;  // positive to the left
    input.steer = steerFor(car.def().steering, arcTan2(curvature * wheelbase(car.def()), 1), now);
    const float wanted = speedFor(road, here, speed);
    input.throttle = std::clamp(0.15f + 0.4f * (wanted - now), 0.0f, 1.0f);
    input.brake = std::clamp(0.3f * (now - wanted) - 0.1f, 0.0f, 1.0f);
    return input;
}

}  // namespace ragtop
