#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ragtop/balance.h"
#include "ragtop/brace.h"
#include "ragtop/get_up.h"
#include "ragtop/module.h"
#include "ragtop/muscles.h"
#include "ragtop/tunables.h"

/// A human that stands, is struck, staggers, falls, lies and gets up.
namespace ragtop {

/// When a puppet does what.
struct PuppetOptions {
    float lost = 0.03f;  ///< m, of the capture point beyond the feet, and beyond a step, at which it gives up standing
    float stagger = 0.02f;  ///< m, of the capture point within the feet, below which it staggers
    float quiet = 0.3f;     ///< m/s, of the centre of mass, below which who fell lies
    float rest = 1.0f;      ///< s, for which it lies before it gets up
    float hurt = 40;        ///< N s, of a blow that leaves a joint of a human of 75 kg without strength
    float recovery = 0.8f;  ///< s, in which strength comes back
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PuppetOptions*) {
    visit(Tunable{"lost", "m", 0, 1, "capture point beyond the feet at which it gives up standing"}, self.lost);
    visit(Tunable{"stagger", "m", 0, 1, "capture point within the feet below which it staggers"}, self.stagger);
    visit(Tunable{"quiet", "m/s", 0.01, 10, "of the centre of mass, below which who fell lies"}, self.quiet);
    visit(Tunable{"rest", "s", 0, 1e6, "for which it lies before it gets up"}, self.rest);
    visit(Tunable{"hurt", "N s", 0.1, 1e6, "blow that leaves a joint of a human of 75 kg limp"}, self.hurt);
    visit(Tunable{"recovery", "s", 0.05, 60, "in which strength comes back"}, self.recovery);
}

/// Empty when the options are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const PuppetOptions& options);

enum class PuppetState : std::uint8_t { stands, staggers, falls, lies, getsUp };

/// "stands", "gets up" and so on.
std::string_view nameOf(PuppetState state);

/// Goes from one behaviour to the next as physics has it; a game calls step() once a step and may strike it. Changes
/// are eased by Muscles::crossfade. What it is about is saved, restored and hashed with the world, to which it belongs
/// as a module. World and ragdoll must outlive it and stay where they are. Steps neither throw nor allocate.
///
///     puppet.step(dt);  world.step(dt);
class Puppet {
public:
    /// Standing. Throws std::invalid_argument on bad options, and where Balance, Brace or GetUp would.
    Puppet(World& world, const Ragdoll& ragdoll, const PuppetOptions& options = {}, const GetUpOptions& help = {});
    ~Puppet();
    Puppet(const Puppet&) = delete;
    Puppet& operator=(const Puppet&) = delete;

    /// Decides what to do, and sets the joints for the next step of the world, of dt seconds.
    void step(double dt);
    /// A blow of `impulse`, N s, on a part at a point of the world. Muscles of joints near it lose strength, by half
    /// for each joint between, and get it back. Throws std::out_of_range, and std::invalid_argument on what is not
    /// finite.
    void strike(int part, const Vec3& impulse, const DVec3& point);

    PuppetState state() const { return state_; }
    const Balance& balance() const { return balance_; }
    const Muscles& muscles() const { return muscles_; }
    Muscles& muscles() { return muscles_; }
    /// N and N m in the next step of the world: of who gets up, else zero.
    const PartMotion& assistance() const { return assistance_; }

private:
    template <class Self, class Visit>
    static void visitState(Self& self, Visit&& visit);
    void belong();
    void enter(PuppetState state);
    void decide();
    void heal();

    World* world_;
    const Ragdoll* ragdoll_;
    PuppetOptions options_;
    InverseDynamics dynamics_;
    Muscles muscles_;
    Balance balance_;
    Brace brace_;
    GetUp getUp_;
    PuppetState state_ = PuppetState::stands;
    double age_ = 0;                  ///< s, of the state
    double air_ = 0;                  ///< s, without a foot on the ground
    double off_ = 0;                  ///< s, with the capture point beyond what a step reaches
    double height_ = 0;               ///< m, of the centre of mass over the feet of who stands
    std::vector<std::uint8_t> hurt_;  ///< by joint: has it just lost strength?
    std::vector<float> loss_;         ///< by part, of one blow
    PartMotion assistance_;
    StepModule module_;
};

}  // namespace ragtop
