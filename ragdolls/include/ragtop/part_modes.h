#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/muscles.h"
#include "ragtop/ragdoll.h"
#include "ragtop/tunables.h"

/// Ragdolls of which an animation moves some parts and physics the others: an arm that hangs limp on a body that walks.
namespace ragtop {

/// What moves a part.
enum class PartMode : std::uint8_t {
    kinematic,  ///< the animation: it pushes and is not pushed
    powered,    ///< its muscles, which follow the animation
    limp,       ///< its weight and what it touches
};

/// "kinematic", "powered" or "limp".
std::string_view nameOf(PartMode mode);

struct PartState {
    PartMode mode = PartMode::powered;
    float strength = 1;  ///< of the muscles of its joint, as by Muscles::setStrength, unless it is limp
    float physics = 1;   ///< share of physics in its drawn pose; the rest is the animation's
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PartState*) {
    visit(Tunable{"strength", "1", 0, 1, "of the muscles of the part's joint"}, self.strength);
    visit(Tunable{"physics", "1", 0, 1, "share of physics in the drawn pose"}, self.physics);
}

/// Empty when the state is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const PartState& state);

/// Moves each part of a ragdoll as its state says, and goes from one state to another without a jump: what leaves the
/// animation keeps its velocity, and what comes back to it begins with the place and velocity that it has and is with
/// the animation, in both, when its time is over (a cubic Hermite curve of the difference). At first all parts are
/// powered. World, ragdoll and muscles must outlive it and stay where they are; states are not part of a world's saved
/// state. Steps neither throw nor allocate.
///
///     modes.set(upperArm, {.mode = PartMode::limp});
///     modes.follow(clip.pose(t), dt);  muscles.step(dt);  world.step(dt);
///     draw(blend(readPose(skeleton, clip.pose(t)), readPose(skeleton, body.pose()), modes.shares()));
class PartModes {
public:
    PartModes(World& world, const Ragdoll& ragdoll, Muscles& muscles);

    /// Of one part, or of it with all that hangs on it; strength and share of the drawn pose get there within
    /// `seconds`, and so does what becomes kinematic. Throws std::out_of_range, and std::invalid_argument on a bad
    /// state or duration.
    void set(int part, const PartState& state, float seconds = 0.2f);
    void setBranch(int part, const PartState& state, float seconds = 0.2f);
    const PartState& state(int part) const { return parts_.at(static_cast<std::size_t>(part)).state; }

    /// Where the animation has the bones when the next step, of dt seconds, is over: kinematic parts are taken there,
    /// with joints closed where it stretches them, and muscles follow. Throws std::invalid_argument on another number
    /// of bones or a pose that is none, and on a dt that is not above zero and finite.
    void follow(std::span<const Pose> bones, double dt);

    /// Share of physics in the drawn pose of each bone, for `blend` (pose.h).
    std::span<const float> shares() const { return shares_; }

private:
    /// From where physics had a part to where the animation has it, in world axes.
    struct Approach {
        Vec3 place, turn;          ///< m and rad, at its start
        Vec3 placeRate, turnRate;  ///< m/s and rad/s, there
        float age = 0, time = 0;   ///< s; it is over when the first is the second
    };
    struct Part {
        PartState state{};
        int joint = -1;             ///< that carries it
        int parent = -1;            ///< where that joint holds two points together
        Vec3 inParent{}, inPart{};  ///< m, these points
        float share = 1, rate = 0;  ///< of physics now, and how fast it changes, 1/s
        bool begins = false;        ///< has just become kinematic
        Approach approach{};
    };

    void begin(std::size_t part, const Pose& goal, const Vec3& velocity, const Vec3& spin);
    Pose approached(std::size_t part, const Pose& goal);
    void move(double dt);

    World* world_;
    const Ragdoll* ragdoll_;
    Muscles* muscles_;
    std::vector<Part> parts_;
    std::vector<Pose> before_, now_, goals_;  ///< of parts: the animation's last two poses; and where they are taken
    std::vector<float> shares_;               ///< one per bone
    bool told_ = false;                       ///< was there a pose before?
};

}  // namespace ragtop
