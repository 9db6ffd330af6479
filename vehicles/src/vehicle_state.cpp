#include <algorithm>
#include <cstddef>
#include <type_traits>

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

constexpr std::uint64_t kFnvOffset = 14695981039346656037ull;
constexpr std::uint64_t kFnvPrime = 1099511628211ull;

}  // namespace

template <class Self, class Visit>
void VehicleSim::visitState(Self& self, Visit&& visit) {
    visit(self.driver);
    visit(self.steerAngle);
    visit(self.drivetrain.engineSpeed);
    visit(self.drivetrain.engine);
    visit(self.drivetrain.clutch);
    visit(self.drivetrain.gearbox);
    visit(self.drivetrain.spin);
    visit(self.drivetrain.brake);
    visit(self.drivetrain.differential);
    visit(self.wheels);
}

std::size_t VehicleSim::saveSize() const {
    std::size_t size = 0;
    visitState(*this, [&](const auto& value) { size += bytesOf(value).size(); });
    return size + sizeof(Driver);
}

void VehicleSim::save(std::span<std::byte> into) const {
    const auto put = [&](const auto& value) {
        const auto bytes = bytesOf(value);
        std::copy(bytes.begin(), bytes.end(), into.begin());
        into = into.subspan(bytes.size());
    };
    visitState(*this, put);
    put(driverOf(input));
}

void VehicleSim::restore(std::span<const std::byte> from) {
    const auto get = [&](auto& value) {
        const auto bytes = bytesOf(value);
        std::copy_n(from.begin(), bytes.size(), bytes.begin());
        from = from.subspan(bytes.size());
    };
    visitState(*this, get);
    Driver set;
    get(set);
    input = {set.throttle, set.brake, set.steer, set.handbrake, set.clutch, {}};
    if (set.gearGiven != 0) input.gear = set.gear;
    stale = true;
}

/// FNV-1a.
std::uint64_t VehicleSim::hash() const {
    std::uint64_t hash = kFnvOffset;
    visitState(*this, [&](const auto& value) {
        for (const std::byte byte : bytesOf(value)) hash = (hash ^ static_cast<std::uint64_t>(byte)) * kFnvPrime;
    });
    return hash;
}

}  // namespace ragtop
