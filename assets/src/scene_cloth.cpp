#include "scene_cloth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr std::size_t kMostPoints = 65536;  ///< of a cloth in a scene file

/// Places on a line through points, as far apart as its length allows without being farther than `spacing`.
std::vector<Vec3> placesAlong(const std::vector<Vec3>& path, float spacing) {
    float whole = 0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) whole += length(path[i + 1] - path[i]);
    const auto pieces = static_cast<std::size_t>(std::max(1.0f, std::ceil(whole / spacing - 1e-3f)));
    const float each = whole / static_cast<float>(pieces);
    std::vector<Vec3> places{path[0]};
    std::size_t at = 0;
    float before = 0;  // length of the pieces that lie behind
    for (std::size_t k = 1; k < pieces; ++k) {
        const float wanted = each * static_cast<float>(k);
        while (at + 2 < path.size() && before + length(path[at + 1] - path[at]) < wanted) {
            before += length(path[at + 1] - path[at]);
            ++at;
        }
        places.push_back(path[at] + (wanted - before) * normalized(path[at + 1] - path[at]));
    }
    places.push_back(path.back());
    return places;
}

/// Columns across its width, a row for each place; its outside looks where `facing` does.
ClothDef strapOf(const StrapInFile& strap) {
    const std::vector<Vec3> places = placesAlong(strap.path, strap.spacing);
    const int columns = static_cast<int>(strap.columns);
    ClothDef def;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3 along = places[std::min(i + 1, places.size() - 1)] - places[i == 0 ? 0 : i - 1];
        const Vec3 across = strap.width * normalized(cross(strap.facing, along), {1, 0, 0});
        for (int column = 0; column < columns; ++column)
            def.points.push_back(places[i] +
                                 (static_cast<float>(column) / static_cast<float>(columns - 1) - 0.5f) * across);
    }
    for (int row = 0; row + 1 < static_cast<int>(places.size()); ++row)
        for (int column = 0; column + 1 < columns; ++column) {
            const int first = row * columns + column;
            def.faces.push_back({first, first + columns, first + columns + 1, first + 1});
        }
    return def;
}

/// Of what lies in rows; 0 for a rope, which has none.
int columnsOf(const ClothInScene& in) {
    return in.sheet ? static_cast<int>(in.sheet->columns) : in.strap ? static_cast<int>(in.strap->columns) : 0;
}

void needPath(const StrapInFile& strap, const JsonValue& at) {
    if (strap.path.size() < 2) at.at("path").fail(fmt::format("has {} points, must have 2 or more", strap.path.size()));
    float whole = 0;
    for (std::size_t i = 0; i + 1 < strap.path.size(); ++i) {
        const float piece = length(strap.path[i + 1] - strap.path[i]);
        if (!(piece > 0)) at.at("path").at(i + 1).fail("is the point before it, must be another one");
        whole += piece;
    }
    if (whole / strap.spacing * static_cast<float>(strap.columns) > static_cast<float>(kMostPoints))
        at.fail(fmt::format("has more than {} points, the most allowed", kMostPoints));
}

}  // namespace

ClothDef clothOf(const ClothInScene& in, const JsonValue& at) {
    const int forms = (in.sheet ? 1 : 0) + (in.rope ? 1 : 0) + (in.strap ? 1 : 0);
    if (forms != 1) at.fail(fmt::format("has {} of \"sheet\", \"rope\" and \"strap\", must have exactly one", forms));
    ClothDef def;
    if (in.sheet) {
        if (std::size_t{in.sheet->columns} * in.sheet->rows > kMostPoints)
            at.at("sheet").fail(fmt::format("has {} points, must have at most {}",
                                            std::size_t{in.sheet->columns} * in.sheet->rows, kMostPoints));
        def = clothSheet(static_cast<int>(in.sheet->columns), static_cast<int>(in.sheet->rows), in.sheet->across,
                         in.sheet->down);
    } else if (in.rope) {
        def = clothRope(static_cast<int>(in.rope->points), in.rope->along);
    } else {
        needPath(*in.strap, at.at("strap"));
        def = strapOf(*in.strap);
    }
    ClothDef whole = in.def;
    whole.points = std::move(def.points);
    whole.faces = std::move(def.faces);
    whole.lines = std::move(def.lines);
    if (const std::string wrong = whyInvalid(whole); !wrong.empty()) at.fail("is no usable cloth: " + wrong);
    return whole;
}

std::vector<int> heldPoints(const ClothInScene& in, const ClothHoldInFile& hold, std::size_t points,
                            const JsonValue& at) {
    const int columns = columnsOf(in), count = static_cast<int>(points);
    const int forms = (hold.points.empty() ? 0 : 1) + (hold.row ? 1 : 0) + (hold.column ? 1 : 0);
    if (forms != 1) at.fail(fmt::format("has {} of \"points\", \"row\" and \"column\", must have exactly one", forms));
    const auto need = [&](const JsonValue& value, int index, int below, const char* what) {
        if (index < 0 || index >= below)
            value.fail(fmt::format("is {}, must be one of the {} {}, from 0 on", index, below, what));
    };
    for (std::size_t i = 0; i < hold.points.size(); ++i) need(at.at("points").at(i), hold.points[i], count, "points");
    if (!hold.points.empty()) return hold.points;
    if (columns == 0) at.fail("has a row or column, must have \"points\": a rope has no rows");
    const int rows = count / columns, across = hold.row ? columns : rows;
    if (hold.row) need(at.at("row"), *hold.row, rows, "rows");
    if (hold.column) need(at.at("column"), *hold.column, columns, "columns");
    if (hold.first) need(at.at("first"), *hold.first, across, "points of it");
    if (hold.last) need(at.at("last"), *hold.last, across, "points of it");
    std::vector<int> held;
    for (int i = hold.first.value_or(0); i <= hold.last.value_or(across - 1); ++i)
        held.push_back(hold.row ? *hold.row * columns + i : i * columns + *hold.column);
    if (held.empty()) at.fail("has its first point behind its last one, must be at or before it");
    return held;
}

}  // namespace ragtop
