#include <stdexcept>
#include <string>

#include "world/world_impl.h"

// Couplings between joints: their life, and their part in a step. They are few, act on up to eight bodies at once and
// are therefore solved one after the other, after the joints and contacts of all colours.
namespace ragtop {

namespace {

constexpr std::uint32_t kParts = CouplingDef::kMostParts;

std::string nameOf(int part) { return "parts[" + std::to_string(part) + "]"; }

}  // namespace

void WorldImpl::checkCoupled(const CouplingDef& def) const {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    for (int i = 0; i < def.count; ++i) {
        const CoupledCoordinate& part = def.parts[static_cast<std::size_t>(i)];
        if (!joints.slots.isValid(part.joint.index, part.joint.generation))
            throw std::invalid_argument(nameOf(i) + ".joint names no joint of this world");
        if (!hasCoordinate(joints.sims[part.joint.index].kind, part.coordinate))
            throw std::invalid_argument(nameOf(i) + ".coordinate is " + std::to_string(part.coordinate) +
                                        ", which this kind of joint does not have");
    }
}

std::uint32_t WorldImpl::createCoupling(const CouplingDef& def) {
    checkCoupled(def);
    const std::uint32_t index = couplings.acquire();
    CouplingRecord& coupling = couplings[index];
    coupling.def = def;
    compileCoupling(def, joints.sims.data(), couplings.sims[index]);
    markCoupled(couplings.sims[index], joints.sims.data());
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(def.count); ++i) {
        JointRecord& joint = joints[def.parts[i].joint.index];
        coupling.next[i] = joint.firstCoupling;
        joint.firstCoupling = kParts * index + i;
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (bodies.moves(body)) wakeBody(body);
    }
    ++structureVersion;
    islands.structureChangedAt();
    joints.bundlesChanged = directSet.treesChanged = true;
    return index;
}

void WorldImpl::destroyCoupling(std::uint32_t index) {
    const CouplingRecord& coupling = couplings[index];
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(coupling.def.count); ++i) {
        const std::uint32_t j = coupling.def.parts[i].joint.index, key = kParts * index + i;
        JointRecord& joint = joints[j];
        std::uint32_t* at = &joint.firstCoupling;
        while (*at != key) at = &couplings[*at / kParts].next[*at % kParts];
        *at = coupling.next[i];
        clearCoupled(joints.sims[j], false);
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (bodies.moves(body)) wakeBody(body);
    }
    couplings.release(index);
    for (std::uint32_t c = 0; c < couplings.slots.count(); ++c)
        if (couplings.slots.isUsed(c)) markCoupled(couplings.sims[c], joints.sims.data());
    ++structureVersion;
    islands.structureChangedAt();
    joints.bundlesChanged = directSet.treesChanged = true;
}

/// What a coupling reaches from this joint wakes with it.
void WorldImpl::pushCoupledBodies(std::uint32_t joint) {
    for (std::uint32_t key = joints[joint].firstCoupling; key != kNone;
         key = couplings[key / kParts].next[key % kParts]) {
        const CouplingDef& def = couplings[key / kParts].def;
        for (int i = 0; i < def.count; ++i) {
            const JointRecord& other = joints[def.parts[static_cast<std::size_t>(i)].joint.index];
            for (const std::uint32_t body : {other.bodyA, other.bodyB})
                if (bodies.moves(body) && !bodies.isAwake(body)) islands.stack.push(body);
        }
    }
}

bool WorldImpl::isIterated(const CouplingDef& def) const {
    for (int i = 0; i < def.count; ++i) {
        const GraphPlace& place = joints[def.parts[static_cast<std::size_t>(i)].joint.index].place;
        if (place.color == kNone || place.color == ConstraintGraph::kDirect) return false;
    }
    return true;
}

void WorldImpl::prepareCouplings(float ratio) {
    couplings.iterated.clear();
    for (std::uint32_t c = 0; c < couplings.slots.count(); ++c) {
        if (!couplings.slots.isUsed(c) || !isIterated(couplings[c].def)) continue;
        if (ratio != 1) rescale(couplings.sims[c].axis, ratio);
        couplings.iterated.push(c);
    }
}

void WorldImpl::warmStartCouplings() {
    for (const std::uint32_t c : couplings.iterated)
        for (std::uint32_t i = 0; i < couplings.sims[c].count; ++i)
            clearCoupled(joints.sims[couplings.sims[c].joints[i]], true);
    for (const std::uint32_t c : couplings.iterated) warmStartCoupling(couplings.sims[c], joints.sims.data());
}

void WorldImpl::beginCouplings() {
    for (const std::uint32_t c : couplings.iterated)
        beginCoupling(couplings.sims[c], joints.sims.data(), bodies.states.data(), bodies.inertias.data(),
                      jointContext);
}

/// A push along one joint may open another that shares a body with it: so these are solved in turn.
void WorldImpl::solveCouplings(bool moving) {
    constexpr int kRounds = 4;  // by trial
    if (!moving)
        for (const std::uint32_t c : couplings.iterated)
            refreshCoupling(couplings.sims[c], joints.sims.data(), bodies.states.data(), bodies.inertias.data());
    for (int round = 0; round < kRounds; ++round)
        for (const std::uint32_t c : couplings.iterated) {
            CouplingSim& coupling = couplings.sims[c];
            if (round > 0)
                for (std::uint32_t i = 0; i < coupling.count; ++i)
                    solveJointAgain(joints.sims[coupling.joints[i]], bodies.states.data(), bodies.inertias.data(),
                                    jointContext, moving);
            solveCoupling(coupling, joints.sims.data(), bodies.states.data(), bodies.inertias.data(), jointContext,
                          moving);
        }
}

const CouplingDef& World::def(CouplingId coupling) const { return impl_->couplings[impl_->index(coupling)].def; }

void World::setDef(CouplingId id, const CouplingDef& def) {
    const std::uint32_t index = impl_->index(id);
    impl_->checkCoupled(def);
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
            if (impl_->bodies.moves(body)) impl_->wakeBody(body);
    }
}

CouplingState World::state(CouplingId id) const {
    const WorldImpl& world = *impl_;
    const std::uint32_t index = world.index(id);
    const CouplingSim& sim = world.couplings.sims[index];
    JointSim now[CouplingSim::kMost];
    for (std::uint32_t i = 0; i < sim.count; ++i) {
        now[i] = world.joints.sims[sim.joints[i]];
        placeJoint(now[i], world.jointBodies(world.joints[sim.joints[i]]), world.bodies.states.data(),
                   world.bodies.inertias.data());
    }
    const float rate = world.lastSubstep > 0 ? 1 / world.lastSubstep : 0;
    return couplingState(sim, now, world.bodies.states.data(), world.bodies.inertias.data(), rate);
}

std::uint64_t World::userData(CouplingId coupling) const {
    return impl_->couplings[impl_->index(coupling)].def.userData;
}

}  // namespace ragtop
