#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "ragtop/hull_triangles.h"
#include "ragtop/world.h"

/// A fast body meets what its shape would meet, not what happens to lie nearest when the step begins.
namespace ragtop {
namespace {

/// One body on its way past a fixed obstacle, without gravity, friction or turns.
struct Flight {
    Shape shape, obstacle;
    Quat turn, obstacleTurn;
    Vec3 start, velocity;
    float seconds = 0;

    Vec3 velocityAfter(float rate) const {
        World world({.gravity = {}});
        const Material smooth{.friction = 0};
        world.create(BodyDef{.type = BodyType::fixed,
                             .shapes = {ShapeDef{.geometry = obstacle, .material = smooth}},
                             .pose = {{}, obstacleTurn}});
        BodyDef def{.shapes = {ShapeDef{.geometry = shape, .material = smooth}}};
        def.pose = {DVec3{start}, turn};
        def.linearVelocity = velocity;
        def.locks = {.rotationX = true, .rotationY = true, .rotationZ = true};
        def.allowSleep = false;
        const BodyId body = world.create(def);
        for (int i = 0; i < static_cast<int>(std::lround(seconds * rate)); ++i) world.step(1 / rate);
        return world.linearVelocity(body);
    }
};

constexpr int kMesh = 4;  ///< of an obstacle; the other kinds are 0 to 3

class Flights {
public:
    explicit Flights(unsigned seed) : random_(seed) {}

    Flight next(int kind, int obstacleKind) {
        const float size = between(0.2f, 1), obstacleSize = between(0.5f, 3);
        Flight f{shapeOf(kind, size), shapeOf(obstacleKind, obstacleSize), anyTurn(), anyTurn(), {}, {}, 0};
        const float speed = between(5, 60), far = 2.5f * obstacleSize + 2 * size + between(0, 1);
        const Vec3 way = rotate(anyTurn(), {1, 0, 0});
        f.start = 0.8f * obstacleSize * Vec3{between(-1, 1), between(-1, 1), between(-1, 1)} - far * way;
        f.velocity = speed * way;
        f.seconds = std::ceil(60 * far / speed) / 30;
        return f;
    }

private:
    float between(float low, float high) {
        return low + (high - low) * static_cast<float>(random_() >> 8) / 16777216.0f;
    }
    Quat anyTurn() { return normalized(Quat{between(-1, 1), between(-1, 1), between(-1, 1), between(0.1f, 1)}); }
    Shape shapeOf(int kind, float size) {
        if (kind == 0) return Sphere{between(0.5f, 1) * size};
        if (kind == 1) return Capsule{between(0.2f, 0.5f) * size, between(0.3f, 1) * size};
        if (kind == kMesh) return meshOf(size);
        if (kind == 2) return Box{size * Vec3{between(0.2f, 1), between(0.2f, 1), between(0.2f, 1)}};
        std::vector<Vec3> points;
        for (int i = 0; i < 12; ++i) points.push_back(size * Vec3{between(-1, 1), between(-1, 1), between(-1, 1)});
        return ConvexHull(points);
    }

    Shape meshOf(float size) {
        const Shape hull = shapeOf(3, 1);
        std::vector<Vec3> corners(std::get<ConvexHull>(hull).vertices().begin(),
                                  std::get<ConvexHull>(hull).vertices().end());
        std::vector<Triangle> triangles;
        for (const HullTriangle& t : convexTriangles({corners.begin(), corners.end()}))
            triangles.push_back(
                {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
        for (Vec3& corner : corners) corner *= size;
        return TriangleMesh(corners, triangles);
    }

    std::mt19937 random_;
};

constexpr float kSameOutcome = 0.05f;  // of the speed: what a centimetre aside may change

/// The outcome in the limit of small steps; none where a centimetre aside changes it.
bool converged(const Flight& flight, Vec3& outcome) {
    constexpr float kFine = 32 * 60;
    outcome = flight.velocityAfter(kFine);
    const float speed = length(flight.velocity);
    for (const Vec3& aside : {Vec3{0.01f, 0, 0}, Vec3{0, 0.01f, 0}, Vec3{0, 0, 0.01f}}) {
        Flight other = flight;
        other.start += aside;
        if (length(other.velocityAfter(kFine) - outcome) > kSameOutcome * speed) return false;
    }
    return true;
}

class FastFlight : public testing::TestWithParam<int> {};

TEST_P(FastFlight, OutcomeOfAFlightIsThatOfSmallSteps) {
    Flights flights(20);
    int looked = 0;
    for (int obstacle : {2, 3, kMesh}) {
        for (int i = 0; i < 16; ++i) {
            const Flight flight = flights.next(GetParam(), obstacle);
            Vec3 expected;
            if (!converged(flight, expected)) continue;
            const float speed = length(flight.velocity);
            const bool passes = length(expected - flight.velocity) < 1e-4f * speed;
            // Where a body strikes several triangles in a step, the second is met on another way than foreseen.
            if (obstacle == kMesh && !passes) continue;
            ++looked;
            for (const float rate : {30.0f, 60.0f, 120.0f}) {
                const float error = length(flight.velocityAfter(rate) - expected) / speed;
                EXPECT_LE(error, passes ? 1e-4f : kSameOutcome)
                    << "obstacle " << obstacle << ", flight " << i << ", " << rate << " Hz";
            }
        }
    }
    EXPECT_GE(looked, 16);
}

/// A plane takes the speed towards it and no other, however many of its triangles lie on the way.
TEST(FastFlights, KeepTheirSpeedAlongAFineMesh) {
    constexpr std::uint32_t kCells = 200;
    std::vector<Vec3> corners;
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i <= kCells; ++i)
        for (std::uint32_t j = 0; j <= kCells; ++j)
            corners.push_back({0.05f * static_cast<float>(i) - 5, 0, 0.05f * static_cast<float>(j) - 5});
    for (std::uint32_t i = 0; i < kCells; ++i)
        for (std::uint32_t j = 0; j < kCells; ++j) {
            const std::uint32_t first = i * (kCells + 1) + j, next = first + kCells + 1;
            triangles.push_back({first, first + 1, next});
            triangles.push_back({next, first + 1, next + 1});
        }
    const TriangleMesh plane(corners, triangles);
    for (const Shape& shape : {Shape{Sphere{0.3f}}, Shape{Capsule{0.3f, 0.2f}}, Shape{Box{{0.3f, 0.2f, 0.25f}}}})
        for (const float slope : {0.1f, 0.5f, 2.0f}) {
            const Vec3 way = normalized(Vec3{1, -slope, 0.2f}), along{way.x, 0, way.z};
            const Flight flight{shape, plane, {}, {}, Vec3{0, 0.45f, 0} - 1.3f * way, 40 * way, 0.1f};
            for (const float rate : {60.0f, 120.0f})
                EXPECT_LE(length(flight.velocityAfter(rate) - 40 * along), 1e-3f * 40)
                    << "kind " << shape.index() << ", slope " << slope << ", " << rate << " Hz";
        }
}

/// A frictionless surface that is flat and then rises along an arc of plane pieces, as one mesh.
struct Rise {
    float radius = 0, piece = 0;  ///< m; rad, that each piece turns
    int pieces = 0;
    float halfWidth = 0;

    TriangleMesh mesh() const {
        constexpr float kRun = 60;  // m, before the arc and after it
        std::vector<Vec3> line{{0, 0, -kRun}, {0, 0, -2}, {}};
        const float chord = 2 * radius * std::sin(0.5f * piece);
        float angle = 0.5f * piece;
        for (int i = 0; i < pieces; ++i, angle += piece)
            line.push_back(line.back() + chord * Vec3{0, std::sin(angle), std::cos(angle)});
        angle -= 0.5f * piece;
        line.push_back(line.back() + kRun * Vec3{0, std::sin(angle), std::cos(angle)});
        std::vector<Vec3> corners;
        std::vector<Triangle> triangles;
        for (const Vec3& place : line)
            for (const float side : {-halfWidth, halfWidth}) corners.push_back(place + Vec3{side, 0, 0});
        for (std::uint32_t i = 0; i + 2 < corners.size(); i += 2) {
            triangles.push_back({i, i + 2, i + 1});
            triangles.push_back({i + 1, i + 2, i + 3});
        }
        return TriangleMesh(corners, triangles);
    }
};

/// A body that comes fast along the flat part and goes up the arc.
struct Climb {
    Rise rise;
    BodyDef body;
    float speed = 0, seconds = 0;

    float speedAfter(float rate) const {
        World world({.gravity = {}});
        world.create(StaticBody{.shape = rise.mesh(), .material = {.friction = 0}});
        const BodyId id = world.create(body);
        for (int i = 0; i < static_cast<int>(std::lround(seconds * rate)); ++i) world.step(1 / rate);
        return length(world.linearVelocity(id));
    }
};

class Climbs {
public:
    explicit Climbs(unsigned seed) : random_(seed) {}

    Climb next(int kind) {
        const Vec3 half{between(0.15f, 0.6f), between(0.04f, 0.4f), between(0.3f, 2)};
        const Shape shape = shapeOf(kind, half);
        const float reach = kind == 0 ? half.y : half.z, bottom = half.y;
        Climb climb{{between(8, 20), 0.0175f * between(1, 6), 1 + static_cast<int>(random_() % 12), between(0.7f, 5)},
                    BodyDef{.shapes = {ShapeDef{.geometry = shape, .material = {.friction = 0}}}},
                    between(8, 45),
                    0};
        const float yaw = random_() % 2 ? 0 : between(-0.3f, 0.3f), hover = random_() % 2 ? 0 : between(0, 0.15f);
        climb.body.pose = {DVec3{0, static_cast<double>(bottom + hover), static_cast<double>(-reach - 1.5f)},
                           rotationAbout({0, 1, 0}, yaw) * (kind == 1 ? rotationAbout({1, 0, 0}, 0.5f * kPi) : Quat{})};
        climb.body.linearVelocity = {0, 0, climb.speed};
        climb.body.allowSleep = false;
        const bool locked = random_() % 2 != 0;
        climb.body.locks = {.rotationX = locked, .rotationY = locked, .rotationZ = locked};
        const float way = 4 + climb.rise.radius * climb.rise.piece * static_cast<float>(climb.rise.pieces);
        climb.seconds = std::ceil(30 * way / climb.speed) / 30;
        return climb;
    }

private:
    float between(float low, float high) {
        return low + (high - low) * static_cast<float>(random_() >> 8) / 16777216.0f;
    }
    Shape shapeOf(int kind, const Vec3& half) {
        if (kind == 0) return Sphere{half.y};
        if (kind == 1) return Capsule{half.y, std::max(0.1f, half.z - half.y)};
        if (kind == 2) return Box{half};
        const float slope = between(0, 0.3f);
        std::vector<Vec3> corners;
        for (int i = 0; i < 8; ++i) {
            const float narrow = (i & 2) != 0 ? 1 - slope : 1;
            corners.push_back({((i & 1) != 0 ? narrow : -narrow) * half.x, (i & 2) != 0 ? half.y : -half.y,
                               ((i & 4) != 0 ? narrow : -narrow) * half.z});
        }
        return ConvexHull(corners);
    }

    std::mt19937 random_;
};

/// An arc takes the speed that turning the way takes, as small steps tell, and none of its pieces is a wall, however
/// far apart steps are.
TEST(FastClimbs, LoseNoMoreThanTheTurningOfTheWayTakes) {
    Climbs climbs(7);
    for (int kind = 0; kind < 4; ++kind)
        for (int i = 0; i < 24; ++i) {
            const Climb climb = climbs.next(kind);
            const float fine = climb.speedAfter(16 * 60);
            for (const float rate : {30.0f, 60.0f, 120.0f, 240.0f}) {
                const float speed = climb.speedAfter(rate);
                EXPECT_NEAR(speed, fine, kSameOutcome * climb.speed)
                    << "kind " << kind << ", climb " << i << ", " << rate << " Hz, from " << climb.speed;
                EXPECT_LE(speed, 1.001f * climb.speed);
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FastFlight, testing::Range(0, 4));

}  // namespace
}  // namespace ragtop
