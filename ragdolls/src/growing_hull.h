#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ragtop/math.h"

namespace ragtop {

/// n · x ≤ offset within, n unit and outwards.
struct FacePlane {
    Vec3 normal{};
    float offset = 0;  ///< m
};

/// The hull of a few of many points, of which the farthest outside is added each time [Barber, Dobkin, Huhdanpaa, The
/// Quickhull Algorithm for Convex Hulls, 1996, which this leaves early].
class GrowingHull {
public:
    /// Begins with four points that are far apart. The points have to live as long.
    explicit GrowingHull(std::span<const Vec3> points);

    /// Do the points lie in a plane, by a thousandth of their extent? Nothing can be added then.
    bool isFlat() const { return faces_.empty(); }
    /// Adds until no point is outside, or it has `most` corners.
    void grow(std::size_t most);

    /// In the order in which they were added.
    std::vector<Vec3> corners() const;
    std::vector<FacePlane> planes() const;
    float volume() const;  ///< m³

private:
    struct Face {
        std::array<std::uint32_t, 3> corner{};  ///< counter-clockwise from outside
        FacePlane plane{};
        std::vector<std::uint32_t> outside{};  ///< points over this, and of others none that have been there before
        std::uint32_t farthest = 0;            ///< of these
        float height = 0;                      ///< m, of that
    };

    bool makeFace(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::vector<Face>& into) const;
    void share(std::span<const std::uint32_t> points, std::size_t first);
    bool put(std::uint32_t point, Face& face) const;
    bool add(std::uint32_t point);
    bool addSeeing(std::uint32_t point, float least);
    void leaveOut(Face& face);

    std::span<const Vec3> points_;
    Vec3 middle_{};
    float slack_ = 0;
    std::vector<std::uint32_t> corners_;
    std::vector<Face> faces_;
    // Of adding a point, kept for their memory.
    std::vector<char> seen_;
    std::vector<std::uint64_t> edges_;
    std::vector<Face> cone_;
    std::vector<std::uint32_t> orphans_;
};

}  // namespace ragtop
