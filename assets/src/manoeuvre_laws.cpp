#include "manoeuvre_laws.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "manoeuvre_trailer.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr double kGravity = 9.81;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

using Sample = TrackSample;

double of(const Sample& sample, TrackChannel channel) { return sample[static_cast<std::size_t>(channel)]; }

std::span<const Sample> window(const TrackRun& run, double from, double to) {
    const auto time = [](const Sample& sample) { return of(sample, TrackChannel::time); };
    const auto first = std::ranges::lower_bound(run.samples, from - 1e-9, {}, time);
    const auto last = std::ranges::upper_bound(run.samples, to + 1e-9, {}, time);
    return {first, last};
}

/// When a channel first crosses a level, between samples on the line.
double timeTo(std::span<const Sample> samples, TrackChannel channel, double level, bool above) {
    const auto reached = [&](const Sample& s) { return above ? of(s, channel) >= level : of(s, channel) <= level; };
    const auto found = std::ranges::find_if(samples, reached);
    if (found == samples.end()) return kNone;
    const double begin = of(samples.front(), TrackChannel::time), t = of(*found, TrackChannel::time);
    if (found == samples.begin()) return 0;
    const Sample& before = *(found - 1);
    const double a = of(before, channel), b = of(*found, channel);
    return of(before, TrackChannel::time) + (level - a) / (b - a) * (t - of(before, TrackChannel::time)) - begin;
}

double take(const TrackMeasurement& wanted, std::span<const Sample> samples) {
    if (samples.empty()) return kNone;
    const auto value = [&](const Sample& sample) { return of(sample, wanted.channel); };
    const double first = value(samples.front()), last = value(samples.back());
    const double largest = value(std::ranges::max(samples, {}, value));
    switch (wanted.take) {
        case TrackTake::first:
            return first;
        case TrackTake::last:
            return last;
        case TrackTake::smallest:
            return value(std::ranges::min(samples, {}, value));
        case TrackTake::largest:
            return largest;
        case TrackTake::change:
            return last - first;
        case TrackTake::overshoot:
            return largest / last - 1;
        case TrackTake::rise:
            return largest / first - 1;
        case TrackTake::timeAbove:
            return timeTo(samples, wanted.channel, static_cast<double>(wanted.level), true);
        case TrackTake::timeBelow:
            return timeTo(samples, wanted.channel, static_cast<double>(wanted.level), false);
        case TrackTake::mean:
            break;
    }
    double sum = 0;
    for (const Sample& sample : samples) sum += value(sample);
    return sum / static_cast<double>(samples.size());
}

}  // namespace

VehicleDef asOneBody(VehicleDef def) {
    def.level = std::min(def.level, VehicleLevel::full);
    return def;
}

Axles axlesOf(const VehicleDef& def) {
    World world;
    const Vehicle car(world, asOneBody(def));
    const MassProperties mass = world.mass(car.chassis());
    Axles axles;
    axles.mass = static_cast<double>(mass.mass);
    axles.yawInertia = static_cast<double>(mass.inertia.cy.y);
    double steered = 0, other = 0;
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        const WheelDef& wheel = def.wheels[i];
        const double stiffness = static_cast<double>(tireNumbers(wheel.tire, car.staticLoads()[i]).corneringStiffness *
                                                     car.staticLoads()[i]);
        const double ahead = static_cast<double>(wheel.position.z - mass.center.z);
        (wheel.steerFactor != 0 ? axles.front : axles.rear) += stiffness;
        (wheel.steerFactor != 0 ? axles.a : axles.b) += wheel.steerFactor != 0 ? ahead : -ahead;
        (wheel.steerFactor != 0 ? steered : other) += 1;
        axles.relaxation += static_cast<double>(wheel.tire.relaxationLength) / static_cast<double>(def.wheels.size());
    }
    axles.a /= std::max(steered, 1.0);
    axles.b /= std::max(other, 1.0);
    return axles;
}

namespace {

/// K = (m/L)(b/C_f − a/C_r), rad per m/s² [Pacejka, Tire and Vehicle Dynamics, 2012, ch. 1].
double understeer(const Axles& axles) {
    return axles.mass / (axles.a + axles.b) * (axles.b / axles.front - axles.a / axles.rear);
}

/// Force over speed squared, N s²/m².
double airResistance(const VehicleDef& def) {
    return 0.5 * static_cast<double>(def.aerodynamics.airDensity * def.aerodynamics.dragArea);
}

/// m/s², of a car whose wheels are locked: a = Σ Nᵢ μ(Nᵢ)/m under the loads that it presses them down with,
///   Nᵢ = Nᵢ₀ + m a h (zᵢ − z̄)/Σ (zⱼ − z̄)²,   h: of the centre of mass above the ground.
double lockedDeceleration(const VehicleDef& def, double friction) {
    World world;
    const Vehicle car(world, asOneBody(def));
    const DVec3 center{world.mass(car.chassis()).center};
    const double m = static_cast<double>(def.chassis.mass), count = static_cast<double>(def.wheels.size());
    double middle = 0, ground = 0, spread = 0, decelerates = 0;
    for (const WheelDef& wheel : def.wheels) {
        middle += static_cast<double>(wheel.position.z) / count;
        ground += static_cast<double>(wheel.position.y - wheel.radius) / count;
    }
    const auto ahead = [&](const WheelDef& wheel) { return static_cast<double>(wheel.position.z) - middle; };
    for (const WheelDef& wheel : def.wheels) spread += ahead(wheel) * ahead(wheel);
    // Grip falls slowly with load: each round leaves a small share of what was missing.
    for (int round = 0; round < 16; ++round) {
        double force = 0;
        for (std::size_t i = 0; i < def.wheels.size(); ++i) {
            const WheelDef& wheel = def.wheels[i];
            const double shifted = spread > 0 ? m * decelerates * (center.y - ground) * ahead(wheel) / spread : 0;
            const double rest = static_cast<double>(car.staticLoads()[i]), load = std::max(0.0, rest + shifted);
            const double surface = friction / static_cast<double>(wheel.tire.referenceSurface);
            const bool ownLaw = wheel.tire.magicFormula || wheel.tire.slipCurves;  // which knows loads
            const double lost = ownLaw ? 0 : static_cast<double>(wheel.tire.loadSensitivity) * (load / rest - 1);
            const auto grip = tireNumbers(wheel.tire, static_cast<float>(load)).slidingFriction;
            force += load * surface * std::max(1 - lost, 0.5) * static_cast<double>(grip);
        }
        decelerates = force / m;
    }
    return decelerates;
}

/// From v to rest at v̇ = −(a + c v²), a by locked wheels and c of the air: ln(1 + c v²/a)/(2 c).
double lockedStop(const VehicleDef& def, double friction, double v) {
    const double a = lockedDeceleration(def, friction), c = airResistance(def) / static_cast<double>(def.chassis.mass);
    return c > 0 ? std::log1p(c * v * v / a) / (2 * c) : v * v / (2 * a);
}

double coastDown(const VehicleDef& def, double from, double to) {
    const double m = static_cast<double>(def.chassis.mass);
    double turning = 0, rolling = 0;
    for (const WheelDef& wheel : def.wheels) {
        turning += 0.75 * static_cast<double>(wheel.mass);
        rolling += static_cast<double>(wheel.tire.rollingResistance) / static_cast<double>(def.wheels.size());
    }
    const double A = rolling * m * kGravity;
    const double C = airResistance(def);
    if (!(C > 0)) return (m + turning) / A * (from - to);
    const double s = std::sqrt(C / A);
    return (m + turning) / std::sqrt(A * C) * (std::atan(from * s) - std::atan(to * s));
}

double lawOf(const TrackMeasurement& wanted, const TrackRun& run, std::span<const Sample> samples,
             const TrackCase& made) {
    const double v = of(samples.front(), TrackChannel::speed), end = of(samples.back(), TrackChannel::speed);
    switch (wanted.law) {
        case TrackLaw::lockedStop:
            return lockedStop(*made.def, static_cast<double>(made.friction), v);
        case TrackLaw::coastDown:
            return coastDown(*made.def, v, static_cast<double>(wanted.level));
        case TrackLaw::bicycleYaw: {
            const Axles axles = axlesOf(*made.def);
            const double angle = of(samples.back(), TrackChannel::wheelAngle);
            return end * angle / (axles.a + axles.b + understeer(axles) * end * end);
        }
        case TrackLaw::bicycleSteer: {
            const Axles axles = axlesOf(*made.def);
            const auto radius = static_cast<double>(*made.manoeuvre->cruise->radius);
            return (axles.a + axles.b) / radius + understeer(axles) * end * end / radius;
        }
        case TrackLaw::hitchPull:
            return hitchPull(*made.manoeuvre->trailer, *made.def, samples);
        case TrackLaw::hitchSwing: {
            const TrackRun swung{linearSwing(*made.manoeuvre->trailer, *made.def, run.samples), {}};
            return take(wanted, window(swung, static_cast<double>(wanted.from), static_cast<double>(wanted.to)));
        }
        case TrackLaw::none:
            break;
    }
    return kNone;
}

std::string_view unitOf(const TrackMeasurement& wanted) {
    if (wanted.take == TrackTake::timeAbove || wanted.take == TrackTake::timeBelow) return "s";
    if (wanted.take == TrackTake::overshoot || wanted.take == TrackTake::rise) return "1";
    return kTrackChannels[static_cast<std::size_t>(wanted.channel)].unit;
}

}  // namespace

TrackValue measured(const TrackMeasurement& wanted, const TrackRun& run, const TrackCase& made) {
    const auto samples = window(run, static_cast<double>(wanted.from), static_cast<double>(wanted.to));
    TrackValue value{.name = wanted.name, .unit = std::string(unitOf(wanted)), .value = take(wanted, samples)};
    if (wanted.reference) value.reference = static_cast<double>(*wanted.reference);
    if (wanted.law != TrackLaw::none && !samples.empty()) value.reference = lawOf(wanted, run, samples, made);
    value.pass = std::isfinite(value.value);
    if (value.reference) {
        value.error = value.value / *value.reference - 1;
        value.pass = value.pass && std::abs(*value.error) <= static_cast<double>(wanted.tolerance);
    }
    if (wanted.least) value.pass = value.pass && value.value >= static_cast<double>(*wanted.least);
    if (wanted.greatest) value.pass = value.pass && value.value <= static_cast<double>(*wanted.greatest);
    return value;
}

}  // namespace ragtop
