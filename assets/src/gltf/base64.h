#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ragtop {

/// The URI of a buffer that stands in the file itself.
std::string dataUri(std::span<const std::byte> bytes);

}  // namespace ragtop
