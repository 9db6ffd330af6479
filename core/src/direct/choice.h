#pragma once

#include <cstdint>

#include "constraints/stiffness.h"
#include "ragtop/math.h"

namespace ragtop::direct {

/// Why an island is solved directly.
enum class Reason : std::uint8_t { none, asked, heavy, tall, deep, taut, leaning, tree, loop, stiff, damped, staying };

/// Of the bodies of an island together.
struct CommonMotion {
    Vec3 momentum;   ///< kg m/s
    float mass = 0;  ///< kg

    void add(float more, const Vec3& velocity) { mass += more, momentum += more * velocity; }
    Vec3 velocity() const { return (1 / mass) * momentum; }
};

/// What decides how an island is solved. Loads are estimates: each body hands its weight, and what it carries, to
/// the neighbours that are nearer to the ground (islands/load_paths.h). A load number is such a load over the weight of
/// the lighter of the two bodies that meet: a column of n equal boxes has n at its foot, a weight on a box their mass
/// ratio.
struct IslandFeatures {
    std::uint32_t bodies = 0;
    CommonMotion common;                  ///< of all bodies: motion is what differs from it
    std::uint32_t moving = 0;             ///< bodies that are not nearly at rest against the common motion
    std::uint32_t restless = 0;           ///< bodies that have neither just been made nor been at rest for long
    std::uint32_t leaning = 0;            ///< bodies at rest that nothing level holds up
    std::uint32_t joints = 0;
    std::uint32_t hung = 0;                ///< joints by which a body hangs from one above, loaded by more than kHung
    float spin = 0;                        ///< rad, the largest turn in a substep
    float contactLoad = 0, jointLoad = 0;  ///< largest load numbers
    float massRatio = 1;                   ///< largest of a loaded pair
    Hardness hardness;                     ///< the largest of joints
    float stiffness = 0;                   ///< h² Σ k/m of springs along ways, the largest of a body
    float buckling = 0;  ///< load over what soft contacts bear before they tilt away, or open at a corner
    bool hangs = false;                    ///< by joints, from something that does not move
    bool touches = false;                  ///< has contacts, near or not
    bool bare = true;                      ///< bodies turn freely, and joints are such as trees know
    bool rolls = false;    ///< some contact has resistance to turning or a grain, which only the iteration knows
    bool inside = false;   ///< some bodies are so far inside each other that iteration moves them apart by places
    bool coupled = false;  ///< joints are coupled with each other, which only the iteration knows
    bool direct = false;   ///< is solved directly now
    std::int32_t staying = 0, cooldown = 0;  ///< steps for which it stays so, or may not be (negative)
    Reason last = Reason::none, reason = Reason::none;
};

/// Share of the buckling load: at p of it what is crooked leans 1/(1 − p) as far. Columns of four to nine boxes, 6:1 to
/// 40:1, fall from 0.5 on (docs/measurements/islands.md).
inline constexpr float kBuckling = 0.25f;
inline constexpr float kCrushing = 100;  ///< load number that no iteration holds, whatever else goes on
inline constexpr float kHung = 20;  ///< load number of a joint whose body hangs from one that contacts bear
inline constexpr std::uint32_t kMostBodies = 512;   ///< of an island that is solved directly whatever it does
inline constexpr std::uint32_t kMostAtRest = 4096;  ///< of one that is so only as long as nothing in it moves
inline constexpr std::uint32_t kMostLooped = 64;    ///< of a mechanism, whose factor costs more than iterating it
inline constexpr float kLongRest = 1;               ///< s; more than it takes an island to fall asleep
inline constexpr std::int32_t kStayingSteps = 60;   ///< for which a choice outlives its reason
inline constexpr std::int32_t kFactorSteps = 10;    ///< of its stay that each dear step costs an island
/// Block products of a dear step, some 2 ms: what came apart and tumbles asks for more than any structure at rest.
inline constexpr double kDear = 2e4;
/// Load number up to which dear steps count: what is wedged has less at times, and is not handed to iteration.
inline constexpr float kBearable = 0.25f * kCrushing;
inline constexpr std::int32_t kCooldownSteps = 60;  ///< of iteration after a direct solve that failed
inline constexpr std::uint8_t kMostDoublings = 5;   ///< of those steps, one for each further failure

/// How finely what a body is part of divides a substep.
struct SubstepPace {
    std::uint8_t inner = 1;              ///< steps of each substep, as part of a mechanism
    std::uint8_t calm = 0;               ///< steps for which half as many would have done
    std::uint8_t stepFactor : 3 = 1;     ///< substeps taken at once last, as part of a tree: 1, 2 or 4
    std::uint8_t allowedFactor : 3 = 1;  ///< the same, as far as its joints' gaps tell
};

const char* nameOf(Reason reason);
Reason chooseDirect(const IslandFeatures& island);

}  // namespace ragtop::direct
