#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/check_tunables.h"
#include "shapes/mesh_build.h"

namespace ragtop {
namespace {

[[noreturn]] void rejectField(const std::string& why) { throw std::invalid_argument("HeightField: " + why); }

void checkGrid(int columns, int rows, float spacing, std::span<const float> heights) {
    if (columns < 2) rejectField("columns is " + std::to_string(columns) + ", must be at least 2");
    if (rows < 2) rejectField("rows is " + std::to_string(rows) + ", must be at least 2");
    if (!std::isfinite(spacing) || !(spacing > 0)) {
        rejectField("spacing is " + numberText(spacing) + ", must be finite and above 0 m");
    }
    const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    if (heights.size() != count) {
        rejectField("heights has " + std::to_string(heights.size()) + " entries, must have columns x rows, " +
                    std::to_string(count));
    }
    if (count > 0x7fffffffu) rejectField("columns x rows is " + std::to_string(count) + ", must be at most 2147483647");
    for (std::size_t i = 0; i < count; ++i) {
        if (std::isinf(heights[i])) {
            rejectField("heights[" + std::to_string(i) + "] is " + numberText(heights[i]) +
                        ", must be finite, or NaN for a hole");
        }
    }
}

std::size_t triangleIndex(const HeightFieldData& field, int column, int row, int half) {
    return 2 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns - 1) +
                static_cast<std::size_t>(column)) +
           static_cast<std::size_t>(half);
}

void findNormals(HeightFieldData& field) {
    for (int row = 0; row + 1 < field.rows; ++row) {
        for (int column = 0; column + 1 < field.columns; ++column) {
            for (int half = 0; half < 2; ++half) {
                const TriangleView t = triangleOf(field, column, row, half);
                if (std::isnan(t.a.y) || std::isnan(t.b.y) || std::isnan(t.c.y)) continue;
                field.normals[triangleIndex(field, column, row, half)] = triangleNormal(t.a, t.b, t.c);
                field.lowest = std::min({field.lowest, t.a.y, t.b.y, t.c.y});
                field.highest = std::max({field.highest, t.a.y, t.b.y, t.c.y});
            }
        }
    }
}

/// The triangle beyond each edge: of half 0 to the left, in front and across the diagonal; of half 1 across the
/// diagonal, to the right and behind.
struct Neighbor {
    int column, row, half;
};
constexpr Neighbor kNeighbors[2][3] = {{{-1, 0, 1}, {0, 1, 1}, {0, 0, 1}}, {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}};

std::uint8_t activeEdgesOf(const HeightFieldData& field, int column, int row, int half) {
    const TriangleView t = triangleOf(field, column, row, half);
    const Vec3 edges[3] = {t.b - t.a, t.c - t.b, t.a - t.c};
    unsigned active = 0;
    for (int e = 0; e < 3; ++e) {
        const Neighbor& step = kNeighbors[half][e];
        const int i = column + step.column, j = row + step.row;
        bool open = i < 0 || j < 0 || i + 1 >= field.columns || j + 1 >= field.rows;
        if (!open) {
            const Vec3& other = field.normals[triangleIndex(field, i, j, step.half)];
            open = isHole(other) || isActiveBend(bendAt(t.normal, other, edges[e]));
        }
        if (open) active |= 1u << e;
    }
    return static_cast<std::uint8_t>(active);
}

}  // namespace

HeightField::HeightField(int columns, int rows, float spacing, std::span<const float> heights) {
    checkGrid(columns, rows, spacing, heights);
    HeightFieldData field;
    field.columns = columns;
    field.rows = rows;
    field.spacing = spacing;
    field.heights.assign(heights.begin(), heights.end());
    field.lowest = std::numeric_limits<float>::infinity();
    field.highest = -field.lowest;
    const std::size_t count = 2 * static_cast<std::size_t>(columns - 1) * static_cast<std::size_t>(rows - 1);
    field.normals.resize(count);
    field.activeEdges.resize(count);
    findNormals(field);
    if (field.lowest > field.highest) rejectField("heights leaves no triangle, must have one without NaN");
    for (int row = 0; row + 1 < rows; ++row) {
        for (int column = 0; column + 1 < columns; ++column) {
            for (int half = 0; half < 2; ++half) {
                const std::size_t index = triangleIndex(field, column, row, half);
                if (!isHole(field.normals[index])) field.activeEdges[index] = activeEdgesOf(field, column, row, half);
            }
        }
    }
    data_ = std::make_shared<const HeightFieldData>(std::move(field));
}

int HeightField::columns() const { return data_->columns; }
int HeightField::rows() const { return data_->rows; }
float HeightField::spacing() const { return data_->spacing; }
std::span<const float> HeightField::heights() const { return data_->heights; }

}  // namespace ragtop
