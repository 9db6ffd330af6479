#include <algorithm>

#include "contacts/may_collide.h"
#include "contacts/surfaces.h"
#include "continuous/continuous.h"
#include "world/world_impl.h"

/// What continuous collision asks the world for.
namespace ragtop {

void WorldImpl::sweepFast() {
    collision.swept.impacts.clear();
    const AlignedArray<BodyFlag>& flags = collision.swept.flags;
    if (!settings.continuous || std::find(flags.begin(), flags.end(), kToSweep) == flags.end()) return;
    const std::function<bool(std::uint32_t, std::uint32_t)> may = [this](std::uint32_t shape, std::uint32_t obstacle) {
        return shouldCollide(tables.bodies, tables.shapes, tables.joints, tables.shapes[shape],
                             tables.shapes[obstacle]) &&
               (!callbacks.filter || callbacks.filter(pairInfo(tables.bodies, tables.shapes, shape, obstacle)));
    };
    const std::function<ContactSurface(const Meeting&)> surfaceAt = [this](const Meeting& meeting) {
        // As their contact has it, seen from the obstacle.
        const std::uint32_t* contact = collision.broadphase.pairs.find(pairKey(meeting.obstacle, meeting.shape));
        const bool swap = contact && tables.contacts[*contact].shapeA != meeting.obstacle;
        const std::uint32_t a = swap ? meeting.shape : meeting.obstacle, b = swap ? meeting.obstacle : meeting.shape;
        ContactSurface surface = surfaceOf(tables.bodies, tables.shapes, a, b, meeting.touch.triangle);
        if (contact && callbacks.modify) callbacks.modify(pairInfo(tables.bodies, tables.shapes, a, b), surface);
        if (swap) surface.surfaceVelocity = -surface.surfaceVelocity;
        return surface;
    };
    const SweepView view{tables, collision.broadphase, collision.swept.startPoses(), clock.dt, solving.context.h, may};
    sweepFastBodies(view, {solving.context.restitutionSpeed, surfaceAt},
                    {tables.bodies, tables.contacts, collision.swept}, machine.runner);
}

}  // namespace ragtop
