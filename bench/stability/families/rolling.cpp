#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

constexpr float kRadius = 0.25f;

/// A ball thrown without spin slides until it rolls, at 2 v/(7 μ g), with 5/7 of its speed.
void slidesThenRolls(Trial& trial) {
    constexpr double kSpeed = 5, kFriction = 0.1;
    Scene scene;
    const Material material = surface(static_cast<float>(kFriction));
    addFloor(scene, material);
    BodyDef ball = solidBody(Sphere{kRadius}, {0, 0.25, 0}, 1, material);
    ball.linearVelocity = {static_cast<float>(kSpeed), 0, 0};
    const int body = add(scene, ball);
    Run run = trial.start(scene);
    const auto slip = [&] {
        const BodyMotion m = run.motion(body);
        return static_cast<double>(m.v.x + kRadius * m.w.z);
    };
    // The slip falls linearly: the last two steps that end well above rolling tell when it is over.
    double before = kSpeed, last = kSpeed, lastTime = 0;
    const double time = 2 * kSpeed / (7 * kFriction * kGravity);
    run.advance(2 * time, [&] {
        if (slip() > 0.02 * kSpeed) {
            before = last;
            last = slip();
            lastTime = run.time();
        }
        return true;
    });
    trial.expectNear("speed", static_cast<double>(run.motion(body).v.x), kSpeed * 5 / 7, 0.005 * kSpeed * 5 / 7, "m/s");
    trial.expectNear("time", lastTime + last * trial.dt() / (before - last), time, 0.005 * time, "s");
}

/// Something round on a slope of tan θ = 1/2 with a moment of inertia I = k m r²: a = g sin θ/(1 + k) while it rolls,
/// which takes μ ≥ k/(1 + k) tan θ, and g (sin θ − μ cos θ) beyond.
void ramp(Trial& trial, double shape, double friction) {
    const double theta = std::atan(0.5);
    Scene scene;
    scene.settings.gravity = slopeGravity(theta, 0);
    const Material material = surface(static_cast<float>(friction));
    addFloor(scene, material);
    const float moment = static_cast<float>(shape) * kRadius * kRadius;
    const int body = add(scene, bodyWithMass(Sphere{kRadius}, {0, 0.25, 0}, 1, {moment, moment, moment}, material));
    Run run = trial.start(scene);
    const auto placeAfter = [&](double seconds) {
        run.advance(seconds);
        return run.position(body).x;
    };
    const double x0 = placeAfter(1), x1 = placeAfter(2), x2 = placeAfter(2);
    const double rolls = kGravity * std::sin(theta) / (1 + shape);
    const double slides = kGravity * (std::sin(theta) - friction * std::cos(theta));
    const double exact = larger(rolls, slides);
    trial.expectNear("acceleration", (x2 - 2 * x1 + x0) / 4, exact, 0.005 * exact, "m/s2");
}

/// A bowl as a mesh of squares of `cell` over 2 half × 2 half metres, its lowest point at the origin.
TriangleMesh bowlOf(double radius, double half, double cell) {
    const int side = static_cast<int>(std::lround(2 * half / cell)) + 1;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const double x = column * cell - half, z = row * cell - half;
            vertices.push_back(toVec3(DVec3{x, radius - std::sqrt(radius * radius - x * x - z * z), z}));
        }
    for (int row = 0; row + 1 < side; ++row)
        for (int column = 0; column + 1 < side; ++column) {
            const auto a = static_cast<std::uint32_t>(row * side + column), b = a + 1;
            const auto c = a + static_cast<std::uint32_t>(side), d = c + 1;
            triangles.push_back({a, c, b});
            triangles.push_back({b, c, d});
        }
    return {vertices, triangles};
}

/// A ball swings through the bottom of a bowl with ω² = 5 g/(7 (R − r)), less a sixteenth of the amplitude's square.
/// The bowl has facets of half a degree, a tenth of the amplitude: a hundredth for the period is what they allow.
void bowl(Trial& trial) {
    constexpr double kBowl = 2, kAmplitude = 0.1, kReach = kBowl - static_cast<double>(kRadius);
    Scene scene;
    const Material material = surface(0.8f);
    add(scene, fixedBody(bowlOf(kBowl, 0.5, 0.02), {}, material));
    const DVec3 at{kReach * std::sin(kAmplitude), kBowl - kReach * std::cos(kAmplitude), 0};
    const int body = add(scene, solidBody(Sphere{kRadius}, at, 1, material));
    Run run = trial.start(scene);
    double before = at.x, first = 0, last = 0;
    int crossings = -1;
    run.advance(20, [&] {
        const double now = run.position(body).x;
        if (now * before < 0) {
            last = run.time() - trial.dt() * now / (now - before);
            if (++crossings == 0) first = last;
        }
        before = now;
        return true;
    });
    const double small = 2 * std::numbers::pi / std::sqrt(5 * kGravity / (7 * kReach));
    const double exact = small * (1 + kAmplitude * kAmplitude / 16);
    trial.expectNear("period", 2 * (last - first) / crossings, exact, 0.01 * exact, "s");
}

/// A ball that rolls on a turntable circles with 2/7 of its speed, wherever and however fast it goes.
void turntable(Trial& trial) {
    constexpr float kTable = 2, kSpeed = 0.5f;
    constexpr double kSeconds = 10;
    Scene scene;
    const Material material = surface(0.6f);
    BodyDef table = fixedBody(Box{{5, 0.5f, 5}}, {0, -0.5, 0}, material);
    table.type = BodyType::kinematic;
    table.angularVelocity = {0, kTable, 0};
    add(scene, table);
    BodyDef ball = solidBody(Sphere{kRadius}, {1, 0.25, 0}, 1, material);
    ball.linearVelocity = {0, 0, kSpeed};
    // Rolling: the ball's lowest point moves with the table, v + ω × (0, −r, 0) = Ω × (1, 0, 0) = (0, 0, −Ω).
    ball.angularVelocity = {(kTable + kSpeed) / kRadius, 0, 0};
    const int body = add(scene, ball);
    Run run = trial.start(scene);
    double turned = 0, heading = 0;
    bool first = true;
    run.advance(kSeconds, [&] {
        const Vec3 v = run.motion(body).v;
        const double next = std::atan2(static_cast<double>(v.x), static_cast<double>(v.z));
        if (!first) turned += std::remainder(next - heading, 2 * std::numbers::pi);
        first = false;
        heading = next;
        return true;
    });
    const double exact = 2.0 / 7 * static_cast<double>(kTable) * (run.time() - trial.dt());
    trial.expectNear("turned in 10 s", turned, exact, 0.005 * exact, "rad");
}

}  // namespace

Family rolling() {
    Family family{"rolling", {{"sliding to rolling", slidesThenRolls}}};
    const auto addRamp = [&family](const char* name, double shape, double friction) {
        family.cases.push_back(
            {fmt::format("{} on a ramp, mu={}", name, friction), [=](Trial& trial) { ramp(trial, shape, friction); }});
    };
    addRamp("ball", 0.4, 0.3);
    addRamp("disc", 0.5, 0.3);
    addRamp("hoop", 1, 0.3);
    addRamp("ball", 0.4, 0.1);
    addRamp("hoop", 1, 0.2);
    family.cases.push_back({"ball in a bowl", bowl});
    family.cases.push_back({"ball on a turntable", turntable});
    return family;
}

}  // namespace ragtop::stability
