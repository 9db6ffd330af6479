#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "shapes/geometry.h"

namespace ragtop {
namespace {

/// The least float that is not below v, and the greatest not above it; the same bits everywhere without the C library.
/// Half of all numbers need their neighbour, which no processor foresees: hence no branches.
float roundedUp(double v) {
    const float nearest = static_cast<float>(v) + 0.0f;  // no −0
    const auto bits = std::bit_cast<std::int32_t>(nearest);
    const std::int32_t away = 1 | (bits >> 31), below = nearest < v ? -1 : 0;
    return std::bit_cast<float>(bits + (away & below));
}
float roundedDown(double v) { return -roundedUp(-v); }

/// Rows of the rotation matrix.
struct Rows {
    DVec3 x, y, z;

    explicit Rows(const Quat& q) {
        const double qx = q.x, qy = q.y, qz = q.z, qw = q.w;
        x = {1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)};
        y = {2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)};
        z = {2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)};
    }
};

double absDot(const DVec3& a, const Vec3& b) {
    return std::abs(a.x) * std::abs(static_cast<double>(b.x)) + std::abs(a.y) * std::abs(static_cast<double>(b.y)) +
           std::abs(a.z) * std::abs(static_cast<double>(b.z));
}

/// Points turned by `rotate` in single precision, as the narrow phase turns them, are off by a few units in the last
/// place of their distance from the origin.
constexpr double kRotationRounding = 1.0 / (1 << 20);

Bounds outwards(const DVec3& lower, const DVec3& upper, double slack) {
    return {{roundedDown(lower.x - slack), roundedDown(lower.y - slack), roundedDown(lower.z - slack)},
            {roundedUp(upper.x + slack), roundedUp(upper.y + slack), roundedUp(upper.z + slack)}};
}

Bounds outwards(const DVec3& center, const DVec3& half) {
    const double slack = kRotationRounding * std::max({half.x, half.y, half.z});
    return outwards(center - half, center + half, slack);
}

/// Of a box in its shape's frame; conservative when turned.
Bounds boundsOfBox(const Bounds& box, const DVec3& position, const Rows& rows) {
    const DVec3 middle = 0.5 * (DVec3(box.lower) + DVec3(box.upper));
    const DVec3 half = 0.5 * (DVec3(box.upper) - DVec3(box.lower));
    const auto reach = [&](const DVec3& r) {
        return std::abs(r.x) * half.x + std::abs(r.y) * half.y + std::abs(r.z) * half.z;
    };
    const auto at = [&](const DVec3& r) { return r.x * middle.x + r.y * middle.y + r.z * middle.z; };
    const DVec3 center = position + DVec3(at(rows.x), at(rows.y), at(rows.z));
    const DVec3 extent(reach(rows.x), reach(rows.y), reach(rows.z));
    const double size =
        std::max({std::abs(middle.x) + half.x, std::abs(middle.y) + half.y, std::abs(middle.z) + half.z});
    return outwards(center - extent, center + extent, 2 * kRotationRounding * size);
}

Bounds localBounds(const HeightFieldData& field) {
    return {{0, field.lowest, 0},
            {static_cast<float>(field.columns - 1) * field.spacing, field.highest,
             static_cast<float>(field.rows - 1) * field.spacing}};
}

typedef double TwoDoubles __attribute__((vector_size(16)));
TwoDoubles lesser(TwoDoubles a, TwoDoubles b) { return a < b ? a : b; }
TwoDoubles greater(TwoDoubles a, TwoDoubles b) { return a > b ? a : b; }
double least(TwoDoubles v) { return std::min(v[0], v[1]); }
double most(TwoDoubles v) { return std::max(v[0], v[1]); }

/// Visits vertices two at a time, by coordinate; of an odd number the last one twice.
template <class Visit>
void forTwo(const std::vector<Vec3>& vertices, Visit&& visit) {
    for (std::size_t i = 0; i < vertices.size(); i += 2) {
        const Vec3 &a = vertices[i], &b = vertices[i + 1 < vertices.size() ? i + 1 : i];
        visit(TwoDoubles{a.x, b.x}, TwoDoubles{a.y, b.y}, TwoDoubles{a.z, b.z});
    }
}

struct Extent {
    DVec3 lower, upper;
};

/// Of turned points about the origin.
Extent extentOf(const std::vector<Vec3>& vertices, const Rows& rows) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr TwoDoubles kAbove{kInfinity, kInfinity}, kBelow{-kInfinity, -kInfinity};
    TwoDoubles lower[3] = {kAbove, kAbove, kAbove}, upper[3] = {kBelow, kBelow, kBelow};
    const DVec3* const of[3] = {&rows.x, &rows.y, &rows.z};
    forTwo(vertices, [&](TwoDoubles x, TwoDoubles y, TwoDoubles z) {
        for (int k = 0; k < 3; ++k) {
            const TwoDoubles along = of[k]->x * x + of[k]->y * y + of[k]->z * z;
            lower[k] = lesser(along, lower[k]);
            upper[k] = greater(along, upper[k]);
        }
    });
    return {{least(lower[0]), least(lower[1]), least(lower[2])}, {most(upper[0]), most(upper[1]), most(upper[2])}};
}

struct BoundsOf {
    DVec3 position;
    const Quat& rotation;

    Bounds operator()(const Sphere& s) const {
        const double r = s.radius;
        return outwards(position - DVec3(r, r, r), position + DVec3(r, r, r), 0);
    }
    Bounds operator()(const Capsule& s) const {
        const Rows rows(rotation);
        const double h = s.halfHeight, r = s.radius;
        return outwards(position, {std::abs(rows.x.y) * h + r, std::abs(rows.y.y) * h + r, std::abs(rows.z.y) * h + r});
    }
    Bounds operator()(const Box& s) const {
        const Rows rows(rotation);
        return outwards(position,
                        {absDot(rows.x, s.halfExtents), absDot(rows.y, s.halfExtents), absDot(rows.z, s.halfExtents)});
    }
    Bounds operator()(const ConvexHull& s) const {
        const auto [lower, upper] = extentOf(s.data().vertices, Rows(rotation));
        const double size = std::max({-lower.x, -lower.y, -lower.z, upper.x, upper.y, upper.z});
        return outwards(position + lower, position + upper, kRotationRounding * size);
    }
    Bounds operator()(const TriangleMesh& s) const { return boundsOfBox(s.data().bounds, position, Rows(rotation)); }
    Bounds operator()(const HeightField& s) const {
        return boundsOfBox(localBounds(s.data()), position, Rows(rotation));
    }
    Bounds operator()(const Compound&) const {
        throw std::invalid_argument("shape is a Compound, which has no bounds of its own; must be one of its parts");
    }
};

double distanceOf(const Vec3& a, const Vec3& b) {
    const DVec3 d = DVec3(a) - DVec3(b);
    return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

struct RadiusAbout {
    Vec3 center;

    double operator()(const Sphere& s) const { return distanceOf(center, {}) + s.radius; }
    double operator()(const Capsule& s) const {
        return std::max(distanceOf(center, {0, s.halfHeight, 0}), distanceOf(center, {0, -s.halfHeight, 0})) + s.radius;
    }
    double operator()(const Box& s) const {
        const Vec3& h = s.halfExtents;
        return distanceOf({center.x < 0 ? h.x : -h.x, center.y < 0 ? h.y : -h.y, center.z < 0 ? h.z : -h.z}, center);
    }
    double operator()(const ConvexHull& s) const {
        const DVec3 from(center);
        TwoDoubles square{};
        forTwo(s.data().vertices, [&](TwoDoubles x, TwoDoubles y, TwoDoubles z) {
            const TwoDoubles dx = x - from.x, dy = y - from.y, dz = z - from.z;
            square = greater(dx * dx + dy * dy + dz * dz, square);
        });
        return std::sqrt(most(square));
    }
    double operator()(const TriangleMesh& s) const {
        double radius = 0;
        const MeshData& mesh = s.data();
        for (const Triangle& t : mesh.triangles) {
            for (const std::uint32_t i : {t.a, t.b, t.c}) {
                radius = std::max(radius, distanceOf(mesh.vertices[i], center));
            }
        }
        return radius;
    }
    double operator()(const HeightField& s) const {
        double radius = 0;
        forEachTriangle(s.data(), localBounds(s.data()), [&](const TriangleView& t) {
            radius = std::max({radius, distanceOf(t.a, center), distanceOf(t.b, center), distanceOf(t.c, center)});
            return true;
        });
        return radius;
    }
    double operator()(const Compound& s) const {
        double radius = 0;
        for (const CompoundPart& part : s.parts) {
            radius = std::max(radius,
                              static_cast<double>(radiusAbout(part.shape, inverseTransformPoint(part.frame, center))));
        }
        return radius;
    }
};

struct SizeOf {
    float operator()(const Sphere& s) const { return s.radius; }
    float operator()(const Capsule& s) const { return s.radius; }
    float operator()(const Box& s) const { return std::min({s.halfExtents.x, s.halfExtents.y, s.halfExtents.z}); }
    float operator()(const ConvexHull& s) const { return s.data().innerRadius; }
    float operator()(const TriangleMesh&) const { return std::numeric_limits<float>::infinity(); }
    float operator()(const HeightField&) const { return std::numeric_limits<float>::infinity(); }
    float operator()(const Compound& s) const {
        float size = std::numeric_limits<float>::infinity();
        for (const CompoundPart& part : s.parts) size = std::min(size, sizeOf(part.shape));
        return size;
    }
};

struct ViewOf {
    ConvexView operator()(const Sphere& s) const { return {ConvexKind::sphere, s.radius, {}, nullptr}; }
    ConvexView operator()(const Capsule& s) const {
        return {ConvexKind::capsule, s.radius, {0, s.halfHeight, 0}, nullptr};
    }
    ConvexView operator()(const Box& s) const { return {ConvexKind::box, 0, s.halfExtents, nullptr}; }
    ConvexView operator()(const ConvexHull& s) const { return {ConvexKind::hull, 0, {}, &s.data()}; }
    template <class Other>
    ConvexView operator()(const Other&) const {
        throw std::invalid_argument("shape is a mesh, height field or compound; must be convex");
    }
};

}  // namespace

ConvexView convexView(const Shape& shape) { return std::visit(ViewOf{}, shape); }
float sizeOf(const Shape& shape) { return std::visit(SizeOf{}, shape); }
float radiusAbout(const Shape& shape, const Vec3& center) { return roundedUp(std::visit(RadiusAbout{center}, shape)); }
Bounds boundsOfPath(const DVec3& from, const DVec3& to, float radius) {
    const DVec3 lower(std::min(from.x, to.x), std::min(from.y, to.y), std::min(from.z, to.z));
    const DVec3 upper(std::max(from.x, to.x), std::max(from.y, to.y), std::max(from.z, to.z));
    return outwards(lower, upper, (1 + kRotationRounding) * radius);
}

Bounds boundsOf(const Shape& shape, const Pose& pose) {
    return std::visit(BoundsOf{pose.position, pose.rotation}, shape);
}
Bounds boundsOf(const Shape& shape, const Frame& frame) {
    return std::visit(BoundsOf{DVec3(frame.position), frame.rotation}, shape);
}

Vec3 supportOfCore(const ConvexView& shape, const Vec3& direction) {
    switch (shape.kind) {
        case ConvexKind::sphere:
            return {};
        case ConvexKind::capsule:
            return direction.y < 0 ? -shape.halfExtents : shape.halfExtents;
        case ConvexKind::box: {
            const Vec3& h = shape.halfExtents;
            return {direction.x < 0 ? -h.x : h.x, direction.y < 0 ? -h.y : h.y, direction.z < 0 ? -h.z : h.z};
        }
        case ConvexKind::hull:
            break;
    }
    const std::vector<Vec3>& vertices = shape.hull->vertices;
    std::size_t best = 0;
    float farthest = dot(vertices[0], direction);
    for (std::size_t i = 1; i < vertices.size(); ++i) {
        const float along = dot(vertices[i], direction);
        if (along > farthest) {
            farthest = along;
            best = i;
        }
    }
    return vertices[best];
}

}  // namespace ragtop
