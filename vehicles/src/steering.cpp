#include "steering.h"

#include "point_body.h"

namespace ragtop {

float steeredAngle(const SteeringDef& def, float angle, float input, float speed, float dt) {
    float most = def.maxAngle;
    if (def.halfAngleSpeed) {
        const float share = speed / *def.halfAngleSpeed;
        most /= 1 + share * share;
    }
    const float wanted = -input * most;
    const float change = def.rate * dt;
    return angle + clampTo(wanted - angle, -change, change);
}

Vec3 wheelDirection(const SteeringDef& def, float steerFactor, const Vec3& position, float angle) {
    const SinCos middle = sinCos(steerFactor * angle);
    const Vec3 same{middle.sin, 0, middle.cos};
    if (middle.sin == 0 || position.z == 0) return same;
    const Vec3 about = normalized(Vec3{middle.sin, 0, middle.cos - position.x / position.z * middle.sin}, same);
    return normalized(same + def.ackermann * (about - same), same);
}

}  // namespace ragtop
