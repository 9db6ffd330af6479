#include <stdexcept>
#include <string>

#include "scene/scene.h"

namespace ragtop {

namespace {

constexpr std::uint32_t kParts = CouplingDef::kMostParts;

std::string nameOf(int part) { return "parts[" + std::to_string(part) + "]"; }

}  // namespace

void Scene::checkCoupled(const CouplingDef& def) const {
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

std::uint32_t Scene::createCoupling(const CouplingDef& def) const {
    checkCoupled(def);
    const std::uint32_t index = couplings.acquire();
    CouplingRecord& coupling = couplings[index];
    coupling.def = def;
    compileCoupling(def, joints.sims.data(), couplings.sims[index]);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(def.count); ++i) {
        JointRecord& joint = joints[def.parts[i].joint.index];
        const bool held = mayHold(bodies, joint);
        coupling.next[i] = joint.firstCoupling;
        joint.firstCoupling = kParts * index + i;
        settleJoint(def.parts[i].joint.index, held);
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (bodies.moves(body)) activity.wakeBody(body);
        activity.addJointToGraph(def.parts[i].joint.index);
    }
    markCoupled(couplings.sims[index], joints.sims.data());
    ++versions.structure;
    islands.structureChangedAt();
    joints.bundlesChanged = directSet.treesChanged = true;
    return index;
}

void Scene::destroyCoupling(std::uint32_t index) const {
    const CouplingRecord& coupling = couplings[index];
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(coupling.def.count); ++i) {
        const std::uint32_t j = coupling.def.parts[i].joint.index, key = kParts * index + i;
        JointRecord& joint = joints[j];
        std::uint32_t* at = &joint.firstCoupling;
        while (*at != key) at = &couplings[*at / kParts].next[*at % kParts];
        const bool held = mayHold(bodies, joint);
        *at = coupling.next[i];
        clearCoupled(joints.sims[j], false);
        if (!mayHold(bodies, joint)) activity.removeJointFromGraph(j);
        settleJoint(j, held);
        for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
            if (bodies.moves(body)) activity.wakeBody(body);
    }
    couplings.release(index);
    for (std::uint32_t c = 0; c < couplings.slots.count(); ++c)
        if (couplings.slots.isUsed(c)) markCoupled(couplings.sims[c], joints.sims.data());
    ++versions.structure;
    islands.structureChangedAt();
    joints.bundlesChanged = directSet.treesChanged = true;
}

}  // namespace ragtop
