#include "contacts/may_collide.h"
#include "contacts/surfaces.h"
#include "continuous/continuous.h"
#include "world/world_impl.h"

/// What continuous collision asks the world for.
namespace ragtop {

void WorldImpl::sweepFast() {
    sweptBodies.impacts.clear();
    if (!settings.continuous) return;
    const std::function<bool(std::uint32_t, std::uint32_t)> may = [this](std::uint32_t shape, std::uint32_t obstacle) {
        return shouldCollide(bodies, shapes, joints, shapes[shape], shapes[obstacle]) &&
               (!callbacks.filter || callbacks.filter(pairInfo(bodies, shapes, shape, obstacle)));
    };
    const std::function<ContactSurface(const Meeting&)> surfaceAt = [this](const Meeting& meeting) {
        // As their contact has it, seen from the obstacle.
        const std::uint32_t* contact = broadphase.pairs.find(pairKey(meeting.obstacle, meeting.shape));
        const bool swap = contact && contacts[*contact].shapeA != meeting.obstacle;
        const std::uint32_t a = swap ? meeting.shape : meeting.obstacle, b = swap ? meeting.obstacle : meeting.shape;
        ContactSurface surface = surfaceOf(bodies, shapes, a, b, meeting.touch.triangle);
        if (contact && callbacks.modify) callbacks.modify(pairInfo(bodies, shapes, a, b), surface);
        if (swap) surface.surfaceVelocity = -surface.surfaceVelocity;
        return surface;
    };
    const SweepView view{tables(), broadphase, sweptBodies.startPoses(), dt, context.h, may};
    sweepFastBodies(view, {context.restitutionSpeed, surfaceAt}, {bodies, contacts, sweptBodies}, runner);
}

}  // namespace ragtop
