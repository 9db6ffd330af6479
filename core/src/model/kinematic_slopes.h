#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "model/bodies.h"

namespace ragtop {

/// A kinematic body that has been given other velocities of late.
struct KinematicSlope {
    std::uint32_t body = 0, generation = 0;
    float dt = 0;                            ///< s, of the last step
    Vec3 v, w;                               ///< m/s, rad/s, means of that step
    Vec3 acceleration, angularAcceleration;  ///< m/s², rad/s², of those against the means of the step before
};

/// How kinematic bodies speed up within a step.
///
/// A caller gives the mean velocity of each step. A body that kept it for the whole step would jump between steps: what
/// stands on it meets all of a step's change in the first of n substeps, n times the force, and slips or falls though
/// friction would carry it. So the velocity is linear within a step, about the mean that was given,
///     v(t) = v̄ + s a (t − ½ dt),   a = Δv̄/dt,   s = clamp(a_last · a / |a|², 0, 1),
/// with the slope that two changes have in common: a min-mod limiter for vectors [van Leer, Towards the ultimate
/// conservative difference scheme V, 1979], as positions have it (docs/adr/0004). The body ends each step where the
/// mean takes it; even acceleration has no jumps, and a start from rest to full speed no overshoot.
class KinematicSlopes {
public:
    explicit KinematicSlopes(std::pmr::memory_resource* memory) : slopes_(memory) {}

    /// Before a caller gives a body another velocity than that of the last step, of `lastStep` seconds.
    void record(const Bodies& bodies, std::uint32_t body, float lastStep);
    /// What a caller gives within a step counts at once, and for the rest of it.
    void replace(Bodies& bodies, std::uint32_t body, const Vec3& v, const Vec3& w);
    /// Gives bodies the velocity that a step of dt seconds begins with, and the acceleration that it goes on with in
    /// place of a force, until the next `end`.
    void begin(Bodies& bodies, float dt, int substeps);
    /// Gives them the mean again.
    void end(Bodies& bodies) const;

    template <class Archive>
    void archive(Archive& archive) {
        archive(slopes_);
    }

private:
    std::size_t placeOf(std::uint32_t body) const;
    bool holds(std::size_t place, std::uint32_t body) const;

    AlignedArray<KinematicSlope> slopes_;  ///< in the order of bodies
};

}  // namespace ragtop
