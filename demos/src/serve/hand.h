#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/module.h"

namespace ragtop {
class World;
}

namespace ragtop::live {

/// What viewers do to a world by hand: a damped spring from a point of a body to the cursor, and balls they shoot. It
/// is a module of the world, so that its state is saved and restored with it.
///
/// The spring is integrated implicitly with the mass that the point of the free body has,
///
///     (E + (h² k + h c) K) λ = −h (k (x − target) + (h k + c) v),   |λ| ≤ h F
///
/// which never overshoots, whatever the body touches or is joined to: that makes it only heavier. Stiffness, damping
/// and the largest force F belong to the mass of the body and all that joints hang on it, so that a person can be
/// lifted by the hand and a brick cannot push a car.
class Hand {
public:
    static constexpr std::size_t kMostBalls = 200;  ///< a further one takes the place of the oldest

    /// The world must outlive it and stay where it is.
    explicit Hand(World& world);
    ~Hand();
    Hand(const Hand&) = delete;
    Hand& operator=(const Hand&) = delete;

    /// `point` is in the frame of the body. Throws std::invalid_argument unless the body is dynamic.
    void grab(BodyId body, const Vec3& point, const DVec3& target);
    /// Throws std::invalid_argument when nothing is held.
    void drag(const DVec3& target);
    void release();
    /// What is held; null: nothing.
    BodyId held() const { return state_.body; }

    /// `direction` need not have unit length; speed in m/s, radius in m. Throws std::invalid_argument.
    BodyId shoot(const DVec3& origin, const Vec3& direction, float speed, float radius);
    bool isBall(BodyId body) const;

private:
    struct State {
        BodyId body;
        Vec3 point;      // m, in the body
        float mass = 0;  // kg, of the body and what joints hang on it
        DVec3 target;
        std::uint32_t nextBall = 0, reserved = 0;
        std::array<BodyId, kMostBalls> balls{};
    };

    void beforeStep();
    std::span<const BodyId> look() const;
    void pull(float h);

    World& world_;
    StepModule module_;
    State state_;
};

}  // namespace ragtop::live
