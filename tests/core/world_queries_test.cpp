#include <algorithm>
#include <random>

#include "shapes/geometry.h"
#include "world/shape_queries.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// A hundred shapes at random, some moved and some asleep.
class QueryScene {
public:
    explicit QueryScene(const DVec3& origin = {}) : world(withoutGravity()), origin_(origin), random_(7) {
        for (int i = 0; i < 100; ++i) {
            const Shape shape = i % 3 == 0   ? Shape(Sphere{0.2f + 0.3f * share()})
                                : i % 3 == 1 ? Shape(Box{{0.2f + share(), 0.3f, 0.2f + 0.5f * share()}})
                                             : Shape(Capsule{0.2f, 0.5f * share()});
            const bool moves = i % 4 != 0 && i % 11 != 0;
            BodyDef def = bodyDef(shape, origin_ + point(), surface(0.5f), moves ? BodyType::dynamic : BodyType::fixed);
            def.pose.rotation = rotationAbout(direction(), 3 * share());
            def.shapes[0].filter = {.category = 1u << (i % 3), .mask = i % 5 ? 0xffu : 0x100u};
            def.shapes[0].sensor = i % 11 == 0;
            def.shapes[0].material.surface = static_cast<std::uint32_t>(i);
            if (moves) def.linearVelocity = 0.5f * direction();
            bodies.push_back(world.create(def));
        }
        run(world, 0.5);
    }

    float share() { return std::uniform_real_distribution<float>(0, 1)(random_); }
    Vec3 direction() { return normalized(Vec3{share() - 0.5f, share() - 0.5f, share() - 0.5f}); }
    DVec3 point() { return {10.0 * share() - 5, 10.0 * share() - 5, 10.0 * share() - 5}; }
    Ray ray() { return {origin_ + point(), (2 + 10 * share()) * direction()}; }

    bool sees(const QueryFilter& filter, BodyId body, ShapeId shape) const {
        // The definition of the scene, by the number of the body.
        const auto i = static_cast<std::uint32_t>(std::find(bodies.begin(), bodies.end(), body) - bodies.begin());
        const Filter own{.category = 1u << (i % 3), .mask = i % 5 ? 0xffu : 0x100u};
        return (own.category & filter.mask) && (filter.category & own.mask) && (filter.sensors || i % 11 != 0) &&
               body != filter.ignore && world.isValid(shape);
    }

    World world;
    std::vector<BodyId> bodies;

private:
    DVec3 origin_;
    std::mt19937 random_;
};

TEST(WorldQueries, RaysFindWhatBruteForceFinds) {
    for (const DVec3& origin : {DVec3{}, DVec3{1000, 50, -2000}}) {
        QueryScene scene(origin);
        int hits = 0;
        for (int k = 0; k < 300; ++k) {
            const Ray ray = scene.ray();
            QueryFilter filter;
            filter.mask = k % 2 ? 0xffffffffu : 0x5u;
            filter.category = k % 3 ? 0xffffffffu : 0xffu;
            filter.sensors = k % 5 == 0;
            filter.ignore = scene.bodies[static_cast<std::size_t>(k % 100)];
            const Hit hit = scene.world.castRay(ray, filter);
            float best = 1;
            ShapeId nearest;
            for (const BodyId body : scene.bodies)
                for (const ShapeId shape : scene.world.shapes(body)) {
                    if (!scene.sees(filter, body, shape)) continue;
                    std::uint32_t triangle = 0;
                    const Pose pose = scene.world.pose(body) * scene.world.frame(shape);
                    const SweepHit one = castRayAtShape(scene.world.geometry(shape), pose, ray, 1, triangle);
                    if (one.hit && (nearest.isNull() || one.fraction < best)) best = one.fraction, nearest = shape;
                }
            ASSERT_EQ(static_cast<bool>(hit), !nearest.isNull()) << k;
            if (!hit) continue;
            ++hits;
            ASSERT_NEAR(hit.fraction, best, 1e-5f);
            if (best > 0) {
                ASSERT_EQ(hit.shape, nearest) << k;
                ASSERT_EQ(hit.surface, scene.world.material(nearest).surface);
                ASSERT_LT(distanceBetween(hit.point, ray.origin + hit.fraction * ray.translation), 1e-4);
                ASSERT_LE(dot(hit.normal, ray.translation), 1e-5f);
            }
        }
        EXPECT_GT(hits, 30);
    }
}

TEST(WorldQueries, ManyRaysGiveWhatEachGives) {
    QueryScene scene;
    std::vector<Ray> rays;
    for (int k = 0; k < 500; ++k) rays.push_back(scene.ray());
    std::vector<Hit> hits(rays.size());
    scene.world.castRays(rays, hits);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const Hit one = scene.world.castRay(rays[k]);
        ASSERT_EQ(hits[k].shape, one.shape);
        ASSERT_EQ(hits[k].fraction, one.fraction);
        ASSERT_EQ(hits[k].point, one.point);
        ASSERT_EQ(hits[k].normal, one.normal);
    }
    std::vector<Hit> few(3);
    EXPECT_THROW(scene.world.castRays(rays, few), std::invalid_argument);
}

TEST(WorldQueries, ShapesSweepToWhatBruteForceFinds) {
    QueryScene scene;
    const Shape moving[] = {Sphere{0.3f}, Box{{0.2f, 0.3f, 0.4f}}, Capsule{0.2f, 0.4f}};
    for (int k = 0; k < 200; ++k) {
        const Ray ray = scene.ray();
        const Quat rotation = rotationAbout(scene.direction(), 2 * scene.share());
        const Shape& shape = moving[k % 3];
        const Hit hit = scene.world.castShape(shape, rotation, ray);
        float best = 1;
        bool any = false;
        for (const BodyId body : scene.bodies)
            for (const ShapeId target : scene.world.shapes(body)) {
                if (!scene.sees({}, body, target)) continue;
                std::uint32_t triangle = 0;
                const Pose pose = scene.world.pose(body) * scene.world.frame(target);
                const SweepHit one =
                    sweepShapeAtShape(shape, rotation, ray, scene.world.geometry(target), pose, 1, triangle);
                if (one.hit) any = true, best = std::min(best, one.fraction);
            }
        ASSERT_EQ(static_cast<bool>(hit), any) << k;
        ASSERT_NEAR(hit.fraction, any ? best : 1, 1e-4f) << k;
    }
}

TEST(WorldQueries, OverlapsAreThoseOfBruteForce) {
    QueryScene scene;
    int found = 0;
    for (int k = 0; k < 100; ++k) {
        const Pose pose{scene.point(), rotationAbout(scene.direction(), 2)};
        const Shape shape = k % 2 ? Shape(Sphere{1.5f}) : Shape(Box{{1, 0.5f, 2}});
        std::vector<ShapeId> got, expected, inBounds, expectedInBounds;
        scene.world.overlap(shape, pose, [&](ShapeId id) { return got.push_back(id), true; });
        const Bounds bounds = boundsOf(shape, pose);
        scene.world.overlap(bounds, [&](ShapeId id) { return inBounds.push_back(id), true; });
        for (const BodyId body : scene.bodies)
            for (const ShapeId target : scene.world.shapes(body)) {
                if (!scene.sees({}, body, target)) continue;
                const Pose at = scene.world.pose(body) * scene.world.frame(target);
                if (overlapsShape(shape, pose, scene.world.geometry(target), at)) expected.push_back(target);
                if (overlaps(bounds, scene.world.bounds(target))) expectedInBounds.push_back(target);
            }
        for (auto* list : {&got, &expected, &inBounds, &expectedInBounds}) std::sort(list->begin(), list->end());
        ASSERT_EQ(got, expected) << k;
        ASSERT_EQ(inBounds, expectedInBounds) << k;
        found += static_cast<int>(got.size());
        // False ends the visit.
        int visits = 0;
        scene.world.overlap(shape, pose, [&](ShapeId) { return ++visits, false; });
        ASSERT_EQ(visits, got.empty() ? 0 : 1);
    }
    EXPECT_GT(found, 20);
}

TEST(WorldQueries, ThatSeeWhatIsNearAloneMeetWhatTheyWouldInTheWorld) {
    for (const DVec3& origin : {DVec3{}, DVec3{1000, 50, -2000}}) {
        QueryScene scene(origin);
        int hits = 0;
        for (int k = 0; k < 300; ++k) {
            const Ray ray = scene.ray();
            const Shape ball = Sphere{0.1f + 0.2f * scene.share()};
            const Vec3 from = toVec3(ray.origin), to = toVec3(ray.origin + ray.translation);
            const Vec3 around{0.4f, 0.4f, 0.4f};
            QueryFilter filter{.ignore = scene.bodies[static_cast<std::size_t>(k % 100)], .sensors = k % 5 == 0};
            std::vector<ShapeId> near;
            scene.world.overlap(
                Bounds{min(from, to) - around, max(from, to) + around},
                [&](ShapeId shape) { return near.push_back(shape), true; }, filter);
            const Hit rayHit = scene.world.castRay(ray, filter), hit = scene.world.castShape(ball, {}, ray, filter);
            filter.among = near;
            const Hit rayAgain = scene.world.castRay(ray, filter), again = scene.world.castShape(ball, {}, ray, filter);
            for (const auto& [all, some] : {std::pair(rayHit, rayAgain), std::pair(hit, again)}) {
                ASSERT_EQ(static_cast<bool>(all), static_cast<bool>(some)) << k;
                if (!all) continue;
                ++hits;
                ASSERT_NEAR(some.fraction, all.fraction, 1e-5f) << k;
                if (all.fraction > 0) {
                    ASSERT_EQ(some.shape, all.shape) << k;
                }
            }
            near.clear();
            filter.among = near;
            ASSERT_FALSE(scene.world.castRay(ray, filter));
        }
        EXPECT_GT(hits, 100);
    }
}

TEST(WorldQueries, AmongShapesThatAreNoneAreRefused) {
    World world(withoutGravity());
    const BodyId box = world.create(bodyDef(Box{{1, 1, 1}}, {}));
    const std::vector<ShapeId> gone(world.shapes(box).begin(), world.shapes(box).end());
    world.destroy(box);
    EXPECT_THROW((void)world.castRay({{3, 0, 0}, {-5, 0, 0}}, {.among = gone}), std::out_of_range);
}

TEST(WorldQueries, ARayInsideStartsAtZeroAndAnEmptyWorldHasNothing) {
    World world(withoutGravity());
    EXPECT_FALSE(world.castRay({{}, {1, 0, 0}}));
    const BodyId box = world.create(bodyDef(Box{{1, 1, 1}}, {}));
    const Hit hit = world.castRay({{0.1, 0, 0}, {5, 0, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit.body, box);
    EXPECT_EQ(hit.fraction, 0);
    EXPECT_FALSE(world.castRay({{3, 0, 0}, {5, 0, 0}}));
    world.destroy(box);
    EXPECT_FALSE(world.castRay({{0.1, 0, 0}, {5, 0, 0}}));
}

TEST(WorldQueries, QueriesSeeABodyWhereItWasPut) {
    World world(withoutGravity());
    const BodyId box = world.create(bodyDef(Box{{1, 1, 1}}, {}, {}, BodyType::fixed));
    world.setPose(box, {{50, 0, 0}, {}});
    EXPECT_FALSE(world.castRay({{0, 5, 0}, {0, -10, 0}}));
    const Hit hit = world.castRay({{50, 5, 0}, {0, -10, 0}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit.fraction, 0.4, 1e-6);
}

}  // namespace
}  // namespace ragtop
