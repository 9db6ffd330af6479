#include "mjcf_geoms.h"

#include <array>
#include <map>

#include "single.h"

namespace ragtop {
namespace {

constexpr double kDensity = 1000;  // kg/m³, of geoms that do not say
constexpr double kTurn = 3.14159265358979323846;

const std::map<std::string, RobotShapeKind> kKinds{
    {"sphere", RobotShapeKind::sphere},     {"capsule", RobotShapeKind::capsule},     {"box", RobotShapeKind::box},
    {"cylinder", RobotShapeKind::cylinder}, {"ellipsoid", RobotShapeKind::ellipsoid}, {"plane", RobotShapeKind::plane},
    {"mesh", RobotShapeKind::mesh},
};

/// Numbers of `size` that a kind needs; with `fromto` one less, the length.
int sizesOf(RobotShapeKind kind) {
    switch (kind) {
        case RobotShapeKind::sphere:
            return 1;
        case RobotShapeKind::capsule:
        case RobotShapeKind::cylinder:
            return 2;
        case RobotShapeKind::mesh:
            return 0;
        default:
            return 3;
    }
}

/// Volume, and moments about the axes over the mass; z is the axis of what is round.
struct Solid {
    double volume, x, y, z;
};

Solid solidOf(RobotShapeKind kind, const std::array<double, 3>& size) {
    const auto [a, b, c] = size;
    switch (kind) {
        case RobotShapeKind::sphere:
            return {4.0 / 3 * kTurn * a * a * a, 0.4 * a * a, 0.4 * a * a, 0.4 * a * a};
        case RobotShapeKind::box:
            return {8 * a * b * c, (b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3};
        case RobotShapeKind::ellipsoid:
            return {4.0 / 3 * kTurn * a * b * c, (b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5};
        case RobotShapeKind::cylinder: {
            const double across = (3 * a * a + 4 * b * b) / 12;
            return {2 * kTurn * a * a * b, across, across, a * a / 2};
        }
        case RobotShapeKind::capsule: {
            // A tube and two half balls, whose centres are 3/8 of the radius from their flat sides.
            const double tube = 2 * kTurn * a * a * b, balls = 4.0 / 3 * kTurn * a * a * a, volume = tube + balls;
            const double along = (tube * a * a / 2 + balls * 0.4 * a * a) / volume;
            const double across =
                (tube * (3 * a * a + 4 * b * b) / 12 + balls * (0.4 * a * a + b * b + 0.75 * a * b)) / volume;
            return {volume, across, across, along};
        }
        default:
            return {0, 0, 0, 0};
    }
}

/// Half the length from `fromto`, and the frame in its middle with z along it.
double halfLengthOf(const MjcfElement& element, Frame& place) {
    std::array<double, 6> ends{};
    element.numbers("fromto", ends, 6);
    const Vec3 from{single(ends[0]), single(ends[1]), single(ends[2])};
    const Vec3 to{single(ends[3]), single(ends[4]), single(ends[5])};
    if (!(length(to - from) > 0)) element.failAt("fromto", "two points that differ");
    place = {0.5f * (from + to), rotationBetween({0, 0, 1}, normalized(to - from))};
    return 0.5 * static_cast<double>(length(to - from));
}

std::array<double, 3> sizeOf(const MjcfElement& element, RobotShapeKind kind, Frame& place) {
    std::array<double, 3> size{};
    const bool long_ = element.find("fromto");
    if (long_ && (kind == RobotShapeKind::sphere || kind == RobotShapeKind::plane || kind == RobotShapeKind::mesh))
        element.failAt("fromto", "of a capsule, cylinder, box or ellipsoid");
    const int needed = sizesOf(kind) - (long_ ? 1 : 0);
    const int count = element.numbers("size", size, kind == RobotShapeKind::mesh ? 0 : std::min(needed, 1));
    if (kind != RobotShapeKind::plane && kind != RobotShapeKind::mesh && count < (long_ ? 1 : needed))
        element.failAt("size", std::to_string(long_ ? 1 : needed) + " numbers or more");
    if (long_) {
        const double half = halfLengthOf(element, place);
        const bool round = kind == RobotShapeKind::capsule || kind == RobotShapeKind::cylinder;
        if (!round && count < 2) size[1] = size[0];
        size[round ? 1 : 2] = half;
    }
    const int used = sizesOf(kind);
    for (int i = 0; i < used && kind != RobotShapeKind::plane; ++i)
        if (!(size[static_cast<std::size_t>(i)] > 0)) element.failAt("size", "above 0 m");
    return size;
}

}  // namespace

MjcfGeom readGeom(const MjcfElement& element, const MjcfCompiler& compiler) {
    const auto kind = kKinds.find(element.text("type", "sphere"));
    if (kind == kKinds.end()) element.failAt("type", "sphere, capsule, box, cylinder, ellipsoid, plane or mesh");
    Frame place = placeOf(element, compiler);
    const std::array<double, 3> size = sizeOf(element, kind->second, place);
    MjcfGeom geom;
    geom.isMesh = kind->second == RobotShapeKind::mesh;
    const Solid solid = solidOf(kind->second, size);
    if (solid.volume > 0) {
        const double density = element.number("density", kDensity);
        const double mass = element.number("mass", density * solid.volume);
        if (density < 0) element.failAt("density", "at least 0 kg/m³");
        if (mass < 0) element.failAt("mass", "at least 0 kg");
        const MassProperties own{
            single(mass),
            {},
            {{single(mass * solid.x), 0, 0}, {0, single(mass * solid.y), 0}, {0, 0, single(mass * solid.z)}}};
        if (mass > 0) geom.mass = transformed(own, place);
    }
    // What collides with nothing is there for the looks, and for its mass.
    if (element.number("contype", 1) == 0 && element.number("conaffinity", 1) == 0) return geom;
    ImportedRobotShape shape;
    shape.kind = kind->second;
    shape.origin = place;
    shape.radius = single(size[0]);
    shape.length = single(2 * size[1]);
    const float whole = kind->second == RobotShapeKind::box ? 2.0f : 1.0f;
    shape.size = whole * Vec3{single(size[0]), single(size[1]), single(size[2])};
    std::array<double, 3> friction{1, 0, 0};
    element.numbers("friction", friction, 1);
    if (friction[0] < 0) element.failAt("friction", "at least 0");
    shape.friction = single(friction[0]);
    if (geom.isMesh) {
        shape.size = {1, 1, 1};
        shape.mesh = element.text("mesh");
    }
    geom.shape = shape;
    return geom;
}

}  // namespace ragtop
