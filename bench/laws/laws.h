#pragma once

#include <span>
#include <string>
#include <vector>

#include "../stability/engine.h"
#include "grammar.h"

/// What holds in every scene, whatever was built.
namespace ragtop::laws {

/// What a run of a scene showed. A number that is none stays none.
struct Watched {
    double energyGain = 0;    ///< largest energy over that at the start, as a share of what the scene could release
    double momentumGain = 0;  ///< of bodies that nothing holds, against what gravity gives, as a share of theirs
    double gap = 0;           ///< m, largest of a joint at the end of any step
    double restGap = 0;       ///< m, the same in the last half second, where all came to rest
    double overLimit = 0;     ///< rad, farthest beyond a limit
    double restOverLimit = 0;
    double overlap = 0;  ///< m, deepest of two bodies that were apart at the start, looked at in each tenth of a second
    double restOverlap = 0;
    double moved = 0;     ///< m, farthest against body 0 of what should stand
    double hangs = 0;     ///< m, by which what should fall has moved less than what may stand
    double rolls = 0;     ///< m/s, √(2 K/m) of what is braked, when it ends
    double fastest = 0;   ///< m/s, of any body at the end of any step
    double endSpeed = 0;  ///< m/s, √(2 K/m) of all bodies when it ends; laws at rest look at what is slow alone
    double stuck = 0;     ///< s, longest in which no place changed though there were speeds
    double meanMs = 0, medianMs = 0, worstMs = 0;  ///< of a step
    std::vector<std::string> meddled;              ///< laws that did not hold where it was meddled with
    bool restored = true;                          ///< after a restore the same bits as without
};

/// A law and where its bound comes from.
struct Law {
    const char* name;
    double Watched::*value;
    double bound;
    const char* unit;
    bool always = true;  ///< else it counts only where it is asked for by its name: it does not hold in all kinds yet
};

/// Gaps and angles are what users see: 5 cm and 5° in motion, 2 mm and 1° at rest. Energy: a hundredth of what the
/// scene can release, which is what rows of an implicit first-order method may trade between places and speeds. What
/// stands moves by less than a hundredth of a box. A step that cannot be had is undone, once or twice; no scene stands
/// still in its motion. Momentum: what rounding of speeds may bring in a thousand substeps. No scene drops or swings
/// anything to a third of the bound of speed.
std::span<const Law> allLaws();

/// Is something moved from outside, whose work is not counted?
bool isDriven(const Drawn& drawn);
/// Runs the scene in an engine.
Watched watch(const Drawn& drawn, const stability::EngineKind& engine);
/// Whether a world that is restored now and then takes the same course to the bit.
bool restoresAlike(const Drawn& drawn, std::uint64_t seed);

/// A restored world takes the same course.
inline constexpr const char* kRestoredLaw = "restored";
/// Names of those of the laws asked for ("all": every one) that do not hold.
std::vector<std::string> broken(const Watched& watched, const std::vector<std::string>& asked);

}  // namespace ragtop::laws
