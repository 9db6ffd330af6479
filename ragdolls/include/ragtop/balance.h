#pragma once

#include <array>
#include <string>
#include <vector>

#include "ragtop/body_pose.h"
#include "ragtop/inverse_dynamics.h"
#include "ragtop/muscles.h"
#include "ragtop/tunables.h"

/// A powered human that stands on its own feet.
namespace ragtop {

/// How a body stands.
struct BalanceOptions {
    float gain = 2.8f;     ///< of the centre of pressure on the capture point; topples at 1
    float crouch = 0.04f;  ///< of the length of straight legs, by which the hips are lower
    float step = 0.9f;     ///< of the length of the legs, by which feet part at most in a step; 0: they stay in place
    float learning =
        0.5f;  ///< 1/s, at which it finds where it has to lean on a slope, with a load, on what accelerates
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BalanceOptions*) {
    visit(Tunable{"gain", "1", 1, 20, "of the centre of pressure on the capture point"}, self.gain);
    visit(Tunable{"crouch", "1", 0, 0.6, "of the length of the legs, by which hips are lower"}, self.crouch);
    visit(Tunable{"step", "1", 0, 1.5, "of the length of the legs, by which feet part at most in a step"}, self.step);
    visit(Tunable{"learning", "1/s", 0, 10, "at which it finds where it has to lean"}, self.learning);
}

/// Empty when the options are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const BalanceOptions& options);

struct Leg;
struct Sole;

/// Keeps a human on its feet by its joints alone: no force acts on it but gravity and what it touches. Legs are bent
/// by inverse kinematics for hips that carry the centre of mass over the middle of the feet, and bear the weight with
/// the torques of inverse dynamics for a centre of pressure that brings the capture point back (docs/adr/0080).
/// Everything is relative to what the feet stand on. World, ragdoll and muscles must outlive it and stay where they
/// are. Steps neither throw nor allocate.
///
///     balance.step(dt);  muscles.step(dt);  world.step(dt);
class Balance {
public:
    /// Throws std::invalid_argument on bad options, and where the body is no human with legs of three parts whose knees
    /// are hinges.
    Balance(World& world, const Ragdoll& ragdoll, Muscles& muscles, const BalanceOptions& options = {});
    ~Balance();
    Balance(const Balance&) = delete;
    Balance& operator=(const Balance&) = delete;

    /// Sets targets and gains of all muscles for the next step of the world.
    void step(double dt);
    /// The same with what was just seen of this ragdoll.
    void step(double dt, const InverseDynamics& seen);
    /// Takes up where the feet are, for capturePoint(), margin(), center() and reach(), of who something else moves.
    void look();
    void look(const InverseDynamics& seen);
    /// Gives the gains of the muscles back to their profile, and forgets where it had to lean.
    void release();

    /// Where the body would have to be held up to come to rest over it, on the height of the feet [Pratt et al.,
    /// Capture Point, 2006].
    const DVec3& capturePoint() const { return capture_; }
    /// m, from the capture point to the nearest edge of what the feet on or hardly over the ground cover, one that
    /// steps where it is going to be; negative beyond it.
    float margin() const { return margin_; }
    /// m, from the centre of mass to the edge of what the feet cover, along a level direction: J = m d √(g/z) is what a
    /// body of that height z can be pushed by without a step. 0 where it has no foot on the ground.
    float reach(const Vec3& direction) const;
    /// m, the middle between the soles.
    const DVec3& center() const { return center_; }
    const BalanceOptions& options() const { return options_; }
    /// From the next step on. Throws std::invalid_argument.
    void setOptions(const BalanceOptions& options);
    /// Is a foot on its way to where it is to catch the body?
    bool steps() const { return swing_.side >= 0; }
    bool onFeet() const { return feet_[0].planted || feet_[1].planted; }

    /// As Muscles::visitState.
    template <class Self, class Visit>
    static void visitState(Self& self, Visit&& visit) {
        visit(self.options_.gain);
        visit(self.options_.crouch);
        visit(self.options_.step);
        visit(self.options_.learning);
        visit(self.swing_.side);
        visit(self.swing_.age);
        visit(self.swing_.time);
        visit(self.swing_.from);
        visit(self.swing_.to);
        for (auto& foot : self.feet_) {
            visit(foot.planted);
            visit(foot.load);
            visit(foot.pressure);
            visit(foot.normal);
            visit(foot.ground);
            visit(foot.gained);
            visit(foot.height);
            visit(foot.middle);
            visit(foot.flat);
        }
        visit(self.lean_);
        visit(self.quickening_);
        visit(self.center_);
        visit(self.capture_);
        visit(self.margin_);
        visit(self.height_);
        visit(self.rise_);
    }

private:
    struct Foot {
        bool planted = false;
        float load = 0;    ///< N
        DVec3 pressure{};  ///< m, centre of it
        Vec3 normal{0, 1, 0};
        Vec3 ground{};     ///< m/s, of what it stands on
        Vec3 gained{};     ///< m/s, of that since it was felt before
        float height = 0;  ///< m, over the ground of the other one, of who is not planted
        DVec3 middle{};    ///< m, of the sole
        Quat flat{};       ///< rotation of its bone with the sole on the ground
    };
    /// A foot in the air.
    struct Swing {
        int side = -1;               ///< −1: none
        float age = 0, time = 0;     ///< s, since it left the ground, and that the step takes
        DVec3 from{}, to{};          ///< m, of the middle of its sole
    };
    struct Stand;

    void feel();
    void feel(std::size_t side);
    Stand survey() const;
    void quicken(float dt);
    void learn(const Stand& stand, float dt);
    void measure(const Stand& stand);
    bool isNear(std::size_t side) const;
    float marginOf(const Vec3& point) const;
    bool swings(std::size_t side) const { return swing_.side == static_cast<int>(side); }
    Vec3 landing(const Stand& stand, std::size_t side, float time) const;
    void begin(const Stand& stand);
    void carrySwing(float dt);
    void swing(const Stand& stand, float dt);
    Vec3 swungTo(const Stand& stand, float age) const;
    Vec3 swungBy(float age, float dt) const;
    void bend(const Stand& stand, float dt);
    void bear(const Stand& stand, float dt);

    World* world_;
    const Ragdoll* ragdoll_;
    Muscles* muscles_;
    BalanceOptions options_;
    BodyAxes axes_;
    int pelvis_ = -1;
    InverseDynamics dynamics_;
    std::vector<Leg> legs_;                            ///< left, right
    std::vector<Sole> soles_;                          ///< likewise
    std::vector<Quat> stance_;                         ///< turns of the joints of who stands
    std::vector<PartMotion> accelerations_, outside_;  ///< that muscles are told
    std::array<Foot, 2> feet_;
    Swing swing_;
    Vec3 lean_{};        ///< m, of the centre of mass from the middle of the feet, beside what quickening asks for
    Vec3 quickening_{};  ///< m/s², level acceleration of what the feet stand on
    DVec3 center_{}, capture_{};  ///< m, of the feet
    float margin_ = 0;
    float height_ = 0;  ///< m, of the hips, as legs were last bent for; 0: not yet
    float rise_ = 0;    ///< m/s, of that
};

}  // namespace ragtop
