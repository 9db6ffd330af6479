#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "base/hash.h"
#include "ragtop/command_buffer.h"
#include "ragtop/tasks.h"
#include "scenes.h"

/// What docs/threading.md promises. Under the thread sanitizer (preset tsan) these tests also show that nothing races.
namespace ragtop {
namespace {

constexpr int kThreads = 4;

/// Runs task(thread) on all threads at once.
template <class Task>
void onThreads(Task&& task) {
    std::atomic<int> ready{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < kThreads; ++i)
        threads.emplace_back([&, i] {
            ++ready;
            while (ready < kThreads) std::this_thread::yield();
            task(i);
        });
    for (std::thread& thread : threads) thread.join();
}

/// A digest of all that const members tell of a world.
std::uint64_t readAll(const World& world) {
    StateHash digest;
    for (const BodyId body : world.bodies()) {
        digest.add(world.pose(body));
        digest.add(world.linearVelocity(body));
        digest.add(world.isAwake(body));
        for (const ShapeId shape : world.shapes(body)) digest.add(world.bounds(shape).lower);
        digest.add(static_cast<std::uint64_t>(world.jointsOf(body).size()));
    }
    for (const JointId joint : world.joints()) digest.add(world.state(joint).force);
    world.forEachContact([&](const Contact& contact) { digest.add(contact.normalForce); });
    std::vector<Ray> rays;
    for (int i = 0; i < 300; ++i) rays.push_back({{0.125 * (i % 20) - 1, 12, 0.25 * (i / 20) - 2}, {0, -24, 0.5f}});
    std::vector<Hit> hits(rays.size());
    world.castRays(rays, hits);
    for (const Hit& hit : hits) {
        digest.add(hit.shape);
        digest.add(hit.fraction);
    }
    for (int i = 0; i < 20; ++i) {
        const Ray& path = rays[static_cast<std::size_t>(i)];
        digest.add(world.castRay(path).fraction);
        digest.add(world.castShape(Capsule{}, {}, path).fraction);
        world.overlap(Box{}, {{0.25 * i - 2, 1, 0}, {}}, [&](ShapeId shape) {
            digest.add(shape);
            return true;
        });
    }
    digest.add(world.energy());
    digest.add(world.hash());
    digest.add(static_cast<std::uint64_t>(world.stats().touching));
    std::vector<std::byte> state(world.saveSize());
    world.save(state);
    digest.add(std::span<const std::byte>(state).first(64));
    return digest.value();
}

TEST(Threading, ConstMembersMayBeCalledFromAllThreadsBetweenSteps) {
    World world({}, {.tasks = threadTasks(2)});
    scenes::addHills(world);
    scenes::addMixedShapes(world, {}, 30);
    scenes::addFigure(world, {}, 0, 8);
    for (int i = 0; i < 10; ++i) {
        world.step(1.0 / 60);
        // Lists of ids are made anew after this.
        world.create(DynamicBody{.position = {3, 8.0 + i, 0}});
        std::array<std::uint64_t, kThreads> seen{};
        onThreads([&](int thread) { seen[static_cast<std::size_t>(thread)] = readAll(world); });
        for (const std::uint64_t digest : seen) EXPECT_EQ(digest, readAll(world));
    }
}

/// Jobs record while others read; the keys of their buffers, not their threads, decide the order.
TEST(Threading, CommandsRecordedByJobsApplyInTheOrderOfTheirKeys) {
    const auto run = [](bool backwards) {
        World world({}, {.tasks = threadTasks(2)});
        scenes::addFloor(world);
        for (int i = 0; i < 4 * kThreads; ++i) scenes::addBox(world, {}, {0.5f, 0.5f, 0.5f}, 2 * i, 0.5, 0);
        for (int frame = 0; frame < 20; ++frame) {
            std::vector<CommandBuffer> buffers;
            for (std::uint64_t key = 0; key < kThreads; ++key) buffers.emplace_back(key);
            onThreads([&](int thread) {
                const int job = backwards ? kThreads - 1 - thread : thread;
                CommandBuffer& buffer = buffers[static_cast<std::size_t>(job)];
                for (int k = 0; k < 4; ++k) {
                    const BodyId body =
                        world.bodies()[static_cast<std::size_t>(1 + (4 * job + 5 * k + frame) % (4 * kThreads))];
                    const Vec3 push{10.0f * static_cast<float>(job - 1), 100, 5.0f * static_cast<float>(k)};
                    buffer.applyImpulse(body, push, world.centerOfMass(body));
                }
                if (frame % 5 == job) {
                    BodyDef def;
                    def.shapes.push_back({.geometry = Sphere{0.25f}});
                    def.pose.position = {static_cast<double>(job), 4, 2};
                    buffer.create(def);
                }
            });
            std::vector<CommandBuffer*> order;
            for (CommandBuffer& buffer : buffers) order.insert(backwards ? order.begin() : order.end(), &buffer);
            world.apply(order);
            world.step(1.0 / 60);
        }
        return world.hash();
    };
    EXPECT_EQ(run(false), run(true));
}

TEST(Threading, CallbacksOnAllThreadsDecideAsOnOne) {
    const auto run = [](const TaskRunner& tasks) {
        std::atomic<int> filtered{0}, modified{0};
        World world({}, {.tasks = tasks});
        WorldCallbacks callbacks;
        callbacks.filter = [&](const PairInfo& pair) {
            ++filtered;
            return (pair.userDataA + pair.userDataB) % 5 != 0 || pair.userDataA == 0 || pair.userDataB == 0;
        };
        callbacks.modify = [&](const PairInfo& pair, ContactSurface& surface) {
            ++modified;
            surface.friction = pair.userDataB % 2 == 0 ? 0.0f : 1.0f;
            if (pair.userDataA % 3 == 2) surface.surfaceVelocity = {1, 0, 0};
        };
        world.setCallbacks(callbacks);
        scenes::addBowl(world);
        for (std::uint64_t i = 0; i < 60; ++i) {
            BodyDef def;
            def.shapes.push_back({.geometry = Box{{0.25f, 0.25f, 0.25f}}, .userData = i + 1});
            def.pose.position = {0.75 * static_cast<double>(i % 4), 1 + static_cast<double>(i / 16),
                                 0.75 * static_cast<double>(i / 4 % 4)};
            world.create(def);
        }
        for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
        EXPECT_GT(filtered, 0);
        EXPECT_GT(modified, 0);
        return world.hash();
    };
    const std::uint64_t expected = run(serialTasks());
    EXPECT_EQ(run(threadTasks(4)), expected);
}

TEST(Threading, StepsOnFourThreadsTouchNothingTwice) {
    for (const scenes::Scenario& scenario : scenes::kScenarios) {
        World serial, threaded({}, {.tasks = threadTasks(4)});
        scenario.build(serial, {});
        scenario.build(threaded, {});
        for (int i = 0; i < 40; ++i) {
            scenes::advance(serial, scenario);
            scenes::advance(threaded, scenario);
        }
        EXPECT_EQ(threaded.hash(), serial.hash()) << scenario.name;
    }
}

/// Threads that are slow to come in every other score of runs, so that a world changes its mind about them.
struct MoodyThreads {
    TaskRunner pool = threadTasks(4);
    std::array<int, 5> runs{};  ///< by number of tasks
    int count = 0;

    TaskRunner runner() {
        TaskRunner result;
        result.workers = pool.workers;
        result.user = this;
        result.run = [](void* user, int tasks, TaskRunner::Task task, void* context) {
            auto& self = *static_cast<MoodyThreads*>(user);
            ++self.runs[static_cast<std::size_t>(tasks)];
            if (self.count++ / 20 % 2 == 1) std::this_thread::sleep_for(std::chrono::milliseconds(3));
            self.pool.run(self.pool.user, tasks, task, context);
        };
        return result;
    }
};

TEST(Threading, WhoTakesPartDoesNotMatter) {
    MoodyThreads threads;
    int steps = 0;
    for (const std::size_t number : {3u, 6u, 7u}) {
        const scenes::Scenario& scenario = scenes::kScenarios[number];
        SCOPED_TRACE(scenario.name);
        World shared({}, {.tasks = threads.runner()}), alone;
        scenario.build(shared, {});
        scenario.build(alone, {});
        for (int i = 0; i < 120; ++i, ++steps) {
            scenes::advance(shared, scenario);
            scenes::advance(alone, scenario);
            ASSERT_EQ(shared.hash(), alone.hash()) << "step " << i;
        }
    }
    EXPECT_GT(threads.runs[2], 0) << "no step on half of them";
    EXPECT_GT(threads.runs[4], 0) << "no step on all";
    EXPECT_LT(threads.count, steps) << "no step alone";
}

/// Worlds on different threads share nothing but a runner, and that only if told so.
TEST(Threading, WorldsStepAtOnceAndMayShareARunner) {
    const TaskRunner shared = threadTasks(3);
    std::array<std::uint64_t, kThreads> hashes{};
    onThreads([&](int thread) {
        World world({}, {.tasks = thread % 2 == 0 ? shared : threadTasks(2)});
        scenes::addHouse(world);
        for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
        hashes[static_cast<std::size_t>(thread)] = world.hash();
    });
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(Threading, AWorldMayMoveToAnotherThreadBetweenSteps) {
    World world({}, {.tasks = threadTasks(2)}), stay({}, {.tasks = threadTasks(2)});
    for (World* w : {&world, &stay}) scenes::addTower(*w);
    for (int i = 0; i < 20; ++i) {
        std::thread([&] { world.step(1.0 / 60); }).join();
        stay.step(1.0 / 60);
    }
    EXPECT_EQ(world.hash(), stay.hash());
}

#ifdef RAGTOP_RACE_PROGRAM
/// Without this, silence of the sanitizer might mean that it sees nothing.
TEST(Threading, ARaceSeededOnPurposeIsReported) {
    const auto run = [](const std::string& argument) {
        return std::system((std::string(RAGTOP_RACE_PROGRAM) + " " + argument + " > /dev/null 2>&1").c_str());
    };
    EXPECT_EQ(run("lawful"), 0);
    EXPECT_NE(run("racing"), 0);
}
#endif

}  // namespace
}  // namespace ragtop
