#include "direct/choice.h"

namespace ragtop::direct {

namespace {

constexpr float kDepth = 4;           ///< load number of columns that soft contacts bear without much sag
constexpr float kDeep = 8;            ///< load number of structures that swing and creep in soft contacts
constexpr float kHeavy = 8;           ///< load number of unequal bodies
constexpr float kCrushing = 100;      ///< load number that no iteration holds, whatever else goes on
constexpr float kQuiet = 0.125f;      ///< share of bodies that move up to which an island is at rest
constexpr float kUnequal = 4;         ///< mass ratio from which bodies are unequal
constexpr float kColumnPairs = 1.5f;  ///< pairs per body up to which nothing beside a column holds it
constexpr float kHanging = 6;         ///< load number of joints that hang, whose every gap adds up
constexpr float kHungShare = 0.0625f;     ///< share of bodies that hang from what contacts bear, as a rope over a drum
constexpr std::uint32_t kHungBodies = 3;  ///< of these; fewer are a limb under a heap
constexpr float kJointed = 100;       ///< load number of other joints, as ankles of a ragdoll that stands
constexpr float kStiff = 1;           ///< as stiffnessOf has it
constexpr float kBuckling = 0.5f;     ///< share of the buckling load
constexpr float kLeaning = 0.25f;     ///< share of bodies
constexpr float kSpin = 0.125f;       ///< rad per substep, from which only free rotation knows how a top turns
constexpr float kLoopSpin = 1;        ///< the same of mechanisms with loops, which divide the substep
constexpr float kStay = 2.0f / 3;     ///< of a limit, for what is direct already

/// Joints alone.
bool isMechanism(const IslandFeatures& island) { return island.joints > 0 && island.bare && !island.touches; }
std::uint32_t jointsOfTree(const IslandFeatures& island) { return island.bodies - (island.hangs ? 0 : 1); }

}  // namespace

const char* nameOf(Reason reason) {
    constexpr const char* kNames[] = {"none", "asked",   "heavy", "tall", "slender", "deep",
                                      "taut", "leaning", "tree",  "loop", "stiff",   "staying"};
    return kNames[static_cast<int>(reason)];
}

Reason chooseDirect(const IslandFeatures& island) {
    if (island.bodies > kMostAtRest || island.rolls || island.coupled) return Reason::none;
    if (island.bodies > kMostBodies && (island.restless > 0 || island.jointLoad > 0)) return Reason::none;
    const float limit = island.direct ? kStay : 1.0f;
    if (isMechanism(island)) {
        // Elimination costs no more than a pass over rows. Loops are another matter, but passes do not close them.
        const bool tree = island.joints == jointsOfTree(island);
        if (tree && limit * island.spin < kSpin) return Reason::tree;
        if (!tree && island.bodies <= kMostLooped && limit * island.spin < kLoopSpin) return Reason::loop;
    }
    const auto bodies = static_cast<float>(island.bodies), pairs = static_cast<float>(island.pairs);
    const bool jointed = island.jointLoad > 0, quiet = limit * static_cast<float>(island.moving) <= kQuiet * bodies;
    if (island.bodies <= kMostBodies && island.stiffness > limit * kStiff) return Reason::stiff;
    if (island.hangs && island.jointLoad > limit * kHanging) return Reason::taut;
    if (island.hung >= kHungBodies && static_cast<float>(island.hung) > limit * kHungShare * bodies)
        return Reason::taut;
    if (quiet && island.jointLoad > limit * kJointed) return Reason::taut;
    if ((quiet || !jointed) && island.contactLoad > limit * kCrushing && island.massRatio > limit * kUnequal)
        return Reason::heavy;
    // What tumbles changes its contacts in every step, and iteration is as good.
    if (jointed || !quiet) return Reason::none;
    if (island.contactLoad > limit * kHeavy && island.massRatio > limit * kUnequal) return Reason::heavy;
    if (island.contactLoad > limit * kDepth && limit * pairs < kColumnPairs * bodies) return Reason::tall;
    if (island.buckling > limit * kBuckling) return Reason::slender;
    if (island.contactLoad > limit * kDeep && island.moving == 0) return Reason::deep;
    if (island.leaning >= 2 && static_cast<float>(island.leaning) > limit * kLeaning * bodies) return Reason::leaning;
    return Reason::none;
}

}  // namespace ragtop::direct
