#pragma once

#include <span>

#include "narrowphase/manifold.h"
#include "ragtop/math.h"

/// Contacts of a pair that is still apart, found where its shapes will first touch: from afar a ramp is a wall, since
/// its foot is what lies nearest.
namespace ragtop {

/// How B comes to A in the coming step, turns left out.
struct Approach {
    Vec3 way{};          ///< m, of B beside A, in A's axes
    float near = 1e30f;  ///< m: a gap no wider is not looked beyond

    bool looksAhead() const { return lengthSquared(way) > near * near; }
};

inline float leastSeparation(std::span<const ManifoldPoint> points) {
    float least = points[0].separation;
    for (const ManifoldPoint& point : points.subspan(1)) least = point.separation < least ? point.separation : least;
    return least;
}

/// Conservative advancement [Mirtich 1996, section 2.3]: B goes until the plane that parts the pair is reached, is
/// looked at there, and so on until it touches or comes no farther:
///   t ← t + s(t)/c(t),   c = −way · n(t).
/// `contact` has what is found where B is now, `look(t, contact)` replaces it by what is found after the share t of the
/// way. Returns that share.
template <class Contact, class Look>
float goToMeet(const Approach& approach, Contact& contact, Look&& look) {
    constexpr int kMost = 8;  // each step reaches another feature, or is one of Newton's on a gap that is convex in t
    float gone = 0;
    for (int i = 0; i < kMost && !contact.all().empty(); ++i) {
        const float gap = leastSeparation(contact.all()), closing = -dot(approach.way, contact.normal);
        if (gap <= approach.near || closing * (1 - gone) <= gap) break;
        gone += gap / closing;
        look(gone, contact);
    }
    return gone;
}

/// Separations become those of now along the normal that was found, s(t) + t c(t). Where that plane does not part the
/// pair now the pair passes, and nothing is left.
template <class Contact>
void bringBack(const Approach& approach, float gone, Contact& contact) {
    if (gone == 0 || contact.all().empty()) return;
    const float nearer = -gone * dot(approach.way, contact.normal);
    for (ManifoldPoint& point : contact.all()) point.separation += nearer;
    if (leastSeparation(contact.all()) < 0) contact.clear();
}

}  // namespace ragtop
