#pragma once

#include <cstdint>
#include <vector>

#include "cast.h"
#include "frame_encoder.h"
#include "json.h"

namespace ragtop::live {

/// The cloths of a cast as pages draw them.
class Draped {
public:
    /// Points are told relative to `origin`.
    Draped(const Cast& cast, const DVec3& origin);

    /// All cloths with their points as they are now.
    Json describe() const;
    /// Takes up where all points are after a step.
    void update(std::uint32_t step);
    /// Number of the latest update that moved a point.
    std::uint32_t sequence() const { return sequence_; }
    /// The points after that; null where there are no cloths.
    const FrameBytes& frame() const { return frame_; }

private:
    void readPoints(std::vector<Vec3>& all) const;

    const Cast& cast_;
    DVec3 origin_;
    std::vector<Vec3> points_;  ///< of all cloths, one after the other
    std::uint32_t sequence_ = 0;
    FrameBytes frame_;
};

}  // namespace ragtop::live
