#pragma once

/// Functions of angles in single precision for laws that take many of them, by polynomials, with the same bits on every
/// platform: within 3e-7 of the truth where |x| ≤ π, and of what is no number no number.
namespace ragtop {

float quickArcTan(float x);
/// The angle in [−π/2, π/2] of a sine, whose cosine is given.
float quickArcSin(float sine, float cosine);
float quickSin(float x);
float quickCos(float x);

}  // namespace ragtop
