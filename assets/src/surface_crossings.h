#pragma once

#include <optional>

#include "ragtop/world.h"

namespace ragtop {

/// Meshes and height fields of one body by themselves; rays meet them on the front alone.
class SurfaceCrossings {
public:
    void add(const Shape& surface, const Pose& pose);

    struct Behind {
        float depth = 0;       ///< m; zero for a point that is before the surfaces
        bool between = false;  ///< backs are above and below it
    };
    /// A point is behind where going up it comes to the back of a surface first, and going down not to a front first.
    Behind behind(const DVec3& point) const;

private:
    /// Heights of the first and the last front that a ray straight up or down meets.
    std::optional<double> firstFront(const DVec3& from, double height) const;
    std::optional<double> lastFront(DVec3 from, double height) const;

    World world_;
    std::optional<Bounds> bounds_;
};

}  // namespace ragtop
