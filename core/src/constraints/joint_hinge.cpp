#include "constraints/joint_hinge.h"

#include "constraints/joint_types.h"

namespace ragtop {

/// The errors, masses and margins of now; at the beginning of a substep also the aims of the scalar rows.
void refreshHinge(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    RigidBlock& block = joint.block;
    if (refresh.places) {
        alignHinge<float>(block, place.a, place.b, place.gap);
    } else {
        placeHinge(block, place.a, place.b, place.gap, pair.mass(joint.arms));
        joint.axis.inverseMass = freeMass(block);
    }
    const float raw = hingeAngle(place.a, place.b);
    track(joint.axis, raw);
    const double angle = unwrapped(joint.axis, raw);
    setMargins(joint.axis, angle);
    if (!refresh.begins) return;
    const Vec3 xB = block.basis.cz, load = block.impulseFirst - dot(block.impulseFirst, xB) * xB;
    const bool hadImpact =
        beginAxis(joint.axis, angle, dot(xB, pair.velocity(joint.arms).angular), length(load), refresh.context);
    beginBlock(block, hadImpact);
}

}  // namespace ragtop
