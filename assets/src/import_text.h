#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ragtop {

/// Six digits, without trailing zeros.
inline std::string shortNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}
inline std::string shortNumber(float value) { return shortNumber(static_cast<double>(value)); }

/// Equal texts once, where the first of them was, with how often they were there.
inline std::vector<std::string> counted(const std::vector<std::string>& texts) {
    std::map<std::string, int> times;
    for (const std::string& text : texts) ++times[text];
    std::vector<std::string> once;
    for (const std::string& text : texts) {
        const int count = std::exchange(times[text], 0);
        if (count > 0) once.push_back(count == 1 ? text : text + " (" + std::to_string(count) + " times)");
    }
    return once;
}

}  // namespace ragtop
