#include "world/shape_motion.h"

#include "world/world_impl.h"

namespace ragtop {

namespace {

/// How much room is left in the bounds of the body's other shapes is not known then.
void refit(WorldImpl& world, std::uint32_t index) {
    const ShapeRecord& shape = world.shapes[index];
    const ShapeBounds bounds = world.shapeBounds();
    bounds.giveRoom(shape.body);
    if (shape.proxy == kNone) return;
    const Bounds tight = bounds.tightBounds(shape, world.dt);
    if (contains(world.broadphase.tree(shape.isStaticTree).bounds(shape.proxy), tight)) return;
    bounds.removeProxy(index);
    bounds.insertProxy(index);
}

}  // namespace

/// What a shape goes in its body counts as travel of the body.
void moveShape(WorldImpl& world, std::uint32_t index, const Frame& frame) {
    ShapeRecord& shape = world.shapes[index];
    BodyRecord& body = world.bodies[shape.body];
    if (frame == shape.frame) return;
    if (body.type == BodyType::fixed) {
        world.wakeTouching(shape.body);
        ++world.fixedVersion;
    } else {
        world.wakeBody(shape.body);
    }
    const GeometryEntry& geometry = world.shapes.geometryOf(shape);
    const Quat turn = conjugate(shape.frame.rotation) * frame.rotation;
    const float travel = length(frame.position - shape.frame.position) +
                         2 * length(Vec3{turn.x, turn.y, turn.z}) * radiusAbout(geometry.shape, {});
    shape.frame = frame;
    reach(body, shape, geometry);
    body.travel += static_cast<double>(travel);
    world.forgetGaps(shape.body);
    refit(world, index);
}

}  // namespace ragtop
