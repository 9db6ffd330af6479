#pragma once

/// Lengths relative to the size of what touches, and other numbers of the method.
namespace ragtop::tuning {

inline constexpr float kSpeculative = 0.02f;      ///< contact margin at rest, in sizes of the smaller shape
inline constexpr float kReuse = 0.05f;            ///< motion of a pair within which its manifolds are kept, in sizes
inline constexpr float kFatMargin = 0.1f;         ///< enlargement of bounds, in sizes
inline constexpr float kContinuousMotion = 0.5f;  ///< motion per step beyond which a body is swept, in sizes
inline constexpr float kSlideSpeed = 0.05f;       ///< slowest slide or roll reported, in √(gravity · size)

}  // namespace ragtop::tuning
