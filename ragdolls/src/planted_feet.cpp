#include "planted_feet.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "inertia.h"

namespace ragtop {
namespace {

constexpr float kStandsBelow = 0.04f;   ///< of the height of the hips, over the ground
constexpr float kStandsSlower = 0.12f;  ///< of √(g height)
constexpr float kGoesOn = 2;            ///< times as fast and high may be what stands still a moment before or later
constexpr float kClearance = 0.015f;    ///< of the height of the hips, that a foot that swings is over the ground
constexpr float kEase = 0.1f;           ///< s, within which it gets there
constexpr float kShortest = 0.06f;      ///< s: shorter stances and pauses between them are none

/// What is low and slow, and what goes on from there somewhat higher and faster: feet roll off.
std::vector<bool> standing(const std::vector<Vec3>& way, float ground, float height, float rate) {
    const float low = kStandsBelow * height, slow = kStandsSlower * std::sqrt(kGravity * height);
    std::vector<float> share(way.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
        const std::size_t before = i > 0 ? i - 1 : i, after = i + 1 < way.size() ? i + 1 : i;
        const float speed =
            length(way[after] - way[before]) * rate / static_cast<float>(std::max(after - before, std::size_t{1}));
        share[i] = std::max((way[i].y - ground) / low, speed / slow);
    }
    std::vector<bool> stands(way.size(), false);
    for (std::size_t i = 0; i < way.size();) {
        std::size_t end = i;
        float least = kGoesOn;
        for (; end < way.size() && share[end] < kGoesOn; ++end) least = std::min(least, share[end]);
        if (least < 1)
            std::fill(stands.begin() + static_cast<std::ptrdiff_t>(i),
                      stands.begin() + static_cast<std::ptrdiff_t>(end), true);
        i = end + 1;
    }
    return stands;
}

/// Runs of `value` shorter than that, not at either end, become the other.
void dropShort(std::vector<bool>& stands, bool value, std::size_t shortest) {
    for (std::size_t i = 0; i < stands.size();) {
        std::size_t end = i;
        while (end < stands.size() && stands[end] == stands[i]) ++end;
        if (stands[i] == value && end - i < shortest && i > 0 && end < stands.size())
            for (std::size_t k = i; k < end; ++k) stands[k] = !value;
        i = end;
    }
}

/// Of what stands at two moments: the mean of its points.
Vec3 moved(const FootWay& way, const Stances& stances, std::size_t from, std::size_t to) {
    const bool heel = stances.heel[from] && stances.heel[to], ball = stances.ball[from] && stances.ball[to];
    const Vec3 byHeel = way.heel[to] - way.heel[from], byBall = way.ball[to] - way.ball[from];
    if (heel == ball) return 0.5f * (byHeel + byBall);
    return heel ? byHeel : byBall;
}

float lowestOf(const FootWay& way, std::size_t i) { return std::min(way.heel[i].y, way.ball[i].y); }

/// Within one stance.
void hold(const FootWay& way, const Stances& stances, const Stances::Stance& stance, float ground,
          std::vector<Vec3>& offsets) {
    const auto first = static_cast<std::size_t>(stance.first), last = static_cast<std::size_t>(stance.last);
    Vec3 level, mean;
    for (std::size_t i = first; i <= last; ++i) {
        if (i > first) level = level - moved(way, stances, i - 1, i);
        level.y = 0;
        offsets[i] = level;
        mean += (1.0f / static_cast<float>(last - first + 1)) * level;
    }
    for (std::size_t i = first; i <= last; ++i) {
        offsets[i] = offsets[i] - mean;
        offsets[i].y = ground - lowestOf(way, i);
    }
}

/// What swings is over the ground, the more the longer ago and the longer until it stands.
void clear(const FootWay& way, const Stances& stances, float ground, float height, float rate,
           std::vector<Vec3>& offsets) {
    std::vector<float> since(offsets.size(), 1.0f);
    const float each = 1 / (kEase * rate);
    for (const Stances::Stance& stance : stances.all)
        for (int i = 0; i < static_cast<int>(since.size()); ++i) {
            const int away = std::max({stance.first - i, i - stance.last, 0});
            since[static_cast<std::size_t>(i)] =
                std::min(since[static_cast<std::size_t>(i)], each * static_cast<float>(away));
        }
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const float share = since[i] * (2 - since[i]), least = share * kClearance * height + ground - lowestOf(way, i);
        const float ofTip = share * (kClearance * height + ground - way.tip[i].y);
        offsets[i].y = std::max({offsets[i].y, least, share > 0 ? ofTip : least});
    }
}

}  // namespace

Stances stancesOf(const FootWay& way, float ground, float height, float rate) {
    Stances stances;
    const auto shortest = static_cast<std::size_t>(std::lround(kShortest * rate));
    for (const auto& [points, stands] : {std::pair{&way.heel, &stances.heel}, std::pair{&way.ball, &stances.ball}}) {
        *stands = standing(*points, ground, height, rate);
        dropShort(*stands, false, shortest);
        dropShort(*stands, true, shortest);
    }
    for (std::size_t i = 0; i < way.heel.size(); ++i) {
        if (!stances.heel[i] && !stances.ball[i]) continue;
        const int at = static_cast<int>(i);
        if (stances.all.empty() || stances.all.back().last + 1 < at) stances.all.push_back({at, at});
        stances.all.back().last = at;
    }
    return stances;
}

std::vector<Vec3> heldOffsets(const FootWay& way, const Stances& stances, float ground, float height, float rate) {
    std::vector<Vec3> offsets(way.heel.size());
    for (const Stances::Stance& stance : stances.all) hold(way, stances, stance, ground, offsets);
    const auto at = [&](int moment) -> Vec3& { return offsets[static_cast<std::size_t>(moment)]; };
    int done = -1;  // moments up to it have their offset
    Vec3 last;
    const auto blendTo = [&](int next, const Vec3& to) {
        for (int i = done + 1; i < next; ++i) {
            const float share = static_cast<float>(i - done) / static_cast<float>(next - done);
            at(i) = last + (share * share * (3 - 2 * share)) * (to - last);
        }
    };
    for (const Stances::Stance& stance : stances.all) {
        if (done < 0) last = at(stance.first);
        blendTo(stance.first, at(stance.first));
        done = stance.last;
        last = at(done);
    }
    blendTo(static_cast<int>(offsets.size()), last);
    clear(way, stances, ground, height, rate, offsets);
    return offsets;
}

std::vector<float> lowest(const std::array<FootWay, 2>& ways) {
    std::vector<float> heights;
    for (std::size_t i = 0; i < ways[0].heel.size(); ++i)
        heights.push_back(std::min(lowestOf(ways[0], i), lowestOf(ways[1], i)));
    return heights;
}

Vec3 groundVelocity(const std::array<FootWay, 2>& ways, float height, float rate) {
    const std::array<const std::vector<Vec3>*, 4> points{&ways[0].heel, &ways[0].ball, &ways[1].heel, &ways[1].ball};
    std::vector<float> along, across;
    for (std::size_t i = 0; i + 1 < ways[0].heel.size(); ++i) {
        const auto& low = **std::min_element(points.begin(), points.end(),
                                             [&](const auto* a, const auto* b) { return (*a)[i].y < (*b)[i].y; });
        along.push_back(rate * (low[i + 1].z - low[i].z));
        across.push_back(rate * (low[i + 1].x - low[i].x));
    }
    if (along.empty()) return {};
    for (auto* each : {&along, &across})
        std::nth_element(each->begin(), each->begin() + static_cast<std::ptrdiff_t>(each->size() / 2), each->end());
    const Vec3 velocity{across[across.size() / 2], 0, along[along.size() / 2]};
    return length(velocity) > kStandsSlower * std::sqrt(kGravity * height) ? velocity : Vec3{};
}

FootWay onGround(FootWay way, const Vec3& velocity, float rate) {
    for (auto* points : {&way.heel, &way.ball, &way.tip})
        for (std::size_t i = 0; i < points->size(); ++i)
            (*points)[i] = (*points)[i] - (static_cast<float>(i) / rate) * velocity;
    return way;
}

std::vector<float> smoothed(std::span<const float> values, int window) {
    std::vector<float> mean(values.size());
    const int count = static_cast<int>(values.size());
    for (int i = 0; i < count; ++i) {
        float sum = 0, weights = 0;
        for (int k = -window; k <= window; ++k) {
            const float weight = static_cast<float>(window + 1 - std::abs(k));
            sum += weight * values[static_cast<std::size_t>(std::clamp(i + k, 0, count - 1))];
            weights += weight;
        }
        mean[static_cast<std::size_t>(i)] = sum / weights;
    }
    return mean;
}

std::vector<float> smoothAbove(std::span<const float> wanted, int window) {
    std::vector<float> most(wanted.begin(), wanted.end());
    const int count = static_cast<int>(wanted.size());
    for (int i = 0; i < count; ++i)
        for (int k = std::max(0, i - window); k <= std::min(count - 1, i + window); ++k)
            most[static_cast<std::size_t>(i)] =
                std::max(most[static_cast<std::size_t>(i)], wanted[static_cast<std::size_t>(k)]);
    return smoothed(most, window);
}

}  // namespace ragtop
