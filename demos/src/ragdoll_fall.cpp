#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ragdoll_stander.h"
#include "ragtop/brace.h"

namespace ragtop::demos {
namespace {

constexpr int kPushes = 64;
constexpr double kFall = 4;                   ///< s
constexpr float kLeast = 1.6f, kMost = 2.6f;  ///< of what a body without a step can take
constexpr float kLost = 0.03f;  ///< m, of the capture point beyond the feet, at which it gives up standing
constexpr double kArmsFirst = 0.9, kHeadShare = 0.6;

bool isLeg(BodyRole role) { return role == BodyRole::foot || role == BodyRole::shank || role == BodyRole::thigh; }
bool isArm(BodyRole role) { return role == BodyRole::hand || role == BodyRole::forearm || role == BodyRole::upperArm; }

/// What happened when a body fell.
struct Fall {
    bool fell = false;
    BodyRole first = BodyRole::other;  ///< what met the ground first, of all but legs
    float head = 0;                    ///< m/s, of the hardest impact of the head
};

/// Notes what touches the floor, with the speeds that it had a step before.
class Landing {
public:
    explicit Landing(RagdollStander& stander) : stander_(stander), speeds_(stander.body().bodies().size()) {}

    void before() {
        for (std::size_t i = 0; i < speeds_.size(); ++i)
            speeds_[i] = -stander_.world().linearVelocity(stander_.body().bodies()[i]).y;
    }
    void after(Fall& fall) const {
        for (std::size_t i = 0; i < speeds_.size(); ++i) {
            const BodyRole role = stander_.body().def().parts[i].role;
            if (isLeg(role) || !touches(stander_.body().bodies()[i])) continue;
            if (fall.first == BodyRole::other) fall.first = role;
            if (role == BodyRole::head) fall.head = std::max(fall.head, speeds_[i]);
        }
    }

private:
    bool touches(BodyId part) const {
        bool found = false;
        stander_.world().forEachContact(part, [&](const Contact& contact) {
            const bool floor = contact.bodyA == stander_.floor() || contact.bodyB == stander_.floor();
            found |= floor && contact.normalForce > 0;
        });
        return found;
    }

    RagdollStander& stander_;
    std::vector<float> speeds_;
};

Fall fallOf(const RagdollDef& def, const Vec3& direction, float share, bool bracing, double dt) {
    RagdollStander stander(def);
    for (int i = 0; i < std::lround(kSettled / dt) && stander.stands(); ++i) stander.step(dt);
    stander.push(direction, share * stander.most(direction));
    Brace brace(stander.world(), stander.body(), stander.muscles());
    Landing landing(stander);
    Fall fall;
    for (int i = 0; i < std::lround(kFall / dt); ++i) {
        if (!fall.fell && stander.balance().margin() < -kLost) {
            fall.fell = true;
            stander.balance().release();
            if (!bracing) stander.muscles().setProfile(muscleProfile("limp"), 0.05f);
        }
        landing.before();
        stander.step(dt, fall.fell ? (bracing ? &brace : nullptr) : nullptr, !fall.fell);
        landing.after(fall);
    }
    return fall;
}

}  // namespace

std::vector<RagdollFigure> brace(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    const RagdollDef* def = RagdollStander::standerOf(subject);
    if (!def) return {};
    std::mt19937 random(static_cast<unsigned>(options.seeds));
    int falls = 0, arms = 0;
    double braced = 0, limp = 0;
    std::string others;
    for (int i = 0; i < kPushes; ++i) {
        const SinCos angle = sinCos(2 * kPi * static_cast<float>(i) / kPushes);
        const Vec3 direction{angle.sin, 0, angle.cos};
        const float share = kLeast + (kMost - kLeast) * 0.5f * (1 + anyNumber(random));
        const Fall fall = fallOf(*def, direction, share, true, 1 / options.hz);
        if (!fall.fell) continue;
        ++falls;
        arms += isArm(fall.first) ? 1 : 0;
        if (!isArm(fall.first)) others += fmt::format("{}{}: {}", others.empty() ? "" : ", ", i, nameOf(fall.first));
        braced += fall.head;
        limp += fallOf(*def, direction, share, false, 1 / options.hz).head;
    }
    const auto of = [](double part, double all) { return all > 0 ? part / all : 0.0; };
    return {{"brace", "arms_first_share", of(arms, falls), kArmsFirst, true, others},
            {"brace", "head_speed_to_limp_ratio", of(braced, limp), kHeadShare, false,
             fmt::format("{:.2f} m/s, limp {:.2f} m/s", of(braced, falls), of(limp, falls))}};
}

}  // namespace ragtop::demos
