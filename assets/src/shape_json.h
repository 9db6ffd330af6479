#pragma once

#include "json_value.h"
#include "ragtop/shape.h"

namespace ragtop {

/// A shape in a file is an object with one member: {"box": {...}}, {"sphere": {...}}, {"capsule": {...}},
/// {"hull": points or "file"}, {"mesh": {"vertices", "triangles"} or "file"}, {"heightField": {...}},
/// {"compound": [{"shape", "frame"}, ...]}.
Json shapeSchema(bool compounds = true);
/// Throws AssetError where the numbers, or the file referred to, make no usable shape.
Shape readShape(const JsonValue& value);
Json writeShape(const Shape& shape);

}  // namespace ragtop
