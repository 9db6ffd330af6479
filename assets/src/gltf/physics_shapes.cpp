#include "gltf/physics_shapes.h"

#include <cmath>
#include <optional>
#include <stdexcept>

namespace ragtop {
namespace {

/// Of round shapes as hulls: corners around, and rings from pole to pole.
constexpr int kAround = 16, kRings = 4;

void addRing(std::vector<Vec3>& points, float radius, float y) {
    for (int i = 0; i < kAround; ++i) {
        const SinCos turn = sinCos(2 * kPi * static_cast<float>(i) / kAround);
        points.push_back({radius * turn.cos, y, radius * turn.sin});
    }
}

/// Half a ball about (0, y, 0), upwards or downwards.
void addCap(std::vector<Vec3>& points, float radius, float y, float up) {
    for (int ring = 0; ring < kRings; ++ring) {
        const SinCos height = sinCos(kPi / 2 * static_cast<float>(ring) / kRings);
        addRing(points, radius * height.cos, y + up * radius * height.sin);
    }
    points.push_back({0, y + up * radius, 0});
}

std::vector<Vec3> cornersOf(const GltfShape& shape) {
    std::vector<Vec3> points;
    const GltfRod& rod = shape.type == GltfShapeType::capsule ? shape.capsule : shape.cylinder;
    if (shape.type == GltfShapeType::box) {
        for (int corner = 0; corner < 8; ++corner)
            points.push_back(0.5f * scale(shape.box.size, {corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f,
                                                           corner & 4 ? 1.0f : -1.0f}));
    } else if (shape.type == GltfShapeType::sphere) {
        addCap(points, shape.sphere.radius, 0, 1), addCap(points, shape.sphere.radius, 0, -1);
    } else if (shape.type == GltfShapeType::capsule) {
        addCap(points, rod.radiusTop, rod.height / 2, 1), addCap(points, rod.radiusBottom, -rod.height / 2, -1);
    } else {
        addRing(points, rod.radiusTop, rod.height / 2), addRing(points, rod.radiusBottom, -rod.height / 2);
    }
    return points;
}

/// The shape itself where Ragtop has it.
std::optional<Shape> sameShape(const GltfShape& shape, float size) {
    switch (shape.type) {
        case GltfShapeType::sphere:
            return Sphere{size * shape.sphere.radius};
        case GltfShapeType::box:
            return Box{size * 0.5f * shape.box.size};
        case GltfShapeType::capsule:
            if (shape.capsule.radiusBottom != shape.capsule.radiusTop) return std::nullopt;
            return Capsule{size * shape.capsule.radiusTop, size * 0.5f * shape.capsule.height};
        default:
            return std::nullopt;
    }
}

class BodyShaper {
public:
    BodyShaper(const GltfFile& file, const GltfTree& tree, const JsonValue& json, const MeshPoints& points, int body)
        : file_(file), tree_(tree), json_(json), meshPoints_(points), body_(body), size_(tree.scaleWithin(body)) {}

    BodyShape shape(const std::vector<int>& nodes) {
        if (nodes.size() == 1)
            if (std::optional<BodyShape> whole = wholeOf(nodes[0])) return *std::move(whole);
        if (nodes.size() > 1)
            result_.lost.push_back("has " + std::to_string(nodes.size()) + " colliders, of which the hull is taken");
        for (const int node : nodes) addPoints(node);
        const JsonValue at = colliderOf(nodes.front());
        try {
            result_.shape = ConvexHull(points_);
        } catch (const std::invalid_argument& error) {
            at.fail(std::string("makes no shape: ") + error.what());
        }
        return std::move(result_);
    }

private:
    JsonValue colliderOf(int node) const {
        return json_.at("nodes")
            .at(static_cast<std::size_t>(node))
            .at("extensions")
            .at(std::string(kGltfPhysics))
            .at("collider");
    }
    const GltfGeometry& geometryOf(int node) const {
        return file_.nodes[static_cast<std::size_t>(node)].extensions.physics->collider->geometry;
    }

    const GltfShape& namedShape(int node) const {
        const GltfGeometry& geometry = geometryOf(node);
        const std::vector<GltfShape>& shapes = file_.extensions.shapes.shapes;
        if (static_cast<std::size_t>(*geometry.shape) >= shapes.size())
            colliderOf(node)
                .at("geometry")
                .at("shape")
                .fail("is " + std::to_string(*geometry.shape) + ", must be one of " + std::to_string(shapes.size()) +
                      " shapes of KHR_implicit_shapes");
        const GltfShape& shape = shapes[static_cast<std::size_t>(*geometry.shape)];
        if (shape.type == GltfShapeType::plane)
            colliderOf(node)
                .at("geometry")
                .at("shape")
                .fail("is a plane, must be a shape with a volume where it moves");
        return shape;
    }

    /// A collider that is a ball, box or capsule of equal scales along its axes.
    std::optional<BodyShape> wholeOf(int node) const {
        if (!geometryOf(node).shape) return std::nullopt;
        const Vec3 size = tree_.scaleWithin(node);
        if (size.x != size.y || size.y != size.z || !(size.x > 0)) return std::nullopt;
        const std::optional<Shape> same = sameShape(namedShape(node), size.x);
        if (!same) return std::nullopt;
        if (const std::string wrong = whyInvalid(*same); !wrong.empty())
            colliderOf(node).fail("makes no shape: " + wrong);
        Frame frame = tree_.within(node, body_);
        frame.position = scale(size_, frame.position);
        return BodyShape{*same, frame, {}};
    }

    void addPoints(int node) {
        const GltfGeometry& geometry = geometryOf(node);
        std::vector<Vec3> points;
        if (geometry.shape) {
            const GltfShape& shape = namedShape(node);
            points = cornersOf(shape);
            if (shape.type != GltfShapeType::box) result_.lost.push_back("has a round shape, of which a hull is taken");
        } else {
            int mesh = geometry.mesh.value_or(-1);
            if (geometry.node && static_cast<std::size_t>(*geometry.node) < file_.nodes.size())
                mesh = file_.nodes[static_cast<std::size_t>(*geometry.node)].mesh.value_or(-1);
            if (mesh < 0)
                colliderOf(node)
                    .at("geometry")
                    .fail("has no geometry, must have a shape, a mesh or a node with a mesh");
            points = meshPoints_(mesh);
            if (!geometry.convexHull) result_.lost.push_back("has a mesh as a collider, of which the hull is taken");
        }
        for (const Vec3& point : points) points_.push_back(scale(size_, tree_.pointWithin(point, node, body_)));
    }

    const GltfFile& file_;
    const GltfTree& tree_;
    const JsonValue& json_;
    const MeshPoints& meshPoints_;
    int body_;
    Vec3 size_;
    std::vector<Vec3> points_;
    BodyShape result_;
};

}  // namespace

BodyShape shapeOfBody(const GltfFile& file, const GltfTree& tree, const JsonValue& json, const MeshPoints& points,
                      int body, const std::vector<int>& nodes) {
    return BodyShaper(file, tree, json, points, body).shape(nodes);
}

}  // namespace ragtop
