#include <memory>

#include "collide_support.h"
#include "shape_support.h"

/// Where contact points lie, of pairs that a machine draws: any two convex shapes, sizes to 1000:1, plates and needles
/// among them, aligned or not, from a gap to as deep as they are thick, and as they go on from there.
namespace ragtop {
namespace {

struct Drawn {
    ConvexView view;
    std::shared_ptr<const HullData> hull;  ///< that the view looks at
    float size = 0;                        ///< m, half of the least thickness
};

float between(Random& random, float low, float high) { return low * std::pow(high / low, random.uniform(0, 1)); }

Drawn ofPoints(const std::vector<Vec3>& points) {
    const auto hull = std::make_shared<const HullData>(ConvexHull(points).data());
    return {hullView(*hull), hull, hull->innerRadius};
}

Drawn drawShape(Random& random, float s) {
    std::vector<Vec3> points;
    switch (static_cast<int>(random.uniform(0, 4.999f))) {
        case 0:
            return {sphereView(s), nullptr, s};
        case 1: {
            const float radius = s * between(random, 0.1f, 0.9f);
            return {capsuleView(radius, s - radius), nullptr, radius};
        }
        case 2: {
            const Vec3 half = s * Vec3{between(random, 0.02f, 1), between(random, 0.02f, 1), between(random, 0.02f, 1)};
            return {boxView(half), nullptr, std::min({half.x, half.y, half.z})};
        }
        case 3:
            return ofPoints(randomPoints(random, 4 + static_cast<int>(random.uniform(0, 30)), s));
        default: {
            const int corners = 6 + static_cast<int>(random.uniform(0, 24));
            const float half = s * between(random, 0.03f, 3);
            for (int i = 0; i < 2 * corners; ++i) {
                const float angle = kPi * static_cast<float>(i) / static_cast<float>(corners);
                points.push_back({s * std::cos(angle), i % 2 == 0 ? half : -half, s * std::sin(angle)});
            }
            return ofPoints(points);
        }
    }
}

/// Any, or one that a scene has: aligned but for a little.
Quat drawRotation(Random& random) {
    if (random.uniform(0, 1) < 0.5f) return random.rotation();
    const float angle = between(random, 1e-7f, 0.1f);
    Quat q = rotationAbout(random.direction(), angle);
    for (int turns = static_cast<int>(random.uniform(0, 4)); turns > 0; --turns)
        q = q * rotationAbout(turns % 2 == 0 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}, kPi / 2);
    return q;
}

/// B beside A, moved along a line through A's middle, or past it, until it is as deep in A as asked.
Frame place(Random& random, const Drawn& a, const Drawn& b, float ratio) {
    Frame frame{{}, drawRotation(random)};
    const Vec3 way = random.direction();
    const Vec3 aside = random.uniform(0, 1) < 0.5f ? std::min(1.0f, ratio) * random.inBox(1) : Vec3{};
    float low = 0, high = 4 * (1 + ratio);
    for (int i = 0; i < 40; ++i) {
        const float middle = 0.5f * (low + high);
        frame.position = aside + middle * way;
        const Distance apart = distance(a.view, b.view, frame);
        (apart.coresOverlap || apart.distance <= 0 ? low : high) = middle;
    }
    const float size = std::min(a.size, b.size);
    const float depth = random.uniform(0, 1) < 0.5f ? between(random, 1e-4f, 3) : random.uniform(-0.02f, 1);
    frame.position = aside + (low - depth * size) * way;
    return frame;
}

float distanceTo(const ConvexView& shape, const Vec3& point) {
    return distance(shape, sphereView(0), {point, {}}).distance;
}

// A point that claims the separation s is half way between the surfaces, so no farther than |s|/2 from either shape.
// What tolerances of choices leave, 0.1 sizes, is ten times the largest of them. A point elsewhere turns bodies by an
// arm that is not there: a lever of 100 m on a crate that a wall was 100 m high beside.
TEST(ContactPoints, LieBetweenTheSurfacesOfBoth) {
    RAGTOP_NEEDS_HULLS();
    int points = 0;
    for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
        Random random(seed);
        const float ratio = between(random, 1e-3f, 1e3f), reach = 1 + ratio;
        const Drawn a = drawShape(random, 1), b = drawShape(random, ratio);
        const float size = std::min(a.size, b.size);
        Frame frame = place(random, a, b, ratio);
        const Vec3 step = 0.02f * size * random.direction(), axis = random.direction();
        const float turn = 0.02f * random.uniform(0, 1) * std::min(1.0f, size / reach);
        SeparationCache cache;
        for (int i = 0; i < 10; ++i) {
            Manifold m;
            collide(a.view, b.view, frame, 0.02f * size, cache, m);
            for (const ManifoldPoint& point : m.all()) {
                const float fromA = distanceTo(a.view, point.position);
                const float fromB = distanceTo(b.view, inverseRotate(frame.rotation, point.position - frame.position));
                EXPECT_LE(std::max(fromA, fromB), 0.5f * std::fabs(point.separation) + 0.1f * size + 2e-6f * reach)
                    << "draw " << seed << ", step " << i << ", separation " << point.separation << ", size " << size;
            }
            points += m.pointCount;
            frame.position = frame.position + step;
            frame.rotation = normalized(rotationAbout(axis, turn) * frame.rotation);
        }
    }
    EXPECT_GT(points, 40000);
}

}  // namespace
}  // namespace ragtop
