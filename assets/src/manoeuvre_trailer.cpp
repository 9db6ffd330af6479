#include "manoeuvre_trailer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr float kOverhang = 1;       ///< m, of the hitch behind the rearmost hub
constexpr float kHalfAxles = 1.15f;  ///< radii, from an axle of the trailer to the middle
constexpr float kClear = 1.2f;       ///< m between the hitch and the body of the trailer

const WheelDef& rearmost(const VehicleDef& car) {
    return *std::ranges::min_element(car.wheels, {}, [](const WheelDef& wheel) { return wheel.position.z; });
}

double wide(float x) { return static_cast<double>(x); }

}  // namespace

VehicleDef trailerOf(const TrackTrailer& trailer, const VehicleDef& car) {
    WheelDef wheel = rearmost(car);
    const float radius = wheel.radius, across = std::abs(wheel.position.x);
    wheel.steerFactor = wheel.driveShare = wheel.brakeTorque = wheel.handbrakeTorque = 0;
    wheel.suspension = {};
    wheel.tire.radialStiffness.reset();
    VehicleDef def = car;
    def.name = "trailer";
    def.level = std::min(def.level, VehicleLevel::full);
    def.antiRollBars.clear();
    def.linkages.clear();
    def.aerodynamics = {.dragArea = 0};
    def.visual.reset();
    def.wheels.clear();
    for (const float along : {kHalfAxles, -kHalfAxles})
        for (const float side : {across, -across}) {
            wheel.position = {side, radius, along * radius};
            wheel.axle = along > 0 ? 0 : 1;
            def.wheels.push_back(wheel);
        }
    const float half = 0.3f;  // m, of the height of its body
    def.chassis.shapes = {
        {.shape = Box{{across, half, trailer.length - kClear}}, .frame = {{0, 2 * radius + half, 0}, {}}}};
    def.chassis.mass = trailer.mass;
    def.chassis.centerOfMass = Vec3{0, 2 * radius, trailer.ahead};
    def.chassis.inertia = Vec3{trailer.yawInertia, trailer.yawInertia, 0.5f * trailer.mass * across * across};
    return def;
}

Vec3 hitchOfCar(const VehicleDef& car) {
    const WheelDef& last = rearmost(car);
    return {0, last.position.y, last.position.z - kOverhang};
}

Vec3 hitchOfTrailer(const TrackTrailer& trailer, const VehicleDef& car) {
    return {0, rearmost(car).radius, trailer.length};
}

double hitchPull(const TrackTrailer& trailer, const VehicleDef& car, std::span<const TrackSample> samples) {
    constexpr double kGravity = 9.81;
    const auto change = [&](TrackChannel channel) {
        const auto i = static_cast<std::size_t>(channel);
        return samples.back()[i] - samples.front()[i];
    };
    double moved = wide(trailer.mass), rolls = 0;
    const VehicleDef def = trailerOf(trailer, car);
    for (const WheelDef& wheel : def.wheels) {
        moved += 0.75 * wide(wheel.mass);
        rolls += wide(wheel.tire.rollingResistance) / static_cast<double>(def.wheels.size());
    }
    return moved * change(TrackChannel::speed) / change(TrackChannel::time) + rolls * wide(trailer.mass) * kGravity;
}

namespace {

/// A car and its trailer in the plane, at a speed u [Pacejka, Tire and Vehicle Dynamics, 2012, section 1.5]. V and r
/// are those of the car's centre of mass, h behind which the hitch is; φ is the articulation, e and lₖ from the hitch
/// to the trailer's centre of mass and its axles:
///
///     m V' + mₜ A = F₁ + F₂ + Σ Fₖ − m u r,   A = V' − h r' − e (r' + φ'') + u r
///     I r' − h mₜ A = a F₁ − b F₂ − h Σ Fₖ
///     Iₜ (r' + φ'') − e mₜ A = −Σ lₖ Fₖ
///     σ/u F' + F = −C (slip angle)
class SwingingPair {
public:
    enum State : std::size_t { V, r, phi, phiRate, F1, F2, T1, T2, kStates };
    using States = std::array<double, kStates>;

    SwingingPair(const TrackTrailer& trailer, const VehicleDef& car)
        : car_(axlesOf(car)), mass_(wide(trailer.mass)), inertia_(wide(trailer.yawInertia)) {
        const VehicleDef def = trailerOf(trailer, car);
        World world;
        const Vehicle made(world, def), tows(world, asOneBody(car));
        h_ = wide(world.mass(tows.chassis()).center.z - hitchOfCar(car).z);
        e_ = wide(trailer.length - trailer.ahead);
        for (std::size_t k = 0; k < 2; ++k) {
            const std::size_t wheel = 2 * k;
            const float load = made.staticLoads()[wheel];
            axle_[k] = wide(trailer.length - def.wheels[wheel].position.z);
            stiffness_[k] = 2 * wide(tireNumbers(def.wheels[wheel].tire, load).corneringStiffness * load);
        }
    }

    States rate(const States& s, double u, double delta) const {
        const double pull = s[T1] + s[T2], turn = -axle_[0] * s[T1] - axle_[1] * s[T2], side = mass_ * u * s[r];
        // In V', r' and φ''.
        const double reach = h_ + e_, carried = car_.mass + mass_;
        const double M[3][3] = {
            {carried, -mass_ * reach, -mass_ * e_},
            {-h_ * mass_, car_.yawInertia + h_ * mass_ * reach, h_ * mass_ * e_},
            {-e_ * mass_, inertia_ + e_ * mass_ * reach, inertia_ + e_ * mass_ * e_},
        };
        const double f[3] = {s[F1] + s[F2] + pull - car_.mass * u * s[r] - side,
                             car_.a * s[F1] - car_.b * s[F2] - h_ * pull + h_ * side, turn + e_ * side};
        States out{};
        const double whole = determinant(M);
        const std::size_t at[3] = {V, r, phiRate};
        for (std::size_t column = 0; column < 3; ++column) {
            double with[3][3];
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t k = 0; k < 3; ++k) with[i][k] = k == column ? f[i] : M[i][k];
            out[at[column]] = determinant(with) / whole;
        }
        out[phi] = s[phiRate];
        const double lag = u / car_.relaxation, hitch = s[V] - h_ * s[r] - u * s[phi], turns = s[r] + s[phiRate];
        out[F1] = lag * (car_.front * (delta - (s[V] + car_.a * s[r]) / u) - s[F1]);
        out[F2] = lag * (-car_.rear * (s[V] - car_.b * s[r]) / u - s[F2]);
        out[T1] = lag * (-stiffness_[0] * (hitch - axle_[0] * turns) / u - s[T1]);
        out[T2] = lag * (-stiffness_[1] * (hitch - axle_[1] * turns) / u - s[T2]);
        return out;
    }

private:
    static double determinant(const double (&m)[3][3]) {
        return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    }

    Axles car_;
    double mass_, inertia_;
    double h_ = 0, e_ = 0;
    double axle_[2] = {}, stiffness_[2] = {};
};

}  // namespace

/// By the classical Runge-Kutta method, in parts of each step within which tires relax slowly.
std::vector<TrackSample> linearSwing(const TrackTrailer& trailer, const VehicleDef& car,
                                     std::span<const TrackSample> samples) {
    constexpr double kSlowest = 1;  // m/s, below which slip angles are over nothing
    constexpr int kParts = 40;
    const auto of = [](const TrackSample& sample, TrackChannel channel) {
        return sample[static_cast<std::size_t>(channel)];
    };
    const SwingingPair pair(trailer, car);
    std::vector<TrackSample> out(samples.begin(), samples.end());
    SwingingPair::States state{};
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (i > 0) {
            const double h = (of(out[i], TrackChannel::time) - of(out[i - 1], TrackChannel::time)) / kParts;
            const double u = std::max(of(out[i], TrackChannel::speed), kSlowest);
            const double delta = of(out[i], TrackChannel::wheelAngle);
            const auto moved = [&](const SwingingPair::States& rate, double way) {
                SwingingPair::States to = state;
                for (std::size_t k = 0; k < to.size(); ++k) to[k] += way * rate[k];
                return to;
            };
            for (int part = 0; part < kParts; ++part) {
                const auto k1 = pair.rate(state, u, delta), k2 = pair.rate(moved(k1, 0.5 * h), u, delta);
                const auto k3 = pair.rate(moved(k2, 0.5 * h), u, delta), k4 = pair.rate(moved(k3, h), u, delta);
                for (std::size_t k = 0; k < state.size(); ++k)
                    state[k] += h / 6 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
            }
        }
        out[i][static_cast<std::size_t>(TrackChannel::articulation)] = state[SwingingPair::phi];
    }
    return out;
}

}  // namespace ragtop
