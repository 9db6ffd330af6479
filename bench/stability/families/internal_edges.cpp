#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace internal_edges_cases {

constexpr int kCells = 20;

TriangleMesh flatMesh() {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (int row = 0; row <= kCells; ++row)
        for (int column = 0; column <= kCells; ++column)
            vertices.push_back({static_cast<float>(column), 0, static_cast<float>(row)});
    for (std::uint32_t row = 0; row < kCells; ++row)
        for (std::uint32_t column = 0; column < kCells; ++column) {
            const std::uint32_t a = row * (kCells + 1) + column, b = a + 1, c = a + kCells + 1, d = c + 1;
            triangles.push_back({a, c, b});
            triangles.push_back({b, c, d});
        }
    return {vertices, triangles};
}

void addGround(Scene& scene, const std::string& ground, const Material& smooth) {
    if (ground == "mesh") {
        add(scene, fixedBody(flatMesh(), {}, smooth));
        return;
    }
    for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j)
            add(scene, fixedBody(Box{{0.5f, 0.5f, 0.5f}}, {i + 0.5, -0.5, j + 0.5}, smooth));
}

/// Slides over a frictionless floor made of parts, 10 m/s, for 1.3 s after 0.3 s to settle: nothing may hold or lift
/// it.
void slides(Trial& trial, const std::string& ground, const Shape& shape, double height, double heading) {
    constexpr double kSpeed = 10;
    Scene scene;
    const Material smooth = surface(0);
    addGround(scene, ground, smooth);
    BodyDef def = solidBody(shape, {1.3, height, 2.7}, 1, smooth);
    const double c = std::cos(heading), s = std::sin(heading);
    def.linearVelocity = toVec3(DVec3{kSpeed * c, 0, kSpeed * s});
    if (std::holds_alternative<Capsule>(shape)) def.pose.rotation = rotationAbout({0, 0, 1}, kPi / 2);
    const int body = add(scene, def);
    Run run = trial.start(scene);
    run.advance(0.3);
    double lift = 0, slowest = INFINITY;
    run.advance(1.3, [&] {
        const DVec3 v{run.motion(body).v};
        lift = larger(lift, std::abs(v.y));
        slowest = smaller(slowest, v.x * c + v.z * s);
        return true;
    });
    trial.expectAtMost("vertical speed", lift, 0.001, "m/s");
    trial.expectNear("slowest", slowest, kSpeed, 0.001 * kSpeed, "m/s");
}

}  // namespace internal_edges_cases
}  // namespace

Family internalEdges() {
    using namespace internal_edges_cases;
    struct Slider {
        const char* name;
        Shape shape;
        double height;
    };
    const Slider sliders[] = {{"box", Box{{0.25f, 0.25f, 0.25f}}, 0.25},
                              {"ball", Sphere{0.25f}, 0.25},
                              {"capsule", Capsule{0.25f, 0.25f}, 0.25}};
    Family family{"internal_edges", {}};
    for (const char* ground : {"mesh", "tiles"})
        for (const Slider& slider : sliders)
            for (const double degrees : {0.0, 30.0}) {
                const double heading = degrees * std::numbers::pi / 180;
                family.cases.push_back(
                    {fmt::format("{} on {}, {} deg", slider.name, ground, degrees),
                     [=](Trial& trial) { slides(trial, ground, slider.shape, slider.height, heading); }});
            }
    return family;
}

}  // namespace ragtop::stability
