#include <stdexcept>
#include <string>

#include "world/world_impl.h"

namespace ragtop {

const CouplingDef& World::def(CouplingId coupling) const {
    return impl_->tables.couplings[indexOf(impl_->tables.couplings, coupling)].def;
}

void World::setDef(CouplingId id, const CouplingDef& def) {
    const std::uint32_t index = indexOf(impl_->tables.couplings, id);
    impl_->scene().checkCoupled(def);
    CouplingRecord& coupling = impl_->tables.couplings[index];
    bool same = def.count == coupling.def.count;
    for (int i = 0; same && i < def.count; ++i) {
        const auto &was = coupling.def.parts[static_cast<std::size_t>(i)], &is = def.parts[static_cast<std::size_t>(i)];
        same = was.joint == is.joint && was.coordinate == is.coordinate;
    }
    if (!same) throw std::invalid_argument("setDef keeps the joints of a coupling and their coordinates");
    coupling.def = def;
    compileCoupling(def, impl_->tables.joints.sims.data(), impl_->tables.couplings.sims[index]);
    for (int i = 0; i < def.count; ++i) {
        const JointRecord& joint = impl_->tables.joints[def.parts[static_cast<std::size_t>(i)].joint.index];
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (impl_->tables.bodies.moves(body)) impl_->activity().wakeBody(body);
    }
}

CouplingState World::state(CouplingId id) const {
    const WorldImpl& world = *impl_;
    const std::uint32_t index = indexOf(world.tables.couplings, id);
    const CouplingSim& sim = world.tables.couplings.sims[index];
    AxesJointSim now[CouplingSim::kMost];
    JointSim* joints[CouplingSim::kMost] = {};
    for (std::uint32_t i = 0; i < sim.count; ++i) {
        now[i] = copyOf(world.tables.joints.sims[sim.joints[i]]);
        joints[i] = &now[i];
        placeJoint(now[i], jointBodies(world.tables.bodies, world.tables.joints[sim.joints[i]]),
                   world.tables.bodies.states.data(), world.tables.bodies.inertias.data());
    }
    const float rate = world.clock.lastSubstep > 0 ? 1 / world.clock.lastSubstep : 0;
    return couplingState(sim, joints, world.tables.bodies.states.data(), world.tables.bodies.inertias.data(), rate);
}

std::uint64_t World::userData(CouplingId coupling) const {
    return impl_->tables.couplings[indexOf(impl_->tables.couplings, coupling)].def.userData;
}

}  // namespace ragtop
