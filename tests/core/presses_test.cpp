#include <algorithm>
#include <array>
#include <cmath>

#include "collide_support.h"
#include "mesh_bodies.h"
#include "shape_support.h"
#include "world_support.h"

/// Bodies that a machine draws, where no answer holds them: between plates that close, and put into each other.
namespace ragtop::test {
namespace {

enum class Kinds { convex, all };

class Heap {
public:
    Heap(std::uint64_t seed, Kinds kinds) : random_(seed), kinds_(kinds == Kinds::convex ? 3.999f : 5.999f) {
        const float least = 0.05f * std::pow(10.0f, random_.uniform(0, 1));
        size_ = {least, least * random_.uniform(1, 6)};
        heaviness_ = random_.uniform(0, 1) < 0.5f ? 1 : std::pow(30.0f, random_.uniform(0, 1));
    }
    float largest() const { return size_[1]; }
    float draw(float low, float high) { return random_.uniform(low, high); }

    BodyId add(World& world, const DVec3& place) {
        const float s = size_[0] * std::pow(size_[1] / size_[0], random_.uniform(0, 1));
        const Material rough = surface(random_.uniform(0.1f, 1));
        BodyDef def = bodyDef(shape(s), place, rough);
        def.shapes[0].density = 1000 * std::pow(heaviness_, random_.uniform(-1, 1));
        def.pose.rotation = random_.rotation();
        return world.create(def);
    }

private:
    Shape shape(float s) {
        const auto share = [&] { return s * random_.uniform(0.2f, 1); };
        switch (static_cast<int>(random_.uniform(0, kinds_))) {
            case 0:
                return Sphere{s};
            case 1:
                return Box{{share(), share(), share()}};
            case 2: {
                const float radius = s * random_.uniform(0.2f, 0.6f);
                return Capsule{radius, s - 0.99f * radius};
            }
            case 3:
                return ConvexHull(randomPoints(random_, 5 + static_cast<int>(random_.uniform(0, 30)), s));
            case 4: {
                const auto sides = 8 + static_cast<std::uint32_t>(random_.uniform(0, 16));
                return scenes::torus(0.7f * s, s * random_.uniform(0.1f, 0.3f), sides, 8);
            }
            default: {
                Compound both;
                for (const float side : {-0.4f, 0.4f})
                    both.parts.push_back(
                        {Box{{share() / 2, share() / 2, share() / 2}}, {{side * s, 0, 0}, random_.rotation()}});
                return both;
            }
        }
    }

    Random random_;
    float kinds_;
    std::array<float, 2> size_{};
    float heaviness_ = 1;
};

void addShaft(World& world, double half) {
    addFloor(world, surface(0.5f));
    for (int i = 0; i < 4; ++i) {
        BodyDef wall = bodyDef(Box{{0.5f, 50, static_cast<float>(half) + 1}}, {}, surface(0.5f));
        const double angle = 0.5 * 3.14159265358979 * i;
        wall.type = BodyType::fixed;
        wall.pose = {{(half + 0.5) * std::cos(angle), 50, -(half + 0.5) * std::sin(angle)},
                     rotationAbout({0, 1, 0}, static_cast<float>(angle))};
        world.create(wall);
    }
}

double fastest(const World& world, const std::vector<BodyId>& bodies) {
    double most = 0;
    for (const BodyId body : bodies) most = std::max(most, asDouble(length(world.linearVelocity(body))));
    return most;
}

// A plate comes down to half of the largest body, stays for three seconds and goes up again. What falls from its height
// has √(2 g y), and a plate gives what it squeezes out of a wedge of 60° twice its speed, so none is faster than the
// sum. Loads that grew while nothing could give way threw one of five, at up to six times that.
TEST(Presses, ThrowNothing) {
    RAGTOP_NEEDS_HULLS();
    for (std::uint64_t seed = 1; seed <= 36; ++seed) {
        SCOPED_TRACE(seed);
        Heap heap(seed, Kinds::convex);
        World world;
        const double half = 2 * asDouble(heap.largest()), large = asDouble(heap.largest());
        addShaft(world, half);
        std::vector<BodyId> bodies;
        const int count = 2 + static_cast<int>(heap.draw(0, 18));
        for (int i = 0; i < count; ++i) {
            const auto aside = [&] { return asDouble(heap.draw(-1, 1)) * (half - large); };
            const double x = aside(), z = aside();
            bodies.push_back(heap.add(world, {x, large * (1 + 1.2 * i), z}));
        }
        const float wide = static_cast<float>(0.95 * half);
        BodyDef def = bodyDef(Box{{wide, 0.5f, wide}}, {0, 0.5 + large * (3 + 1.2 * count), 0}, surface(0.5f));
        def.type = BodyType::kinematic;
        const BodyId plate = world.create(def);
        const double top = world.pose(plate).position.y, speed = asDouble(heap.draw(0.5f, 5));
        double most = 0;
        bool closed = false;
        for (int i = 0; i < 480; ++i) {
            closed |= world.pose(plate).position.y - 0.5 < 0.5 * large;
            const double rate = !closed ? -speed : i < 400 ? 0 : 1;
            world.setVelocity(plate, {0, static_cast<float>(rate), 0}, {});
            world.step(kDt);
            most = std::max(most, fastest(world, bodies));
        }
        EXPECT_LT(most, std::sqrt(2 * 9.81 * top) + 2 * speed);
    }
}

// The heap is three of the largest body high. To the speed of that fall come pushes of ½ √(g · size) at most, one on
// the other over the bodies of a column.
TEST(Presses, BodiesPutIntoEachOtherFlyNoFasterThanTheyCouldFall) {
    RAGTOP_NEEDS_HULLS();
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE(seed);
        Heap heap(seed, Kinds::all);
        World world;
        addFloor(world, surface(0.5f));
        std::vector<BodyId> bodies;
        const float large = heap.largest();
        const int count = 2 + static_cast<int>(seed) * 38 / 24;
        for (int i = 0; i < count; ++i) {
            const float x = heap.draw(-1, 1), y = heap.draw(0, 2), z = heap.draw(-1, 1);
            bodies.push_back(heap.add(world, DVec3(large * Vec3{x, y, z})));
        }
        double most = 0;
        run(world, 2, kDt, [&] { most = std::max(most, fastest(world, bodies)); });
        EXPECT_LT(most, (std::sqrt(6.0) + 0.5 * std::cbrt(count)) * std::sqrt(9.81 * asDouble(large)));
    }
}

}  // namespace
}  // namespace ragtop::test
