#include "continuous/continuous.h"
#include "world/world_impl.h"

/// What continuous collision asks the world for.
namespace ragtop {

bool WorldImpl::mayCollide(std::uint32_t shape, std::uint32_t obstacle) const {
    const ShapeRecord &a = shapes[shape], &b = shapes[obstacle];
    if (!shouldCollide(a, b)) return false;
    return !callbacks.filter || callbacks.filter({shapes.id(shape), shapes.id(obstacle), bodies.id(a.body),
                                                  bodies.id(b.body), a.userData, b.userData});
}

/// As their contact has it, seen from the obstacle.
ContactSurface WorldImpl::surfaceOfMeeting(const Meeting& meeting) const {
    const std::uint32_t* contact = broadphase.pairs.find(pairKey(meeting.obstacle, meeting.shape));
    if (!contact) return surfaceOfPair(meeting.obstacle, meeting.shape, meeting.touch.triangle);
    ContactSurface surface = surfaceOf(contacts[*contact], meeting.touch.triangle);
    if (contacts[*contact].shapeA != meeting.obstacle) surface.surfaceVelocity = -surface.surfaceVelocity;
    return surface;
}

void WorldImpl::sweepFast() {
    sweptBodies.impacts.clear();
    if (!settings.continuous) return;
    const std::function<bool(std::uint32_t, std::uint32_t)> may = [this](std::uint32_t shape, std::uint32_t obstacle) {
        return mayCollide(shape, obstacle);
    };
    const std::function<ContactSurface(const Meeting&)> surface = [this](const Meeting& meeting) {
        return surfaceOfMeeting(meeting);
    };
    const SweepView view{tables(), broadphase, sweptBodies.startPoses(), dt, context.h, may};
    sweepFastBodies(view, {context.restitutionSpeed, surface}, {bodies, contacts, sweptBodies}, runner);
}

}  // namespace ragtop
