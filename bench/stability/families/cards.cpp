#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "../extremes.h"
#include "masonry.h"

namespace ragtop::stability {
namespace {
namespace cards_cases {

constexpr double kSeconds = 60;
constexpr double kLength = 0.4, kThickness = 0.002, kWidth = 0.25;  ///< m
constexpr double kFallen = kLength / 10;                            ///< m, that a card of two has moved by
const double kLean = 25 * std::numbers::pi / 180;                   ///< rad from the vertical

/// The corners of a card by where it touches below and above, as it leans: the side towards `to` carries both contacts.
struct Card {
    DVec3 foot, head;
    double side;  ///< +1: its thickness lies to the left of the line from foot to head, −1: to the right

    std::vector<DVec3> corners() const {
        const DVec3 along = (1 / kLength) * (head - foot);
        const DVec3 back = side * kThickness * DVec3{-along.y, along.x, 0};
        return {foot, head, head + back, foot + back};
    }
};

/// Two cards that lean against each other on a level.
class Pair {
public:
    Pair(double middle, double level)
        : left_{{middle - kLength * std::sin(kLean), level, 0}, {middle, level + kLength * std::cos(kLean), 0}, 1},
          right_{{middle + kLength * std::sin(kLean), level, 0}, left_.head, -1} {}
    const Card& left() const { return left_; }
    const Card& right() const { return right_; }
    double top() const { return left_.corners()[2].y; }

private:
    Card left_, right_;
};

/// A line of contact across the card's width.
std::vector<DVec3> across(const DVec3& at) { return {{at.x, at.y, -kWidth / 2}, {at.x, at.y, kWidth / 2}}; }

/// Storeys of pairs, one less in each, with level cards over the gaps between their tops; all cards are equal.
class House {
public:
    /// With a seed, leaning pairs and level cards are each up to a tenth of a millimetre off their places. The two of a
    /// pair stay together: where their edges miss each other, they bear in another direction.
    explicit House(int storeys, double friction, int seed = 0)
        : cards_(static_cast<float>(friction)), dice_(static_cast<std::uint64_t>(seed)), off_(seed > 0 ? 1e-4 : 0) {
        double level = 0;
        std::vector<int> below;
        for (int storey = 0; storey < storeys; ++storey) {
            std::vector<int> pairs;
            for (int i = 0; i < storeys - storey; ++i)
                pairs.push_back(
                    addPair({kSpacing * (i + 0.5 * storey) + off(), level}, storey > 0 ? below[index(i)] : kGround));
            level = Pair(0, level).top();
            below.clear();
            for (int i = 0; i + 1 < static_cast<int>(pairs.size()); ++i)
                below.push_back(addLevel({kSpacing * (i + 0.5 * storey + 0.5) + off(), level, 0}, pairs[index(i)] + 1,
                                         pairs[index(i + 1)]));
            level += kThickness;
        }
    }
    const Masonry& cards() const { return cards_; }

private:
    static constexpr double kSpacing = kLength + 0.001;
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    double off() { return off_ * static_cast<double>(dice_.between(-1, 1)); }

    /// Returns the left card's number; the right one has the next.
    int addPair(const Pair& pair, int ground) {
        const int left = cards_.addSlab(pair.left().corners(), kWidth);
        const int right = cards_.addSlab(pair.right().corners(), kWidth);
        cards_.limit.addJoint({ground, left, across(pair.left().foot), {0, 1, 0}, {1, 0, 0}});
        cards_.limit.addJoint({ground, right, across(pair.right().foot), {0, 1, 0}, {1, 0, 0}});
        // The edges meet at a point in the plane, whose normal is level by symmetry.
        cards_.limit.addJoint({left, right, across(pair.left().head), {1, 0, 0}, {0, 1, 0}});
        heads_[left] = pair.left().corners()[2];
        heads_[right] = pair.right().corners()[2];
        return left;
    }
    /// A level card, its lower side's middle given, on the highest corners of two leaning ones.
    int addLevel(const DVec3& middle, int left, int right) {
        const double half = kLength / 2, top = middle.y + kThickness;
        const int card = cards_.addSlab({{middle.x - half, middle.y, 0},
                                         {middle.x + half, middle.y, 0},
                                         {middle.x + half, top, 0},
                                         {middle.x - half, top, 0}},
                                        kWidth);
        for (const int support : {left, right})
            cards_.limit.addJoint({support, card, across(heads_[support]), {0, 1, 0}, {1, 0, 0}});
        return card;
    }

    Masonry cards_;
    scenes::Dice dice_;
    double off_;  ///< m
    std::map<int, DVec3> heads_;
};

Survival simulate(Trial& trial, const House& house, const std::string& label, double limit) {
    Run run = trial.start(house.cards().scene, label);
    return survive(run, house.cards().stones, kSeconds, limit);
}

void stands(Trial& trial, int storeys, double friction, double limit) {
    int standing = 0;
    double moved = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        const Survival result = simulate(trial, House(storeys, friction, seed), fmt::format("{}", seed), limit);
        if (result.time >= kSeconds) ++standing;
        moved = larger(moved, result.moved);
    }
    trial.expectAtLeast(fmt::format("stand, of {}", trial.starts()), standing, trial.starts(), "houses");
    trial.expectAtMost("largest move", moved, kThickness / 10, "m");
}

double limitFriction(int storeys) {
    return bisect(0.7, 0.1, 1e-3, [&](double mu) { return House(storeys, mu).cards().limit.stands(mu); });
}

/// Two cards on the floor: with contacts at the edges they hold when μ ≥ (tan(lean) − thickness/length)/2.
void criticalFriction(Trial& trial) {
    const double exact = limitFriction(1);
    const auto stands = [&](double friction) {
        return simulate(trial, House(1, friction), fmt::format("mu {:.4f}", friction), kFallen).time >= kSeconds;
    };
    trial.expectNear("critical mu", bisect(0.3, 0.15, 5e-3, stands), exact, 0.02 * exact, "1");
}

}  // namespace cards_cases
}  // namespace

void addCardCases(Family& family) {
    using namespace cards_cases;
    family.cases.push_back({"limit analysis of cards",
                            [](Trial& trial) {
                                const double exact = (std::tan(kLean) - kThickness / kLength) / 2;
                                trial.expectNear("critical mu of two", limitFriction(1), exact, 0.001, "1");
                                trial.expectNear("five storeys stand", House(5, 0.7).cards().limit.stands(0.7), 1, 0,
                                                 "1");
                            },
                            Kind::ragtopOnly});
    family.cases.push_back({"two cards, mu=0.3", [](Trial& trial) { stands(trial, 1, 0.3, kFallen); }});
    family.cases.push_back({"two cards", criticalFriction, Kind::oneStep});
    for (const int storeys : {1, 3, 5})
        family.cases.push_back({fmt::format("house of cards, {} storeys", storeys),
                                [storeys](Trial& trial) { stands(trial, storeys, 0.7, kLength / 4); }});
}

}  // namespace ragtop::stability
