#pragma once

#include <filesystem>
#include <string>

#include "ragtop/asset_error.h"
#include "ragtop/robot_def.h"

namespace ragtop {

/// Reads URDF, besides capsules (URDF 1.1) and spherical joints (Bullet's dialect), and a part of MJCF. docs/files.md
/// has what each element becomes; what cannot be honoured (meshes that are absent, transmissions) is left out with a
/// warning and counted in `tags`. Throws AssetError with the line: not XML, a value that is no number or out of range,
/// a link that is missing.
Robot loadRobot(const std::filesystem::path& path, const RobotOptions& options = {});

/// Mass, bodies with shapes, joints and warnings, some lines of text.
std::string describeAsset(const Robot& robot);

}  // namespace ragtop
