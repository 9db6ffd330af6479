#include "brakes.h"

#include "point_body.h"

namespace ragtop {

float brakeCapacity(const WheelDef& wheel, float pedal, float handbrake, float load) {
    return pedal * wheel.brakeTorque + handbrake * wheel.handbrakeTorque +
           wheel.tire.rollingResistance * load * wheel.radius;
}

float solveBrake(float inertia, float bound, float& impulse, float& spin) {
    const float added = addBounded(impulse, -spin * inertia, -bound, bound);
    spin += added / inertia;
    return added;
}

}  // namespace ragtop
