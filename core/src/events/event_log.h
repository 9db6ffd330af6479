#pragma once

#include <cstddef>
#include <memory_resource>
#include <span>
#include <vector>

#include "ragtop/events.h"

namespace ragtop {

/// What a step tells: touching that began or ended, impacts, slides, rolls, sleep, joints that broke. What calls
/// between two steps end, or put to sleep, is told by the next step. Spans hold until then.
class EventLog {
public:
    explicit EventLog(std::pmr::memory_resource* memory)
        : begins_(memory),
          ends_(memory),
          sensorBegins_(memory),
          sensorEnds_(memory),
          endsBetween_(memory),
          sensorEndsBetween_(memory),
          surfaces_(memory),
          sleeps_(memory),
          sleepsBetween_(memory),
          breaks_(memory) {}

    /// A step begins, in which so many bodies may wake or fall asleep without taking memory.
    void beginStep(std::size_t bodies);
    void endStep() { stepping_ = false; }
    /// After a state was restored, of which the ends between steps are a part.
    void forget();

    void begin(const ContactEvent& event, bool sensor) { (sensor ? sensorBegins_ : begins_).push_back(event); }
    void end(const ContactEvent& event, bool sensor);
    void surface(const SurfaceEvent& event) { surfaces_.push_back(event); }
    void sleep(const SleepEvent& event) { (stepping_ ? sleeps_ : sleepsBetween_).push_back(event); }
    /// The last one was none: of a body that was just made, or is destroyed.
    void takeBackSleep() { (stepping_ ? sleeps_ : sleepsBetween_).pop_back(); }
    void jointBreak(const JointBreak& event) { breaks_.push_back(event); }

    std::span<const ContactEvent> begins() const { return begins_; }
    std::span<const ContactEvent> ends() const { return ends_; }
    std::span<const ContactEvent> sensorBegins() const { return sensorBegins_; }
    std::span<const ContactEvent> sensorEnds() const { return sensorEnds_; }
    std::span<const SurfaceEvent> surfaces() const { return surfaces_; }
    std::span<const SleepEvent> sleeps() const { return sleeps_; }
    std::span<const JointBreak> breaks() const { return breaks_; }

    template <class Archive>
    void archive(Archive& archive) {
        archive.events(endsBetween_);
        archive.events(sensorEndsBetween_);
    }

private:
    std::pmr::vector<ContactEvent> begins_, ends_, sensorBegins_, sensorEnds_;
    std::pmr::vector<ContactEvent> endsBetween_, sensorEndsBetween_;
    std::pmr::vector<SurfaceEvent> surfaces_;
    std::pmr::vector<SleepEvent> sleeps_, sleepsBetween_;
    std::pmr::vector<JointBreak> breaks_;
    bool stepping_ = false;
};

}  // namespace ragtop
