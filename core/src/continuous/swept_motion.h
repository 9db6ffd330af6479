#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// `pose` in the frame of `from`, its rotation a unit quaternion.
inline Frame seenFrom(const Pose& from, const Pose& pose) {
    Frame frame = relative(from, pose);
    frame.rotation = normalized(frame.rotation);
    return frame;
}

/// From one frame to another along a line, turning at a constant rate over the shorter way.
class SweptMotion {
public:
    SweptMotion(const Frame& from, const Frame& to)
        : from_(from),
          way_(to.position - from.position),
          turn_(rotationVector(to.rotation * conjugate(from.rotation))),
          angle_(length(turn_)) {}

    Frame at(float share) const {
        Frame frame{from_.position + share * way_, from_.rotation};
        if (angle_ > 0) frame.rotation = normalized(rotationAbout(turn_, share * angle_) * from_.rotation);
        return frame;
    }

private:
    Frame from_;
    Vec3 way_, turn_;
    float angle_;
};

/// A pose and the motion ahead of it: a line, and a turn at a constant rate that may be of many revolutions.
struct SweptPath {
    Pose from;
    Vec3 way;   ///< m
    Vec3 turn;  ///< rad

    Pose at(float share) const {
        Pose pose{from.position + share * way, from.rotation};
        if (const float angle = length(turn); angle > 0)
            pose.rotation = normalized(rotationAbout(turn, share * angle) * from.rotation);
        return pose;
    }
};

}  // namespace ragtop
