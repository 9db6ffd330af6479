#pragma once

#include <string>
#include <vector>

#include "robot_document.h"
#include "xml_text.h"

namespace ragtop {

/// What the URDF library cannot read, taken out of the text before it sees it.
struct ExtraCapsule {
    std::string link;
    double radius = 0, length = 0;  ///< m; the length is of the straight part, along z
    double xyz[3]{}, rpy[3]{};      ///< of the capsule in the link
};

struct CheckedRobotText {
    std::string text;  ///< XML that the library can read
    std::vector<ExtraCapsule> capsules;
    std::vector<std::string> spherical;  ///< joints to be made balls; "floating" in the text
    std::vector<ImportedRobotTag> tags;
    std::vector<std::string> warnings;  ///< of elements that nothing will use, and others
};

/// Checks what the library lets pass: every number and its range, names that are doubled, links that are missing.
/// Throws AssetError with file and line.
CheckedRobotText checkRobotText(const std::string& file, XmlText& text);

}  // namespace ragtop
