#pragma once

#include <array>
#include <span>
#include <vector>

#include "ragtop/math.h"

namespace ragtop {

/// Where points of a foot are at even times, m, y up.
struct FootWay {
    std::vector<Vec3> heel{}, ball{}, tip{};
};

/// When a foot stands.
struct Stances {
    struct Stance {
        int first = 0, last = 0;  ///< moments, both within it
    };
    std::vector<bool> heel{}, ball{};  ///< per moment: that point stands
    std::vector<Stance> all{};
};

/// What is near the ground and slow stands. `height`: m, of the body's hips, by which both are measured.
Stances stancesOf(const FootWay& way, float ground, float height, float rate);

/// What to add to the foot's place at each moment for what stands to stay on one spot at the height of the ground:
/// within a stance against each movement of what stands, about nothing in the mean; from one stance to the next
/// smoothly. Nothing goes below the ground.
std::vector<Vec3> heldOffsets(const FootWay& way, const Stances& stances, float ground, float height, float rate);

/// The lowest point of both feet at each moment, m.
std::vector<float> lowest(const std::array<FootWay, 2>& ways);
/// How the ground moves below who walks on the spot, m/s: as what is lowest does at most moments; zero where that
/// stands.
Vec3 groundVelocity(const std::array<FootWay, 2>& ways, float height, float rate);
/// A way as seen from ground that moves so.
FootWay onGround(FootWay way, const Vec3& velocity, float rate);

/// The least curve over `wanted` that a window of that many moments to either side leaves smooth.
std::vector<float> smoothAbove(std::span<const float> wanted, int window);
/// The mean over a window, weighted to its middle.
std::vector<float> smoothed(std::span<const float> values, int window);

}  // namespace ragtop
