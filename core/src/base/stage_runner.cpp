#include "base/stage_runner.h"

#include <stdexcept>
#include <string>

#include "base/pause.h"

namespace ragtop {

namespace {

/// Rounds of waiting with the processor kept (some 10 µs) before it is offered to others.
constexpr int kPauses = 256;
/// Rounds after which a worker no longer believes that the region will open.
constexpr int kPatience = kPauses + 2048;

/// One round of waiting. With fewer processors than threads the peer waited for may need this one.
void waitRound(int round) {
    if (round < kPauses) {
        pauseThread();
    } else {
        std::this_thread::yield();
    }
}

constexpr std::uint64_t kFront = 1;  // a block off the front of a range
constexpr std::uint64_t kBack = std::uint64_t{1} << 32;

// Claims of an empty range push its ends past each other, by at most one per worker; hence the signed ends.
int frontOf(std::uint64_t blocks) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(blocks)); }
int backOf(std::uint64_t blocks) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(blocks >> 32)); }
bool isEmpty(std::uint64_t blocks) { return frontOf(blocks) >= backOf(blocks); }

}  // namespace

StageRunner::StageRunner(const TaskRunner& tasks) : tasks_(tasks) {
    if (tasks.workers < 1 || tasks.workers > 64) {
        throw std::invalid_argument("tasks.workers is " + std::to_string(tasks.workers) + "; allowed are 1 to 64");
    }
    workers_ = tasks.run == nullptr ? 1 : tasks.workers;
    shares_ = std::make_unique<Share[]>(static_cast<std::size_t>(workers_));
}

bool StageRunner::openRegion(int workers, BodyFunction body, void* context) {
    std::thread::id nobody;
    if (!caller_.compare_exchange_strong(nobody, std::this_thread::get_id(), std::memory_order_acquire,
                                         std::memory_order_relaxed)) {
        return false;
    }
    body_ = body;
    bodyContext_ = context;
    bodyDone_ = false;
    joined_.store(0, std::memory_order_relaxed);
    state_.store(State::waiting, std::memory_order_release);
    tasks_.run(
        tasks_.user, workers,
        [](void* self, int) {
            auto& runner = *static_cast<StageRunner*>(self);
            if (std::this_thread::get_id() != runner.caller_.load(std::memory_order_relaxed)) {
                runner.help();
            } else if (!runner.bodyDone_) {
                runner.runBody();
            }
        },
        this);
    if (!bodyDone_) runBody();
    caller_.store(std::thread::id{}, std::memory_order_release);
    return true;
}

/// An exception could not pass through a game's job system; noexcept ends the program where it was thrown.
void StageRunner::runBody() noexcept {
    bodyDone_ = true;
    state_.store(State::open, std::memory_order_release);
    body_(bodyContext_);
    state_.store(State::closed, std::memory_order_release);
}

/// The life of a worker in a region. Once the region is open its body is running, so waiting on ends with it.
void StageRunner::help() {
    for (int round = 0; state_.load(std::memory_order_acquire) == State::waiting; ++round) {
        if (round == kPatience) return;
        waitRound(round);
    }
    const int worker = 1 + joined_.fetch_add(1, std::memory_order_relaxed);
    const Share& own = shares_[static_cast<std::size_t>(worker)];
    bool look = true;  // a stage that was shared out before may have blocks left
    int round = 0;
    while (state_.load(std::memory_order_acquire) == State::open) {
        const int taken = look || !isEmpty(own.blocks.load(std::memory_order_relaxed)) ? takeBlocks(worker) : 0;
        if (taken > 0) {
            done_.fetch_add(static_cast<std::uint32_t>(taken), std::memory_order_release);
            round = 0;
        } else {
            waitRound(round < kPauses ? round++ : round);
        }
        look = round == kPauses;
    }
}

/// Claims and runs blocks of the current stage until none is left, its own ones first. All belong to one stage: the
/// caller cannot publish the next one before the blocks taken here are reported done.
int StageRunner::takeBlocks(int worker) {
    int taken = 0;
    for (int i = 0; i < workers_; ++i) {
        const int owner = worker + i < workers_ ? worker + i : worker + i - workers_;
        Share& share = shares_[static_cast<std::size_t>(owner)];
        while (!isEmpty(share.blocks.load(std::memory_order_relaxed))) {
            const std::uint64_t before = i == 0 ? share.blocks.fetch_add(kFront, std::memory_order_acquire)
                                                : share.blocks.fetch_sub(kBack, std::memory_order_acquire);
            if (isEmpty(before)) break;
            const int block = i == 0 ? frontOf(before) : backOf(before) - 1;
            const int begin = block * share.grain, left = share.count - begin;
            share.function(share.context, begin, begin + (left > share.grain ? share.grain : left), worker);
            ++taken;
        }
    }
    return taken;
}

void StageRunner::runStage(BlockFunction function, void* context, int count, int grain) {
    const int blockCount = (count - 1) / grain + 1, present = 1 + joined_.load(std::memory_order_relaxed);
    const int sharers = blockCount < present ? blockCount : present;
    const auto startOf = [&](int worker) {
        return static_cast<std::uint64_t>((static_cast<std::int64_t>(blockCount) * worker + sharers - 1) / sharers);
    };
    for (int worker = sharers; worker-- > 0;) {
        Share& share = shares_[static_cast<std::size_t>(worker)];
        share.function = function;
        share.context = context;
        share.count = count;
        share.grain = grain;
        share.blocks.store(startOf(worker) | startOf(worker + 1) << 32, std::memory_order_release);
    }
    const int taken = takeBlocks(0);
    othersBlocks_ += static_cast<std::uint32_t>(blockCount - taken);
    for (int round = 0; done_.load(std::memory_order_acquire) != othersBlocks_;) {
        waitRound(round < kPauses ? round++ : round);
    }
}

}  // namespace ragtop
