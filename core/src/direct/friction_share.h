#pragma once

namespace ragtop::direct {

/// A point of a manifold in its plane: where it is, and what it bears.
struct SharePoint {
    double
        x = 0,
        y = 0;  ///< m, from the manifold's centre along its tangents, which make a right-handed basis with the normal
    double normal = 0;        ///< N s
    double friction[2] = {};  ///< N s, along the tangents; the result
};

/// Shares a friction impulse and a twist about the centre out to points, each within its disc of Coulomb's law. The
/// answer is the slip of a plane, x → a + ω × x, under which points loaded by N would answer with N min(|s|, μ) along
/// it: the minimum of a convex function of (a, ω), by Newton's method [the limit surface of Goyal, Ruina, Papadopoulos,
/// 1991]. What the discs cannot carry is lost.
void shareFriction(SharePoint* points, unsigned count, double mu, const double friction[2], double twist);

}  // namespace ragtop::direct
