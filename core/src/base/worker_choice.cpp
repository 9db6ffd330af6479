#include "base/worker_choice.h"

#include <algorithm>

namespace ragtop {

WorkerChoice::WorkerChoice(int workers) {
    const auto add = [&](Sharing sharing) { way(count_++).sharing = sharing; };
    add({workers, true});
    if (workers == 1) return;
    add({1, false});
    add({workers, false});
    if (workers >= 4) add({workers / 2, true});
}

void WorkerChoice::note(float seconds, float size) {
    if (count_ == 1 || !(size > 0) || !(seconds > 0)) return;
    ++step_;
    if (!(size < kSameSize * size_ && size_ < kSameSize * size)) go(current_);
    if (tried_ == current_) size_ = size;
    const float rate = seconds / size;
    const int number = steps_++;
    if (tried_ != current_) trial_[static_cast<std::size_t>(number)] = rate;
    if (number == 0) return;  // it finds its data in the caches of others, and helpers asleep
    if (tried_ == current_) {
        recent_[static_cast<std::size_t>(number) % recent_.size()] = rate;
        if (steps_ >= kTrial) beginTrial();
    } else if (steps_ == kTrial) {
        endTrial();
    }
}

void WorkerChoice::go(int tried) {
    tried_ = tried;
    steps_ = 0;
}

/// Of the way that has waited longest, if any has waited enough.
void WorkerChoice::beginTrial() {
    int longest = current_;
    for (int i = 0; i < count_; ++i)
        if (i != current_ && way(i).due <= step_ && (longest == current_ || way(i).due < way(longest).due)) longest = i;
    if (longest != current_) go(longest);
}

/// A way that took longer by the share r in each of k steps waits for k r (ways − 1)/kCost steps: then all trials
/// together cost no more than kCost. A single step that took far longer than the others says nothing about the way.
void WorkerChoice::endTrial() {
    const float own = *std::min_element(recent_.begin(), recent_.end());
    std::sort(trial_.begin() + 1, trial_.end());
    const float best = trial_[1], usual = trial_[kTrial / 2];
    if (best < (1 - kWorth) * own) {
        // What seemed faster because of a disturbance is found out soon.
        way(current_).wait = kFirstWait;
        way(current_).due = step_ + kFirstWait;
        current_ = tried_;
    } else {
        Way& lost = way(tried_);
        const float taken = (kTrial - 1) * usual + std::min(trial_[0], 2 * usual);
        const float lostSteps = std::max(taken / own - static_cast<float>(kTrial), 0.0f);
        const float bound = std::min(lostSteps * static_cast<float>(count_ - 1) / kCost, kLongestWait);
        lost.due = step_ + std::max(lost.wait, static_cast<std::uint64_t>(bound));
        lost.wait = std::min(2 * lost.wait, kMostWait);
    }
    go(current_);
}

}  // namespace ragtop
