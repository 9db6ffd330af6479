#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "ragtop/world.h"

namespace ragtop {
namespace {

/// A crate of 1 m and 100 kg on a slope that falls 3 in 4.
struct Crate {
    World world{WorldSettings{.sleeping = false}};
    BodyId body;

    Crate() {
        const float half = 0.5f * std::atan(0.75f);
        const Quat downhill{0, 0, -std::sin(half), std::cos(half)};
        const Material wood{.friction = 0.5f};
        world.create(StaticBody{
            .shape = Box{{10, 0.5f, 10}}, .position = {-0.3, -0.4, 0}, .rotation = downhill, .material = wood});
        body = world.create(DynamicBody{.shape = Box{{0.5f, 0.5f, 0.5f}},
                                        .density = 100,
                                        .position = {0.3, 0.4, 0},
                                        .rotation = downhill,
                                        .material = wood});
    }

    static double along(const Vec3& v) { return 0.8 * v.x - 0.6 * v.y; }

    /// What the page tells, by the names of its rows.
    std::map<std::string, double> measure(double h) const {
        std::map<std::string, double> found;
        const Vec3 place = relative(world.pose(body).position, DVec3{0.3, 0.4, 0});
        found["speed down the slope, mm/s"] = 1000 * along(world.linearVelocity(body));
        found["path, mm"] = 1000 * along(place);
        world.forEachContact([&](const Contact& contact) {
            found["normal force, N"] = contact.normalForce;
            found["friction, N"] = length(contact.frictionForce);
            double deepest = 0, edge = 0;
            for (int i = 0; i < contact.pointCount; ++i) {
                deepest = std::fmin(deepest, contact.points[i].separation);
                const Vec3 arm = relative(contact.points[i].point, world.pose(body).position);
                if (along(arm) > 0) edge += contact.points[i].impulse / h;
            }
            found["deepest corner, µm"] = 1e6 * deepest;
            found["on the downhill edge, N"] = edge;
        });
        return found;
    }
};

std::string trimmed(const std::string& text) {
    const auto begin = text.find_first_not_of(' '), end = text.find_last_not_of(' ');
    return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

/// A number as a page tells it, and half a unit of its last digit.
struct Told {
    double value = 0, rounding = 0;
};
Told read(const std::string& text) {
    const std::string minus = "−";
    const bool negative = text.starts_with(minus);
    const std::string digits = negative ? text.substr(minus.size()) : text;
    const auto point = digits.find('.');
    const auto decimals = point == std::string::npos ? 0 : static_cast<int>(digits.size() - point - 1);
    return {(negative ? -1 : 1) * std::stod(digits), 0.5 * std::pow(10.0, -decimals)};
}

/// The rows between the marks of docs/step.md: cells by their name.
std::map<std::string, std::vector<std::string>> rowsOfThePage() {
    std::ifstream page(RAGTOP_SOURCE_DIR "/docs/step.md");
    std::map<std::string, std::vector<std::string>> rows;
    bool on = false;
    for (std::string line; std::getline(page, line);) {
        if (line == "<!-- crate -->" || line == "<!-- end -->") on = line == "<!-- crate -->";
        if (!on || line.empty() || line[0] != '|') continue;
        std::istringstream cells(line.substr(1));
        std::string name, cell;
        std::getline(cells, name, '|');
        while (std::getline(cells, cell, '|')) rows[trimmed(name)].push_back(trimmed(cell));
    }
    return rows;
}

TEST(StepExample, TheCrateOfTheDocumentation) {
    Crate substep, step, second;
    substep.world.setSettings({.substeps = 1, .sleeping = false});
    substep.world.step(1.0 / 240);
    step.world.step(1.0 / 60);
    for (int i = 0; i < 60; ++i) second.world.step(1.0 / 60);

    const auto rows = rowsOfThePage();
    const std::array<std::map<std::string, double>, 3> found{substep.measure(1.0 / 240), step.measure(1.0 / 240),
                                                             second.measure(1.0 / 240)};
    for (const auto& [name, value] : found[0]) {
        const auto row = rows.find(name);
        ASSERT_TRUE(row != rows.end() && row->second.size() == 4) << "docs/step.md has no row: " << name;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const Told told = read(row->second[i + 1]);
            EXPECT_NEAR(found[i].at(name), told.value, 1.001 * told.rounding) << "docs/step.md: " << name;
        }
    }
}

/// Friction acts half a metre below the centre, so that the downhill edge bears (N + F)/2 = 0.6 m g.
TEST(StepExample, TheCrateSlidesByCoulombsLaw) {
    Crate crate;
    for (int i = 0; i < 60; ++i) crate.world.step(1.0 / 60);
    const double g = 9.81, weight = 100 * g, h = 1.0 / 240;
    auto found = crate.measure(h);
    EXPECT_NEAR(found["normal force, N"], 0.8 * weight, 1e-4 * weight);
    EXPECT_NEAR(found["friction, N"], 0.4 * weight, 1e-4 * weight);
    EXPECT_NEAR(found["on the downhill edge, N"], 0.6 * weight, 1e-3 * weight);
    // What friction lacks while loads are found is less than that of a substep, and stays as a speed.
    EXPECT_NEAR(found["speed down the slope, mm/s"], 1000 * 0.2 * g, 1000 * 0.4 * g * h);
}

}  // namespace
}  // namespace ragtop
