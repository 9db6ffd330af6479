#pragma once

#include <string>

#include "ragtop/robot.h"

namespace ragtop::demos {

/// What a description became, as a JSON object: bodies, joints, who follows whom, elements by name with how many were
/// applied and left out, and warnings.
std::string robotJson(const Robot& robot);

}  // namespace ragtop::demos
