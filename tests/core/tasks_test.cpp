#include "ragtop/tasks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/stage_runner.h"

namespace ragtop {
namespace {

using Run = void (*)(void* user, int count, TaskRunner::Task task, void* context);

TaskRunner runnerOf(int workers, Run run) {
    TaskRunner runner;
    runner.workers = workers;
    runner.run = run;
    return runner;
}

void inOrder(void*, int count, TaskRunner::Task task, void* context) {
    for (int i = 0; i < count; ++i) task(context, i);
}

void inReverse(void*, int count, TaskRunner::Task task, void* context) {
    for (int i = count - 1; i >= 0; --i) task(context, i);
}

// The calling thread takes no task at all, and the others run one after the other.
void onOneOtherThread(void*, int count, TaskRunner::Task task, void* context) {
    std::thread([&] { inReverse(nullptr, count, task, context); }).join();
}

// As a job system whose caller only waits.
void onOtherThreads(void*, int count, TaskRunner::Task task, void* context) {
    std::vector<std::thread> threads;
    for (int i = 0; i < count; ++i) threads.emplace_back(task, context, i);
    for (std::thread& thread : threads) thread.join();
}

void callerLast(void*, int count, TaskRunner::Task task, void* context) {
    std::vector<std::thread> threads;
    for (int i = 0; i + 1 < count; ++i) threads.emplace_back(task, context, i);
    if (count > 0) task(context, count - 1);
    for (std::thread& thread : threads) thread.join();
}

struct NamedRunner {
    std::string name;
    TaskRunner runner;
};

std::vector<NamedRunner> allRunners() {
    return {{"serial", serialTasks()},
            {"thread1", threadTasks(1)},
            {"thread2", threadTasks(2)},
            {"thread4", threadTasks(4)},
            {"tbb2", tbbTasks(2)},
            {"tbb4", tbbTasks(4)},
            {"inOrder", runnerOf(4, inOrder)},
            {"inReverse", runnerOf(4, inReverse)},
            {"onOneOtherThread", runnerOf(4, onOneOtherThread)},
            {"onOtherThreads", runnerOf(4, onOtherThreads)},
            {"callerLast", runnerOf(4, callerLast)}};
}

// One plain, unsynchronized counter per item: a block run twice or a stage that overlaps another one shows as a wrong
// count, and as a race under the thread sanitizer.
void runRandomStages(StageRunner& runner, std::mt19937& random, int stages) {
    std::vector<int> visits(3000);
    std::vector<int> expected(visits.size());
    std::vector<std::atomic<int>> busy(static_cast<std::size_t>(runner.workers()));
    bool bodyOnCaller = false;
    const auto caller = std::this_thread::get_id();
    runner.region([&] {
        bodyOnCaller = std::this_thread::get_id() == caller;
        for (int s = 0; s < stages; ++s) {
            const int count = static_cast<int>(random() % visits.size());
            const int grain = 1 + static_cast<int>(random() % 300);
            std::atomic<int> blocks{0};
            runner.parallelFor(count, grain, [&](int begin, int end, int worker) {
                ASSERT_TRUE(worker >= 0 && worker < runner.workers());
                ASSERT_EQ(busy[static_cast<std::size_t>(worker)].exchange(1), 0) << "two threads with one number";
                ASSERT_TRUE(0 <= begin && begin < end && end <= count);
                for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
                blocks.fetch_add(1, std::memory_order_relaxed);
                busy[static_cast<std::size_t>(worker)].store(0);
            });
            for (int i = 0; i < count; ++i) ++expected[static_cast<std::size_t>(i)];
            const int most = count == 0 ? 0 : (count - 1) / grain + 1;
            ASSERT_LE(blocks.load(), most);
            ASSERT_GE(blocks.load(), count > 0 ? 1 : 0);
        }
    });
    EXPECT_TRUE(bodyOnCaller);
    EXPECT_EQ(visits, expected);
}

TEST(StageRunner, RunsEveryBlockOnceOnAnyRunner) {
    for (const NamedRunner& named : allRunners()) {
        SCOPED_TRACE(named.name);
        StageRunner runner(named.runner);
        std::mt19937 random(11);
        for (int region = 0; region < 20; ++region) runRandomStages(runner, random, 50);
        ASSERT_FALSE(::testing::Test::HasFailure());
    }
}

TEST(StageRunner, ManyTinyStagesLoseNothing) {
    for (const NamedRunner& named : allRunners()) {
        SCOPED_TRACE(named.name);
        StageRunner runner(named.runner);
        std::vector<long> sums(64);
        runner.region([&] {
            for (int s = 0; s < 5000; ++s) {
                runner.parallelFor(64, 8, [&](int begin, int end, int) {
                    for (int i = begin; i < end; ++i) sums[static_cast<std::size_t>(i)] += s;
                });
            }
        });
        for (const long sum : sums) ASSERT_EQ(sum, 5000L * 4999 / 2);
    }
}

TEST(StageRunner, LoopsOutsideARegionOpenTheirOwn) {
    for (const NamedRunner& named : allRunners()) {
        SCOPED_TRACE(named.name);
        StageRunner runner(named.runner);
        std::vector<int> visits(1000);
        for (int k = 0; k < 10; ++k) {
            runner.parallelFor(1000, 10, [&](int begin, int end, int) {
                for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
            });
        }
        EXPECT_EQ(visits, std::vector<int>(1000, 10));
    }
}

TEST(StageRunner, SmallOrEmptyLoopsStayOnTheCaller) {
    StageRunner runner(threadTasks(2));
    const auto caller = std::this_thread::get_id();
    int calls = 0;
    runner.parallelFor(0, 4, [&](int, int, int) { ++calls; });
    EXPECT_EQ(calls, 0);
    runner.region([&] {
        runner.parallelFor(4, 4, [&](int begin, int end, int worker) {
            ++calls;
            EXPECT_EQ(std::this_thread::get_id(), caller);
            EXPECT_EQ(begin, 0);
            EXPECT_EQ(end, 4);
            EXPECT_EQ(worker, 0);
        });
    });
    EXPECT_EQ(calls, 1);
}

TEST(StageRunner, AloneOnTheCallerWakesNoWorker) {
    StageRunner runner(threadTasks(2));
    const auto caller = std::this_thread::get_id();
    int calls = 0;
    runner.serialRegion([&] {
        runner.parallelFor(1000, 10, [&](int begin, int end, int worker) {
            calls += end - begin;
            EXPECT_EQ(std::this_thread::get_id(), caller);
            EXPECT_EQ(worker, 0);
        });
        runner.region([&] { ++calls; });  // within: as a part of it
    });
    EXPECT_EQ(calls, 1001);
    std::vector<int> visits(1000);
    runner.parallelFor(1000, 10, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
    });
    EXPECT_EQ(visits, std::vector<int>(1000, 1));
}

TEST(StageRunner, NoMoreThanAskedForTakePart) {
    struct Count {
        int tasks = 0;
    } count;
    TaskRunner tasks = runnerOf(4, [](void* user, int tasksOfRun, TaskRunner::Task task, void* context) {
        static_cast<Count*>(user)->tasks = tasksOfRun;
        inOrder(nullptr, tasksOfRun, task, context);
    });
    tasks.user = &count;
    StageRunner runner(tasks);
    for (const int most : {1, 2, 4, 9}) {
        count.tasks = 1;
        int calls = 0;
        runner.region(most, [&] { runner.parallelFor(100, 1, [&](int begin, int end, int) { calls += end - begin; }); });
        EXPECT_EQ(count.tasks, most < 4 ? most : 4);
        EXPECT_EQ(calls, 100);
    }
}

TEST(StageRunner, PartsOfARegionMayStayAlone) {
    StageRunner runner(threadTasks(2));
    const auto caller = std::this_thread::get_id();
    const auto visitAll = [&](bool alone) {
        std::vector<int> visits(1000);
        runner.parallelFor(1000, 10, [&](int begin, int end, int) {
            if (alone) {
                EXPECT_EQ(std::this_thread::get_id(), caller);
            }
            for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
        });
        EXPECT_EQ(visits, std::vector<int>(1000, 1));
    };
    runner.region([&] {
        visitAll(false);
        runner.part(true, [&] {
            visitAll(true);
            runner.part(false, [&] { visitAll(true); });  // what is alone stays so
        });
        runner.part(false, [&] { visitAll(false); });
    });
    runner.region(1, [&] { runner.part(false, [&] { visitAll(true); }); });
    runner.part(true, [&] { visitAll(false); });  // outside: as if it were not there
}

TEST(StageRunner, WorkersReallyJoin) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "oneTBB starts no thread here";
    for (const TaskRunner& tasks : {threadTasks(2), tbbTasks(2)}) {
        StageRunner runner(tasks);
        // Each of two blocks waits a while for the other to begin, which takes two threads. A busy machine may not
        // grant the second one at once.
        bool joined = false;
        for (int attempt = 0; attempt < 1000 && !joined; ++attempt) {
            std::atomic<int> begun{0};
            std::atomic<int> met{0};
            runner.parallelFor(2, 1, [&](int, int, int) {
                begun.fetch_add(1);
                for (int i = 0; i < 10000 && begun.load() < 2; ++i) std::this_thread::yield();
                met.fetch_add(begun.load() == 2 ? 1 : 0);
            });
            joined = met.load() == 2;
        }
        EXPECT_TRUE(joined);
    }
}

TEST(StageRunner, ThreadsMayShareIt) {
    StageRunner runner(threadTasks(2));
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t) {
        threads.emplace_back([&] {
            std::vector<int> visits(1000);
            for (int k = 0; k < 200; ++k) {
                runner.parallelFor(1000, 10, [&](int begin, int end, int) {
                    for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
                });
            }
            EXPECT_EQ(visits, std::vector<int>(1000, 200));
        });
    }
    for (std::thread& thread : threads) thread.join();
}

TEST(Tasks, RunnersRunEachTaskOnceAndReturnAfterTheLast) {
    for (const NamedRunner& named : allRunners()) {
        if (named.runner.run == nullptr) continue;
        SCOPED_TRACE(named.name);
        struct Context {
            std::vector<std::atomic<int>> runs;
        };
        for (const int count : {0, 1, 2, 7, 100}) {
            Context context{std::vector<std::atomic<int>>(100)};
            named.runner.run(
                named.runner.user, count,
                [](void* c, int i) { static_cast<Context*>(c)->runs[static_cast<std::size_t>(i)].fetch_add(1); },
                &context);
            for (int i = 0; i < 100; ++i) {
                ASSERT_EQ(context.runs[static_cast<std::size_t>(i)].load(), i < count ? 1 : 0);
            }
        }
    }
}

TEST(Tasks, OnePoolServesWorldsOnSeveralThreads) {
    const TaskRunner tasks = threadTasks(2);
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 3; ++t) {
        threads.emplace_back([&tasks, t] {
            StageRunner runner(tasks);
            std::mt19937 random(t);
            for (int region = 0; region < 10; ++region) runRandomStages(runner, random, 10);
        });
    }
    for (std::thread& thread : threads) thread.join();
}

TEST(Tasks, PoolLivesAsLongAsACopyOfItsRunner) {
    auto runner = std::make_unique<TaskRunner>(threadTasks(2));
    const StageRunner stages(*runner);
    EXPECT_FALSE(runner->keepAlive == nullptr);
    std::weak_ptr<void> pool = runner->keepAlive;
    runner.reset();
    EXPECT_FALSE(pool.expired());
}

TEST(Tasks, NumbersOfWorkersOutOfRangeAreNamed) {
    for (const int workers : {-1, 0, 65}) {
        EXPECT_THROW(threadTasks(workers), std::invalid_argument);
        EXPECT_THROW(tbbTasks(workers), std::invalid_argument);
        try {
            StageRunner runner(runnerOf(workers, inOrder));
            FAIL() << "accepted " << workers;
        } catch (const std::invalid_argument& error) {
            EXPECT_NE(std::string(error.what()).find("workers is " + std::to_string(workers)), std::string::npos);
            EXPECT_NE(std::string(error.what()).find("1 to 64"), std::string::npos);
        }
    }
    EXPECT_EQ(StageRunner(serialTasks()).workers(), 1);
    EXPECT_EQ(StageRunner(threadTasks(3)).workers(), 3);
}

}  // namespace
}  // namespace ragtop
