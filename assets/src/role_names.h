#pragma once

#include <string>
#include <vector>

#include "ragtop/anatomy.h"

namespace ragtop {

/// Names of the values in the order of the enums; describe_json.h finds them by argument.
const std::vector<std::string>& enumNames(BodyRole);
const std::vector<std::string>& enumNames(BodySide);
inline std::vector<const char*> requiredFields(const BoneRole*) { return {"bone"}; }

}  // namespace ragtop
