#pragma once

#include <array>
#include <vector>

#include "solids/cut_solid.h"

/// What the functions of cut_solid.h share.
namespace ragtop {

/// Zero for what lies on the plane.
std::vector<double> heightsAbove(const std::vector<DVec3>& points, const DPlane& plane);

/// Where an edge meets the plane: the same bits whichever way it runs.
inline DVec3 crossing(const DVec3& a, double ha, const DVec3& b, double hb) {
    if (ha > hb) return crossing(b, hb, a, ha);
    return a + (ha / (ha - hb)) * (b - a);
}

/// Is a triangle, or a part of it, of the solid below? The solid is behind a triangle that lies in the plane.
bool isBelow(const CutSolid& solid, const Triangle& t, const std::vector<double>& heights, const DPlane& plane);
/// The same of a whole cap, where it lies in the plane.
bool isFlush(const Cap& cap, const std::vector<double>& heights);

/// Things that hang together, by numbers; and as well where bounds of their points overlap.
class Groups {
public:
    explicit Groups(std::size_t count);
    void join(std::uint32_t a, std::uint32_t b);
    void add(std::uint32_t of, const DVec3& point);  ///< to the bounds
    void joinOverlapping();
    std::uint32_t of(std::uint32_t i);

private:
    struct Box {
        DVec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
    };
    std::vector<std::uint32_t> parent_;
    std::vector<Box> box_;
};

}  // namespace ragtop
