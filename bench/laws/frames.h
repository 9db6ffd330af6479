#pragma once

#include <span>
#include <string>

#include "grammar.h"

/// The same scene seen from elsewhere. Physics does not depend on it, so verdicts must not.
namespace ragtop::laws {

struct Seen {
    std::string name;
    Drawn (*from)(Drawn drawn);
    double length = 1;    ///< of a metre of the scene
    bool hasCars = true;  ///< where there are some: their air stands, and their definitions have a size
};

/// Moving evenly, turned about the vertical, far away, four times as large with twice the step, made in reverse order.
std::span<const Seen> allViews();

}  // namespace ragtop::laws
