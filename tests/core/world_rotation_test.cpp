#include <algorithm>
#include <numbers>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Complete elliptic integral of the first kind, by the arithmetic-geometric mean [Abramowitz and Stegun, 17.6].
double ellipticK(double squaredModulus) {
    double a = 1, b = std::sqrt(1 - squaredModulus);
    while (a - b > 1e-15 * a) {
        const double mean = 0.5 * (a + b);
        b = std::sqrt(a * b);
        a = mean;
    }
    return std::numbers::pi / (2 * a);
}

Vec3 angularVelocityInBody(const World& world, BodyId body) {
    return inverseRotate(world.pose(body).rotation, world.angularVelocity(body));
}

struct Spin {
    Vec3 axis;
    float speed;
};

class WorldFreeRotation : public ::testing::TestWithParam<Spin> {};

// The momentum is stored and does not change while no torque acts: what is seen of it is rounded when the angular
// velocity is made of it and again by the test, a few ε each. Energy oscillates by the splitting error: with its
// leading term (|ω| h)² / 24 times differences of moments over moments, below one half here, and |ω| h ≤ 0.15, that is
// 5e-4; and it does not drift but for the rounding of rotations, √n ε.
TEST_P(WorldFreeRotation, KeepsAngularMomentumAndEnergy) {
    World world(withoutGravity());
    BodyDef def = bodyDef(Box{{0.5f, 0.3f, 0.1f}}, {});
    // A little off the axis, so that rotation about the middle one tumbles.
    def.angularVelocity = GetParam().speed * normalized(GetParam().axis + Vec3{1e-3f, 1e-3f, 1e-3f});
    const BodyId box = world.create(def);
    const Vec3 start = angularMomentum(world, box);
    const double energy = world.energy();
    float worst = 0;
    double worstEnergy = 0;
    run(world, 60, kDt, [&] {
        worst = std::max(worst, length(angularMomentum(world, box) - start) / length(start));
        worstEnergy = std::max(worstEnergy, std::abs(world.energy() - energy) / energy);
    });
    EXPECT_LT(worst, 20 * kEpsilon);
    EXPECT_LT(worstEnergy, 5e-4);
    RecordProperty("momentum", std::to_string(worst));
    RecordProperty("energy", std::to_string(worstEnergy));
}

// Nothing is too small to turn: a body is as large as its mass reaches, where it has no shape.
TEST(WorldRotation, BodiesWithoutShapesTurnUnderGravity) {
    World world;
    BodyDef def;
    def.mass = MassProperties{2, {}, {{0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}}};
    def.angularVelocity = {0, 2, 0};
    const BodyId body = world.create(def);
    run(world, 1, kDt, [] {});
    EXPECT_NEAR(world.angularVelocity(body).y, 2, 1e-5);
    world.setMass(body, {1, {}, {{0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}}});
    run(world, 1, kDt, [] {});
    EXPECT_NEAR(world.angularVelocity(body).y, 2, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Axes, WorldFreeRotation,
                         ::testing::Values(Spin{{1, 0, 0}, 10}, Spin{{0, 1, 0}, 10}, Spin{{0, 0, 1}, 10},
                                           Spin{{1, 0, 0}, 30}, Spin{{0, 1, 0}, 30}, Spin{{0, 0, 1}, 30},
                                           Spin{{1, 0, 0}, 100}, Spin{{0, 1, 0}, 100}, Spin{{0, 0, 1}, 100},
                                           Spin{{1, 1, 1}, 50}));

// About its long and its short axis a body keeps turning; about the middle one it tumbles over
// (Dzhanibekov; Landau and Lifshitz, Mechanics, § 37).
TEST(WorldRotation, OnlyTheMiddleAxisIsUnstable) {
    for (int axis = 0; axis < 3; ++axis) {
        World world(withoutGravity());
        BodyDef def = bodyDef(Box{{0.5f, 0.3f, 0.1f}}, {});
        Vec3 w{1e-3f, 1e-3f, 1e-3f};
        w[axis] = 10;
        def.angularVelocity = w;
        const BodyId box = world.create(def);
        float least = 1;
        run(world, 20, kDt, [&] { least = std::min(least, angularVelocityInBody(world, box)[axis] / 10); });
        // Principal moments order x < y < z for half extents 0.5, 0.3, 0.1.
        if (axis == 1)
            EXPECT_LT(least, -0.9f);
        else
            EXPECT_GT(least, 0.99f);
    }
}

/// A bar with a stem: moments all different, the middle one about the bar's normal in the plane of both.
BodyDef tHandle() {
    BodyDef def;
    def.shapes.push_back(shapeDef(Box{{0.3f, 0.05f, 0.05f}}));
    def.shapes.push_back(shapeDef(Box{{0.05f, 0.15f, 0.05f}}));
    def.shapes.back().frame.position = {0, -0.2f, 0};
    return def;
}

// Euler's equations turn the middle component of ω through a Jacobian sine of period 4 K(k) / rate, with
//   rate² = (I₃ − I₂)(L² − 2 E I₁) / (I₁ I₂ I₃),   k² = (I₂ − I₁)(2 E I₃ − L²) / ((I₃ − I₂)(L² − 2 E I₁))
// for L² > 2 E I₂ and I₁ < I₂ < I₃, and 1 and 3 exchanged otherwise (Landau and Lifshitz, § 37). The splitting makes
// the rate wrong by (|ω| h)² / 24 of a rotor step at most; the period depends on the logarithm of what the energy has
// above the separatrix, which is kept to rounding. Of fourth order, which long substeps take, 10 rad/s leave 4e-6 of
// it.
TEST(WorldRotation, ATHandleFlipsWithTheEllipticPeriod) {
    struct Pace {
        float speed;
        int substeps;
        double dt, tolerance;
    };
    for (const auto& [speed, substeps, dt, tolerance] :
         {Pace{10, 4, kDt, 1e-3}, Pace{30, 4, kDt, 1e-3}, Pace{100, 4, kDt, 1e-3}, Pace{10, 1, 4 * kDt, 3e-5}}) {
        WorldSettings settings = withoutGravity();
        settings.substeps = substeps;
        World world(settings);
        BodyDef def = tHandle();
        const BodyId probe = world.create(def);
        const Mat3 inertia = world.mass(probe).inertia;
        const double moment[3] = {inertia.cx.x, inertia.cy.y, inertia.cz.z};
        world.destroy(probe);
        int order[3] = {0, 1, 2};
        std::sort(order, order + 3, [&](int a, int b) { return moment[a] < moment[b]; });
        Vec3 w;  // so near the separatrix that a change of energy by 1e-5 would send it around the wrong way
        w[order[0]] = 0.01f * speed;
        w[order[1]] = speed;
        def.angularVelocity = w;
        const BodyId handle = world.create(def);
        double squared = 0, twice = 0;
        for (int i = 0; i < 3; ++i) {
            const double l = moment[i] * w[i];
            squared += l * l, twice += l * w[i];
        }
        const bool high = squared > twice * moment[order[1]];
        const double i1 = moment[order[high ? 0 : 2]], i2 = moment[order[1]], i3 = moment[order[high ? 2 : 0]];
        const double rate = std::sqrt((i3 - i2) * (squared - twice * i1) / (i1 * i2 * i3));
        const double k2 = (i2 - i1) * (twice * i3 - squared) / ((i3 - i2) * (squared - twice * i1));
        const double flip = 2 * ellipticK(k2) / rate;
        double before = w[order[1]], first = 0, last = 0;
        int flips = -1, step = 0;
        run(world, 60, dt, [&] {
            const double now = angularVelocityInBody(world, handle)[order[1]];
            ++step;
            if ((now > 0) != (before > 0)) {
                last = (step - 1 + before / (before - now)) * dt;
                if (++flips == 0) first = last;
            }
            before = now;
        });
        ASSERT_GT(flips, 3);
        EXPECT_NEAR((last - first) / flips, flip, tolerance * flip) << speed << " rad/s, " << dt << " s";
    }
}

// A symmetric top on a point precesses steadily when I₁ cos θ Ω² − I₃ ω₃ Ω + m g r = 0, with I₁ about the point
// (Goldstein, Classical Mechanics, § 5.7). The joint holds the point to h² of its acceleration.
TEST(WorldRotation, AHeavyTopPrecessesSteadily) {
    for (const double spin : {45.0, 60.0, 90.0}) {
        const double theta = 0.5, r = 0.4;
        World world(withoutSleep());
        BodyDef def = bodyDef(Box{{0.3f, 0.05f, 0.3f}}, {});
        const BodyId probe = world.create(def);
        const MassProperties mass = world.mass(probe);
        world.destroy(probe);
        const double i3 = mass.inertia.cy.y, i1 = mass.inertia.cx.x + mass.mass * r * r;
        // The slow root.
        const double a = i1 * std::cos(theta), b = i3 * spin, c = mass.mass * 9.81 * r;
        const double rate = 2 * c / (b + std::sqrt(b * b - 4 * a * c));
        const Quat tilt = rotationAbout({0, 0, 1}, -static_cast<float>(theta));
        const Vec3 axis = rotate(tilt, {0, 1, 0}), arm = static_cast<float>(r) * axis;
        const Vec3 precession{0, static_cast<float>(rate), 0};
        def.pose = {DVec3(arm), tilt};
        def.angularVelocity = precession + static_cast<float>(spin - rate * std::cos(theta)) * axis;
        def.linearVelocity = cross(precession, arm);
        const BodyId top = world.create(def);
        BallDef ball;
        ball.bodies.b = top;
        ball.bodies.frameB.position = {0, -static_cast<float>(r), 0};
        world.create(JointDef{ball});
        double turned = 0, before = 0;
        const double seconds = 10;
        run(world, seconds, kDt, [&] {
            const DVec3 p = world.pose(top).position;
            const double now = std::atan2(-p.z, p.x);
            double change = now - before;
            if (change < -std::numbers::pi) change += 2 * std::numbers::pi;
            turned += change;
            before = now;
        });
        EXPECT_NEAR(turned / seconds, rate, 0.005 * rate) << spin;
        const Vec3 up = rotate(world.pose(top).rotation, {0, 1, 0});
        EXPECT_NEAR(std::acos(static_cast<double>(up.y)), theta, 0.01);
    }
}

// Euler's equations in double precision, by Runge and Kutta's method: R' = R [ω], I ω' = I ω × ω + τ, all along the body's
// axes but τ.
struct Turning {
    double q[4];  ///< x, y, z, w
    double w[3];
};

Turning rates(const Turning& s, const double inertia[3], const Vec3& torqueWorld) {
    const Quat q{static_cast<float>(s.q[0]), static_cast<float>(s.q[1]), static_cast<float>(s.q[2]),
                 static_cast<float>(s.q[3])};
    const Vec3 torque = inverseRotate(q, torqueWorld);
    const double t[3] = {torque.x, torque.y, torque.z};
    Turning d;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        d.w[i] = ((inertia[j] - inertia[k]) * s.w[j] * s.w[k] + t[i]) / inertia[i];
        d.q[i] = 0.5 * (s.q[3] * s.w[i] + s.q[j] * s.w[k] - s.q[k] * s.w[j]);
    }
    d.q[3] = -0.5 * (s.q[0] * s.w[0] + s.q[1] * s.w[1] + s.q[2] * s.w[2]);
    return d;
}

Turning plus(Turning s, double h, const Turning& d) {
    for (int i = 0; i < 4; ++i) s.q[i] += h * d.q[i];
    for (int i = 0; i < 3; ++i) s.w[i] += h * d.w[i];
    return s;
}

// A body that something acts on and that turns by less than 1/256 rad in a substep is turned by its mean angular velocity.
// That errs by a twelfth of the third power of the turn, 2e-9 a substep here; kicks of the torque come half a substep
// early, 2e-6 in all; single precision rounds the rotation twice a substep, at most 2n ε = 6e-4, likely a tenth of it.
// Without the second order of its axis it would be off by h ω² t / 2 = 8e-3.
TEST(WorldRotation, ASlowBodyTurnsAsEulersEquationsSay) {
    World world(withoutGravity());
    BodyDef def = bodyDef(Box{{0.5f, 0.3f, 0.1f}}, {});
    def.angularVelocity = {0.4f, 0.3f, 0.35f};
    const BodyId box = world.create(def);
    const Mat3 moments = world.mass(box).inertia;
    const double inertia[3] = {moments.cx.x, moments.cy.y, moments.cz.z};
    const Vec3 torque{1e-4f * moments.cz.z, 0, 0};
    Turning now{{0, 0, 0, 1}, {def.angularVelocity.x, def.angularVelocity.y, def.angularVelocity.z}};
    constexpr int kSteps = 600, kParts = 16;
    constexpr double h = kDt / kParts;
    for (int i = 0; i < kSteps; ++i) {
        world.applyTorque(box, torque);
        world.step(kDt);
        for (int j = 0; j < kParts; ++j) {
            const Turning a = rates(now, inertia, torque), b = rates(plus(now, h / 2, a), inertia, torque);
            const Turning c = rates(plus(now, h / 2, b), inertia, torque), d = rates(plus(now, h, c), inertia, torque);
            now = plus(plus(plus(plus(now, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
        }
    }
    const Quat rotation = world.pose(box).rotation;
    const double q[4] = {rotation.x, rotation.y, rotation.z, rotation.w};
    double along = 0, squared = 0;
    for (int i = 0; i < 4; ++i) along += q[i] * now.q[i];
    const double sign = along < 0 ? -1 : 1;
    for (int i = 0; i < 4; ++i) squared += (q[i] - sign * now.q[i]) * (q[i] - sign * now.q[i]);
    const double angle = 2 * std::sqrt(squared);
    EXPECT_LT(angle, 2e-4);
    RecordProperty("angle", std::to_string(angle));
}

// The pull of a joint is inner to the pair: its centre of mass flies the parabola of a single body, and the momentum
// about it is kept, since the joint's impulses act at one point.
TEST(WorldRotation, AJointedPairFliesLikeOneBody) {
    World world;
    BodyDef def = bodyDef(Box{{0.4f, 0.1f, 0.1f}}, {-0.4, 100, 0});
    def.angularVelocity = {0, 2, 5};
    def.linearVelocity = {3, 10, 0};
    const BodyId a = world.create(def);
    def.pose.position = {0.4, 100, 0};
    def.angularVelocity = {4, -3, 1};
    def.linearVelocity = {3, 10, 0};
    const BodyId b = world.create(def);
    BallDef ball;
    ball.bodies.a = a, ball.bodies.b = b;
    ball.bodies.frameA.position = {0.4f, 0, 0}, ball.bodies.frameB.position = {-0.4f, 0, 0};
    world.create(JointDef{ball});
    for (int i = 1; i <= 180; ++i) {
        world.step(kDt);
        const double t = i * kDt;
        const DVec3 middle = 0.5 * (world.centerOfMass(a) + world.centerOfMass(b));
        ASSERT_NEAR(middle.y, 100 + 10 * t - 0.5 * 9.81 * t * t, 2e-5 * (1 + t * t * 5)) << t;
        ASSERT_NEAR(middle.x, 3 * t, 2e-5 * (1 + 3 * t)) << t;
    }
}

}  // namespace
}  // namespace ragtop
