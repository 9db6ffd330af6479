#include <cmath>

#include "world/draw_joint.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

// 0xRRGGBB
constexpr Color kFixedColor = 0x8a8f98, kKinematicColor = 0x4f9dde, kAwakeColor = 0xe0a458, kAsleepColor = 0x6d7f5e,
                kContactColor = 0xd1495b, kForceColor = 0xf5d547, kBoundsColor = 0x9c6ade;
constexpr float kStandardGravity = 9.81f;  ///< m/s², for the scale of forces
constexpr float kLongestArrow = 4;         ///< sizes

void drawTriangles(DebugDraw& draw, const Pose& pose, std::span<const Vec3> vertices,
                   std::span<const Triangle> triangles, Color color) {
    for (const Triangle& t : triangles)
        draw.triangle(transformPoint(pose, vertices[t.a]), transformPoint(pose, vertices[t.b]),
                      transformPoint(pose, vertices[t.c]), color);
}

struct ShapePainter {
    DebugDraw& draw;
    Pose pose;
    Color color;

    void operator()(const Sphere& s) const { draw.sphere(pose, s.radius, color); }
    void operator()(const Capsule& c) const { draw.capsule(pose, c.radius, c.halfHeight, color); }
    void operator()(const Box& b) const { draw.box(pose, b.halfExtents, color); }
    void operator()(const ConvexHull& h) const {
        const HullData& hull = h.data();
        for (const HullData::Edge& e : hull.edges)
            draw.line(transformPoint(pose, hull.vertices[e.from]), transformPoint(pose, hull.vertices[e.to]), color);
    }
    void operator()(const TriangleMesh& m) const { drawTriangles(draw, pose, m.vertices(), m.triangles(), color); }
    void operator()(const HeightField& f) const {
        for (int row = 0; row < f.rows(); ++row)
            for (int column = 0; column < f.columns(); ++column) {
                const auto at = [&](int c, int r) {
                    const float height = f.heights()[static_cast<std::size_t>(r * f.columns() + c)];
                    return transformPoint(
                        pose, Vec3{static_cast<float>(c) * f.spacing(), height, static_cast<float>(r) * f.spacing()});
                };
                if (column + 1 < f.columns()) draw.line(at(column, row), at(column + 1, row), color);
                if (row + 1 < f.rows()) draw.line(at(column, row), at(column, row + 1), color);
            }
    }
    void operator()(const Compound&) const {}
};

void drawBounds(DebugDraw& draw, const Bounds& b) {
    const Vec3 corner[2] = {b.lower, b.upper};
    const auto at = [&](int i) { return DVec3(corner[i & 1].x, corner[(i >> 1) & 1].y, corner[(i >> 2) & 1].z); };
    for (int i = 0; i < 8; ++i)
        for (int bit = 1; bit < 8; bit <<= 1)
            if ((i & bit) == 0) draw.line(at(i), at(i | bit), kBoundsColor);
}

/// Forces on the lighter body; one of its weight is a quarter as long as that body is large.
void drawContact(DebugDraw& draw, const WorldImpl& world, const Contact& contact) {
    const BodyRecord* lighter = nullptr;
    float sign = 1;
    for (const BodyId id : {contact.bodyA, contact.bodyB}) {
        const BodyRecord& body = world.tables.bodies[id.index];
        if (!world.tables.bodies.moves(id.index) || (lighter && body.mass >= lighter->mass)) continue;
        lighter = &body;
        sign = id == contact.bodyB ? 1.0f : -1.0f;
    }
    if (!lighter) return;
    const float scale = 0.25f * lighter->size / (lighter->mass * kStandardGravity);
    const Vec3 force = sign * scale * (contact.normalForce * contact.normal + contact.frictionForce);
    float whole = 0;
    for (int i = 0; i < contact.pointCount; ++i) whole += contact.points[i].impulse;
    for (int i = 0; i < contact.pointCount; ++i) {
        const ContactPoint& point = contact.points[i];
        draw.sphere({point.point, {}}, 0.04f * lighter->size, kContactColor);
        if (!(whole > 0)) continue;
        const Vec3 arrow = (point.impulse / whole) * force;
        const float longest = kLongestArrow * lighter->size, length = ragtop::length(arrow);
        draw.arrow(point.point, length > longest ? (longest / length) * arrow : arrow, kForceColor);
    }
}

}  // namespace

/// Hues at steps of the golden section, which are far apart for any few numbers.
Color islandColor(BodyId first) {
    if (first.isNull()) return kAsleepColor;
    const float turns = 0.618034f * static_cast<float>(first.index), hue = 6 * (turns - std::floor(turns));
    const auto channel = [&](float peak) {
        const float away = std::abs(std::remainder(hue - peak, 6.0f));
        const float share = away < 1 ? 1 : away < 2 ? 2 - away : 0;
        return static_cast<Color>(70 + 165 * share);
    };
    return channel(0) << 16 | channel(2) << 8 | channel(4);
}

void World::draw(DebugDraw& draw) const {
    const WorldImpl& impl = *impl_;
    std::vector<Color> ofIsland;
    if (draw.options.islands) {
        ofIsland.resize(impl.tables.bodies.slots.count(), kAsleepColor);
        const std::vector<BodyId> first = islands();
        for (std::size_t i = 0; i < first.size(); ++i) ofIsland[bodies()[i].index] = islandColor(first[i]);
    }
    for (std::uint32_t s = 0; s < impl.tables.shapes.slots.count(); ++s) {
        if (!impl.tables.shapes.slots.isUsed(s)) continue;
        const ShapeRecord& shape = impl.tables.shapes[s];
        if (!impl.tables.bodies.isEnabled(shape.body)) continue;
        const BodyRecord& body = impl.tables.bodies[shape.body];
        const Color color = body.type == BodyType::fixed       ? kFixedColor
                            : body.type == BodyType::kinematic ? kKinematicColor
                            : draw.options.islands             ? ofIsland[shape.body]
                            : body.awakeIndex != kNone         ? kAwakeColor
                                                               : kAsleepColor;
        if (draw.options.shapes)
            std::visit(ShapePainter{draw, shapePose(impl.tables.bodies[shape.body], shape), color},
                       impl.tables.shapes.geometries[shape.geometry].shape);
        if (draw.options.bounds && shape.proxy != kNone)
            drawBounds(draw, impl.collision.broadphase.tree(shape.isStaticTree).bounds(shape.proxy));
    }
    if (draw.options.centers)
        for (const BodyId id : bodies())
            if (impl.tables.bodies.moves(id.index))
                draw.frame({centerOfMass(id), impl.tables.bodies[id.index].rotation},
                           impl.tables.bodies[id.index].size);
    if (draw.options.contacts) forEachContact([&](const Contact& contact) { drawContact(draw, impl, contact); });
    if (draw.options.joints)
        for (const JointId id : joints()) {
            const JointRecord& joint = impl.tables.joints[id.index];
            const JointBodies& ends =
                std::visit([](const auto& d) -> const JointBodies& { return d.bodies; }, joint.def);
            const Pose a = joint.bodyA == 0 ? Pose{} : poseOf(impl.tables.bodies[joint.bodyA]);
            const Pose b = joint.bodyB == 0 ? Pose{} : poseOf(impl.tables.bodies[joint.bodyB]);
            float size = 0;
            for (const std::uint32_t end : {joint.bodyA, joint.bodyB})
                if (impl.tables.bodies.moves(end) && (size == 0 || impl.tables.bodies[end].radius < size))
                    size = impl.tables.bodies[end].radius;
            drawJoint(draw, joint.def, state(id), a * ends.frameA, b * ends.frameB, size);
        }
}

}  // namespace ragtop
