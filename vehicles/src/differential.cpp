#include "differential.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "point_body.h"

namespace ragtop {
namespace {

float meanSpeed(const std::vector<int>& wheels, std::span<const float> spin) {
    float sum = 0;
    for (const int i : wheels) sum += spin[static_cast<std::size_t>(i)];
    return sum / static_cast<float>(wheels.size());
}

/// Change of the mean speed by a unit impulse that is shared evenly.
float inverseInertiaOf(const std::vector<int>& wheels, std::span<const float> inertia) {
    float sum = 0;
    for (const int i : wheels) sum += 1 / inertia[static_cast<std::size_t>(i)];
    const auto count = static_cast<float>(wheels.size());
    return sum / (count * count);
}

void turn(const std::vector<int>& wheels, std::span<const float> inertia, float impulse, std::span<float> spin) {
    const float each = impulse / static_cast<float>(wheels.size());
    for (const int i : wheels) {
        const auto w = static_cast<std::size_t>(i);
        spin[w] += each / inertia[w];
    }
}

constexpr float kAll = std::numeric_limits<float>::infinity();

float boundOf(const DifferentialRow& row, const DifferentialLoad& load) {
    const DifferentialDef& def = row.def;
    const float through = 0.5f * row.share * std::abs(load.torque);
    switch (def.type) {
        case DifferentialType::limitedSlip: {
            const float ratio = load.driven ? def.lockingRatio : def.coastLockingRatio.value_or(def.lockingRatio);
            return 0.5f * load.h * def.preload + ratio * through;
        }
        case DifferentialType::helical:
            return (def.torqueBias - 1) / (def.torqueBias + 1) * through;
        case DifferentialType::active:
            return load.h * load.lock * def.activeTorque;
        default:
            return kAll;
    }
}

}  // namespace

std::vector<DifferentialRow> differentialRows(const VehicleDef& def) {
    float total = 0;
    for (const WheelDef& wheel : def.wheels) total += wheel.driveShare;
    std::vector<DifferentialRow> rows;
    std::vector<DifferentialRow> axles;  // `first` holds the wheels of an axle
    for (unsigned axle = 0; axle < 256; ++axle) {
        DifferentialRow whole{.def = def.centerDifferential, .first = {}, .second = {}, .share = 0};
        for (std::size_t i = 0; i < def.wheels.size(); ++i) {
            if (def.wheels[i].axle != axle || !(def.wheels[i].driveShare > 0)) continue;
            whole.first.push_back(static_cast<int>(i));
            whole.share += def.wheels[i].driveShare / total;
        }
        if (!whole.first.empty()) axles.push_back(whole);
    }
    if (def.differential.type != DifferentialType::open) {
        for (const DifferentialRow& axle : axles) {
            for (std::size_t i = 1; i < axle.first.size(); ++i) {
                rows.push_back({def.differential, {axle.first[i - 1]}, {axle.first[i]}, axle.share});
            }
        }
    }
    if (def.centerDifferential.type != DifferentialType::open) {
        for (std::size_t i = 1; i < axles.size(); ++i) {
            rows.push_back({def.centerDifferential, axles[i - 1].first, axles[i].first, 1});
        }
    }
    return rows;
}

float solveDifferential(const DifferentialRow& row, std::span<const float> inertia, std::span<const float> held,
                        const DifferentialLoad& load, float& impulse, std::span<float> spin) {
    const float bound = boundOf(row, load);
    float give = 0;  // of the speeds, per impulse
    if (row.def.type == DifferentialType::viscous) give = 1 / std::max(load.h * row.def.viscosity, 1e-12f);
    const float difference = meanSpeed(row.second, spin) - meanSpeed(row.first, spin);
    const float K = inverseInertiaOf(row.first, held) + inverseInertiaOf(row.second, held) + give;
    const float added = addBounded(impulse, (difference - give * impulse) / K, -bound, bound);
    applyDifferential(row, inertia, added, spin);
    return added;
}

double lossOf(const DifferentialRow& row, float impulse, std::span<const float> meanSpin) {
    return static_cast<double>(impulse) *
           static_cast<double>(meanSpeed(row.second, meanSpin) - meanSpeed(row.first, meanSpin));
}

void applyDifferential(const DifferentialRow& row, std::span<const float> inertia, float impulse,
                       std::span<float> spin) {
    turn(row.first, inertia, impulse, spin);
    turn(row.second, inertia, -impulse, spin);
}

}  // namespace ragtop
