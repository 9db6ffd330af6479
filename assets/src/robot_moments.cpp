#include "robot_moments.h"

#include <algorithm>
#include <cmath>

#include "import_text.h"

namespace ragtop {
namespace {

/// Principal minors of a symmetric matrix over its trace, of two and of three rows: least of those, and that.
struct Minors {
    double two, three;
};
Minors minorsOf(const Moments& m) {
    const double trace = m[0] + m[1] + m[2], over = trace > 0 ? 1 / trace : 0;
    const double xx = over * m[0], yy = over * m[1], zz = over * m[2], xy = over * m[3], xz = over * m[4],
                 yz = over * m[5];
    return {std::min({xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz}),
            xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)};
}

constexpr double kDigits = 1e-5;  // of the trace, by which files round

}  // namespace

std::string whyNoInertia(const Moments& m) {
    const double products = std::max({std::abs(m[3]), std::abs(m[4]), std::abs(m[5])});
    const bool none = m[0] + m[1] + m[2] == 0;
    const auto [two, three] = minorsOf(m);
    if (none ? products == 0 : two >= -kDigits && three >= -kDigits) return {};
    std::string said;
    for (std::size_t i = 0; const char* name : {"xx", "yy", "zz", "xy", "xz", "yz"})
        said += (i > 0 ? std::string(", ") : std::string()) + name + " " + shortNumber(m[i]), ++i;
    return "has the moments " + said + ", which are below 0 about some axis, must be at least 0 about all";
}

bool isThin(const MassProperties& mass) {
    constexpr double kLeast = 1e-12;  // of the cube of the trace, far above the rounding of single precision
    const Mat3& i = mass.inertia;
    const Moments m{i.cx.x, i.cy.y, i.cz.z, i.cy.x, i.cz.x, i.cz.y};
    const auto [two, three] = minorsOf(m);
    return !(std::min({m[0], m[1], m[2]}) > 0 && two > 0 && three > kLeast);
}

Thickened thickened(const MassProperties& mass, const std::vector<ShapeDef>& shapes) {
    constexpr float kMore = 1e-3f, kWater = 1000;
    Thickened thick{mass, "a little thicker"};
    Mat3& i = thick.mass.inertia;
    const auto add = [&](float each) { i.cx.x += each, i.cy.y += each, i.cz.z += each; };
    if (const float largest = std::max({i.cx.x, i.cy.y, i.cz.z}); largest > 0) {
        add(kMore * largest);
    } else if (shapes.empty()) {
        const float radius = std::cbrt(3 * mass.mass / (4 * kPi * kWater));
        add(0.4f * mass.mass * radius * radius);
        thick.as = "a ball of water";
    } else {
        std::vector<MassProperties> parts;
        for (const ShapeDef& shape : shapes) parts.push_back(transformed(massOf(shape.geometry, kWater), shape.frame));
        const MassProperties whole = combined(parts);
        const float share = mass.mass / whole.mass;
        i = {share * whole.inertia.cx, share * whole.inertia.cy, share * whole.inertia.cz};
        thick.as = "its shapes";
    }
    return thick;
}

}  // namespace ragtop
