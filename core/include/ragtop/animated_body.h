#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/id.h"
#include "ragtop/joint_parts.h"
#include "ragtop/math.h"

namespace ragtop {

class World;

/// What an animation does when its way is blocked: when moving on would take more than its budget.
enum class WhenBlocked {
    stall,        ///< presses with its budget; its clock slows down to what the body achieves
    yield,        ///< after `patience` runs backwards, and forwards again once it is back at its beginning
    breakThrough  ///< after `patience` destroys the dynamic body that bears most of its force
};
inline constexpr std::array<std::string_view, 3> kWhenBlockedNames{"stall", "yield", "break"};
constexpr const std::array<std::string_view, 3>& enumNames(WhenBlocked) { return kWhenBlockedNames; }

struct AnimationKey {
    double time = 0;  ///< s
    Pose pose{};      ///< of the body, in its carrier
};

/// A dynamic body that follows an animation as a kinematic one would, with a bounded force on what it meets.
struct AnimatedBodyDef {
    BodyId body{};     ///< dynamic
    BodyId carrier{};  ///< the body that poses are relative to and that bears the reaction; null: the world
    /// At least two, at rising times from 0 s on. Between two keys the share of the way is 3t² − 2t³, t from 0 to 1.
    std::vector<AnimationKey> keys{};
    bool loops = false;      ///< goes on with the first key after the last one; their poses should be equal
    float maxForce = 1000;   ///< N, along its path and across it, each beyond what its own motion takes
    float maxTorque = 1000;  ///< N m, likewise
    WhenBlocked whenBlocked = WhenBlocked::stall;
    float patience = 0.2f;  ///< s that it must be blocked before it yields or breaks
};

/// Empty when the definition is usable (its bodies are not checked); otherwise says what is wrong.
std::string whyInvalid(const AnimatedBodyDef& def);

struct AnimationState {
    double clock = 0;      ///< s, time of the animation that the body is at
    float rate = 0;        ///< of the clock in the last step: 1; less when blocked; negative while it yields
    bool blocked = false;  ///< the body came less than half as far as it should in the last step
    float force = 0;       ///< N, on the body at the end of the last step
    BodyId broken{};       ///< the body that it destroyed in the last step, or null
};

/// Plays an animation on a body, which does not feel gravity meanwhile. Let go, it is a dynamic body like any other,
/// with the velocity that it has. The world must outlive this object. Saved, restored and hashed with the world.
class AnimatedBody {
public:
    /// Throws std::invalid_argument that says what is wrong.
    AnimatedBody(World& world, const AnimatedBodyDef& def);
    ~AnimatedBody();
    AnimatedBody(AnimatedBody&&) noexcept;
    AnimatedBody& operator=(AnimatedBody&&) noexcept;

    AnimationState state() const;
    /// The pose of the animation at a time of its clock, in the carrier.
    Pose at(double clock) const;
    /// A paused animation holds the body where it is.
    void setPaused(bool paused);
    /// Hands the body over to physics.
    void letGo();

private:
    struct Player;
    std::unique_ptr<Player> player_;
};

}  // namespace ragtop
