#pragma once

/// The memory of wide contact constraints: bundles of N contacts (N the world's lane count), each a fixed list of
/// fields, each field N floats. A contact lives in one lane of one bundle of its colour as long as it touches; the
/// narrow phase writes its geometry there and the solver its impulses, so nothing is rebuilt per step.
namespace ragtop::contact {

/// Fields of a point, from kPoints + point · kPointFields.
enum PointField : int {
    kAnchor,          ///< 3, shared contact point from the centre of A, m
    kSeparation = 3,  ///< m at the beginning of the step, negative when overlapping
    kImpulse,         ///< N s along the normal in the last substep
    kMass,            ///< effective mass of the normal row, kg; zero for an absent point
    kLever,           ///< distance from the friction centre, m
    kPeak,            ///< sum of impulses over the substeps of this step, N s
    kLoad,            ///< carried load: the impulse the soft row relaxes towards, N s
    kPointFields,
};
inline constexpr int kMaxPoints = 4;  ///< of the largest polygon that a manifold keeps

/// Fields of a bundle; vectors take three consecutive fields. What every pass reads comes first, then the points, of which
/// a pass reads those that there are, then what few contacts have and what is for other stages. Of points beyond the last
/// one that some lane has, only mass, impulse and load are written by prepare.
enum Field : int {
    kBodyA,  ///< index of the body's state, as integer bits; 0 is the static body
    kBodyB,
    kTraits,                  ///< Traits that some lane has, as integer bits in each lane; written by prepare
    kNormal,                  ///< 3, from A to B
    kOffset = kNormal + 3,    ///< 3, centre of B minus centre of A at the beginning of the step, m
    kFriction = kOffset + 3,  ///< coefficient at rest
    kSlidingShare,            ///< coefficient while sliding over that at rest
    kSize,                    ///< length that stands for the pair's size, m
    kFollow,                  ///< share of B's displacement from A that the shared point makes too
    kFrictionImpulse,         ///< 3, world axes, N s
    kTwistImpulse = kFrictionImpulse + 3,  ///< N m s about the normal
    kSliding,                              ///< 1 while the surfaces slide, 0 while they stick
    kStick,                      ///< 3, m, how far B has slipped on A since they stick, without this step's displacement
    kShift = kStick + 3,         ///< 3, m, how far B has moved from A in this step; 0 where one is fixed
    kCenter = kShift + 3,        ///< 3, friction centre from the centre of A, m; written by prepare
    kFrictionMass = kCenter + 3,  ///< 6, upper triangle of the symmetric matrix in world axes, without part along the normal, kg
    kTwistMass = kFrictionMass + 6,
    kPoints,                                         ///< first field of the first point
    kRecordA = kPoints + kMaxPoints * kPointFields,  ///< index of the body's record, as integer bits
    kRecordB,
    kPointCount,   ///< integer bits
    kRestitution,
    kCross,                    ///< 1/k² − 1 with k the coefficient across the grain over that along it; 0: no grain
    kAcross,                   ///< 3, unit tangent across the grain, where kCross is not 0
    kRolling = kAcross + 3,    ///< rolling resistance, m
    kSpinning,                 ///< the same about the normal, m
    kRollMass,
    kRollImpulse,                ///< 3, N m s
    kRoundA = kRollImpulse + 3,  ///< m, radius about A's core: the point of a round surface that touches does not turn with A
    kRoundB,
    kCoreShareA,  ///< share of the way of A's core, as A turns, that the shared point makes too
    kCoreShareB,
    kSurface,                 ///< 3, velocity of B's surface relative to A's beyond the bodies' motion, m/s
    kShifted = kSurface + 3,  ///< 1 until loads are found anew, where the points that hold a body on the ground changed
    kStruck,                  ///< steps for which its load may be an impact's, above 0 after something came fast
    kApproach,                ///< one per point: normal velocity just before the point is struck, m/s
    kThrown = kApproach + kMaxPoints,  ///< above 0 where the warm start of this substep throws apart what was struck
    kFields,
};

/// What few contacts have: fields that are zero elsewhere, and points beyond the first.
enum Trait : int {
    kBouncy = 1,          ///< kRestitution
    kUneven = 2,          ///< kCross
    kRolls = 4,           ///< kRolling, kRollImpulse
    kSpins = 8,           ///< kSpinning
    kRound = 16,          ///< kRoundA, kRoundB
    kMovingSurface = 32,  ///< kSurface
    kFindsLoad = 64,      ///< kShifted
    kTurningCore = 128,   ///< kCoreShareA, kCoreShareB
    kSecondPoint = 256,
    kThirdPoint = 512,
    kFourthPoint = 1024,
    kBodyOnBody = 2048,  ///< kBodyA: A is not the static body
    kIsStruck = 4096,    ///< kStruck
};

/// Of the size: overlaps that no load leaves, which bodies come out of as fast as from the ground.
inline constexpr float kDeep = 0.015f;
/// Of the weight of what a row moves: a load whose overlap is not deep, however small the bodies are.
inline constexpr float kHeavy = 10;
/// Of √(gravity · size): the fastest push, with which a body goes on by an eighth of its size. A share of a size per
/// step is that for 0.77 m at 60 Hz; at 480 Hz it is eight times as fast, and threw a crate by metres.
inline constexpr float kPushFall = 0.5f;
/// Of the size: overlaps that bodies leave by being moved, since the speed of pushing is bounded.
inline constexpr float kInside = 0.25f;
inline constexpr float kInsideMost = 0.1f;  ///< of the size, by which they are moved in a step at most

/// Times the speed that gravity gives in a substep: what comes faster strikes. Twice what bounces least, by trial.
inline constexpr float kStruckSpeed = 8;
/// Of what counts as deep: only a load presses bodies so far into each other, and what pushes them out again leaves
/// speeds that one relaxing pass does not take back where masses differ. By trial.
inline constexpr float kPressedDepth = 4;
inline constexpr float kStruckSteps = 4;  ///< by trial: longer, piles cost more; shorter, slow impacts bounce
/// Times the speed that gravity gives in a substep: what a warm start throws apart slower is the rounding of rest.
inline constexpr float kThrownSpeed = 4;

/// Rad per substep up to which contacts look ahead of a turn: by a series to its second term, a tenth of which is left
/// out there.
inline constexpr float kAhead = 0.25f;

}  // namespace ragtop::contact
