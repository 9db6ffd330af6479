#pragma once

#include <cstdint>
#include <string_view>

#include "ragtop/id.h"
#include "ragtop/math.h"

namespace ragtop {

/// 0xRRGGBB.
using Color = std::uint32_t;

/// The colour of the island with this first body (World::islands); for a null id that of sleeping bodies.
Color islandColor(BodyId first);

/// The interface that World::draw calls; derive from it to show a world. Positions and sizes are in m. By default every
/// function does nothing.
class DebugDraw {
public:
    struct Options {  ///< what is drawn
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
