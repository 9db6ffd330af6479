#pragma once

#include <string>
#include <string_view>

namespace ragtop::demos {

/// As JSON; it has no NaN and no infinity, which are null.
std::string jsonNumber(double value);
std::string jsonString(std::string_view text);
/// A member with a list of what `one` makes of each element, a line each.
template <class All, class One>
std::string jsonList(const char* name, const All& all, One one) {
    std::string lines;
    for (const auto& each : all) lines += (lines.empty() ? "\n      " : ",\n      ") + one(each);
    return "    \"" + std::string(name) + "\": [" + lines + (lines.empty() ? "]" : "\n    ]");
}

}  // namespace ragtop::demos
