#pragma once

#include <vector>

#include "solids/cut_solid.h"
#include "solids/point_hull.h"
#include "solids/surface_tree.h"

namespace ragtop {

/// The air around a solid, to measure what hulls fill of it: rays from points of its surface, outwards. Where parts of
/// the solid overlap there is none.
class Air {
public:
    explicit Air(const CutSolid& solid);

    /// How far from the solid the farthest air inside of the hull is, of what the rays see; above `enough` any such.
    double depthIn(const PointHull& hull, double enough) const;

    /// A number that no fewer convex pieces can hold the solid with, without air farther from it than the error: of
    /// points of the surface no two of which see each other but through such air. Ends above `most`.
    std::size_t fewestPieces(double error, std::size_t most) const;

private:
    struct Ray {
        DVec3 from, direction;
        double length = 0;  ///< to the next surface
        bool open = true;   ///< meets none
    };
    void add(const DVec3& from, const DVec3& direction);
    std::size_t countApart(std::vector<const Ray*> rest, const Ray& first, double error, std::size_t most,
                           int& effort) const;
    bool leadsThroughAir(const Ray& from, const DVec3& to, double error, int& effort) const;

    SurfaceTree surface_;
    std::vector<Ray> rays_;
};

}  // namespace ragtop
