#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace ragtop {

/// Who takes part in a step.
struct Sharing {
    int workers = 1;          ///< the calling thread included
    bool shareSolve = false;  ///< the many short stages of the solver too, and not the others alone

    bool operator==(const Sharing&) const = default;
};

/// Chooses who takes part in the coming step by what steps have taken. Whether help pays is not known beforehand:
/// handing a stage over takes 0.1 to 2 µs, as the processors share a cache or not, and a step has a hundred stages of a
/// few microseconds. Results do not depend on the choice (docs/adr/0006).
///
/// Ways to share a step are compared by time over size, which the caller counts. One of them is the current one; now and
/// then another is tried for kTrial steps. The fastest of these, the first left aside, is held against the fastest of as
/// many steps just before, and becomes the current way if it is faster by kWorth. How long a way that took longer by
/// some share waits for its next trial bounds what trials cost to kCost of the time; steps in which something else had
/// the processors, or the solver much to do, are not laid to a way's charge. Takes no memory.
class WorkerChoice {
public:
    static constexpr float kCost = 0.01f;  ///< of the time
    static constexpr float kWorth = 0.03f;  ///< of a step's time
    static constexpr int kTrial = 4;  ///< steps, of which the first does not count
    /// Steps to the first repetition of a trial; each that is lost doubles them, up to kMostWait.
    static constexpr std::uint64_t kFirstWait = 16, kMostWait = 256;
    /// However much slower a way was: what made it so may have gone. What takes four times as long still keeps to kCost.
    static constexpr float kLongestWait = 4096;
    /// Ratio of sizes beyond which steps are not held against each other.
    static constexpr float kSameSize = 1.25f;

    /// Of at most so many workers; with one there is nothing to choose.
    explicit WorkerChoice(int workers);

    /// For the coming step.
    Sharing next() const { return way(tried_).sharing; }
    /// What that step took, and a measure of its size: steps of one size should take equally long.
    void note(float seconds, float size);

private:
    struct Way {
        Sharing sharing;
        std::uint64_t due = 0;  ///< step of its next trial
        std::uint64_t wait = kFirstWait;
    };

    const Way& way(int index) const { return ways_[static_cast<std::size_t>(index)]; }
    Way& way(int index) { return ways_[static_cast<std::size_t>(index)]; }
    void go(int tried);
    void beginTrial();
    void endTrial();

    std::array<Way, 4> ways_;
    int count_ = 0;
    int current_ = 0, tried_ = 0;
    std::uint64_t step_ = 0;
    int steps_ = 0;   ///< of the way that is tried, since it began
    float size_ = 0;  ///< of the last step of the current way
    std::array<float, kTrial - 1> recent_{};  ///< rates of the current way
    std::array<float, kTrial> trial_{};       ///< rates of the way that is tried
};

}  // namespace ragtop
