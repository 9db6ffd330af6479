#pragma once

#include <filesystem>

#include "robot_document.h"
#include "xml_text.h"

namespace ragtop {

/// Reads MJCF, MuJoCo's format, of which `root` is the element <mujoco>: bodies, joints, geoms, default classes,
/// included files, equalities, excluded pairs, fixed tendons, actuators and keyframes. Throws AssetError with file and
/// line.
ImportedRobot readMjcf(const std::filesystem::path& path, const TiXmlElement& root);

}  // namespace ragtop
