// Restitution of an island: all its points at once.

#include "constraints/contact_layout.h"
#include "direct/island_system.h"

namespace ragtop::direct {

/// The speed at which points that were not struck yet will be, as the wide rows foresee it: velocities are already those
/// of the end of the substep, a fall through a gap ends within it, or in the next.
void IslandSystem::foreseeBounces(const BodyArrays& arrays, const SolverContext& context) {
    updateGaps(arrays);
    speedsAt(free_.data());
    const DVec3 gravity{context.gravity[0], context.gravity[1], context.gravity[2]};
    const double h = context.h;
    for (const SystemContact& c : contacts_) {
        if (!(c.restitution > 0)) continue;
        // Two falling bodies fall alike; only against one that does not fall does gravity close the gap.
        const double falling = (c.b != kFixed ? 1 : 0) - (c.a != kFixed ? 1 : 0);
        const double gain = h * falling * dot(c.normal, gravity);
        for (std::uint32_t j = 0; j < c.count; ++j) {
            if (pointField(c, j, contact::kPeak) > 0) continue;
            const SystemPoint& p = points_[c.first + j];
            const double speed = p.speed[0], closing = speed < 0 ? -speed * h : 0;
            double substeps = p.gap > 0 && closing > 0 ? p.gap / closing : 0;
            if (substeps > 2) substeps = 2;
            pointField(c, j, contact::kApproach) = static_cast<float>(speed - gain * (1 - substeps));
        }
    }
}

bool IslandSystem::aimAtBounce(const SolverContext& context) {
    if (!bounces_) return false;
    const float threshold = -context.restitutionSpeed;
    bool any = false;
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const float approach = pointField(c, j, contact::kApproach);
            if (!(c.restitution > 0) || !(approach < threshold) || !(pointField(c, j, contact::kPeak) > 0)) continue;
            points_[c.first + j].target = -c.restitution * static_cast<double>(approach);
            any = true;
        }
    return any;
}

void IslandSystem::carryBounce() {
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points_[c.first + j];
            pointField(c, j, contact::kPeak) += static_cast<float>(p.impulse[0] - p.load[0]);
        }
}

}  // namespace ragtop::direct
