#pragma once

/// Closed forms of a free rigid body.
namespace ragtop::stability {

/// Principal moments (kg m²) or angular velocity (rad/s) along the principal axes of least, middle and greatest moment.
struct Principal {
    double least = 0, middle = 0, greatest = 0;
};

/// Time between two flips of a body that spins near its middle axis, s: half a period of the Jacobi elliptic function
/// that its middle component follows [Landau, Lifshitz, Mechanics, §37].
double flipTime(const Principal& moments, const Principal& spin);

}  // namespace ragtop::stability
