#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "masonry.h"

namespace ragtop::stability {
namespace {

constexpr double kSeconds = 60;
constexpr double kLength = 0.4, kThickness = 0.002, kWidth = 0.25;  ///< m
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
    explicit House(int storeys, double friction) : cards_(static_cast<float>(friction)) {
        double level = 0;
        std::vector<int> below;
        for (int storey = 0; storey < storeys; ++storey) {
            std::vector<int> pairs;
            for (int i = 0; i < storeys - storey; ++i)
                pairs.push_back(
                    addPair({kSpacing * (i + 0.5 * storey), level}, storey > 0 ? below[index(i)] : kGround));
            level = Pair(0, level).top();
            below.clear();
            for (int i = 0; i + 1 < static_cast<int>(pairs.size()); ++i)
                below.push_back(addLevel({kSpacing * (i + 0.5 * storey + 0.5), level, 0}, pairs[index(i)] + 1,
                                         pairs[index(i + 1)]));
            level += kThickness;
        }
    }
    const Masonry& cards() const { return cards_; }

private:
    static constexpr double kSpacing = kLength + 0.001;
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }

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
    std::map<int, DVec3> heads_;
};

/// Two cards on the floor: with contacts at the edges they hold when μ ≥ (tan(lean) − thickness/length)/2.
Survival simulateFrame(Trial& trial, double friction) {
    const House pair(1, friction);
    Run run = trial.start(pair.cards().scene, fmt::format("mu {:.4f}", friction));
    return survive(run, pair.cards().stones, kSeconds, kLength / 10);
}

double limitFriction(int storeys) {
    return bisect(0.7, 0.1, 1e-3, [&](double mu) { return House(storeys, mu).cards().limit.stands(mu); });
}

void criticalFriction(Trial& trial) {
    const double exact = limitFriction(1);
    const double measured =
        bisect(0.3, 0.15, 5e-3, [&](double friction) { return simulateFrame(trial, friction).time >= kSeconds; });
    trial.expectNear("critical mu", measured, exact, 0.02 * exact, "1");
}

void house(Trial& trial, int storeys) {
    const House house(storeys, 0.7);
    Run run = trial.start(house.cards().scene);
    const Survival result = survive(run, house.cards().stones, kSeconds, kLength / 4);
    trial.expectAtLeast("stands", result.time, kSeconds, "s");
    trial.expectAtMost("largest move", result.moved, kThickness / 10, "m");
}

}  // namespace

void addCardCases(Family& family) {
    family.cases.push_back({"limit analysis of cards",
                            [](Trial& trial) {
                                const double exact = (std::tan(kLean) - kThickness / kLength) / 2;
                                trial.expectNear("critical mu of two", limitFriction(1), exact, 0.001, "1");
                                trial.expectNear("five storeys stand", House(5, 0.7).cards().limit.stands(0.7), 1, 0,
                                                 "1");
                            },
                            Kind::ragtopOnly});
    family.cases.push_back({"two cards, mu=0.3", [](Trial& trial) {
                                const Survival result = simulateFrame(trial, 0.3);
                                trial.expectAtLeast("stands", result.time, kSeconds, "s");
                                trial.expectAtMost("largest move", result.moved, kThickness / 10, "m");
                            }});
    family.cases.push_back({"two cards", criticalFriction, Kind::oneStep});
    for (const int storeys : {1, 3, 5})
        family.cases.push_back(
            {fmt::format("house of cards, {} storeys", storeys), [storeys](Trial& trial) { house(trial, storeys); }});
}

}  // namespace ragtop::stability
