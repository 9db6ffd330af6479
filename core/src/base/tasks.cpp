#include "ragtop/tasks.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/pause.h"

#ifdef RAGTOP_WITH_TBB
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace ragtop {

namespace {

constexpr int kMaxWorkers = 64;  ///< a bound on what callers ask for
/// Of waiting with the processor kept, some 10 µs: to sleep and be woken costs more.
constexpr int kRounds = 256;

void checkWorkers(int workers) {
    if (workers >= 1 && workers <= kMaxWorkers) return;
    throw std::invalid_argument("workers is " + std::to_string(workers) + "; allowed are 1 to " +
                                std::to_string(kMaxWorkers));
}

/// Threads that sleep between runs. The caller works too and never waits for a thread that has not begun: it takes
/// over what is unclaimed.
class ThreadPool {
public:
    explicit ThreadPool(int threads) {
        threads_.reserve(static_cast<std::size_t>(threads));
        try {
            for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
        } catch (...) {
            stop();
            throw;
        }
    }
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;
    ~ThreadPool() { stop(); }

    void run(int count, TaskRunner::Task task, void* context) {
        if (count <= 0) return;
        // Worlds on different threads may share the pool; their runs take turns.
        const std::lock_guard turn(turn_);
        std::unique_lock lock(mutex_);
        task_ = task;
        context_ = context;
        count_ = count;
        next_.store(1, std::memory_order_relaxed);
        runs_.fetch_add(1, std::memory_order_relaxed);
        if (count > 1) wake_.notify_all();
        lock.unlock();
        task(context, 0);
        // What is left has mostly ended, or does at once; the lock is where its threads are.
        if (next_.load(std::memory_order_acquire) < count) {
            lock.lock();
            takeTasks(lock);
            lock.unlock();
        }
        for (int i = 0; i < kRounds && running_.load(std::memory_order_acquire) > 0; ++i) pauseThread();
        if (running_.load(std::memory_order_acquire) == 0) return;
        lock.lock();
        ended_.wait(lock, [this] { return running_.load(std::memory_order_acquire) == 0; });
    }

private:
    /// Runs unclaimed tasks; holds the lock except while a task runs.
    void takeTasks(std::unique_lock<std::mutex>& lock) {
        while (next_.load(std::memory_order_relaxed) < count_) {
            const TaskRunner::Task task = task_;
            void* const context = context_;
            // In this order: who sees that nothing is left sees who has it.
            running_.fetch_add(1, std::memory_order_relaxed);
            const int index = next_.fetch_add(1, std::memory_order_release);
            lock.unlock();
            task(context, index);
            running_.fetch_sub(1, std::memory_order_release);
            lock.lock();
        }
    }

    void work() {
        std::uint64_t seen = 0;
        for (;;) {
            // The next run often follows at once; waking from sleep costs far more than this wait.
            for (int i = 0; i < kRounds && runs_.load(std::memory_order_relaxed) == seen; ++i) pauseThread();
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return stopping_ || next_.load(std::memory_order_relaxed) < count_; });
            if (stopping_) return;
            takeTasks(lock);
            seen = runs_.load(std::memory_order_relaxed);
            if (running_.load(std::memory_order_relaxed) == 0) ended_.notify_one();
        }
    }

    void stop() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        wake_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

    std::mutex turn_;
    std::mutex mutex_;  ///< guards what follows up to stopping_, but for looks
    TaskRunner::Task task_ = nullptr;
    void* context_ = nullptr;
    int count_ = 0;
    std::atomic<int> next_{0};     ///< taken with the lock alone, looked at without
    std::atomic<int> running_{0};  ///< tasks that threads of the pool, or the caller after its first, are in
    bool stopping_ = false;
    std::condition_variable wake_, ended_;
    std::atomic<std::uint64_t> runs_{0};
    std::vector<std::thread> threads_;
};

}  // namespace

TaskRunner serialTasks() { return {}; }

TaskRunner threadTasks(int workers) {
    checkWorkers(workers);
    if (workers == 1) return serialTasks();
    const auto pool = std::make_shared<ThreadPool>(workers - 1);
    TaskRunner runner;
    runner.workers = workers;
    runner.run = [](void* user, int count, TaskRunner::Task task, void* context) {
        static_cast<ThreadPool*>(user)->run(count, task, context);
    };
    runner.user = pool.get();
    runner.keepAlive = pool;
    return runner;
}

#ifdef RAGTOP_WITH_TBB

TaskRunner tbbTasks(int workers) {
    checkWorkers(workers);
    if (workers == 1) return serialTasks();
    // One slot of the arena is reserved for the thread that steps the world.
    const auto arena = std::make_shared<tbb::task_arena>(workers, 1);
    arena->initialize();
    TaskRunner runner;
    runner.workers = workers;
    runner.run = [](void* user, int count, TaskRunner::Task task, void* context) {
        static_cast<tbb::task_arena*>(user)->execute([=] {
            tbb::parallel_for(
                tbb::blocked_range<int>(0, count, 1),
                [=](const tbb::blocked_range<int>& range) {
                    for (int i = range.begin(); i != range.end(); ++i) task(context, i);
                },
                tbb::simple_partitioner{});
        });
    };
    runner.user = arena.get();
    runner.keepAlive = arena;
    return runner;
}

#else

TaskRunner tbbTasks(int workers) { return threadTasks(workers); }

#endif

}  // namespace ragtop
