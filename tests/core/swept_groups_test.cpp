#include <cmath>

#include "chain_support.h"

/// What continuous collision does to a group of bodies when its step has been accounted for.
namespace ragtop {
namespace {

using namespace test;

/// A slab of balls on stiff springs to all their neighbours.
struct Slab {
    static constexpr float kStiffness = 7e6f, kPitch = 0.375f;
    std::vector<BodyId> balls;
    struct Tie {
        BodyId a, b;
        float rest;
    };
    std::vector<Tie> ties;

    Slab(World& world, float height, const Vec3& velocity) {
        const auto at = [](int i) {
            return Vec3{static_cast<float>(i / 8), static_cast<float>(i / 4 % 2), static_cast<float>(i % 4)};
        };
        for (int i = 0; i < 32; ++i) {
            BodyDef def = bodyDef(Sphere{0.1f}, DVec3{kPitch * at(i) + Vec3{0, height, 0}});
            def.shapes[0].density = 1000;
            def.linearVelocity = velocity;
            balls.push_back(world.create(def));
            for (int j = 0; j < i; ++j) {
                if (lengthSquared(at(i) - at(j)) > 3.5f) continue;
                const float rest = kPitch * length(at(i) - at(j));
                DistanceDef tie;
                tie.bodies = {.a = balls[static_cast<std::size_t>(j)], .b = balls.back()};
                tie.rest = rest;
                tie.spring = Spring{.stiffness = kStiffness, .damping = 300};
                world.create(JointDef{tie});
                ties.push_back({tie.bodies.a, tie.bodies.b, rest});
            }
        }
    }
    double energy(const World& world) const {
        double sum = 0;
        for (const BodyId ball : balls) sum += energyOf(world, ball);
        for (const Tie& tie : ties) {
            const DVec3 way = world.pose(tie.b).position - world.pose(tie.a).position;
            const double stretch =
                std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z) - static_cast<double>(tie.rest);
            sum += 0.5 * static_cast<double>(kStiffness) * stretch * stretch;
        }
        return sum;
    }
};

/// Its balls meet the floor within a step, some sooner than others: those are taken back to where they met it, which
/// presses springs when the step has been accounted for already.
TEST(SweptGroups, SpringsThatContinuousCollisionPressesHoldWhatTheFallBroughtAtMost) {
    for (int i = 0; i < 12; ++i) {
        World world{withoutSleep()};
        addFloor(world);
        const Slab slab{world, 1 + 0.0625f * static_cast<float>(i), {-1.4f, 0.9f, 3.45f}};
        const double start = slab.energy(world);
        for (int step = 0; step < stepsIn(1); ++step) {
            world.step(kDt);
            ASSERT_LE(slab.energy(world), 1.01 * start) << i << ", step " << step;
        }
    }
}

}  // namespace
}  // namespace ragtop
