#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cast.h"
#include "hand.h"
#include "input.h"
#include "live_tuning.h"
#include "snapshots.h"

namespace ragtop::live {

/// A world in time: it steps, takes inputs between steps, and goes back.
///
/// Every input is logged with the step after which it came. A step that was made before is made again from the nearest
/// snapshot with the log, and is the same to the bit. Going on from the past follows the log until a new input comes,
/// which drops the future.
class LiveWorld {
public:
    /// All must outlive it; the world stays where it is. `snapshotBytes` is what snapshots may take.
    LiveWorld(Cast& cast, Tuning& tuning, std::size_t snapshotBytes);

    void step();
    /// Throws std::out_of_range unless first() ≤ step ≤ last().
    void seek(std::uint64_t step);
    /// To the first state of all, with what is tuned; the log ends there.
    void restart();
    std::uint64_t now() const;
    std::uint64_t first() const { return snapshots_.first(); }
    /// The latest step made, which may lie in the future.
    std::uint64_t last() const { return last_; }

    /// Does it now and logs it. The ball that was shot, else null. Throws std::invalid_argument and changes nothing.
    BodyId apply(const Input& input);
    /// Counts how often the future was dropped: ids of bodies of an earlier timeline may come to name others.
    std::uint64_t timeline() const { return timeline_; }

    const Hand& hand() const { return hand_; }
    /// Vehicles that somebody drives in place of their script.
    const std::vector<bool>& driven() const { return driven_; }
    const Snapshots& snapshots() const { return snapshots_; }

private:
    struct Entry {
        std::uint64_t step;
        Input input;
    };

    BodyId perform(const Input& input);
    void drive(const DriveInput& input);
    void resetVehicle(const ResetInput& input);
    void restore(const Snapshot& from);
    void replay(std::uint64_t step);
    void keep();

    Cast& cast_;
    Tuning& tuning_;
    Hand hand_;
    std::vector<bool> driven_;
    Snapshots snapshots_;
    std::vector<Entry> log_;  // by rising step
    std::uint64_t last_ = 0, timeline_ = 0;
};

}  // namespace ragtop::live
