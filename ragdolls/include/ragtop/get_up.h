#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ragtop/balance.h"
#include "ragtop/body_pose.h"
#include "ragtop/inverse_dynamics.h"
#include "ragtop/muscles.h"
#include "ragtop/tunables.h"

/// A human that gets up from the ground.
namespace ragtop {

/// How a body gets up, and what it may be helped with.
struct GetUpOptions {
    float force = 0.6f;    ///< most assistance, over the weight
    float torque = 0.4f;   ///< most assistance, over weight times length of the legs
    float turning = 1.5f;  ///< s, at most, in which the trunk turns upright over folded legs
    float rising = 1.0f;   ///< s, from squatting to standing
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GetUpOptions*) {
    visit(Tunable{"force", "1", 0, 2, "most assistance, over the weight"}, self.force);
    visit(Tunable{"torque", "1", 0, 2, "most assistance, over weight times length of the legs"}, self.torque);
    visit(Tunable{"turning", "s", 0.5, 10, "at most, in which the trunk turns upright over folded legs"}, self.turning);
    visit(Tunable{"rising", "s", 0.2, 10, "from squatting to standing"}, self.rising);
}

/// Empty when the options are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const GetUpOptions& options);

enum class GetUpPhase : std::uint8_t {
    fold,   ///< knees under the trunk, which turns upright; arms push against the ground
    squat,  ///< the weight goes to the feet
    rise,
    stand,  ///< without assistance
};

/// Brings a human from any lying pose onto its feet. Key poses by role bring the legs under the trunk, arms reach for
/// the ground, and from the squat Balance raises it (docs/adr/0081). What joints cannot give is added as the
/// acceleration of a rigid body, which strains no joint, of bounded force and torque; it is told, may be bounded to
/// zero, and is zero for who stands. World, ragdoll, muscles and balance must outlive it and stay where they are. Steps
/// neither throw nor allocate.
///
///     getUp.step(dt);  muscles.step(dt);  world.step(dt);
class GetUp {
public:
    /// Throws std::invalid_argument on bad options, and where the body has no chest.
    GetUp(World& world, const Ragdoll& ragdoll, Muscles& muscles, Balance& balance, const GetUpOptions& options = {});

    /// From how the body lies now. The profile of the muscles is the caller's: who is limp stays down.
    void begin();
    /// Sets targets and gains of all muscles, the crouch of the balance, and the assistance for the next step of the
    /// world, of dt seconds.
    void step(double dt);

    GetUpPhase phase() const { return phase_; }
    bool stands() const { return phase_ == GetUpPhase::stand; }
    /// N, and N m about the centre of mass, world axes, in the next step of the world.
    const PartMotion& assistance() const { return assistance_; }

    /// As Muscles::visitState.
    template <class Self, class Visit>
    static void visitState(Self& self, Visit&& visit) {
        visit(self.phase_);
        visit(self.age_);
        visit(self.assistance_.linear);
        visit(self.assistance_.angular);
    }

private:
    void enter(GetUpPhase phase);
    void advance();
    void fold();
    void rise();
    float share() const;
    void assist(float dt);
    void push(Vec3 linear, Vec3 angular);
    Vec3 up() const;

    World* world_;
    const Ragdoll* ragdoll_;
    Muscles* muscles_;
    Balance* balance_;
    GetUpOptions options_;
    BalanceOptions standing_;  ///< as the balance was made
    BodyAxes axes_;
    InverseDynamics dynamics_;
    int pelvis_ = -1, chest_ = -1;
    float legs_ = 0;  ///< m, length
    std::vector<Quat> turns_;
    GetUpPhase phase_ = GetUpPhase::stand;
    float age_ = 0;  ///< s, of the phase
    PartMotion assistance_;
};

}  // namespace ragtop
