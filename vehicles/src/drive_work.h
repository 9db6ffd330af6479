#pragma once

namespace ragtop {

/// Work since the start, J; the engine's with that of torques that are given to wheels. An impulse that takes a speed
/// from a to b does it at (a + b)/2, so that, to rounding,
///
///     engine = Δ½ Σ I ω² + clutch + gears + differentials + brakes + rolling + what the wheels give their tires, and
///              their pads what carries these
///
/// A loss may shrink for a substep in which something comes to be held: others have turned it till then.
struct DriveWork {
    double engine = 0, clutch = 0, gears = 0, differentials = 0, brakes = 0, rolling = 0;
    bool operator==(const DriveWork&) const = default;
};

}  // namespace ragtop
