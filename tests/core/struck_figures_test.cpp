#include <algorithm>

#include "chain_support.h"

namespace ragtop {
namespace {

using namespace test;

/// A trunk of 8 cm, three arms of four links with narrow limits, each link a fifth as heavy as the one before, and a
/// ball of 50 kg that flies at one of them, with nothing else around.
struct Struck {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;

    Struck(World& world, int seed) {
        scenes::Dice dice(static_cast<std::uint64_t>(seed));
        const auto any = [&] {
            return normalized(Vec3{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)});
        };
        add(world, Sphere{0.04f}, {}, {}, 3);
        for (int arm = 0; arm < 3; ++arm) addArm(world, any());
        const DVec3 aim = world.pose(bodies[1 + dice.below(12)]).position;
        const Vec3 way = any();
        const BodyId ball = add(world, Sphere{0.15f}, aim - DVec3{0.8f * way}, {}, 50);
        world.setVelocity(ball, 30.0f * way, {});
    }
    BodyId add(World& world, const Shape& shape, const DVec3& at, const Quat& turned, float mass) {
        BodyDef def = bodyDef(shape, at);
        def.pose.rotation = turned;
        def.shapes[0].density = mass / massOf(shape, 1).mass;
        def.shapes[0].filter.group = mass < 50 ? -1 : 0;
        bodies.push_back(world.create(def));
        return bodies.back();
    }
    void addArm(World& world, const Vec3& along) {
        constexpr float kLink = 0.04f;
        const Quat turned = rotationBetween({0, 1, 0}, along);
        BodyId before = bodies.front();
        Vec3 from = 0.04f * along;
        float mass = 1;
        for (int i = 0; i < 4; ++i, mass *= 0.2f) {
            const Vec3 middle = from + 0.5f * kLink * along;
            const BodyId link = add(world, Capsule{0.008f, 0.012f}, DVec3{middle}, turned, mass);
            const Quat axis = rotationBetween({1, 0, 0}, along);
            const Pose pose = world.pose(before);
            JointBodies joined{.a = before, .b = link};
            joined.frameA = {inverseRotate(pose.rotation, from - toVec3(pose.position)),
                             conjugate(pose.rotation) * axis};
            joined.frameB = {inverseRotate(turned, from - middle), conjugate(turned) * axis};
            joints.push_back(
                world.create(BallDef{.bodies = joined, .swingLimit = 0.1f, .twistLimit = Range{-0.05f, 0.05f}}));
            before = link;
            from = from + kLink * along;
        }
    }
    DVec3 momentum(const World& world) const {
        DVec3 sum{};
        for (const BodyId body : bodies) sum = sum + DVec3{world.mass(body).mass * world.linearVelocity(body)};
        return sum;
    }
    double energy(const World& world) const {
        double sum = 0;
        for (const BodyId body : bodies) sum += kineticEnergy(world, body);
        return sum;
    }
};

/// Whoever corrects what a step did: the ball and the figure have the momentum that the ball brought, and no more
/// energy. 22.5 kJ and 1,500 kg m/s; rounding of 60 steps of 4 substeps is below 1e-4 of either.
TEST(StruckFigures, HaveTheMomentumThatTheBallBroughtAndNoMoreEnergy) {
    std::uint64_t guarded = 0, cut = 0;
    for (int seed = 1; seed <= 12; ++seed) {
        WorldSettings settings = withoutSleep();
        settings.gravity = {};
        World world{settings};
        const Struck scene(world, seed);
        const double energy = scene.energy(world);
        const DVec3 momentum = scene.momentum(world);
        for (int i = 0; i < stepsIn(1); ++i) {
            world.step(kDt);
            const DVec3 gained = scene.momentum(world) - momentum;
            ASSERT_LE(std::sqrt(lengthSquared(toVec3(gained))), 1e-4f * 1500) << "seed " << seed << " step " << i;
            ASSERT_LE(scene.energy(world), (1 + 1e-4) * energy) << "seed " << seed << " step " << i;
            for (const JointId joint : scene.joints)
                ASSERT_GE(world.state(joint).limitMargin, -0.05f) << "seed " << seed << " step " << i;
        }
        guarded += world.stats().energyGuarded;
        cut += world.stats().stepsCut;
    }
    EXPECT_GT(guarded, 0u);  // or nothing was tried
    EXPECT_GT(cut, 0u);
}

}  // namespace
}  // namespace ragtop
