#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "world_support.h"

// Joints of several coordinates with soft stops, thrown from random states: what stops give they have taken.
namespace ragtop::test {
namespace {

constexpr Vec3 kMoments{0.02f, 0.06f, 0.05f};
constexpr float kLever = 0.3f, kStiffness = 200;

/// Deterministic numbers in [lower, upper).
class Dice {
public:
    float between(float lower, float upper) {
        state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
        return lower + (upper - lower) * static_cast<float>(state_ >> 40) / 16777216.0f;
    }
    Vec3 vector(float size) { return size * Vec3{between(-1, 1), between(-1, 1), between(-1, 1)}; }
    Range around(float size) { return {-size * between(0, 1), size * between(0.02f, 1)}; }
    AxisDef softAxis(float size) { return {.limit = around(size), .stop = {.stiffness = kStiffness}}; }

private:
    std::uint64_t state_ = 1;
};

/// A definition, B's rotation in A's frame, and what its stops store there.
struct Drawn {
    JointDef def;
    Quat rotation{};
    double stored = 0;
};

double storedBeyond(float margin) {
    return margin < 0 ? 0.5 * static_cast<double>(kStiffness) * static_cast<double>(margin * margin) : 0.0;
}

/// Up to half a radian beyond both limits where `pressed`. A twist stop's margin is scaled by the cosine of half the
/// swing.
Drawn cone(Dice& dice, bool pressed) {
    BallDef ball;
    ball.swingLimit = dice.between(0.1f, 2);
    ball.twistLimit = dice.around(2);
    ball.stop.stiffness = kStiffness;
    const float more = pressed ? 0.5f : 0.0f, to = dice.between(0, 6.28f);
    const float swing = pressed ? *ball.swingLimit + dice.between(0, more) : dice.between(0, *ball.swingLimit);
    const float twist = pressed ? ball.twistLimit->upper + dice.between(0, more) : 0.0f;
    const double stored = storedBeyond(*ball.swingLimit - swing) +
                          storedBeyond(std::cos(0.5f * swing) * (ball.twistLimit->upper - twist));
    return {ball, rotationAbout({0, std::cos(to), std::sin(to)}, swing) * rotationAbout({1, 0, 0}, twist), stored};
}
Drawn ellipse(Dice& dice, bool) {
    BallDef ball;
    ball.swingEllipse = SwingEllipse{dice.between(0.1f, 2), dice.between(0.1f, 2)};
    ball.twistLimit = dice.around(2);
    ball.stop.stiffness = kStiffness;
    return {ball};
}
Drawn pyramid(Dice& dice, bool) {
    BallDef ball;
    ball.swingPyramid = SwingPyramid{dice.around(1.5f), dice.around(1.5f)};
    ball.twistLimit = dice.around(2);
    ball.stop.stiffness = kStiffness;
    return {ball};
}
Drawn universal(Dice& dice, bool pressed) {
    UniversalDef def;
    def.first = dice.softAxis(1), def.second = dice.softAxis(1);
    const float first = pressed ? def.first.limit->upper + dice.between(0, 0.5f) : 0.0f;
    const float second = pressed ? def.second.limit->upper + dice.between(0, 0.5f) : 0.0f;
    const double stored = storedBeyond(def.first.limit->upper - first) + storedBeyond(def.second.limit->upper - second);
    return {def, rotationAbout({1, 0, 0}, first) * rotationAbout({0, 1, 0}, second), stored};
}

struct StopKind {
    const char* name;
    Drawn (*draw)(Dice& dice, bool pressed);
    bool mayBePressed;
};
constexpr StopKind kStopKinds[] = {
    {"cone", cone, true}, {"ellipse", ellipse, false}, {"pyramid", pyramid, false}, {"universal", universal, true}};

/// Joints far from each other, each of two bodies or of one and the world.
class ThrownJoints {
public:
    /// Velocities fit the joint but for a share `off` of them.
    ThrownJoints(const StopKind& kind, bool two, bool pressed, int count, float off = 0)
        : world_(withoutGravity()), off_(off) {
        Dice dice;
        for (int i = 0; i < count; ++i) {
            const DVec3 at{4.0 * i, 0, 0};
            const Drawn drawn = kind.draw(dice, pressed);
            const Vec3 common = two ? dice.vector(1) : Vec3{};
            Joint joint;
            if (two) joint.a = add(dice, at, {}, 1, common);
            joint.b = add(dice, at, drawn.rotation, -1, common);
            JointDef def = drawn.def;
            std::visit(
                [&](auto& each) {
                    each.bodies = {
                        joint.a, joint.b, {two ? Vec3{kLever, 0, 0} : toVec3(at), {}}, {{-kLever, 0, 0}, {}}};
                },
                def);
            joint.id = world_.create(def);
            joint.start = drawn.stored;
            joints_.push_back(joint);
        }
        recordKinetic(kind);
    }
    /// The most that any joint has gained, of what it began with, while none of its stops is pressed.
    double gain() const {
        double most = 0;
        for (const Joint& joint : joints_)
            if (world_.state(joint.id).limitMargin >= 0)
                most = std::max(most, (energy(world_, joint.a) + energy(world_, joint.b)) / joint.start - 1);
        return most;
    }
    void step() { world_.step(kDt); }

private:
    struct Joint {
        BodyId a, b;
        JointId id;
        double start = 0;
    };

    static WorldSettings withoutGravity() {
        WorldSettings settings;
        settings.gravity = {};
        return settings;
    }
    BodyId add(Dice& dice, const DVec3& at, const Quat& rotation, float side, const Vec3& common) {
        const Vec3 arm = rotate(rotation, {side * kLever, 0, 0});
        BodyDef def;
        def.pose = {at - DVec3(arm), rotation};
        def.shapes.push_back(shapeDef(Sphere{0.1f}));
        def.shapes[0].filter.mask = 0;
        def.mass = MassProperties{1, {}, {{kMoments.x, 0, 0}, {0, kMoments.y, 0}, {0, 0, kMoments.z}}};
        def.angularVelocity = dice.vector(6);
        def.linearVelocity = (1 + off_) * (common - cross(def.angularVelocity, arm));
        return world_.create(def);
    }
    static double energy(const World& world, BodyId id) {
        if (id.isNull()) return 0;
        const Vec3 v = world.linearVelocity(id), w = inverseRotate(world.pose(id).rotation, world.angularVelocity(id));
        return 0.5 * static_cast<double>(dot(v, v) + dot(w, scale(kMoments, w)));
    }
    /// What does not fit the rigid rows is lost at once: a universal's axes are held apart by its cross.
    void recordKinetic(const StopKind& kind);

    World world_;
    float off_;
    std::vector<Joint> joints_;
};

void ThrownJoints::recordKinetic(const StopKind& kind) {
    if (kind.draw != universal) {
        for (Joint& joint : joints_) joint.start += energy(world_, joint.a) + energy(world_, joint.b);
        return;
    }
    for (Joint& joint : joints_) {
        // Without its stops the joint's first step leaves what fits.
        World alone(withoutGravity());
        JointDef def = world_.def(joint.id);
        auto& universalDef = std::get<UniversalDef>(def);
        universalDef.first.limit.reset();
        universalDef.second.limit.reset();
        const auto copy = [&](BodyId id) {
            if (id.isNull()) return BodyId{};
            BodyDef body;
            body.pose = world_.pose(id);
            body.shapes.push_back(shapeDef(Sphere{0.1f}));
            body.shapes[0].filter.mask = 0;
            body.mass = world_.mass(id);
            body.linearVelocity = world_.linearVelocity(id);
            body.angularVelocity = world_.angularVelocity(id);
            return alone.create(body);
        };
        const BodyId a = copy(joint.a), b = copy(joint.b);
        universalDef.bodies.a = a, universalDef.bodies.b = b;
        alone.create(def);
        alone.step(kDt);
        joint.start += energy(alone, a) + energy(alone, b);
    }
}

/// Springs give back what they took, also where sides press together, begin pressed, or are met at one and left at
/// another time of a substep. In four seconds stops are met some ten times each.
TEST(SoftStopStates, NoJointGainsEnergy) {
    for (const StopKind& kind : kStopKinds)
        for (const bool two : {false, true})
            for (const bool pressed : {false, true}) {
                if (pressed && !kind.mayBePressed) continue;
                ThrownJoints joints(kind, two, pressed, 100);
                double most = 0;
                for (int step = 0; step < 240; ++step) {
                    joints.step();
                    most = std::max(most, joints.gain());
                }
                EXPECT_LT(most, 1e-3) << kind.name << ", two " << two << ", pressed " << pressed;
            }
}

/// Velocities that callers have from elsewhere fit a joint up to rounding, and are left as they are: so is what is
/// known of their energy.
TEST(SoftStopStates, FitUpToRoundingAndGainNoEnergy) {
    for (const StopKind& kind : kStopKinds)
        for (const bool two : {false, true}) {
            if (!kind.mayBePressed) continue;
            ThrownJoints joints(kind, two, true, 100, 4e-6f);
            double most = 0;
            for (int step = 0; step < 120; ++step) {
                joints.step();
                most = std::max(most, joints.gain());
            }
            EXPECT_LT(most, 1e-3) << kind.name << ", two " << two;
        }
}

}  // namespace
}  // namespace ragtop::test
