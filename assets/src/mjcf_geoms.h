#pragma once

#include <optional>

#include "mjcf_places.h"
#include "ragtop/shape.h"
#include "robot_document.h"

namespace ragtop {

/// A geom: what it weighs and, where it collides, its shape, in the frame of its body.
struct MjcfGeom {
    std::optional<ImportedRobotShape> shape;
    std::optional<MassProperties> mass;  ///< none of planes and meshes
    bool isMesh = false;
};

MjcfGeom readGeom(const MjcfElement& element, const MjcfCompiler& compiler);

}  // namespace ragtop
