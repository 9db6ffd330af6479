#include "world/multirate.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/economy.h"
#include "direct/joint_tuning.h"

namespace ragtop {

namespace {

template <class Visit>
void forMembers(const MultirateView& view, const DirectIsland& island, Visit&& visit) {
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) visit(view.directSet.bodies[island.firstBody + i]);
}

/// Does a module act on bodies of it between two substeps?
bool isLookedAt(const MultirateView& view, const DirectIsland& island) {
    bool looked = false;
    if (view.moduleWork.acts())
        forMembers(view, island, [&](std::uint32_t body) { looked |= view.moduleWork.actsOn(body); });
    return looked;
}

struct Pace {
    int stepFactor;
    bool independent;
};

/// A tree takes as many substeps at once as its gaps allow and no link turns too far in, and is independent if what it
/// hangs from stands still. Trees that hang from nothing share their parabola with other free trees unless they are
/// leapfrog trees.
Pace paceOf(const MultirateView& view, const direct::TreePlan::Tree& tree, bool mayBeIndependent) {
    const DirectIsland& island = view.directSet.islands[tree.owner];
    const BodyState& anchor = view.bodies.states[tree.anchor];
    if (isLookedAt(view, island)) return {1, false};
    if (anchor.v != Vec3{} || anchor.w != Vec3{}) return {1, false};
    const bool hangs = view.directSet.trees.linkOf(tree, 0).joint != direct::TreeJoint::free;
    if (!island.multirate) return {1, mayBeIndependent && (hangs || island.leapfrog)};
    float square = 0;
    int most = direct::TreePlan::kLongestFactor;
    forMembers(view, island, [&](std::uint32_t body) {
        square = std::max(square, lengthSquared(view.bodies.states[body].w));
        most = std::min(most, static_cast<int>(view.bodies[body].direct.pace.allowedFactor));
    });
    const float longest = static_cast<float>(direct::tuning::kLongTurn) / view.context.h;
    int stepFactor = 1;
    while (economy.calmTrees && 2 * stepFactor <= most && view.settings.substeps % (2 * stepFactor) == 0 &&
           square * static_cast<float>(4 * stepFactor * stepFactor) < longest * longest)
        stepFactor *= 2;
    return {stepFactor, mayBeIndependent};
}

/// Does anything that it touches or hangs from move by itself?
bool isCarried(const MultirateView& view, const DirectIsland& island) {
    bool carried = false;
    const auto note = [&](std::uint32_t body) {
        const BodyState& state = view.bodies.states[body];
        carried |= !view.bodies.moves(body) && (state.v != Vec3{} || state.w != Vec3{});
    };
    for (std::uint32_t i = 0; i < island.contactCount; ++i) {
        const ContactRecord& contact =
            view.contacts[view.manifolds[view.directSet.manifolds[island.firstContact + i]].contact];
        note(contact.bodyA), note(contact.bodyB);
    }
    for (std::uint32_t i = 0; i < island.jointCount; ++i) {
        const JointRecord& joint = view.joints[view.directSet.joints[island.firstJoint + i]];
        note(joint.bodyA), note(joint.bodyB);
    }
    return carried;
}

/// What stiff springs hold upright, and hardly moves, takes longer substeps when it has done so for a while, and single
/// ones as soon as anything of it moves: an answer that is at rest is the same for all of them.
int standingFactor(const MultirateView& view, const DirectIsland& island) {
    constexpr float kCalm = 0.01f;       // speed of a body that stands, in √(gravity · size)
    constexpr std::uint8_t kSteps = 16;  // for which it has stood: a quarter of a second at 60 Hz
    const auto& first = view.bodies[view.directSet.bodies[island.firstBody]].direct;
    const bool stands = first.reason == direct::Reason::stiff && !island.tree && !island.mechanism &&
                        island.jointCount > 0 && island.contactCount > 0;
    if (!stands || !economy.calmTrees) return 1;
    bool calm = !isCarried(view, island);
    const float gravity = length(view.settings.gravity);
    int most = direct::TreePlan::kLongestFactor, steps = kSteps;
    forMembers(view, island, [&](std::uint32_t body) {
        const BodyRecord& record = view.bodies[body];
        const BodyState& state = view.bodies.states[body];
        const float speed = length(state.v) + length(state.w) * record.radius;
        calm &= speed <= kCalm * std::sqrt(gravity * record.size) && !view.moduleWork.names(body);
        most = std::min(most, static_cast<int>(record.direct.pace.allowedFactor));
        steps = std::min(steps, static_cast<int>(record.direct.pace.calm));
    });
    if (!calm) most = 1, steps = 0;
    if (calm && ++steps >= kSteps) most = std::min(2 * most, direct::TreePlan::kLongestFactor), steps = 0;
    forMembers(view, island, [&](std::uint32_t body) {
        view.bodies[body].direct.pace.allowedFactor = static_cast<std::uint8_t>(most) & 7u;
        view.bodies[body].direct.pace.calm = static_cast<std::uint8_t>(steps);
    });
    while (view.settings.substeps % most != 0) most /= 2;
    return most;
}

/// What changes only with the islands and their paces.
void markTrees(const MultirateView& view) {
    Multirate& multirate = view.directSet.multirate;
    multirate.marks.resizeForOverwrite(view.bodies.size());
    for (const std::uint32_t body : view.bodies.awake) multirate.marks[body] = 0;
    for (DirectIsland& island : view.directSet.islands) island.independent = false;
    multirate.any = false;
    multirate.independentCount = 0;
    for (std::size_t t = 0; t < view.directSet.trees.treeCount(); ++t) {
        const direct::TreePlan::Tree& tree = view.directSet.trees.treeAt(t);
        DirectIsland& island = view.directSet.islands[tree.owner];
        multirate.any |= tree.independent || tree.stepFactor > 1;
        multirate.independentCount += tree.independent ? tree.count : 0;
        island.independent = tree.independent;
        const int mark = tree.stepFactor | (tree.independent ? Multirate::kIndependent : 0);
        forMembers(view, island, [&](std::uint32_t body) { multirate.marks[body] = static_cast<std::uint8_t>(mark); });
    }
    for (const DirectIsland& island : view.directSet.islands) {
        if (island.stepFactor == 1) continue;
        multirate.any = true;
        const int mark = island.stepFactor | Multirate::kStanding;
        forMembers(view, island, [&](std::uint32_t body) { multirate.marks[body] = static_cast<std::uint8_t>(mark); });
    }
    multirate.sharedJoints.clear();
    for (const DirectIsland& island : view.directSet.islands)
        for (std::uint32_t j = 0; j < island.jointCount && !island.independent; ++j)
            multirate.sharedJoints.push(view.directSet.joints[island.firstJoint + j]);
}

/// The bodies that take part in the world's substeps, by their step factors.
void listShared(const MultirateView& view) {
    Multirate& multirate = view.directSet.multirate;
    for (AlignedArray<std::uint32_t>& list : multirate.lists) list.clear();
    if (multirate.independentCount == view.freezing.solved.size()) return;
    for (const std::uint32_t body : view.freezing.solved) {
        if ((multirate.marks[body] & Multirate::kIndependent) != 0) continue;
        const std::uint8_t mark = multirate.marks[body];
        if ((mark & Multirate::kStanding) != 0)  // no speed of the middle of a substep
            view.bodies[body].direct.pace.stepFactor = mark & Multirate::kFactor;
        else
            setStepFactor(view.bodies, body, mark, view.settings.gravity, view.context.h);
        if (multirate.any)
            multirate.lists[static_cast<std::size_t>(view.bodies[body].direct.pace.stepFactor / 2)].push(body);
    }
}

}  // namespace

/// Speeds of a body that joints hold belong to the middle of a substep. Where the next one is longer or shorter, the
/// forces between the middles of both are those of half of each. What is of no tree, or of none any more, has step
/// factor 0.
void setStepFactor(Bodies& bodies, std::uint32_t index, int stepFactor, const Vec3& gravity, float h) {
    BodyRecord& body = bodies[index];
    if (stepFactor == 0) body.direct.pace.stepFactor = 1;
    if (stepFactor == 0 || stepFactor == body.direct.pace.stepFactor) return;
    BodyState& state = bodies.states[index];
    const float early = 0.5f * h * static_cast<float>(stepFactor - static_cast<int>(body.direct.pace.stepFactor));
    body.direct.pace.stepFactor = static_cast<std::uint8_t>(stepFactor) & 7u;
    state.v -= early * (body.motion.gravityScale * gravity + state.invMass * body.force);
    state.w -= early * (bodies.inertias[index] * body.torque);
}

void chooseStepFactors(const MultirateView& view) {
    direct::TreePlan& chains = view.directSet.trees;
    Multirate& multirate = view.directSet.multirate;
    bool standing = false;
    for (DirectIsland& island : view.directSet.islands) {
        const int before = std::exchange(island.stepFactor, standingFactor(view, island));
        standing |= before != island.stepFactor;
    }
    const bool regrouped = std::exchange(multirate.regrouped, false);
    if (chains.treeCount() == 0 && !multirate.any && !standing) return;
    std::atomic<bool> changed{standing || (regrouped && multirate.any) || !chains.isGrouped()};
    // What was just made is settled among all bodies, before the step or within its first substep.
    const bool mayBeIndependent =
        economy.independentTrees && view.joints.created.empty() && view.contactFinds.fresh.empty();
    view.runner.parallelFor(static_cast<int>(chains.treeCount()), 8, [&](int begin, int end, int) {
        for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
            const Pace pace = paceOf(view, chains.treeAt(t), mayBeIndependent);
            if (chains.setPace(t, pace.stepFactor, pace.independent)) changed.store(true, std::memory_order_relaxed);
        }
    });
    if (changed.load(std::memory_order_relaxed)) {
        chains.group(direct::selectTreeKernels(view.lanes));
        markTrees(view);
    }
    listShared(view);
}

}  // namespace ragtop
