#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "ragdoll_stander.h"
#include "ragdoll_watch.h"
#include "ragtop/get_up.h"

namespace ragtop::demos {
namespace {

constexpr double kLiesFor = 3, kRisesWithin = 4,
                 kRiseWatched = 6;  ///< s: after it is dropped; in which it is to stand; in all
constexpr double kDropHeight = 1;   ///< m
constexpr double kRisen = 0.85;     ///< of the height of the centre of mass of who was set upright
constexpr double kRisenShare = 0.95, kJumpWay = 0.01, kJumpTurn = 2;  ///< share, m, degrees
constexpr double kJumpDegrees = 180 / M_PI;

/// Where parts are and how they move, to tell what a step did to them beside that.
class Jumps {
public:
    explicit Jumps(const RagdollStage& stage) : stage_(stage), poses_(stage.bodies.size()), speeds_(poses_.size()) {}

    void before() {
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            poses_[i] = {stage_.world.centerOfMass(stage_.bodies[i]), stage_.world.pose(stage_.bodies[i]).rotation};
            speeds_[i] = {stage_.world.linearVelocity(stage_.bodies[i]),
                          stage_.world.angularVelocity(stage_.bodies[i])};
        }
    }
    void after(double dt, const std::string& run) {
        const auto seconds = static_cast<float>(dt);
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            const Vec3 way = relative(stage_.world.centerOfMass(stage_.bodies[i]), poses_[i].position);
            const Quat turn = stage_.world.pose(stage_.bodies[i]).rotation * conjugate(poses_[i].rotation);
            const std::string where = run + ", " + stage_.names[i];
            way_.add(static_cast<double>(length(way - seconds * speeds_[i].linear)), where);
            turn_.add(kJumpDegrees * static_cast<double>(length(rotationVector(turn) - seconds * speeds_[i].angular)),
                      where);
        }
    }
    const Worst& way() const { return way_; }
    const Worst& turn() const { return turn_; }

private:
    const RagdollStage& stage_;
    std::vector<Pose> poses_;
    std::vector<PartMotion> speeds_;
    Worst way_, turn_;
};

struct Rise {
    bool stood = false;
    double force = 0, torque = 0;  ///< N, N m, the most
    double weight = 0;             ///< N
    Worst way, turn;               ///< where the phase changes
    Worst firstWay, firstTurn;     ///< where it is limp no more
};

Rise riseOf(const RagdollSubject& subject, const RagdollDef& def, int seed, const GetUpOptions& help, double dt) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const Quat turn = anyRotation(random);
    RagdollStage stage(subject, {{0, kDropHeight - RagdollStage(subject, {{}, turn}).lowestPoint(), 0}, turn});
    stage.addGround();
    const double upright = RagdollStander(def).height();
    Muscles muscles(stage.world, *stage.ragdoll, muscleProfile("limp"));
    Balance balance(stage.world, *stage.ragdoll, muscles);
    GetUp getUp(stage.world, *stage.ragdoll, muscles, balance, help);
    Jumps jumps(stage), first(stage);
    const std::string run = fmt::format("seed {}", seed);
    for (int i = 0; i < std::lround(kLiesFor / dt); ++i) {
        muscles.step(dt);
        stage.world.step(dt);
    }
    Rise rise;
    rise.weight = stage.mass() * static_cast<double>(length(stage.world.settings().gravity));
    std::optional<double> since;
    for (int i = 0; i < std::lround(kRiseWatched / dt); ++i) {
        if (i == 0) {
            muscles.setProfile(muscleProfile("tense"));
            getUp.begin();
        }
        const GetUpPhase before = getUp.phase();
        (i == 0 ? first : jumps).before();
        getUp.step(dt);
        muscles.step(dt);
        stage.world.step(dt);
        if (i == 0) first.after(dt, run);
        if (i > 0 && getUp.phase() != before) jumps.after(dt, run);
        rise.force = std::max(rise.force, static_cast<double>(length(getUp.assistance().linear)));
        rise.torque = std::max(rise.torque, static_cast<double>(length(getUp.assistance().angular)));
        const bool stands = getUp.stands() && stage.centerOfMass().y > kRisen * upright;
        if (!stands) since.reset();
        if (stands && !since) since = i * dt;
    }
    rise.stood = since && *since <= kRisesWithin;
    rise.way = jumps.way();
    rise.turn = jumps.turn();
    rise.firstWay = first.way();
    rise.firstTurn = first.turn();
    return rise;
}

}  // namespace

/// Dropped limp in any rotation, it gets up from how it lies then.
std::vector<RagdollFigure> getUp(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    const RagdollDef* def = RagdollStander::standerOf(subject);
    if (!def) return {};
    const GetUpOptions help;
    int stood = 0, alone = 0;
    Worst way, turn, firstWay, firstTurn, force, torque;
    std::string lay;
    double weight = 0;
    for (int seed = 1; seed <= options.seeds; ++seed) {
        const Rise rise = riseOf(subject, *def, seed, help, 1 / options.hz);
        const std::string run = fmt::format("seed {}", seed);
        stood += rise.stood ? 1 : 0;
        if (!rise.stood) lay += (lay.empty() ? "lay: " : ", ") + run;
        way.add(rise.way.value(), rise.way.where());
        turn.add(rise.turn.value(), rise.turn.where());
        firstWay.add(rise.firstWay.value(), rise.firstWay.where());
        firstTurn.add(rise.firstTurn.value(), rise.firstTurn.where());
        force.add(rise.force, run);
        torque.add(rise.torque, run);
        weight = rise.weight;
        alone += riseOf(subject, *def, seed, {.force = 0, .torque = 0}, 1 / options.hz).stood ? 1 : 0;
    }
    const auto share = [&](int count) { return options.seeds > 0 ? static_cast<double>(count) / options.seeds : 0; };
    // The centre of mass of who stands is higher than the legs are long.
    const double leg = RagdollStander(*def).height();
    return {{"getup", "stands_within_4_s_share", share(stood), kRisenShare, true, lay},
            {"getup", "assistance_force_max_n", force.value(), 1.001 * static_cast<double>(help.force) * weight, false,
             force.where()},
            {"getup", "assistance_torque_max_n_m", torque.value(), static_cast<double>(help.torque) * weight * leg,
             false, torque.where()},
            {"getup", "stands_without_assistance_share", share(alone), 0, true, ""},
            {"getup", "jump_from_limp_max_m", firstWay.value(), kJumpWay, false, firstWay.where()},
            {"getup", "turn_from_limp_max_deg", firstTurn.value(), kJumpTurn, false, firstTurn.where()},
            {"getup", "jump_at_changes_max_m", way.value(), kJumpWay, false, way.where()},
            {"getup", "turn_at_changes_max_deg", turn.value(), kJumpTurn, false, turn.where()}};
}

}  // namespace ragtop::demos
