#pragma once

#include <atomic>
#include <cassert>
#include <cstdint>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>

#include "ragtop/tasks.h"

namespace ragtop {

/// Runs the stages of a step on all workers of a TaskRunner within one parallel region per step: starting threads once
/// per stage would cost more than most stages [Catto, SIMD Matters, 2024; Box3D solver.c; Bepu2 ThreadDispatcher].
///
/// In a region the runner is given as many tasks as it has workers. The one that runs on the calling thread executes
/// the body; the others wait for stages that the body publishes, claim blocks of them and leave when the region is
/// closed. The caller claims blocks too and waits only for blocks that another worker has claimed, so a worker that is
/// late, or never comes, costs nothing but its help.
///
/// Any order of tasks is fine. A runner that executes them one after the other on the calling thread runs the body in
/// whichever comes first, and the others see it done. Tasks on other threads wait for the body for a bounded time and
/// then leave, so a runner that starts the caller's task only after they have ended does not deadlock; if no task ran
/// on the calling thread, the body runs there, alone, after the runner has returned.
///
/// Claiming: the blocks of a stage are shared out in order, one range per worker that is there, so that a worker meets
/// the same data in the next stage; who has finished its own range takes blocks of another's. A range is one 64-bit
/// word, [begin, end) in its low and high half, in a cache line of its own with what the stage is: waking a worker moves
/// one line, and claims within its range move none. Its owner takes blocks from the front, others from the back. A claim
/// is one atomic add that returns the range as it was; it holds if that range was not empty. Only then does a worker read
/// what the stage is, which the caller cannot change before the claimed block is reported done. So a worker that wakes
/// in a later stage than it slept in claims a block of the later one, and there is no ABA problem.
class StageRunner {
public:
    /// Throws std::invalid_argument when tasks.workers is not 1 to 64.
    explicit StageRunner(const TaskRunner& tasks);
    StageRunner(const StageRunner&) = delete;
    StageRunner& operator=(const StageRunner&) = delete;

    /// Workers that may run at once; 1 when everything runs on the calling thread.
    int workers() const { return workers_; }

    /// Everything inside `body()`, executed on the calling thread, may call parallelFor; up to `most` workers join it, the
    /// caller counted. The body must not throw.
    template <class Body>
    void region(int most, Body&& body) {
        using Function = std::remove_reference_t<Body>;
        const BodyFunction call = [](void* context) { (*static_cast<Function*>(context))(); };
        const int workers = most < workers_ ? most : workers_;
        if (workers_ == 1 || inRegion()) return body();
        if (workers == 1) return serialRegion(body);
        if (!openRegion(workers, call, addressOf(body))) body();
    }
    template <class Body>
    void region(Body&& body) {
        region(workers_, body);
    }

    /// Within a region: a part of it that workers are not asked to help with if `alone`.
    template <class Part>
    void part(bool alone, Part&& part) {
        if (!inRegion()) return part();
        const bool before = serial_;
        serial_ = before || alone;
        part();
        serial_ = before;
    }

    /// The same on the calling thread alone: waking workers costs more than they could help with little work.
    template <class Body>
    void serialRegion(Body&& body) {
        std::thread::id nobody;
        const bool taken =
            caller_.compare_exchange_strong(nobody, std::this_thread::get_id(), std::memory_order_acquire);
        if (!taken) return body();
        serial_ = true;
        body();
        serial_ = false;
        caller_.store(std::thread::id{}, std::memory_order_release);
    }

    /// Calls body(begin, end, worker) for blocks of `grain` that make up [0, count), each once, on any worker (0 is the
    /// calling thread); returns when all are done. Inline when there is one block or one worker; opens a region for the
    /// call when there is none. Any number of threads may call it at once: those that find the workers busy with
    /// another's region run alone, as worker 0 too. Blocks may not start further loops.
    template <class F>
    void parallelFor(int count, int grain, F&& body) {
        assert(grain > 0);
        if (count <= 0) return;
        if (count <= grain || workers_ == 1) {
            body(0, count, 0);
            return;
        }
        using Function = std::remove_reference_t<F>;
        const BlockFunction call = [](void* context, int begin, int end, int worker) {
            (*static_cast<Function*>(context))(begin, end, worker);
        };
        if (inRegion()) {
            if (serial_) return body(0, count, 0);
            runStage(call, addressOf(body), count, grain);
            return;
        }
        auto stage = [&] { runStage(call, addressOf(body), count, grain); };
        using Stage = decltype(stage);
        if (!openRegion(workers_, [](void* context) { (*static_cast<Stage*>(context))(); }, &stage)) body(0, count, 0);
    }

private:
    using BlockFunction = void (*)(void* context, int begin, int end, int worker);
    using BodyFunction = void (*)(void* context);
    enum class State : std::uint32_t { waiting, open, closed };

    template <class F>
    static void* addressOf(F& function) {
        return const_cast<void*>(static_cast<const void*>(std::addressof(function)));
    }

    /// The blocks of a stage that are a worker's to begin with, and the stage.
    struct alignas(64) Share {
        std::atomic<std::uint64_t> blocks{0};
        BlockFunction function = nullptr;
        void* context = nullptr;
        int count = 0;
        int grain = 1;
    };

    bool inRegion() const { return caller_.load(std::memory_order_relaxed) == std::this_thread::get_id(); }
    /// False, and nothing is run, while another thread has a region.
    bool openRegion(int workers, BodyFunction body, void* context);
    void runBody() noexcept;
    void help();
    int takeBlocks(int worker);
    void runStage(BlockFunction function, void* context, int count, int grain);

    TaskRunner tasks_;
    int workers_ = 1;
    std::unique_ptr<Share[]> shares_;        ///< one per worker
    std::atomic<std::thread::id> caller_{};  ///< whose region it is
    bool bodyDone_ = false;                  ///< of the caller alone
    bool serial_ = false;                    ///< of the caller alone: its region has no workers, or does not ask them
    BodyFunction body_ = nullptr;
    void* bodyContext_ = nullptr;
    std::uint32_t othersBlocks_ = 0;  ///< of the caller alone: blocks that others have done since the runner was made

    // What waiting workers look at, besides their shares.
    alignas(64) std::atomic<State> state_{State::waiting};
    std::atomic<int> joined_{0};

    alignas(64) std::atomic<std::uint32_t> done_{0};  ///< counts with othersBlocks_ and wraps as that does
};

}  // namespace ragtop
