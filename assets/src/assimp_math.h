#pragma once

#include <assimp/vector3.h>

#include "ragtop/math.h"

namespace ragtop {

inline Vec3 toVec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

}  // namespace ragtop
