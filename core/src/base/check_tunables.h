#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// Validation out of the `describe` declarations: which number is wrong, what it is and what is allowed.
namespace ragtop {

/// The shortest text that reads back as the same number; no exponent where digits are as clear.
template <class Number>
std::string numberText(Number value) {
    std::array<char, 64> text;
    std::to_chars_result end{};
    if constexpr (std::floating_point<Number>) {
        const double size = std::abs(static_cast<double>(value));
        const bool plain = size == 0 || (size >= 1e-5 && size < 1e10);
        end = std::to_chars(text.data(), text.data() + text.size(), value,
                            plain ? std::chars_format::fixed : std::chars_format::general);
    } else {
        end = std::to_chars(text.data(), text.data() + text.size(), value);
    }
    return std::string(text.data(), end.ptr);
}

/// "must be in [0, 10] m", "must be at least 0 m", "must be finite"
inline std::string rangeText(const Tunable& tunable) {
    const std::string unit = tunable.unit.empty() || tunable.unit == "1" ? "" : " " + std::string(tunable.unit);
    const bool below = tunable.minimum > -kUnbounded, above = tunable.maximum < kUnbounded;
    if (below && above) {
        return "must be in [" + numberText(tunable.minimum) + ", " + numberText(tunable.maximum) + "]" + unit;
    }
    if (below) return "must be at least " + numberText(tunable.minimum) + unit;
    if (above) return "must be at most " + numberText(tunable.maximum) + unit;
    return "must be finite";
}

/// Takes any field; stands in for a visitor where only the existence of `describe` matters.
struct AnyVisitor {
    template <class T>
    void operator()(const Tunable&, const T&) const {}
};

template <class T>
concept Described = requires(AnyVisitor& visit, const T& value) {
    describe(visit, value, &value);
};

/// Empty for a unit quaternion, to 1e-3; otherwise the complaint.
inline std::string whyNoRotation(const std::string& name, const Quat& q) {
    const double squared = static_cast<double>(q.x) * q.x + static_cast<double>(q.y) * q.y +
                           static_cast<double>(q.z) * q.z + static_cast<double>(q.w) * q.w;
    if (std::abs(std::sqrt(squared) - 1) <= 1e-3) return {};
    return name + " is (" + numberText(q.x) + ", " + numberText(q.y) + ", " + numberText(q.z) + ", " + numberText(q.w) +
           "), must be finite and have length 1 to within 0.001";
}

template <class Vector>
std::string whyNotFinite(const std::string& name, const Vector& v) {
    const auto numbers = {v.x, v.y, v.z};
    const char* axis = "xyz";
    for (const auto number : numbers) {
        if (!std::isfinite(number)) return name + "." + *axis + " is " + numberText(number) + ", must be finite";
        ++axis;
    }
    return {};
}

template <class T>
concept NamedEnum = std::is_enum_v<T> && requires { enumNames(T{}); };

/// Empty for a value that has a name; otherwise "solver is 3, must be one of automatic (0), iterative (1), direct (2)".
template <NamedEnum T>
std::string whyNoName(const std::string& name, T value) {
    const auto number = static_cast<std::int64_t>(value);
    const auto& names = enumNames(value);
    if (number >= 0 && number < std::ssize(names)) return {};
    std::string why = name + " is " + numberText(number) + ", must be one of ";
    std::int64_t next = 0;
    for (const auto& one : names) {
        if (next > 0) why += ", ";
        why += std::string(one) + " (" + numberText(next++) + ")";
    }
    return why;
}

/// A visitor for `describe` that keeps the first complaint. Strings and the like have no range and pass.
class TunableCheck {
public:
    explicit TunableCheck(std::string prefix = {}) : prefix_(std::move(prefix)) {}

    template <class T>
    void operator()(const Tunable& tunable, const T& value) {
        // Names take memory, and joints may be defined anew in every step.
        if constexpr (std::is_arithmetic_v<T>)
            if (isWithin(tunable, value)) return;
        if (why_.empty()) check(prefix_ + std::string(tunable.name), tunable, value);
    }
    const std::string& why() const { return why_; }

private:
    template <class T>
    void check(const std::string& name, const Tunable& tunable, const T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            return;
        } else if constexpr (std::is_arithmetic_v<T>) {
            checkNumber(name, tunable, value);
        } else if constexpr (NamedEnum<T>) {
            complain(whyNoName(name, value));
        } else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, DVec3>) {
            checkNumber(name + ".x", tunable, value.x);
            checkNumber(name + ".y", tunable, value.y);
            checkNumber(name + ".z", tunable, value.z);
        } else if constexpr (std::is_same_v<T, Quat>) {
            complain(whyNoRotation(name, value));
        } else if constexpr (std::is_same_v<T, Range>) {
            // Ends of a range are in the unit and bounds of what it limits.
            checkNumber(name + ".lower", tunable, value.lower);
            checkNumber(name + ".upper", tunable, value.upper);
            if (value.lower > value.upper) {
                complain(name + ".lower is " + numberText(value.lower) + ", must be at most " + name + ".upper, " +
                         numberText(value.upper));
            }
        } else if constexpr (Described<T>) {
            TunableCheck inner(name + ".");
            describe(inner, value, &value);
            complain(inner.why_);
        } else if constexpr (requires {
                                 value.has_value();
                                 *value;
                             }) {
            if (value) check(name, tunable, *value);
        }
    }

    template <class Number>
    static bool isWithin(const Tunable& tunable, Number value) {
        if constexpr (std::is_same_v<Number, bool>) return true;
        // The bounds in the precision of the value: 1e-4f must not fail "at least 1e-4".
        if constexpr (std::is_floating_point_v<Number>)
            return std::isfinite(value) && value >= rounded<Number>(tunable.minimum) &&
                   value <= rounded<Number>(tunable.maximum);
        return static_cast<double>(value) >= tunable.minimum && static_cast<double>(value) <= tunable.maximum;
    }

    template <class Number>
    void checkNumber(const std::string& name, const Tunable& tunable, Number value) {
        if (!isWithin(tunable, value)) complain(name + " is " + numberText(value) + ", " + rangeText(tunable));
    }

    template <class Number>
    static Number rounded(double bound) {
        constexpr double kMost = std::numeric_limits<Number>::max();
        if (bound > kMost) return std::numeric_limits<Number>::infinity();
        if (bound < -kMost) return -std::numeric_limits<Number>::infinity();
        return static_cast<Number>(bound);
    }

    void complain(const std::string& why) {
        if (why_.empty()) why_ = why;
    }

    std::string prefix_;
    std::string why_;
};

/// Empty when all described fields are finite and in range; otherwise the first complaint, its field after `prefix`.
template <Described T>
std::string whyOutOfRange(const T& value, const std::string& prefix = {}) {
    TunableCheck check(prefix);
    describe(check, value, &value);
    return check.why();
}

}  // namespace ragtop
