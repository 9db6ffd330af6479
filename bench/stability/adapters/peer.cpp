#include "peer.h"

#include "../scenery.h"
#include "base/symmetric_eigen.h"

namespace ragtop::stability {

Inertial inertialOf(const BodyDef& def) {
    if (def.type != BodyType::dynamic) return {};
    const MassProperties mass = massOf(def);
    const PrincipalAxes axes = principalAxes(mass.inertia);
    return {static_cast<double>(mass.mass), axes.values, {mass.center, axes.rotation}};
}

PeerBodies::PeerBodies(const Scene& scene) {
    for (const SceneBody& body : scene.bodies) add(body.def);
}

void PeerBodies::add(const BodyDef& def) {
    defs_.push_back(def);
    inertials_.push_back(inertialOf(def));
}

Frame PeerBodies::local(int body, const Frame& frame) const {
    return body == kWorld ? frame : inverse(inertial(body).frame) * frame;
}

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& joint) -> const JointBodies& { return joint.bodies; }, def);
}

bool isPlain(const HingeDef& hinge) {
    return !hinge.bearing && !(hinge.stop.restitution > 0) && !(hinge.stop.stiffness > 0) &&
           (!hinge.spring || !(hinge.spring->frequency > 0));
}

}  // namespace ragtop::stability
