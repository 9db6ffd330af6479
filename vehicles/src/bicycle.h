#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

/// A car seen from above as a bicycle: its axles are points, tires are linear in their slip, loads shift with
/// acceleration along the way, and nothing rolls, pitches or heaves. With V the speed, w the speed to the left and r
/// the yaw rate of the centre of mass, and for each axle its distance z ahead of it, its load N, its cornering
/// stiffness C = c N and its share f of the steering angle δ,
///
///     m (w' + V r) = Σ F,   I r' = Σ z F,   F = C (f δ sgn V − (w + z r)/|V|)                       (1)
///     N = N₀ − m a h (z − z̄)/Σ (z − z̄)²                                                            (2)
///
/// [Pacejka, Tire and Vehicle Dynamics, 2012, ch. 1; of two axles the single-track model of Althoff, Koschi, Manzinger,
/// CommonRoad, IV 2017]. At no speed (1) is the car that rolls without slip: Σ F = Σ z F = 0.
namespace ragtop {

template <class Real>
struct BicycleAxle {
    Real ahead = 0;      ///< z, m
    Real load = 0;       ///< N₀, N
    Real cornering = 0;  ///< c, 1/rad
    Real steered = 0;    ///< f
};

/// A sum over axles at an acceleration along the way, m/s².
template <class Real>
struct BicycleSum {
    Real rest = 0, shift = 0;
    Real at(Real acceleration) const { return rest + acceleration * shift; }
};

template <class Real>
struct Bicycle {
    Real mass = 1, inertia = 1;                    ///< kg; kg m², of yaw
    BicycleSum<Real> grip{}, moment{}, spread{};   ///< Σ C, Σ C z, Σ C z²
    BicycleSum<Real> steer{}, turn{};              ///< Σ C f, Σ C f z
    Real most = std::numeric_limits<Real>::max();  ///< m/s², at which (2) takes all of a load
};

/// Of the centre of mass: m/s to the left, rad/s to the left.
template <class Real>
struct LateralMotion {
    Real side = 0, yaw = 0;
};

/// (1) as d(w, r)/dt = A (w, r) + c.
template <class Real>
struct LateralLaw {
    Real sideBySide = 0, sideByYaw = 0, yawBySide = 0, yawByYaw = 0, side = 0, yaw = 0;
    LateralMotion<Real> rate(const LateralMotion<Real>& at) const {
        return {sideBySide * at.side + sideByYaw * at.yaw + side, yawBySide * at.side + yawByYaw * at.yaw + yaw};
    }
};

/// `height` of the centre of mass over the ground, m.
template <class Real>
Bicycle<Real> makeBicycle(std::span<const BicycleAxle<Real>> axles, Real mass, Real inertia, Real height) {
    Bicycle<Real> car{.mass = mass, .inertia = inertia};
    Real middle = 0, spread = 0;
    for (const BicycleAxle<Real>& axle : axles) middle += axle.ahead / static_cast<Real>(axles.size());
    for (const BicycleAxle<Real>& axle : axles) spread += (axle.ahead - middle) * (axle.ahead - middle);
    for (const BicycleAxle<Real>& axle : axles) {
        const Real shift = spread > 0 ? -mass * height * (axle.ahead - middle) / spread : 0;
        if (shift != 0) car.most = std::min(car.most, axle.load / std::abs(shift));
        const auto add = [&](BicycleSum<Real>& sum, Real arm) {
            sum.rest += axle.cornering * axle.load * arm;
            sum.shift += axle.cornering * shift * arm;
        };
        add(car.grip, 1);
        add(car.moment, axle.ahead);
        add(car.spread, axle.ahead * axle.ahead);
        add(car.steer, axle.steered);
        add(car.turn, axle.steered * axle.ahead);
    }
    return car;
}

/// At a speed that is not 0, m/s, and an acceleration below `most`.
template <class Real>
LateralLaw<Real> lateralLaw(const Bicycle<Real>& car, Real speed, Real acceleration, Real angle) {
    const Real perMass = 1 / car.mass, perInertia = 1 / car.inertia, over = 1 / std::abs(speed);
    const Real steered = speed < 0 ? -angle : angle, moment = car.moment.at(acceleration);
    return {-car.grip.at(acceleration) * over * perMass,
            -moment * over * perMass - speed,
            -moment * over * perInertia,
            -car.spread.at(acceleration) * over * perInertia,
            steered * car.steer.at(acceleration) * perMass,
            steered * car.turn.at(acceleration) * perInertia};
}

/// Of a car that rolls without slip: the one of `slope`, the tangent of the steering angle.
template <class Real>
LateralMotion<Real> rollingMotion(const Bicycle<Real>& car, Real speed, Real slope) {
    const Real determinant = car.grip.rest * car.spread.rest - car.moment.rest * car.moment.rest;
    if (!(determinant > 0)) return {};
    const Real s = speed * slope / determinant;
    return {s * (car.spread.rest * car.steer.rest - car.moment.rest * car.turn.rest),
            s * (car.grip.rest * car.turn.rest - car.moment.rest * car.steer.rest)};
}

/// After h seconds, by (w, r) = x + e^(A h) ((w, r)₀ − x), x where it stays: exact, so that it does not depend on the
/// step.
LateralMotion<float> lateralAfter(const LateralLaw<float>& law, const LateralMotion<float>& from, float h);

}  // namespace ragtop
