#pragma once

#include "constraints/joint_sim.h"

/// How much springs, dampers and soft stops are for a substep.
namespace ragtop {

/// Of a joint, with w the inverse mass of the relative motion where nothing else holds the bodies, of turns about the
/// axis about which these turn most easily, nearly. 0 where there is none.
struct Hardness {
    /// z/z₀ of its stiffest spring or soft stop, z = h² k w, and z₀ where the iteration stops to hold it beside
    /// neighbours: 14 ζ, from 0.03 to 1, of springs; 1 of soft stops, whose trajectory the iteration knows up to there.
    /// Springs of more than 1 that have neighbours are to be solved all at once (docs/adr/0038).
    float stiffness = 0;
    /// x = h c w of its hardest damper: about the share of a speed that it takes. Beside neighbours, whose inertia its
    /// shares do not know, it brakes too much by up to (eˣ − 1)/x.
    float braking = 0;
    /// N/m, of a spring along a way, that is of distances and sliders: each body has the sum of its springs.
    float travel = 0;
};
Hardness hardnessOf(const JointSim& joint, const BodyState* states, const BodyInertia* inertia, float h);

}  // namespace ragtop
