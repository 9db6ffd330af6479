#pragma once

/// Numbers of rigid rows that are solved directly, by Newton's method or by elimination of trees.
namespace ragtop::direct::tuning {

inline constexpr double kRowResistance = 1e-6;  ///< R of a row of a joint, over its inverse mass
inline constexpr double kStiffLink = 1;         ///< 4 T h²/(m L) beyond which the stiffness of tension counts
inline constexpr double kVeryTaut = 25;         ///< stiffness over inertia beyond which one linearization will not do
inline constexpr double kImplicit = 0.5;        ///< γ: taut rows pull as at x + γ h (u − u_free)

}  // namespace ragtop::direct::tuning
