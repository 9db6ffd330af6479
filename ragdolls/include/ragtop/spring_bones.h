#pragma once

#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/skeleton.h"
#include "ragtop/tunables.h"

/// Hair, tails, ears, straps: bones that swing behind an animation as damped pendulums.
namespace ragtop {

/// A line of bones. Each is a pendulum about where it would be unbent; its weight is where the next bone begins.
/// All numbers but `radius` are ratios, rates and angles, so that a skeleton of any size moves alike.
struct SpringChain {
    int first = -1, last = -1;  ///< indices of bones; `first` is `last` or above it, and none of them is the root
    /// m, in the last bone: where its weight is. Zero: as far from it as it is from its parent, and straight on.
    Vec3 tip{};
    float frequency = 2.0f;  ///< Hz, of each bone alone
    float dampingRatio = 0.25f;
    float sag = 0.1f;         ///< rad, by which gravity turns a bone that the animation has level
    float inertia = 0.5f;     ///< share of the animation's acceleration that bends it
    float swingLimit = 1.4f;  ///< rad, largest angle to where it would be unbent
    float radius = 0.0f;      ///< m, of the ball at each weight that colliders push out
};

/// The half-space y ≤ 0 of its frame is solid.
struct SpringPlane {};

/// What chains do not pass through: a shape that moves with a bone.
struct SpringCollider {
    int bone = -1;  ///< one that no chain moves; −1: the world
    Frame frame{};  ///< of the shape in the bone, or in the world
    std::variant<Sphere, Capsule, SpringPlane> shape{};
};

struct SpringBonesDef {
    std::vector<SpringChain> chains{};
    std::vector<SpringCollider> colliders{};
    /// Where a chain begins, it is taken for a teleport that it is further from where its motion led than this, in
    /// sizes of the skeleton.
    float jump = 0.5f;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SpringChain*) {
    visit(Tunable{"frequency", "Hz", 0.05, 30, "of each bone alone"}, self.frequency);
    visit(Tunable{"dampingRatio", "1", 0, 10, "damping over that without overshoot"}, self.dampingRatio);
    visit(Tunable{"sag", "rad", 0, 1.5, "angle by which gravity turns a bone held level"}, self.sag);
    visit(Tunable{"inertia", "1", 0, 1, "share of the animation's acceleration that bends it"}, self.inertia);
    visit(Tunable{"swingLimit", "rad", 1e-3, 3, "largest angle to where it would be unbent"}, self.swingLimit);
    visit(Tunable{"radius", "m", 0, 1e3, "of the ball at each weight"}, self.radius);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SpringBonesDef*) {
    visit(Tunable{"jump", "1", 1e-3, 1e6, "distance of a teleport over the size of the skeleton"}, self.jump);
}

/// Empty when the definition is usable on that skeleton; otherwise names the chain or collider, its value and what is
/// allowed.
std::string whyInvalid(const SpringBonesDef& def, const Skeleton& skeleton);

/// The chains of one skeleton while they move. The direction d of a bone, a unit vector, follows
///
///     d̈ = F − (F·d) d − 2ζω (ḋ − ḋ_c) − |ḋ|² d,   F = ω² r + ω² tan(sag) g − (inertia/L) a,
///
/// r where the animation has it, ḋ_c its rate if it were fixed there, a the acceleration of its joint in the animation,
/// g the unit vector of gravity, L its length; all seen in axes that turn with the bend of the bone that carries it. So
/// bends add up along a chain, but none shakes another, which would grow from bone to bone without end. Each step is
/// the damped oscillator's own course for the force and stiffness F·d in its middle: it is stable at any duration, and
/// the same at any frame rate (docs/adr/0045). Between frames the animation moves as its last two
/// frames and this one say. Steps neither throw nor allocate.
class SpringBones {
public:
    /// Throws std::invalid_argument that says what is wrong with the skeleton or the definition.
    SpringBones(const Skeleton& skeleton, const SpringBonesDef& def);
    ~SpringBones();
    SpringBones(SpringBones&&) noexcept;
    SpringBones& operator=(SpringBones&&) noexcept;

    const SpringBonesDef& def() const;
    /// Takes the pose of an animation, one world pose per bone, and turns the bones of chains, and carries along those
    /// that hang on them; dt seconds after the last call. In the first call chains hang at rest. With dt = 0 they keep
    /// their bend. `gravity` may have any length: other than 1 for weaker or stronger pull, with wind added to it.
    /// A pose of another size, a dt below zero and what is not finite assert in debug builds and do nothing.
    void step(std::span<Pose> pose, double dt, const Vec3& gravity = {0, -1, 0});
    /// What the animation does before the next step is no motion: chains keep their bend and swing. Told by hand where
    /// a jump is shorter than SpringBonesDef::jump, or a turn.
    void teleport();
    /// The next step begins with chains at rest, as the first one does.
    void reset();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ragtop
