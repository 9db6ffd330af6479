#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "json_document.h"

namespace ragtop {

inline constexpr int kMaxJsonDepth = 64;

/// Line and column of a byte of the text.
JsonPlace placeAt(std::string_view text, std::size_t byte);

/// Where each value of a well-formed text begins, by JSON pointer. nlohmann's parser keeps no places and silently
/// takes the last of two equal keys, so this pass finds both. Throws AssetError on equal keys and deep nesting.
std::map<std::string, JsonPlace> scanPlaces(std::string_view text, const std::string& file);

}  // namespace ragtop
