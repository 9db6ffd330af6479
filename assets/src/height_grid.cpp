#include "height_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace ragtop {
namespace {

/// Catmull–Rom weights of the four samples around t in [0, 1] between the middle two.
std::array<float, 4> cubicWeights(float t) {
    const float t2 = t * t, t3 = t2 * t;
    return {0.5f * (-t3 + 2 * t2 - t), 0.5f * (3 * t3 - 5 * t2 + 2), 0.5f * (-3 * t3 + 4 * t2 + t), 0.5f * (t3 - t2)};
}

/// The height at place (x, z), counted in cells, with the border rows repeated outwards.
float smoothHeight(const std::vector<std::vector<float>>& heights, int cellX, int cellZ, float tx, float tz) {
    const auto wx = cubicWeights(tx), wz = cubicWeights(tz);
    const int rows = static_cast<int>(heights.size()), columns = static_cast<int>(heights[0].size());
    float sum = 0;
    for (int j = 0; j < 4; ++j) {
        const auto& row = heights[static_cast<std::size_t>(std::clamp(cellZ + j - 1, 0, rows - 1))];
        for (int i = 0; i < 4; ++i) {
            const auto column = static_cast<std::size_t>(std::clamp(cellX + i - 1, 0, columns - 1));
            sum += wz[static_cast<std::size_t>(j)] * wx[static_cast<std::size_t>(i)] * row[column];
        }
    }
    return sum;
}

}  // namespace

HeightField heightFieldOf(const HeightGrid& grid) {
    if (grid.heights.size() < 2 || grid.heights[0].size() < 2) {
        throw std::invalid_argument("heights has fewer than 2 rows or columns");
    }
    for (std::size_t row = 0; row < grid.heights.size(); ++row) {
        if (grid.heights[row].size() != grid.heights[0].size()) {
            throw std::invalid_argument(fmt::format("heights/{} has {} numbers, must have {} as the first row", row,
                                                    grid.heights[row].size(), grid.heights[0].size()));
        }
    }
    const int parts = static_cast<int>(grid.smooth);
    const int columns = (static_cast<int>(grid.heights[0].size()) - 1) * parts + 1;
    const int rows = (static_cast<int>(grid.heights.size()) - 1) * parts + 1;
    std::vector<float> heights;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto part = [&](int k) { return static_cast<float>(k % parts) / static_cast<float>(parts); };
            heights.push_back(smoothHeight(grid.heights, i / parts, j / parts, part(i), part(j)));
        }
    }
    return HeightField(columns, rows, grid.spacing / static_cast<float>(parts), heights);
}

HeightGrid gridOf(const HeightField& field) {
    HeightGrid grid{field.spacing(), 1, {}};
    const auto columns = static_cast<std::size_t>(field.columns());
    for (std::size_t row = 0; row < static_cast<std::size_t>(field.rows()); ++row) {
        const auto line = field.heights().subspan(row * columns, columns);
        grid.heights.emplace_back(line.begin(), line.end());
    }
    return grid;
}

}  // namespace ragtop
