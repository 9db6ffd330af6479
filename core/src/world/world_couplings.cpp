#include <stdexcept>
#include <string>

#include "world/world_impl.h"

namespace ragtop {

const CouplingDef& World::def(CouplingId coupling) const {
    return impl_->couplings[indexOf(impl_->couplings, coupling)].def;
}

void World::setDef(CouplingId id, const CouplingDef& def) {
    const std::uint32_t index = indexOf(impl_->couplings, id);
    impl_->scene().checkCoupled(def);
    CouplingRecord& coupling = impl_->couplings[index];
    bool same = def.count == coupling.def.count;
    for (int i = 0; same && i < def.count; ++i) {
        const auto &was = coupling.def.parts[static_cast<std::size_t>(i)], &is = def.parts[static_cast<std::size_t>(i)];
        same = was.joint == is.joint && was.coordinate == is.coordinate;
    }
    if (!same) throw std::invalid_argument("setDef keeps the joints of a coupling and their coordinates");
    coupling.def = def;
    compileCoupling(def, impl_->joints.sims.data(), impl_->couplings.sims[index]);
    for (int i = 0; i < def.count; ++i) {
        const JointRecord& joint = impl_->joints[def.parts[static_cast<std::size_t>(i)].joint.index];
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (impl_->bodies.moves(body)) impl_->activity().wakeBody(body);
    }
}

CouplingState World::state(CouplingId id) const {
    const WorldImpl& world = *impl_;
    const std::uint32_t index = indexOf(world.couplings, id);
    const CouplingSim& sim = world.couplings.sims[index];
    JointSim now[CouplingSim::kMost];
    for (std::uint32_t i = 0; i < sim.count; ++i) {
        now[i] = world.joints.sims[sim.joints[i]];
        placeJoint(now[i], jointBodies(world.bodies, world.joints[sim.joints[i]]), world.bodies.states.data(),
                   world.bodies.inertias.data());
    }
    const float rate = world.lastSubstep > 0 ? 1 / world.lastSubstep : 0;
    return couplingState(sim, now, world.bodies.states.data(), world.bodies.inertias.data(), rate);
}

std::uint64_t World::userData(CouplingId coupling) const {
    return impl_->couplings[indexOf(impl_->couplings, coupling)].def.userData;
}

}  // namespace ragtop
