#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "byte_hash.h"
#include "vehicle_sim.h"

namespace ragtop {
namespace {

template <class T>
std::span<const std::byte> bytesOf(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span<const T>(&value, 1));
}
template <class T>
std::span<const std::byte> bytesOf(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span<const T>(values));
}
template <class T>
std::span<std::byte> bytesOf(T& value) {
    return std::as_writable_bytes(std::span<T>(&value, 1));
}
template <class T>
std::span<std::byte> bytesOf(std::vector<T>& values) {
    return std::as_writable_bytes(std::span<T>(values));
}

/// Beyond it squares are no numbers of single precision.
constexpr float kMost = 1e18f;

bool isNumber(float x) { return std::abs(x) <= kMost; }
bool isNumber(const Vec2& a) { return isNumber(a.x) && isNumber(a.y); }
bool isNumber(const Vec3& a) { return isNumber(a.x) && isNumber(a.y) && isNumber(a.z); }
bool areNumbers(const std::vector<float>& values) {
    return std::ranges::all_of(values, [](float x) { return isNumber(x); });
}
bool holdsNumbers(const WheelState& w) {
    return isNumber(w.compression) && isNumber(w.load) && isNumber(w.force) && isNumber(w.deflection) &&
           isNumber(w.core) && isNumber(w.transport) && isNumber(w.travel) && isNumber(w.rotation) &&
           isNumber(w.sunk) && isNumber(w.hubSpeed) && isNumber(w.below) && isNumber(w.inclination) &&
           isNumber(w.aligning);
}

}  // namespace

template <class Self, class Visit>
void VehicleSim::visitState(Self& self, Visit&& visit) {
    visit(self.def.level);
    visit(self.driver);
    visit(self.steerAngle);
    visit(self.drivetrain.engineSpeed);
    visit(self.drivetrain.engine);
    visit(self.drivetrain.clutch);
    visit(self.drivetrain.boost);
    visit(self.drivetrain.gearbox);
    visit(self.drivetrain.spin);
    visit(self.drivetrain.brake);
    visit(self.drivetrain.brakeHeat);
    visit(self.drivetrain.differential);
    visit(self.drivetrain.work);
    visit(self.lost);
    visit(self.wheels);
    visit(self.peakLoads);
    visit(self.carried);
    visit(self.carriers);
    visit(self.endPose);
    visit(self.substepRotation);
    visit(self.unseen);
}

std::size_t VehicleSim::saveSize() const {
    std::size_t size = 0;
    visitState(*this, [&](const auto& value) { size += bytesOf(value).size(); });
    return sizeof digest + size + sizeof(Driver);
}

void VehicleSim::save(std::span<std::byte> into) const {
    const auto put = [&](const auto& value) {
        const auto bytes = bytesOf(value);
        std::copy(bytes.begin(), bytes.end(), into.begin());
        into = into.subspan(bytes.size());
    };
    put(digest);
    visitState(*this, put);
    put(driverOf(input));
}

/// What a state means depends on the car that it is of, also where it is as long.
bool VehicleSim::fits(std::span<const std::byte> from) const {
    std::uint64_t saved = 0;
    std::memcpy(&saved, from.data(), sizeof saved);
    return saved == digest;
}

void VehicleSim::restore(std::span<const std::byte> from) {
    from = from.subspan(sizeof digest);
    const auto get = [&](auto& value) {
        const auto bytes = bytesOf(value);
        std::copy_n(from.begin(), bytes.size(), bytes.begin());
        from = from.subspan(bytes.size());
    };
    const VehicleLevel before = def.level;
    visitState(*this, get);
    if (def.level != before) takeDef();
    Driver set;
    get(set);
    input = {set.throttle,         set.brake,        set.steer, set.handbrake, set.clutch, {},
             set.differentialLock, set.wheelTorques, set.wind};
    if (set.gearGiven != 0) input.gear = set.gear;
    stale = true;
}

std::uint64_t VehicleSim::hash() const {
    ByteHash hash;
    visitState(*this, [&](const auto& value) { hash.add(bytesOf(value)); });
    return hash.value();
}

/// Whether the substep's impulses and what comes of them are numbers that the next one can reckon with.
bool VehicleSim::holds(const Vec3& linear, const Vec3& angular) const {
    const Drivetrain& d = drivetrain;
    return isNumber(linear) && isNumber(angular) && isNumber(d.engineSpeed) && isNumber(d.clutch) &&
           isNumber(Vec3{d.engine.throttle, d.engine.idle, d.engine.friction}) && areNumbers(d.spin) &&
           areNumbers(d.brake) && areNumbers(d.differential) &&
           std::ranges::all_of(d.brakeHeat, [](double heat) { return std::abs(heat) <= static_cast<double>(kMost); }) &&
           std::ranges::all_of(wheels, holdsNumbers);
}

/// Wheels that stand and an engine that idles; where the wheels are and what the driver does stays. What was counted in
/// such a step is not known.
void VehicleSim::forgetMotion() {
    drivetrain.stop(def);
    drivetrain.work = workBefore;
    lost = lostBefore;
    carried = {};
    for (WheelState& wheel : wheels) {
        const GroundPlane ground = wheel.ground;
        wheel = {};
        wheel.ground = ground;
    }
    for (WheelPatch& patch : patches) patch.heldShare = 0;
}

}  // namespace ragtop
