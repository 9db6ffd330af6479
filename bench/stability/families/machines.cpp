#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace machines_cases {

constexpr float kFriction = 0.5f;

/// A box put on a belt of 2 m/s slips u/(μ g) long, u²/(2 μ g) far, and nowhere to the side.
void conveyor(Trial& trial, bool belt, double heading) {
    constexpr double kSpeed = 2, kSeconds = 2;
    Scene scene;
    const Vec3 u = toVec3(kSpeed * DVec3{std::cos(heading), 0, std::sin(heading)});
    BodyDef floor = fixedBody(Box{{50, 1, 50}}, {0, -1, 0}, surface(kFriction));
    if (belt) {
        floor.shapes[0].material.surfaceVelocity = u;
    } else {
        floor.type = BodyType::kinematic;
        floor.linearVelocity = u;
    }
    add(scene, floor);
    const int box = add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, surface(kFriction)));
    Run run = trial.start(scene);
    run.advance(kSeconds);
    const DVec3 end = run.position(box);
    const double forward = end.x * std::cos(heading) + end.z * std::sin(heading);
    const double exact = kSpeed * kSpeed / (2 * static_cast<double>(kFriction) * kGravity);
    trial.expectNear("slip", kSpeed * run.time() - forward, exact, 0.005 * exact, "m");
    trial.expectAtMost("sideways", end.z * std::cos(heading) - end.x * std::sin(heading), 0.001 * exact, "m");
}

constexpr double kDrum = 2;  ///< m, inner radius

/// A drum open at both ends, from inside, as a mesh of flat strips one degree wide.
TriangleMesh drum(double halfWidth) {
    constexpr std::uint32_t kStrips = 360;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i < kStrips; ++i) {
        const double angle = 2 * std::numbers::pi * i / kStrips;
        for (const double z : {-halfWidth, halfWidth})
            vertices.push_back(toVec3(DVec3{kDrum * std::sin(angle), -kDrum * std::cos(angle), z}));
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kStrips);
        triangles.push_back({a, a + 1, b});
        triangles.push_back({b, a + 1, b + 1});
    }
    return {vertices, triangles};
}

int addDrum(Scene& scene, float speed, const Material& material) {
    BodyDef def = fixedBody(drum(1), {}, material);
    def.type = BodyType::kinematic;
    def.angularVelocity = {0, 0, speed};
    return add(scene, def);
}

/// A block in a turning drum slides where friction holds it. It touches along two edges, the chord's half angle β from
/// its middle, and its centre of mass is d from the axis: forces along and across the radius and moments about the
/// axis give tan φ = μ (R/d)/(cos β − μ² (R/d − cos β)), which is μ for a small block. It begins there: dry friction
/// would never damp its swinging about that place.
void blockInDrum(Trial& trial) {
    constexpr double kHalf = 0.15, kMu = 0.4;
    const Material material = surface(static_cast<float>(kMu));
    Scene scene;
    addDrum(scene, 1, material);
    const double cosBeta = std::sqrt(1 - kHalf * kHalf / (kDrum * kDrum)), d = kDrum * cosBeta - kHalf;
    const double lever = kDrum / d;
    const double exact = std::atan(kMu * lever / (cosBeta - kMu * kMu * (lever - cosBeta)));
    const float half = static_cast<float>(kHalf);
    const DVec3 place = d * DVec3{std::sin(exact), -std::cos(exact), 0};
    BodyDef def = solidBody(Box{{half, half, half}}, place, 1, material);
    def.pose.rotation = rotationAbout({0, 0, 1}, static_cast<float>(exact));
    const int block = add(scene, def);
    Run run = trial.start(scene);
    double sum = 0;
    int samples = 0;
    run.advance(10, [&] {
        const DVec3 at = run.position(block);
        sum += std::atan2(at.x, -at.y);
        ++samples;
        return true;
    });
    trial.expectNear("angle of the block", sum / samples, exact, 0.02 * exact, "rad");
}

/// A ball that already turns with the drum idles at the bottom.
void ballInDrum(Trial& trial) {
    constexpr float kRadius = 0.25f, kSpeed = 1;
    const Material material = surface(0.5f);
    Scene scene;
    addDrum(scene, kSpeed, material);
    BodyDef def = solidBody(Sphere{kRadius}, {0, static_cast<double>(kRadius) - kDrum, 0}, 1, material);
    def.angularVelocity = {0, 0, kSpeed * static_cast<float>(kDrum) / kRadius};
    const int ball = add(scene, def);
    Run run = trial.start(scene);
    double farthest = 0;
    run.advance(10, [&] {
        const DVec3 at = run.position(ball);
        farthest = larger(farthest, std::abs(std::atan2(at.x, -at.y)));
        return true;
    });
    // A strip of the drum is a degree wide.
    trial.expectAtMost("leaves the bottom", farthest, std::numbers::pi / 180, "rad");
}

/// Sets the friction of sliding as a share of that of rest.
void setSliding(Material& material, float share) {
    const auto set = [share](auto& m) {
        if constexpr (requires { m.slidingShare; })
            m.slidingShare = share;
        else
            throw Unsupported("one coefficient for rest and sliding");
    };
    set(material);
}

/// A weight on a slow belt, held by a spring. It rides until the spring pulls with μ_s m g and slips back until it has
/// the belt's speed u again: through 2 R, R² = ((μ_s − μ_k) m g/k)² + (u/ω)².
void stickSlip(Trial& trial) {
    constexpr double kStiffness = 100, kMass = 25, kAtRest = 0.6, kSliding = 0.4, kBelt = 0.1, kRope = 20;
    Scene scene;
    Material material = surface(static_cast<float>(kAtRest));
    setSliding(material, static_cast<float>(kSliding / kAtRest));
    BodyDef floor = fixedBody(Box{{100, 1, 5}}, {0, -1, 0}, material);
    floor.shapes[0].material.surfaceVelocity = {static_cast<float>(kBelt), 0, 0};
    add(scene, floor);
    const int box = add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, static_cast<float>(kMass), material));
    DistanceDef& spring = addDistance(scene, kWorld, box, {-kRope, 0.5, 0}, {0, 0.5, 0});
    spring.spring = Spring{static_cast<float>(kStiffness), 0};
    spring.rest = static_cast<float>(kRope);
    Run run = trial.start(scene);
    // Into the first slip, and then through two whole strokes.
    const double reach = kAtRest * kMass * kGravity / kStiffness;
    run.advance(reach / kBelt + 3);
    double lowest = INFINITY, highest = -INFINITY;
    run.advance(25, [&] {
        lowest = smaller(lowest, run.position(box).x);
        highest = larger(highest, run.position(box).x);
        return true;
    });
    const double stroke = (kAtRest - kSliding) * kMass * kGravity / kStiffness;
    const double exact = 2 * std::hypot(stroke, kBelt / std::sqrt(kStiffness / kMass));
    trial.expectNear("stroke", highest - lowest, exact, 0.02 * exact, "m");
}

}  // namespace machines_cases
}  // namespace

Family machines() {
    using namespace machines_cases;
    Family family{"machines", {}};
    for (const double degrees : {0.0, 30.0})
        for (const bool belt : {true, false})
            family.cases.push_back({fmt::format("{}, {} deg", belt ? "conveyor belt" : "moving floor", degrees),
                                    [=](Trial& trial) { conveyor(trial, belt, degrees * std::numbers::pi / 180); }});
    family.cases.push_back({"stick-slip", stickSlip, Kind::oneStep});
    family.cases.push_back({"block in a drum", blockInDrum});
    family.cases.push_back({"ball in a drum", ballInDrum});
    return family;
}

}  // namespace ragtop::stability
