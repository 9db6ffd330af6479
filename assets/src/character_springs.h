#pragma once

#include "character_import.h"

namespace ragtop {

/// The springs of a file for the bones of its character. VRM moves the end of a bone once a frame by
///
///     x ← x + (1 − drag)(x − x₋) + dt (stiffness r + gravityPower g),   |x| = L;
///
/// frequency and damping are those of that recurrence for small swings at 60 frames/s, z² − (2 − drag − dt·stiffness/L)
/// z
/// + (1 − drag) = 0 with z = e^{(−ζω ± iω√(1−ζ²)) dt}. What cannot be taken over is added to the character's warnings.
SpringBonesDef makeSprings(ImportedCharacter& imported);

}  // namespace ragtop
