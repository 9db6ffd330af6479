#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ragtop/math.h"
#include "solve/body_state.h"
#include "solve/contact_places.h"

namespace ragtop {

/// What a body needs to be integrated, beside its state. Rows of eight floats, gathered by transposes.
struct alignas(64) BodyDynamics {
    Vec3 inertia;           ///< kg m², principal moments; 1 where rotation is kinematic or locked
    float linearDecay = 1;  ///< 1 / (1 + h · damping)
    Vec3 inverseInertia;    ///< 1/(kg m²), principal; 1 where rotation is kinematic or locked
    float angularDecay = 1;
    Vec3 acceleration;     ///< m/s², gravity and forces, of this step
    float spins = kSpins;  ///< 0: keeps its angular velocity (kinematic, locked)
    Vec3 torque;           ///< N m of this step; of what has no mass rad/s²
    float translates = 1;  ///< 1: smooth accelerations correct the position; 0 for kinematic and jointed bodies

    // Of `spins`: rotates by its momentum; the same, and has no joint and no contact in this step.
    static constexpr float kSpins = 1, kSpinsAlone = 2;
};
static_assert(sizeof(BodyDynamics) == 64);

/// What a body remembers within and between substeps. The momentum belongs to the angular velocity `turning`; what the
/// velocity has changed since then is added to it, so that a body on which no torque acts keeps it to the bit.
struct alignas(64) BodyHistory {
    Vec3 velocityBefore;  ///< m/s at the beginning of the substep
    float turningX = 0;   ///< rad/s, angular velocity at the end of the last substep
    Vec3 lastChange;      ///< m/s, change of velocity over the substep before; of links of trees, between steps, what
                          ///< single precision leaves out of their velocity (direct/tree_kernels.inl)
    float turningY = 0;
    Quat rotation;  ///< principal axes to world, at the beginning of the step
    Vec3 momentum;  ///< kg m²/s about the centre of mass, world axes; zero where `spins` is
    float turningZ = 0;
};
static_assert(sizeof(BodyHistory) == 64);

struct BodyArrays {
    BodyState* states = nullptr;
    BodyInertia* inertia = nullptr;
    const BodyDynamics* dynamics = nullptr;
    BodyHistory* history = nullptr;
};

struct SolverContext {
    float h = 0, inverseH = 0;   ///< substep, s
    float dt = 0;                ///< step, s
    Softness soft, softStatic;   ///< of contacts between moving bodies, and with static ones
    float pushOut = 0;           ///< m/s per m of size: what an overlap adds at most to the speed that the load takes
    float pushRoot = 0;          ///< m/s per √m of size: the same where steps are short (contact::kPushFall)
    float restitutionSpeed = 0;  ///< m/s
    float gravityStep = 0;       ///< m/s, what gravity gives in a substep
    float heavyDepth = 0;        ///< m, overlap that a heavy load leaves between moving bodies
    float loadShare = 0;         ///< λ̂ ← λ̂ + share (λ − λ̂) per step
    float staticLoadShare = 0;   ///< the same against what does not move
    float elapsed = 0;           ///< s of this step that positions have moved by
    int substep = 0;             ///< its number within the step
    bool firstSubstep = false, lastSubstep = false;
    bool normals = true, friction = true;  ///< the rows that a pass solves
    bool settling = false;                 ///< it finds loads, and moves no body
    bool farContacts = false;              ///< more than a cache holds: passes ask for their memory beforehand

    /// m/s, that an overlap between surfaces of a size (m) adds at most to the speed that the load takes.
    float pushSpeed(float size) const { return std::min(pushOut * size, pushRoot * std::sqrt(size)); }
};

/// Instruction sets and lane counts that kernels are built for, in the order of each list of tables. Sixteen lanes of
/// AVX2 are for tests, and in builds that ask for them: they show processors without AVX-512 what those with it do.
enum class KernelSet {
    baseline4,
#if defined(RAGTOP_X86_KERNELS)
    avx2Lanes8,
    avx512Lanes8,
    avx512Lanes16,
#if defined(RAGTOP_AVX2_LANES16)
    avx2Lanes16,
#endif
#endif
};

/// What kernels are compiled for, narrowest first.
enum class Instructions { baseline, avx2, avx512 };

/// Of this processor, and no more than `limitInstructions` has allowed.
Instructions usableInstructions();

/// Worlds made from now on use nothing beyond `most`, so that a test sees the kernels of lesser processors. Not while
/// another thread makes a world.
void limitInstructions(Instructions most);

/// The fastest set of `lanes` (4, 8, 16) lanes that may be used here, or for 0 lanes the fastest of all. Four lanes
/// where there are only the baseline's instructions, eight in place of sixteen where nothing is built for these.
KernelSet selectKernelSet(int lanes);

/// Defines Table select(lanes), that of selectKernelSet among the tables which the files of instruction sets define:
/// name##Baseline4 and so on, in the order of KernelSet.
#if defined(RAGTOP_X86_KERNELS)
#if defined(RAGTOP_AVX2_LANES16)
#define RAGTOP_WIDEST_OF_AVX2(name) name##Avx216
#else
#define RAGTOP_WIDEST_OF_AVX2(name) name##Avx28
#endif
#define RAGTOP_SELECT_KERNELS(Table, select, name)                                                                  \
    extern const Table name##Baseline4, name##Avx28, name##Avx5128, name##Avx51216, RAGTOP_WIDEST_OF_AVX2(name);    \
    const Table& select(int lanes) {                                                                                \
        static constexpr const Table* kTables[] = {&name##Baseline4, &name##Avx28, &name##Avx5128, &name##Avx51216, \
                                                   &RAGTOP_WIDEST_OF_AVX2(name)};                                   \
        return *kTables[static_cast<int>(selectKernelSet(lanes))];                                                  \
    }
#else
#define RAGTOP_SELECT_KERNELS(Table, select, name) \
    extern const Table name##Baseline4;            \
    const Table& select(int) { return name##Baseline4; }
#endif

/// Wide kernels of one instruction set and lane count. Bundle ranges are in bundles, body ranges in entries of a list
/// of state indices; they may run at once when they share no moving body.
struct KernelTable {
    const char* name;
    int lanes;
    void (*integrateVelocities)(const BodyArrays&, const std::uint32_t* bodies, int begin, int end,
                                const SolverContext&);
    void (*integratePositions)(const BodyArrays&, const std::uint32_t* bodies, int begin, int end,
                               const SolverContext&);
    /// Brings the geometry of contacts to where their bodies are.
    void (*placeContacts)(float* bundles, int begin, int end, const LaneManifolds&, const ContactPlaces&);
    /// Which of contact::kBouncy and kIsStruck any of them has.
    std::int32_t (*prepareContacts)(float* bundles, int begin, int end, const BodyArrays&, const SolverContext&);
    /// Reflects what will meet within this substep; true if anything did.
    bool (*bounceContacts)(float* bundles, int begin, int end, const BodyArrays&, const SolverContext&);
    void (*warmStartContacts)(float* bundles, int begin, int end, const BodyArrays&, const SolverContext&);
    /// Tells by contact::kThrown which contacts that were struck the warm start throws apart.
    void (*markThrown)(float* bundles, int begin, int end, const BodyArrays&, const SolverContext&);
    void (*solveContacts)(float* bundles, int begin, int end, const BodyArrays&, const SolverContext&);
    void (*relaxContacts)(float* bundles, int begin, int end, const BodyArrays&, const SolverContext&);
    /// A ManifoldTouch per lane of all bundles.
    void (*readTouches)(const float* bundles, int begin, int end, std::uint8_t* touches);
};

/// Those of `selectKernelSet`.
const KernelTable& selectKernels(int lanes);

}  // namespace ragtop
