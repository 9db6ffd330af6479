#pragma once

/// The memory of wide contact constraints: bundles of N contacts (N the world's lane count), each a fixed list of
/// fields, each field N floats. A contact lives in one lane of one bundle of its colour as long as it touches; the
/// narrow phase writes its geometry there and the solver its impulses, so nothing is rebuilt per step.
namespace ragtop::contact {

/// Fields of a bundle; vectors take three consecutive fields.
enum Field : int {
    kBodyA,  ///< index of the body's state, as integer bits; 0 is the static body
    kBodyB,
    kRecordA,  ///< index of the body's record, as integer bits
    kRecordB,
    kPointCount,              ///< integer bits
    kNormal,                  ///< 3, from A to B
    kOffset = kNormal + 3,    ///< 3, centre of B minus centre of A at the beginning of the step, m
    kFriction = kOffset + 3,  ///< coefficient at rest
    kSlidingShare,            ///< coefficient while sliding over that at rest
    kCross,                   ///< 1/k² − 1 with k the coefficient across the grain over that along it; 0: no grain
    kAcross,                  ///< 3, unit tangent across the grain, where kCross is not 0
    kRestitution = kAcross + 3,
    kRolling,   ///< rolling resistance, m
    kSpinning,  ///< the same about the normal, m
    kSize,      ///< length that stands for the pair's size, m
    kRoundA,    ///< m, radius about A's core: the point of a round surface that touches does not turn with A
    kRoundB,
    kFollow,                          ///< share of B's displacement from A that the shared point makes too
    kSurface,                         ///< 3, velocity of B's surface relative to A's beyond the bodies' motion, m/s
    kFrictionImpulse = kSurface + 3,  ///< 3, world axes, N s
    kTwistImpulse = kFrictionImpulse + 3,  ///< N m s about the normal
    kRollImpulse,                          ///< 3, N m s
    kSliding = kRollImpulse + 3,           ///< 1 while the surfaces slide, 0 while they stick
    kShifted,              ///< 1 until loads are found anew, where the points that hold a body on the ground changed
    kStick,                ///< 3, m, how far B has slipped on A since they stick, without this step's displacement
    kShift = kStick + 3,   ///< 3, m, how far B has moved from A in this step; 0 where one is fixed
    kCenter = kShift + 3,  ///< 3, friction centre from the centre of A, m; written by prepare
    kTangentMass = kCenter + 3,  ///< 3, symmetric 2 × 2 in the tangent basis of the normal, kg
    kTwistMass = kTangentMass + 3,
    kRollMass,
    kPoints,  ///< first field of the first point
};

/// Fields of a point, from kPoints + point · kPointFields.
enum PointField : int {
    kAnchor,          ///< 3, shared contact point from the centre of A, m
    kSeparation = 3,  ///< m at the beginning of the step, negative when overlapping
    kImpulse,         ///< N s along the normal in the last substep
    kMass,            ///< effective mass of the normal row, kg; zero for an absent point
    kLever,           ///< distance from the friction centre, m
    kApproach,        ///< normal velocity just before the point is struck, m/s
    kPeak,            ///< sum of impulses over the substeps of this step, N s
    kLoad,            ///< carried load: the impulse the soft row relaxes towards, N s
    kPointFields,
};

/// Of the size: overlaps that no load leaves, which bodies come out of as fast as from the ground.
inline constexpr float kDeep = 0.02f;

inline constexpr int kMaxPoints = 4;
inline constexpr int kFields = kPoints + kMaxPoints * kPointFields;

}  // namespace ragtop::contact
