#pragma once

#include <vector>

#include "solids/cut_solid.h"
#include "solids/point_hull.h"
#include "solids/surface_tree.h"

namespace ragtop {

/// The air around a solid, to measure what hulls fill of it: rays from points of its surface, outwards.
class Air {
public:
    explicit Air(const CutSolid& solid);

    /// How far from the solid the farthest air inside of the hull is, of what the rays see; above `enough` any such.
    double depthIn(const PointHull& hull, double enough) const;

private:
    struct Ray {
        DVec3 from, direction;
        double length = 0;  ///< to the next surface
        bool open = true;   ///< meets none
    };
    void add(const DVec3& from, const DVec3& direction);

    SurfaceTree surface_;
    std::vector<Ray> rays_;
};

}  // namespace ragtop
