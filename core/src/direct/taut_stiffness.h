#pragma once

#include "direct/equations.h"
#include "direct/joint_tuning.h"

namespace ragtop::direct {

/// The larger part of ∂²/∂θ² of a force's work on an arm, (F · r) E − ½ (r Fᵀ + F rᵀ): what is not negative.
inline DSym3 tautStiffness(const DVec3& force, const DVec3& arm) {
    const double f = length(force), r = length(arm);
    if (!(f > 0) || !(r > 0)) return {};
    const double along = dot(force, arm), largest = f * r;
    const DVec3 axis = cross(arm, force), apart = (1 / r) * arm - (1 / f) * force;
    const double sine = length(axis), spread = length(apart);
    if (sine <= 1e-6 * largest || spread <= 1e-6) {
        if (!(along > 0)) return {};
        const DSym3 across = outer(-largest / (r * r), arm);
        return across + DSym3{largest, 0, 0, largest, 0, largest};
    }
    const DSym3 first = along > 0 ? outer(along / (sine * sine), axis) : DSym3{};
    return first + outer(0.5 * (along + largest) / (spread * spread), apart);
}

inline void addStiffness(SystemBody& body, const DVec3& impulse, const DVec3& arm, double h) {
    const double turning = h * length(impulse) * length(arm);
    const DSym3& i = body.inverseInertia;
    const double least = i.xx > i.yy ? (i.xx > i.zz ? i.xx : i.zz) : (i.yy > i.zz ? i.yy : i.zz);
    // For a thin link T = |impulse|/h, r = L/2 and I = m L²/12, so 4 T h²/(m L) = ⅔ h |impulse| r / I.
    const double ratio = (2.0 / 3) * turning * least / tuning::kStiffLink;
    if (!(ratio > 1)) return;
    const double share = ratio < 2 ? ratio - 1 : 1;
    body.stiffness = body.stiffness + scaled(tautStiffness(impulse, arm), share * tuning::kImplicit * h);
}

}  // namespace ragtop::direct
