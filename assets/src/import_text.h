#pragma once

#include <cstdio>
#include <string>

namespace ragtop {

/// Six digits, without trailing zeros.
inline std::string shortNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}
inline std::string shortNumber(float value) { return shortNumber(static_cast<double>(value)); }

}  // namespace ragtop
