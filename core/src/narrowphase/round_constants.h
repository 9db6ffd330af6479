#pragma once

/// Numbers of the closed forms of round shapes that one pair alone and four side by side share.
namespace ragtop {

/// Of |d|² |e|²: segments whose directions have a smaller square of their sine are parallel.
inline constexpr float kParallelSegments = 1e-10f;
/// sin² up to which capsules touch along a line.
inline constexpr float kNearlyParallel = 0.01f;

}  // namespace ragtop
