#include "events/event_log.h"

namespace ragtop {

void EventLog::beginStep(std::size_t bodies) {
    stepping_ = true;
    begins_.clear();
    sensorBegins_.clear();
    ends_.clear();
    sensorEnds_.clear();
    ends_.swap(endsBetween_);
    sensorEnds_.swap(sensorEndsBetween_);
    surfaces_.clear();
    breaks_.clear();
    sleeps_.clear();
    sleeps_.swap(sleepsBetween_);
    // All may wake at once, however long they have slept.
    sleeps_.reserve(bodies);
}

void EventLog::forget() {
    begins_.clear();
    ends_.clear();
    sensorBegins_.clear();
    sensorEnds_.clear();
    surfaces_.clear();
    sleeps_.clear();
    breaks_.clear();
    sleepsBetween_.clear();
}

void EventLog::end(const ContactEvent& event, bool sensor) {
    auto& now = sensor ? sensorEnds_ : ends_;
    auto& between = sensor ? sensorEndsBetween_ : endsBetween_;
    (stepping_ ? now : between).push_back(event);
}

}  // namespace ragtop
