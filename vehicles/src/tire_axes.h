#pragma once

namespace ragtop {

/// In the plane of the ground under a tire: x forward along the wheel, y to the left.
struct Vec2 {
    float x = 0, y = 0;
    bool operator==(const Vec2&) const = default;
};

}  // namespace ragtop
