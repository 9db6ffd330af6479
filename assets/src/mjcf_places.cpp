#include "mjcf_places.h"

#include <array>

#include "single.h"

namespace ragtop {
namespace {

Vec3 vectorOf(const double* v) { return {single(v[0]), single(v[1]), single(v[2])}; }

Quat turnOf(const MjcfElement& element, const MjcfCompiler& compiler) {
    int given = 0;
    for (const char* each : {"quat", "axisangle", "euler", "xyaxes", "zaxis"})
        if (element.xml().Attribute(each) && ++given > 1) element.failAt(each, "the only rotation");
    std::array<double, 6> v{};
    if (element.numbers("quat", {v.data(), 4}, 4) > 0) {
        const Quat q{single(v[1]), single(v[2]), single(v[3]), single(v[0])};
        if (q == Quat{0, 0, 0, 0}) element.failAt("quat", "a rotation w x y z");
        return normalized(q);
    }
    if (element.numbers("axisangle", {v.data(), 4}, 4) > 0)
        return rotationAbout(vectorOf(v.data()), single(compiler.radians(v[3])));
    if (element.numbers("euler", {v.data(), 3}, 3) > 0) {
        Quat turn;
        for (std::size_t i = 0; i < 3; ++i) {
            const char axis = compiler.eulerOrder[i];
            const char lower = axis < 'a' ? static_cast<char>(axis - 'A' + 'a') : axis;
            const Vec3 about{lower == 'x' ? 1.0f : 0.0f, lower == 'y' ? 1.0f : 0.0f, lower == 'z' ? 1.0f : 0.0f};
            const Quat one = rotationAbout(about, single(compiler.radians(v[i])));
            turn = axis == lower ? turn * one : one * turn;
        }
        return normalized(turn);
    }
    if (element.numbers("xyaxes", {v.data(), 6}, 6) > 0) {
        const Vec3 x = normalized(vectorOf(v.data())), along = vectorOf(v.data() + 3);
        const Vec3 y = along - dot(along, x) * x;
        if (x == Vec3{} || !(length(y) > 0)) element.failAt("xyaxes", "two directions that differ");
        return normalized(rotationFromAxes(x, normalized(y), cross(x, normalized(y))));
    }
    if (element.find("zaxis")) return rotationBetween({0, 0, 1}, directionOf(element, "zaxis", {}));
    return {};
}

}  // namespace

double MjcfCompiler::radians(double angle) const {
    return degrees ? angle * (static_cast<double>(kPi) / 180.0) : angle;
}

void readCompiler(const MjcfElement& element, MjcfCompiler& compiler) {
    const std::string angle = element.text("angle", "degree");
    if (angle != "degree" && angle != "radian") element.failAt("angle", "degree or radian");
    if (element.find("angle")) compiler.degrees = angle == "degree";
    if (element.text("coordinate", "local") != "local") element.failAt("coordinate", "local");
    compiler.eulerOrder = element.text("eulerseq", compiler.eulerOrder);
    if (compiler.eulerOrder.size() != 3 || compiler.eulerOrder.find_first_not_of("xyzXYZ") != std::string::npos)
        element.failAt("eulerseq", "three of x, y, z, X, Y, Z");
    compiler.meshFolder = element.text("meshdir", element.text("assetdir", compiler.meshFolder));
    compiler.massFromShapes = element.truth("inertiafromgeom").value_or(compiler.massFromShapes);
}

Vec3 pointOf(const MjcfElement& element, const char* attribute) {
    std::array<double, 3> v{};
    element.numbers(attribute, v, 3);
    return vectorOf(v.data());
}

Vec3 directionOf(const MjcfElement& element, const char* attribute, const Vec3& otherwise) {
    if (!element.find(attribute)) return otherwise;
    const Vec3 direction = pointOf(element, attribute);
    if (!(length(direction) > 0)) element.failAt(attribute, "a direction");
    return normalized(direction);
}

Frame placeOf(const MjcfElement& element, const MjcfCompiler& compiler) {
    return {pointOf(element, "pos"), turnOf(element, compiler)};
}

}  // namespace ragtop
