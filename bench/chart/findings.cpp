#include "findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace ragtop::chart {
namespace {

const Point* standardOf(const Points& points, const std::string& scene, const std::string& variant) {
    const auto at = std::ranges::find_if(points, [&](const Point& point) {
        return point.scene == scene && point.variant == variant && point.isDefault;
    });
    return at == points.end() || !std::isfinite(at->value) ? nullptr : &*at;
}

std::string row(const std::string& finding, const std::string& variant, const std::string& measured,
                const std::string& law) {
    return fmt::format("| {} | `{}` | {} | {} |\n", finding, variant, measured, law);
}

/// Friction in a pyramid that lies in the cone is 1/√2 of it along the diagonal; in one around it √2 times it.
std::string pyramids(const Points& points) {
    std::string text;
    for (const char* variant : {"mujoco-pyramids", "ode-exact", "ragtop"})
        if (const Point* point = standardOf(points, "stopping-16", variant))
            text += row("Friction in a pyramid depends on the heading", variant,
                        fmt::format("{}: {:+.1f} %", point->quantity, 100 * (point->value / point->reference - 1)),
                        std::string(variant) == "ragtop" ? "0: a cone" : "√2 − 1 in the cone, 1/√2 − 1 around it");
    return text;
}

/// Each soft contact of a stack yields with what rests on it, so that their sum grows with the square.
std::string sag(const Points& points) {
    std::string text;
    for (const char* variant : {"mujoco", "mujoco-pyramids", "ragtop"}) {
        const Point *ten = standardOf(points, "stack-10", variant), *twenty = standardOf(points, "stack-20", variant);
        if (!ten || !twenty) continue;
        text += row("Soft contact sags by n²", variant,
                    fmt::format("10 cubes {:.3g} mm, 20 cubes {:.3g} mm: {:.1f} times", 1000 * ten->value,
                                1000 * twenty->value, twenty->value / ten->value),
                    "4 times");
    }
    return text;
}

/// Fast chains and tops need gyroscopic terms, which explicit steps give energy.
std::string explosions(const Points& points) {
    std::string text;
    for (const char* variant : {"mujoco-trees", "bullet-multibody", "dart", "simbody", "ragtop"})
        for (const char* scene : {"chain-energy", "top"}) {
            std::map<long, bool> holds;  // by rate, finest settings and all
            for (const Point& point : points)
                if (point.scene == scene && point.variant == variant && point.outcome != Outcome::unsupported)
                    holds[std::lround(1 / point.setting.step)] |= point.outcome == Outcome::measured;
            if (holds.empty()) continue;
            std::erase_if(holds, [](const auto& each) { return each.second; });
            std::vector<long> failed;
            for (const auto& [rate, held] : holds) failed.push_back(rate);
            text += row(fmt::format("Explicit steps of reduced coordinates explode: `{}`", scene), variant,
                        failed.empty() ? std::string("holds at every rate")
                                       : fmt::format("no setting holds at {} Hz", fmt::join(failed, ", ")),
                        std::string(variant) == "ragtop" ? "no such term" : "ω × I ω of a step before gives energy");
        }
    return text;
}

/// Of a scene, or of one engine in it.
struct Reason {
    const char *scene, *engine, *text;
};
constexpr Reason kReasons[] = {
    {"chain-planar", "", "reduced coordinates close joints by construction"},
    {"chain-spatial", "", "reduced coordinates close joints by construction"},
    {"chain-energy", "bullet",
     "passes the right number on its way once; its joints are open by a tenth of a link meanwhile"},
    {"chain-energy", "ode", "passes the right number on its way once, as Bullet does"},
    {"chain-energy", "",
     "Runge–Kutta and error control keep energy to fourth order, a step of an impulse engine to second"},
    {"top", "simbody", "error control of fourth order in double precision"},
    {"handle", "", "one body, which Ragtop turns right at any step: the price of a step; below 10⁻⁵ single precision"},
    {"free-spin", "simbody", "double precision: Ragtop keeps 3 · 10⁻⁶ of its energy in a minute at any step"},
    {"free-spin", "", "one body: the price of a step"},
    {"rolling", "", "one body and one contact: the price of a step, and continuous collision, which Ragtop has on"},
    {"stopping", "", "one body: the price of a step"},
    {"stopping-16", "", "one body: the price of a step"},
    {"bounce", "", "one body that flies: the price of a step"},
    {"friction-holds", "", "one body: the price of a step"},
    {"friction-slides", "", "one body: the price of a step"},
};

}  // namespace

std::string reasonOf(const std::string& scene, const std::string& engine) {
    for (const Reason& reason : kReasons)
        if (scene == reason.scene && (engine == reason.engine || std::string(reason.engine).empty()))
            return reason.text;
    return {};
}

std::string findingsTable(const Points& points) {
    return "| Finding | Variant | Measured | Expected |\n|---|---|---|---|\n" + pyramids(points) + sag(points) +
           explosions(points);
}

}  // namespace ragtop::chart
