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

/// Which of the vertices of a solid a part of it has so far, and as which of its own.
class KeptVertices {
public:
    explicit KeptVertices(const CutSolid& solid) : from_(solid.vertices), name_(solid.vertices.size(), kNone) {}

    std::uint32_t of(std::uint32_t i, std::vector<DVec3>& kept) {
        if (name_[i] == kNone) {
            name_[i] = static_cast<std::uint32_t>(kept.size());
            kept.push_back(from_[i]);
        }
        return name_[i];
    }

private:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    const std::vector<DVec3>& from_;
    std::vector<std::uint32_t> name_;
};

/// Things that hang together, by numbers; and as well where bounds of their points overlap.
class Groups {
public:
    explicit Groups(std::size_t count);
    void join(std::uint32_t a, std::uint32_t b);
    void add(std::uint32_t of, const DVec3& point);  ///< to the bounds
    void joinOverlapping();
    std::uint32_t of(std::uint32_t i);

    struct Box {
        DVec3 middle() const { return 0.5 * (lower + upper); }
        bool holds(const Box& other) const {
            return lower.x <= other.lower.x && lower.y <= other.lower.y && lower.z <= other.lower.z &&
                   upper.x >= other.upper.x && upper.y >= other.upper.y && upper.z >= other.upper.z;
        }
        DVec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
    };
    const Box& boxOf(std::uint32_t i) { return box_[of(i)]; }

private:
    std::vector<std::uint32_t> parent_;
    std::vector<Box> box_;
};

}  // namespace ragtop
