#include "spring_plan.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr int kLanes = SpringGroup::kLanes;

struct Place {
    const SpringChain* chain = nullptr;
    Vec3 weight{};
    int level = 0;     ///< spring bones above
    int carrier = -1;  ///< bone of the nearest one above
    int number = -1;   ///< group · kLanes + lane
};

void fill(SpringGroup& group, int lane, const Place& place, std::span<const Place> places) {
    const SpringChain& chain = *place.chain;
    const float rate = 2 * kPi * chain.frequency, reach = length(place.weight);
    const SinCos sag = sinCos(chain.sag);
    group.roots = place.carrier < 0;
    if (!group.roots)
        group.carrier[static_cast<std::size_t>(lane)] = places[static_cast<std::size_t>(place.carrier)].number;
    group.from.set(lane, {});
    group.to.set(lane, {});
    group.axis.set(lane, normalized(place.weight));
    group.length[lane] = reach;
    group.radius[lane] = chain.radius;
    group.stiffness[lane] = rate * rate;
    group.damping[lane] = 2 * chain.dampingRatio * rate;
    group.sag[lane] = rate * rate * sag.sin / sag.cos;
    group.inertia[lane] = chain.inertia / reach;
    group.leastCosine[lane] = sinCos(chain.swingLimit).cos;
}

}  // namespace

SpringPlan planOf(const SpringBonesDef& def, const Skeleton& skeleton) {
    SpringPlan plan;
    const Bounds bounds = boundsOf(skeleton);
    plan.size = length(bounds.upper - bounds.lower);
    std::vector<Place> places(skeleton.bones.size());
    for (const SpringChain& chain : def.chains) {
        const std::vector<int> bones = bonesOf(chain, skeleton);
        for (std::size_t i = 0; i < bones.size(); ++i) {
            Place& place = places[static_cast<std::size_t>(bones[i])];
            place.chain = &chain;
            place.weight = weightOf(chain, bones, i, skeleton);
        }
        // Force and stiffness of a bone that hangs as gravity and spring want it are ω² √(1 + tan²(sag)).
        plan.quickest = std::max(plan.quickest, 2 * kPi * chain.frequency / std::sqrt(sinCos(chain.sag).cos));
    }
    std::vector<std::vector<int>> levels;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const int parent = skeleton.bones[i].parent;
        if (parent >= 0) {
            const Place& above = places[static_cast<std::size_t>(parent)];
            places[i].carrier = above.chain ? parent : above.carrier;
            places[i].level = above.level + (above.chain ? 1 : 0);
        }
        if (!places[i].chain) continue;
        levels.resize(std::max(levels.size(), static_cast<std::size_t>(places[i].level) + 1));
        levels[static_cast<std::size_t>(places[i].level)].push_back(static_cast<int>(i));
    }
    for (std::vector<int>& level : levels) {
        const auto order = [&](int bone) {
            const int carrier = places[static_cast<std::size_t>(bone)].carrier;
            return std::pair{carrier < 0 ? -1 : places[static_cast<std::size_t>(carrier)].number, bone};
        };
        std::sort(level.begin(), level.end(), [&](int a, int b) { return order(a) < order(b); });
        for (std::size_t i = 0; i < level.size(); i += kLanes) {
            SpringGroup& group = plan.groups.emplace_back();
            for (int lane = 0; lane < kLanes; ++lane) {
                // Lanes that are left over do as the last one does.
                Place& place = places[static_cast<std::size_t>(
                    level[std::min(i + static_cast<std::size_t>(lane), level.size() - 1)])];
                if (place.number < 0) place.number = static_cast<int>(plan.groups.size() - 1) * kLanes + lane;
                fill(group, lane, place, places);
            }
        }
    }
    for (std::size_t i = 0; i < places.size(); ++i)
        if (places[i].chain || places[i].carrier >= 0)
            plan.bones.push_back({static_cast<int>(i), places[i].carrier, places[i].number});
    return plan;
}

}  // namespace ragtop
