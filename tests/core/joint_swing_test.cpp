#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "constraints/joint_swing.h"
#include "joint_rig.h"

// Limits of the swing against brute force over their edges.
namespace ragtop::test {
namespace {

constexpr double kSwingDegree = 3.14159265358979323846 / 180;

struct Directions {
    std::mt19937 engine{11};
    Vec3 next() {
        std::normal_distribution<float> normal;
        return normalized(Vec3{normal(engine), normal(engine), normal(engine)});
    }
};

double nearest(const std::vector<Vec3>& edge, const Vec3& d) {
    float least = 9;
    for (const Vec3& e : edge) least = std::min(least, lengthSquared(e - d));
    return 2 * std::asin(0.5 * std::sqrt(static_cast<double>(least)));
}

/// The margin's axis must turn d the way that widens it.
void expectTurnsInwards(const SwingLimit& limit, const Vec3& d, const SwingMargin& side) {
    const float step = 0.02f;
    SwingMargin after[SwingLimit::kSides];
    swingMargins(limit, rotate(rotationAbout(side.axis, step), d), after);
    EXPECT_GT(after[0].margin, side.margin + 0.5f * step) << d.x << " " << d.y << " " << d.z;
}

TEST(SwingLimit, EllipseIsWithinATenthOfADegreeOfBruteForce) {
    for (const auto& [y, z] : {std::pair{0.3f, 1.2f}, {1.2f, 0.3f}, {0.9f, 1.0f}, {2.2f, 0.6f}, {0.2f, 0.25f}}) {
        SwingLimit limit;
        limit.shape = SwingShape::ellipse;
        limit.y = y, limit.z = z;
        std::vector<Vec3> edge;
        for (int i = 0; i < 4000; ++i) {
            const double phi = 2 * 3.14159265358979323846 * i / 4000;
            edge.push_back(
                directionOfSwing(y * static_cast<float>(std::cos(phi)), z * static_cast<float>(std::sin(phi))));
        }
        Directions directions;
        int wrong = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3 d = directions.next();
            SwingMargin sides[SwingLimit::kSides];
            swingMargins(limit, d, sides);
            const double across = std::sqrt(static_cast<double>(d.y * d.y + d.z * d.z));
            const double angle = std::atan2(across, static_cast<double>(d.x));
            const double sy = -angle * static_cast<double>(d.z) / across / static_cast<double>(y),
                         sz = angle * static_cast<double>(d.y) / across / static_cast<double>(z);
            const double exact = (sy * sy + sz * sz <= 1 ? 1 : -1) * nearest(edge, d);
            if (std::abs(static_cast<double>(sides[0].margin) - exact) > 0.1 * kSwingDegree) {
                if (++wrong <= 3)
                    ADD_FAILURE() << y << " " << z << " at " << d.x << " " << d.y << " " << d.z << ": "
                                  << sides[0].margin << " for " << exact;
            } else if (std::abs(exact) < 0.3 && std::abs(exact) > 0.03 &&
                       std::abs(exact) < 0.3 * static_cast<double>(std::min(y, z) * std::min(y, z) / std::max(y, z))) {
                expectTurnsInwards(limit, d, sides[0]);
            }
        }
        EXPECT_EQ(wrong, 0);
    }
}

SwingMargin marginOf(float y, float z, const Vec3& d) {
    SwingLimit limit;
    limit.shape = SwingShape::ellipse;
    limit.y = y, limit.z = z;
    SwingMargin sides[SwingLimit::kSides];
    swingMargins(limit, d, sides);
    return sides[0];
}

/// Of a swing along the short half axis the end of that axis is nearest, and of one beyond the long axis its end.
TEST(SwingLimit, EllipseIsExactOnItsHalfAxes) {
    for (const auto& [y, z] : {std::pair{0.3f, 1.2f}, {0.9f, 1.0f}, {0.05f, 1.5f}, {0.001f, 0.002f}, {1, 1.0001f}})
        for (const float sign : {-1.0f, 1.0f}) {
            EXPECT_NEAR(marginOf(y, z, {1, 0, 0}).margin, y, 2e-6f) << y << " " << z;
            for (const float share : {0.1f, 0.9f, 0.999f, 1.001f, 1.5f}) {
                const SwingMargin across = marginOf(y, z, directionOfSwing(sign * share * y, 0));
                EXPECT_NEAR(across.margin, y - share * y, 2e-6f) << y << " " << z << " " << share;
                EXPECT_NEAR(across.axis.y, -sign, 1e-3f) << y << " " << z << " " << share;
                if (share < 1) continue;
                const SwingMargin along = marginOf(y, z, directionOfSwing(0, sign * share * z));
                EXPECT_NEAR(along.margin, z - share * z, 2e-6f) << y << " " << z << " " << share;
                EXPECT_NEAR(along.axis.z, -sign, 1e-3f) << y << " " << z << " " << share;
            }
        }
}

/// Opposite to x as well, and as slender as may be.
TEST(SwingLimit, EllipseHasAMarginAnywhere) {
    Directions directions;
    for (const auto& [y, z] : {std::pair{0.001f, 3.1f}, {3.1f, 0.001f}, {0.001f, 0.001001f}, {3.1f, 3}})
        for (int i = 0; i < 1000; ++i) {
            const Vec3 d = i == 0 ? Vec3{-1, 0, 0} : i == 1 ? Vec3{0, 1, 0} : directions.next();
            const SwingMargin side = marginOf(y, z, d);
            EXPECT_TRUE(std::abs(side.margin) <= kPi) << d.x << " " << d.y << " " << d.z;
            EXPECT_NEAR(length(side.axis), 1, 1e-3f) << d.x << " " << d.y << " " << d.z;
        }
}

ReachPolygon polygonOf(const std::vector<Vec3>& corners) {
    ReachPolygon polygon;
    polygon.count = static_cast<int>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) polygon.corners[i].direction = corners[i];
    return polygon;
}
/// Corners at angles about x and from x, degrees.
ReachPolygon aroundX(const std::vector<std::pair<double, double>>& corners) {
    std::vector<Vec3> directions;
    for (const auto& [about, from] : corners) {
        const double a = about * kSwingDegree, f = from * kSwingDegree;
        directions.push_back(toVec3(DVec3{std::cos(f), std::sin(f) * std::cos(a), std::sin(f) * std::sin(a)}));
    }
    return polygonOf(directions);
}

/// Inside by the sum of the angles at which edges are seen from d, in its tangent plane.
bool isInside(const std::vector<Vec3>& edge, const Vec3& d, const Vec3& outside) {
    // The great arc from d to a place outside crosses the edge an odd number of times.
    int crossings = 0;
    const Vec3 n = cross(d, outside);
    for (std::size_t i = 0; i < edge.size(); ++i) {
        const Vec3 &a = edge[i], &b = edge[(i + 1) % edge.size()];
        const Vec3 m = cross(a, b);
        if (dot(n, a) * dot(n, b) >= 0 || dot(m, d) * dot(m, outside) >= 0) continue;
        const Vec3 line = cross(n, m);
        const Vec3 at = dot(line, a) > 0 ? line : -line;
        if (dot(cross(d, at), n) > 0 && dot(cross(at, outside), n) > 0) ++crossings;
    }
    return crossings % 2 == 1;
}

TEST(SwingLimit, ReachPolygonIsWithinATenthOfADegreeOfBruteForce) {
    const ReachPolygon polygons[] = {
        aroundX({{0, 40}, {90, 60}, {180, 30}, {270, 50}}),
        // Concave.
        aroundX({{0, 70}, {45, 20}, {90, 80}, {150, 60}, {180, 25}, {225, 70}, {290, 40}}),
        // Larger than a hemisphere.
        aroundX({{0, 130}, {70, 150}, {140, 120}, {210, 160}, {280, 110}}),
    };
    for (const ReachPolygon& polygon : polygons) {
        ASSERT_EQ(whyInvalidReach(polygon), "");
        SwingLimit limit;
        compile(limit, polygon);
        std::vector<Vec3> edge;
        constexpr int kPerEdge = 1500;
        for (std::uint32_t i = 0; i < limit.corners; ++i)
            for (int k = 0; k < kPerEdge; ++k) {
                const float share = static_cast<float>(k) / kPerEdge;
                edge.push_back(
                    normalized((1 - share) * limit.corner[i] + share * limit.corner[(i + 1) % limit.corners]));
            }
        std::vector<Vec3> corners(limit.corner, limit.corner + limit.corners);
        Directions directions;
        int wrong = 0;
        for (int i = 0; i < 3000; ++i) {
            const Vec3 d = directions.next();
            SwingMargin sides[SwingLimit::kSides];
            swingMargins(limit, d, sides);
            const double exact = (isInside(corners, d, {-1, 1e-3f, 2e-3f}) ? 1 : -1) * nearest(edge, d);
            if (std::abs(static_cast<double>(sides[0].margin) - exact) > 0.1 * kSwingDegree && ++wrong <= 3)
                ADD_FAILURE() << polygon.count << " corners at " << d.x << " " << d.y << " " << d.z << ": "
                              << sides[0].margin << " for " << exact;
            if (std::abs(exact) > 0.03 && std::abs(exact) < 0.1 && sides[1].margin > 0.2f)
                expectTurnsInwards(limit, d, sides[0]);
        }
        EXPECT_EQ(wrong, 0);
    }
}

TEST(SwingLimit, TwistRangeIsThatOfEachCorner) {
    ReachPolygon polygon = aroundX({{0, 40}, {120, 60}, {240, 30}});
    polygon.corners[0].twist = {-1, 1};
    polygon.corners[1].twist = {-2, 0.5f};
    polygon.corners[2].twist = {-0.5f, 2};
    SwingLimit limit;
    compile(limit, polygon);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const Range range = twistAt(limit, limit.corner[i]);
        EXPECT_NEAR(range.lower, limit.twist[i].lower, 1e-3);
        EXPECT_NEAR(range.upper, limit.twist[i].upper, 1e-3);
    }
    const Range middle = twistAt(limit, {1, 0, 0});
    EXPECT_GT(middle.lower, -2);
    EXPECT_LT(middle.upper, 2);
}

/// A twist limit whose ends change with the swing pushes along their slope, or swinging would carry it beyond them.
TEST(SwingLimit, TwistEndsGrowAsTheirTiltSays) {
    ReachPolygon polygon = aroundX({{0, 40}, {90, 60}, {180, 30}, {270, 50}});
    const Range twists[] = {{-1, 1}, {-2, 0.5f}, {-0.5f, 2}, {-1, 0.2f}};
    for (std::size_t i = 0; i < 4; ++i) polygon.corners[i].twist = twists[i];
    SwingLimit limit;
    compile(limit, polygon);
    Directions directions;
    for (int i = 0; i < 500; ++i) {
        const Vec3 d = directions.next(), w = directions.next();
        constexpr float kStep = 2e-3f;
        const Range range = twistAt(limit, d), before = twistAt(limit, rotate(rotationAbout(w, -kStep), d)),
                    after = twistAt(limit, rotate(rotationAbout(w, kStep), d));
        const TwistTilt tilt = twistTiltAt(limit, d, range);
        // Central differences leave steps² times a third derivative, of some 3/distance³ to the nearest corner.
        EXPECT_NEAR(dot(w, tilt.lower), (after.lower - before.lower) / (2 * kStep), 0.01f * (1 + length(tilt.lower)));
        EXPECT_NEAR(dot(w, tilt.upper), (after.upper - before.upper) / (2 * kStep), 0.01f * (1 + length(tilt.upper)));
    }
}

TEST(SwingLimit, SaysWhatIsWrongWithAPolygon) {
    EXPECT_NE(whyInvalidReach(polygonOf({{1, 0, 0}, {0, 1, 0}})), "");
    EXPECT_NE(whyInvalidReach(polygonOf({{1, 0, 0}, {0, 0, 0}, {0, 0, 1}})).find("corners[1].direction is zero"),
              std::string::npos);
    EXPECT_NE(whyInvalidReach(polygonOf({{1, 0, 0}, {2, 0, 0}, {0, 0, 1}})).find("corners[1]"), std::string::npos);
    // A bow tie.
    EXPECT_NE(whyInvalidReach(aroundX({{0, 40}, {180, 40}, {90, 40}, {270, 40}})).find("cross"), std::string::npos);
}

}  // namespace
}  // namespace ragtop::test
