#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../../../tests/core/mesh_bodies.h"
#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace rolling_cases {

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

/// A body that rolls about z on a slope, its moment there k m r².
struct Roller {
    std::string name;
    BodyDef def;
    int sides = 0;  ///< of a mesh; 0: round

    double k() const { return static_cast<double>(massOf(def).inertia.cz.z / (kRadius * kRadius)); }
};

Roller ball(double friction) {
    return {"ball", solidBody(Sphere{kRadius}, {}, 1, surface(static_cast<float>(friction)))};
}

/// The core's one round shape that rolls on a line: solid, or with its mass in its skin, whose tube has m r² and whose
/// caps have 2/3 m r².
Roller trunk(double friction, bool hollow) {
    constexpr float kHalf = 0.25f;
    BodyDef def = solidBody(Capsule{kRadius, kHalf}, {}, 1, surface(static_cast<float>(friction)));
    if (hollow) {
        def.mass = massOf(def);
        const float tube = kHalf / (kHalf + kRadius), r2 = kRadius * kRadius;
        const float across = def.mass->inertia.cx.x;
        def.mass->inertia = {{across, 0, 0}, {0, (tube + (1 - tube) * 2 / 3) * r2, 0}, {0, 0, across}};
    }
    // Its own axis is y.
    def.shapes[0].frame.rotation = rotationAbout({1, 0, 0}, kPi / 2);
    if (def.mass) std::swap(def.mass->inertia.cy.y, def.mass->inertia.cz.z);
    return {hollow ? "hollow trunk" : "solid trunk", def};
}

/// A mesh of 10 cm width and many flat sides: a disc, or a hoop with a wall of a centimetre.
Roller wheel(double friction, bool hoop) {
    constexpr std::uint32_t kSides = 256;
    const double r = static_cast<double>(kRadius), inner = hoop ? r - 0.01 : 0.001;
    std::vector<Vec3> vertices;
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const double angle = 2 * std::numbers::pi * i / kSides;
        for (const auto& [radius, z] : {std::pair{r, -0.05}, {r, 0.05}, {inner, 0.05}, {inner, -0.05}})
            vertices.push_back(toVec3(DVec3{radius * std::cos(angle), radius * std::sin(angle), z}));
    }
    const TriangleMesh mesh = scenes::closedGrid(vertices, kSides, 4);
    return {hoop ? "hoop" : "disc", solidBody(mesh, {}, 1, surface(static_cast<float>(friction))), kSides};
}

/// On a slope of tan θ = 1/2: a = g sin θ/(1 + k) while it rolls, which takes μ ≥ k/(1 + k) tan θ, and
/// g (sin θ − μ cos θ) beyond.
void ramp(Trial& trial, const Roller& roller) {
    const Slope slope{std::atan(0.5), 0, {}};
    const Material& material = roller.def.shapes[0].material;
    Scene scene;
    addSlope(scene, slope, material);
    BodyDef def = roller.def;
    def.pose.position = {0, static_cast<double>(kRadius), 0};
    const int body = add(scene, onSlope(slope, def));
    const DVec3 from = scene.bodies[static_cast<std::size_t>(body)].def.pose.position;
    Run run = trial.start(scene);
    const auto wayAfter = [&](double seconds) {
        run.advance(seconds);
        const DVec3 d = run.position(body) - from, down = slope.down();
        return d.x * down.x + d.y * down.y + d.z * down.z;
    };
    const double k = roller.k(), friction = static_cast<double>(material.friction);
    const double rolls = kGravity * std::sin(slope.theta) / (1 + k);
    const double slides = kGravity * (std::sin(slope.theta) - friction * std::cos(slope.theta));
    const double exact = larger(rolls, slides);
    if (roller.sides > 0) {
        // Each edge that it tips over takes the share α²/(1 + k) of its energy, α = 2π/n: on a way of φ radians from
        // rest, half of α φ/(1 + k) of all.
        const double way = exact / 2,
                     lost = std::numbers::pi / roller.sides * way / static_cast<double>(kRadius) / (1 + k);
        trial.expectNear("way in a second", wayAfter(1), way, (0.005 + lost) * way, "m");
        return;
    }
    const double x0 = wayAfter(1), x1 = wayAfter(2), x2 = wayAfter(2);
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

/// A ball that rolls on a turntable goes round a circle with 2/7 of its speed, wherever and however fast.
void turntable(Trial& trial) {
    constexpr float kTable = 2, kSpeed = 0.5f;
    constexpr double kSeconds = 12;  // a little more than one turn
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
    // At first towards z, so that the circle's middle is farther along x.
    const double radius = static_cast<double>(kSpeed / kTable) * 7 / 2;
    const DVec3 middle{1 + radius, 0, 0};
    double turned = 0, heading = 0, off = 0;
    bool first = true;
    run.advance(kSeconds, [&] {
        const BodyMotion m = run.motion(body);
        const double next = std::atan2(static_cast<double>(m.v.x), static_cast<double>(m.v.z));
        if (!first) turned += std::remainder(next - heading, 2 * std::numbers::pi);
        first = false;
        heading = next;
        const DVec3 arm = m.pose.position - middle;
        off = larger(off, std::abs(std::hypot(arm.x, arm.z) - radius));
        return true;
    });
    const double exact = 2.0 / 7 * static_cast<double>(kTable) * (run.time() - trial.dt());
    trial.expectNear("turned in 12 s", turned, exact, 0.005 * exact, "rad");
    trial.expectAtMost("off the circle", off, 0.005 * radius, "m");
}

}  // namespace rolling_cases
}  // namespace

Family rolling() {
    using namespace rolling_cases;
    Family family{"rolling", {{"sliding to rolling", slidesThenRolls}}};
    for (const double friction : {0.3, 0.1})
        for (const Roller& roller : {ball(friction), trunk(friction, false), trunk(friction, true),
                                     wheel(friction, false), wheel(friction, true)})
            family.cases.push_back({fmt::format("{} on a ramp, mu={}", roller.name, friction),
                                    [roller](Trial& trial) { ramp(trial, roller); }});
    family.cases.push_back({"ball in a bowl", bowl});
    family.cases.push_back({"ball on a turntable", turntable});
    return family;
}

}  // namespace ragtop::stability
