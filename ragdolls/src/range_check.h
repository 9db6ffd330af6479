#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <type_traits>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

namespace ragtop {

/// A visitor for `describe` that keeps the first field outside of its range.
struct RangeCheck {
    std::string problem{};

    template <class Field>
    void operator()(const Tunable& tunable, const std::optional<Field>& field) {
        if (field) (*this)(tunable, *field);
    }
    template <class Field>
    void operator()(const Tunable& tunable, const Field& field) {
        if constexpr (std::is_same_v<Field, float>) {
            if (!problem.empty() || (field >= tunable.minimum && field <= tunable.maximum)) return;
            char text[160];
            const std::string unit = tunable.unit == "1" ? "" : " " + std::string(tunable.unit);
            std::snprintf(text, sizeof text, " is %g%s, must be in [%g, %g]", static_cast<double>(field), unit.c_str(),
                          tunable.minimum, tunable.maximum);
            problem = std::string(tunable.name) + text;
        }
    }
};

/// Empty when all described numbers are within their ranges; otherwise the first complaint.
template <class T>
std::string whyOutside(const T& value) {
    RangeCheck check;
    describe(check, value, static_cast<const T*>(nullptr));
    return check.problem;
}

inline bool isRotation(const Quat& q) {
    const float norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    return isFinite(q) && norm > 0.99f && norm < 1.01f;
}

}  // namespace ragtop
