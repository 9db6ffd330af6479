#include "ragtop/vehicle_def.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "axle_linkage.h"
#include "carriers.h"
#include "chassis.h"
#include "suspension.h"

namespace ragtop {
namespace {

std::string text(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.7g", value);
    return digits;
}

struct Probe {
    template <class T>
    void operator()(const Tunable&, T&) const {}
};

template <class T>
concept HasFields = requires(Probe& probe, const T& value) {
    describe(probe, value, &value);
};

/// Visits a definition down to its numbers and keeps the first complaint. Fields are named by their path in a file.
class RangeCheck {
public:
    explicit RangeCheck(std::string path) : path_(std::move(path)) {}

    template <class T>
    void operator()(const Tunable& tunable, const T& value) {
        if (why_.empty()) check(path_ + "/" + std::string(tunable.name), tunable, value);
    }
    const std::string& why() const { return why_; }

private:
    template <class T>
    void check(const std::string& path, const Tunable& tunable, const T& value) {
        if constexpr (std::is_arithmetic_v<T>) {
            checkNumber(path, tunable, static_cast<double>(value));
        } else if constexpr (std::is_same_v<T, Vec3>) {
            checkNumber(path + "/0", tunable, static_cast<double>(value.x));
            if (why_.empty()) checkNumber(path + "/1", tunable, static_cast<double>(value.y));
            if (why_.empty()) checkNumber(path + "/2", tunable, static_cast<double>(value.z));
        } else if constexpr (std::is_same_v<T, Frame>) {
            checkFrame(path, value);
        } else if constexpr (std::is_same_v<T, Shape>) {
            checkShape(path, value);
        } else if constexpr (HasFields<T>) {
            RangeCheck inner(path);
            describe(inner, value, &value);
            why_ = inner.why_;
        } else if constexpr (requires {
                                 typename T::value_type;
                                 value.has_value();
                             }) {
            if (value) check(path, tunable, *value);
        } else if constexpr (requires {
                                 typename T::value_type;
                                 value.capacity();
                             } &&
                             !std::is_same_v<T, std::string>) {
            for (std::size_t i = 0; i < value.size() && why_.empty(); ++i) {
                check(path + "/" + std::to_string(i), tunable, value[i]);
            }
        }
    }

    void checkNumber(const std::string& path, const Tunable& tunable, double value) {
        // Bounds are decimal, values single precision: 1e-4f must pass as 1e-4.
        const double slack = 1e-6;
        const double lower = tunable.minimum - slack * std::abs(tunable.minimum);
        const double upper = tunable.maximum + slack * std::abs(tunable.maximum);
        if (value >= lower && value <= upper && std::isfinite(value)) return;
        const std::string unit = tunable.unit.empty() || tunable.unit == "1" ? "" : " " + std::string(tunable.unit);
        why_ = path + " is " + text(value) + unit + ", must be in [" + text(tunable.minimum) + ", " +
               text(tunable.maximum) + "]";
    }

    void checkFrame(const std::string& path, const Frame& frame) {
        const Quat& q = frame.rotation;
        const float norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
        if (!isFinite(frame.position)) {
            why_ = path + "/position is not finite, must be";
        } else if (!(std::abs(norm - 1) < 1e-3f)) {
            why_ = path + "/rotation has length " + text(std::sqrt(static_cast<double>(norm))) + ", must be 1";
        }
    }

    void checkShape(const std::string& path, const Shape& shape) {
        if (std::holds_alternative<TriangleMesh>(shape) || std::holds_alternative<HeightField>(shape) ||
            std::holds_alternative<Compound>(shape)) {
            why_ = path + " is a mesh, height field or compound, must be a box, sphere, capsule or hull";
        } else if (const std::string inner = ragtop::whyInvalid(shape); !inner.empty()) {
            why_ = path + ": " + inner;
        }
    }

    std::string path_, why_;
};

std::string whyInvalid(const EngineDef& engine) {
    const auto& curve = engine.torqueCurve;
    if (curve.empty()) return "/engine/torqueCurve is empty, must have a point";
    for (std::size_t i = 1; i < curve.size(); ++i) {
        if (curve[i].rpm > curve[i - 1].rpm) continue;
        return "/engine/torqueCurve/" + std::to_string(i) + "/rpm is " + text(static_cast<double>(curve[i].rpm)) +
               ", must be above the point before, " + text(static_cast<double>(curve[i - 1].rpm));
    }
    if (!(engine.limiterRpm > engine.idleRpm)) {
        return "/engine/limiterRpm is " + text(static_cast<double>(engine.limiterRpm)) + ", must be above idleRpm, " +
               text(static_cast<double>(engine.idleRpm));
    }
    return {};
}

std::string whyInvalid(const std::vector<ConverterPoint>& map) {
    if (map.size() < 2) return " has " + std::to_string(map.size()) + " points, must have 2 or more";
    const auto number = [](float value) { return text(static_cast<double>(value)); };
    for (std::size_t i = 0; i < map.size(); ++i) {
        const std::string point = "/" + std::to_string(i),
                          ratio = point + "/speedRatio is " + number(map[i].speedRatio);
        if (i == 0 && map[i].speedRatio != 0) return ratio + ", must be 0 in the first point";
        if (i > 0 && !(map[i].speedRatio > map[i - 1].speedRatio))
            return ratio + ", must be above the point before, " + number(map[i - 1].speedRatio);
        if (i + 1 == map.size() && map[i].speedRatio != 1) return ratio + ", must be 1 in the last point";
        const float most = map[i].speedRatio > 0 ? 1 / map[i].speedRatio : 100;
        if (map[i].torqueRatio > (1 + 1e-6f) * most) {
            return point + "/torqueRatio is " + number(map[i].torqueRatio) + ", must be at most 1 over speedRatio, " +
                   number(most) + ", as power does not grow";
        }
    }
    if (map.back().capacity == 0) return {};
    return "/" + std::to_string(map.size() - 1) + "/capacity is " + number(map.back().capacity) +
           ", must be 0 where speeds are equal";
}

std::string whyInvalid(const GearboxDef& gearbox) {
    if (gearbox.ratios.empty()) return "/gearbox/ratios is empty, must have a gear";
    for (std::size_t i = 1; i < gearbox.ratios.size(); ++i) {
        if (gearbox.ratios[i] < gearbox.ratios[i - 1]) continue;
        return "/gearbox/ratios/" + std::to_string(i) + " is " + text(static_cast<double>(gearbox.ratios[i])) +
               ", must be below the gear before, " + text(static_cast<double>(gearbox.ratios[i - 1]));
    }
    if (gearbox.continuous && gearbox.ratios.size() < 2)
        return "/gearbox/ratios has 1 ratio, must have 2 or more where continuous is true";
    if (std::string why = whyInvalid(gearbox.converterMap); !why.empty()) return "/gearbox/converterMap" + why;
    if (!(gearbox.shiftUpRpm > gearbox.shiftDownRpm)) {
        return "/gearbox/shiftUpRpm is " + text(static_cast<double>(gearbox.shiftUpRpm)) +
               ", must be above shiftDownRpm, " + text(static_cast<double>(gearbox.shiftDownRpm));
    }
    return {};
}

std::string whyInvalid(const VehicleVisualDef& visual, std::size_t wheels) {
    const std::size_t nodes = visual.wheelNodes.size();
    if (visual.chassis.empty()) return "/visual/chassis is empty, must name a model file";
    if (nodes > 0 && !visual.wheel.empty())
        return "/visual/wheelNodes has names, must be empty where wheel names a file";
    if (nodes > 0 && nodes != wheels) {
        return "/visual/wheelNodes has " + std::to_string(nodes) + " names, must have one for each of the " +
               std::to_string(wheels) + " wheels, or none";
    }
    return {};
}

/// Where shapes are, in m; as far as wheels may be.
constexpr float kFarthest = 1e4f;

std::string whyInvalid(const ChassisDef& chassis) {
    if (chassis.shapes.empty()) return "/chassis/shapes is empty, must have a shape";
    for (std::size_t i = 0; i < chassis.shapes.size(); ++i) {
        const Vec3 far = abs(chassis.shapes[i].frame.position);
        if (std::max({far.x, far.y, far.z}) <= kFarthest) continue;
        return "/chassis/shapes/" + std::to_string(i) + "/frame/position is not within " +
               text(static_cast<double>(kFarthest)) + " m, must be";
    }
    return {};
}

/// What the world would say of the body.
std::string whyNoBody(const VehicleDef& def) {
    const std::string why = whyInvalid(chassisBody(def, {}));
    return why.empty() ? why : "/chassis: " + why;
}

std::string whyUnbalanced(const VehicleDef& def) {
    const MassProperties mass = chassisMass(def.chassis);
    std::vector<Vec3> positions;
    for (const WheelDef& wheel : def.wheels) positions.push_back(wheel.position - mass.center);
    const std::vector<float> shares = staticLoads(positions, 1);
    if (shares.empty()) return "/wheels stand in a line, must span an area";
    for (std::size_t i = 0; i < shares.size(); ++i) {
        if (shares[i] > 0) continue;
        return "/wheels/" + std::to_string(i) + "/position makes the wheel carry " +
               text(static_cast<double>(shares[i])) +
               " of the weight, must be above 0: the centre of mass has to be between the wheels";
    }
    return {};
}

std::string whyInvalid(const VehicleDef& def, const AxleLiftDef& lift, std::size_t i) {
    const std::string axle = "/aerodynamics/axleLifts/" + std::to_string(i) + "/axle is " + std::to_string(lift.axle);
    const auto has = [&](const WheelDef& wheel) { return wheel.axle == lift.axle; };
    if (std::none_of(def.wheels.begin(), def.wheels.end(), has))
        return axle + ", which has no wheels, must be one that has";
    const auto& lifts = def.aerodynamics.axleLifts;
    const auto same = [&](const AxleLiftDef& other) { return other.axle == lift.axle; };
    const auto end = lifts.begin() + static_cast<std::ptrdiff_t>(i);
    return std::any_of(lifts.begin(), end, same) ? axle + ", must be that of no other" : std::string();
}

std::string whyInvalid(const std::vector<DamperPoint>& curve, const std::string& path) {
    for (std::size_t i = 1; i < curve.size(); ++i) {
        const DamperPoint &before = curve[i - 1], &now = curve[i];
        const std::string point = path + "/" + std::to_string(i);
        if (!(now.speed > before.speed)) {
            return point + "/speed is " + text(static_cast<double>(now.speed)) + ", must be above the point before, " +
                   text(static_cast<double>(before.speed));
        }
        if (!(now.force >= before.force)) {
            return point + "/force is " + text(static_cast<double>(now.force)) +
                   ", must not be below the point before, " + text(static_cast<double>(before.force));
        }
    }
    return {};
}

std::string whyInvalid(const VehicleDef& def, const AntiRollBarDef& bar, std::size_t i) {
    const std::string axle = "/antiRollBars/" + std::to_string(i) + "/axle is " + std::to_string(bar.axle);
    const auto wheels = std::count_if(def.wheels.begin(), def.wheels.end(),
                                      [&](const WheelDef& wheel) { return wheel.axle == bar.axle; });
    if (wheels != 2) return axle + ", which has " + std::to_string(wheels) + " wheels, must be one of 2";
    const auto end = def.antiRollBars.begin() + static_cast<std::ptrdiff_t>(i);
    const auto same = [&](const AntiRollBarDef& other) { return other.axle == bar.axle; };
    return std::any_of(def.antiRollBars.begin(), end, same) ? axle + ", must be that of no other" : std::string();
}

std::string whyInvalid(const TireDef& tire, const std::string& path) {
    if (!tire.file.empty()) return path + "/file is " + tire.file + ", must be read before (loadVehicle)";
    if (tire.magicFormula && tire.slipCurves)
        return path + "/slipCurves is given, must be absent where magicFormula is given";
    if (!tire.slipCurves) return {};
    for (const auto& [curve, name] :
         {std::pair{&tire.slipCurves->longitudinal, "longitudinal"}, std::pair{&tire.slipCurves->lateral, "lateral"}}) {
        if (curve->slideSlip > curve->peakSlip) continue;
        return path + "/slipCurves/" + name + "/slideSlip is " + text(static_cast<double>(curve->slideSlip)) +
               ", must be above peakSlip, " + text(static_cast<double>(curve->peakSlip));
    }
    return {};
}

std::string whyInvalid(const WheelDef& wheel, std::size_t i) {
    const std::string suspension = "/wheels/" + std::to_string(i) + "/suspension";
    for (const auto& [curve, name] : {std::pair{&wheel.suspension.compressionCurve, "/compressionCurve"},
                                      std::pair{&wheel.suspension.reboundCurve, "/reboundCurve"}}) {
        if (std::string why = whyInvalid(*curve, suspension + name); !why.empty()) return why;
    }

    const auto& surfaces = wheel.tire.surfaces;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
        const auto same = [&](const TireSurface& other) { return other.surface == surfaces[k].surface; };
        if (std::none_of(surfaces.begin(), surfaces.begin() + static_cast<std::ptrdiff_t>(k), same)) continue;
        return "/wheels/" + std::to_string(i) + "/tire/surfaces/" + std::to_string(k) + "/surface is " +
               std::to_string(surfaces[k].surface) + ", must be that of no other";
    }
    if (std::string why = whyInvalid(wheel.tire, "/wheels/" + std::to_string(i) + "/tire"); !why.empty()) return why;
    const Vec3& axis = wheel.suspension.axis;
    if (axis.y > 0.5f * length(axis)) return {};
    return suspension + "/axis is (" + text(static_cast<double>(axis.x)) + ", " + text(static_cast<double>(axis.y)) +
           ", " + text(static_cast<double>(axis.z)) + "), must be within 60° of (0, 1, 0)";
}

}  // namespace

std::string whyInvalid(const VehicleDef& def) {
    RangeCheck check("");
    describe(check, def, &def);
    if (!check.why().empty()) return check.why();
    if (std::string why = whyInvalid(def.chassis); !why.empty()) return why;
    if (def.wheels.size() < 3) {
        return "/wheels has " + std::to_string(def.wheels.size()) + " wheels, must have 3 or more";
    }
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        if (std::string why = whyInvalid(def.wheels[i], i); !why.empty()) return why;
    }
    for (std::size_t i = 0; i < def.antiRollBars.size(); ++i) {
        if (std::string why = whyInvalid(def, def.antiRollBars[i], i); !why.empty()) return why;
    }
    for (std::size_t i = 0; i < def.linkages.size(); ++i) {
        if (std::string why = whyInvalid(def, def.linkages[i], i); !why.empty()) return why;
    }
    for (std::size_t i = 0; i < def.aerodynamics.axleLifts.size(); ++i) {
        if (std::string why = whyInvalid(def, def.aerodynamics.axleLifts[i], i); !why.empty()) return why;
    }
    if (std::string why = whyInvalid(def.engine); !why.empty()) return why;
    if (std::string why = whyInvalid(def.gearbox); !why.empty()) return why;
    if (def.visual) {
        if (std::string why = whyInvalid(*def.visual, def.wheels.size()); !why.empty()) return why;
    }
    if (std::string why = whyNoBody(def); !why.empty()) return why;
    if (std::string why = whyUnbalanced(def); !why.empty()) return why;
    return def.level == VehicleLevel::linkages ? whyNoCarriers(def) : std::string();
}

}  // namespace ragtop
