#include <numbers>
#include <stdexcept>
#include <vector>

#include "base/double_vectors.h"
#include "shapes/solid_mass.h"

namespace ragtop {
namespace {

/// Adds mass · (d² E − d dᵀ), the inertia of a point mass at d.
void addPoint(SolidMass& m, double mass, const DVec3& d) {
    m.xx += mass * (d.y * d.y + d.z * d.z);
    m.yy += mass * (d.x * d.x + d.z * d.z);
    m.zz += mass * (d.x * d.x + d.y * d.y);
    m.xy -= mass * d.x * d.y;
    m.xz -= mass * d.x * d.z;
    m.yz -= mass * d.y * d.z;
}

MassProperties rounded(const SolidMass& m) {
    const auto f = [](double v) { return static_cast<float>(v); };
    return {f(m.mass),
            toVec3(m.center),
            {{f(m.xx), f(m.xy), f(m.xz)}, {f(m.xy), f(m.yy), f(m.yz)}, {f(m.xz), f(m.yz), f(m.zz)}}};
}

SolidMass widened(const MassProperties& m) {
    return {m.mass,         DVec3(m.center), m.inertia.cx.x, m.inertia.cy.x,
            m.inertia.cz.x, m.inertia.cy.y,  m.inertia.cz.y, m.inertia.cz.z};
}

/// I' = R I Rᵀ with R from the quaternion made unit in double.
SolidMass moved(const SolidMass& m, const Frame& frame) {
    const double l = std::sqrt(static_cast<double>(frame.rotation.x) * frame.rotation.x +
                               static_cast<double>(frame.rotation.y) * frame.rotation.y +
                               static_cast<double>(frame.rotation.z) * frame.rotation.z +
                               static_cast<double>(frame.rotation.w) * frame.rotation.w);
    const double x = frame.rotation.x / l, y = frame.rotation.y / l, z = frame.rotation.z / l, w = frame.rotation.w / l;
    const DVec3 rows[3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    const auto times = [&m](const DVec3& v) {
        return DVec3(m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
                     m.xz * v.x + m.yz * v.y + m.zz * v.z);
    };
    const DVec3 a = times(rows[0]), b = times(rows[1]), c = times(rows[2]);
    SolidMass result;
    result.mass = m.mass;
    result.center =
        DVec3(frame.position) + DVec3(dot(rows[0], m.center), dot(rows[1], m.center), dot(rows[2], m.center));
    result.xx = dot(rows[0], a);
    result.xy = dot(rows[0], b);
    result.xz = dot(rows[0], c);
    result.yy = dot(rows[1], b);
    result.yz = dot(rows[1], c);
    result.zz = dot(rows[2], c);
    return result;
}

/// Parallel axes: I = Σ Iᵢ + mᵢ (dᵢ² E − dᵢ dᵢᵀ), dᵢ = cᵢ − c.
SolidMass sum(std::span<const SolidMass> parts) {
    SolidMass total;
    for (const SolidMass& part : parts) {
        total.mass += part.mass;
        total.center = total.center + part.mass * part.center;
    }
    if (!(total.mass > 0)) return {};
    total.center = (1 / total.mass) * total.center;
    for (const SolidMass& part : parts) {
        total.xx += part.xx;
        total.xy += part.xy;
        total.xz += part.xz;
        total.yy += part.yy;
        total.yz += part.yz;
        total.zz += part.zz;
        addPoint(total, part.mass, part.center - total.center);
    }
    return total;
}

SolidMass diagonal(double mass, double xx, double yy, double zz) { return {mass, {}, xx, 0, 0, yy, 0, zz}; }

struct SolidOf {
    double density;

    SolidMass operator()(const Sphere& s) const {
        const double r = s.radius;
        const double mass = density * (4.0 / 3.0) * std::numbers::pi * r * r * r;
        const double i = 0.4 * mass * r * r;
        return diagonal(mass, i, i, i);
    }

    /// A cylinder and two half balls, whose centres are 3r/8 from their flat sides.
    SolidMass operator()(const Capsule& s) const {
        const double r = s.radius, h = s.halfHeight;
        const double tube = density * std::numbers::pi * r * r * 2 * h;
        const double caps = density * (4.0 / 3.0) * std::numbers::pi * r * r * r;
        const double along = 0.5 * tube * r * r + 0.4 * caps * r * r;
        const double across = tube * (0.25 * r * r + h * h / 3) + caps * (0.4 * r * r + h * h + 0.75 * r * h);
        return diagonal(tube + caps, across, along, across);
    }

    SolidMass operator()(const Box& s) const {
        const double x = s.halfExtents.x, y = s.halfExtents.y, z = s.halfExtents.z;
        const double mass = density * 8 * x * y * z;
        return diagonal(mass, mass * (y * y + z * z) / 3, mass * (x * x + z * z) / 3, mass * (x * x + y * y) / 3);
    }

    SolidMass operator()(const ConvexHull& s) const { return massOfHull(s.data(), density); }

    SolidMass operator()(const TriangleMesh& s) const {
        if (const std::string& why = s.data().whyNotSolid; !why.empty())
            throw std::invalid_argument("shape is a TriangleMesh that " + why + ", and so has no mass");
        return massOfMesh(s.data(), density);
    }
    SolidMass operator()(const HeightField&) const {
        throw std::invalid_argument("shape is a HeightField, which has no mass; must be a solid");
    }

    SolidMass operator()(const Compound& s) const {
        std::vector<SolidMass> parts;
        parts.reserve(s.parts.size());
        for (const CompoundPart& part : s.parts) parts.push_back(moved(std::visit(*this, part.shape), part.frame));
        return sum(parts);
    }
};

}  // namespace

namespace {

/// Sums tetrahedra from a point to triangles [Eberly, Polyhedral Mass Properties, 2002]. For one with edges a, b, c
/// from that point, V = a · (b × c) / 6, ∫x dV = V (a + b + c) / 4 and ∫x xᵀ dV = V/20 (a aᵀ + b bᵀ + c cᵀ + s sᵀ), s =
/// a + b + c.
struct Tetrahedra {
    DVec3 origin;
    double density;
    SolidMass m;
    DVec3 moment;

    void add(const DVec3& a, const DVec3& b, const DVec3& c) {
        const DVec3 s = a + b + c;
        const double mass = density * dot(a, cross(b, c)) / 6;
        m.mass += mass;
        moment = moment + (0.25 * mass) * s;
        for (const DVec3& point : {a, b, c, s}) addPoint(m, mass / 20, point);
    }
    SolidMass whole() {
        const DVec3 offset = (1 / m.mass) * moment;
        addPoint(m, -m.mass, offset);
        m.center = origin + offset;
        return m;
    }
};

}  // namespace

SolidMass massOfHull(const HullData& hull, double density) {
    DVec3 origin;
    for (const Vec3& v : hull.vertices) origin = origin + DVec3(v);
    origin = (1.0 / static_cast<double>(hull.vertices.size())) * origin;
    Tetrahedra sum{origin, density, {}, {}};
    for (const HullData::Face& face : hull.faces) {
        const auto corner = [&](int i) {
            return DVec3(hull.vertices[hull.faceIndices[static_cast<std::size_t>(face.firstIndex + i)]]) - origin;
        };
        for (int i = 2; i < face.count; ++i) sum.add(corner(0), corner(i - 1), corner(i));
    }
    return sum.m.mass > 0 ? sum.whole() : SolidMass{};
}

SolidMass massOfMesh(const MeshData& mesh, double density) {
    const DVec3 origin = 0.5 * (DVec3(mesh.bounds.lower) + DVec3(mesh.bounds.upper));
    Tetrahedra sum{origin, density, {}, {}};
    for (const Triangle& t : mesh.sourceTriangles) {
        const auto corner = [&](std::uint32_t i) { return DVec3(mesh.vertices[i]) - origin; };
        sum.add(corner(t.a), corner(t.b), corner(t.c));
    }
    return sum.m.mass != 0 ? sum.whole() : SolidMass{};
}

MassProperties massOf(const Shape& shape, float density) { return rounded(std::visit(SolidOf{density}, shape)); }

MassProperties transformed(const MassProperties& m, const Frame& frame) { return rounded(moved(widened(m), frame)); }

MassProperties combined(std::span<const MassProperties> parts) {
    std::vector<SolidMass> wide;
    wide.reserve(parts.size());
    for (const MassProperties& part : parts) wide.push_back(widened(part));
    return rounded(sum(wide));
}

}  // namespace ragtop
