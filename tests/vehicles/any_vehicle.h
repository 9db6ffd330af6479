#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "hardpoints.h"

namespace ragtop {

/// Draws definitions of vehicles: each number that is drawn is somewhere in its declared range, often at an end of it.
class AnyVehicle {
public:
    explicit AnyVehicle(unsigned seed) : dice_(seed) {}

    /// A usable definition. Of its numbers none, some or all are the hatchback's; a third of those drawn have linkages,
    /// at any level.
    VehicleDef draw() {
        for (;;) {
            share_ = std::vector<double>{0.02, 0.1, 0.4, 1}[index(4)];
            VehicleDef def = chance(1.0 / 3) ? linked() : hatchback();
            describe(*this, def, static_cast<const VehicleDef*>(nullptr));
            makeOrdered(def);
            if (!def.linkages.empty()) mirrorWheels(def);
            if (whyInvalid(def).empty()) return def;
        }
    }

    std::size_t index(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(dice_); }
    double between(double from, double to) { return std::uniform_real_distribution<double>(from, to)(dice_); }
    bool chance(double share) { return between(0, 1) < share; }

    template <class T>
    void operator()(const Tunable& tunable, T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            if (chance(share_)) value = chance(0.5);
        } else if constexpr (std::is_arithmetic_v<T>) {
            if (chance(share_)) value = static_cast<T>(number(tunable.minimum, tunable.maximum));
        } else if constexpr (std::is_enum_v<T>) {
            if (chance(share_)) value = static_cast<T>(index(enumNames(T{}).size()));
        } else if constexpr (std::is_same_v<T, Vec3>) {
            for (float* part : {&value.x, &value.y, &value.z}) (*this)(tunable, *part);
        } else if constexpr (std::is_same_v<T, Frame>) {
            const Tunable along{"", "m", -1e4, 1e4};
            (*this)(along, value.position);
            const Vec3 axis{1, static_cast<float>(between(-1, 1)), static_cast<float>(between(-1, 1))};
            if (chance(share_)) value.rotation = rotationAbout(axis, static_cast<float>(between(-3, 3)));
        } else if constexpr (std::is_same_v<T, Shape>) {
            drawShape(value);
        } else if constexpr (requires { describe(*this, value, static_cast<const T*>(nullptr)); }) {
            describe(*this, value, static_cast<const T*>(nullptr));
        } else if constexpr (requires { value.has_value(); }) {
            drawOptional(tunable, value);
        } else if constexpr (requires { value.capacity(); } && !std::is_same_v<T, std::string>) {
            for (auto& one : value) (*this)(tunable, one);
        }
    }

private:
    double number(double from, double to) {
        if (chance(0.1)) return from;
        if (chance(0.1)) return to;
        if (from > 0) return std::clamp(std::exp(between(std::log(from), std::log(to))), from, to);
        const double end = from < 0 && chance(0.5) ? from : to;
        return std::clamp(end * std::exp(between(std::log(1e-12), 0)), from, to);
    }
    template <class T>
    void drawOptional(const Tunable& tunable, std::optional<T>& value) {
        if constexpr (!std::is_same_v<T, VehicleVisualDef>) {
            if (!chance(share_)) return;
            value.reset();
            if (chance(0.5)) return;
            value.emplace();
            (*this)(tunable, *value);
        }
    }
    void drawShape(Shape& shape) {
        if (!chance(share_)) return;
        const auto drawn = [&](auto fresh) {
            describe(*this, fresh, static_cast<const decltype(fresh)*>(nullptr));
            shape = fresh;
        };
        switch (index(3)) {
            case 0:
                return drawn(Box{});
            case 1:
                return drawn(Sphere{});
            default:
                return drawn(Capsule{});
        }
    }
    VehicleDef linked() {
        const LinkageDef fronts[] = {frontStruts(), raceWishbones(), parallelWishbones()};
        const LinkageDef rears[] = {rearArms(), beamOnRods()};
        std::vector<LinkageDef> linkages{fronts[index(3)]};
        if (!chance(0.2)) linkages.push_back(rears[index(2)]);
        VehicleDef def = withLinkages(linkages);
        if (linkages.size() > 1 && chance(0.5)) def.level = VehicleLevel::linkages;
        return def;
    }
    /// As those of linkages have to.
    static void mirrorWheels(VehicleDef& def) {
        for (std::size_t i = 0; i + 1 < def.wheels.size(); i += 2) {
            WheelDef &left = def.wheels[i], &right = def.wheels[i + 1];
            left.axle = right.axle = static_cast<unsigned>(i / 2);
            right.position = {-left.position.x, left.position.y, left.position.z};
            right.radius = left.radius;
            right.steerFactor = left.steerFactor;
        }
    }
    /// What has to rise or fall does.
    static void makeOrdered(VehicleDef& def) {
        std::ranges::sort(def.engine.torqueCurve, {}, &TorquePoint::rpm);
        std::ranges::sort(def.gearbox.ratios, std::greater{});
        auto& map = def.gearbox.converterMap;
        std::ranges::sort(map, {}, &ConverterPoint::speedRatio);
        map.front().speedRatio = 0;
        map.back() = {1, 1, 0};
        for (ConverterPoint& p : map) {
            if (p.speedRatio > 0) p.torqueRatio = std::min(p.torqueRatio, 1 / p.speedRatio);
        }
        if (def.engine.limiterRpm < def.engine.idleRpm) std::swap(def.engine.limiterRpm, def.engine.idleRpm);
        if (def.gearbox.shiftUpRpm < def.gearbox.shiftDownRpm)
            std::swap(def.gearbox.shiftUpRpm, def.gearbox.shiftDownRpm);
    }

    std::mt19937 dice_;
    double share_ = 1;
};

}  // namespace ragtop
