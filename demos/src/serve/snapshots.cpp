#include "snapshots.h"

#include <algorithm>

namespace ragtop::live {
namespace {

constexpr double kWidestOverAge = 0.25;  ///< a gap that is made, over the age of what goes

}  // namespace

void Snapshots::add(Snapshot snapshot) {
    bytes_ += snapshot.world.size();
    kept_.push_back(std::move(snapshot));
    while ((bytes_ > budget_ || kept_.size() > kMost) && kept_.size() > 2) thin();
}

/// Neither the first nor the last goes.
void Snapshots::thin() {
    const std::uint64_t now = kept_.back().step;
    std::size_t best = 0;
    double least = kWidestOverAge;
    for (std::size_t i = 1; i + 1 < kept_.size(); ++i) {
        const std::uint64_t gap = kept_[i + 1].step - kept_[i - 1].step;
        const double cost = static_cast<double>(gap) / static_cast<double>(now - kept_[i].step);
        if (gap > kWidest || cost >= least) continue;
        best = i;
        least = cost;
    }
    drop(best != 0 ? best : 1);
}

void Snapshots::drop(std::size_t index) {
    bytes_ -= kept_[index].world.size();
    kept_.erase(kept_.begin() + static_cast<std::ptrdiff_t>(index));
}

void Snapshots::dropAfter(std::uint64_t step) {
    while (kept_.size() > 1 && kept_.back().step > step) drop(kept_.size() - 1);
}

const Snapshot& Snapshots::before(std::uint64_t step) const {
    const auto after = std::upper_bound(kept_.begin(), kept_.end(), step,
                                        [](std::uint64_t s, const Snapshot& snapshot) { return s < snapshot.step; });
    return *(after == kept_.begin() ? after : after - 1);
}

std::uint64_t Snapshots::first() const {
    const bool wide = kept_.size() > 1 && kept_[1].step - kept_[0].step > kWidest;
    return kept_[wide ? 1 : 0].step;
}

}  // namespace ragtop::live
