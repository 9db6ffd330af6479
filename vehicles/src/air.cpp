#include "air.h"

#include <algorithm>
#include <cmath>

namespace ragtop {

std::vector<LiftPoint> liftPoints(const VehicleDef& def, const Vec3& centerOfMass) {
    std::vector<LiftPoint> points{{def.aerodynamics.center, def.aerodynamics.liftArea}};
    for (const AxleLiftDef& lift : def.aerodynamics.axleLifts) {
        Vec3 sum;
        float count = 0;
        for (const WheelDef& wheel : def.wheels) {
            if (wheel.axle != lift.axle) continue;
            sum += wheel.position;
            count += 1;
        }
        points.push_back({(1 / count) * sum - centerOfMass, lift.liftArea, lift.liftArea, lift.perHeight, lift.axle});
    }
    return points;
}

AirImpulse airImpulse(const AerodynamicsDef& air, std::span<const LiftPoint> lifts, const AirMotion& motion, float h) {
    constexpr float kMostTurn = 1e6f;
    const float speed = length(motion.velocity);
    if (!(speed > 0)) return {};
    const float pressure = 0.5f * air.airDensity * speed * h;
    const Vec3 up = rotate(motion.rotation, {0, 1, 0}), left = rotate(motion.rotation, {1, 0, 0});
    const Vec3 along = (1 / speed) * motion.velocity;
    const float drift = dot(motion.velocity, left);

    const float drag = pressure * air.dragArea, side = pressure * air.sideArea;
    const Vec3 against = (-drag / (1 + drag * motion.inverseMass)) * motion.velocity -
                         (side / (1 + side * motion.inverseMass) * drift) * left;
    AirImpulse impulse{against, cross(rotate(motion.rotation, air.center), against)};

    float a = 0;
    for (const LiftPoint& lift : lifts) a += pressure * lift.area * motion.inverseMass;
    a = std::clamp(a, -kMostTurn, kMostTurn);
    const float longer = 2 * dot(along, up) + a, turned = std::sqrt(std::max(1 + a * longer, 0.0f));
    const Vec3 each =
        turned > 0 ? speed / (turned * motion.inverseMass) * (up - longer / (1 + turned) * along) : Vec3{};
    for (const LiftPoint& lift : lifts) {
        const Vec3 part = std::clamp(pressure * lift.area * motion.inverseMass, -kMostTurn, kMostTurn) * each;
        impulse.linear += part;
        impulse.angular += cross(rotate(motion.rotation, lift.arm), part);
    }
    impulse.angular += (pressure * air.yawVolume * drift) * up;
    return impulse;
}

}  // namespace ragtop
