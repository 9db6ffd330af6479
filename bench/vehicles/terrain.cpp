#include "terrain.h"

#include <algorithm>
#include <cmath>

namespace ragtop::fleet {

namespace {

/// Slopes up to 12 %, with bumps of 4 cm that the wheels feel.
float hillAt(double x, double z) {
    return static_cast<float>(1.5 * std::sin(0.05 * x) * std::cos(0.04 * z) + 0.04 * std::sin(0.7 * x + 0.9 * z));
}

/// Pavements of 12 cm with a house on each, streets of 30 m between them.
std::vector<Terrain::Block> cityBlocks(float reach) {
    constexpr double kPitch = 40, kPavement = 5, kKerb = 0.06, kHouse = 4;
    std::vector<Terrain::Block> blocks;
    const int count = static_cast<int>(std::ceil(reach / kPitch)) + 1;
    for (int i = -count; i <= count; ++i)
        for (int k = -count; k <= count; ++k) {
            const DVec3 middle{kPitch * (i + 0.5), 0, kPitch * (k + 0.5)};
            const auto half = [](double side, double height) {
                return Vec3{static_cast<float>(side), static_cast<float>(height), static_cast<float>(side)};
            };
            blocks.push_back({middle + DVec3{0, kKerb, 0}, half(kPavement, kKerb)});
            blocks.push_back({middle + DVec3{0, 8, 0}, half(kHouse, 8)});
        }
    return blocks;
}

}  // namespace

float Terrain::heightAt(double x, double z) const {
    if (heights.empty()) return 0;
    const auto cell = [&](double place) {
        const int i = static_cast<int>(std::lround((place + static_cast<double>(extent())) / kSpacing));
        return static_cast<std::size_t>(std::clamp(i, 0, columns - 1));
    };
    return heights[cell(z) * static_cast<std::size_t>(columns) + cell(x)];
}

std::vector<Vec3> Terrain::vertices() const {
    std::vector<Vec3> vertices;
    for (int row = 0; row < columns; ++row)
        for (int column = 0; column < columns; ++column)
            vertices.push_back({kSpacing * static_cast<float>(column) - extent(),
                                heights[static_cast<std::size_t>(row * columns + column)],
                                kSpacing * static_cast<float>(row) - extent()});
    return vertices;
}

std::vector<int> Terrain::indices() const {
    std::vector<int> indices;
    for (int row = 0; row + 1 < columns; ++row)
        for (int column = 0; column + 1 < columns; ++column) {
            const int a = row * columns + column, b = a + 1, c = a + columns, d = c + 1;
            indices.insert(indices.end(), {a, c, b, b, c, d});
        }
    return indices;
}

Terrain makeTerrain(const std::string& name, float reach) {
    Terrain terrain;
    if (name == "flat") return terrain;
    if (name == "city") {
        terrain.blocks = cityBlocks(reach);
        return terrain;
    }
    constexpr float kMargin = 60;  // m around the fleet
    terrain.triangles = name == "mesh";
    terrain.columns = 2 * static_cast<int>(std::ceil((reach + kMargin) / Terrain::kSpacing)) + 1;
    for (int row = 0; row < terrain.columns; ++row)
        for (int column = 0; column < terrain.columns; ++column)
            terrain.heights.push_back(hillAt(static_cast<double>(Terrain::kSpacing) * column - terrain.extent(),
                                             static_cast<double>(Terrain::kSpacing) * row - terrain.extent()));
    return terrain;
}

}  // namespace ragtop::fleet
