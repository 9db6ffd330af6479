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

/// How an animation goes on when what is in its way takes more than its budget.
enum class WhenBlocked {
    stall,        ///< it presses on with its budget, and its clock slows down to what the body achieves
    yield,        ///< after a while it runs backwards, and forwards again once it is back at its beginning
    breakThrough  ///< after a while it destroys the dynamic body that bears most of its budget
};
inline constexpr std::array<std::string_view, 3> kWhenBlockedNames{"stall", "yield", "break"};
constexpr const std::array<std::string_view, 3>& enumNames(WhenBlocked) { return kWhenBlockedNames; }

struct AnimationKey {
    double time = 0;  ///< s
    Pose pose{};      ///< of the body, in its carrier
};

/// A body that follows an animation as a kinematic one does, but gives no more than its budget to what it meets.
struct AnimatedBodyDef {
    BodyId body{};     ///< dynamic
    BodyId carrier{};  ///< what the poses are relative to, and what bears the reaction; null: the world
    /// At least two, the first at 0 s, later ones later. Between them it eases out and in, s = 3t² − 2t³.
    std::vector<AnimationKey> keys{};
    bool loops = false;      ///< from the last key, which is where the first one is, on with the first
    float maxForce = 1000;   ///< N, along its way and across it, beyond what its own motion takes
    float maxTorque = 1000;  ///< N m, likewise
    WhenBlocked whenBlocked = WhenBlocked::stall;
    float patience = 0.2f;  ///< s of being blocked until it yields or breaks
};

/// Empty when the definition is usable, its bodies aside; otherwise the complaint.
std::string whyInvalid(const AnimatedBodyDef& def);

struct AnimationState {
    double clock = 0;      ///< s; the body is where the animation is at this time
    float rate = 0;        ///< of the clock in the last step: 1, less when blocked, negative when it runs backwards
    bool blocked = false;  ///< less than half of the way was possible in the last step
    float force = 0;       ///< N, that the animation gave at the end of the last step
    BodyId broken{};       ///< what it destroyed in the last step
};

/// Plays an animation on a body. While it is in hand the body does not feel gravity; let go, it is a dynamic body as
/// any other with the velocity that it had. The world must outlive this. Saved, restored and hashed with the world.
class AnimatedBody {
public:
    /// Throws std::invalid_argument that says what is wrong.
    AnimatedBody(World& world, const AnimatedBodyDef& def);
    ~AnimatedBody();
    AnimatedBody(AnimatedBody&&) noexcept;
    AnimatedBody& operator=(AnimatedBody&&) noexcept;

    AnimationState state() const;
    /// Where the animation is at a time of its clock.
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
