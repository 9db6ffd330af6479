#include "definition_digest.h"

#include <optional>
#include <string>
#include <type_traits>

#include "byte_hash.h"

namespace ragtop {
namespace {

/// Visits a definition down to its numbers.
class Digest {
public:
    template <class T>
    void operator()(const Tunable&, const T& value) {
        add(value);
    }
    template <class T>
    void add(const T& value) {
        if constexpr (std::is_same_v<T, VehicleLevel>) {
            return;  // which is state
        } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            hash_.add(std::as_bytes(std::span<const T>(&value, 1)));
        } else if constexpr (std::is_same_v<T, Vec3>) {
            for (const float part : {value.x, value.y, value.z}) add(part);
        } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, ChassisShape> ||
                             std::is_same_v<T, VehicleVisualDef>) {
            return;
        } else if constexpr (requires { describe(*this, value, &value); }) {
            describe(*this, value, &value);
        } else if constexpr (requires { value.has_value(); }) {
            add(value.has_value());
            if (value) add(*value);
        } else {
            add(value.size());
            for (const auto& one : value) add(one);
        }
    }
    std::uint64_t value() const { return hash_.value(); }

private:
    ByteHash hash_;
};

}  // namespace

std::uint64_t definitionDigest(const VehicleDef& def, const MassProperties& mass, float gravity) {
    Digest digest;
    digest.add(def);
    digest.add(mass.mass);
    for (const Vec3& part : {mass.center, mass.inertia.cx, mass.inertia.cy, mass.inertia.cz}) digest.add(part);
    digest.add(gravity);
    return digest.value();
}

}  // namespace ragtop
