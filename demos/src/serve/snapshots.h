#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "ragtop/tuning.h"

namespace ragtop::live {

/// The values of all tunables, in their order.
using TuneState = std::vector<TuneValue>;

/// A world after a step and before the inputs of that step, and what is not in its state.
struct Snapshot {
    std::uint64_t step = 0;
    std::vector<std::byte> world{};
    std::shared_ptr<const TuneState> tuned{};
    std::vector<bool> driven{};
};

/// Snapshots by rising step within a budget of memory. Where it does not suffice those are dropped whose loss leaves
/// the smallest gap relative to their age, so that gaps grow with age; no gap grows beyond kWidest steps or a quarter
/// of its age, rather the oldest go. The very first is always kept.
class Snapshots {
public:
    static constexpr std::uint64_t kEvery = 10;    ///< steps between two that are taken
    static constexpr std::uint64_t kWidest = 120;  ///< steps between two that are kept
    static constexpr std::size_t kMost = 2000;

    explicit Snapshots(std::size_t budget) : budget_(budget) {}

    /// `snapshot` is later than all there are.
    void add(Snapshot snapshot);
    /// Drops those after `step`.
    void dropAfter(std::uint64_t step);
    /// The latest at or before `step`, which is not before first().
    const Snapshot& before(std::uint64_t step) const;
    const Snapshot& initial() const { return kept_.front(); }
    /// The earliest step from which on the gaps are narrow.
    std::uint64_t first() const;
    std::uint64_t last() const { return kept_.back().step; }
    std::size_t size() const { return kept_.size(); }
    std::size_t bytes() const { return bytes_; }

private:
    void thin();
    void drop(std::size_t index);

    std::size_t budget_;
    std::size_t bytes_ = 0;
    std::vector<Snapshot> kept_;
};

}  // namespace ragtop::live
