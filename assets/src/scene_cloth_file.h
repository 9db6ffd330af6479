#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ragtop/cloth.h"
#include "scene_place_file.h"

/// The cloths of a scene file as they are read (scene_file.h).
namespace ragtop {

struct SheetInFile {
    unsigned columns = 16, rows = 16;
    Vec3 across{1, 0, 0}, down{0, -1, 0};
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SheetInFile*) {
    visit(Tunable{"columns", "", 2, 1024, "points across"}, self.columns);
    visit(Tunable{"rows", "", 2, 1024, "points down"}, self.rows);
    visit(Tunable{"across", "m", -1000, 1000, "from the first point of a row to its last one"}, self.across);
    visit(Tunable{"down", "m", -1000, 1000, "from the first row to the last one"}, self.down);
}

struct RopeInFile {
    unsigned points = 16;
    Vec3 along{0, -1, 0};
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RopeInFile*) {
    visit(Tunable{"points", "", 2, 65536, "how many"}, self.points);
    visit(Tunable{"along", "m", -1000, 1000, "from the first point to the last one"}, self.along);
}

/// A band along a line of straight pieces.
struct StrapInFile {
    std::vector<Vec3> path;
    Vec3 facing{0, 0, 1};
    float width = 0.05f, spacing = 0.025f;
    unsigned columns = 3;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const StrapInFile*) {
    visit(Tunable{"path", "m", -1000, 1000, "its middle, from place to place"}, self.path);
    visit(Tunable{"facing", "1", -1e5, 1e5, "where its outside looks, across the path"}, self.facing);
    visit(Tunable{"width", "m", 1e-3, 100, "from edge to edge"}, self.width);
    visit(Tunable{"spacing", "m", 1e-3, 100, "largest distance of points along it"}, self.spacing);
    visit(Tunable{"columns", "", 2, 64, "points across"}, self.columns);
}
inline Names requiredFields(const StrapInFile*) { return {"path"}; }

struct ClothHoldInFile {
    std::string to;
    std::vector<int> points;
    std::optional<int> row, column, first, last;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ClothHoldInFile*) {
    visit(Tunable{.name = "to", .meaning = "as the ends of joints; absent: the world"}, self.to);
    visit(Tunable{"points", "", 0, 65535, "by their numbers, row after row"}, self.points);
    visit(Tunable{"row", "", 0, 65535, "or those of a row; a strap has one for each place along it"}, self.row);
    visit(Tunable{"column", "", 0, 65535, "or those of a column"}, self.column);
    visit(Tunable{"first", "", 0, 65535, "of the row or column; absent: the very first"}, self.first);
    visit(Tunable{"last", "", 0, 65535, "likewise; absent: the very last"}, self.last);
}

struct ClothInScene {
    std::string name, color;
    PlaceInFile place;
    std::optional<SheetInFile> sheet;
    std::optional<RopeInFile> rope;
    std::optional<StrapInFile> strap;
    std::vector<ClothHoldInFile> holds;
    Vec3 wind{}, velocity{};
    ClothDef def;  ///< what its description covers
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ClothInScene*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "color", .meaning = "\"#rrggbb\""}, self.color);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{.name = "sheet", .meaning = "rows of points from its position on"}, self.sheet);
    visit(Tunable{.name = "rope", .meaning = "a line of points from its position on"}, self.rope);
    visit(Tunable{.name = "strap", .meaning = "a band along a path"}, self.strap);
    visit(Tunable{.name = "holds", .meaning = "points that go where bodies do, or stay"}, self.holds);
    visit(Tunable{"wind", "m/s", -1000, 1000, "in which it is"}, self.wind);
    visit(Tunable{"velocity", "m/s", -1000, 1000, "of all points at the start"}, self.velocity);
    describe(visit, self.def, static_cast<const ClothDef*>(nullptr));
}

}  // namespace ragtop
