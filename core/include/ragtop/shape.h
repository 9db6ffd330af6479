#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// Shapes are values: copies of a hull, mesh or height field share its data, which never changes.
namespace ragtop {

/// How the numbers of two surfaces that meet are combined. Of two different rules, the later in this list holds.
enum class CombineRule : std::uint8_t { geometricMean, average, minimum, product, maximum };
constexpr std::array<std::string_view, 5> enumNames(CombineRule) {
    return {"geometricMean", "average", "minimum", "product", "maximum"};
}
/// The number of two surfaces with these rules and values.
float combined(CombineRule a, float valueA, CombineRule b, float valueB);

/// What a surface does to what touches it. For two surfaces, friction and restitution are combined by their rules; the
/// larger rolling and spinning resistance, the difference of surface velocities, and the grain of the surface whose
/// friction depends more on direction hold.
struct Material {
    float friction = 0.6f;           ///< Coulomb coefficient at rest, along the grain where there is one
    float slidingShare = 1.0f;       ///< coefficient while sliding over that at rest
    Vec3 grain{};                    ///< direction in the body's frame; zero: no grain
    float crossFriction = 1.0f;      ///< coefficient across the grain over that along it
    float restitution = 0.0f;        ///< speed after over speed before an impact
    float rollingResistance = 0.0f;  ///< resisting moment over normal force, m
    float spinningResistance = 0.0f; ///< resisting moment about the normal over normal force, m
    CombineRule frictionRule = CombineRule::geometricMean;
    CombineRule restitutionRule = CombineRule::maximum;
    Vec3 surfaceVelocity{};            ///< m/s in the body's frame; a conveyor belt
    std::uint32_t surface = 0;       ///< the caller's name for the surface, handed on in events
    bool operator==(const Material&) const = default;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Material*) {
    visit(Tunable{"friction", "1", 0, 10, "Coulomb coefficient at rest, along the grain"}, self.friction);
    visit(Tunable{"slidingShare", "1", 0, 1, "coefficient while sliding over that at rest"}, self.slidingShare);
    visit(Tunable{"grain", "1", -1e5, 1e5, "direction in the body's frame; zero: none"}, self.grain);
    visit(Tunable{"crossFriction", "1", 0.01, 100, "coefficient across the grain over that along it"},
          self.crossFriction);
    visit(Tunable{"restitution", "1", 0, 1, "speed after over speed before an impact"}, self.restitution);
    visit(Tunable{"rollingResistance", "m", 0, 1, "resisting moment over normal force"}, self.rollingResistance);
    visit(Tunable{"spinningResistance", "m", 0, 1, "resisting moment about the normal over normal force"},
          self.spinningResistance);
    visit(Tunable{"frictionRule", "", 0, 0, "how the coefficient is made of two surfaces'"}, self.frictionRule);
    visit(Tunable{"restitutionRule", "", 0, 0, "how restitution is made of two surfaces'"}, self.restitutionRule);
    visit(Tunable{"surfaceVelocity", "m/s", -1000, 1000, "velocity of the surface in the body's frame"},
          self.surfaceVelocity);
    visit(Tunable{"surface", "", 0, 4294967295.0, "the caller's name for the surface"}, self.surface);
}

/// Which shapes collide: each one's mask must meet the other's category. Shapes of one group above zero always collide,
/// those of one group below zero never do.
struct Filter {
    std::uint32_t category = 1;
    std::uint32_t mask = 0xffffffffu;
    std::int32_t group = 0;
    bool operator==(const Filter&) const = default;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Filter*) {
    visit(Tunable{"category", "", 0, 4294967295.0, "bits of what this is"}, self.category);
    visit(Tunable{"mask", "", 0, 4294967295.0, "bits of what this collides with"}, self.mask);
    visit(Tunable{"group", "", -2147483648.0, 2147483647.0, "equal and positive: always collide; negative: never"},
          self.group);
}

/// A ball about the origin.
struct Sphere {
    float radius = 0.5f;  ///< m
};

/// A segment along y from −halfHeight to +halfHeight, thickened by radius.
struct Capsule {
    float radius = 0.25f;      ///< m
    float halfHeight = 0.25f;  ///< m, of the segment, without the caps
};

/// A box about the origin.
struct Box {
    Vec3 halfExtents{0.5f, 0.5f, 0.5f};  ///< m
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Sphere*) {
    visit(Tunable{"radius", "m", 1e-4, 1e5, "radius of the ball"}, self.radius);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Capsule*) {
    visit(Tunable{"radius", "m", 1e-4, 1e5, "radius of tube and caps"}, self.radius);
    visit(Tunable{"halfHeight", "m", 0, 1e5, "half the length of the segment, without the caps"}, self.halfHeight);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Box*) {
    visit(Tunable{"halfExtents", "m", 1e-4, 1e5, "half the size along x, y, z"}, self.halfExtents);
}

struct HullData;
struct MeshData;
struct ShapeImage;
struct HeightFieldData;

/// The convex hull of points.
class ConvexHull {
public:
    /// Builds the hull of 4 to 65,535 points that are finite and not all in a plane; it keeps at most 128 vertices
    /// (the outermost, in a fixed order). Throws std::invalid_argument saying which point or what is wrong.
    explicit ConvexHull(std::span<const Vec3> points);
    const HullData& data() const { return *data_; }
    std::span<const Vec3> vertices() const;

private:
    friend struct ShapeImage;
    explicit ConvexHull(std::shared_ptr<const HullData> data) : data_(std::move(data)) {}
    std::shared_ptr<const HullData> data_;
};

/// Three indices into the vertices, counter-clockwise as seen from outside.
struct Triangle {
    std::uint32_t a = 0, b = 0, c = 0;
};

/// A surface of triangles that collides on the side from which they are counter-clockwise. On a dynamic body it is a
/// solid of any form and must be closed; an open one is a thin sheet, and its body's mass must be given.
class TriangleMesh {
public:
    /// `materialOfTriangle` is empty, or has one index per triangle into `materials` (then the shape's own material
    /// is not used). Throws std::invalid_argument on an empty mesh, an index out of range, a number that is not
    /// finite. Triangles without area are left out and counted by `degenerateCount`.
    TriangleMesh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                 std::span<const std::uint8_t> materialOfTriangle = {}, std::span<const Material> materials = {});
    const MeshData& data() const { return *data_; }
    std::span<const Vec3> vertices() const;
    std::span<const Triangle> triangles() const;
    int degenerateCount() const;  ///< triangles that were left out because they have no area

private:
    friend struct ShapeImage;
    explicit TriangleMesh(std::shared_ptr<const MeshData> data) : data_(std::move(data)) {}
    std::shared_ptr<const MeshData> data_;
};

/// A grid of heights over the x–z plane, columns along x, rows along z, its first sample at the origin. Each cell is
/// split along the diagonal from (i, j) to (i+1, j+1). For static and kinematic bodies.
class HeightField {
public:
    /// heights[row * columns + column], m; at least 2 × 2; spacing in m, above zero. A height that is NaN is a hole.
    /// Throws std::invalid_argument otherwise.
    HeightField(int columns, int rows, float spacing, std::span<const float> heights);
    const HeightFieldData& data() const { return *data_; }
    int columns() const;
    int rows() const;
    float spacing() const;
    std::span<const float> heights() const;

private:
    std::shared_ptr<const HeightFieldData> data_;
};

struct CompoundPart;

/// Several shapes fixed to each other. On a body each part is a shape of its own, with its own id and bounds.
struct Compound {
    std::vector<CompoundPart> parts;
};

using Shape = std::variant<Sphere, Capsule, Box, ConvexHull, TriangleMesh, HeightField, Compound>;

struct CompoundPart {
    Shape shape;
    Frame frame{};  ///< of the part in the compound
};

/// Mass, centre of mass and inertia about it.
struct MassProperties {
    float mass = 0;  ///< kg
    Vec3 center{};     ///< m, in the frame of the shape or body
    Mat3 inertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  ///< kg m², about the centre, in the axes of that frame
};

/// Mass properties of a solid of uniform density (kg/m³). Throws std::invalid_argument for height fields and for meshes
/// that are not closed, naming the edge that is open or the triangles that are inverted.
MassProperties massOf(const Shape& shape, float density);
/// The same, from `frame` to the frame around it; and the sum of several in one frame (parallel axes).
MassProperties transformed(const MassProperties& m, const Frame& frame);
MassProperties combined(std::span<const MassProperties> parts);

/// Empty when the shape is usable; otherwise names the number that is wrong and what is allowed.
std::string whyInvalid(const Shape& shape);

}  // namespace ragtop
