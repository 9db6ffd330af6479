#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ragtop/body.h"
#include "ragtop/debug_draw.h"
#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"

/// What a recording has seen, before it becomes a file.
namespace ragtop {

struct RecordedKey {
    int frame = 0;
    Vec3 position;  ///< m, from the recording's origin
    Quat rotation;
    bool operator==(const RecordedKey&) const = default;
};

struct RecordedPart {
    Shape shape;
    Frame frame;
};

/// One body from its creation to its end.
struct RecordedBody {
    BodyId id;
    BodyType type = BodyType::dynamic;
    std::string name;
    std::optional<Color> color;
    std::vector<RecordedPart> parts;
    std::vector<RecordedKey> keys;  ///< only where it moved, linear between
    int firstFrame = 0;
    int goneFrame = std::numeric_limits<int>::max();  ///< the first frame without it
};

struct RecordedScene {
    std::vector<double> times;  ///< s, of the frames
    std::vector<RecordedBody> bodies;
};

}  // namespace ragtop
