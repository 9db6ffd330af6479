#pragma once

/// Numbers of rigid rows that are solved directly, by Newton's method or by elimination of trees.
namespace ragtop::direct::tuning {

inline constexpr double kRowResistance = 1e-6;  ///< R of a row of a joint, over its inverse mass
/// R of a contact point beside which joints are closed: where both cannot be had, joints are. Points of a face share what
/// they push with; much firmer ones change sides hundreds of times before an answer is found.
inline constexpr double kPointResistance = 0.1;
inline constexpr double kStiffLink = 1;         ///< 4 T h²/(m L) beyond which the stiffness of tension counts
inline constexpr double kVeryTaut = 25;         ///< stiffness over inertia beyond which one linearization will not do
inline constexpr double kOpen = 2e-4;           ///< gap over arm beyond which a substep of a tree was too long
inline constexpr double kClosed = 1e-4;         ///< gap over arm up to which one of twice the length would do
inline constexpr double kLongTurn = 1.0 / 16;   ///< rad, by which links of trees turn in a substep that is lengthened
inline constexpr double kImplicit = 0.5;        ///< γ: taut rows pull as at x + γ h (u − u_free)

}  // namespace ragtop::direct::tuning
