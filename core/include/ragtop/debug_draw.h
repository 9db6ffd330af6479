#pragma once

#include <cstdint>
#include <string_view>

#include "ragtop/id.h"
#include "ragtop/math.h"

namespace ragtop {

/// 0xRRGGBB.
using Color = std::uint32_t;

/// The colour of an island by its first body (World::islands); of sleeping bodies where that is null.
Color islandColor(BodyId first);

/// What World::draw calls; derive from it to show a world. Every function does nothing by default.
class DebugDraw {
public:
    struct Options {
        bool shapes = true, contacts = false, joints = false, bounds = false, centers = false, islands = false;
    };
    Options options;

    virtual ~DebugDraw() = default;
    virtual void line(const DVec3&, const DVec3&, Color) {}
    virtual void arrow(const DVec3& /*from*/, const Vec3& /*along*/, Color) {}
    virtual void sphere(const Pose&, float /*radius*/, Color) {}
    virtual void capsule(const Pose&, float /*radius*/, float /*halfHeight*/, Color) {}
    virtual void box(const Pose&, const Vec3& /*halfExtents*/, Color) {}
    virtual void triangle(const DVec3&, const DVec3&, const DVec3&, Color) {}
    virtual void frame(const Pose&, float /*size*/) {}
    virtual void text(const DVec3&, std::string_view, Color) {}
};

}  // namespace ragtop
