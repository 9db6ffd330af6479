#pragma once

#include <filesystem>

#include "robot_document.h"
#include "xml_text.h"

namespace ragtop {

/// Reads URDF, whose `text` it changes. Throws AssetError: a wrong value with its line, a loop.
ImportedRobot readUrdf(const std::filesystem::path& path, XmlText& text);

}  // namespace ragtop
