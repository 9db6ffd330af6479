#include "brakes.h"

#include "point_body.h"

namespace ragtop {

float brakeCapacity(const WheelDef& wheel, float pedal, float handbrake, float resistance) {
    return pedal * wheel.brakeTorque + handbrake * wheel.handbrakeTorque + resistance;
}

float solveBrake(float inertia, float held, float bound, float still, float& impulse, float& spin) {
    const float added = addBounded(impulse, (still - spin) * held, -bound, bound);
    spin += added / inertia;
    return added;
}

}  // namespace ragtop
