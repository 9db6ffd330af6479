#pragma once

#include <string>
#include <vector>

#include "robot_document.h"
#include "xml_text.h"

namespace ragtop {

/// Counts everything that is in a URDF, and whether it becomes part of the robot. What is left out for the looks alone
/// is told by its number only; all else is a warning, attributes included. Throws AssetError on what is for xacro.
std::vector<std::string> countTags(const std::string& file, const TiXmlElement& robot,
                                   std::vector<ImportedRobotTag>& tags);

}  // namespace ragtop
