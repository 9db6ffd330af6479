#pragma once

#include "json_value.h"
#include "ragtop/scene.h"
#include "scene_file.h"

namespace ragtop {

/// The fabric of an entry: points, faces and lines of the one form that it has, with its numbers. Fails where it has
/// none or several, or is not usable.
ClothDef clothOf(const ClothInScene& in, const JsonValue& at);

/// The points of a cloth that a hold of it means. Fails where it has no such points.
std::vector<int> heldPoints(const ClothInScene& in, const ClothHoldInFile& hold, std::size_t points,
                            const JsonValue& at);

}  // namespace ragtop
