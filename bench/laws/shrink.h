#pragma once

#include <functional>

#include "grammar.h"

namespace ragtop::laws {

/// The smallest scene found by leaving out bodies, with the joints that hold them, and joints, for which `fails` still
/// holds: halves first, then ever smaller parts [Zeller, Hildebrandt, Simplifying and isolating failure-inducing input,
/// 2002]. Tries `most` scenes.
Drawn shrunk(Drawn drawn, const std::function<bool(const Drawn&)>& fails, int most = 400);

}  // namespace ragtop::laws
