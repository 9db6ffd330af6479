#include "direct/choice.h"

namespace ragtop::direct {

namespace {

constexpr float kDeep = 8;            ///< load number of structures that swing and creep in soft contacts
constexpr float kQuiet = 0.125f;      ///< share of bodies that move up to which an island is at rest
constexpr float kUnequal = 4;         ///< mass ratio from which bodies are unequal
constexpr float kHanging = 6;         ///< load number of joints that hang, whose every gap adds up
constexpr float kHungShare = 0.0625f;     ///< share of bodies that hang from what contacts bear, as a rope over a drum
constexpr std::uint32_t kHungBodies = 3;  ///< of these; fewer are a limb under a heap
constexpr float kJointed = 100;       ///< load number of other joints, as ankles of a ragdoll that stands
constexpr float kStiff = 1;           ///< as Hardness has it
/// h² Σ k/m of a body: no eigenvalue h² λ is more than twice that, and steps that push by where springs are follow up
/// to 4 (docs/adr/0038).
constexpr float kStiffTogether = 2;
constexpr float kBraked = 0.1f;       ///< the same of dampers, which brake light links by half of it too much
constexpr float kLeaning = 0.25f;     ///< share of bodies
constexpr float kSpin = 0.125f;       ///< rad per substep, from which only free rotation knows how a top turns
constexpr float kLoopSpin = 1;        ///< the same of mechanisms with loops, which divide the substep
constexpr float kStay = 2.0f / 3;     ///< of the spin of what is direct already, so that none goes to and fro

/// Joints alone.
bool isMechanism(const IslandFeatures& island) { return island.joints > 0 && island.bare && !island.touches; }
/// More than one pair, whose shares are exact.
bool flies(const IslandFeatures& island) {
    return island.joints > 1 && !island.touches && island.bodies <= kMostBodies;
}
std::uint32_t jointsOfTree(const IslandFeatures& island) { return island.bodies - (island.hangs ? 0 : 1); }
/// Held by several ropes, stops or hinges at once: what one pass closes the next opens.
bool isLooped(const IslandFeatures& island) {
    return !island.touches && island.bodies <= kMostLooped && island.joints > jointsOfTree(island);
}

}  // namespace

const char* nameOf(Reason reason) {
    constexpr const char* kNames[] = {"none",    "asked", "heavy", "tall",  "deep",   "taut",
                                      "leaning", "tree",  "loop",  "stiff", "damped", "staying"};
    return kNames[static_cast<int>(reason)];
}

Reason chooseDirect(const IslandFeatures& island) {
    if (island.bodies > kMostAtRest || island.rolls || island.coupled) return Reason::none;
    if (island.bodies > kMostBodies && (island.restless > 0 || island.jointLoad > 0)) return Reason::none;
    if (isMechanism(island)) {
        // Elimination costs no more than a pass over rows. Loops are another matter, but passes do not close them.
        const bool tree = island.joints == jointsOfTree(island);
        const float spin = (island.direct ? kStay : 1.0f) * island.spin;
        if (tree && spin < kSpin) return Reason::tree;
        if (!tree && island.bodies <= kMostLooped && spin < kLoopSpin) return Reason::loop;
    }
    const auto bodies = static_cast<float>(island.bodies);
    const bool jointed = island.jointLoad > 0, quiet = static_cast<float>(island.moving) <= kQuiet * bodies;
    const bool stiff = island.hardness.stiffness > kStiff || island.stiffness > kStiffTogether;
    if (stiff && island.bodies <= kMostBodies) return Reason::stiff;
    if (flies(island) && island.hardness.braking > kBraked) return Reason::damped;
    if (isLooped(island)) return Reason::taut;
    if (island.hangs && island.jointLoad > kHanging) return Reason::taut;
    if (island.hung >= kHungBodies && static_cast<float>(island.hung) > kHungShare * bodies) return Reason::taut;
    if (quiet && island.jointLoad > kJointed) return Reason::taut;
    if ((quiet || !jointed) && island.contactLoad > kCrushing && island.massRatio > kUnequal) return Reason::heavy;
    // What tumbles changes its contacts in every step, and iteration is as good. What lies inside each other asks for
    // pushes that contradict, and an exact answer to them is fast.
    if (jointed || !quiet || island.inside) return Reason::none;
    if (island.buckling > kBuckling) return Reason::tall;
    if (island.contactLoad > kDeep && (island.moving == 0 || island.direct)) return Reason::deep;
    if (island.leaning >= 2 && static_cast<float>(island.leaning) > kLeaning * bodies) return Reason::leaning;
    return Reason::none;
}

}  // namespace ragtop::direct
