#pragma once

#include <cstdint>
#include <vector>

#include "../stability/scenery.h"

/// Words for writing courses: gravity 10 m/s², friction 0.6, no restitution, nothing sleeps.
namespace ragtop::speed {

/// The generator that the other engines' scenes were drawn with (xorshift).
class PeerDice {
public:
    explicit PeerDice(std::uint64_t seed) : state_(seed * 2654435761u + 88172645463325252ull) {}
    std::uint32_t bits() {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 7;
        state_ ^= state_ << 17;
        return static_cast<std::uint32_t>(state_ >> 32);
    }
    float between(float from, float to) {
        return from + (to - from) * (static_cast<float>(bits() >> 8) * (1.0f / 16777216.0f));
    }
    /// In the box of side 2.
    Vec3 inCube();

private:
    std::uint64_t state_;
};

/// Bodies of one group, above zero, do not collide with each other.
struct Placing {
    DVec3 position{};
    Quat rotation{};
    Vec3 velocity{};  ///< m/s
    int group = 0;
};

/// Where a joint is and how it turns: its axis, and the direction that both bodies call zero.
struct JointPlace {
    DVec3 anchor{};
    Vec3 axis{1, 0, 0}, zero{0, 1, 0};
};

class Builder {
public:
    explicit Builder(std::string name);

    int fixed(Shape shape, const Placing& at);
    /// Density in kg/m³.
    int moving(Shape shape, float density, const Placing& at);
    /// Moves as it is told, at a constant speed.
    int pusher(Shape shape, const Placing& at);
    /// A slab with its top at y = 0.
    void ground(float half);
    /// Four walls of 20 bricks of 0.4 m × 0.2 m × 0.2 m a course, laid dry with gaps of 2 mm, each corner in bond.
    void brickHouse(int courses);
    /// A square pit of that inner side (m) on the ground.
    void pit(float side);

    BallDef& ball(int a, int b, const JointPlace& place);
    HingeDef& hinge(int a, int b, const JointPlace& place);

    Scene scene;
    int groups = 0;  ///< given out so far

private:
    JointBodies frames(int a, int b, const JointPlace& place) const;
};

inline constexpr Quat kTurnedAlongX{0, 0, -0.70710678f, 0.70710678f};  ///< takes a capsule's y to x

/// Twelve capsules, eleven joints with limits and dry friction, 1.7 m tall, its pelvis at the pose.
void addRagdoll(Builder& builder, const DVec3& position, const Quat& rotation);
/// The hull of 12 to 20 points on a sphere of half a metre.
ConvexHull stone(PeerDice& dice);
/// A wall of boxes of 1 m, `base` of them below.
void addPyramid(Builder& builder, const DVec3& at, int base);

}  // namespace ragtop::speed
