#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "ragtop/tasks.h"
#include "scenes.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

class SoundScenes : public testing::TestWithParam<std::size_t> {
protected:
    const scenes::Scenario& scenario() const { return scenes::kScenarios[GetParam()]; }
};

TEST_P(SoundScenes, HoldAllFactsAfterEveryStep) {
    for (const int workers : {1, 2}) {
        World world({}, {.tasks = threadTasks(workers)});
        scenario().build(world, {});
        for (int i = 0; i < scenario().steps / 2; ++i) {
            scenes::advance(world, scenario());
            ASSERT_TRUE(isSound(world)) << "step " << i << ", " << workers << " threads";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SoundScenes, testing::Range(std::size_t{0}, std::size(scenes::kScenarios)),
                         [](const auto& param) { return std::string(scenes::kScenarios[param.param].name); });

/// Makes, joins, moves, puts to sleep, wakes, changes the types of and destroys at random.
class Meddler {
public:
    Meddler(World& world, std::uint32_t seed) : world_(world), dice_(seed) {}

    void act() {
        switch (dice_() % 10) {
            case 0:
                add(BodyType::dynamic);
                break;
            case 1:
                add(dice_() % 4 == 0 ? BodyType::kinematic : BodyType::dynamic);
                break;
            case 2:
                join();
                break;
            case 3:
                if (bodies_.size() > 20) world_.destroy(take(bodies_));
                forgetDeadJoints();
                break;
            case 4:
                if (!joints_.empty()) world_.destroy(take(joints_));
                break;
            case 5:
                world_.sleep(any());
                break;
            case 6:
                world_.setPose(any(), {place(), {}});
                break;
            case 7:
                changeType();
                break;
            case 8:
                world_.setEnabled(any(), dice_() % 3 != 0);
                break;
            default:
                world_.wake(any());
                break;
        }
    }

private:
    float number() { return std::uniform_real_distribution<float>(-1, 1)(dice_); }
    DVec3 place() { return DVec3(Vec3{2 * number(), 2 + number(), 2 * number()}); }
    BodyId any() { return bodies_[dice_() % bodies_.size()]; }
    template <class Id>
    Id take(std::vector<Id>& from) {
        const std::size_t i = dice_() % from.size();
        const Id id = from[i];
        from[i] = from.back();
        from.pop_back();
        return id;
    }
    void add(BodyType type) {
        BodyDef def =
            bodyDef(dice_() % 2 == 0 ? Shape{Box{{0.2f, 0.2f, 0.2f}}} : Shape{Sphere{0.25f}}, place(), {}, type);
        def.shapes[0].sensor = type == BodyType::dynamic && dice_() % 8 == 0;
        if (def.shapes[0].sensor) def.mass = MassProperties{1, {}, Mat3{}};
        bodies_.push_back(world_.create(def));
    }
    void changeType() {
        constexpr BodyType kTypes[] = {BodyType::fixed, BodyType::kinematic, BodyType::dynamic};
        const BodyId body = any();
        world_.setType(body, kTypes[dice_() % 3]);
    }
    void join() {
        if (bodies_.size() < 2) return;
        const BodyId a = any(), b = any();
        if (a == b || (world_.type(a) != BodyType::dynamic && world_.type(b) != BodyType::dynamic)) return;
        joints_.push_back(world_.create(BallDef{.bodies = {.a = a, .b = b}}));
    }
    void forgetDeadJoints() {
        std::erase_if(joints_, [&](JointId joint) { return !world_.isValid(joint); });
    }

    World& world_;
    std::mt19937 dice_;
    std::vector<BodyId> bodies_{world_.create(bodyDef(Sphere{0.25f}, {0, 3, 0}))};
    std::vector<JointId> joints_;
};

TEST(SoundWorld, HoldsAllFactsWhateverIsDoneToIt) {
    for (const std::uint32_t seed : {1u, 15u, 20u, 49u, 69u, 111u}) {
        World world;
        addFloor(world);
        Meddler meddler(world, seed);
        std::vector<std::byte> saved;
        for (int i = 0; i < 600; ++i) {
            meddler.act();
            ASSERT_TRUE(isSound(world)) << "between steps, " << i << ", seed " << seed;
            world.step(kDt);
            ASSERT_TRUE(isSound(world)) << "after step " << i << ", seed " << seed;
            if (i % 50 != 49) continue;
            saved.resize(world.saveSize());
            world.save(saved);
            run(world, 0.5);
            const std::uint64_t course = world.hash();
            world.restore(saved);
            ASSERT_TRUE(isSound(world)) << "restored, " << i << ", seed " << seed;
            run(world, 0.5);
            ASSERT_EQ(world.hash(), course) << "restored, " << i << ", seed " << seed;
            world.restore(saved);
        }
    }
}

}  // namespace
}  // namespace ragtop
