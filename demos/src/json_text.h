#pragma once

#include <string>
#include <string_view>

namespace ragtop::demos {

/// As JSON; it has no NaN and no infinity, which are null.
std::string jsonNumber(double value);
std::string jsonString(std::string_view text);

}  // namespace ragtop::demos
