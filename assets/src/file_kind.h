#pragma once

#include <string>
#include <string_view>

namespace ragtop {

/// "; it looks like VRML", by the first bytes of a file; empty where they are of no format that is known here.
std::string looksLike(std::string_view file);

}  // namespace ragtop
