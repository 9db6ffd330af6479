#include "model/coupling_passes.h"

namespace ragtop {

static bool isIterated(const Joints& joints, const CouplingDef& def) {
    for (int i = 0; i < def.count; ++i) {
        const GraphPlace& place = joints[def.parts[static_cast<std::size_t>(i)].joint.index].place;
        if (place.color == kNone || place.color == ConstraintGraph::kDirect) return false;
    }
    return true;
}

void prepareCouplings(Couplings& couplings, const Joints& joints, float ratio) {
    couplings.iterated.clear();
    for (std::uint32_t c = 0; c < couplings.slots.count(); ++c) {
        if (!couplings.slots.isUsed(c) || !isIterated(joints, couplings[c].def)) continue;
        if (ratio != 1) rescale(couplings.sims[c].axis, ratio);
        couplings.iterated.push(c);
    }
}

void warmStartCouplings(Couplings& couplings, Joints& joints) {
    for (const std::uint32_t c : couplings.iterated)
        for (std::uint32_t i = 0; i < couplings.sims[c].count; ++i)
            clearCoupled(joints.sims[couplings.sims[c].joints[i]], true);
    for (const std::uint32_t c : couplings.iterated) warmStartCoupling(couplings.sims[c], joints.sims.data());
}

void beginCouplings(Couplings& couplings, Joints& joints, Bodies& bodies, const JointContext& context) {
    for (const std::uint32_t c : couplings.iterated)
        beginCoupling(couplings.sims[c], joints.sims.data(), bodies.states.data(), bodies.inertias.data(), context);
}

void solveCouplings(Couplings& couplings, Joints& joints, Bodies& bodies, const JointContext& context, bool moving) {
    constexpr int kRounds = 4;  // by trial
    if (couplings.iterated.empty()) return;
    if (!moving)
        for (const std::uint32_t c : couplings.iterated)
            refreshCoupling(couplings.sims[c], joints.sims.data(), bodies.states.data(), bodies.inertias.data());
    for (int round = 0; round < kRounds; ++round)
        for (const std::uint32_t c : couplings.iterated) {
            CouplingSim& coupling = couplings.sims[c];
            if (round > 0)
                for (std::uint32_t i = 0; i < coupling.count; ++i)
                    solveJointAgain(joints.sims[coupling.joints[i]], bodies.states.data(), bodies.inertias.data(),
                                    context, moving);
            solveCoupling(coupling, joints.sims.data(), bodies.states.data(), bodies.inertias.data(), context, moving);
        }
}

}  // namespace ragtop
