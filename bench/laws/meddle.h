#pragma once

#include <array>
#include <string>
#include <vector>

#include "grammar.h"

namespace ragtop::laws {

/// Laws that are broken only where a scene is meddled with.
inline constexpr std::array<const char*, 2> kMeddledLaws{"valid", "in range"};

/// Does to a scene what games do to worlds: bodies are made, destroyed, put elsewhere, pushed, given other masses and
/// other gravity, joints made and broken, worlds saved and restored, in steps of 1/240 to 1/15 s. Then it is left alone.
/// Names of the laws that did not hold: that all numbers are in range and the world's parts agree throughout, and, once
/// it is left alone, that joints are closed and energy does not grow where nothing drives it.
std::vector<std::string> meddle(const Drawn& drawn, std::uint64_t seed);

}  // namespace ragtop::laws
