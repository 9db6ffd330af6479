#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "collide_support.h"
#include "narrowphase/reduce_points.h"

namespace ragtop {
namespace {

struct Corner {
    double x, y;
};

/// Keeps nx x + ny y ≤ offset.
std::vector<Corner> clipped(const std::vector<Corner>& in, double nx, double ny, double offset) {
    std::vector<Corner> out;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Corner a = in[i], b = in[(i + 1) % in.size()];
        const double ha = nx * a.x + ny * a.y - offset, hb = nx * b.x + ny * b.y - offset;
        if (ha <= 0) out.push_back(a);
        if (ha * hb >= 0) continue;
        const double t = ha / (ha - hb);
        out.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
    return out;
}

/// Where a rectangle covers another one that is turned and shifted against it at random: up to eight corners, in a
/// plane whose normal is y.
std::vector<ManifoldPoint> overlapOfRectangles(Random& random) {
    const auto side = [&] { return static_cast<double>(random.uniform(0.2f, 1)); };
    const double halfX = side(), halfY = side(), otherX = side(), otherY = side();
    const auto turn = static_cast<double>(random.uniform(0, kPi));
    const double shiftX = static_cast<double>(random.uniform(-1, 1)),
                 shiftY = static_cast<double>(random.uniform(-1, 1));
    const double c = std::cos(turn), s = std::sin(turn);
    std::vector<Corner> corners;
    for (const Corner e : {Corner{1, 1}, Corner{-1, 1}, Corner{-1, -1}, Corner{1, -1}})
        corners.push_back({shiftX + c * e.x * otherX - s * e.y * otherY, shiftY + s * e.x * otherX + c * e.y * otherY});
    corners = clipped(clipped(corners, 1, 0, halfX), -1, 0, halfX);
    corners = clipped(clipped(corners, 0, 1, halfY), 0, -1, halfY);
    std::vector<ManifoldPoint> points;
    for (const Corner& corner : corners) {
        ManifoldPoint point;
        point.position = {static_cast<float>(corner.x), 0, static_cast<float>(corner.y)};
        points.push_back(point);
    }
    return points;
}

/// How far the wrenches that points can exert, each by a unit force in a cone of friction, reach along a direction of
/// six: forces, then moments over the size of the manifold.
double reach(const std::vector<ManifoldPoint>& points, const Vec3& middle, float size, const std::array<double, 6>& d) {
    constexpr double kMu = 0.5;
    double most = 0;
    for (const ManifoldPoint& point : points) {
        const Vec3 arm = (1 / size) * (point.position - middle);
        const auto x = static_cast<double>(arm.x), z = static_cast<double>(arm.z);
        const double alongX = d[0] + d[4] * z, alongY = d[1] - d[3] * z + d[5] * x, alongZ = d[2] - d[4] * x;
        most = std::max(most, alongY + kMu * std::hypot(alongX, alongZ));
    }
    return most;
}

/// Directions of which none is preferred: a nearly normal distribution.
std::vector<std::array<double, 6>> directions(Random& random) {
    std::vector<std::array<double, 6>> all(400);
    for (std::array<double, 6>& direction : all)
        for (double& component : direction) {
            component = 0;
            for (int k = 0; k < 12; ++k) component += static_cast<double>(random.uniform(-0.5f, 0.5f));
        }
    return all;
}

/// Mean width of the set of wrenches of some points over that of all.
double keptWrenches(const std::vector<ManifoldPoint>& kept, const std::vector<ManifoldPoint>& all,
                    const std::vector<std::array<double, 6>>& along) {
    Vec3 middle;
    for (const ManifoldPoint& point : all) middle += (1 / static_cast<float>(all.size())) * point.position;
    float size = 0;
    for (const ManifoldPoint& point : all) size = std::max(size, length(point.position - middle));
    double some = 0, most = 0;
    for (const std::array<double, 6>& direction : along) {
        some += reach(kept, middle, size, direction);
        most += reach(all, middle, size, direction);
    }
    return some / most;
}

/// The same for the best four of them.
double bestFour(const std::vector<ManifoldPoint>& all, const std::vector<std::array<double, 6>>& along) {
    double best = 0;
    for (unsigned bits = 0; bits < 1u << all.size(); ++bits) {
        if (std::popcount(bits) != kMaxManifoldPoints) continue;
        std::vector<ManifoldPoint> four;
        for (std::size_t i = 0; i < all.size(); ++i)
            if ((bits >> i & 1u) != 0) four.push_back(all[i]);
        best = std::max(best, keptWrenches(four, all, along));
    }
    return best;
}

/// Of eight corners all alike no four reach more than 95 %: there the best four count.
TEST(ContactReduction, FourPointsReachTheWrenchesOfAll) {
    Random random(1);
    const auto along = directions(random);
    double mean = 0;
    constexpr int kTrials = 10000;
    for (int trial = 0; trial < kTrials;) {
        const std::vector<ManifoldPoint> all = overlapOfRectangles(random);
        if (all.size() < 3) continue;
        ++trial;
        std::vector<ManifoldPoint> kept = all;
        if (all.size() > kMaxManifoldPoints)
            kept.resize(
                static_cast<std::size_t>(reducePoints(kept.data(), static_cast<int>(kept.size()), {0, 1, 0}, 0.0f)));
        EXPECT_LE(kept.size(), std::size_t{kMaxManifoldPoints});
        const double share = keptWrenches(kept, all, along);
        mean += share / kTrials;
        if (share >= 0.95) continue;
        EXPECT_GE(share, bestFour(all, along) - 1e-3) << trial << ", of " << all.size() << " points";
    }
    EXPECT_GT(mean, 0.995);
}

/// The deepest point is kept, however little it widens the manifold.
TEST(ContactReduction, TheDeepestPointStays) {
    Random random(2);
    for (int trial = 0; trial < 1000;) {
        std::vector<ManifoldPoint> points = overlapOfRectangles(random);
        if (points.size() <= kMaxManifoldPoints) continue;
        ++trial;
        const std::size_t deepest = static_cast<std::size_t>(trial) % points.size();
        points[deepest].separation = -0.1f;
        const Vec3 place = points[deepest].position;
        reducePoints(points.data(), static_cast<int>(points.size()), {0, 1, 0}, 0.01f);
        EXPECT_EQ(points[0].position, place);
    }
}

}  // namespace
}  // namespace ragtop
