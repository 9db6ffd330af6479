#include <atomic>
#include <stdexcept>
#include <string>

#include "world/world_impl.h"

namespace ragtop {

/// Whether a body can be given this. What is no number throws, but not within a step: there it is left out, and counts.
bool WorldImpl::takes(bool finite, const char* what) {
    if (finite) return true;
    if (!inStep) throw std::invalid_argument(std::string(what) + " is not finite");
    std::atomic_ref(outOfRange).fetch_add(1, std::memory_order_relaxed);
    return false;
}

/// One body's failure is not to be that of all it touches.
void WorldImpl::stopOutOfRange() {
    for (std::size_t i = 0; i < bodies.awake.size(); ++i) {
        if (sweptBodies.flags[i] != kOutOfRange) continue;
        sweptBodies.flags[i] = kNotFast;
        ++outOfRange;
        scene().forgetImpulses(bodies.awake[i]);
    }
}

}  // namespace ragtop
