#include <atomic>
#include <stdexcept>
#include <string>

#include "world/world_impl.h"

namespace ragtop {

/// Within a step, what is no number is left out, and counts.
bool WorldImpl::takes(bool finite, const char* what) {
    if (finite) return true;
    if (!clock.inStep) throw std::invalid_argument(std::string(what) + " is not finite");
    std::atomic_ref(guards.outOfRange).fetch_add(1, std::memory_order_relaxed);
    return false;
}

/// One body's failure is not to be that of all it touches.
void WorldImpl::stopOutOfRange() {
    for (std::size_t i = 0; i < tables.bodies.awake.size(); ++i) {
        if (collision.swept.flags[i] != kOutOfRange) continue;
        collision.swept.flags[i] = kNotFast;
        ++guards.outOfRange;
        scene().forgetImpulses(tables.bodies.awake[i]);
    }
}

}  // namespace ragtop
