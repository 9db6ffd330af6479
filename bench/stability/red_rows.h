#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "trial.h"

namespace ragtop::stability {

/// A row of Ragtop's that fails, named "family/row".
struct RedRow {
    std::string_view name;
    double off;  ///< its value from its reference, as it is known
};

/// docs/stability.md says what is known of the cause. They run and are told like all others. One that comes to hold is
/// to leave this list with the change that cures it.
inline constexpr RedRow kRedRows[] = {
    {"restitution/cradle, 1 mm gap, k=1: the last one's reach", 0.022},
    {"restitution/cradle, 1 mm gap, k=2: the others move", 0.025},
    {"restitution/cradle, 1 mm gap, k=2: the last one's reach", 0.021},
    {"restitution/cradle, 1 mm gap, k=3: the others move", 0.05},
    {"restitution/cradle, 1 mm gap, k=3: the last one's reach", 0.023},
    {"restitution/cradle, 1 mm gap, k=4: the others move", 0.05},
    {"restitution/cradle, touching, k=1: the last one's reach", 0.022},
    {"restitution/cradle, touching, k=2: the last one's reach", 0.023},
    {"restitution/cradle, touching, k=3: the others move", 0.025},
    {"restitution/cradle, touching, k=4: the others move", 0.025},
    {"wall/10 x 20 bricks, unhit: largest move", 0.015},
    {"wall/hit, 8 runs: energy gained at any time", 0.0066},
    {"chain/20 links, 10000:1, swings out of the plane: stay closed, of 8", 5},
    {"chain/20 links, 10000:1, swings out of the plane: gap", 0.0049},
    {"chain/20 links, 10000:1, swings out of the plane: energy lost in 5 s", 1.2},
    {"chain/40 links, 10000:1, swings out of the plane: stay closed, of 8", 6},
    {"chain/40 links, 10000:1, swings out of the plane: gap", 0.0042},
    {"chain/40 links, 10000:1, swings out of the plane: energy lost in 5 s", 1.7},
    {"chain/100 links, 10000:1, swings out of the plane: stay closed, of 8", 8},
    {"chain/100 links, 10000:1, swings out of the plane: gap", 0.005},
    {"chain/100 links, 10000:1, swings out of the plane: energy lost in 5 s", 3},
    {"joint_states/200 of polygon anywhere, two bodies: energy gained", 0.005},
    {"joint_states/200 of polygon anywhere, two bodies: joints that gain", 1},
    {"joint_states/200 of hinge with soft stops anywhere, two bodies: energy gained, in pressed stops too", 0.0015},
    {"joint_states/200 of slider with soft stops, two bodies: energy gained, in pressed stops too", 0.0077},
    {"joint_states/200 of slider with soft stops anywhere, two bodies: energy gained, in pressed stops too", 0.009},
    {"joint_states/200 of cone with soft stops, a body and the world: energy gained, in pressed stops too", 0.022},
    {"joint_states/200 of cone with soft stops anywhere, a body and the world: energy gained, in pressed stops too",
     0.067},
    {"joint_states/200 of cone with soft stops, two bodies: energy gained, in pressed stops too", 0.042},
    {"joint_states/200 of cone with soft stops anywhere, two bodies: energy gained, in pressed stops too", 0.09},
    {"joint_states/200 of twist with soft stops, a body and the world: energy gained, in pressed stops too", 0.065},
    {"joint_states/200 of twist with soft stops anywhere, a body and the world: energy gained, in pressed stops too",
     0.15},
    {"joint_states/200 of twist with soft stops, two bodies: energy gained, in pressed stops too", 0.087},
    {"joint_states/200 of twist with soft stops anywhere, two bodies: energy gained, in pressed stops too", 0.29},
    {"joint_states/limit of a spring of a hinge: most that it gives, over its limit", 0.24},
    {"joint_states/limit of a spring of a slider: most that it gives, over its limit", 0.25},
    {"joint_states/limit of a spring of a ball: most that it gives, over its limit", 0.18},
    {"nonconvex/chain of 12 tori, the last 10 times as heavy: links apart beyond taut", 0.0107},
    {"overlap/0.9 m in a box: off its rest after 0.5 s", 0.049},
};

/// Whether one of them is of this "family/case".
inline bool hasRedRow(std::string_view name) {
    return std::ranges::any_of(kRedRows, [name](const RedRow& red) {
        return red.name.starts_with(name) && red.name.substr(name.size()).starts_with(": ");
    });
}

/// Null for a row that has to hold.
inline const RedRow* redRowOf(const Row& row) {
    const auto isIt = [name = row.family + "/" + row.name](const RedRow& red) { return red.name == name; };
    const auto* const found = std::ranges::find_if(kRedRows, isIt);
    return row.engine == "ragtop" && found != std::end(kRedRows) ? found : nullptr;
}

/// Whether it is more than twice as far off as is known, or nowhere: many of these values are the worst of random
/// states, and move by as much as that whenever a digit changes.
inline bool isWorse(const Row& row, const RedRow& red) { return !(std::abs(row.value - row.reference) <= 2 * red.off); }

}  // namespace ragtop::stability
